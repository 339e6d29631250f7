//! The whole surface as Bézier triangles.

use msplines_common::Point3;
use msplines_common::Vector3;
use msplines_common::bspline::{BezierCells, CellShape};
use rayon::prelude::*;

use super::PowellSabinSurface;
use super::approximate::DEGREE;
use super::hole::Cap;
use super::smooth::SmoothCap;
use crate::element::micro_ordinates;

/// The surface as Bézier triangles.
#[derive(Clone, Debug)]
pub struct SurfaceCells {
    /// The cells: quadratic ones first, those of the regular part and of covered faces before those of
    /// minimal caps; then those of higher degree, where the surface is blended.
    pub cells: BezierCells,
    /// How many of them are the surface exactly: the quadratic ones.
    pub exact: usize,
    /// Largest distance found of the others from the surface, over the diagonal of the mesh.
    pub deviation: f64,
    /// How often sides of micro triangles were halved at most.
    pub halvings: u32,
}

/// Six points of a cell: `P, Q, R, PQ, QR, PR`.
type Cell = [Vector3<f64>; 6];

impl PowellSabinSurface {
    /// The deviation of [`Self::bezier_cells`] that serves pictures and files, over the diagonal.
    pub const CELL_TOLERANCE: f64 = 1e-6;

    /// Returns the surface as Bézier triangles: exactly where it is quadratic, so for all faces, six
    /// cells each, and minimal caps, but those along the rim of smooth caps and in the rings that they
    /// are blended over, which are no polynomials. There quartics pass through fifteen points of each
    /// micro triangle; those that are not within `tolerance` times the diagonal are halved, six times
    /// at most.
    ///
    /// Cells meet their neighbours to rounding; open holes stay open.
    ///
    /// # Panics
    /// Never: the points fill whole cells.
    #[must_use]
    pub fn bezier_cells(&self, tolerance: f64) -> SurfaceCells {
        let exact_faces = (0..self.mesh().face_count() as u32).filter(|&f| self.is_exact(f));
        let mut cells: Vec<Cell> = exact_faces.flat_map(|f| self.exact_cells(f)).collect();
        for hole in self.caps() {
            if let Cap::Minimal(cap) = hole.cap() {
                cells.extend(hole.faces().iter().flat_map(|&face| cap.cells(face)));
            }
        }
        let exact = cells.len();
        let in_order = |[p, q, r, pq, qr, pr]: Cell| [p, pq, q, pr, qr, r].map(Point3::from);
        let points = cells.into_iter().flat_map(in_order).collect();
        let limit = tolerance * self.mesh().diagonal();
        let blended = self.approximate(&self.blended_faces(), limit);
        let build = |degree: usize, points: Vec<Point3<f64>>| {
            let cells = BezierCells::build(CellShape::Triangles, [degree, 0, 0], points, None);
            cells.expect("whole cells")
        };
        let mut cells = build(2, points);
        if !blended.points.is_empty() {
            let more = build(DEGREE, blended.points);
            cells = cells.joined(more).expect("triangles without weights");
        }
        SurfaceCells {
            cells,
            exact,
            deviation: blended.deviation / self.mesh().diagonal(),
            halvings: blended.halvings,
        }
    }

    /// The smooth cap that covers a face.
    pub(super) fn covering(&self, face: u32) -> Option<&SmoothCap> {
        let hole = self.caps().get(self.hole_of_face[face as usize] as usize)?;
        match hole.cap() {
            Cap::Smooth(cap) => Some(cap),
            _ => None,
        }
    }

    /// Whether the surface is a Powell-Sabin spline on a face.
    fn is_exact(&self, face: u32) -> bool {
        match self.covering(face) {
            Some(cap) => cap.is_straight(face),
            None => self.plain_face(face).is_some() && self.blends(face).next().is_none(),
        }
    }

    fn exact_cells(&self, face: u32) -> impl Iterator<Item = Cell> + use<> {
        let parts = [0, 1, 2].map(|c| match self.covering(face) {
            Some(cap) => cap.ordinates(face, c),
            None => {
                let regular = self.plain_face(face).unwrap_or_default();
                self.regular().ordinates(regular, c)
            }
        });
        (0..6).map(move |micro| {
            micro_ordinates(micro).map(|at| Vector3::from(parts.each_ref().map(|b| b[at])))
        })
    }

    /// Faces of smooth caps along their rims, and of the rings around them.
    pub(super) fn blended_faces(&self) -> Vec<u32> {
        let blended = |&face: &u32| {
            let shown = self.covering(face).is_some() || self.plain_face(face).is_some();
            shown && !self.is_exact(face)
        };
        let faces = 0..self.mesh().face_count() as u32;
        faces.into_par_iter().filter(blended).collect()
    }
}
