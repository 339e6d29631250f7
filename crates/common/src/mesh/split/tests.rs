//! Split meshes are the same surface, and know where everything went.

use std::sync::LazyLock;

use nalgebra::{Point3, Vector3};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};

use super::*;
use crate::mesh::{Facts, NONE, shapes, zoo};

/// Rounding of a few operations on numbers of size one.
const ROUNDING: f64 = 1e-12;

static ZOO: LazyLock<Vec<TriangleMesh>> = LazyLock::new(zoo::all);

fn on(face: u32, at: [f64; 3]) -> SurfacePoint {
    SurfacePoint { face, at }
}

fn unit(corner: usize) -> [f64; 3] {
    std::array::from_fn(|i| if i == corner { 1.0 } else { 0.0 })
}

/// Returns two triangles over the square, with the diagonal from vertex 0 to vertex 2.
fn square() -> TriangleMesh {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let corners = corners.map(|[x, y]| Point3::new(x, y, 0.0));
    TriangleMesh::build(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap()
}

/// Splits and checks everything that holds for all points.
fn split(mesh: &TriangleMesh, points: &[SurfacePoint]) -> SplitMesh {
    let split = split_at(mesh, points).unwrap();
    let fine = &split.mesh;
    fine.topology().sanity_check();
    let (before, after) = (Facts::measure(mesh), Facts::measure(fine));
    assert_eq!(
        (before.genus, before.boundary_loops, before.components),
        (after.genus, after.boundary_loops, after.components)
    );
    let (old, new) = fine.positions().split_at(mesh.vertex_count());
    assert_eq!(old, mesh.positions());
    assert_eq!(new.len(), split.places.len());
    for (position, &place) in new.iter().zip(&split.places) {
        assert_eq!(*position, mesh.position(place));
    }
    // What is near becomes one vertex.
    let reach = 4.0 * ON_SIDE * before.edge_length.max;
    for (&point, &vertex) in points.iter().zip(&split.vertices) {
        let found = fine.positions()[vertex as usize];
        assert!((mesh.position(point) - found).norm() <= reach);
    }
    assert_same_surface(mesh, &split);
    split
}

/// Checks that the faces in each face face the same side and have its area together.
fn assert_same_surface(mesh: &TriangleMesh, split: &SplitMesh) {
    assert_eq!(split.parents.len(), split.mesh.face_count());
    assert!(split.parents.is_sorted());
    let mut sums = vec![Vector3::zeros(); mesh.face_count()];
    let mut areas = vec![0.0; mesh.face_count()];
    for (face, &parent) in split.parents.iter().enumerate() {
        let normal = split.mesh.face_normal(face as u32);
        sums[parent as usize] += normal;
        areas[parent as usize] += normal.norm();
    }
    for face in 0..mesh.face_count() as u32 {
        let [a, b, c] = mesh.triangle(face);
        let normal = mesh.face_normal(face);
        // A needle has the area of its rounding.
        let size = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        let bound = ROUNDING * size * size;
        assert!((sums[face as usize] - normal).norm() < bound);
        assert!((areas[face as usize] - normal.norm()).abs() < bound);
    }
}

/// Checks that a point is found again where it was.
fn assert_located(mesh: &TriangleMesh, split: &SplitMesh, point: SurfacePoint) {
    let found = split.locate(point);
    assert_eq!(split.parents[found.face as usize], point.face);
    assert!(found.at.iter().all(|x| (0.0..=1.0).contains(x)));
    assert!((found.at.iter().sum::<f64>() - 1.0).abs() < 1e-15);
    let error = (split.mesh.position(found) - mesh.position(point)).norm();
    assert!(error < ROUNDING * mesh.diagonal(), "{point:?}: {error}");
}

#[test]
fn no_points_change_nothing() {
    for mesh in ZOO.iter() {
        let split = split(mesh, &[]);
        assert_eq!(split.mesh.faces(), mesh.faces());
        assert_eq!(split.mesh.positions(), mesh.positions());
    }
}

#[test]
fn a_point_at_a_vertex_is_that_vertex() {
    for mesh in ZOO.iter() {
        let corners = |face: u32| (0..3).map(move |corner| on(face, unit(corner)));
        let points: Vec<_> = (0..mesh.face_count() as u32).flat_map(corners).collect();
        let split = split(mesh, &points);
        assert_eq!(split.vertices, mesh.faces().concat());
        assert!(split.places.is_empty());
    }
    let near = [
        on(1, [1.0 - 4e-10, 2e-10, 2e-10]),
        on(0, [-1e-10, 0.0, 1.0]),
    ];
    assert_eq!(split(&square(), &near).vertices, [0, 2]);
}

#[test]
fn a_point_on_an_edge_cuts_both_faces_and_is_one_vertex_from_either_side() {
    // The diagonal runs from corner 2 to corner 0 of face 0 and from 0 to 1 of face 1.
    let split = split(
        &square(),
        &[on(0, [0.75, 1e-10, 0.25]), on(1, [0.75, 0.25, 0.0])],
    );
    assert_eq!(split.vertices, [4, 4]);
    assert_eq!(split.mesh.face_count(), 4);
    assert_eq!(split.parents, [0, 0, 1, 1]);
    assert!((split.mesh.positions()[4] - Point3::new(0.25, 0.25, 0.0)).norm() < 1e-15);
    assert_eq!(split.mesh.topology().neighbours(4).count(), 4);
}

#[test]
fn a_point_on_the_boundary_stays_on_the_boundary() {
    let mesh = zoo::with_boundary();
    let topology = mesh.topology();
    let boundary = (0..3 * mesh.face_count() as u32).filter(|&h| topology.twin(h) == NONE);
    let points: Vec<_> = boundary
        .map(|h| {
            on(
                h / 3,
                Weights::on_side((h % 3) as usize, ONE / 3).to_coordinates(),
            )
        })
        .collect();
    let split = split(&mesh, &points);
    let boundary = split.mesh.topology().boundary_loops();
    assert_eq!(boundary[0].len(), 2 * points.len());
    for &vertex in &split.vertices {
        assert!(split.mesh.topology().is_boundary_vertex(vertex));
    }
}

#[test]
fn edges_are_replaced_by_their_pieces_in_order() {
    let points = [
        on(0, [0.25, 0.0, 0.75]),
        on(1, [0.5, 0.5, 0.0]),
        on(0, [0.9, 0.0, 0.1]),
        on(0, [0.5, 0.5, 0.0]),
    ];
    let split = split(&square(), &points);
    let [far, middle, near, other] = split.vertices[..] else {
        panic!("four points have four vertices")
    };
    assert_eq!(
        split.edges(&[[2, 0], [2, 3], [0, 1], [0, 2]]),
        [
            [2, far],
            [far, middle],
            [middle, near],
            [near, 0],
            [2, 3],
            [0, other],
            [other, 1],
            [0, near],
            [near, middle],
            [middle, far],
            [far, 2],
        ]
    );
    let topology = split.mesh.topology();
    for [a, b] in split.edges(&[[2, 0], [0, 1]]) {
        assert!(topology.neighbours(a).any(|vertex| vertex == b));
    }
}

#[test]
fn thousands_of_points_in_one_face_are_all_its_vertices() {
    let mut random = rand_pcg::Pcg64::seed_from_u64(1);
    let mut point = || {
        let [u, v]: [f64; 2] = [random.random(), random.random()];
        let (u, v) = if u + v > 1.0 {
            (1.0 - u, 1.0 - v)
        } else {
            (u, v)
        };
        on(1, [1.0 - u - v, u, v])
    };
    let points: Vec<_> = (0..5_000).map(|_| point()).collect();
    let split = split(&square(), &points);
    assert_eq!(split.mesh.vertex_count(), 5_004);
    assert_eq!(split.mesh.face_count(), 2 + 2 * 5_000);
    for _ in 0..1_000 {
        assert_located(&square(), &split, point());
    }
}

#[test]
fn the_order_of_the_points_does_not_matter() {
    let mesh = &ZOO[0];
    let point = |i: u32| {
        let (u, v) = (f64::from(i % 7) / 13.0, f64::from(i % 5) / 11.0);
        on(i % 3, [1.0 - u - v, u, v])
    };
    let mut points: Vec<_> = (0..60).map(point).collect();
    let first = split(mesh, &points);
    points.reverse();
    let second = split(mesh, &points);
    assert_eq!(first.mesh.faces(), second.mesh.faces());
    assert_eq!(first.mesh.positions(), second.mesh.positions());
    assert!(first.vertices.iter().eq(second.vertices.iter().rev()));
}

#[test]
fn points_that_are_not_on_the_mesh_are_refused() {
    let mesh = square();
    let refuse = |point| {
        split_at(&mesh, &[on(0, unit(0)), point])
            .unwrap_err()
            .to_string()
    };
    assert_eq!(
        refuse(on(2, unit(0))),
        "point 1 lies on face 2, but there are 2 faces; give points of this mesh"
    );
    assert_eq!(
        refuse(on(1, [0.5, 0.75, -0.25])),
        "point 1 has the barycentric coordinates [0.5, 0.75, -0.25], which are not in face 1; \
         give three numbers that are not negative and sum to one"
    );
    for at in [
        [0.5, 0.5, 0.5],
        [0.0; 3],
        [f64::NAN, 0.5, 0.5],
        [f64::INFINITY, f64::NEG_INFINITY, 1.0],
        [f64::INFINITY, 0.0, 0.0],
    ] {
        assert!(refuse(on(1, at)).starts_with("point 1 has the barycentric"));
    }
}

#[test]
fn faces_with_more_than_one_common_side_cannot_be_joined_twice() {
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Point3::from);
    let pillow = TriangleMesh::build(corners.to_vec(), vec![[0, 1, 2], [0, 2, 1]]).unwrap();
    let points = [on(0, [0.5, 0.5, 0.0]), on(0, [0.0, 0.5, 0.5])];
    let refused = split_at(&pillow, &points).unwrap_err();
    assert!(matches!(refused, SplitError::Topology(_)));
    assert!(refused.to_string().contains("share more than one side"));
}

#[test]
fn a_point_outside_of_its_face_is_located_at_the_nearest_side() {
    let split = split(&square(), &[on(0, [0.25, 0.5, 0.25])]);
    let found = split.locate(on(0, [0.5, 0.5, -1e-6]));
    let position = split.mesh.position(found);
    assert!(position.y.abs() < ROUNDING && (position.x - 0.5).abs() < 1e-6);
    for at in [[f64::NAN; 3], [0.0; 3], [f64::INFINITY; 3]] {
        assert_eq!(split.parents[split.locate(on(0, at)).face as usize], 0);
    }
}

#[test]
fn a_sphere_split_everywhere_keeps_area_and_volume() {
    let mesh = shapes::sphere(400);
    let points: Vec<_> = (0..mesh.face_count() as u32)
        .flat_map(|face| [[0.2, 0.3, 0.5], [0.4, 0.6, 0.0], [0.0, 0.3, 0.7]].map(|at| on(face, at)))
        .collect();
    let split = split(&mesh, &points);
    let (before, after) = (Facts::measure(&mesh), Facts::measure(&split.mesh));
    assert!((after.area / before.area - 1.0).abs() < ROUNDING);
    assert!((after.volume.unwrap() / before.volume.unwrap() - 1.0).abs() < ROUNDING);
}

/// Points of every kind: inside, on sides, at corners, and a hair beside of each.
fn points() -> impl Strategy<Value = Vec<(u32, [f64; 3])>> {
    let hair = prop::sample::select(vec![0.0, 1e-17, 1e-13, 1e-10, 9e-10, 1.1e-9, 1e-8, 1e-5]);
    let at = (0usize..4, 0usize..3, 0.0..1.0f64, 0.0..1.0f64, hair);
    let at = at.prop_map(|(kind, turn, u, v, hair)| {
        let mut at = match kind {
            0 => [hair, u * (1.0 - hair), (1.0 - u) * (1.0 - hair)],
            1 => [1.0 - hair, hair * u, hair * (1.0 - u)],
            2 => [
                1.0 / 3.0 + hair,
                1.0 / 3.0 - hair * u,
                1.0 / 3.0 - hair * (1.0 - u),
            ],
            _ => [u * v, u * (1.0 - v), 1.0 - u],
        };
        at.rotate_left(turn);
        at
    });
    prop::collection::vec((any::<u32>(), at), 1..60)
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 200, failure_persistence: None, ..ProptestConfig::default()
    })]

    #[test]
    fn any_points_become_vertices_of_the_same_surface(
        which in 0..5usize,
        spread in prop::sample::select(vec![1u32, 4, 50, u32::MAX]),
        squeeze in prop::sample::select(vec![1.0, 1e-3, 1e-7]),
        points in points(),
        queries in points(),
    ) {
        let mesh = &ZOO[which];
        let squeezed = |p: &Point3<f64>| Point3::new(p.x, p.y * squeeze, p.z * squeeze);
        let mesh = mesh.with_positions(mesh.positions().iter().map(squeezed).collect());
        let faces = spread.min(mesh.face_count() as u32);
        let place = |points: &[(u32, [f64; 3])]| -> Vec<_> {
            points.iter().map(|&(face, at)| on(face % faces, at)).collect()
        };
        let points = place(&points);
        let split = split(&mesh, &points);
        for point in place(&queries).into_iter().chain(points) {
            assert_located(&mesh, &split, point);
        }
        let topology = mesh.topology();
        let edges: Vec<_> = (0..topology.edge_count() as u32)
            .map(|edge| topology.edge_vertices(edge))
            .collect();
        let fine = split.mesh.topology();
        for [a, b] in split.edges(&edges) {
            prop_assert!(fine.neighbours(a).any(|vertex| vertex == b));
        }
    }
}
