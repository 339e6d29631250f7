//! Laws that sparse manifolds keep on every control mesh.

use msplines_common::mesh::polygon::{CreaseTag, INFINITELY_SHARP, PolygonMesh, Rules, Sharpness};
use msplines_common::mesh::shapes;
use msplines_common::progress::unobserved;
use msplines_sparse_manifold::{Local, Options, SparseManifold, Tessellator, fit};
use nalgebra::{Point3, Rotation3, Vector3};
use rayon::ThreadPoolBuilder;

/// What 500 steps of conjugate gradients leave, in lengths of control edges: 1.6e-8 at most.
const SETTLED: f64 = 1e-6;

/// Control meshes of several genera, with boundary, of high valence, and with creases.
fn controls() -> Vec<(&'static str, PolygonMesh, Vec<CreaseTag>)> {
    let box_mesh = shapes::jittered(&shapes::box_surface([1, 2, 3]), 0.1, 3);
    let edge = box_mesh.topology().edge_vertices(0);
    let tag = CreaseTag {
        vertices: edge,
        sharpness: INFINITELY_SHARP,
    };
    vec![
        ("box", box_mesh.clone(), Vec::new()),
        ("box with a crease", box_mesh, vec![tag]),
        ("genus 2", shapes::slab_with_holes(2), Vec::new()),
        ("valence 9", shapes::trapezohedron(9), Vec::new()),
        ("patch", shapes::quad_patch(3), Vec::new()),
    ]
}

fn fitted(mesh: &PolygonMesh, tags: &[CreaseTag]) -> SparseManifold {
    fitted_by(&Options::default(), mesh, tags)
}

fn fitted_by(options: &Options, mesh: &PolygonMesh, tags: &[CreaseTag]) -> SparseManifold {
    let rules = Rules::default();
    let sharpness = Sharpness::build(mesh.topology(), rules, tags).expect("tags of this mesh");
    let fit = fit(mesh, &sharpness, rules, options, &mut unobserved());
    fit.expect("a surface").spline
}

fn points(spline: &SparseManifold) -> Vec<Point3<f64>> {
    Tessellator::build(spline, 5).surface(spline).positions
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    for (name, mesh, tags) in controls() {
        let with = |threads| {
            let pool = ThreadPoolBuilder::new().num_threads(threads).build();
            let pool = pool.expect("threads");
            pool.install(|| points(&fitted(&mesh, &tags)))
        };
        let one = with(1);
        for threads in [2, 3] {
            assert_eq!(one, with(threads), "{name}, {threads} threads");
        }
    }
}

#[test]
fn doubling_the_control_mesh_doubles_the_surface_to_the_bit() {
    for (name, mesh, tags) in controls() {
        let doubled = mesh.positions().iter().map(|p| p * 2.0).collect();
        let large = mesh.with_positions(doubled);
        let pairs = points(&fitted(&mesh, &tags));
        let pairs = pairs.iter().zip(points(&fitted(&large, &tags)));
        for (small, large) in pairs {
            assert_eq!(small * 2.0, large, "{name}");
        }
    }
}

/// Which of two atoms that are as good comes first is a matter of rounding, so that sparse surfaces
/// agree as far as they fit; polynomials leave nothing to choose, once their coefficients have
/// settled.
#[test]
fn turning_the_control_mesh_turns_the_surface() {
    let turn = Rotation3::new(Vector3::new(0.3, -1.1, 0.7));
    let polynomials = Options {
        local: Local::Polynomial { degree: None },
        frozen_sweeps: 500,
        least_progress: 0.0,
        ..Options::default()
    };
    for (options, bound) in [(polynomials, SETTLED), (Options::default(), 5e-3)] {
        for (name, mesh, tags) in controls() {
            let turned = mesh.with_positions(mesh.positions().iter().map(|p| turn * p).collect());
            let pairs = points(&fitted_by(&options, &mesh, &tags));
            let pairs = pairs
                .iter()
                .zip(points(&fitted_by(&options, &turned, &tags)));
            let apart = pairs.map(|(p, q)| (turn * p - q).norm());
            let worst = apart.fold(0.0, f64::max) / mesh.mean_edge_length();
            assert!(worst < bound, "{name}: {worst:e}");
        }
    }
}

/// Charts of a plane are plane: no atom leaves it.
#[test]
fn a_flat_control_mesh_gives_a_flat_surface() {
    let mesh = shapes::quad_patch(4);
    let flat = mesh.with_positions(
        mesh.positions()
            .iter()
            .map(|p| Point3::new(p.x, p.y, 0.0))
            .collect(),
    );
    let found = points(&fitted(&flat, &[]));
    assert!(found.iter().all(|p| p.z == 0.0));
}
