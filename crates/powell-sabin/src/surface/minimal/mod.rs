//! Minimal caps: a surface of small area that spans a hole, with the rim of the spline as boundary.
//!
//! Faces along the rim are cut where the spline is, so that every piece of the rim is one quadratic. All
//! faces are then divided evenly into quadratic Bézier triangles, whose control points on the rim are
//! those of the subdivided curve. Inside they start as the harmonic image of a disk, and follow
//!
//! ```text
//! F' = argmin ½ ∫ <∇F', ∇F'> in the metric of F        area(F') ≤ E(F') ≤ E(F) = area(F)
//! ```
//!
//! until the area settles.
//!
//! # Reference
//! [He2005] §3.3, "Handling the singular points"; [Pinkall1993] for the iteration. Deviation: quadratic
//! elements instead of linear ones, so that the rim is matched exactly.

mod relax;
#[cfg(test)]
mod tests;

use msplines_common::Vector3;
use msplines_common::evaluate::Order;
use msplines_common::mesh::{Lattice, NONE, SurfacePoint, Topology, TriangleMesh};
use msplines_conformal::Zero;

use super::jet::Jet;
use super::part::Part;
use crate::spline::PowellSabinSpline;
pub(super) use relax::Relaxed;

/// Pieces into which each side of a face, or part of a side along the rim, is divided.
pub(super) const PIECES: u32 = 4;

/// A surface of small area over a hole.
#[derive(Clone, Debug)]
pub struct MinimalCap {
    layout: Layout,
    points: Vec<Vector3<f64>>,
}

/// How the faces of a hole are divided, and which control points belong to which cell.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    /// Faces of the hole, ascending.
    faces: Vec<u32>,
    /// For each face, the side along the rim and the share at which it is cut.
    cuts: Vec<Option<(usize, f64)>>,
    /// First base triangle of each face.
    firsts: Vec<u32>,
    /// Faces of the hole, cut along the rim.
    pub(super) base: Topology,
    /// Control points of the cells of each base triangle: `P, Q, R, PQ, QR, PR`.
    pub(super) cells: Vec<[u32; 6]>,
    /// Control points that lie on the rim, and where.
    pub(super) rim: Vec<(u32, Vector3<f64>)>,
    /// The place of every control point on a base triangle.
    pub(super) places: Vec<SurfacePoint>,
}

/// A piece of the rim: the Bézier points of its two quadratics, and where they meet.
struct Curve {
    points: [Vector3<f64>; 5],
    share: f64,
}

/// The regular part as caps see it.
pub(super) struct Rim<'a> {
    pub(super) mesh: &'a TriangleMesh,
    pub(super) regular: &'a PowellSabinSpline,
    pub(super) part: &'a Part,
}

impl Rim<'_> {
    /// Returns the curve along a half-edge of a face of a hole, if it is on its rim: that of the spline,
    /// or a straight one where the surface ends.
    fn curve(&self, half_edge: u32, in_hole: impl Fn(u32) -> bool) -> Option<Curve> {
        let topology = self.mesh.topology();
        let twin = topology.twin(half_edge);
        if twin == NONE {
            let ends = [topology.origin(half_edge), topology.target(half_edge)];
            let [a, b] = ends.map(|v| self.mesh.positions()[v as usize].coords);
            let points = [0.0, 0.25, 0.5, 0.75, 1.0].map(|t| a.lerp(&b, t));
            return Some(Curve { points, share: 0.5 });
        }
        if in_hole(twin / 3) {
            return None;
        }
        let face = self.part.face(twin / 3)?;
        let side = (twin % 3) as usize;
        let triangle = self.regular.macro_triangle(face);
        let ordinates = [0, 1, 2].map(|c| self.regular.ordinates(face, c));
        let next = (side + 1) % 3;
        // Corner, behind it, the cut, before the next corner, that corner: the way of the twin.
        let mut points = [side, 3 + side, 12 + side, 6 + side, next]
            .map(|at| Vector3::from(ordinates.map(|b| b[at])));
        points.reverse();
        Some(Curve {
            points,
            share: 1.0 - triangle.splits()[side],
        })
    }
}

/// Returns the polar form of a quadratic.
fn blossom(points: &[Vector3<f64>], s: f64, t: f64) -> Vector3<f64> {
    (1.0 - s) * (1.0 - t) * points[0]
        + (s * (1.0 - t) + t * (1.0 - s)) * points[1]
        + s * t * points[2]
}

impl Layout {
    pub(super) fn new(rim: &Rim<'_>, zero: &Zero) -> Option<Self> {
        let in_hole = |face: u32| zero.faces.binary_search(&face).is_ok();
        let part = Part::new(rim.mesh, zero.faces.clone());
        let (mut cuts, mut firsts) = (Vec::new(), Vec::new());
        let (mut faces, mut curves) = (Vec::new(), Vec::new());
        let mut count = part.vertices.len() as u32;
        for &face in &zero.faces {
            let corners = rim.mesh.faces()[face as usize].map(|v| part.vertex(v));
            let [Some(a), Some(b), Some(c)] = corners else {
                return None;
            };
            let corners = [a, b, c];
            let curve = (0..3).find_map(|side| {
                let curve = rim.curve(3 * face + side, in_hole)?;
                Some((side as usize, curve))
            });
            firsts.push(faces.len() as u32);
            let Some((side, curve)) = curve else {
                cuts.push(None);
                faces.push(corners);
                continue;
            };
            let [a, b, c] = [0, 1, 2].map(|i| corners[(side + i) % 3]);
            cuts.push(Some((side, curve.share)));
            curves.push((3 * faces.len() as u32, curve.points[..3].to_vec()));
            faces.push([a, count, c]);
            curves.push((3 * faces.len() as u32, curve.points[2..].to_vec()));
            faces.push([count, b, c]);
            count += 1;
        }
        let base = Topology::build(count as usize, faces).ok()?;
        let lattice = Lattice::new(&base, 2 * PIECES);
        let along = |&(side, ref points): &(u32, Vec<Vector3<f64>>)| {
            let points = points.clone();
            let (first, at) = (side / 3, lattice_counts);
            let place = |k: u32| lattice.index(first, at(side % 3, k));
            let pieces = 0..=2 * PIECES;
            pieces
                .map(|k| {
                    let piece = |k: u32| f64::from(k) / f64::from(PIECES);
                    (
                        place(k),
                        blossom(&points, piece(k / 2), piece(k.div_ceil(2))),
                    )
                })
                .collect::<Vec<_>>()
        };
        let mut on_rim: Vec<(u32, Vector3<f64>)> = curves.iter().flat_map(along).collect();
        on_rim.sort_by_key(|&(place, _)| place);
        on_rim.dedup_by_key(|&mut (place, _)| place);
        Some(Self {
            faces: zero.faces.clone(),
            cuts,
            firsts,
            cells: cells(&base, &lattice),
            rim: on_rim,
            places: lattice.points.clone(),
            base,
        })
    }
}

/// The steps from the corners of a lattice point on a side.
fn lattice_counts(side: u32, k: u32) -> [u32; 3] {
    let mut counts = [0; 3];
    counts[side as usize] = 2 * PIECES - k;
    counts[(side as usize + 1) % 3] = k;
    counts
}

/// The cells of each base triangle, rows of the third corner outermost: upright ones first, then those
/// upside down.
fn cells(base: &Topology, lattice: &Lattice<'_>) -> Vec<[u32; 6]> {
    let mut cells = Vec::new();
    for face in 0..base.face_count() as u32 {
        for [i, j, down] in cell_places() {
            let corners = if down == 0 {
                [[i, j], [i + 1, j], [i, j + 1]]
            } else {
                [[i + 1, j + 1], [i, j + 1], [i + 1, j]]
            };
            let between = |a: usize, b: usize| {
                let [second, third] = [0, 1].map(|k| corners[a][k] + corners[b][k]);
                lattice.index(face, [2 * PIECES - second - third, second, third])
            };
            cells
                .push([(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)].map(|(a, b)| between(a, b)));
        }
    }
    cells
}

/// Steps of the first corner along both sides, and whether the cell is upside down.
fn cell_places() -> impl Iterator<Item = [u32; 3]> {
    let up = (0..PIECES).flat_map(|j| (0..PIECES - j).map(move |i| [i, j, 0]));
    let down = (1..PIECES).flat_map(|j| (0..PIECES - j).map(move |i| [i, j - 1, 1]));
    up.chain(down)
}

/// Cells of a base triangle.
const CELLS: usize = (PIECES * PIECES) as usize;

impl MinimalCap {
    /// Returns a surface of small area that spans a hole, and how it was found; nothing if its faces are
    /// no disk.
    pub(super) fn span(rim: &Rim<'_>, zero: &Zero) -> Option<(Self, Relaxed)> {
        let layout = Layout::new(rim, zero)?;
        let (points, relaxed) = relax::relax(&layout)?;
        Some((Self { layout, points }, relaxed))
    }

    /// Returns the surface of stored control points.
    pub(super) fn restore(rim: &Rim<'_>, zero: &Zero, points: &[[f64; 3]]) -> Option<Self> {
        let layout = Layout::new(rim, zero)?;
        let fits = points.len() == layout.places.len();
        fits.then(|| Self {
            layout,
            points: points.iter().copied().map(Vector3::from).collect(),
        })
    }

    /// Returns all control points.
    #[must_use]
    pub fn points(&self) -> &[Vector3<f64>] {
        &self.points
    }

    /// Returns the number of control points that are not given by the rim.
    #[must_use]
    pub fn free_points(&self) -> usize {
        self.points.len() - self.layout.rim.len()
    }

    /// Returns the cells over a face: the control points `P, Q, R, PQ, QR, PR` of each.
    pub(super) fn cells(&self, face: u32) -> impl Iterator<Item = [Vector3<f64>; 6]> + '_ {
        let at = self.layout.faces.binary_search(&face).unwrap_or_default();
        let first = self.layout.firsts[at] as usize;
        let count = if self.layout.cuts[at].is_some() { 2 } else { 1 };
        let cells = &self.layout.cells[CELLS * first..][..CELLS * count];
        cells
            .iter()
            .map(|cell| cell.map(|p| self.points[p as usize]))
    }

    /// Returns the surface at a point of the hole, by the second and third barycentric coordinate.
    pub(super) fn jet(&self, face: u32, at: [f64; 3], order: Order) -> Jet {
        let place = self.layout.faces.binary_search(&face).unwrap_or_default();
        let (base, in_base, change) = self.layout.in_base(place, at);
        let n = f64::from(PIECES);
        let steps = [in_base[1] * n, in_base[2] * n];
        let mut corner = steps.map(|s| s.floor().clamp(0.0, n - 1.0) as u32);
        // At the far side rounding may leave the triangle.
        corner[1] = corner[1].min(PIECES - 1 - corner[0]);
        let [x, y] = [0, 1].map(|k| steps[k] - f64::from(corner[k]));
        let down = x + y > 1.0 && corner[0] + corner[1] + 2 <= PIECES;
        let local = if down {
            [x + y - 1.0, 1.0 - x, 1.0 - y]
        } else {
            [1.0 - x - y, x, y]
        };
        let number = cell_number(corner, down);
        let cell = self.layout.cells[CELLS * base + number].map(|p| self.points[p as usize]);
        let scale = if down { -n } else { n };
        let jet = quadratic(&cell, local);
        if order == Order::Value {
            return jet;
        }
        jet.changed(change.map(|row| row.map(|c| scale * c)))
    }
}

/// Returns the number of a cell in the order of [`cell_places`].
fn cell_number([i, j]: [u32; 2], down: bool) -> usize {
    let n = PIECES;
    let number = if down {
        // Rows of n - 1, n - 2, ... cells.
        n * (n + 1) / 2 + j * (n - 1) - j * j.saturating_sub(1) / 2 + i
    } else {
        j * n - j * j.saturating_sub(1) / 2 + i
    };
    number as usize
}

/// Returns a quadratic Bézier triangle at a point, by its second and third barycentric coordinate.
fn quadratic([p, q, r, pq, qr, pr]: &[Vector3<f64>; 6], [a, b, c]: [f64; 3]) -> Jet {
    let by = [
        a * p + b * pq + c * pr,
        a * pq + b * q + c * qr,
        a * pr + b * qr + c * r,
    ];
    Jet {
        value: a * by[0] + b * by[1] + c * by[2],
        first: [2.0 * (by[1] - by[0]), 2.0 * (by[2] - by[0])],
        second: [
            2.0 * (p - 2.0 * pq + q),
            2.0 * (p - pq - pr + qr),
            2.0 * (p - 2.0 * pr + r),
        ],
    }
}

impl Layout {
    /// Returns the base triangle of a point of a face, its coordinates there, and their derivatives by
    /// the second and third coordinate of the face: `[by second, by third][second, third of the base]`.
    fn in_base(&self, place: usize, at: [f64; 3]) -> (usize, [f64; 3], [[f64; 2]; 2]) {
        let first = self.firsts[place] as usize;
        let Some((side, share)) = self.cuts[place] else {
            return (first, at, [[1.0, 0.0], [0.0, 1.0]]);
        };
        let [a, b, c] = [0, 1, 2].map(|i| (side + i) % 3);
        let tail = at[b] * (1.0 - share) <= at[a] * share;
        // Coordinates of the base triangle as rows over those of the face.
        let mut rows = [[0.0; 3]; 3];
        rows[2][c] = 1.0;
        if tail {
            rows[1][b] = 1.0 / share;
            rows[0][a] = 1.0;
            rows[0][b] = -(1.0 - share) / share;
        } else {
            rows[0][a] = 1.0 / (1.0 - share);
            rows[1][b] = 1.0;
            rows[1][a] = -share / (1.0 - share);
        }
        let value = rows.map(|row| row[0] * at[0] + row[1] * at[1] + row[2] * at[2]);
        let change = [1, 2].map(|k| [1, 2].map(|row: usize| rows[row][k] - rows[row][0]));
        (first + usize::from(!tail), value, change)
    }
}
