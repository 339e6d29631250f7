//! How far a surface is from being smooth, from one-sided limits.
//!
//! # Notation
//! Across a line, `d(h)` is the difference of a derivative at distance `h` on both sides; of `d(h)`,
//! `d(2h)` and `d(4h)` that part is taken that is neither linear nor quadratic in `h`: a jump.
//!
//! # Reference
//! [He2006] §3.3.

use msplines_common::Vector3;
use msplines_common::evaluate::Order;
use nalgebra::Complex;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::{Deserialize, Serialize};

use super::lines::{Circle, Crossing, around, circles, edges, junctions, rays};
use crate::caps::core_of;
use crate::complex::Point;
use crate::spline::TSpline;

/// Points from which the sizes of derivatives are known.
const TYPICAL: usize = 10_000;
/// How far from its centre a cap is looked at, over its core.
const IN_CORE: f64 = 0.9;

/// How many points are looked at, and which.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ContinuityOptions {
    /// On each of two sides of every leaf.
    pub per_edge: usize,
    /// On every line from a zero, and on every half circle around one.
    pub per_line: usize,
    /// Of the random numbers.
    pub seed: u64,
}

impl Default for ContinuityOptions {
    fn default() -> Self {
        Self {
            per_edge: 2,
            per_line: 64,
            seed: 0,
        }
    }
}

/// The largest jumps over lines of one kind: of the surface and its derivatives by `x` and `y`, each over
/// its own root mean square on the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Jumps {
    /// Crossings that were looked at.
    pub crossings: usize,
    /// Of points.
    pub value: f64,
    /// Of first derivatives.
    pub first: f64,
    /// Of second derivatives; at centres there is none, as polynomials in `w` have no sides.
    pub second: Option<f64>,
}

/// How smooth a surface is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Continuity {
    /// Over borders of cylinders: the critical lines of the form. This and the next three outside of cores.
    pub borders: Jumps,
    /// Over sides of leaves within cylinders.
    pub edges: Jumps,
    /// Over vertical lines through zeros.
    pub rays: Jumps,
    /// At T-junctions.
    pub t_junctions: Jumps,
    /// Over borders of caps.
    pub cap_borders: Jumps,
    /// Over borders of their cores.
    pub core_borders: Jumps,
    /// At their centres, between limits along rays from all sheets: of points, and of derivatives by `w`
    /// over the largest of them.
    pub centres: Jumps,
}

impl Continuity {
    /// Returns the largest relative jump up to second derivatives over all lines but those of caps.
    #[must_use]
    pub fn c2_jump(&self) -> f64 {
        let lines = [self.borders, self.edges, self.rays, self.t_junctions];
        lines.iter().map(Jumps::c2).fold(0.0, f64::max)
    }

    /// Returns the largest relative jump up to first derivatives at borders, cores and centres of caps.
    #[must_use]
    pub fn cap_c1_jump(&self) -> f64 {
        let lines = [self.cap_borders, self.core_borders, self.centres];
        lines.iter().map(Jumps::c1).fold(0.0, f64::max)
    }

    /// Returns the largest relative jump up to second derivatives at borders and cores of caps.
    #[must_use]
    pub fn cap_c2_jump(&self) -> f64 {
        self.cap_borders.c2().max(self.core_borders.c2())
    }
}

impl Jumps {
    /// Returns the largest of points and first derivatives.
    #[must_use]
    pub fn c1(&self) -> f64 {
        self.value.max(self.first)
    }

    /// Returns the largest of all.
    #[must_use]
    pub fn c2(&self) -> f64 {
        self.c1().max(self.second.unwrap_or(0.0))
    }
}

/// Returns how smooth a surface is: at random points on every kind of line that it crosses. The cost is
/// that of six evaluations of second derivatives per crossing.
///
/// # Reference
/// [He2006] §3.3. Deviation: here it is measured.
#[must_use]
pub fn continuity(spline: &TSpline, options: &ContinuityOptions) -> Continuity {
    let mut random = Pcg64Mcg::seed_from_u64(options.seed);
    let (space, each) = (spline.space(), options.per_line);
    let mesh = space.mesh();
    let measured = Measured {
        spline,
        typical: typical(spline, &mut random),
    };
    let outside = |mut crossings: Vec<Crossing>| {
        crossings.retain(|c| !in_core(spline, c.at));
        measured.jumps(&crossings)
    };
    let [borders, inside] = edges(mesh, options.per_edge, &mut random);
    Continuity {
        borders: outside(borders),
        edges: outside(inside),
        rays: outside(rays(mesh, each, &mut random)),
        t_junctions: outside(junctions(mesh, &mesh.t_junctions())),
        cap_borders: measured.jumps(&circles(space, Circle::Border, each, &mut random)),
        core_borders: measured.jumps(&circles(space, Circle::Core, each, &mut random)),
        centres: measured.centres(each, &mut random),
    }
}

fn in_core(spline: &TSpline, at: Point) -> bool {
    let cap = spline.space().caps().at(at);
    cap.is_some_and(|cap| cap.rest.0[0] <= 0.0)
}

/// A point, then all its derivatives.
type JetOf = [Vector3<f64>; 6];
/// Where first and second derivatives stand among them.
const ORDERS: [std::ops::Range<usize>; 3] = [0..1, 1..3, 3..6];

fn jets(spline: &TSpline, points: &[Point]) -> Vec<JetOf> {
    let s = spline.evaluate(points, Order::Second);
    let jet = |i: usize| {
        let ([x, y], [xx, xy, yy]) = (s.first[i], s.second[i]);
        [s.positions[i].coords, x, y, xx, xy, yy]
    };
    (0..points.len()).map(jet).collect()
}

/// Returns the norm of all derivatives of each order.
fn sizes(jet: &JetOf) -> [f64; 3] {
    ORDERS.map(|range| {
        let squares = jet[range].iter().map(Vector3::norm_squared);
        squares.sum::<f64>().sqrt()
    })
}

/// Returns the root mean square of each order over the surface outside of cores, that of points from
/// their mean.
fn typical(spline: &TSpline, random: &mut Pcg64Mcg) -> [f64; 3] {
    let complex = spline.space().mesh().complex();
    let area = complex.area() as f64;
    let mut points = Vec::with_capacity(TYPICAL);
    for (cylinder, own) in (0..).zip(complex.cylinders()) {
        let [c, h] = [own.circumference, own.height].map(|n| n as f64);
        let count = (TYPICAL as f64 * c * h / area).ceil() as usize;
        points.extend((0..count).map(|_| Point {
            cylinder,
            x: c * random.random::<f64>(),
            y: h * random.random::<f64>(),
        }));
    }
    points.retain(|&p| !in_core(spline, p));
    let mut found = jets(spline, &points);
    let count = found.len().max(1) as f64;
    let mean = found.iter().map(|jet| jet[0]).sum::<Vector3<f64>>() / count;
    let mut squares = [0.0; 3];
    for jet in &mut found {
        jet[0] -= mean;
        let all = sizes(jet);
        (0..3).for_each(|k| squares[k] += all[k] * all[k]);
    }
    squares.map(|sum| (sum / count).sqrt())
}

/// Returns the jump of differences at one, two and four steps.
fn jump([near, far, farther]: [Vector3<f64>; 3]) -> Vector3<f64> {
    (8.0 * near - 6.0 * far + farther) / 3.0
}

/// Returns a jump over a size; a surface of size 0 has none but 0.
fn relative(jump: f64, size: f64) -> f64 {
    if jump > 0.0 { jump / size } else { 0.0 }
}

struct Measured<'a> {
    spline: &'a TSpline,
    typical: [f64; 3],
}

impl Measured<'_> {
    fn jumps(&self, crossings: &[Crossing]) -> Jumps {
        let complex = self.spline.space().mesh().complex();
        let side = |times: f64| {
            let moved = |c: &Crossing| complex.walk(c.at, c.step.map(|s| times * s)).0;
            jets(
                self.spline,
                &crossings.iter().map(moved).collect::<Vec<_>>(),
            )
        };
        let sides = [1.0, 2.0, 4.0].map(|times| [side(times), side(-times)]);
        let mut largest = [0.0_f64; 3];
        for i in 0..crossings.len() {
            let jump: JetOf = std::array::from_fn(|d| {
                jump([0, 1, 2].map(|k| {
                    let [there, back] = &sides[k];
                    there[i][d] - back[i][d]
                }))
            });
            let jump = sizes(&jump);
            (0..3).for_each(|k| largest[k] = largest[k].max(jump[k]));
        }
        let [value, first, second] = [0, 1, 2].map(|k| relative(largest[k], self.typical[k]));
        Jumps {
            crossings: crossings.len(),
            value,
            first,
            second: Some(second),
        }
    }

    /// Between limits at the centres of caps along rays.
    fn centres(&self, each: usize, random: &mut Pcg64Mcg) -> Jumps {
        let mut found = Jumps::default();
        let space = self.spline.space();
        for cap in 0..space.caps().caps().len() as u32 {
            let limits = self.limits(cap, each, random);
            let count = limits.len().max(1) as f64;
            let mean = limits
                .iter()
                .fold(Limit::default(), |sum, l| sum.plus(l, 1.0 / count));
            let size = limits.iter().map(|l| l.slope()).fold(0.0, f64::max);
            for limit in &limits {
                let off = limit.plus(&mean, -1.0);
                found.value = found.value.max(relative(off.point.norm(), self.typical[0]));
                found.first = found.first.max(relative(off.slope(), size));
            }
            found.crossings += limits.len();
        }
        found
    }

    /// Limits of points and derivatives by `w` along rays to the centre of a cap. On them these are
    /// polynomials of at most its degree, of which as many values and one give that at zero, whatever the
    /// distance: near a zero coordinates have few digits.
    fn limits(&self, cap: u32, each: usize, random: &mut Pcg64Mcg) -> Vec<Limit> {
        let space = self.spline.space();
        let own = space.caps().caps()[cap as usize];
        let nodes = usize::from(own.degree) + 1;
        let near = IN_CORE * core_of(own.kind) / nodes as f64;
        let start = random.clone();
        let mut limits: Vec<Limit> = Vec::new();
        // Binomial coefficients of alternating sign extrapolate from 1, .., n to 0.
        let mut factor = -1.0;
        for k in 1..=nodes {
            factor *= -((nodes + 1 - k) as f64) / k as f64;
            // The same angles at every distance.
            *random = start.clone();
            let size = near * k as f64;
            let places = around(space, cap, size, each, random).into_iter();
            let points: Vec<Point> = places.map(|(at, _)| at).collect();
            limits.resize(points.len(), Limit::default());
            for (i, jet) in jets(self.spline, &points).iter().enumerate() {
                let Some(here) = space.caps().at(points[i]) else {
                    continue;
                };
                let by_w = [0, 1, 2].map(|c| Complex::new(jet[1][c], -jet[2][c]) / here.dw[0]);
                limits[i] = limits[i].plus(
                    &Limit {
                        point: jet[0],
                        by_w,
                    },
                    factor,
                );
            }
        }
        limits
    }
}

/// A point, and twice the derivative by `w` as a complex number per coordinate: `F_u - i F_v`.
#[derive(Clone, Copy, Debug, Default)]
struct Limit {
    point: Vector3<f64>,
    by_w: [Complex<f64>; 3],
}

impl Limit {
    fn plus(&self, other: &Self, times: f64) -> Self {
        Self {
            point: self.point + other.point * times,
            by_w: [0, 1, 2].map(|c| self.by_w[c] + other.by_w[c] * times),
        }
    }

    fn slope(&self) -> f64 {
        self.by_w.iter().map(|c| c.norm_sqr()).sum::<f64>().sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_jumps_are_left_of_differences() {
        let [size, linear, quadratic] = [0.25, -3.0, 1.5].map(|x| Vector3::new(x, 2.0 * x, -x));
        let at = |h: f64| size + linear * h + quadratic * h * h;
        let found = jump([1.0, 2.0, 4.0].map(|h| at(h * 0.1)));
        assert!((found - size).norm() < 1e-14, "{found}");
    }
}
