//! Smoothness over all lines that a surface crosses.
//!
//! # Notation
//! Over a line the difference of a derivative on both sides, at the distance `d` from it, is
//! `j + a d + b d^2`: `j` is the jump, which is nothing but rounding where the surface is C2. Rounding is that
//! of sums of control points times derivatives of functions, whose sizes are added up.

use msplines_common::Vector3;
use msplines_common::evaluate::Order;
use msplines_t_spline::TSpline;
use msplines_t_spline::caps::CapKind;
use msplines_t_spline::complex::{Border, Point, UNITS};

use super::{Sequence, Whole};

/// A point on a line and a direction across.
type Crossing = (Point, [f64; 2]);

/// Distances from a line, in units of the form's 1; the last one is ten times the first.
const OFFSETS: [f64; 4] = [1e-10, 2e-10, 4e-10, 1e-9];
/// Jumps of values, first and second derivatives, over the sums of sizes: rounding, of which divisions by
/// narrow intervals between knots, 2e-8 where two lines nearly meet, leave that much.
const JUMPS: [f64; 3] = [1e-12, 1e-9, 1e-8];
/// The same over the derivatives themselves: a double knot leaves a tenth and more.
const OVER_TYPICAL: [f64; 3] = [1e-12, 1e-8, 1e-6];
/// Points on each edge.
const ON_EDGE: usize = 3;
/// Points on each circle and ray.
const ON_CIRCLE: i32 = 100;
/// Radius of the core of a cap, in which there is nothing but the polynomial, over that of the cap.
const CORE: f64 = 0.4;

/// What was found over lines of one kind.
#[derive(Clone, Copy, Debug, Default)]
struct Found {
    /// Jumps over the sums of sizes.
    jumps: [f64; 3],
    /// Jumps over the root mean square of the derivative.
    over_typical: [f64; 3],
    /// Differences at 1e-10 and at 1e-9 over the root mean square of the derivative.
    differences: [[f64; 3]; 2],
}

/// Value and derivatives.
type Jet = [Vector3<f64>; 6];

fn jets(spline: &TSpline, points: &[Point]) -> Vec<Jet> {
    let s = spline.evaluate(points, Order::Second);
    let jet = |i: usize| {
        let ([x, y], [xx, xy, yy]) = (s.first[i], s.second[i]);
        [s.positions[i].coords, x, y, xx, xy, yy]
    };
    (0..points.len()).map(jet).collect()
}

/// The order of an entry of a jet.
fn order(entry: usize) -> usize {
    usize::from(entry > 0) + usize::from(entry > 2)
}

/// Returns per point and order the sum of the sizes of what is added.
fn sizes(spline: &TSpline, points: &[Point]) -> Vec<[f64; 3]> {
    let rows = spline.space().rows(points, Order::Second);
    let size = |i: usize| {
        let row = rows.row(i);
        let mut sizes = [0.0; 3];
        for (k, &unknown) in row.unknowns.iter().enumerate() {
            let length = spline.control()[unknown as usize].norm();
            let largest = |values: &[f64]| values.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            sizes[0] += length * row.values[k].abs();
            sizes[1] += length * largest(&row.first[k]);
            sizes[2] += length * largest(&row.second[k]);
        }
        sizes
    };
    (0..points.len()).map(size).collect()
}

/// Measures differences over lines.
fn measure(spline: &TSpline, crossings: &[Crossing]) -> Found {
    let complex = spline.space().mesh().complex();
    let side = |offset: f64| -> Vec<Jet> {
        let moved = crossings.iter().map(|&(point, across)| {
            let step = across.map(|c| c * offset * UNITS);
            complex.walk(point, step).0
        });
        jets(spline, &moved.collect::<Vec<_>>())
    };
    let sides = OFFSETS.map(|offset| (side(offset), side(-offset)));
    let points: Vec<Point> = crossings.iter().map(|c| c.0).collect();
    let sizes = sizes(spline, &points);
    let count = crossings.len() as f64;
    let typical: [f64; 6] = std::array::from_fn(|d| {
        let squares = sides[0].0.iter().map(|jet| jet[d].norm_squared());
        (squares.sum::<f64>() / count).sqrt()
    });
    let mut found = Found::default();
    for i in 0..crossings.len() {
        for d in 0..6 {
            let o = order(d);
            let [near, far, farther, last] = [0, 1, 2, 3].map(|k| {
                let (one, other) = &sides[k];
                one[i][d] - other[i][d]
            });
            // Differences that are linear and quadratic in the offset leave nothing, a jump itself.
            let jump = (8.0 * near - 6.0 * far + farther).norm() / 3.0;
            let raise = |largest: &mut f64, value: f64| *largest = largest.max(value);
            raise(&mut found.jumps[o], jump / sizes[i][o]);
            raise(&mut found.over_typical[o], jump / typical[d]);
            raise(&mut found.differences[0][o], near.norm() / typical[d]);
            raise(&mut found.differences[1][o], last.norm() / typical[d]);
        }
    }
    found
}

/// Points on the edges of faces, on borders of cylinders and others, and around T-junctions.
fn on_mesh(spline: &TSpline) -> [Vec<Crossing>; 3] {
    let mesh = spline.quad_mesh();
    let mut numbers = Sequence(3);
    let [mut edges, mut borders, mut junctions] = [Vec::new(), Vec::new(), Vec::new()];
    for edge in mesh.edges() {
        for _ in 0..ON_EDGE {
            let mut point = Point::from(edge.start);
            let way = edge.length as f64 * numbers.unit();
            if edge.axis == 0 {
                point.x += way;
                let on_border = edge.start.y == 0;
                let lines = if on_border { &mut borders } else { &mut edges };
                lines.push((point, [0.0, 1.0]));
            } else {
                point.y += way;
                edges.push((point, [1.0, 0.0]));
            }
        }
    }
    for vertex in mesh
        .vertices()
        .iter()
        .filter(|v| v.is_t_junction && v.zero.is_none())
    {
        for across in [[1.0, 0.0], [0.0, 1.0], [0.6, 0.8], [-0.8, 0.6]] {
            junctions.push((vertex.point, across));
        }
    }
    [edges, borders, junctions]
}

/// Points on the vertical lines through zeros, in the cylinders beside them.
fn on_rays(spline: &TSpline) -> Vec<Crossing> {
    let complex = spline.space().mesh().complex();
    let mut points = Vec::new();
    for (cylinder, own) in (0..).zip(complex.cylinders()) {
        for (border, y, sign) in [
            (Border::Bottom, 0.0, 1.0),
            (Border::Top, own.height as f64, -1.0),
        ] {
            for segment in complex
                .border(cylinder, border)
                .iter()
                .filter(|s| s.zero.is_some())
            {
                for step in 1..ON_CIRCLE {
                    let way = sign * own.height as f64 * f64::from(step) / f64::from(ON_CIRCLE);
                    let point = Point {
                        cylinder,
                        x: segment.start as f64,
                        y: y + way,
                    };
                    points.push((point, [1.0, 0.0]));
                }
            }
        }
    }
    points
}

/// Points on the borders of caps and of their cores.
fn on_caps(spline: &TSpline) -> Vec<Crossing> {
    let space = spline.space();
    let complex = space.mesh().complex();
    let caps = space.caps().caps();
    let mut points = Vec::new();
    for (cylinder, own) in (0..).zip(complex.cylinders()) {
        let size = own.circumference as f64;
        for (border, y, turn) in [
            (Border::Bottom, 0.0, 0.0),
            (Border::Top, own.height as f64, 1.0),
        ] {
            for segment in complex.border(cylinder, border) {
                let Some(cap) = segment.zero.map(|zero| &caps[zero as usize]) else {
                    continue;
                };
                for radius in [1.0, CORE].map(|share| share * cap.radius * UNITS) {
                    for step in 0..ON_CIRCLE {
                        let share = (f64::from(step) + 0.5) / f64::from(ON_CIRCLE);
                        let angle = (turn + share) * std::f64::consts::PI;
                        let across = [angle.cos(), angle.sin()];
                        let x = (segment.start as f64 + radius * across[0]).rem_euclid(size);
                        let y = y + radius * across[1];
                        points.push((Point { cylinder, x, y }, across));
                    }
                }
            }
        }
    }
    for cap in caps {
        let CapKind::Pole {
            cylinder, border, ..
        } = cap.kind
        else {
            continue;
        };
        let own = &complex.cylinders()[cylinder as usize];
        let size = own.circumference as f64;
        let rim = cap.radius * UNITS;
        // |w| falls by a turn's logarithm over a circumference.
        for depth in [rim, rim + CORE.ln() / std::f64::consts::TAU * size] {
            let y = match border {
                Border::Bottom => depth,
                Border::Top => own.height as f64 - depth,
            };
            for step in 0..ON_CIRCLE {
                let x = (f64::from(step) + 0.5) / f64::from(ON_CIRCLE) * size;
                points.push((Point { cylinder, x, y }, [0.0, 1.0]));
            }
        }
    }
    points
}

/// Returns the narrowest interval between knots, in units of the form's 1.
fn narrowest(spline: &TSpline) -> f64 {
    let functions = spline.space().functions().iter();
    let knots = functions.flat_map(|f| [f.x, f.y]);
    let steps = knots.flat_map(|k| [0, 1, 2, 3].map(|i| k[i + 1] - k[i]));
    let least = steps.filter(|&step| step > 0).min();
    least.map_or(f64::INFINITY, |least| least as f64 / UNITS)
}

/// Asserts that neither values nor derivatives jump.
pub(super) fn assert_c2(whole: &Whole) {
    let spline = whole.surface.spline();
    let complex = spline.space().mesh().complex();
    let narrowest = narrowest(spline);
    println!(
        "{}: the narrowest knot interval is {narrowest:e}",
        whole.name
    );
    // Closer knots are one double knot to a number: there is no C2 to be seen.
    assert!(narrowest > OFFSETS[3], "{}: {narrowest:e}", whole.name);
    let [edges, borders, junctions] = on_mesh(spline);
    let kinds = [
        ("edges", edges),
        ("critical lines", borders),
        ("T-junctions", junctions),
        ("lines through zeros", on_rays(spline)),
        ("borders of caps", on_caps(spline)),
    ];
    for (kind, mut crossings) in kinds {
        // Beyond an open border there is nothing to compare with.
        let farthest = OFFSETS[3] * UNITS;
        crossings.retain(|&(point, across)| {
            [farthest, -farthest].iter().all(|step| {
                let (_, stop) = complex.walk(point, across.map(|c| c * step));
                stop.is_none()
            })
        });
        if crossings.is_empty() {
            continue;
        }
        let found = measure(spline, &crossings);
        println!(
            "{}, {kind}: {} points, {found:?}",
            whole.name,
            crossings.len()
        );
        for o in 0..3 {
            // Places are known to a unit: where a surface is steep or bends, values and derivatives are that
            // far apart. Of a jump that is less than a thousandth.
            let unit = found.differences[0][o] / (OFFSETS[0] * UNITS);
            assert!(
                found.jumps[o] <= JUMPS[o] + unit
                    && found.over_typical[o] <= OVER_TYPICAL[o] + unit,
                "{}, {kind}: {found:?}",
                whole.name
            );
        }
    }
}
