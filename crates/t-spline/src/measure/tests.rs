//! Measures against closed forms, and against damage.

use std::sync::Arc;

use msplines_common::Vector3;

use super::*;
use crate::caps::CapOptions;
use crate::complex::{Beyond, CylinderComplex};
use crate::samples::{Sequence, large_double_torus, open_cylinder, surfaces_with_zeros};
use crate::space::TSplineSpace;
use crate::space::tests::random_space;
use crate::spline::TSpline;
use crate::tmesh::{Axis, Grid, TMesh};

fn random_spline(complex: &Arc<CylinderComplex>, splits: usize, seed: u64) -> TSpline {
    let space = Arc::new(random_space(complex, splits, seed));
    let mut numbers = Sequence(seed);
    let vector = |_| Vector3::from_fn(|_, _| numbers.unit() - 0.5);
    let control = (0..space.unknowns()).map(vector).collect();
    TSpline::new(space, control)
}

fn torus_space(columns: usize, rows: usize) -> TSplineSpace {
    let complex = CylinderComplex::torus((columns as i64) << 40, (rows as i64) << 39, 0);
    let mesh = TMesh::build(
        &Arc::new(complex.expect("a torus")),
        &[Grid { columns, rows }],
    );
    TSplineSpace::build(mesh.expect("a mesh"), &CapOptions::default()).expect("no caps")
}

/// Eigenvalues of the Gram matrix of periodic uniform cubics: values of a B-spline of degree 7.
fn symbol(n: usize) -> [f64; 2] {
    let at = |k: usize| {
        let t = std::f64::consts::TAU * k as f64 / n as f64;
        let sum = 2.0 * (1191.0 * t.cos() + 120.0 * (2.0 * t).cos() + (3.0 * t).cos());
        (2416.0 + sum) / 5040.0
    };
    let all = (0..n).map(at);
    let (low, high) = (f64::INFINITY, 0.0);
    all.fold([low, high], |[low, high], v| {
        [f64::min(low, v), f64::max(high, v)]
    })
}

#[test]
fn uniform_periodic_cubics_have_the_condition_of_their_symbol() {
    for (columns, rows) in [(8, 8), (12, 9), (31, 16)] {
        let found = gram(&torus_space(columns, rows), 1).expect("a matrix");
        let ([a, b], [c, d]) = (symbol(columns), symbol(rows));
        // The diagonal of both factors is 2416 / 5040.
        let scale = (5040.0_f64 / 2416.0).powi(2);
        let due = b * d / (a * c);
        let condition = found.condition.expect("independent functions");
        assert!((condition / due - 1.0).abs() < 1e-9, "{condition} {due}");
        assert!(
            (found.largest / (scale * b * d) - 1.0).abs() < 1e-9,
            "{found:?}"
        );
        assert!(found.independent && found.idle == 0);
    }
    // Of even numbers (315 / 17)².
    let due = (315.0_f64 / 17.0).powi(2);
    let even = gram(&torus_space(16, 10), 3).expect("a matrix");
    assert!((even.condition.expect("independent") / due - 1.0).abs() < 1e-9);
}

#[test]
fn functions_of_random_meshes_are_independent() {
    let mut surfaces = surfaces_with_zeros();
    surfaces.push(open_cylinder(Beyond::Pole { index: 0 }));
    for (seed, complex) in surfaces.iter().enumerate() {
        let space = random_space(complex, 30, seed as u64);
        let found = gram(&space, 1).expect("a matrix");
        println!("{found:?}");
        assert!(found.independent && found.idle == 0, "{found:?}");
        // The bounds of Gershgorin: a row of a positive matrix of ones has no more entries than unknowns.
        assert!(found.largest >= 1.0 && found.largest < space.unknowns() as f64);
        assert!(found.smallest.is_some_and(|s| s < 1.0));
    }
}

#[test]
fn functions_within_a_core_are_counted_as_idle() {
    let complex = large_double_torus();
    let mut space = random_space(&complex, 0, 0);
    // Halve what lies at a zero until four intervals fit in the core.
    for _ in 0..7 {
        let mut mesh = space.mesh().clone();
        for border in [0, 1] {
            let at = crate::tmesh::Side::High;
            let leaf = mesh.locate(border, [0, 0], [at, at]);
            mesh.split(leaf, Axis::Both);
            for other in mesh.neighbours(leaf) {
                mesh.split(other, Axis::Both);
            }
        }
        space = TSplineSpace::with_caps(mesh, space.caps().clone());
    }
    let found = gram(&space, 1).expect("a matrix");
    assert!(found.idle > 0, "{found:?}");
}

#[test]
fn surfaces_are_smooth_over_every_line() {
    let mut surfaces = surfaces_with_zeros();
    surfaces.push(open_cylinder(Beyond::Pole { index: 0 }));
    for (seed, complex) in surfaces.iter().enumerate() {
        let spline = random_spline(complex, 60, seed as u64);
        let found = continuity(&spline, &ContinuityOptions::default());
        println!("{found:?}");
        // Rounding, of second derivatives in thin columns.
        assert!(found.c2_jump() < 1e-8, "{found:?}");
        assert!(
            found.cap_c1_jump() < 1e-8 && found.cap_c2_jump() < 1e-8,
            "{found:?}"
        );
        assert!(found.centres.c1() < 1e-11, "{found:?}");
        let looked = [
            found.edges,
            found.t_junctions,
            found.cap_borders,
            found.core_borders,
        ];
        assert!(looked.iter().all(|jumps| jumps.crossings > 50), "{found:?}");
        let zeros = complex.zeros() > 0;
        assert_eq!(
            zeros,
            found.borders.crossings > 0 && found.rays.crossings > 0
        );
    }
}

#[test]
fn caps_of_few_units_are_as_smooth() {
    // Rounding of coordinates is a thousand times larger in such caps.
    for complex in surfaces_with_zeros() {
        let mut space = random_space(&complex, 20, 2);
        for cap in 0..space.caps().caps().len() as u32 {
            let radius = space.caps().caps()[cap as usize].limit;
            space.caps_mut().set_radius(cap, 1e-3 * radius);
        }
        let mut numbers = Sequence(8);
        let vector = |_| Vector3::from_fn(|_, _| numbers.unit() - 0.5);
        let control = (0..space.unknowns()).map(vector).collect();
        let spline = TSpline::new(Arc::new(space), control);
        let found = continuity(&spline, &ContinuityOptions::default());
        assert!(found.centres.c1() < 1e-9, "{found:?}");
    }
}

#[test]
fn the_same_seed_measures_the_same() {
    let spline = random_spline(&large_double_torus(), 20, 3);
    let options = ContinuityOptions::default();
    let first = continuity(&spline, &options);
    assert_eq!(first, continuity(&spline, &options));
    assert_ne!(
        first,
        continuity(&spline, &ContinuityOptions { seed: 7, ..options })
    );
}
