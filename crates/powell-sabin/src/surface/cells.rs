//! The whole surface as Bézier triangles.

use msplines_common::Point3;
use msplines_common::Vector3;
use msplines_common::bspline::{BezierCells, CellShape};
use msplines_common::evaluate::Order;
use msplines_common::mesh::{NONE, SurfacePoint};
use rayon::prelude::*;

use super::PowellSabinSurface;
use super::hole::Cap;
use super::smooth::SmoothCap;
use crate::element::{MacroTriangle, micro_ordinates};

/// How often sides of micro triangles are halved at most.
const DEEPEST: u32 = 5;

/// Points of a cell, beside those it passes through, where its distance is taken.
const PROBES: [[f64; 3]; 4] = [
    [1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0],
    [0.75, 0.25, 0.0],
    [0.0, 0.75, 0.25],
    [0.25, 0.0, 0.75],
];

/// The surface as quadratic Bézier triangles.
#[derive(Clone, Debug)]
pub struct SurfaceCells {
    /// The cells: those of the regular part first, then hole after hole.
    pub cells: BezierCells,
    /// How many of them are the surface exactly.
    pub exact: usize,
    /// Largest distance found of the others from the surface, over the diagonal of the mesh.
    pub deviation: f64,
    /// How often sides of micro triangles were halved for the worst hole.
    pub halvings: u32,
}

/// Six points of a cell: `P, Q, R, PQ, QR, PR`.
type Cell = [Vector3<f64>; 6];

impl PowellSabinSurface {
    /// The deviation of [`Self::bezier_cells`] that serves pictures and files, over the diagonal.
    pub const CELL_TOLERANCE: f64 = 1e-6;

    /// Returns the surface as quadratic Bézier triangles: exactly where it is quadratic, so for
    /// all faces, six cells each, and minimal caps, but those along the rim of smooth caps and in the
    /// rings that they are blended over, which are no polynomials; their micro triangles are halved until quadratics through
    /// corners and middles of sides are within `tolerance` times the diagonal, five times at most.
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
        let (mut deviation, mut halvings) = (0.0_f64, 0);
        for faces in self.blended_groups() {
            let limit = tolerance * self.mesh().diagonal();
            let mut found = (Vec::new(), f64::INFINITY);
            let mut level = 0;
            while level <= DEEPEST && found.1 > limit {
                found = self.approximate(&faces, level);
                level += 1;
            }
            cells.extend(found.0);
            deviation = deviation.max(found.1 / self.mesh().diagonal());
            halvings = halvings.max(level - 1);
        }
        let in_order = |[p, q, r, pq, qr, pr]: Cell| [p, pq, q, pr, qr, r].map(Point3::from);
        let points = cells.into_iter().flat_map(in_order).collect();
        SurfaceCells {
            cells: BezierCells::build(CellShape::Triangles, [2, 0, 0], points, None)
                .expect("six points per cell"),
            exact,
            deviation,
            halvings,
        }
    }

    /// The smooth cap that covers a face.
    fn covering(&self, face: u32) -> Option<&SmoothCap> {
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

    /// Faces of smooth caps and of their rings; holes whose rings share a face are one group.
    fn blended_groups(&self) -> Vec<Vec<u32>> {
        let mut group: Vec<u32> = (0..self.caps().len() as u32).collect();
        let faces = 0..self.mesh().face_count() as u32;
        let regular = faces.filter(|&f| self.plain_face(f).is_some());
        let rings: Vec<(u32, u32)> = regular
            .filter_map(|face| {
                let mut owners = self.blends(face);
                let first = owners.next()?;
                for other in owners {
                    let (a, b) = (group[first as usize], group[other as usize]);
                    let joined = group.iter_mut().filter(|g| **g == a.max(b));
                    joined.for_each(|g| *g = a.min(b));
                }
                Some((face, first))
            })
            .collect();
        let mut groups = vec![Vec::new(); self.caps().len()];
        for (number, hole) in self.caps().iter().enumerate() {
            if let Cap::Smooth(cap) = hole.cap() {
                let bent = cap.covered_faces().filter(|&f| !cap.is_straight(f));
                groups[group[number] as usize].extend(bent);
            }
        }
        for (face, owner) in rings {
            groups[group[owner as usize] as usize].push(face);
        }
        groups.retain(|faces| !faces.is_empty());
        groups
    }

    /// Returns quadratics over faces whose micro triangles are halved so often, and their largest
    /// distance.
    fn approximate(&self, faces: &[u32], level: u32) -> (Vec<Cell>, f64) {
        let found: Vec<(Vec<Cell>, f64)> = faces
            .par_iter()
            .map(|&face| self.approximate_face(face, 1 << level))
            .collect();
        let deviation = found.iter().fold(0.0, |max: f64, part| max.max(part.1));
        let cells = found.into_iter().flat_map(|part| part.0);
        (cells.collect(), deviation)
    }

    fn approximate_face(&self, face: u32, pieces: u32) -> (Vec<Cell>, f64) {
        let triangle = self.cell_split(face);
        let mut deviation = 0.0_f64;
        let mut cells = Vec::new();
        for micro in 0..6 {
            let corners = triangle.micro_corners(micro);
            let value = |at: [f64; 3]| {
                let at = mix(&corners, at);
                self.jet(&SurfacePoint { face, at }, Order::Value).value
            };
            // Points of a grid of half steps, rows of the third corner outermost.
            let half = 2 * pieces;
            let place = |[second, third]: [u32; 2]| {
                let steps = [half - second - third, second, third];
                steps.map(|s| f64::from(s) / f64::from(half))
            };
            let rows = (0..=half).flat_map(|j| (0..=half - j).map(move |i| [i, j]));
            let grid: Vec<Vector3<f64>> = rows.map(|at| value(place(at))).collect();
            let known = |[i, j]: [u32; 2]| {
                // Rows of half + 1, half, ... points lie before.
                grid[(j * (half + 1) - j * j.saturating_sub(1) / 2 + i) as usize]
            };
            let mut push = |tail: [[u32; 2]; 3]| {
                let ends = tail.map(|t| known(t.map(|s| 2 * s)));
                let middle = |a: usize, b: usize| {
                    let at = [0, 1].map(|k| tail[a][k] + tail[b][k]);
                    2.0 * known(at) - 0.5 * (ends[a] + ends[b])
                };
                let [p, q, r] = ends;
                let cell = [p, q, r, middle(0, 1), middle(1, 2), middle(0, 2)];
                let at = tail.map(|t| place(t.map(|s| 2 * s)));
                for probe in PROBES {
                    let gap = quadratic(&cell, probe) - value(mix(&at, probe));
                    deviation = deviation.max(gap.norm());
                }
                cells.push(cell);
            };
            for j in 0..pieces {
                for i in 0..pieces - j {
                    push([[i, j], [i + 1, j], [i, j + 1]]);
                    if i + j + 2 <= pieces {
                        push([[i + 1, j + 1], [i, j + 1], [i + 1, j]]);
                    }
                }
            }
        }
        (cells, deviation)
    }

    /// Returns the split of a face that has pieces of the surface as its micro triangles, as far as
    /// there are straight ones.
    fn cell_split(&self, face: u32) -> MacroTriangle {
        if let Some(regular) = self.plain_face(face) {
            return self.regular().macro_triangle(regular);
        }
        let Some(cap) = self.covering(face) else {
            return MacroTriangle::new([[1.0, 0.0], [-1.0, 1.0], [0.0, -1.0]], [0.5; 3]);
        };
        let own = cap.split(face);
        let mut splits = own.splits();
        for (i, split) in splits.iter_mut().enumerate() {
            let twin = self.mesh().topology().twin(3 * face + i as u32);
            // Along the rim the cells beside are cut where the regular part is.
            let beside = if twin == NONE {
                None
            } else {
                self.plain_face(twin / 3)
            };
            if let Some(regular) = beside {
                *split = 1.0 - self.regular().macro_triangle(regular).splits()[(twin % 3) as usize];
            }
        }
        MacroTriangle::new(own.edges(), splits)
    }
}

fn mix(corners: &[[f64; 3]; 3], weights: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| (0..3).map(|k| weights[k] * corners[k][i]).sum())
}

fn quadratic([p, q, r, pq, qr, pr]: &Cell, [a, b, c]: [f64; 3]) -> Vector3<f64> {
    a * (a * p + 2.0 * b * pq) + b * (b * q + 2.0 * c * qr) + c * (c * r + 2.0 * a * pr)
}
