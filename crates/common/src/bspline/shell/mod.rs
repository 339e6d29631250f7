//! Shells of Bézier patches that share their edges, as writers of boundary representations take them.

mod check;
mod curve;

use nalgebra::Point3;

pub use check::{ShellError, ShellPart};
pub use curve::BezierCurve;

/// A curve between two vertices, where one patch ends or two meet.
#[derive(Clone, Debug, PartialEq)]
pub struct BezierEdge {
    /// Vertices at the start and at the end of the curve.
    pub ends: [u32; 2],
    /// The curve.
    pub curve: BezierCurve,
}

/// An edge as a piece of the boundary of a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EdgeUse {
    /// The edge.
    pub edge: u32,
    /// Whether the boundary runs along it from its end to its start.
    pub reversed: bool,
}

/// A tensor-product Bézier patch with its boundary.
#[derive(Clone, Debug, PartialEq)]
pub struct BezierFace {
    /// Degrees in the two directions.
    pub degree: [usize; 2],
    /// Control points; `(i, j)` stands at `i + (d0 + 1) j`.
    pub points: Vec<Point3<f64>>,
    /// Rational weights, one for each point; absent where all are 1. Points are not multiplied by them.
    pub weights: Option<Vec<f64>>,
    /// Edges around the patch, counterclockwise in its parameters: along the sides from (0, 0) to
    /// (1, 0), (1, 1), (0, 1) and back. A side is one edge or, where patches end at it, several; one that
    /// is but a point is none.
    pub boundary: Vec<EdgeUse>,
}

impl BezierFace {
    /// Returns side 0 to 3 of the patch, counterclockwise from that of (0, 0) and (1, 0).
    ///
    /// # Panics
    /// If there is no such side, or not a point and a weight for each pair of indices.
    #[must_use]
    pub fn side(&self, side: usize) -> BezierCurve {
        let [a, b] = self.degree;
        let place = |i: usize, j: usize| i + (a + 1) * j;
        let along: Vec<usize> = match side {
            0 => (0..=a).map(|i| place(i, 0)).collect(),
            1 => (0..=b).map(|j| place(a, j)).collect(),
            2 => (0..=a).rev().map(|i| place(i, b)).collect(),
            3 => (0..=b).rev().map(|j| place(0, j)).collect(),
            _ => panic!("a patch has sides 0 to 3, not {side}"),
        };
        BezierCurve {
            points: along.iter().map(|&at| self.points[at]).collect(),
            weights: self
                .weights
                .as_ref()
                .map(|weights| along.iter().map(|&at| weights[at]).collect()),
        }
    }

    /// Corners (0, 0), (1, 0), (1, 1), (0, 1).
    fn corners(&self) -> [Point3<f64>; 4] {
        let [a, b] = self.degree;
        [0, a, a + (a + 1) * b, (a + 1) * b].map(|at| self.points[at])
    }
}

/// Faces that are joined across edges.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShellComponent {
    /// The faces, ascending.
    pub faces: Vec<u32>,
    /// Whether two faces, or one twice, meet at each of their edges.
    pub is_closed: bool,
}

/// Bézier patches and the edges and vertices that they share.
///
/// Neighbours share the curve between them, whatever their control points: the shell has no gaps
/// other than those that [`Self::tolerance`] and the rounding of curves allow. Where several patches
/// end at the side of one, as at the T-junctions of a T-spline, that side is several edges, each a
/// [`BezierCurve::piece`] of it. The outer side of a patch is that of `du × dv`.
#[derive(Clone, Debug, PartialEq)]
pub struct BezierShell {
    vertices: Vec<Point3<f64>>,
    edges: Vec<BezierEdge>,
    faces: Vec<BezierFace>,
    /// The faces at each edge.
    sides: Vec<(u32, Option<u32>)>,
    tolerance: f64,
}

impl BezierShell {
    /// Returns the shell of these patches, with vertices, curves' ends and corners of patches that
    /// agree up to the length `tolerance`.
    ///
    /// That edges lie on their patches between the corners is not checked; those that
    /// [`BezierFace::side`] and [`BezierCurve::piece`] return do. Linear in the size of the shell.
    ///
    /// # Errors
    /// Numbers that are not finite, weights that are not positive, points or weights that are not those
    /// of the degrees, indices out of range, an edge that does not end at its vertices, a boundary that
    /// does not close or does not pass the corners of its patch counterclockwise, an edge that is not
    /// used once or twice or is used twice in one direction, no faces at all.
    pub fn build(
        vertices: Vec<Point3<f64>>,
        edges: Vec<BezierEdge>,
        faces: Vec<BezierFace>,
        tolerance: f64,
    ) -> Result<Self, ShellError> {
        let sides = check::check(&vertices, &edges, &faces, tolerance)?;
        Ok(Self {
            vertices,
            edges,
            faces,
            sides,
            tolerance,
        })
    }

    /// The vertices.
    #[must_use]
    pub fn vertices(&self) -> &[Point3<f64>] {
        &self.vertices
    }

    /// The edges.
    #[must_use]
    pub fn edges(&self) -> &[BezierEdge] {
        &self.edges
    }

    /// The faces.
    #[must_use]
    pub fn faces(&self) -> &[BezierFace] {
        &self.faces
    }

    /// Length by which vertices may differ from ends of curves and corners of patches.
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Returns the pieces that hang together across edges, in the order of their first faces.
    #[must_use]
    pub fn components(&self) -> Vec<ShellComponent> {
        let mut component = vec![usize::MAX; self.faces.len()];
        let mut components = Vec::new();
        for first in 0..self.faces.len() {
            if component[first] != usize::MAX {
                continue;
            }
            let (mut faces, mut is_closed) = (vec![first as u32], true);
            component[first] = components.len();
            let mut next = 0;
            while let Some(&face) = faces.get(next) {
                next += 1;
                for used in &self.faces[face as usize].boundary {
                    let (one, other) = self.sides[used.edge as usize];
                    is_closed &= other.is_some();
                    for neighbour in [Some(one), other].into_iter().flatten() {
                        let found = &mut component[neighbour as usize];
                        if *found == usize::MAX {
                            *found = components.len();
                            faces.push(neighbour);
                        }
                    }
                }
            }
            faces.sort_unstable();
            components.push(ShellComponent { faces, is_closed });
        }
        components
    }
}

#[cfg(test)]
mod tests;
