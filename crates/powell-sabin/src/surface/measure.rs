//! How far a surface keeps what it promises.

use msplines_common::Vector3;
use msplines_common::evaluate::Order;
use msplines_common::mesh::{NONE, SurfacePoint, Topology};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::PowellSabinSurface;
use super::hole::Cap;
use crate::element::micro_ordinates;
use crate::fit::VertexCondition;
use crate::spline::Basis;

/// Splits of edges nearer to an end than this make thin micro triangles, over which differences of
/// Bézier points lose digits.
const THIN: f64 = 0.01;

/// Figures about a surface; every one is 0 or near rounding but `folded_samples`, which may count some.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SurfaceChecks {
    /// Largest distance from the position of a condition, over the diagonal, from every face at it.
    pub position_max: f64,
    /// Largest sine of the angle to the normal of a condition, from every face at it but those of minimal
    /// caps.
    pub normal_max: f64,
    /// Largest jump of the flat derivatives across edges of the regular part and micro edges, relative to
    /// them, where no micro triangle is thin.
    pub c1_jump_max: f64,
    /// The same at all edges.
    pub c1_jump_max_all: f64,
    /// Largest sine between the normals on both sides of the rims of smooth caps and of the outer edges
    /// of the rings that they are blended over.
    pub seam_max: f64,
    /// Largest distance of the sum of the basis functions from 1.
    pub unity_max: f64,
    /// Smallest Bézier ordinate of a basis function.
    pub basis_min: f64,
    /// Vertices with a normal that the surface passes inside out.
    pub orientation_violations: usize,
    /// Samples whose normal opposes that of the face of the mesh.
    pub folded_samples: usize,
    /// Samples taken.
    pub samples: usize,
}

/// Random numbers by the splitmix generator.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn below(&mut self, count: usize) -> u32 {
        ((self.next() * count as f64) as usize).min(count - 1) as u32
    }

    fn barycentric(&mut self) -> [f64; 3] {
        let (a, b) = (self.next(), self.next());
        let (a, b) = if a + b > 1.0 {
            (1.0 - a, 1.0 - b)
        } else {
            (a, b)
        };
        [1.0 - a - b, a, b]
    }
}

impl PowellSabinSurface {
    /// Returns figures about the surface, with `samples` points of a seeded generator for each of those
    /// that are taken at random.
    ///
    /// # Panics
    /// If there is not one condition per vertex of the mesh.
    #[must_use]
    pub fn measure(
        &self,
        conditions: &[VertexCondition],
        seed: u64,
        samples: usize,
    ) -> SurfaceChecks {
        let vertices = self.mesh().vertex_count();
        assert_eq!(conditions.len(), vertices, "one condition per vertex");
        let mut random = Random(seed);
        let [position_max, normal_max, violations] = self.misses(conditions);
        let [c1_jump_max, c1_jump_max_all] = self.jumps(&mut random, samples);
        let [unity_max, basis_min] = self.basis_figures();
        let seam_max = self.seams(&mut random, samples);
        let (folded_samples, samples) = self.folded(&mut random, samples);
        SurfaceChecks {
            position_max,
            normal_max,
            c1_jump_max,
            c1_jump_max_all,
            seam_max,
            unity_max,
            basis_min,
            orientation_violations: violations as usize,
            folded_samples,
            samples,
        }
    }

    /// Largest misses of positions and normals, and the number of vertices passed inside out.
    fn misses(&self, conditions: &[VertexCondition]) -> [f64; 3] {
        let diagonal = self.mesh().diagonal();
        let rows: Vec<[f64; 3]> = conditions
            .par_iter()
            .enumerate()
            .map(|(vertex, condition)| {
                let mut worst = [0.0_f64; 3];
                for h in self.mesh().topology().outgoing(vertex as u32) {
                    let mut at = [0.0; 3];
                    at[(h % 3) as usize] = 1.0;
                    let point = SurfacePoint { face: h / 3, at };
                    if self.is_open(point.face) || self.is_loose(vertex as u32) {
                        continue;
                    }
                    let jet = self.jet(&point, Order::First);
                    if let Some(position) = condition.position() {
                        let miss = (jet.value - position.coords).norm() / diagonal;
                        worst[0] = worst[0].max(miss);
                    }
                    // Minimal caps have an edge along their rim.
                    let smooth = self.is_smooth(point.face);
                    if let (true, VertexCondition::Interpolate { normal, .. }) = (smooth, condition)
                    {
                        let (due, own) = (normal.normalize(), self.normal(&point, &jet));
                        worst[1] = worst[1].max(due.cross(&own).norm());
                        worst[2] = worst[2].max(f64::from(u8::from(due.dot(&own) < 0.0)));
                    }
                }
                worst
            })
            .collect();
        rows.iter().fold([0.0; 3], |sum, row| {
            [sum[0].max(row[0]), sum[1].max(row[1]), sum[2] + row[2]]
        })
    }

    /// Whether nothing makes the surface pass through a vertex: one inside of a hole that is not filled
    /// smoothly.
    fn is_loose(&self, vertex: u32) -> bool {
        let inside = |hole: &&super::Hole| hole.vertices().contains(&vertex);
        let hole = self.caps().iter().find(inside);
        hole.is_some_and(|hole| !matches!(hole.cap(), Cap::Smooth(_)))
    }

    /// Largest relative jumps of the flat derivatives at good edges, and at all.
    fn jumps(&self, random: &mut Random, samples: usize) -> [f64; 2] {
        let domain = self.flat_domain();
        let (topology, splits) = (domain.topology(), domain.edge_splits());
        let mut worst = [0.0_f64; 2];
        for _ in 0..samples {
            let h = random.below(splits.len());
            let share = random.next();
            let twin = topology.twin(h);
            let plain =
                |h: u32| self.hole_of_face[self.regular_faces()[(h / 3) as usize] as usize] == NONE;
            if !plain(h) {
                continue;
            }
            let mut jump = self.micro_jump(h, share);
            if twin != NONE && plain(twin) {
                let [a, b] = [(h, share), (twin, 1.0 - share)].map(|(h, share)| {
                    let face = self.regular_faces()[(h / 3) as usize];
                    let point = on_edge(face, h % 3, share);
                    self.jet(&point, Order::First)
                });
                jump = jump.max(relative_jump(a.first, b.first));
            }
            let face = 3 * (h / 3) as usize;
            let thick = |h: usize| (THIN..=1.0 - THIN).contains(&splits[h]);
            if (face..face + 3).all(thick) {
                worst[0] = worst[0].max(jump);
            }
            worst[1] = worst[1].max(jump);
        }
        worst
    }

    /// The jump across the micro edge from the middle of a side of a regular face to its incentre, by
    /// the Bézier points of both sides, which share nothing but those on the edge.
    fn micro_jump(&self, half_edge: u32, share: f64) -> f64 {
        let (face, side) = (half_edge / 3, (half_edge % 3) as usize);
        let triangle = self.regular().macro_triangle(face);
        let ordinates = [0, 1, 2].map(|c| self.regular().ordinates(face, c));
        // Micro 2 i is (V, R, Z), micro 2 i + 1 is (R, V', Z).
        let slopes = [(2 * side, 1), (2 * side + 1, 0)].map(|(micro, split)| {
            let gradients = triangle.micro_gradients(micro);
            let mut at = [0.0; 3];
            (at[split], at[2]) = (1.0 - share, share);
            let [p, q, r, pq, qr, pr] = micro_ordinates(micro);
            let mut slope = [Vector3::zeros(); 2];
            for (c, b) in ordinates.iter().enumerate() {
                let middle = b[p];
                let rows = [[p, pq, pr], [pq, q, qr], [pr, qr, r]];
                for (row, gradient) in rows.into_iter().zip(gradients) {
                    let sum: f64 = row
                        .into_iter()
                        .zip(at)
                        .map(|(o, t)| t * (b[o] - middle))
                        .sum();
                    slope[0][c] += 2.0 * gradient[0] * sum;
                    slope[1][c] += 2.0 * gradient[1] * sum;
                }
            }
            slope
        });
        relative_jump(slopes[0], slopes[1])
    }

    fn seams(&self, random: &mut Random, samples: usize) -> f64 {
        let topology = self.mesh().topology();
        let seams: Vec<u32> = (0..3 * topology.face_count() as u32)
            .filter(|&h| self.is_seam(h))
            .collect();
        if seams.is_empty() {
            return 0.0;
        }
        let sine = |_| {
            let h = seams[random.below(seams.len()) as usize];
            let share = random.next();
            let twin = topology.twin(h);
            let points = [
                on_edge(h / 3, h % 3, share),
                on_edge(twin / 3, twin % 3, 1.0 - share),
            ];
            let [a, b] = points.map(|p| self.normal(&p, &self.jet(&p, Order::First)));
            a.cross(&b).norm().max(f64::from(u8::from(a.dot(&b) < 0.0)))
        };
        (0..samples).map(sine).fold(0.0, f64::max)
    }

    /// Whether a half-edge lies on the rim of a smooth cap, or on the outer edge of its blended ring.
    fn is_seam(&self, h: u32) -> bool {
        let twin = self.mesh().topology().twin(h);
        if twin == NONE {
            return false;
        }
        let regular = |h: u32| self.plain_face(h / 3).is_some();
        let blended = |h: u32| regular(h) && self.blends(h / 3).next().is_some();
        let covered = self.is_smooth(h / 3) && !regular(h);
        regular(twin) && (covered || blended(h) && !blended(twin))
    }

    /// Whether the surface is C1 across the sides of a face.
    fn is_smooth(&self, face: u32) -> bool {
        let hole = self.caps().get(self.hole_of_face[face as usize] as usize);
        hole.is_none_or(|hole| matches!(hole.cap(), Cap::Smooth(_)))
    }

    fn basis_figures(&self) -> [f64; 2] {
        let basis = Basis::new(self.flat_domain());
        let figures = |face: u32| {
            let ordinates = basis.ordinates(face);
            let least = ordinates
                .iter()
                .flatten()
                .fold(f64::INFINITY, |m, &b| m.min(b));
            let sum = |at: usize| ordinates.iter().map(|b| b[at]).sum::<f64>();
            let unity = (0..ordinates[0].len()).map(|at| (sum(at) - 1.0).abs());
            [unity.fold(0.0, f64::max), least]
        };
        let faces: Vec<[f64; 2]> = (0..self.regular_faces().len() as u32)
            .into_par_iter()
            .map(figures)
            .collect();
        faces.iter().fold([0.0, f64::INFINITY], |worst, own| {
            [worst[0].max(own[0]), worst[1].min(own[1])]
        })
    }

    /// Samples whose normal opposes the face, and all of them.
    fn folded(&self, random: &mut Random, samples: usize) -> (usize, usize) {
        let faces = self.mesh().face_count();
        let points: Vec<SurfacePoint> = (0..samples)
            .map(|_| SurfacePoint {
                face: random.below(faces),
                at: random.barycentric(),
            })
            .filter(|p| !self.is_open(p.face))
            .collect();
        let normals = self.sample_normals(&points);
        let opposed = points.iter().zip(&normals);
        let opposed = opposed.filter(|(p, n)| self.mesh().face_normal(p.face).dot(n) < 0.0);
        (opposed.count(), points.len())
    }
}

/// A point on side `side` of a face, at a share of the way along it.
fn on_edge(face: u32, side: u32, share: f64) -> SurfacePoint {
    let mut at = [0.0; 3];
    at[side as usize] = 1.0 - share;
    at[(Topology::next(side) % 3) as usize] = share;
    SurfacePoint { face, at }
}

fn relative_jump(a: [Vector3<f64>; 2], b: [Vector3<f64>; 2]) -> f64 {
    let size = |x: [Vector3<f64>; 2]| x[0].norm().hypot(x[1].norm());
    let gap = size([a[0] - b[0], a[1] - b[1]]);
    let length = size(a).max(size(b));
    if length > 0.0 { gap / length } else { 0.0 }
}
