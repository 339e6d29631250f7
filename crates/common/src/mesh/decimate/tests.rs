//! Laws of decimation.

use nalgebra::{Rotation3, Vector3};
use proptest::prelude::*;

use super::*;
use crate::mesh::{Facts, shapes, subdivide_midpoint, zoo};
use crate::metrics::distance;

#[test]
fn the_exact_count_is_reached_and_the_topology_kept() {
    for mesh in zoo::all() {
        let before = Facts::measure(&mesh);
        for target in [
            mesh.vertex_count(),
            mesh.vertex_count() - 1,
            mesh.vertex_count() / 4,
        ] {
            let found = decimate(&mesh, target).unwrap();
            found.mesh.topology().sanity_check();
            let after = Facts::measure(&found.mesh);
            assert_eq!(after.vertices, target);
            assert_eq!(after.genus, before.genus);
            assert_eq!(after.boundary_loops, before.boundary_loops);
            assert!(found.vertex_origin.windows(2).all(|pair| pair[0] < pair[1]));
        }
    }
}

#[test]
fn a_subdivided_polyhedron_decimates_to_itself() {
    let coarse = shapes::sphere(12);
    let (fine, _) = subdivide_midpoint(&coarse, 3);
    let found = decimate(&fine, 12).unwrap();
    let apart = distance(&coarse, &found.mesh, 2_000, 1).unwrap();
    assert!(apart.max < 1e-9, "{apart:?}");
}

#[test]
fn vertices_stay_where_the_surface_bends() {
    let patch = shapes::height_field(1_600);
    let wave = |p: &Point3<f64>| {
        let height = if p.x > 0.0 {
            0.1 * (9.0 * p.x).sin() * (9.0 * p.y).sin()
        } else {
            0.0
        };
        Point3::new(p.x, p.y, height)
    };
    let mesh = patch.with_positions(patch.positions().iter().map(wave).collect());
    let coarse = decimate(&mesh, 300).unwrap().mesh;
    let flat = coarse.positions().iter().filter(|p| p.x < -0.05).count();
    assert!(flat < 60, "{flat} of 300 vertices lie in the flat half");
}

#[test]
fn a_boundary_stays_where_it_is() {
    let patch = decimate(&zoo::with_boundary(), 60).unwrap().mesh;
    for cycle in patch.topology().boundary_loops() {
        for half_edge in cycle {
            let p = patch.positions()[patch.topology().origin(half_edge) as usize];
            let off = (p.x.abs().max(p.y.abs()) - 1.0).abs();
            assert!(off < 0.02, "{p}");
        }
    }
}

#[test]
fn limits_are_named() {
    let mesh = shapes::sphere(42);
    assert_eq!(
        decimate(&mesh, 43).unwrap_err().to_string(),
        "43 vertices are asked for, but the mesh has only 42; ask for fewer, or subdivide first"
    );
    assert!(matches!(
        decimate(&mesh, 3).unwrap_err(),
        DecimateError::Stalled {
            target: 3,
            reached: 4..
        }
    ));
    assert!(decimate(&shapes::torus(2.0, 1.0, 100), 4).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..Default::default() })]

    #[test]
    fn scaling_and_moving_far_away_change_nothing_but_rounding(
        power in -20i32..20,
        axis in prop::array::uniform3(-1.0..1.0f64),
        target in 80usize..400,
    ) {
        let mesh = zoo::closed();
        // A power of two scales every step exactly.
        let scale = 2f64.powi(power);
        let scaled = mesh.with_positions(mesh.positions().iter().map(|p| p * scale).collect());
        let one = decimate(&mesh, target).unwrap().mesh;
        let two = decimate(&scaled, target).unwrap().mesh;
        prop_assert_eq!(one.faces(), two.faces());
        let turn = Rotation3::new(Vector3::from(axis));
        let turned = mesh.with_positions(mesh.positions().iter().map(|p| turn * p).collect());
        let three = decimate(&turned, target).unwrap().mesh;
        prop_assert_eq!(three.vertex_count(), target);
        prop_assert_eq!(Facts::measure(&three).genus, Some(0));
    }
}
