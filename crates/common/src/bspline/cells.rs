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

/// Bézier cells of one shape and degree.
#[derive(Clone, Debug, PartialEq)]
pub struct BezierCells {
    shape: CellShape,
    degree: [usize; 3],
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
}

impl BezierCells {
    /// Returns cells of the control points of one cell after those of another.
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
        let cells = Self {
            shape,
            degree,
            points,
            weights,
        };
        let per_cell = cells.points_per_cell();
        if !cells.points.len().is_multiple_of(per_cell) {
            return Err(CellsError::Points {
                points: cells.points.len(),
                per_cell,
            });
        }
        match &cells.weights {
            Some(weights) if weights.len() != cells.points.len() => Err(CellsError::Weights {
                weights: weights.len(),
                points: cells.points.len(),
            }),
            _ => Ok(cells),
        }
    }

    /// The shape of the cells.
    #[must_use]
    pub fn shape(&self) -> CellShape {
        self.shape
    }

    /// Degrees in the directions of the shape.
    #[must_use]
    pub fn degree(&self) -> [usize; 3] {
        self.degree
    }

    /// Control points, one cell after another.
    #[must_use]
    pub fn points(&self) -> &[Point3<f64>] {
        &self.points
    }

    /// Rational weights, one for each point; absent where all are 1.
    #[must_use]
    pub fn weights(&self) -> Option<&[f64]> {
        self.weights.as_deref()
    }

    /// Control points of one cell.
    #[must_use]
    pub fn points_per_cell(&self) -> usize {
        let [a, b, c] = self.degree.map(|degree| degree + 1);
        match self.shape {
            CellShape::Triangles => a * (a + 1) / 2,
            CellShape::Quads => a * b,
            CellShape::Hexahedra => a * b * c,
        }
    }

    /// Number of cells.
    #[must_use]
    pub fn len(&self) -> usize {
        self.points.len() / self.points_per_cell()
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
}
