//! Points on every kind of line that a surface crosses, and the directions across.

use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use crate::caps::{CapKind, core_of};
use crate::complex::{Beyond, Border, CylinderComplex, Node, Point, UNITS};
use crate::space::TSplineSpace;
use crate::tmesh::TMesh;

/// How far beside a line one looks, over the smallest length there: far above the last digit of a
/// coordinate, and far below what a cubic needs to bend.
const BESIDE: f64 = 1.0 / (1 << 24) as f64;
/// The least such distance, in units.
const LEAST: f64 = 64.0;

/// A point on a line and a direction across it, of which the length is that of a step, in units.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    pub(super) at: Point,
    pub(super) step: [f64; 2],
}

/// A length in a leaf or a cap, as a step.
fn step(length: f64, direction: [f64; 2]) -> [f64; 2] {
    direction.map(|c| c * (BESIDE * length).max(LEAST))
}

fn leaf_length(mesh: &TMesh, at: Point) -> f64 {
    let [w, h] = mesh.leaves()[mesh.leaf_of(at) as usize].size();
    w.min(h) as f64
}

/// Random points on the lower and the left side of every leaf: on borders of cylinders, and inside.
pub(super) fn edges(mesh: &TMesh, each: usize, random: &mut Pcg64Mcg) -> [Vec<Crossing>; 2] {
    let complex = mesh.complex();
    let [mut borders, mut inside] = [Vec::new(), Vec::new()];
    for leaf in mesh.leaves() {
        let [w, h] = leaf.size().map(|s| s as f64);
        let [x, y] = [leaf.x[0] as f64, leaf.y[0] as f64];
        let cylinder = leaf.cylinder;
        for _ in 0..each {
            let (s, t) = (random.random::<f64>(), random.random::<f64>());
            let on_left = Point {
                cylinder,
                x,
                y: y + t * h,
            };
            let below = Point {
                cylinder,
                x: x + s * w,
                y,
            };
            inside.push(Crossing {
                at: on_left,
                step: step(w.min(h), [1.0, 0.0]),
            });
            let over = Crossing {
                at: below,
                step: step(w.min(h), [0.0, 1.0]),
            };
            if leaf.y[0] > 0 {
                inside.push(over);
            } else if glued(complex, cylinder, Border::Bottom, below.x) {
                borders.push(over);
            }
        }
    }
    [borders, inside]
}

fn glued(complex: &CylinderComplex, cylinder: u32, border: Border, x: f64) -> bool {
    let segment = complex.segment(cylinder, border, x.floor() as i64);
    matches!(segment.beyond, Beyond::Cylinder { .. })
}

/// Zeros on the borders of every cylinder: where, and what is below.
fn zeros(complex: &CylinderComplex) -> impl Iterator<Item = (u32, Border, i64, u32)> + '_ {
    (0..complex.cylinders().len() as u32).flat_map(move |cylinder| {
        [Border::Bottom, Border::Top]
            .into_iter()
            .flat_map(move |border| {
                let segments = complex.border(cylinder, border).iter();
                segments.filter_map(move |s| Some((cylinder, border, s.start, s.zero?)))
            })
    })
}

/// Random points on the vertical lines that start at zeros, through the cylinder beside them and a quarter
/// of its height beyond: on them supports are drawn back.
pub(super) fn rays(mesh: &TMesh, each: usize, random: &mut Pcg64Mcg) -> Vec<Crossing> {
    let complex = mesh.complex();
    let mut found = Vec::new();
    for (cylinder, border, start, _) in zeros(complex) {
        let height = complex.cylinders()[cylinder as usize].height as f64;
        let (y, sign) = match border {
            Border::Bottom => (0.0, 1.0),
            Border::Top => (height, -1.0),
        };
        let from = Point {
            cylinder,
            x: start as f64,
            y,
        };
        for _ in 0..each {
            let way = 1.25 * sign * height * random.random::<f64>();
            let (at, stop) = complex.walk(from, [0.0, way]);
            if stop.is_none() {
                let step = step(leaf_length(mesh, at), [1.0, 0.0]);
                found.push(Crossing { at, step });
            }
        }
    }
    found
}

/// T-junctions, each crossed along both axes and both diagonals.
pub(super) fn junctions(mesh: &TMesh, nodes: &[Node]) -> Vec<Crossing> {
    let across = |&node: &Node| {
        let at = Point::from(node);
        let length = leaf_length(mesh, at);
        let directions = [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, -1.0]];
        directions.map(|direction| Crossing {
            at,
            step: step(length, direction),
        })
    };
    nodes.iter().flat_map(across).collect()
}

/// A circle in a cap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Circle {
    /// The border of the cap.
    Border,
    /// That of its core.
    Core,
}

/// Random points on circles around zeros and poles, crossed along their radii.
pub(super) fn circles(
    space: &TSplineSpace,
    circle: Circle,
    each: usize,
    random: &mut Pcg64Mcg,
) -> Vec<Crossing> {
    let size = |kind| match circle {
        Circle::Border => 1.0,
        Circle::Core => core_of(kind),
    };
    let mesh = space.mesh();
    let mut found = Vec::new();
    for cap in 0..space.caps().caps().len() as u32 {
        let own = space.caps().caps()[cap as usize];
        for (at, direction) in around(space, cap, size(own.kind), each, random) {
            let length = leaf_length(mesh, at).min(own.radius * UNITS);
            found.push(Crossing {
                at,
                step: step(length, direction),
            });
        }
    }
    found
}

/// Random points of a cap at `|w|`, and their directions from its centre: as many on every half disk of a
/// zero, and twice as many at a pole.
pub(super) fn around(
    space: &TSplineSpace,
    cap: u32,
    size: f64,
    each: usize,
    random: &mut Pcg64Mcg,
) -> Vec<(Point, [f64; 2])> {
    let angles: Vec<f64> = (0..2 * each).map(|_| random.random::<f64>()).collect();
    let complex = space.mesh().complex();
    let own = space.caps().caps()[cap as usize];
    match own.kind {
        CapKind::Pole {
            cylinder, border, ..
        } => {
            let shape = &complex.cylinders()[cylinder as usize];
            let [round, height] = [shape.circumference, shape.height].map(|n| n as f64);
            let depth = -size.ln() * round / std::f64::consts::TAU;
            let up = depth - own.radius * UNITS;
            let (y, sign) = match border {
                Border::Bottom => (-up, -1.0),
                Border::Top => (height + up, 1.0),
            };
            let place = |t: &f64| {
                (
                    Point {
                        cylinder,
                        x: t * round,
                        y,
                    },
                    [0.0, sign],
                )
            };
            angles.iter().map(place).collect()
        }
        CapKind::Zero { index, order } => {
            let radius = own.radius * UNITS * size.powi(order as i32 + 1);
            let halves = zeros(complex).filter(|(.., zero)| *zero == index);
            let half = |(cylinder, border, start, _): (u32, Border, i64, u32)| {
                let shape = &complex.cylinders()[cylinder as usize];
                let (y, sign) = match border {
                    Border::Bottom => (0.0, 1.0),
                    Border::Top => (shape.height as f64, -1.0),
                };
                let place = move |t: &f64| {
                    let (sin, cos) = (std::f64::consts::PI * t).sin_cos();
                    let n = [sign * cos, sign * sin];
                    let round = shape.circumference as f64;
                    let x = (start as f64 + radius * n[0]).rem_euclid(round);
                    let x = if x < round { x } else { 0.0 };
                    (
                        Point {
                            cylinder,
                            x,
                            y: y + radius * n[1],
                        },
                        n,
                    )
                };
                angles[..each].iter().map(place).collect::<Vec<_>>()
            };
            halves.flat_map(half).collect()
        }
    }
}
