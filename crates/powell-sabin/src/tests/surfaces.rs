//! Surfaces over atlases with their holes filled.

use msplines_common::Point3;
use msplines_common::evaluate::{EvaluateError, Order, Samples, SurfaceSpline};
use msplines_common::mesh::{SurfacePoint, TriangleMesh, shapes};
use msplines_common::progress::unobserved;
use msplines_conformal::{Atlas, AtlasOptions};

use crate::surface::Cap;
use crate::{
    Fill, PowellSabinSurface, SurfaceFit, SurfaceOptions, VertexCondition, estimate_normals,
    fit_surface,
};

/// Positions are stored, and found again at barycentric coordinates with rounding of their chart.
const POSITION: f64 = 1e-14;

/// As positions, over lengths of edges.
const NORMAL: f64 = 1e-13;

fn atlas(mesh: &TriangleMesh) -> Atlas {
    let found = Atlas::of_surface(mesh, &AtlasOptions::default());
    found.expect("an atlas").atlas
}

fn options(fill: Fill) -> SurfaceOptions {
    SurfaceOptions {
        fill,
        ..SurfaceOptions::default()
    }
}

fn fitted(mesh: &TriangleMesh, fill: Fill) -> (SurfaceFit, Vec<VertexCondition>) {
    let atlas = atlas(mesh);
    let normals = estimate_normals(atlas.mesh()).expect("normals");
    let conditions = VertexCondition::of_mesh(atlas.mesh(), &normals);
    let found = fit_surface(&atlas, &conditions, &options(fill), &mut unobserved());
    (found.expect("a surface"), conditions)
}

fn samples(surface: &PowellSabinSurface, points: &[SurfacePoint], order: Order) -> Samples {
    let mut out = Samples::default();
    let prepared = surface.prepare(points, order).expect("points");
    prepared.evaluate(&mut out);
    out
}

/// The corners of all faces as points.
fn corners(mesh: &TriangleMesh) -> Vec<SurfacePoint> {
    let unit = |i: usize| std::array::from_fn(|k| f64::from(u8::from(k == i)));
    let faces = 0..mesh.face_count() as u32;
    faces
        .flat_map(|face| (0..3).map(move |i| SurfacePoint { face, at: unit(i) }))
        .collect()
}

/// Largest distance from the position, over the diagonal, and sine of the angle to the normal, at the
/// corners of all faces.
fn misses(surface: &PowellSabinSurface, conditions: &[VertexCondition]) -> [f64; 2] {
    let mesh = surface.mesh();
    let points = corners(mesh);
    let values = samples(surface, &points, Order::Value).values;
    let normals = surface.normals(&points).expect("points");
    let mut worst = [0.0_f64; 2];
    for ((point, value), own) in points.iter().zip(values.chunks_exact(3)).zip(normals) {
        let corner = point.at.iter().position(|&c| c == 1.0).expect("a corner");
        let vertex = mesh.faces()[point.face as usize][corner];
        let VertexCondition::Interpolate { position, normal } = conditions[vertex as usize] else {
            continue;
        };
        let miss = (Point3::from_slice(value) - position).norm() / mesh.diagonal();
        worst[0] = worst[0].max(miss);
        worst[1] = worst[1].max(normal.normalize().cross(&own).norm());
        assert!(normal.dot(&own) > 0.0, "vertex {vertex} is inside out");
    }
    worst
}

#[test]
fn open_surfaces_have_holes_at_the_zeros() {
    let (found, _) = fitted(&shapes::genus(2, 2500), Fill::Open);
    let surface = &found.spline;
    assert!(!surface.caps().is_empty());
    for hole in surface.caps() {
        let at = [1.0 / 3.0; 3];
        let face = hole.faces()[0];
        let points = [SurfacePoint { face, at }];
        let refused = surface.prepare(&points, Order::Value).err();
        assert_eq!(refused, Some(EvaluateError::InHole { point: 0, face }));
        let text = EvaluateError::InHole { point: 0, face }.to_string();
        assert!(text.contains(&face.to_string()) && text.contains("fill the holes"));
    }
    let tessellation = surface.tessellate(3);
    let mesh = TriangleMesh::build(tessellation.positions, tessellation.faces);
    let loops = mesh.expect("a manifold").topology().boundary_loops();
    assert_eq!(loops.len(), surface.caps().len());
}

#[test]
fn smooth_surfaces_pass_through_all_vertices_with_their_normals() {
    for mesh in [
        shapes::genus(2, 2500),
        shapes::genus(3, 4000),
        shapes::sphere(1500),
        shapes::bumpy_sphere(3000),
        shapes::torus(1.0, 0.4, 800),
    ] {
        let (found, conditions) = fitted(&mesh, Fill::Smooth);
        assert_eq!(found.report.warnings, []);
        let [position, normal] = misses(&found.spline, &conditions);
        assert!(position < POSITION, "{position:e}");
        assert!(normal < NORMAL, "{normal:e}");
        let smooth = |hole: &crate::surface::Hole| matches!(hole.cap(), Cap::Smooth(_));
        assert!(found.spline.caps().iter().all(smooth));
    }
}
