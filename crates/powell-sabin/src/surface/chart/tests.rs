//! Charts over faces that say nothing.

use msplines_common::Point3;
use msplines_common::mesh::{TriangleMesh, shapes};
use nalgebra::Complex;

use super::{Chart, Reach};
use crate::surface::error::NoSmoothCap;
use crate::tests::surfaces::atlas;

/// Returns the chart around the first zero of a double torus; near it the mesh is changed.
fn chart(change: impl Fn(&mut [Point3<f64>], u32, [u32; 2])) -> Chart {
    let atlas = atlas(&shapes::genus(2, 2500));
    let zero = &atlas.zeros()[0];
    let topology = atlas.mesh().topology();
    let inner = zero.vertices[0];
    let opposite = topology.outgoing(inner).next().expect("a face");
    let mut corners = atlas.mesh().faces()[(opposite / 3) as usize];
    corners.rotate_left((opposite % 3) as usize);
    let mut positions = atlas.mesh().positions().to_vec();
    change(&mut positions, inner, [corners[1], corners[2]]);
    let mesh = TriangleMesh::build(positions, atlas.mesh().faces().to_vec()).expect("a mesh");
    let in_hole = |face: u32| atlas.zeros().iter().any(|z| z.faces.contains(&face));
    let reach = Reach {
        covered: 1,
        rings: 3,
    };
    Chart::build(&mesh, atlas.form(), in_hole, zero, reach).expect("a disk")
}

#[test]
fn straight_angles_have_weights() {
    // The vertex lies on the side opposite to it: half of its angle there has no tangent.
    let mut chart = chart(|positions, inner, [a, b]| {
        let across = positions[a as usize] - positions[b as usize];
        positions[inner as usize] = Point3::origin();
        positions[a as usize] = Point3::from(across);
        positions[b as usize] = Point3::from(-across);
    });
    chart.place_zero().expect("a chart");
    assert!(chart.w.iter().all(|w| w.re.is_finite() && w.im.is_finite()));
}

#[test]
fn a_place_that_is_none_ends_the_search_for_angles() {
    let mut chart = chart(|_, _, _| ());
    chart.z0 = Complex::new(f64::NAN, 0.0);
    assert_eq!(chart.angles(), Err(NoSmoothCap::Folded));
}
