//! Reproduction, smoothness and rates in the plane.

use msplines_common::evaluate::Order;
use msplines_common::mesh::{NONE, SurfacePoint};
use proptest::prelude::*;

use super::{interpolant, jet, jittered_grid, points, random_spline, torus};
use crate::{FlatDomain, PowellSabinSpline};

/// Derivatives of coefficients of order one over edges of length near a tenth, with shares of the
/// edges down to a hundredth.
const ROUNDING: f64 = 1e-11;

fn quadratic(c: [f64; 6], [x, y]: [f64; 2]) -> [f64; 6] {
    [
        c[0] + c[1] * x + c[2] * y + c[3] * x * x + c[4] * x * y + c[5] * y * y,
        c[1] + 2.0 * c[3] * x + c[4] * y,
        c[2] + c[4] * x + 2.0 * c[5] * y,
        2.0 * c[3],
        c[4],
        2.0 * c[5],
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn quadratics_are_reproduced(
        c in prop::array::uniform6(-1.0..1.0f64),
        cells in 2..6usize,
        amount in 0.0..0.45f64,
        seed in 0..1000u64,
    ) {
        let domain = jittered_grid(cells, amount, seed);
        let spline = interpolant(&domain, |at| {
            let q = quadratic(c, at);
            [q[0], q[1], q[2]]
        });
        for point in points(&domain, 4, seed) {
            let at = domain.mesh().position(point);
            let expected = quadratic(c, [at.x, at.y]);
            let found = jet(&spline, point);
            let triangle = domain.macro_triangle(point.face);
            let thin = triangle.locate(point.at).micro;
            let height = triangle.micro_area(thin) / triangle.area();
            for k in 0..3 {
                prop_assert!((found[k] - expected[k]).abs() < ROUNDING, "{k}: {found:?} {expected:?}");
            }
            for k in 3..6 {
                // Second derivatives divide the rounding of first ones by the height of a micro triangle.
                prop_assert!((found[k] - expected[k]).abs() < ROUNDING / height, "{k}: {found:?} {expected:?}");
            }
        }
    }
}

/// Returns the largest jump of the gradient over edges, and over edges of micro triangles, relative to
/// the largest gradient.
fn jumps(spline: &PowellSabinSpline) -> [f64; 2] {
    let domain = spline.flat_domain();
    let topology = domain.topology();
    let sample = |face: u32, at: [f64; 3]| jet(spline, SurfacePoint { face, at });
    let (mut outer, mut inner, mut largest) = (0.0_f64, 0.0_f64, 0.0_f64);
    for h in 0..3 * domain.mesh().face_count() as u32 {
        let twin = topology.twin(h);
        let (face, i) = (h / 3, (h % 3) as usize);
        let share = domain.edge_splits()[h as usize];
        for t in [0.0, 0.3 * share, share, 0.2 + 0.8 * share, 0.9, 1.0] {
            let place = |i: usize, t: f64| {
                let mut at = [0.0; 3];
                at[i] = 1.0 - t;
                at[(i + 1) % 3] = t;
                at
            };
            let own = sample(face, place(i, t));
            largest = largest.max(own[1].hypot(own[2]));
            if twin != NONE && (0.01..0.99).contains(&share) {
                let other = sample(twin / 3, place((twin % 3) as usize, 1.0 - t));
                outer = outer.max((own[0] - other[0]).abs());
                outer = outer.max((own[1] - other[1]).hypot(own[2] - other[2]));
            }
        }
        let triangle = domain.macro_triangle(face);
        let centre = triangle.incentre();
        for foot in [[1.0, 0.0], [1.0 - share, share]] {
            let mut side = [0.0; 3];
            side[i] = foot[0];
            side[(i + 1) % 3] = foot[1];
            let middle = [0, 1, 2].map(|k| 0.4 * side[k] + 0.6 * centre[k]);
            let step = 1e-13;
            let moved = |s: f64| {
                let mut at = middle;
                at[i] += s;
                at[(i + 1) % 3] -= s;
                sample(face, at)
            };
            let (left, right) = (moved(step), moved(-step));
            let bend = left[3..]
                .iter()
                .chain(&right[3..])
                .fold(0.0_f64, |m, x| m.max(x.abs()));
            let jump = (left[1] - right[1]).hypot(left[2] - right[2]);
            // The two points are a step apart, over which a smooth gradient changes too.
            inner = inner.max((jump - 8.0 * step * bend).max(0.0));
        }
    }
    [outer / largest, inner / largest]
}

#[test]
fn gradients_do_not_jump() {
    for (seed, amount) in [(1, 0.0), (2, 0.3), (3, 0.45), (4, 0.49)] {
        let spline = random_spline(&jittered_grid(8, amount, seed), 1, seed);
        let [outer, inner] = jumps(&spline);
        assert!(
            outer < 1e-12 && inner < 1e-12,
            "{amount}: {outer:e} {inner:e}"
        );
    }
    let spline = random_spline(&torus(6, 0.2).0, 1, 3);
    let [outer, inner] = jumps(&spline);
    assert!(outer < 1e-12 && inner < 1e-12, "{outer:e} {inner:e}");
}

#[test]
fn a_split_in_the_wrong_place_makes_gradients_jump() {
    // The check above must be able to fail: midpoints are no Powell-Sabin split.
    let domain = jittered_grid(4, 0.3, 7);
    let spline = random_spline(&domain, 1, 7);
    let mut worst = 0.0_f64;
    for h in 0..3 * domain.mesh().face_count() {
        let twin = domain.topology().twin(h as u32);
        if twin == NONE {
            continue;
        }
        let gradient = |h: usize| {
            let triangle = domain.macro_triangle((h / 3) as u32);
            let wrong = crate::element::MacroTriangle::new(triangle.edges(), [0.5; 3]);
            wrong.gradients(&spline.corner_numbers((h / 3) as u32, 0))[3 + h % 3]
        };
        let (a, b) = (gradient(h), gradient(twin as usize));
        worst = worst.max((a[0] - b[0]).hypot(a[1] - b[1]));
    }
    assert!(worst > 1e-2, "{worst}");
}

#[test]
fn functions_are_approximated_at_the_known_rates() {
    let function = |[x, y]: [f64; 2]| {
        let (s, c) = (3.0 * x + y).sin_cos();
        let e = (0.5 * y).exp();
        [s * e, 3.0 * c * e, (c + 0.5 * s) * e]
    };
    let errors: Vec<[f64; 2]> = [8, 16, 32]
        .iter()
        .map(|&cells| {
            let domain = jittered_grid(cells, 0.2, 9);
            let spline = interpolant(&domain, function);
            let mut sums = [0.0_f64; 2];
            let samples = points(&domain, 6, 1);
            for &point in &samples {
                let at = domain.mesh().position(point);
                let (found, expected) = (jet(&spline, point), function([at.x, at.y]));
                sums[0] += (found[0] - expected[0]).powi(2);
                sums[1] += (found[1] - expected[1]).powi(2) + (found[2] - expected[2]).powi(2);
            }
            sums.map(|sum| (sum / samples.len() as f64).sqrt())
        })
        .collect();
    let rate = |k: usize| (errors[1][k] / errors[2][k]).log2();
    // Quadratics are reproduced; the jitter of three unrelated grids changes the rates by some.
    assert!((rate(0) - 3.0).abs() < 0.2, "{errors:?}");
    assert!((rate(1) - 2.0).abs() < 0.2, "{errors:?}");
}

#[test]
fn units_and_labels_do_not_matter() {
    let domain = jittered_grid(5, 0.3, 4);
    let spline = random_spline(&domain, 1, 8);
    // Vertices are numbered backwards, faces start at their last corner and lengths are in other units.
    let scale = 1e-3;
    let count = domain.mesh().vertex_count() as u32;
    let plane: Vec<[f64; 2]> = (domain.mesh().positions().iter().rev())
        .map(|p| [scale * p.x + 4.0, scale * p.y - 7.0])
        .collect();
    let faces = domain.mesh().faces().iter().rev();
    let faces = faces
        .map(|f| [f[2], f[0], f[1]].map(|v| count - 1 - v))
        .collect();
    let other = FlatDomain::planar_with_faces(&plane, faces).expect("the same domain");
    let values = spline.vertex_values().iter().rev().copied().collect();
    let gradients = spline.vertex_gradients().chunks_exact(2).rev();
    let gradients = gradients
        .flat_map(|g| [g[0] / scale, g[1] / scale])
        .collect();
    let other = PowellSabinSpline::from_parts(other, 1, values, gradients).expect("a spline");
    let last = domain.mesh().face_count() as u32 - 1;
    for point in points(&domain, 3, 2) {
        let [a, b, c] = point.at;
        let moved = SurfacePoint {
            face: last - point.face,
            at: [c, a, b],
        };
        let (one, two) = (jet(&spline, point), jet(&other, moved));
        // The shift by 7 costs five digits of vectors of length 1e-4, short pieces of edges two more.
        assert!((one[0] - two[0]).abs() < 1e-9, "{one:?} {two:?}");
        assert!((one[1] - scale * two[1]).abs() < 1e-7, "{one:?} {two:?}");
    }
    assert!(spline.evaluate_flat(&[], Order::Value).is_ok());
}
