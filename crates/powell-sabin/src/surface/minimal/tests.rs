//! Minimal surfaces that are known.

use msplines_common::Vector3;
use msplines_common::mesh::TriangleMesh;
use msplines_conformal::Zero;

use super::{MinimalCap, Rim};
use crate::domain::FlatDomain;
use crate::spline::PowellSabinSpline;
use crate::surface::part::Part;
use crate::tests::{Random, jittered_grid};

/// Returns the cap in the middle of a grid, beside which the surface has these random gradients, its
/// relaxation, and the mesh.
fn spanned(lift: f64, bend: f64) -> (MinimalCap, super::Relaxed, TriangleMesh, Zero) {
    let whole = jittered_grid(6, 0.2, 3);
    let mesh = whole.mesh();
    let topology = mesh.topology();
    let inner = (0..mesh.vertex_count() as u32)
        .find(|&v| (mesh.positions()[v as usize].coords - Vector3::new(0.5, 0.5, 0.0)).norm() < 0.1)
        .expect("a vertex in the middle");
    let mut faces: Vec<u32> = topology.outgoing(inner).map(|h| h / 3).collect();
    faces.sort_unstable();
    let zero = Zero {
        order: 1,
        vertices: vec![inner],
        faces,
    };
    let rest = (0..mesh.face_count() as u32).filter(|f| !zero.faces.contains(f));
    let part = Part::new(mesh, rest.collect());
    let local = part.mesh(mesh).expect("a mesh");
    let vectors = part.pick_sides(whole.edge_vectors());
    let domain = FlatDomain::build(local, vectors).expect("a domain");
    let mut random = Random::new(8);
    let mut noise = |size: f64| size * (random.next() - 0.5);
    let vertices = domain.mesh().positions().iter();
    let values = vertices.clone().flat_map(|p| [p.x, p.y, lift * p.x * p.y]);
    let gradients = vertices.clone().flat_map(|p| {
        let [a, b, c, d] = [(); 4].map(|()| noise(bend));
        [1.0 + a, b, lift * p.y, c, 1.0 + d, lift * p.x]
    });
    let (values, gradients) = (values.collect(), gradients.collect());
    let regular = PowellSabinSpline::from_parts(domain.clone(), 3, values, gradients);
    let rim = Rim {
        mesh,
        regular: &regular.expect("a spline"),
        part: &part,
    };
    let (cap, relaxed) = MinimalCap::span(&rim, &zero).expect("a cap");
    (cap, relaxed, mesh.clone(), zero)
}

/// The area inside of the rim of a flat cap, by the integral of `x dy` along its quadratics.
fn enclosed(cap: &MinimalCap, zero: &Zero) -> f64 {
    let mut sum = 0.0;
    for cell in zero.faces.iter().flat_map(|&face| cap.cells(face)) {
        let [p, q, r, pq, qr, pr] = cell;
        for [a, m, b] in [[p, pq, q], [q, qr, r], [r, pr, p]] {
            let cross = |a: Vector3<f64>, b: Vector3<f64>| a.x * b.y - a.y * b.x;
            // Sides between cells cancel.
            sum += (2.0 * cross(a, m) + 2.0 * cross(m, b) + cross(a, b)) / 6.0;
        }
    }
    sum
}

#[test]
fn a_flat_rim_is_spanned_by_a_flat_disk() {
    for bend in [0.0, 0.6] {
        let (cap, relaxed, _, zero) = spanned(0.0, bend);
        assert!(relaxed.settled, "{relaxed:?}");
        assert!(cap.points().iter().all(|p| p.z.abs() < 1e-15));
        let due = enclosed(&cap, &zero);
        // Its area is that of the inside as long as nothing folds; quadrature of it is exact.
        assert!(
            (relaxed.area - due).abs() < 1e-12 * due,
            "{relaxed:?} {due}"
        );
    }
}

#[test]
fn area_decreases_below_that_of_the_hyperboloid() {
    // The rim lies on z = x y / 2, which is nearly minimal, up to its quadratic pieces.
    let (_, relaxed, mesh, zero) = spanned(0.5, 0.0);
    assert!(
        relaxed.settled && relaxed.area <= relaxed.start,
        "{relaxed:?}"
    );
    let lifted = zero.faces.iter().map(|&face| {
        let [a, b, c] = mesh
            .triangle(face)
            .map(|p| Vector3::new(p.x, p.y, 0.5 * p.x * p.y));
        0.5 * (b - a).cross(&(c - a)).norm()
    });
    // Facets of the vertices on the surface, the inner one included, span the chords of the rim.
    let facets: f64 = lifted.sum();
    assert!(
        (relaxed.area / facets - 1.0).abs() < 0.01,
        "{relaxed:?} {facets}"
    );
}
