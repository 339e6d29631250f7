//! Laws of the choice of poles.

use msplines_common::mesh::{TriangleMesh, shapes};
use msplines_common::progress::unobserved;
use nalgebra::{Point3, Vector3};

use super::{ProtrusionOptions, Protrusions};

fn found(mesh: &TriangleMesh) -> Protrusions {
    let options = ProtrusionOptions::default();
    Protrusions::of(mesh, &options, &mut unobserved()).expect("poles")
}

/// A sphere drawn out along directions, each spike one and a half radii long and a third of one wide.
fn with_spikes(directions: &[Vector3<f64>]) -> TriangleMesh {
    let sphere = shapes::sphere(6000);
    let moved = |p: &Point3<f64>| {
        let unit = p.coords.normalize();
        let near = |d: &Vector3<f64>| (-((unit - d.normalize()).norm() / 0.35).powi(2)).exp();
        let out: f64 = directions.iter().map(near).sum();
        Point3::from(unit * (1.0 + 1.5 * out))
    };
    sphere.with_positions(sphere.positions().iter().map(moved).collect())
}

/// The vertices that stand out farthest along directions.
fn farthest(mesh: &TriangleMesh, directions: &[Vector3<f64>]) -> Vec<u32> {
    let of = |d: &Vector3<f64>| {
        let along = |v: &u32| mesh.positions()[*v as usize].coords.dot(&d.normalize());
        let vertices = 0..mesh.vertex_count() as u32;
        vertices
            .max_by(|a, b| along(a).total_cmp(&along(b)))
            .expect("a vertex")
    };
    directions.iter().map(of).collect()
}

fn axes(count: usize) -> Vec<Vector3<f64>> {
    let all = [
        [1.0, 0.1, 0.2],
        [-0.4, 1.0, 0.0],
        [-0.5, -0.9, 0.3],
        [0.1, -0.1, 1.0],
        [0.0, 0.2, -1.0],
    ];
    all[..count].iter().map(|d| Vector3::from(*d)).collect()
}

#[test]
fn a_sphere_with_spikes_gets_their_tips() {
    // Of four and more, poles chosen one by one may take the foot of a spike for its tip.
    for count in 2..=3 {
        let mesh = with_spikes(&axes(count));
        let poles = found(&mesh);
        let tips = farthest(&mesh, &axes(count));
        // The sides of the body may get some more.
        assert!(poles.vertices.len() >= count, "{:?}", poles.variances);
        for tip in tips {
            let at = |v: u32| mesh.positions()[v as usize];
            let off = poles.vertices.iter();
            let off = off.map(|&v| (at(v) - at(tip)).norm());
            // Of the two and a half radii from the centre to the tip; vertices are a fifth of one apart.
            let off = off.fold(f64::MAX, f64::min);
            let all: Vec<_> = poles.vertices.iter().map(|&v| at(v)).collect();
            assert!(off < 0.5, "{count}: {} is {off} off {all:?}", at(tip));
        }
        // All poles beyond two together bring what they have to.
        let (first, last) = (
            poles.variances[0],
            poles.variances[poles.variances.len() - 1],
        );
        let gain = ProtrusionOptions::default().gain * (poles.variances.len() - 1) as f64;
        assert!(last <= first - gain, "{:?}", poles.variances);
    }
}

#[test]
fn a_sphere_needs_two_poles_and_a_finger_of_a_torus_one_at_its_tip() {
    let sphere = found(&shapes::sphere(2000));
    assert_eq!(sphere.vertices.len(), 2);
    let torus = crate::tests::with_finger(40);
    let poles = found(&torus).vertices;
    // Vertex 100 is the tip of the finger.
    let near = |v: u32| v == 100 || torus.topology().neighbours(100).any(|n| n == v);
    assert!(poles.iter().any(|&v| near(v)), "{poles:?}");
}

#[test]
fn numbers_of_vertices_do_not_count() {
    let mesh = with_spikes(&axes(4));
    let count = mesh.vertex_count() as u32;
    let renamed = |v: u32| (v * 7 + 5) % count;
    assert!(!count.is_multiple_of(7), "a permutation");
    let mut positions = mesh.positions().to_vec();
    for (v, p) in (0..count).zip(mesh.positions()) {
        positions[renamed(v) as usize] = *p;
    }
    let faces = mesh.faces().iter().map(|f| f.map(renamed)).collect();
    let other = TriangleMesh::build(positions, faces).expect("a mesh");
    let expected: Vec<u32> = found(&mesh).vertices.into_iter().map(renamed).collect();
    assert_eq!(found(&other).vertices, expected);
}

#[test]
fn the_choice_is_the_same_on_any_number_of_threads() {
    let mesh = with_spikes(&axes(3));
    let [one, three] = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(|| found(&mesh))
    });
    assert_eq!(one, three);
}

#[test]
fn no_more_poles_are_taken_than_asked_for() {
    let options = ProtrusionOptions {
        most: 3,
        ..ProtrusionOptions::default()
    };
    let mesh = with_spikes(&axes(5));
    let few = Protrusions::of(&mesh, &options, &mut unobserved()).expect("poles");
    assert_eq!(few.vertices, found(&mesh).vertices[..3]);
    let sheet = shapes::height_field(100);
    assert!(Protrusions::of(&sheet, &options, &mut unobserved()).is_err());
}
