//! The chart around a zero of the form, in which it is a regular point.
//!
//! # Notation
//! `ζ = z - z0`, `n = m + 1` for a zero of order `m` and `-1` for a double pole; `w = ζ^(1 / n)`. Angles of
//! `ζ` are continued from vertex to vertex, so that all `n` sheets are told apart.
//!
//! A cap covers the hole, and mostly a ring of faces around it, because the nearer a straight side of `z`
//! passes by the zero, the more it bends in `w`.
//!
//! On a face the map is exact outside of what is covered: from any corner, `w = w_0 (ζ / ζ_0)^(1 / n)` with the
//! principal root, as no face contains `z0`. On covered faces it is linear, but for faces along the
//! rim: there a side from `a` to `b` follows the curve `q(t) = w(z)` of its straight counterpart, by
//!
//! ```text
//! w = b0 w0 + b1 wa + b2 wb + b1 b2 ε((1 + b2 - b1) / 2),     ε(t) = (q(t) - (1 - t) wa - t wb) / (t (1 - t))
//! ```
//!
//! in which `ε` is written so that nothing cancels: with `c = z_b - z_a` and the sums `h_k` of all
//! products of `k` factors, `ε = c (wb - wa) h_(n-2)(wa, q, wb) / (h_(n-1)(wa, q) h_(n-1)(q, wb))`, and
//! `ε = -c² wa q wb` for the pole.
//!
//! # Reference
//! [He2005] §3.3, which cuts zeros out; the chart `z^(1 / (m + 1))` is the standard one of a zero.

mod map;
#[cfg(test)]
mod tests;

use msplines_common::mesh::{NONE, Topology, TriangleMesh};
use msplines_conformal::Zero;
use nalgebra::{Complex, DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::error::NoSmoothCap;
use super::part::Part;
use crate::vector::cross;

/// Rounds in which the place of the zero is found.
const UPDATES: usize = 4;

/// How far `z` may miss closing around a face of the disk, relative to its side: a period is far more,
/// rounding far less.
const CLOSED: f64 = 1e-6;

/// Largest tangent of half an angle in a weight. Flips leave faces without area, whose largest angle is
/// straight; any positive weights give a chart.
const LARGEST_HALF_TANGENT: f64 = 1e3;

/// The chart over a hole and the rings of faces around it.
#[derive(Clone, Debug)]
pub(super) struct Chart {
    /// `n`.
    pub(super) power: i32,
    pub(super) part: Part,
    pub(super) mesh: TriangleMesh,
    pub(super) z0: Complex<f64>,
    /// By vertex of the part; nothing meaningful at a pole.
    pub(super) z: Vec<Complex<f64>>,
    /// By vertex of the part.
    pub(super) w: Vec<Complex<f64>>,
    /// Whether a face of the part is covered: in the hole, or in the rings around it that the cap takes.
    pub(super) covered: Vec<bool>,
    /// Vertices of the part with covered faces only.
    pub(super) inner: Vec<u32>,
    pub(super) reach: Reach,
}

/// How far a chart goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reach {
    /// Rings of faces around the hole that the cap covers like the hole itself.
    pub covered: u32,
    /// Rings of faces around the hole on which there is a chart.
    pub rings: u32,
}

fn complex([re, im]: [f64; 2]) -> Complex<f64> {
    Complex::new(re, im)
}

impl Chart {
    /// Returns the chart around a hole without places in it; faces of other holes stay out.
    pub(super) fn build(
        mesh: &TriangleMesh,
        form: &[[f64; 2]],
        in_hole: impl Fn(u32) -> bool,
        zero: &Zero,
        reach: Reach,
    ) -> Result<Self, NoSmoothCap> {
        // A disk has fewer rings than faces, whatever a file says.
        if reach.covered.max(reach.rings) as usize > mesh.face_count() {
            return Err(NoSmoothCap::NoDisk);
        }
        let part = disk(mesh, &in_hole, zero, reach.rings);
        let core = disk(mesh, &in_hole, zero, reach.covered);
        let local = part.mesh(mesh).map_err(|_| NoSmoothCap::NoDisk)?;
        let covered: Vec<bool> = part.faces.iter().map(|&f| core.face(f).is_some()).collect();
        let surrounded = |&v: &u32| {
            let mut around = mesh.topology().outgoing(v).map(|h| h / 3);
            around.all(|f| core.face(f).is_some())
        };
        let inner: Vec<u32> = core.vertices.iter().copied().filter(surrounded).collect();
        if inner.iter().any(|&v| mesh.topology().is_boundary_vertex(v)) {
            return Err(NoSmoothCap::NoDisk);
        }
        let mut chart = Self {
            power: if zero.order < 0 { -1 } else { zero.order + 1 },
            z0: Complex::default(),
            z: Vec::new(),
            w: Vec::new(),
            mesh: local,
            covered,
            inner: inner.iter().filter_map(|&v| part.vertex(v)).collect(),
            part,
            reach,
        };
        chart.develop(&chart.part.pick_sides(form), zero)?;
        Ok(chart)
    }

    /// Takes stored places of the zero and of the vertices.
    pub(super) fn set_places(&mut self, zero: [f64; 2], w: &[[f64; 2]]) -> Result<(), NoSmoothCap> {
        if w.len() != self.z.len() {
            return Err(NoSmoothCap::NoDisk);
        }
        self.z0 = complex(zero);
        self.w = w.iter().copied().map(complex).collect();
        Ok(())
    }

    /// Integrates the form over the disk, around a pole only outside of the hole.
    fn develop(&mut self, form: &[[f64; 2]], zero: &Zero) -> Result<(), NoSmoothCap> {
        let topology = self.mesh.topology();
        let usable = |h: u32| {
            let face = self.part.faces[(h / 3) as usize];
            zero.order >= 0 || zero.faces.binary_search(&face).is_err()
        };
        let sides = || (0..form.len() as u32).filter(|&h| usable(h));
        let mut z = vec![None; topology.vertex_count()];
        let start = sides().next().ok_or(NoSmoothCap::NoDisk)?;
        z[topology.origin(start) as usize] = Some(Complex::default());
        let mut queue = vec![topology.origin(start)];
        let mut next = 0;
        while next < queue.len() {
            let vertex = queue[next];
            next += 1;
            for h in topology.outgoing(vertex).filter(|&h| usable(h)) {
                // Both sides of the corner: the second one reaches what a boundary hides.
                let back = Topology::previous(h);
                for (other, side) in [
                    (topology.target(h), complex(form[h as usize])),
                    (topology.origin(back), -complex(form[back as usize])),
                ] {
                    if z[other as usize].is_none() {
                        z[other as usize] = z[vertex as usize].map(|at: Complex<f64>| at + side);
                        queue.push(other);
                    }
                }
            }
        }
        for h in sides() {
            let ends = [topology.origin(h), topology.target(h)].map(|v| z[v as usize]);
            let [Some(from), Some(to)] = ends else {
                return Err(NoSmoothCap::NoDisk);
            };
            let side = complex(form[h as usize]);
            if (to - from - side).norm() > CLOSED * side.norm() {
                return Err(NoSmoothCap::NoDisk);
            }
        }
        self.z = z.into_iter().map(Option::unwrap_or_default).collect();
        Ok(())
    }

    /// Finds `z0`, and `w` at all vertices.
    pub(super) fn place_zero(&mut self) -> Result<(), NoSmoothCap> {
        let centre = if self.power < 0 {
            self.rim()
        } else {
            self.inner.clone()
        };
        let mean = |values: &mut dyn Iterator<Item = Complex<f64>>| {
            values.sum::<Complex<f64>>() / centre.len() as f64
        };
        self.z0 = mean(&mut centre.iter().map(|&v| self.z[v as usize]));
        self.set_roots()?;
        let updates = if self.power < 0 { 0 } else { UPDATES };
        for _ in 0..updates {
            let rest = |&v: &u32| self.z[v as usize] - self.w[v as usize].powi(self.power);
            self.z0 = mean(&mut centre.iter().map(rest));
            self.set_roots()?;
        }
        Ok(())
    }

    /// Returns the vertices of covered faces that have others too, ascending.
    pub(super) fn rim(&self) -> Vec<u32> {
        let faces = self.mesh.faces().iter().zip(&self.covered);
        let corners = faces.filter(|(_, covered)| **covered);
        let mut rim: Vec<u32> = corners
            .flat_map(|(corners, _)| corners)
            .copied()
            .filter(|v| self.inner.binary_search(v).is_err())
            .collect();
        rim.sort_unstable();
        rim.dedup();
        rim
    }

    /// Returns the vertices of the mesh that covered faces have, some several times.
    pub(super) fn covered_vertices(&self) -> impl Iterator<Item = u32> + '_ {
        let faces = self.mesh.faces().iter().zip(&self.covered);
        let corners = faces.filter(|(_, covered)| **covered);
        corners.flat_map(|(corners, _)| corners.map(|v| self.part.vertices[v as usize]))
    }

    /// Takes the root at all vertices outside, and extends it to those inside by positive weights.
    fn set_roots(&mut self) -> Result<(), NoSmoothCap> {
        let angles = self.angles()?;
        let share = 1.0 / f64::from(self.power);
        let root = |(z, angle): (&Complex<f64>, &f64)| {
            Complex::from_polar((z - self.z0).norm().powf(share), angle * share)
        };
        self.w = self.z.iter().zip(&angles).map(root).collect();
        self.extend_inside();
        Ok(())
    }

    /// Returns the continued angles of `ζ` at the vertices outside.
    fn angles(&self) -> Result<Vec<f64>, NoSmoothCap> {
        let topology = self.mesh.topology();
        let zeta = |v: u32| self.z[v as usize] - self.z0;
        let step = |from: u32, to: u32| (zeta(to) / zeta(from)).arg();
        let outside = |h: u32| !self.covered[(h / 3) as usize];
        let sides = || (0..3 * topology.face_count() as u32).filter(|&h| outside(h));
        let mut angles = vec![f64::NAN; self.z.len()];
        let start = topology.origin(sides().next().ok_or(NoSmoothCap::NoDisk)?);
        angles[start as usize] = zeta(start).arg();
        // Marks apart: an angle may be no number, where the place of the zero is none.
        let mut reached = vec![false; self.z.len()];
        reached[start as usize] = true;
        let mut queue = vec![start];
        let mut next = 0;
        while next < queue.len() {
            let vertex = queue[next];
            next += 1;
            for h in topology.outgoing(vertex).filter(|&h| outside(h)) {
                for other in [topology.target(h), topology.origin(Topology::previous(h))] {
                    if !reached[other as usize] {
                        reached[other as usize] = true;
                        let near = angles[vertex as usize] + step(vertex, other);
                        let own = zeta(other).arg();
                        let turns = ((near - own) / std::f64::consts::TAU).round();
                        // The angle itself with whole turns: no rounding piles up along the way.
                        angles[other as usize] = own + std::f64::consts::TAU * turns;
                        queue.push(other);
                    }
                }
            }
        }
        let all_turns = std::f64::consts::TAU * f64::from(self.power.abs());
        let fits = |h: u32| {
            let (from, to) = (topology.origin(h), topology.target(h));
            let gap = angles[to as usize] - angles[from as usize] - step(from, to);
            (gap - all_turns * (gap / all_turns).round()).abs() < 1e-6
        };
        let around =
            |face: &[u32; 3]| -> f64 { (0..3).map(|i| step(face[i], face[(i + 1) % 3])).sum() };
        let faces = self.mesh.faces().iter().zip(&self.covered);
        let holds_zero = faces
            .filter(|(_, covered)| !**covered)
            .any(|(face, _)| around(face).abs() > 1.0);
        let reached = (0..angles.len() as u32)
            .all(|v| self.inner.binary_search(&v).is_ok() || angles[v as usize].is_finite());
        if reached && !holds_zero && sides().all(fits) {
            Ok(angles)
        } else {
            Err(NoSmoothCap::Folded)
        }
    }

    /// Gives inner vertices the mean of their neighbours, with the mean-value weights of the mesh.
    fn extend_inside(&mut self) {
        let inner = self.inner.clone();
        let count = inner.len();
        let place = |v: u32| inner.binary_search(&v).ok();
        let mut matrix = DMatrix::zeros(count, count);
        let (mut re, mut im) = (DVector::zeros(count), DVector::zeros(count));
        let topology = self.mesh.topology();
        for (row, &vertex) in inner.iter().enumerate() {
            for h in topology.outgoing(vertex) {
                let weight = mean_value_weight(&self.mesh, h);
                matrix[(row, row)] += weight;
                let other = topology.target(h);
                if let Some(column) = place(other) {
                    matrix[(row, column)] -= weight;
                } else {
                    re[row] += weight * self.w[other as usize].re;
                    im[row] += weight * self.w[other as usize].im;
                }
            }
        }
        let factors = matrix.lu();
        // A matrix that cannot be solved leaves folds, which are looked for.
        let (re, im) = (factors.solve(&re), factors.solve(&im));
        for (row, &vertex) in inner.iter().enumerate() {
            let at = |part: &Option<DVector<f64>>| part.as_ref().map_or(f64::NAN, |x| x[row]);
            self.w[vertex as usize] = Complex::new(at(&re), at(&im));
        }
    }

    /// Twice the area of a face in the chart.
    fn flat_area(&self, face: u32) -> f64 {
        let [a, b, c] = self.mesh.faces()[face as usize].map(|v| self.w[v as usize]);
        let (e, f) = (b - a, c - a);
        cross([e.re, e.im], [f.re, f.im])
    }

    /// Returns the vectors along the half-edges of the disk in the chart.
    pub(super) fn edge_vectors(&self) -> Vec<[f64; 2]> {
        let side = |face: &[u32; 3], i: usize| {
            let e = self.w[face[(i + 1) % 3] as usize] - self.w[face[i] as usize];
            [e.re, e.im]
        };
        let faces = self.mesh.faces().iter();
        faces
            .flat_map(|face| [0, 1, 2].map(|i| side(face, i)))
            .collect()
    }
}

/// Returns the faces of a hole and so many rings around it.
fn disk(mesh: &TriangleMesh, in_hole: &impl Fn(u32) -> bool, zero: &Zero, rings: u32) -> Part {
    let topology = mesh.topology();
    let mut faces = zero.faces.clone();
    for _ in 0..rings {
        let corners = faces.iter().flat_map(|&f| mesh.faces()[f as usize]);
        let around = corners.flat_map(|v| topology.outgoing(v).map(|h| h / 3));
        let mut more: Vec<u32> = around.filter(|&f| !in_hole(f)).collect();
        more.extend(&zero.faces);
        more.sort_unstable();
        more.dedup();
        faces = more;
    }
    Part::new(mesh, faces)
}

/// Returns the mean-value weight of a half-edge at its origin: `(tan(α / 2) + tan(β / 2)) / length`, with
/// the angles at the origin to both sides, straight ones a little less.
///
/// # Reference
/// [Floater2003].
fn mean_value_weight(mesh: &TriangleMesh, half_edge: u32) -> f64 {
    let topology = mesh.topology();
    let at = |v: u32| mesh.positions()[v as usize];
    let origin = at(topology.origin(half_edge));
    let side = at(topology.target(half_edge)) - origin;
    let length = side.norm();
    let half_tangent = |other: u32| {
        let arm = at(other) - origin;
        let angle = side.cross(&arm).norm().atan2(side.dot(&arm));
        (0.5 * angle).tan().min(LARGEST_HALF_TANGENT)
    };
    let mut sum = half_tangent(topology.target(Topology::next(half_edge)));
    let twin = topology.twin(half_edge);
    if twin != NONE {
        sum += half_tangent(topology.target(Topology::next(twin)));
    }
    sum / length
}
