//! Inputs as runs see them, and knots taken from points.

use std::time::Instant;

use msplines_common::mesh::shapes;
use msplines_io::{Surface, write_surface};

use super::*;
use crate::generated::GeneratedSurface;

#[test]
fn a_refined_input_is_a_smoother_mesh_of_the_same_file() {
    let load = || {
        let input = Input::Surface(GeneratedSurface::BumpySphere500);
        load(&input, &mut PhaseClock::start(Instant::now())).expect("an input")
    };
    let (coarse, fine) = (load(), load().refined(2));
    assert_eq!(fine.mesh.face_count(), 16 * coarse.mesh.face_count());
    assert_eq!(fine.facts.faces, fine.mesh.face_count() as u64);
    assert_eq!(fine.facts.vertices, fine.mesh.vertex_count() as u64);
    assert_eq!(fine.facts.sha256, coarse.facts.sha256);
    assert_eq!(fine.facts.genus, Some(0));
}

#[test]
fn knots_are_the_nearest_vertices_each_once() {
    let mesh = shapes::sphere(200);
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("points.ply");
    let near = |vertex: usize| mesh.positions()[vertex] * 1.01;
    let points = Surface {
        positions: &[near(7), near(3), near(7)],
        faces: &[],
        ..Surface::default()
    };
    write_surface(&path, &points).expect("written");
    assert_eq!(nearest_vertices(&mesh, &path).expect("vertices"), [3, 7]);
    let error = nearest_vertices(&mesh, &folder.path().join("none.ply"));
    let text = error.expect_err("no such file").to_string();
    assert!(
        text.starts_with("--knots-from none.ply: cannot read"),
        "{text}"
    );
    let on_surface = nearest_points(&mesh, &path).expect("points");
    assert_eq!(on_surface.len(), 2);
    for (point, vertex) in on_surface.iter().zip([7, 3]) {
        let apart = (mesh.position(*point) - mesh.positions()[vertex]).norm();
        assert!(apart < 1e-9, "{apart}");
    }
}
