//! Bézier cells of a piecewise polynomial or rational surface or solid, as writers take them.

use nalgebra::Point3;

/// The shape of a Bézier cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellShape {
    /// Triangles of total degree `degree[0]`.
    Triangles,
    /// Tensor products in two variables.
    Quads,
    /// Tensor products in three variables.
    Hexahedra,
}

impl CellShape {
    /// Returns the number of control points of a cell of these degrees; those of absent directions are
    /// ignored.
    #[must_use]
    pub fn points_per_cell(self, degree: [usize; 3]) -> usize {
        let [a, b, c] = degree.map(|degree| degree + 1);
        match self {
            Self::Triangles => a * (a + 1) / 2,
            Self::Quads => a * b,
            Self::Hexahedra => a * b * c,
        }
    }

    /// Returns, for each point of a cell in VTK's order, its place in the order of [`BezierCells`].
    /// VTK has no cells of degree 0.
    #[must_use]
    pub fn vtk_order(self, degree: [usize; 3]) -> Vec<usize> {
        match (self, degree) {
            (Self::Triangles, [degree, ..]) => vtk_triangle_order(degree),
            (Self::Quads, [a, b, _]) => vtk_quad_order([a, b]),
            (Self::Hexahedra, degree) => vtk_hexahedron_order(degree),
        }
    }
}

/// Cells of one degree, one after another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CellRun {
    /// Degrees in the directions of the shape.
    pub degree: [usize; 3],
    /// How many cells.
    pub cells: usize,
}

/// Bézier cells of one shape, in runs of one degree each.
#[derive(Clone, Debug, PartialEq)]
pub struct BezierCells {
    shape: CellShape,
    runs: Vec<CellRun>,
    points: Vec<Point3<f64>>,
    weights: Option<Vec<f64>>,
}

/// Why points are not cells.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CellsError {
    /// The points do not fill whole cells.
    #[error("{points} points do not fill cells of {per_cell}; give all points of every cell")]
    Points {
        /// Number of points.
        points: usize,
        /// Points of a cell.
        per_cell: usize,
    },
    /// Weights are not one for each point.
    #[error("{weights} weights for {points} points; give one for each, or none")]
    Weights {
        /// Number of weights.
        weights: usize,
        /// Number of points.
        points: usize,
    },
    /// Cells that are to be joined differ in more than their degree.
    #[error(
        "cells of different shapes, or with weights and without, cannot be joined; keep them apart"
    )]
    Unlike,
}

impl BezierCells {
    /// Returns cells of one degree, of the control points of one cell after those of another.
    ///
    /// In a tensor product the first index varies fastest: point `(i, j, k)` of a cell stands at
    /// `i + (d0 + 1) (j + (d1 + 1) k)`. In a triangle point `(i, j)`, the coefficient of
    /// `u^(d - i - j) v^i w^j`, comes with `i` fastest. Degrees of absent directions are ignored.
    ///
    /// # Errors
    /// Points that do not fill whole cells; weights that are not one for each point.
    pub fn build(
        shape: CellShape,
        degree: [usize; 3],
        points: Vec<Point3<f64>>,
        weights: Option<Vec<f64>>,
    ) -> Result<Self, CellsError> {
        let per_cell = shape.points_per_cell(degree);
        if !points.len().is_multiple_of(per_cell) {
            return Err(CellsError::Points {
                points: points.len(),
                per_cell,
            });
        }
        if let Some(weights) = weights.as_ref().filter(|w| w.len() != points.len()) {
            return Err(CellsError::Weights {
                weights: weights.len(),
                points: points.len(),
            });
        }
        let cells = points.len() / per_cell;
        Ok(Self {
            shape,
            runs: vec![CellRun { degree, cells }],
            points,
            weights,
        })
    }

    /// Returns these cells and then others, whose degree may be another one.
    ///
    /// # Errors
    /// Cells of another shape, or weights on one side alone.
    pub fn joined(mut self, other: Self) -> Result<Self, CellsError> {
        if self.shape != other.shape || self.weights.is_some() != other.weights.is_some() {
            return Err(CellsError::Unlike);
        }
        self.points.extend(other.points);
        if let (Some(own), Some(more)) = (&mut self.weights, other.weights) {
            own.extend(more);
        }
        for run in other.runs {
            match self.runs.last_mut() {
                Some(last) if last.degree == run.degree => last.cells += run.cells,
                _ => self.runs.push(run),
            }
        }
        Ok(self)
    }

    /// The shape of the cells.
    #[must_use]
    pub fn shape(&self) -> CellShape {
        self.shape
    }

    /// Runs of cells of one degree, in the order of the cells.
    #[must_use]
    pub fn runs(&self) -> &[CellRun] {
        &self.runs
    }

    /// Degrees in the directions of the shape, if all cells have the same.
    #[must_use]
    pub fn degree(&self) -> Option<[usize; 3]> {
        match self.runs.as_slice() {
            [run] => Some(run.degree),
            _ => None,
        }
    }

    /// Control points, one cell after another.
    #[must_use]
    pub fn points(&self) -> &[Point3<f64>] {
        &self.points
    }

    /// Rational weights, one for each point; absent where all are 1. Points are not multiplied by
    /// them: a cell is the sum of `w B p` over that of `w B`.
    #[must_use]
    pub fn weights(&self) -> Option<&[f64]> {
        self.weights.as_deref()
    }

    /// Number of cells.
    #[must_use]
    pub fn len(&self) -> usize {
        self.runs.iter().map(|run| run.cells).sum()
    }

    /// Whether there are no cells.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }
}

/// Returns the number of control points of a hexahedron of these degrees.
#[must_use]
pub fn hexahedron_points(degree: [usize; 3]) -> usize {
    degree.iter().map(|d| d + 1).product()
}

/// Returns, for each point of a `VTK_BEZIER_TRIANGLE` in VTK's order, its place in the order of
/// [`BezierCells`], in which point `(i, j)` of degree `d` stands at `i + j (2 d + 3 - j) / 2`.
///
/// VTK lists the corners `(0, 0)`, `(d, 0)`, `(0, d)`; the inner points of the edges from the first to
/// the second, from the second to the third and from the third to the first, each along its way; and
/// then the points inside in the same manner, as those of a triangle of degree `d - 3`. Its first
/// parameter grows with `i`, its second with `j`.
#[must_use]
pub fn vtk_triangle_order(degree: usize) -> Vec<usize> {
    let place = |[i, j]: [usize; 2]| i + j * (2 * degree + 3 - j) / 2;
    let mut order = Vec::with_capacity((degree + 1) * (degree + 2) / 2);
    let (mut ring, mut rest) = (0, degree);
    // Ring by ring; the one at `ring` is the boundary of a triangle of degree `rest`.
    loop {
        let at = |i: usize, j: usize| place([ring + i, ring + j]);
        if rest == 0 {
            order.push(at(0, 0));
            return order;
        }
        order.extend([at(0, 0), at(rest, 0), at(0, rest)]);
        order.extend((1..rest).map(|i| at(i, 0)));
        order.extend((1..rest).map(|j| at(rest - j, j)));
        order.extend((1..rest).map(|i| at(0, rest - i)));
        match rest.checked_sub(3) {
            Some(inner) => (ring, rest) = (ring + 1, inner),
            None => return order,
        }
    }
}

/// Returns, for each point of a `VTK_BEZIER_QUADRILATERAL` in VTK's order, its place
/// `i + (d0 + 1) j` in the order of [`BezierCells`]. Degrees are at least 1.
///
/// VTK lists the four corners around; the inner points of the four edges around, each along its axis;
/// and the points inside, the first index fastest.
#[must_use]
pub fn vtk_quad_order(degree: [usize; 2]) -> Vec<usize> {
    let [a, b] = degree;
    let place = |i: usize, j: usize| i + (a + 1) * j;
    let mut order = vec![place(0, 0), place(a, 0), place(a, b), place(0, b)];
    order.extend((1..a).map(|i| place(i, 0)));
    order.extend((1..b).map(|j| place(a, j)));
    order.extend((1..a).map(|i| place(i, b)));
    order.extend((1..b).map(|j| place(0, j)));
    order.extend((1..b).flat_map(|j| (1..a).map(move |i| place(i, j))));
    order
}

/// Returns, for each point of a `VTK_BEZIER_HEXAHEDRON` in VTK's order, its place
/// `i + (d0 + 1) (j + (d1 + 1) k)` in the order of [`BezierCells`]. Degrees are at least 1.
///
/// VTK lists the 8 corners as in its linear hexahedron; the inner points of the 12 edges: the four at
/// the bottom around, the four at the top around, the four upright ones around, each along its
/// axis; the inner points of the faces `i = 0`, `i = d0`, `j = 0`, `j = d1`, `k = 0`, `k = d2`, the
/// first free index fastest; and the points inside, the first index fastest. Files of version 2.1 and
/// later have the upright edges around as the corners go; older ones had the last two exchanged.
#[must_use]
pub fn vtk_hexahedron_order(degree: [usize; 3]) -> Vec<usize> {
    let [a, b, c] = degree;
    let place = |[i, j, k]: [usize; 3]| i + (a + 1) * (j + (b + 1) * k);
    let ring = [[0, 0], [a, 0], [a, b], [0, b]];
    let mut order = Vec::with_capacity(hexahedron_points(degree));
    for k in [0, c] {
        order.extend(ring.map(|[i, j]| place([i, j, k])));
    }
    for k in [0, c] {
        order.extend((1..a).map(|i| place([i, 0, k])));
        order.extend((1..b).map(|j| place([a, j, k])));
        order.extend((1..a).map(|i| place([i, b, k])));
        order.extend((1..b).map(|j| place([0, j, k])));
    }
    for [i, j] in ring {
        order.extend((1..c).map(|k| place([i, j, k])));
    }
    for i in [0, a] {
        order.extend((1..c).flat_map(|k| (1..b).map(move |j| place([i, j, k]))));
    }
    for j in [0, b] {
        order.extend((1..c).flat_map(|k| (1..a).map(move |i| place([i, j, k]))));
    }
    for k in [0, c] {
        order.extend((1..b).flat_map(|j| (1..a).map(move |i| place([i, j, k]))));
    }
    for k in 1..c {
        order.extend((1..b).flat_map(|j| (1..a).map(move |i| place([i, j, k]))));
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Index of a point in VTK's order, written from its published formula.
    fn vtk_index([i, j, k]: [usize; 3], order: [usize; 3]) -> usize {
        let [a, b, c] = order.map(|degree| degree - 1);
        let ends = [i % order[0] == 0, j % order[1] == 0, k % order[2] == 0];
        match ends {
            [true, true, true] => {
                let around = [[0, 3], [1, 2]][usize::from(i > 0)][usize::from(j > 0)];
                around + if k > 0 { 4 } else { 0 }
            }
            [false, true, true] => {
                8 + i - 1 + if j > 0 { a + b } else { 0 } + if k > 0 { 2 * (a + b) } else { 0 }
            }
            [true, false, true] => {
                8 + j - 1 + if i > 0 { a } else { 2 * a + b } + if k > 0 { 2 * (a + b) } else { 0 }
            }
            [true, true, false] => {
                let around = [[0, 3], [1, 2]][usize::from(i > 0)][usize::from(j > 0)];
                8 + 4 * (a + b) + k - 1 + c * around
            }
            [true, false, false] => {
                8 + 4 * (a + b + c) + j - 1 + b * (k - 1) + if i > 0 { b * c } else { 0 }
            }
            [false, true, false] => {
                let before = 8 + 4 * (a + b + c) + 2 * b * c;
                before + i - 1 + a * (k - 1) + if j > 0 { a * c } else { 0 }
            }
            [false, false, true] => {
                let before = 8 + 4 * (a + b + c) + 2 * (b * c + a * c);
                before + i - 1 + a * (j - 1) + if k > 0 { a * b } else { 0 }
            }
            [false, false, false] => {
                let before = 8 + 4 * (a + b + c) + 2 * (b * c + a * c + a * b);
                before + i - 1 + a * (j - 1 + b * (k - 1))
            }
        }
    }

    #[test]
    fn the_order_of_vtk_is_its_published_formula() {
        for degree in [[1, 1, 1], [2, 3, 4], [3, 3, 3]] {
            let order = vtk_hexahedron_order(degree);
            assert_eq!(order.len(), hexahedron_points(degree));
            for (index, place) in order.into_iter().enumerate() {
                let [a, b] = [degree[0] + 1, degree[1] + 1];
                let at = [place % a, place / a % b, place / (a * b)];
                assert_eq!(vtk_index(at, degree), index, "{at:?} of {degree:?}");
            }
        }
    }

    /// Index of a point of a triangle in VTK's order, written from its published formula: whole rings
    /// of `3 order` points lie before the ring of a point, and each ring has its corners first.
    fn vtk_triangle_index(at: [usize; 3], degree: usize) -> usize {
        let least = at.into_iter().min().unwrap_or(0);
        let order = degree - 3 * least;
        let before: usize = (0..least).map(|ring| 3 * (degree - 3 * ring)).sum();
        let [r, s, t] = at.map(|x| x - least);
        if let Some(corner) = [t, r, s].iter().position(|&x| x == order) {
            return before + corner;
        }
        // On an edge one coordinate grows, the next is least, and the one after falls.
        let (edge, along) = match [r, s, t] {
            [r, 0, _] => (0, r),
            [_, s, 0] => (1, s),
            [_, _, t] => (2, t),
        };
        before + 3 + edge * (order - 1) + along - 1
    }

    #[test]
    fn the_order_of_triangles_of_vtk_is_its_published_formula() {
        for degree in 1..=9 {
            let order = vtk_triangle_order(degree);
            let all: Vec<[usize; 2]> = (0..=degree)
                .flat_map(|j| (0..=degree - j).map(move |i| [i, j]))
                .collect();
            assert_eq!(order.len(), all.len(), "{degree}");
            for (index, place) in order.into_iter().enumerate() {
                let [i, j] = all[place];
                let at = [i, j, degree - i - j];
                assert_eq!(vtk_triangle_index(at, degree), index, "{at:?}");
            }
        }
        // Corners, then the middles of the edges 01, 12 and 20.
        assert_eq!(vtk_triangle_order(2), [0, 2, 5, 1, 4, 3]);
        assert_eq!(vtk_triangle_order(0), [0]);
    }

    #[test]
    fn the_order_of_quads_of_vtk_is_that_of_the_bottom_of_hexahedra() {
        for degree in [[1, 1], [2, 3], [3, 3], [4, 2]] {
            let [a, b] = degree;
            // A hexahedron of degree 1 upright has nothing else at its bottom than the quad.
            let bottom = vtk_hexahedron_order([a, b, 1]);
            let bottom = bottom.into_iter().filter(|&p| p < (a + 1) * (b + 1));
            assert_eq!(vtk_quad_order(degree), bottom.collect::<Vec<_>>());
        }
    }

    #[test]
    fn every_shape_has_its_points_and_their_order() {
        for (shape, degree, points, order) in [
            (CellShape::Triangles, [3, 7, 7], 10, vtk_triangle_order(3)),
            (CellShape::Quads, [2, 3, 7], 12, vtk_quad_order([2, 3])),
            (
                CellShape::Hexahedra,
                [1, 2, 3],
                24,
                vtk_hexahedron_order([1, 2, 3]),
            ),
        ] {
            assert_eq!(shape.points_per_cell(degree), points);
            assert_eq!(shape.vtk_order(degree), order);
            let cells = |count| {
                let points = vec![Point3::origin(); count * points];
                BezierCells::build(shape, degree, points, None).unwrap()
            };
            assert!(cells(0).is_empty() && !cells(2).is_empty());
        }
    }

    #[test]
    fn cells_are_counted_and_checked() {
        let points = vec![Point3::origin(); 24];
        let shape = CellShape::Hexahedra;
        let cells = BezierCells::build(shape, [1, 1, 2], points.clone(), None);
        assert_eq!(cells.map(|c| c.len()), Ok(2));
        let wrong = BezierCells::build(shape, [3, 3, 3], points.clone(), None);
        assert_eq!(
            wrong,
            Err(CellsError::Points {
                points: 24,
                per_cell: 64
            })
        );
        let wrong = BezierCells::build(shape, [1, 1, 1], points, Some(vec![1.0]));
        assert_eq!(
            wrong,
            Err(CellsError::Weights {
                weights: 1,
                points: 24
            })
        );
    }

    #[test]
    fn joined_cells_keep_their_degrees() {
        let shape = CellShape::Triangles;
        let build = |degree: usize, cells: usize, weights: bool| {
            let points = vec![Point3::origin(); cells * shape.points_per_cell([degree, 0, 0])];
            let weights = weights.then(|| vec![1.0; points.len()]);
            BezierCells::build(shape, [degree, 0, 0], points, weights).unwrap()
        };
        let cells = build(2, 3, false).joined(build(4, 2, false)).unwrap();
        assert_eq!((cells.len(), cells.points().len()), (5, 3 * 6 + 2 * 15));
        assert_eq!(cells.degree(), None);
        let degrees: Vec<_> = cells
            .runs()
            .iter()
            .map(|r| (r.degree[0], r.cells))
            .collect();
        assert_eq!(degrees, [(2, 3), (4, 2)]);
        let same = build(2, 3, true).joined(build(2, 1, true)).unwrap();
        assert_eq!((same.degree(), same.len()), (Some([2, 0, 0]), 4));
        assert_eq!(same.weights().map(<[f64]>::len), Some(24));
        let unlike = build(2, 1, true).joined(build(2, 1, false));
        assert_eq!(unlike, Err(CellsError::Unlike));
        let quads = BezierCells::build(CellShape::Quads, [1, 1, 0], Vec::new(), None).unwrap();
        assert!(build(2, 1, false).joined(quads).is_err());
    }
}
