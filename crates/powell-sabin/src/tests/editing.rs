//! Edits: what changes, where, and what must not.

use msplines_common::evaluate::Order;
use msplines_common::mesh::SurfacePoint;
use msplines_common::{Point3, Vector3};

use super::fitting::{check_interpolation, fitted, torus_data};
use super::{Random, TORUS, interpolant, jet, jittered_grid, points, torus};
use crate::{
    EditError, FlatDomain, NewVertex, Options, PowellSabinSpline, Target, VertexCondition,
};

fn surface() -> (PowellSabinSpline, Vec<VertexCondition>) {
    let (domain, angles) = torus(8, 0.2);
    let data = torus_data(&angles);
    (fitted(&domain, &data, &Options::default()).spline, data)
}

/// Returns the faces of the first spline, of those it shares with the second, whose points moved.
fn changed(one: &PowellSabinSpline, two: &PowellSabinSpline) -> Vec<u32> {
    let faces = one.flat_domain().mesh().faces();
    let same = |&f: &u32| faces[f as usize] == two.flat_domain().mesh().faces()[f as usize];
    let moved = |&f: &u32| {
        (0..3).any(|c| {
            let pairs = one.ordinates(f, c).into_iter().zip(two.ordinates(f, c));
            pairs.into_iter().any(|(a, b)| (a - b).abs() > 1e-13)
        })
    };
    (0..faces.len() as u32).filter(same).filter(moved).collect()
}

fn has_corner(spline: &PowellSabinSpline, faces: &[u32], vertex: u32) -> bool {
    let corners = spline.flat_domain().mesh().faces();
    faces.iter().all(|&f| corners[f as usize].contains(&vertex))
}

#[test]
fn another_normal_changes_the_faces_around_alone() {
    let (spline, mut data) = surface();
    let vertex = 40;
    let turned = Vector3::new(0.2, -0.3, 0.9);
    let other = spline.with_normal(vertex, turned).expect("an edit");
    if let VertexCondition::Interpolate { normal, .. } = &mut data[vertex as usize] {
        *normal = turned;
    }
    check_interpolation(&other, &data);
    let changed = changed(&spline, &other);
    assert_eq!(changed.len(), 6);
    assert!(has_corner(&spline, &changed, vertex));
    // Opposite and the same normal are rotations too.
    let own = spline
        .with_normal(vertex, turned)
        .and_then(|s| s.with_normal(vertex, -turned));
    assert!(own.is_ok());
}

#[test]
fn a_scaled_control_triangle_keeps_position_and_normal() {
    let (spline, data) = surface();
    let other = spline
        .with_scaled_control_triangle(17, 1.5)
        .expect("an edit");
    check_interpolation(&other, &data);
    assert!(has_corner(&spline, &changed(&spline, &other), 17));
    let [a, b] = [&spline, &other].map(|s| s.control_triangles().expect("a surface")[17]);
    for k in 0..3 {
        let (before, after) = (
            (a[k] - a[(k + 1) % 3]).norm(),
            (b[k] - b[(k + 1) % 3]).norm(),
        );
        assert!((after / before - 1.5).abs() < 1e-12);
    }
}

#[test]
fn a_new_vertex_is_passed_through() {
    let (spline, mut data) = surface();
    for at in [[0.3, 0.3, 0.4], [0.0, 0.4, 0.6]] {
        let place = SurfacePoint { face: 30, at };
        let normal = Vector3::new(0.3, 0.4, 0.5);
        let offset = Vector3::new(0.01, 0.0, 0.02);
        let before = spline
            .evaluate_flat(&[place], Order::Value)
            .expect("a point")
            .values;
        let new = NewVertex {
            place,
            offset,
            normal: Some(normal),
        };
        let other = spline.with_vertex(&new).expect("an edit");
        let position = Point3::from_slice(&before) + offset;
        data.push(VertexCondition::Interpolate { position, normal });
        check_interpolation(&other, &data);
        let vertex = data.len() as u32 - 1;
        let faired = other
            .faired(&[vertex], &Options::default())
            .expect("a fit")
            .spline;
        check_interpolation(&faired, &data);
        let options = Options::default();
        assert!(faired.energy(&options) <= other.energy(&options) * (1.0 + 1e-12));
        assert!(has_corner(&other, &changed(&other, &faired), vertex));
        data.pop();
    }
}

#[test]
fn a_new_vertex_without_a_change_changes_quadratics_not_at_all() {
    let domain = jittered_grid(4, 0.3, 6);
    let height = |[x, y]: [f64; 2]| [x * x - x * y, 2.0 * x - y, -x];
    let graph = |domain: &FlatDomain| {
        let scalar = interpolant(domain, height);
        let (mut values, mut gradients) = (Vec::new(), Vec::new());
        for (v, p) in domain.mesh().positions().iter().enumerate() {
            values.extend([p.x, p.y, scalar.vertex_values()[v]]);
            let g = &scalar.vertex_gradients()[2 * v..2 * v + 2];
            gradients.extend([1.0, 0.0, g[0], 0.0, 1.0, g[1]]);
        }
        PowellSabinSpline::from_parts(domain.clone(), 3, values, gradients).expect("a graph")
    };
    let spline = graph(&domain);
    let mut random = Random::new(1);
    for edge in [false, true] {
        let mut at = random.barycentric();
        if edge {
            at = [0.25, 0.75, 0.0];
        }
        let new = NewVertex {
            place: SurfacePoint { face: 11, at },
            offset: Vector3::zeros(),
            normal: None,
        };
        let other = spline.with_vertex(&new).expect("an edit");
        for point in points(other.flat_domain(), 4, 2) {
            let s = other
                .evaluate_flat(&[point], Order::Value)
                .expect("a point")
                .values;
            assert!((s[2] - height([s[0], s[1]])[0]).abs() < 1e-13);
        }
    }
}

#[test]
fn a_new_vertex_without_a_change_stays_near() {
    // Where the surface is no quadratic it moves by less than what the face bends.
    let (spline, _) = surface();
    let place = SurfacePoint {
        face: 30,
        at: [0.3, 0.3, 0.4],
    };
    let new = NewVertex {
        place,
        offset: Vector3::zeros(),
        normal: None,
    };
    let other = spline.with_vertex(&new).expect("an edit");
    let distance = |s: &PowellSabinSpline| {
        let samples = s.evaluate_flat(&points(s.flat_domain(), 8, 1), Order::Value);
        let values = samples.expect("points").values;
        values.chunks_exact(3).map(off_torus).fold(0.0, f64::max)
    };
    assert!(distance(&other) < 1.5 * distance(&spline));
}

fn off_torus(p: &[f64]) -> f64 {
    ((p[0].hypot(p[1]) - TORUS[0]).hypot(p[2]) - TORUS[1]).abs()
}

fn nearest(p: &Point3<f64>) -> (Point3<f64>, Vector3<f64>) {
    let round = p.x.hypot(p.y);
    let centre = Point3::new(p.x / round * TORUS[0], p.y / round * TORUS[0], 0.0);
    let normal = (p - centre).normalize();
    (centre + TORUS[1] * normal, normal)
}

#[test]
fn refinement_where_it_is_worst_lowers_the_error() {
    let (mut spline, data) = surface();
    let worst = |s: &PowellSabinSpline| {
        let samples = s.evaluate_flat(&points(s.flat_domain(), 10, 1), Order::Value);
        samples
            .expect("points")
            .values
            .chunks_exact(3)
            .map(off_torus)
            .fold(0.0, f64::max)
    };
    let before = worst(&spline);
    for _ in 0..4 {
        let first = spline.flat_domain().mesh().vertex_count() as u32;
        let faces = spline
            .worst_faces(60, &mut |p| nearest(p).0)
            .expect("a surface");
        assert_eq!(faces.len(), 60);
        let mut target = |_: SurfacePoint, here: Target| {
            let (position, normal) = nearest(&here.position);
            Target {
                position,
                normal: Some(normal),
            }
        };
        spline = spline.refined(&faces, &mut target).expect("a refinement");
        let count = spline.flat_domain().mesh().vertex_count() as u32;
        assert_eq!(count, first + 60);
        let all: Vec<u32> = (0..count).collect();
        spline = spline
            .faired(&all, &Options::default())
            .expect("a fit")
            .spline;
    }
    check_interpolation(&spline, &data);
    let after = worst(&spline);
    assert!(after < 0.5 * before, "{before} {after}");
    assert_eq!(spline.flat_domain().topology().euler_characteristic(), 0);
}

#[test]
fn flat_delaunay_edges_are_delaunay() {
    let mut random = Random::new(8);
    let plane: Vec<[f64; 2]> = (0..80).map(|_| [random.next(), random.next()]).collect();
    let expected = FlatDomain::planar(&plane).expect("a domain");
    // Vertices are inserted one after another into two triangles, without any flip but one pass at the
    // end.
    let corners = [[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]];
    let faces = vec![[0, 1, 2], [0, 2, 3]];
    let mut domain = FlatDomain::planar_with_faces(&corners, faces).expect("a square");
    for p in &plane {
        let position = Point3::new(p[0], p[1], 0.0);
        let place = (0..domain.mesh().face_count() as u32).find_map(|face| {
            let [a, b, c] = domain.mesh().triangle(face);
            let area = |x: Point3<f64>, y: Point3<f64>, z: Point3<f64>| (y - x).cross(&(z - x)).z;
            let whole = area(a, b, c);
            let at = [
                area(position, b, c),
                area(a, position, c),
                area(a, b, position),
            ];
            at.iter()
                .all(|&x| x > 0.0)
                .then(|| (face, at.map(|x| x / whole), position))
        });
        domain = domain
            .with_vertices_in_faces(&[place.expect("a face")])
            .expect("a domain");
    }
    let found = domain.flat_delaunay().expect("flips");
    let normal = |mut face: [u32; 3], shift: u32| {
        face.iter_mut().for_each(|v| *v -= shift);
        let first = (0..3).min_by_key(|&i| face[i]).unwrap_or(0);
        face.rotate_left(first);
        face
    };
    let mut inner: Vec<[u32; 3]> = found
        .mesh()
        .faces()
        .iter()
        .filter(|f| f.iter().all(|&v| v > 3))
        .map(|&f| normal(f, 4))
        .collect();
    inner.sort_unstable();
    // Faces at the outer square differ; all others are the Delaunay triangulation's.
    let due: Vec<[u32; 3]> = expected
        .mesh()
        .faces()
        .iter()
        .map(|&f| normal(f, 0))
        .collect();
    let missing = due
        .iter()
        .filter(|f| inner.binary_search(f).is_err())
        .count();
    assert!(
        missing <= 12 && inner.iter().all(|f| due.contains(f)),
        "{missing} of {}",
        due.len()
    );
}

#[test]
fn edits_that_are_none_are_refused() {
    let (spline, data) = surface();
    let vertices = data.len();
    let error = |result: Result<PowellSabinSpline, EditError>| result.expect_err("no edit");
    let normal = Vector3::z();
    let missing = EditError::NoSuchVertex {
        vertex: vertices as u32,
        vertices,
    };
    assert_eq!(error(spline.with_normal(vertices as u32, normal)), missing);
    assert_eq!(
        error(spline.with_normal(3, Vector3::zeros())),
        EditError::Value { vertex: 3 }
    );
    for factor in [0.0, -1.0, f64::NAN, 1e308] {
        let found = error(spline.with_scaled_control_triangle(3, factor));
        assert_eq!(found, EditError::Value { vertex: 3 });
    }
    let faces = spline.flat_domain().mesh().face_count();
    let insert = |face: u32, at: [f64; 3], offset: Vector3<f64>| {
        error(spline.with_vertex(&NewVertex {
            place: SurfacePoint { face, at },
            offset,
            normal: None,
        }))
    };
    let zero = Vector3::zeros();
    let face = faces as u32;
    assert_eq!(
        insert(face, [0.3, 0.3, 0.4], zero),
        EditError::NoSuchFace { face, faces }
    );
    for at in [[1.0, 0.0, 0.0], [0.7, 0.7, -0.4]] {
        assert_eq!(insert(2, at, zero), EditError::Place { face: 2, at });
    }
    let far = Vector3::new(f64::INFINITY, 0.0, 0.0);
    let found = insert(2, [0.3, 0.3, 0.4], far);
    assert_eq!(
        found,
        EditError::Value {
            vertex: vertices as u32
        }
    );
    let found = error(spline.refined(&[4, 5, 4], &mut |_, here| here));
    assert_eq!(found, EditError::RepeatedFace { face: 4 });
    assert!(found.to_string().contains("face 4"));
    let function = interpolant(&jittered_grid(2, 0.0, 1), |_| [1.0, 0.0, 0.0]);
    assert!(matches!(
        error(function.with_normal(0, normal)),
        EditError::Spline(_)
    ));
    let point = SurfacePoint {
        face: 0,
        at: [0.2, 0.3, 0.5],
    };
    assert_eq!(jet(&function, point)[0], 1.0);
}
