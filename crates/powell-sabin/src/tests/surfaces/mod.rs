//! Surfaces over atlases with their holes filled.

mod hostile;
mod shape;
mod stored;

use msplines_common::Point3;
use msplines_common::evaluate::{EvaluateError, Order, Samples, SurfaceSpline};
use msplines_common::mesh::{SurfacePoint, TriangleMesh, shapes, zoo};
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

pub(crate) fn atlas(mesh: &TriangleMesh) -> Atlas {
    let found = Atlas::of_surface(mesh, &AtlasOptions::default(), &mut unobserved());
    found.expect("an atlas").atlas
}

pub(super) fn options(fill: Fill) -> SurfaceOptions {
    SurfaceOptions {
        fill,
        ..SurfaceOptions::default()
    }
}

pub(crate) fn fitted(mesh: &TriangleMesh, fill: Fill) -> (SurfaceFit, Vec<VertexCondition>) {
    let atlas = atlas(mesh);
    let normals = estimate_normals(atlas.mesh()).expect("normals");
    let conditions = VertexCondition::of_mesh(atlas.mesh(), &normals);
    let found = fit_surface(&atlas, &conditions, &options(fill), &mut unobserved());
    (found.expect("a surface"), conditions)
}

pub(super) fn samples(
    surface: &PowellSabinSurface,
    points: &[SurfacePoint],
    order: Order,
) -> Samples {
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

/// Largest sine between normals on both sides of a seam: rounding over lengths of edges in two charts.
const SEAM: f64 = 1e-6;

/// Largest jump of derivatives where no micro triangle is thin.
const JUMP: f64 = 1e-10;

#[test]
fn figures_of_smooth_surfaces_are_near_rounding() {
    for mesh in [
        shapes::genus(2, 2500),
        shapes::bumpy_sphere(3000),
        shapes::cylinder(600),
        shapes::height_field(900),
        zoo::genus(4),
    ] {
        let (found, conditions) = fitted(&mesh, Fill::Smooth);
        let checks = found.spline.measure(&conditions, 3, 4000);
        assert!(checks.position_max < POSITION, "{checks:?}");
        assert!(checks.normal_max < NORMAL, "{checks:?}");
        assert!(checks.seam_max < SEAM, "{checks:?}");
        assert!(checks.c1_jump_max < JUMP, "{checks:?}");
        assert!(checks.unity_max < 1e-12, "{checks:?}");
        assert!(checks.basis_min >= 0.0, "{checks:?}");
        assert_eq!(checks.orientation_violations, 0);
        assert_eq!((checks.folded_samples, checks.samples), (0, 4000));
        assert_eq!(checks, found.spline.measure(&conditions, 3, 4000));
    }
}

#[test]
fn a_moved_cap_is_seen_as_a_seam() {
    let (found, conditions) = fitted(&shapes::genus(2, 2500), Fill::Smooth);
    let mut parts = found.spline.parts();
    let crate::surface::CapParts::Smooth { gradients, .. } = &mut parts.holes[0].cap else {
        panic!("a smooth cap");
    };
    for gradient in gradients {
        gradient[0][2] += 0.01;
    }
    let mesh = found.spline.mesh().clone();
    let moved = PowellSabinSurface::from_parts(mesh, &parts).expect("a surface");
    let checks = moved.measure(&conditions, 3, 4000);
    // The blended side takes its gradient at the rim from the cap too: what jumps is the interpolation
    // of the normals.
    assert!(checks.normal_max > 1e-4, "{checks:?}");
}

#[test]
fn filled_surfaces_are_closed() {
    for (mesh, euler) in [
        (shapes::genus(2, 2500), -2),
        (shapes::sphere(500), 2),
        (shapes::torus(1.0, 0.4, 400), 0),
    ] {
        for fill in [Fill::Smooth, Fill::Minimal] {
            let (found, _) = fitted(&mesh, fill);
            let tessellation = found.spline.tessellate(5);
            let vertices = found.spline.mesh().vertex_count();
            let expected = samples(
                &found.spline,
                &tessellation.points[..vertices],
                Order::Value,
            );
            for (position, value) in tessellation
                .positions
                .iter()
                .zip(expected.values.as_chunks::<3>().0)
            {
                assert_eq!(position.coords.as_slice(), value);
            }
            let closed = TriangleMesh::build(tessellation.positions, tessellation.faces);
            let closed = closed.expect("a manifold");
            assert!(closed.topology().boundary_loops().is_empty());
            assert_eq!(closed.topology().euler_characteristic(), euler);
        }
    }
}

#[test]
fn both_sides_of_every_edge_are_one_curve() {
    for fill in [Fill::Smooth, Fill::Minimal] {
        let (found, _) = fitted(&shapes::genus(3, 4000), fill);
        let surface = &found.spline;
        let topology = surface.mesh().topology();
        let (mut own, mut other) = (Vec::new(), Vec::new());
        for edge in 0..topology.edge_count() as u32 {
            let h = topology.edge_half_edge(edge);
            let twin = topology.twin(h);
            for share in [0.17, 0.5, 0.81] {
                let on = |h: u32, share: f64| {
                    let mut at = [0.0; 3];
                    at[(h % 3) as usize] = 1.0 - share;
                    at[((h + 1) % 3) as usize] = share;
                    SurfacePoint { face: h / 3, at }
                };
                own.push(on(h, share));
                other.push(on(twin, 1.0 - share));
            }
        }
        let [a, b] = [own, other].map(|points| samples(surface, &points, Order::Value).values);
        let gap = a
            .iter()
            .zip(&b)
            .fold(0.0_f64, |max, (a, b)| max.max((a - b).abs()));
        assert!(gap < 1e-13, "{fill:?} {gap:e}");
    }
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().expect("threads").install(|| {
            let (found, _) = fitted(&shapes::genus(2, 2500), Fill::Smooth);
            let tessellation = found.spline.tessellate(3);
            let cells = found.spline.bezier_cells(1e-4);
            (
                found.spline.parts(),
                tessellation.positions,
                tessellation.normals,
                cells.cells,
            )
        })
    };
    assert!(run(1) == run(2));
}

#[test]
fn relabelled_surfaces_are_the_same() {
    let base = atlas(&shapes::genus(2, 2500));
    let mesh = base.mesh();
    let count = mesh.vertex_count() as u32;
    // A permutation without structure: multiplication by a number prime to the count.
    let factor = (3..)
        .step_by(2)
        .find(|f| gcd(*f, count) == 1)
        .expect("a factor");
    let name = |v: u32| (u64::from(v) * u64::from(factor) + 7) % u64::from(count);
    let mut positions = mesh.positions().to_vec();
    for (v, &p) in mesh.positions().iter().enumerate() {
        positions[name(v as u32) as usize] = p;
    }
    let turned = |f: usize, i: usize| (f, (i + f) % 3);
    let faces = mesh.faces().iter().enumerate().rev();
    let renamed = faces
        .clone()
        .map(|(f, corners)| [0, 1, 2].map(|i| name(corners[turned(f, i).1]) as u32));
    let other = TriangleMesh::build(positions, renamed.collect()).expect("a mesh");
    let form: Vec<[f64; 2]> = faces
        .flat_map(|(f, _)| [0, 1, 2].map(|i| base.form()[3 * f + turned(f, i).1]))
        .collect();
    let relabelled = Atlas::of_form(&other, &form).expect("an atlas");
    assert_eq!(
        relabelled.mesh().faces(),
        other.faces(),
        "nothing was flipped"
    );
    let fit = |atlas: &Atlas| {
        let normals = estimate_normals(atlas.mesh()).expect("normals");
        let conditions = VertexCondition::of_mesh(atlas.mesh(), &normals);
        let options = options(Fill::Smooth);
        let found = fit_surface(atlas, &conditions, &options, &mut unobserved());
        found.expect("a surface").spline
    };
    let (first, second) = (fit(&base), fit(&relabelled));
    let faces = mesh.face_count();
    let at = [0.2, 0.3, 0.5];
    let own = |f: usize| SurfacePoint { face: f as u32, at };
    let points: Vec<SurfacePoint> = (0..faces).map(own).collect();
    let same = (0..faces).map(|f| SurfacePoint {
        face: (faces - 1 - f) as u32,
        at: [0, 1, 2].map(|i| at[turned(f, i).1]),
    });
    let a = samples(&first, &points, Order::Value).values;
    let b = samples(&second, &same.collect::<Vec<_>>(), Order::Value).values;
    let gap = a
        .iter()
        .zip(&b)
        .fold(0.0_f64, |max, (a, b)| max.max((a - b).abs()));
    // Rounding of another elimination order.
    assert!(gap < 1e-10 * mesh.diagonal(), "{gap:e}");
}

fn gcd(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { gcd(b, a % b) }
}
