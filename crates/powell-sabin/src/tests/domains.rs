//! What is no domain, and what is no spline.

use msplines_common::mesh::{TopologyError, TriangleMesh};

use super::{jittered_grid, torus};
use crate::{DomainError, FlatDomain, PowellSabinSpline, SplineError, estimate_normals};

fn square() -> (TriangleMesh, Vec<[f64; 2]>) {
    let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let faces = vec![[0, 1, 2], [0, 2, 3]];
    let domain = FlatDomain::planar_with_faces(&points, faces).expect("a square");
    (domain.mesh().clone(), domain.edge_vectors().to_vec())
}

fn error(change: impl FnOnce(&mut Vec<[f64; 2]>)) -> DomainError {
    let (mesh, mut vectors) = square();
    change(&mut vectors);
    FlatDomain::build(mesh, vectors).expect_err("no domain")
}

#[test]
fn vectors_that_do_not_fit_are_refused() {
    let found = error(|v| v.truncate(5));
    assert_eq!(
        found,
        DomainError::VectorCount {
            found: 5,
            half_edges: 6
        }
    );
    for bad in [f64::NAN, f64::INFINITY, 1e200] {
        let found = error(|v| v[4][1] = bad);
        assert_eq!(found, DomainError::VectorNotFinite { face: 1, side: 1 });
    }
    let found = error(|v| v[3] = [0.0, 0.0]);
    assert_eq!(found, DomainError::VectorNotFinite { face: 1, side: 0 });
    let found = error(|v| v[3][0] += 1e-3);
    assert!(
        found.to_string().contains("faces [0, 1] disagree") && found.to_string().contains("(2, 0)"),
        "{found}"
    );
    let found = error(|v| v[0][0] += 1e-3);
    assert!(
        matches!(found, DomainError::FaceOpen { face: 0, .. }),
        "{found}"
    );
    assert!(found.to_string().contains("must be closed"));
    // Mirrored, both faces are clockwise.
    let found = error(|v| v.iter_mut().for_each(|v| v[0] = -v[0]));
    assert!(matches!(
        found,
        DomainError::FaceNotPositive {
            face: 0,
            vertices: [0, 1, 2],
            ..
        }
    ));
    assert!(found.to_string().contains("flat area -5.0e-1"), "{found}");
    let found = error(|v| v.iter_mut().for_each(|v| v[1] *= 1e-17));
    assert!(
        matches!(found, DomainError::FaceNotPositive { .. }),
        "{found}"
    );
}

#[test]
fn a_zero_of_the_form_is_refused() {
    // Twelve faces of 60 degrees around one vertex: a simple zero.
    let positions = (0..13).map(|k| match k {
        0 => [0.0; 3],
        k => {
            let angle = f64::from(k) * std::f64::consts::TAU / 12.0;
            [angle.cos(), angle.sin(), 0.0]
        }
    });
    let positions = positions.map(msplines_common::Point3::from).collect();
    let faces = (1..13).map(|k| [0, k, k % 12 + 1]).collect();
    let mesh = TriangleMesh::build(positions, faces).expect("a fan");
    let ray = |k: u32| {
        let angle = f64::from(k) * std::f64::consts::FRAC_PI_3;
        [angle.cos(), angle.sin()]
    };
    let vectors = (1..13).flat_map(|k| {
        let (a, b) = (ray(k), ray(k + 1));
        [a, [b[0] - a[0], b[1] - a[1]], [-b[0], -b[1]]]
    });
    let found = FlatDomain::build(mesh, vectors.collect()).expect_err("a cone");
    assert!(
        matches!(found, DomainError::ConePoint { vertex: 0, turns } if (turns - 2.0).abs() < 1e-9)
    );
    assert!(found.to_string().contains("zero of the 1-form"));
}

#[test]
fn points_that_are_no_planar_domain_are_refused() {
    let planar = |points: &[[f64; 2]]| FlatDomain::planar(points).expect_err("no domain");
    assert_eq!(planar(&[]), DomainError::NoTriangle { points: 0 });
    assert_eq!(
        planar(&[[0.0, 0.0], [1.0, 0.0]]),
        DomainError::NoTriangle { points: 2 }
    );
    let line = [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]];
    assert_eq!(planar(&line), DomainError::NoTriangle { points: 3 });
    let repeated = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 0.0]];
    assert!(matches!(
        planar(&repeated),
        DomainError::RepeatedPoint { .. }
    ));
    let bad = [[0.0, 0.0], [1.0, f64::NAN], [0.0, 1.0]];
    assert_eq!(planar(&bad), DomainError::PositionNotFinite { vertex: 1 });
    let points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    let clockwise = FlatDomain::planar_with_faces(&points, vec![[0, 2, 1]]);
    assert!(matches!(
        clockwise,
        Err(DomainError::FaceNotPositive { face: 0, .. })
    ));
    let missing = FlatDomain::planar_with_faces(&points, vec![[0, 1, 3]]);
    let expected = TopologyError::IndexOutOfRange {
        face: 0,
        vertex: 3,
        vertices: 3,
    };
    assert_eq!(missing.err(), Some(DomainError::Topology(expected)));
}

#[test]
fn any_unit_of_length_will_do() {
    for scale in [1e-60, 1e60] {
        let points: Vec<[f64; 2]> = [[0.0, 0.0], [1.0, 0.0], [0.3, 1.0], [0.9, 1.2]]
            .iter()
            .map(|p| [scale * p[0], scale * p[1]])
            .collect();
        let domain = FlatDomain::planar(&points).expect("a domain");
        assert!(domain.edge_splits().iter().all(|&s| s > 0.0 && s < 1.0));
        assert!(
            crate::powell_sabin_triangles(&domain)
                .iter()
                .all(|t| t.area() > 0.0)
        );
    }
}

#[test]
fn edges_are_split_on_the_line_of_the_incentres() {
    let domain = jittered_grid(6, 0.4, 2);
    let topology = domain.topology();
    let plane = |face: u32, at: [f64; 3]| {
        domain
            .mesh()
            .position(msplines_common::mesh::SurfacePoint { face, at })
    };
    for h in (0..3 * domain.mesh().face_count() as u32).filter(|&h| topology.twin(h) != u32::MAX) {
        let (i, twin) = ((h % 3) as usize, topology.twin(h));
        let share = domain.edge_splits()[h as usize];
        let mut at = [0.0; 3];
        at[i] = 1.0 - share;
        at[(i + 1) % 3] = share;
        let split = plane(h / 3, at);
        let [own, other] = [h / 3, twin / 3].map(|f| plane(f, domain.macro_triangle(f).incentre()));
        let area = (own - split).cross(&(other - split)).norm();
        assert!(area < 1e-15, "{area:e}");
        assert!((share + domain.edge_splits()[twin as usize] - 1.0).abs() < 1e-15);
    }
}

#[test]
fn numbers_that_are_no_spline_are_refused() {
    let domain = torus(3, 0.0).0;
    let n = domain.mesh().vertex_count();
    let build = |values: usize, gradients: usize, d: usize| {
        PowellSabinSpline::from_parts(domain.clone(), d, vec![0.0; values], vec![0.0; gradients])
    };
    assert!(build(3 * n, 6 * n, 3).is_ok());
    for (values, gradients, d) in [
        (0, 0, 0),
        (n, 2 * n, 3),
        (3 * n, 3 * n, 3),
        (n, 2 * n, usize::MAX),
    ] {
        let found = build(values, gradients, d);
        assert!(matches!(found, Err(SplineError::WrongLength { .. })));
    }
    let mut gradients = vec![0.0; 2 * n];
    gradients[9] = f64::NAN;
    let found = PowellSabinSpline::from_parts(domain.clone(), 1, vec![0.0; n], gradients);
    assert_eq!(found.err(), Some(SplineError::NotFinite { vertex: 4 }));
}

#[test]
fn normals_of_a_sphere_are_exact() {
    let mesh = msplines_common::mesh::shapes::sphere(500);
    let normals = estimate_normals(&mesh).expect("normals");
    for (normal, position) in normals.iter().zip(mesh.positions()) {
        assert!((normal - position.coords.normalize()).norm() < 1e-12);
    }
    let flat = mesh.with_positions(vec![msplines_common::Point3::origin(); mesh.vertex_count()]);
    let error = estimate_normals(&flat).expect_err("no normals");
    assert!(error.to_string().contains("vertex 0"), "{error}");
}
