//! Smoothness over every line that a surface crosses, and derivatives against differences.

use std::sync::Arc;

use msplines_common::Vector3;
use msplines_common::evaluate::Order;

use super::*;
use crate::complex::{Beyond, Border, CylinderComplex, UNITS};
use crate::samples::{
    Sequence, large_double_torus, large_torus, open_cylinder, surfaces_with_zeros,
};
use crate::space::tests::{random_points, random_space};

fn random_spline(complex: &Arc<CylinderComplex>, splits: usize, seed: u64, caps: f64) -> TSpline {
    let mut space = random_space(complex, splits, seed);
    for cap in 0..space.caps().caps().len() as u32 {
        let limit = space.caps().caps()[cap as usize].limit;
        assert_eq!(space.caps_mut().set_radius(cap, caps * limit), caps * limit);
    }
    let mut numbers = Sequence(seed);
    let control = (0..space.unknowns())
        .map(|_| Vector3::from_fn(|_, _| numbers.unit() - 0.5))
        .collect();
    TSpline::new(Arc::new(space), control)
}

/// Value and derivatives of a point, in one.
pub(super) fn jets(spline: &TSpline, points: &[Point]) -> Vec<[Vector3<f64>; 6]> {
    let s = spline.evaluate(points, Order::Second);
    (0..points.len())
        .map(|i| {
            let ([x, y], [xx, xy, yy]) = (s.first[i], s.second[i]);
            [s.positions[i].coords, x, y, xx, xy, yy]
        })
        .collect()
}

/// Returns, per derivative, the largest jump over lines through points along a direction, relative to the
/// root mean square of that derivative: what remains of one-sided differences at zero offset.
fn jumps(spline: &TSpline, points: &[(Point, [f64; 2])]) -> [f64; 6] {
    let complex = spline.space().mesh().complex();
    let side = |offset: f64| {
        let moved = |&(point, n): &(Point, [f64; 2])| {
            let step = n.map(|c| c * offset * UNITS);
            complex.walk(point, step).0
        };
        jets(spline, &points.iter().map(moved).collect::<Vec<_>>())
    };
    let sides = [1e-10, 2e-10, 4e-10].map(|offset| (side(offset), side(-offset)));
    let typical: [f64; 6] = std::array::from_fn(|d| {
        let squares = sides[0].0.iter().map(|jet| jet[d].norm_squared());
        (squares.sum::<f64>() / points.len() as f64).sqrt()
    });
    let mut largest = [0.0_f64; 6];
    for i in 0..points.len() {
        for d in 0..6 {
            let [near, far, farther] = [0, 1, 2].map(|k| sides[k].0[i][d] - sides[k].1[i][d]);
            // Differences that are linear and quadratic in the offset leave nothing, a jump itself.
            let jump = (8.0 * near - 6.0 * far + farther).norm() / 3.0;
            largest[d] = largest[d].max(jump / typical[d]);
        }
    }
    largest
}

/// Roundings of values, first and second derivatives, of which the second are worst in thin columns.
const C2: [f64; 6] = [1e-12, 1e-10, 1e-10, 1e-9, 1e-9, 1e-9];

fn assert_c2(what: &str, spline: &TSpline, points: &[(Point, [f64; 2])]) {
    let found = jumps(spline, points);
    println!("{what}: {} points, jumps {found:?}", points.len());
    for d in 0..6 {
        assert!(found[d] < C2[d], "{what}: {found:?}");
    }
}

fn on_leaves(spline: &TSpline, seed: u64) -> [Vec<(Point, [f64; 2])>; 2] {
    let mesh = spline.space().mesh();
    let mut numbers = Sequence(seed);
    let mut lines = [Vec::new(), Vec::new()];
    for leaf in mesh.leaves() {
        let [w, h] = leaf.size().map(|s| s as f64);
        for _ in 0..6 {
            let cylinder = leaf.cylinder;
            let [x, y] = [leaf.x[0] as f64, leaf.y[0] as f64];
            let vertical = Point {
                cylinder,
                x,
                y: y + h * numbers.unit(),
            };
            let horizontal = Point {
                cylinder,
                x: x + w * numbers.unit(),
                y,
            };
            lines[0].push((vertical, [1.0, 0.0]));
            lines[1].push((horizontal, [0.0, 1.0]));
        }
    }
    lines
}

/// Points on vertical lines through zeros, in the cylinders beside them and beyond.
fn on_rays(complex: &CylinderComplex) -> Vec<(Point, [f64; 2])> {
    let mut points = Vec::new();
    for (k, own) in complex.cylinders().iter().enumerate() {
        for (border, at, sign) in [
            (Border::Bottom, 0.0, 1.0),
            (Border::Top, own.height as f64, -1.0),
        ] {
            let zeros = complex
                .border(k as u32, border)
                .iter()
                .filter(|s| s.zero.is_some());
            for x in zeros.map(|s| s.start as f64) {
                for step in 1..400 {
                    let from = Point {
                        cylinder: k as u32,
                        x,
                        y: at,
                    };
                    // Beyond the first cylinder lines through zeros are lines like others.
                    let way = sign * own.height as f64 * f64::from(step) / 320.1;
                    points.push((complex.walk(from, [0.0, way]).0, [1.0, 0.0]));
                }
            }
        }
    }
    points
}

/// Points on circles around zeros, at a share of the radius of their caps.
fn on_caps(spline: &TSpline, share: f64) -> Vec<(Point, [f64; 2])> {
    let complex = spline.space().mesh().complex();
    let mut points = Vec::new();
    for (k, own) in complex.cylinders().iter().enumerate() {
        for (border, y, turn) in [
            (Border::Bottom, 0.0, 0.0),
            (Border::Top, own.height as f64, 1.0),
        ] {
            for s in complex.border(k as u32, border) {
                let Some(zero) = s.zero else { continue };
                let radius = share * spline.space().caps().caps()[zero as usize].radius * UNITS;
                for step in 0..100 {
                    let angle = (turn + (f64::from(step) + 0.5) / 100.0) * std::f64::consts::PI;
                    let n = [angle.cos(), angle.sin()];
                    let x = (s.start as f64 + radius * n[0]).rem_euclid(own.circumference as f64);
                    let point = Point {
                        cylinder: k as u32,
                        x,
                        y: y + radius * n[1],
                    };
                    points.push((point, n));
                }
            }
        }
    }
    points
}

#[test]
fn surfaces_are_c2_over_the_borders_of_poles() {
    let complex = open_cylinder(Beyond::Pole { index: 0 });
    let own = &complex.cylinders()[0];
    let [size, height] = [own.circumference as f64, own.height as f64];
    for (seed, caps) in [(1, 1.0), (2, 0.5)] {
        let spline = random_spline(&complex, 30, seed, caps);
        let mut inner = on_leaves(&spline, seed);
        for lines in &mut inner {
            lines.retain(|(p, _)| p.y > 1e6);
        }
        assert_c2("vertical edges below a pole", &spline, &inner[0]);
        assert_c2("horizontal edges below a pole", &spline, &inner[1]);
        let rim = height - spline.space().caps().caps()[0].radius * UNITS;
        // |w| = exp(-2 pi depth / C).
        let core = rim + 2.5_f64.ln() / std::f64::consts::TAU * size;
        for y in [rim, core] {
            let circle = (0..100).map(|k| (f64::from(k) + 0.5) / 100.0 * size);
            let circle = circle.map(|x| (Point { cylinder: 0, x, y }, [0.0, 1.0]));
            assert_c2(
                "circles around a pole",
                &spline,
                &circle.collect::<Vec<_>>(),
            );
        }
    }
}

#[test]
fn surfaces_are_c2_over_every_line() {
    for (seed, caps) in [(0, 1.0), (1, 0.1), (2, 0.1), (3, 0.5), (4, 0.1), (5, 1.0)] {
        let complex = surfaces_with_zeros().swap_remove(seed as usize % 4);
        let spline = random_spline(&complex, 60, seed, caps);
        let [vertical, horizontal] = on_leaves(&spline, seed);
        assert_c2("vertical edges", &spline, &vertical);
        assert_c2("horizontal edges and borders", &spline, &horizontal);
        assert_c2("lines through zeros", &spline, &on_rays(&complex));
        assert_c2("borders of caps", &spline, &on_caps(&spline, 1.0));
        assert_c2("borders of cores", &spline, &on_caps(&spline, 0.4));
    }
    for twist in [0.0, 0.37] {
        let spline = random_spline(&large_torus(twist), 40, 5, 1.0);
        let [vertical, horizontal] = on_leaves(&spline, 5);
        assert_c2("vertical edges of a torus", &spline, &vertical);
        assert_c2("horizontal edges of a torus", &spline, &horizontal);
    }
}

#[test]
fn derivatives_are_those_of_differences() {
    for (seed, complex) in [
        large_double_torus(),
        large_torus(0.37),
        open_cylinder(Beyond::Pole { index: 0 }),
    ]
    .iter()
    .enumerate()
    {
        let spline = random_spline(complex, 30, seed as u64, 1.0);
        let mut points = random_points(complex, 2000, 2);
        // Where z^(1/2) is nearly singular, differences are not good enough.
        points.retain(|&p| spline.space().caps().at(p).is_none_or(|c| c.w.norm() > 0.2));
        let h = 1e-6;
        let moved = |d: usize, sign: f64| {
            let mut step = [0.0; 2];
            step[d] = sign * h * UNITS;
            let walked = points.iter().map(|&p| complex.walk(p, step).0);
            jets(&spline, &walked.collect::<Vec<_>>())
        };
        let middle = jets(&spline, &points);
        // By x: of value, x, y; by y likewise.
        for (d, pairs) in [[(0, 1), (1, 3), (2, 4)], [(0, 2), (1, 4), (2, 5)]]
            .iter()
            .enumerate()
        {
            let [high, low] = [moved(d, 1.0), moved(d, -1.0)];
            for &(of, derivative) in pairs {
                let scale = middle
                    .iter()
                    .map(|j| j[derivative].norm())
                    .fold(0.0, f64::max);
                let mut wrong = 0;
                for i in 0..points.len() {
                    let difference = (high[i][of] - low[i][of]) / (2.0 * h);
                    let error = (difference - middle[i][derivative]).norm();
                    // Second-order differences, but of third derivatives that jump at knots.
                    wrong += usize::from(error > 1e-5 * scale);
                }
                assert!(
                    wrong * 1000 < points.len(),
                    "{wrong} of {} wrong",
                    points.len()
                );
            }
        }
    }
}

#[test]
fn surfaces_of_equal_control_points_are_a_point() {
    let complex = large_double_torus();
    let space = Arc::new(random_space(&complex, 50, 1));
    let point = Vector3::new(0.3, -2.0, 5.0);
    let mut control = vec![point; space.unknowns()];
    for cap in space.caps().caps() {
        let first = space.functions().len() + cap.offset as usize;
        control[first + 1..first + cap.coefficients()].fill(Vector3::zeros());
    }
    let spline = TSpline::new(space, control);
    let samples = spline.evaluate(&random_points(&complex, 20_000, 8), Order::Value);
    assert_eq!(samples.positions.len(), 20_000);
    for found in samples.positions {
        assert!((found.coords - point).norm() < 1e-12);
    }
}
