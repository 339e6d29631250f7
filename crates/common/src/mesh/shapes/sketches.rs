//! Curve networks as one would sketch them: a mushroom, and a dome like a helmet.

use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, TAU};

use nalgebra::{Point3, Vector3};

use super::networks::KnownNetwork;
use crate::mesh::curves::{Curve, CurveNetwork};

/// Segments of a meridian between two parallels, and of a parallel between two meridians.
const STEPS: u32 = 6;

/// Whether a sketched surface has an opening.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Opening {
    /// It is closed.
    Closed,
    /// It has one opening at its foot.
    Open,
}

/// Returns a mushroom, a surface of revolution about the z axis: meridians from the top of its cap to
/// its foot, and parallels, of which the rim of the cap is a crease. Triangles lie around the top, and
/// around the middle of the foot if that is closed; all other patches are quads.
///
/// # Panics
/// If there are fewer than three meridians.
#[must_use]
pub fn mushroom_network(meridians: u32, opening: Opening) -> KnownNetwork {
    assert!(meridians >= 3, "a mushroom has at least three meridians");
    let mut builder = Revolution {
        meridians,
        points: vec![Point3::new(0.0, 0.0, 1.0)],
    };
    // Rings of points around the axis after the top; every STEPS-th is a parallel.
    let rings = 5 * STEPS;
    for ring in 1..=rings {
        builder.ring(profile(f64::from(ring) / f64::from(STEPS)));
    }
    if opening == Opening::Closed {
        for step in 1..STEPS {
            let [r, z] = profile(5.0);
            builder.ring([r * f64::from(STEPS - step) / f64::from(STEPS), z]);
        }
        builder.points.push(Point3::new(0.0, 0.0, profile(5.0)[1]));
    }
    let bottom = builder.points.len() as u32 - 1;
    let closed = opening == Opening::Closed;
    let turn = meridians * STEPS;
    let mut curves = Vec::new();
    for m in 0..meridians {
        let down = (1..=if closed { rings + STEPS - 1 } else { rings })
            .map(|ring| builder.at(ring, m * STEPS));
        let end = closed.then_some(bottom);
        curves.push(Curve::smooth(
            std::iter::once(0).chain(down).chain(end).collect(),
        ));
    }
    for parallel in 1..=5 {
        let around = (0..=turn)
            .map(|i| builder.at(parallel * STEPS, i))
            .collect();
        // The rim turns under the cap; the foot of a closed mushroom turns to its bottom.
        let sharp = parallel == 2 || (parallel == 5 && closed);
        curves.push(if sharp {
            Curve::crease(around)
        } else {
            Curve::smooth(around)
        });
    }
    let (patches, openings) = builder.patches(closed.then_some(bottom));
    KnownNetwork {
        network: CurveNetwork::build(builder.points, curves).expect("rings are curves"),
        patches,
        openings,
    }
}

/// Returns radius and height of a mushroom: over [0, 2] its cap, to 3 under it, to 5 its stem.
fn profile(t: f64) -> [f64; 2] {
    if t <= 2.0 {
        let angle = FRAC_PI_4 * t;
        [angle.sin(), angle.cos()]
    } else if t <= 3.0 {
        let s = t - 2.0;
        [1.0 - 0.65 * s, -0.12 * (std::f64::consts::PI * s).sin()]
    } else {
        let s = (t - 3.0) / 2.0;
        [0.35 - 0.1 * (FRAC_PI_2 * s).sin() + 0.15 * s * s, -1.2 * s]
    }
}

/// Rings of points around the z axis; point 0 is on the axis.
struct Revolution {
    meridians: u32,
    points: Vec<Point3<f64>>,
}

impl Revolution {
    fn ring(&mut self, [radius, height]: [f64; 2]) {
        let turn = self.meridians * STEPS;
        let at = |i: u32| {
            let angle = TAU * f64::from(i) / f64::from(turn);
            Point3::new(radius * angle.cos(), radius * angle.sin(), height)
        };
        self.points.extend((0..turn).map(at));
    }

    fn at(&self, ring: u32, place: u32) -> u32 {
        let turn = self.meridians * STEPS;
        1 + (ring - 1) * turn + place % turn
    }

    fn patches(&self, bottom: Option<u32>) -> (Vec<Vec<u32>>, Vec<Vec<u32>>) {
        let at = |parallel: u32, m: u32| self.at(parallel * STEPS, m * STEPS);
        let mut patches = Vec::new();
        for m in 0..self.meridians {
            patches.push(vec![0, at(1, m), at(1, m + 1)]);
            for p in 1..5 {
                patches.push(vec![at(p, m), at(p + 1, m), at(p + 1, m + 1), at(p, m + 1)]);
            }
            patches.extend(bottom.map(|bottom| vec![at(5, m), bottom, at(5, m + 1)]));
        }
        let loops = (0..self.meridians).rev().map(|m| at(5, m)).collect();
        let openings = if bottom.is_none() {
            vec![loops]
        } else {
            Vec::new()
        };
        (patches, openings)
    }
}

/// Returns a dome like a helmet: the upper half of an ellipsoid, with `size` by `size` quads on top and
/// half as many rows around, open below, with a crease over its middle from front to back.
///
/// # Panics
/// If `size` is odd or zero.
#[must_use]
pub fn dome_network(size: u32) -> KnownNetwork {
    assert!(size > 0 && size.is_multiple_of(2), "a dome has a middle");
    let mut dome = Dome::new(i64::from(size * STEPS));
    let mut curves = Vec::new();
    for (keys, crease) in dome.lines() {
        let points = keys.into_iter().map(|key| dome.id(key)).collect();
        curves.push(if crease {
            Curve::crease(points)
        } else {
            Curve::smooth(points)
        });
    }
    let cells = dome.cells().into_iter();
    let patches = cells.map(|cell| cell.map(|key| dome.id(key)).to_vec());
    let patches = patches.collect();
    let mut opening = dome.belt(dome.low);
    // Its last point is its first; the opening lies on the other side.
    opening.pop();
    opening.reverse();
    opening.rotate_right(1);
    let opening = opening.into_iter().step_by(STEPS as usize);
    let openings = vec![opening.map(|key| dome.id(key)).collect()];
    KnownNetwork {
        network: CurveNetwork::build(dome.points, curves).expect("arches are curves"),
        patches,
        openings,
    }
}

/// Points on the upper half of the cube `[0, n]³`, blown up to an ellipsoid.
struct Dome {
    n: i64,
    low: i64,
    ids: BTreeMap<[i64; 3], u32>,
    points: Vec<Point3<f64>>,
}

impl Dome {
    fn new(n: i64) -> Self {
        Self {
            n,
            low: n / 2,
            ids: BTreeMap::new(),
            points: Vec::new(),
        }
    }

    fn id(&mut self, key: [i64; 3]) -> u32 {
        // Equal angles instead of equal lengths make even quads; edges of the cube stay in place.
        let t = key.map(|i| (FRAC_PI_4 * (2.0 * i as f64 / self.n as f64 - 1.0)).tan());
        let points = &mut self.points;
        *self.ids.entry(key).or_insert_with(|| {
            let p = Vector3::from(t).normalize();
            points.push(Point3::new(p.x, 1.3 * p.y, 0.9 * p.z));
            points.len() as u32 - 1
        })
    }

    /// Returns the line around the dome at height `k`, closed.
    fn belt(&self, k: i64) -> Vec<[i64; 3]> {
        let n = self.n;
        let front = (0..n).map(|i| [i, 0, k]);
        let right = (0..n).map(|j| [n, j, k]);
        let back = (0..n).map(|i| [n - i, n, k]);
        let left = (0..=n).map(|j| [0, n - j, k]);
        front.chain(right).chain(back).chain(left).collect()
    }

    /// Returns the line over the dome in one direction.
    fn arch(&self, place: impl Fn(i64, i64) -> [i64; 3]) -> Vec<[i64; 3]> {
        let (n, low) = (self.n, self.low);
        let up = (low..n).map(|k| place(0, k));
        let over = (0..=n).map(|i| place(i, n));
        let down = (low..n).rev().map(|k| place(n, k));
        up.chain(over).chain(down).collect()
    }

    /// Returns all curves, and whether each is a crease.
    fn lines(&self) -> Vec<(Vec<[i64; 3]>, bool)> {
        let (n, step) = (self.n, STEPS as usize);
        let mut lines = Vec::new();
        for c in (0..n).step_by(step).skip(1) {
            lines.push((self.arch(|i, k| [i, c, k]), false));
            lines.push((self.arch(|i, k| [c, i, k]), 2 * c == n));
        }
        for k in (self.low..n).step_by(step) {
            lines.push((self.belt(k), false));
        }
        // Three patches meet at a corner of the cube, where its edges end.
        let top = self.belt(n);
        for side in 0..4 {
            let from = side * n as usize;
            lines.push((top[from..=from + n as usize].to_vec(), false));
        }
        for [i, j] in [[0, 0], [n, 0], [n, n], [0, n]] {
            lines.push(((self.low..=n).map(|k| [i, j, k]).collect(), false));
        }
        lines
    }

    /// Returns the corners of all quads, counter-clockwise seen from outside.
    fn cells(&self) -> Vec<[[i64; 3]; 4]> {
        let (n, step) = (self.n, i64::from(STEPS));
        let mut cells = Vec::new();
        for a in (0..n).step_by(STEPS as usize) {
            let b = a + step;
            for c in (0..n).step_by(STEPS as usize) {
                let d = c + step;
                cells.push([[a, c, n], [b, c, n], [b, d, n], [a, d, n]]);
            }
            for k in (self.low..n).step_by(STEPS as usize) {
                let l = k + step;
                cells.push([[a, 0, k], [b, 0, k], [b, 0, l], [a, 0, l]]);
                cells.push([[b, n, k], [a, n, k], [a, n, l], [b, n, l]]);
                cells.push([[n, a, k], [n, b, k], [n, b, l], [n, a, l]]);
                cells.push([[0, b, k], [0, a, k], [0, a, l], [0, b, l]]);
            }
        }
        cells
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns how often each arc is passed, by the junctions at its ends in order.
    fn check(known: &KnownNetwork) {
        let mut sides = BTreeMap::new();
        for cycle in known.patches.iter().chain(&known.openings) {
            for (i, &a) in cycle.iter().enumerate() {
                let b = cycle[(i + 1) % cycle.len()];
                *sides.entry([a, b]).or_insert(0) += 1;
            }
        }
        for ([a, b], count) in &sides {
            assert_eq!(*count, 1, "{a} {b}");
            assert!(sides.contains_key(&[*b, *a]), "{a} {b}");
        }
    }

    #[test]
    fn patches_and_openings_pass_every_arc_once_each_way() {
        for meridians in [3, 12] {
            for opening in [Opening::Open, Opening::Closed] {
                let known = mushroom_network(meridians, opening);
                check(&known);
                let each = if opening == Opening::Open { 5 } else { 6 };
                assert_eq!(known.patches.len(), each * meridians as usize);
            }
        }
        for size in [2, 4] {
            let known = dome_network(size);
            check(&known);
            assert_eq!(
                known.patches.len(),
                (size * size + 2 * size * size) as usize
            );
        }
    }
}
