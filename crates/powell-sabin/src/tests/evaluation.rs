//! Derivatives, normals, Bézier cells and tessellations.

use std::collections::BTreeMap;

use msplines_common::bspline::CellShape;
use msplines_common::evaluate::{Domain, EvaluateError, Order, Samples, SurfaceSpline};
use msplines_common::mesh::{SurfacePoint, TriangleMesh};

use super::{points, random_spline, torus, torus_point};
use crate::{FlatDomain, PowellSabinSpline, SplineError};

/// Returns the spline with the torus' values and derivatives at the vertices.
fn exact_torus(n: usize) -> PowellSabinSpline {
    let (domain, angles) = torus(n, 0.2);
    let jets: Vec<[[f64; 3]; 3]> = angles.into_iter().map(torus_point).collect();
    let values = jets.iter().flat_map(|j| j[0]).collect();
    let gradients = jets.iter().flat_map(|j| [j[1], j[2]]).flatten().collect();
    PowellSabinSpline::from_parts(domain, 3, values, gradients).expect("a torus")
}

fn sample(spline: &PowellSabinSpline, at: &[SurfacePoint], order: Order) -> Samples {
    let mut out = Samples::default();
    spline
        .prepare(at, order)
        .expect("points")
        .evaluate(&mut out);
    out
}

#[test]
fn derivatives_in_the_frame_equal_differences() {
    let spline = exact_torus(6);
    let mesh = spline.flat_domain().mesh().clone();
    let step = 1e-5;
    for point in points(spline.flat_domain(), 2, 4) {
        let triangle = spline.flat_domain().macro_triangle(point.face);
        let inside = triangle.locate(point.at).at.iter().all(|&c| c > 0.02);
        if !inside {
            continue;
        }
        let [along, across] = mesh.face_frame(point.face);
        let [a, b, c] = mesh.triangle(point.face);
        // Barycentric steps of a step along a direction of the plane of the face.
        let normal = mesh.face_normal(point.face);
        let moved = |x: f64, y: f64| {
            let way = step * (x * along + y * across);
            let second = way.cross(&(c - a)).dot(&normal) / normal.norm_squared();
            let third = (b - a).cross(&way).dot(&normal) / normal.norm_squared();
            let at = [
                point.at[0] - second - third,
                point.at[1] + second,
                point.at[2] + third,
            ];
            sample(&spline, &[SurfacePoint { at, ..point }], Order::Value).values
        };
        let s = sample(&spline, &[point], Order::Second);
        let grid = |x: f64, y: f64| moved(x, y);
        let centre = moved(0.0, 0.0);
        for (c, centre) in centre.iter().enumerate() {
            let (px, mx) = (grid(1.0, 0.0)[c], grid(-1.0, 0.0)[c]);
            let (py, my) = (grid(0.0, 1.0)[c], grid(0.0, -1.0)[c]);
            let mixed =
                grid(1.0, 1.0)[c] - grid(1.0, -1.0)[c] - grid(-1.0, 1.0)[c] + grid(-1.0, -1.0)[c];
            let square = step * step;
            // On one quadratic differences are exact but for rounding: 1e-16 / 1e-5, / 1e-10.
            for (found, expected) in [
                (s.first[c], (px - mx) / (2.0 * step)),
                (s.first[3 + c], (py - my) / (2.0 * step)),
            ] {
                assert!((found - expected).abs() < 1e-9, "{found} {expected}");
            }
            for (found, expected) in [
                (s.second[c], (px - 2.0 * centre + mx) / square),
                (s.second[3 + c], mixed / (4.0 * square)),
                (s.second[6 + c], (py - 2.0 * centre + my) / square),
            ] {
                assert!((found - expected).abs() < 1e-4, "{found} {expected}");
            }
        }
    }
}

#[test]
fn flat_derivatives_at_vertices_are_those_stored() {
    let spline = exact_torus(5);
    let topology = spline.flat_domain().topology();
    for vertex in 0..spline.flat_domain().mesh().vertex_count() as u32 {
        for h in topology.outgoing(vertex) {
            let mut at = [0.0; 3];
            at[(h % 3) as usize] = 1.0;
            let s = spline
                .evaluate_flat(&[SurfacePoint { face: h / 3, at }], Order::First)
                .expect("a vertex");
            assert_eq!(s.values, spline.vertex_values()[3 * vertex as usize..][..3]);
            assert_eq!(
                s.first,
                spline.vertex_gradients()[6 * vertex as usize..][..6]
            );
        }
    }
}

#[test]
fn cells_are_the_surface() {
    let spline = exact_torus(4);
    let cells = spline.bezier_cells().expect("cells");
    assert_eq!(
        (cells.shape(), cells.degree()),
        (CellShape::Triangles, Some([2, 0, 0]))
    );
    assert_eq!(cells.len(), 6 * spline.flat_domain().mesh().face_count());
    for point in points(spline.flat_domain(), 3, 8) {
        let at = spline
            .flat_domain()
            .macro_triangle(point.face)
            .locate(point.at);
        let [u, v, w] = at.at;
        let cell = &cells.points()[6 * (6 * point.face as usize + at.micro)..][..6];
        let bernstein = [u * u, 2.0 * u * v, v * v, 2.0 * u * w, 2.0 * v * w, w * w];
        let found = sample(&spline, &[point], Order::Value).values;
        for c in 0..3 {
            let sum: f64 = bernstein.iter().zip(cell).map(|(b, p)| b * p[c]).sum();
            assert!((sum - found[c]).abs() < 1e-14);
        }
    }
}

#[test]
fn tessellations_are_closed_and_their_normals_exact() {
    let spline = exact_torus(16);
    for segments in 1..6 {
        let t = spline.tessellate(segments).expect("a tessellation");
        let mut sides: BTreeMap<[u32; 2], u32> = BTreeMap::new();
        for face in &t.faces {
            for k in 0..3 {
                *sides.entry([face[k], face[(k + 1) % 3]]).or_default() += 1;
            }
        }
        assert!(
            sides
                .iter()
                .all(|(&[a, b], &n)| n == 1 && sides.contains_key(&[b, a]))
        );
        let mesh = TriangleMesh::build(t.positions.clone(), t.faces.clone()).expect("a manifold");
        assert_eq!(mesh.topology().euler_characteristic(), 0);
        let faces = spline.flat_domain().mesh().face_count();
        assert_eq!(mesh.face_count(), faces * (segments * segments) as usize);
        for (face, corners) in t.faces.iter().enumerate() {
            let facet = mesh.face_normal(face as u32).normalize();
            for &vertex in corners {
                let normal = t.normals[vertex as usize];
                assert!((normal.norm() - 1.0).abs() < 1e-14);
                assert!(
                    normal.dot(&facet) > 0.7,
                    "face {face}: {}",
                    normal.dot(&facet)
                );
            }
        }
    }
}

#[test]
fn points_outside_are_refused() {
    let spline = exact_torus(3);
    let faces = spline.flat_domain().mesh().face_count();
    let prepare = |face: u32, at: [f64; 3]| {
        spline
            .prepare(&[SurfacePoint { face, at }], Order::First)
            .err()
    };
    let centre = [0.25, 0.25, 0.5];
    let face = faces as u32;
    let missing = EvaluateError::NoSuchFace {
        point: 0,
        face,
        faces,
    };
    assert_eq!(prepare(face, centre), Some(missing));
    let outside = EvaluateError::OutsideFace { point: 0, face: 2 };
    for at in [[1.5, -0.5, 0.0], [0.3; 3], [f64::NAN, 0.5, 0.5]] {
        assert_eq!(prepare(2, at), Some(outside.clone()));
    }
    assert_eq!(prepare(2, centre), None);
    assert!(matches!(spline.domain(), Domain::Triangles(mesh) if mesh.face_count() == faces));
}

#[test]
fn faces_without_area_have_flat_derivatives_only() {
    let domain = FlatDomain::planar(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]).expect("a triangle");
    let vectors = domain.edge_vectors().to_vec();
    let line = [0.0, 1.0, 2.0].map(|x| msplines_common::Point3::new(x, 0.0, 0.0));
    let mesh = domain.mesh().with_positions(line.to_vec());
    let spline = random_spline(&FlatDomain::build(mesh, vectors).expect("a domain"), 1, 1);
    let point = [SurfacePoint {
        face: 0,
        at: [0.2, 0.3, 0.5],
    }];
    assert!(spline.evaluate_flat(&point, Order::Second).is_ok());
    assert!(spline.prepare(&point, Order::Value).is_ok());
    let error = spline
        .prepare(&point, Order::First)
        .err()
        .expect("an error");
    assert!(
        error.to_string().contains("face 0 of the mesh has no area"),
        "{error}"
    );
    assert!(spline.normals(&point).is_err());
    let cells = spline.bezier_cells();
    assert_eq!(cells, Err(SplineError::NotASurface { dimension: 1 }));
}
