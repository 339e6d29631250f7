//! Laws of maps to the surface of the cube.

use msplines_common::mesh::{TriangleMesh, shapes, subdivide_midpoint};
use msplines_common::progress::unobserved;
use nalgebra::Point3;

use super::*;

fn mapped(surface: &TriangleMesh, corners: &[u32; 8], border: Border) -> BoundaryMap {
    let options = BoundaryOptions {
        border,
        ..BoundaryOptions::default()
    };
    map(surface, corners, &options, &mut unobserved()).unwrap()
}

fn found(surface: &TriangleMesh) -> [u32; 8] {
    find_corners(
        surface,
        Frame {
            turn: 0.0,
            evenness: 0.15,
        },
    )
}

fn refused(surface: &TriangleMesh, corners: &[u32; 8]) -> BoundaryError {
    map(
        surface,
        corners,
        &BoundaryOptions::default(),
        &mut unobserved(),
    )
    .unwrap_err()
}

/// The unit cube in `n` steps along each side, and its corners.
fn cube(n: u32) -> (TriangleMesh, [u32; 8]) {
    let surface = shapes::box_solid([n; 3]).boundary();
    let positions: Vec<_> = surface
        .positions()
        .iter()
        .map(|p| p / f64::from(n))
        .collect();
    let corners = std::array::from_fn(|corner| {
        let at = Point3::from(crate::domain::cube::corner_position(corner));
        positions.iter().position(|p| *p == at).unwrap() as u32
    });
    (surface.with_positions(positions), corners)
}

/// A flat cube is its own image, whatever the border; only rounding differs.
const ROUNDING: f64 = 1e-12;

fn is_identity(map: &BoundaryMap, tolerance: f64) {
    for (p, q) in map.surface.positions().iter().zip(&map.parameters) {
        assert!((p - Point3::from(*q)).norm() < tolerance, "{p} {q:?}");
    }
}

#[test]
fn a_cube_is_reproduced_with_fixed_borders() {
    let (surface, corners) = cube(6);
    let map = mapped(&surface, &corners, Border::Fixed);
    is_identity(&map, ROUNDING);
    assert!((map.report.energy.unwrap() - 4.0).abs() < ROUNDING);
    assert_eq!(
        (
            map.report.folded,
            map.report.convex_patches,
            map.splits.len()
        ),
        (0, 0, 0)
    );
}

#[test]
fn a_cube_is_reproduced_with_free_borders() {
    let (surface, corners) = cube(6);
    let map = mapped(&surface, &corners, Border::Free);
    is_identity(&map, ROUNDING);
    assert_eq!(map.report.folded, 0);
}

#[test]
fn a_sphere_is_mapped_without_folds() {
    let surface = shapes::sphere(2000);
    let corners = found(&surface);
    let fixed = mapped(&surface, &corners, Border::Fixed);
    let sliding = mapped(&surface, &corners, Border::Sliding { evaluations: 100 });
    for map in [&fixed, &sliding] {
        assert_eq!(map.report.folded, 0);
        for (parameter, mask) in map.parameters.iter().zip(&map.masks) {
            for face in (0..6).filter(|face| mask >> face & 1 == 1) {
                assert_eq!(parameter[face / 2], (face % 2) as f64);
            }
            assert!(parameter.iter().all(|x| (0.0..=1.0).contains(x)));
        }
    }
    assert!(sliding.report.energy < fixed.report.energy);
    assert!(fixed.report.energy.unwrap() < 5.0, "{:?}", fixed.report);
    let free = mapped(&surface, &corners, Border::Free);
    assert_eq!(free.report.folded, 0);
}

#[test]
fn patches_do_not_depend_on_where_the_surface_is() {
    let surface = shapes::bumpy_sphere(3000);
    let corners = found(&surface);
    let turn = nalgebra::Rotation3::from_euler_angles(0.3, 1.0, -0.7);
    let moved = surface
        .positions()
        .iter()
        .map(|p| turn * p * 7.0 + nalgebra::Vector3::repeat(100.0));
    let moved = surface.with_positions(moved.collect());
    assert_eq!(found(&moved), corners);
    let [here, there] = [&surface, &moved].map(|s| mapped(s, &corners, Border::Fixed));
    assert_eq!(here.labels, there.labels);
    for (p, q) in here.parameters.iter().zip(&there.parameters) {
        (0..3).for_each(|d| assert!((p[d] - q[d]).abs() < 1e-9));
    }
}

/// Eight corners on neighbouring vertices leave no way between paths: edges are split.
#[test]
fn crowded_corners_are_mapped_by_splitting_edges() {
    let (sphere, _) = subdivide_midpoint(&shapes::sphere(100), 1);
    let mut corners = vec![0u32];
    for vertex in sphere.topology().neighbours(0) {
        corners.push(vertex);
        corners.extend(sphere.topology().neighbours(vertex));
    }
    corners.sort_unstable();
    corners.dedup();
    let corners: [u32; 8] = std::array::from_fn(|corner| corners[corner]);
    let map = mapped(&sphere, &corners, Border::Fixed);
    assert!(map.report.corridor_splits > 0, "{:?}", map.report);
    assert_eq!(map.report.folded, 0);
}

#[test]
fn the_smallest_cube_is_mapped() {
    let (surface, corners) = cube(1);
    is_identity(&mapped(&surface, &corners, Border::Fixed), ROUNDING);
}

#[test]
fn bad_surfaces_are_refused_by_place() {
    let torus = shapes::torus(2.0, 1.0, 400);
    let corners = [0, 1, 2, 3, 4, 5, 6, 7];
    let message = refused(&torus, &corners).to_string();
    assert_eq!(
        message,
        "the surface has genus 1, not 0; give one without tunnels or handles"
    );
    let open = shapes::height_field(200);
    assert!(matches!(
        refused(&open, &corners),
        BoundaryError::Open { loops: 1, .. }
    ));
    let sphere = shapes::sphere(100);
    let tetrahedron: Vec<_> = sphere.positions()[..4].to_vec();
    let tetrahedron = TriangleMesh::build(
        tetrahedron,
        vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]],
    )
    .unwrap();
    assert_eq!(
        refused(&tetrahedron, &corners),
        BoundaryError::TooSmall { vertices: 4 }
    );
    let mut positions = sphere.positions().to_vec();
    positions[9].y = f64::NAN;
    let broken = sphere.with_positions(positions);
    assert_eq!(
        refused(&broken, &corners),
        BoundaryError::NotFinite { vertex: 9 }
    );
}

#[test]
fn bad_corners_are_refused_by_name() {
    let sphere = shapes::sphere(100);
    let mut corners = found(&sphere);
    corners[6] = corners[2];
    let message = refused(&sphere, &corners).to_string();
    let vertex = corners[2];
    assert_eq!(
        message,
        format!(
            "corners 2 and 6 lie on one spot, at vertices {vertex} and {vertex}; choose eight points apart from each other"
        )
    );
    corners[6] = 1_000_000;
    assert!(matches!(
        refused(&sphere, &corners),
        BoundaryError::NoVertex {
            corner: 6,
            vertex: 1_000_000,
            ..
        }
    ));
}

#[test]
fn options_without_meaning_are_refused() {
    let sphere = shapes::sphere(100);
    let mut options = BoundaryOptions::default();
    options.routing.reach = 0.0;
    let error = map(&sphere, &found(&sphere), &options, &mut unobserved()).unwrap_err();
    assert_eq!(error.to_string(), "`reach` is 0; give a number above 0");
}

#[test]
fn the_observer_can_stop() {
    let sphere = shapes::sphere(100);
    let error = map(
        &sphere,
        &found(&sphere),
        &BoundaryOptions::PAPER,
        &mut |_: &Progress| ControlFlow::Break(()),
    );
    assert_eq!(error.unwrap_err(), BoundaryError::Stopped);
}
