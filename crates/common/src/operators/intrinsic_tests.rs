use std::collections::BTreeSet;

use nalgebra::Point3;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use spade::Triangulation as _;

use super::*;

/// The area is conserved up to rounding that a chain of flips accumulates.
const CONSERVED: f64 = 1e-9;

/// The angle of a sliver loses the digits of its aspect ratio.
const CONSERVED_ANGLE: f64 = 1e-7;

type Edge = (u32, u32);

/// A torus of `m × n` vertices whose grid is sheared along the tube, so that triangles are slivers.
fn sheared_torus(m: u32, n: u32, shear: f64) -> TriangleMesh {
    let at = |i: u32, j: u32| (i % m) * n + j % n;
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    for i in 0..m {
        for j in 0..n {
            let u = f64::from(i) / f64::from(m) * std::f64::consts::TAU;
            let turn = f64::from(j) / f64::from(n) + shear * u.sin();
            let v = turn * std::f64::consts::TAU;
            let radius = 3.0 + v.cos();
            positions.push(Point3::new(radius * u.cos(), radius * u.sin(), v.sin()));
            faces.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            faces.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    TriangleMesh::build(positions, faces).unwrap()
}

/// A square of `n × n` vertices at given heights.
fn height_field(n: u32, stretch: f64, height: impl Fn(u32) -> f64) -> TriangleMesh {
    let mut faces = Vec::new();
    for i in 0..n - 1 {
        for j in 0..n - 1 {
            let v = i * n + j;
            faces.push([v, v + n, v + n + 1]);
            faces.push([v, v + n + 1, v + 1]);
        }
    }
    let position = |v| Point3::new(f64::from(v / n) * stretch, f64::from(v % n), height(v));
    TriangleMesh::build((0..n * n).map(position).collect(), faces).unwrap()
}

/// A tall thin double pyramid over a triangle: Delaunay edges wind around it.
fn tall_double_pyramid() -> TriangleMesh {
    let mut positions = vec![Point3::new(0.0, 0.0, 100.0), Point3::new(0.3, 0.1, -100.0)];
    for i in 0..3 {
        let turn = f64::from(i) * 2.1;
        positions.push(Point3::new(turn.cos(), turn.sin(), 30.0 * f64::from(i)));
    }
    let faces = vec![
        [0, 2, 3],
        [0, 3, 4],
        [0, 4, 2],
        [1, 3, 2],
        [1, 4, 3],
        [1, 2, 4],
    ];
    TriangleMesh::build(positions, faces).unwrap()
}

fn mesh_lengths(mesh: &TriangleMesh) -> Vec<[f64; 3]> {
    let length = |p: [Point3<f64>; 3], i: usize| (p[(i + 1) % 3] - p[i]).norm();
    let faces = 0..mesh.face_count() as u32;
    faces
        .map(|f| [0, 1, 2].map(|i| length(mesh.triangle(f), i)))
        .collect()
}

fn angles(sides: [f64; 3]) -> [f64; 3] {
    // At corner i meet sides i and i + 2.
    [0, 1, 2].map(|i| {
        let (p, q, l) = (sides[i], sides[(i + 2) % 3], sides[(i + 1) % 3]);
        (4.0 * triangle_area(p, q, l)).atan2(p * p + q * q - l * l)
    })
}

fn angle_sums(vertices: usize, faces: &[[u32; 3]], lengths: &[[f64; 3]]) -> Vec<f64> {
    let mut sums = vec![0.0; vertices];
    for (corners, &sides) in faces.iter().zip(lengths) {
        for (vertex, angle) in corners.iter().zip(angles(sides)) {
            sums[*vertex as usize] += angle;
        }
    }
    sums
}

fn area(lengths: &[[f64; 3]]) -> f64 {
    lengths
        .iter()
        .map(|&[a, b, c]| triangle_area(a, b, c))
        .sum()
}

/// The edges that lie on an odd number of triangles.
fn boundary(faces: &[[u32; 3]], lengths: &[[f64; 3]]) -> Vec<(Edge, u64)> {
    let mut edges = BTreeSet::new();
    for (corners, sides) in faces.iter().zip(lengths) {
        for i in 0..3 {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            let edge = ((a.min(b), a.max(b)), sides[i].to_bits());
            if !edges.remove(&edge) {
                edges.insert(edge);
            }
        }
    }
    edges.into_iter().collect()
}

/// Smallest `cot α + cot β` over the pairs of equal edges, which generic lengths identify.
fn least_weight(triangulation: &IntrinsicTriangulation) -> f64 {
    let mut sides = Vec::new();
    for (corners, &l) in triangulation.faces.iter().zip(&triangulation.lengths) {
        let angles = angles(l);
        for i in 0..3 {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            sides.push((a.min(b), a.max(b), l[i].to_bits(), angles[(i + 2) % 3]));
        }
    }
    sides.sort_by_key(|side| (side.0, side.1, side.2));
    let pairs = sides
        .windows(2)
        .filter(|pair| (pair[0].0, pair[0].1, pair[0].2) == (pair[1].0, pair[1].1, pair[1].2));
    pairs
        .map(|pair| 1.0 / pair[0].3.tan() + 1.0 / pair[1].3.tan())
        .fold(f64::INFINITY, f64::min)
}

fn check_laws(mesh: &TriangleMesh) -> IntrinsicTriangulation {
    let found = intrinsic_delaunay(mesh).unwrap();
    let lengths = mesh_lengths(mesh);
    assert_eq!(found.outcome, Outcome::Converged);
    assert_eq!(found.negative_edges, 0);
    assert_eq!(found.mollification, 0.0);
    assert!(
        least_weight(&found) > -1e-6,
        "weight {}",
        least_weight(&found)
    );
    let (before, after) = (area(&lengths), area(&found.lengths));
    assert!(
        (before - after).abs() < CONSERVED * before,
        "area {before} became {after}"
    );
    let before = angle_sums(mesh.vertex_count(), mesh.faces(), &lengths);
    let after = angle_sums(mesh.vertex_count(), &found.faces, &found.lengths);
    for (vertex, (before, after)) in before.iter().zip(&after).enumerate() {
        assert!(
            (before - after).abs() < CONSERVED_ANGLE,
            "angle of vertex {vertex}: {before} became {after}"
        );
    }
    assert_eq!(
        boundary(mesh.faces(), &lengths),
        boundary(&found.faces, &found.lengths)
    );
    found
}

#[test]
fn slivers_become_delaunay_and_keep_area_and_angles() {
    for shear in [0.3, 2.0, 5.0] {
        let found = check_laws(&sheared_torus(24, 12, shear));
        assert!(found.flips.len() > 50, "only {} flips", found.flips.len());
    }
}

#[test]
fn carried_forms_stay_closed_and_keep_their_integers() {
    let mesh = sheared_torus(40, 20, 0.6);
    let topology = mesh.topology();
    // The steps along and around the grid: closed, with integer periods, and not exact.
    let step = |h: u32| {
        let [i, j] = [20, 1].map(|stride| {
            let at = |v: u32| i64::from(v / stride) % if stride == 20 { 40 } else { 20 };
            let length = if stride == 20 { 40 } else { 20 };
            let difference = at(topology.target(h)) - at(topology.origin(h));
            (difference + length / 2).rem_euclid(length) - length / 2
        });
        i + 1000 * j
    };
    let half_edges = 0..3 * mesh.face_count() as u32;
    let original: Vec<i64> = half_edges.clone().map(step).collect();
    let found = intrinsic_delaunay(&mesh).unwrap();
    assert!(found.flips.len() > 50);
    let mut carried = original.clone();
    found.carry(&mut carried);
    assert_ne!(carried, original);
    for h in half_edges {
        assert_eq!(
            carried[h as usize],
            -carried[found.twins[h as usize] as usize]
        );
    }
    for face in carried.as_chunks::<3>().0 {
        assert_eq!(face.iter().sum::<i64>(), 0);
    }
}

#[test]
fn simplicial_flips_leave_an_ordinary_mesh_and_twins_that_match_it() {
    let pyramid = tall_double_pyramid();
    let any = intrinsic_delaunay(&pyramid).unwrap();
    assert!(TriangleMesh::build(pyramid.positions().to_vec(), any.faces).is_err());
    for mesh in [pyramid, sheared_torus(40, 20, 0.6)] {
        let found = intrinsic_delaunay_by(&mesh, FlipRule::Simplicial).unwrap();
        let ordinary = TriangleMesh::build(mesh.positions().to_vec(), found.faces).unwrap();
        for h in 0..3 * mesh.face_count() as u32 {
            assert_eq!(ordinary.topology().twin(h), found.twins[h as usize]);
        }
    }
}

#[test]
fn a_delaunay_mesh_keeps_every_bit() {
    let points = random_points(300);
    let positions = points
        .iter()
        .map(|p| Point3::new(p[0], p[1], 0.0))
        .collect();
    let planar = TriangleMesh::build(positions, euclidean_delaunay(&points, 1.0)).unwrap();
    let corners = [
        [1.0, 1.0, 1.0],
        [1.0, -1.0, -1.0],
        [-1.0, 1.0, -1.0],
        [-1.0, -1.0, 1.0],
    ];
    let positions = corners.map(Point3::from).to_vec();
    let faces = vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
    let tetrahedron = TriangleMesh::build(positions, faces).unwrap();
    for mesh in [planar, tetrahedron] {
        let found = intrinsic_delaunay(&mesh).unwrap();
        assert_eq!((found.flips.len(), found.mollification), (0, 0.0));
        assert_eq!(found.faces, mesh.faces());
        assert_eq!(found.lengths, mesh_lengths(&mesh));
    }
}

#[test]
fn cocircular_points_are_left_as_they_are() {
    // Every diagonal of a square grid has right angles on both sides: weight zero, up to rounding.
    for stretch in [1.0, 0.1, 1.0 / 3.0] {
        let found = intrinsic_delaunay(&height_field(12, stretch, |_| 0.0)).unwrap();
        assert_eq!(found.flips.len(), 0);
    }
}

#[test]
fn a_squeezed_triangulation_becomes_the_euclidean_delaunay_triangulation() {
    let points = random_points(300);
    let expected = euclidean_delaunay(&points, 1.0);
    // Delaunay after an affine map is a valid triangulation of the same convex hull, far from
    // Delaunay before it.
    for squeeze in [0.3, 0.02] {
        let faces = euclidean_delaunay(&points, squeeze);
        let positions = points
            .iter()
            .map(|p| Point3::new(p[0], p[1], 0.0))
            .collect();
        let mesh = TriangleMesh::build(positions, faces).unwrap();
        let found = check_laws(&mesh);
        assert!(found.flips.len() > 100);
        assert_eq!(edges(&found.faces), edges(&expected));
    }
}

#[test]
fn a_fan_over_a_convex_polygon_becomes_its_delaunay_triangulation() {
    let mut random = rand_pcg::Pcg64::seed_from_u64(11);
    let mut turns: Vec<f64> = (0..60)
        .map(|_| random.random_range(0.0..std::f64::consts::TAU))
        .collect();
    turns.sort_by(f64::total_cmp);
    // On an ellipse: convex, and no four neighbours on one circle.
    let points: Vec<[f64; 2]> = turns.iter().map(|t| [2.0 * t.cos(), t.sin()]).collect();
    let faces = (1..points.len() as u32 - 1)
        .map(|i| [0, i, i + 1])
        .collect();
    let positions = points
        .iter()
        .map(|p| Point3::new(p[0], p[1], 0.0))
        .collect();
    let found = check_laws(&TriangleMesh::build(positions, faces).unwrap());
    assert_eq!(
        edges(&found.faces),
        edges(&euclidean_delaunay(&points, 1.0))
    );
}

fn random_points(count: usize) -> Vec<[f64; 2]> {
    let mut random = rand_pcg::Pcg64::seed_from_u64(7);
    (0..count)
        .map(|_| [random.random(), random.random()])
        .collect()
}

/// The Delaunay triangulation of the points after their first coordinate is scaled.
fn euclidean_delaunay(points: &[[f64; 2]], squeeze: f64) -> Vec<[u32; 3]> {
    let points = points
        .iter()
        .map(|p| spade::Point2::new(p[0] * squeeze, p[1]))
        .collect();
    let triangulation = spade::DelaunayTriangulation::<_>::bulk_load_stable(points).unwrap();
    let faces = triangulation.inner_faces();
    faces
        .map(|face| face.vertices().map(|vertex| vertex.fix().index() as u32))
        .collect()
}

fn edges(faces: &[[u32; 3]]) -> BTreeSet<Edge> {
    let pairs = faces.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    pairs.map(|(a, b)| (a.min(b), a.max(b))).collect()
}

#[test]
fn degenerate_triangles_are_made_triangles() {
    // Vertex 4 lies on the edge from 0 to 1; vertices 2 and 5 coincide.
    let positions = [
        [0.0, 0.0],
        [2.0, 0.0],
        [1.0, 1.0],
        [1.0, -1.0],
        [1.0, 0.0],
        [1.0, 1.0],
    ];
    let positions = positions.map(|[x, y]| Point3::new(x, y, 0.0)).to_vec();
    let faces = vec![[0, 1, 2], [1, 0, 4], [4, 0, 3], [1, 4, 3], [1, 5, 2]];
    let found = intrinsic_delaunay(&TriangleMesh::build(positions, faces).unwrap()).unwrap();
    assert_eq!(found.outcome, Outcome::Converged);
    assert!(found.mollification > 0.0 && found.mollification < 1e-6);
    for &[a, b, c] in &found.lengths {
        assert!(triangle_area(a, b, c) > 0.0, "sides {a}, {b}, {c}");
    }
    assert!((area(&found.lengths) - 2.0).abs() < 1e-3);
}

#[test]
fn an_edge_from_a_vertex_to_itself_is_allowed() {
    let mesh = tall_double_pyramid();
    let found = check_laws(&mesh);
    let doubled = found
        .faces
        .iter()
        .filter(|f| f[0] == f[1] || f[1] == f[2] || f[2] == f[0]);
    assert!(doubled.count() > 0, "faces {:?}", found.faces);
}

#[test]
fn any_scale_gives_the_same_triangulation() {
    let mesh = sheared_torus(24, 12, 2.0);
    let faces = intrinsic_delaunay(&mesh).unwrap().faces;
    for exponent in [-400, 400] {
        let scale = 2.0_f64.powi(exponent);
        let positions = mesh.positions().iter().map(|p| p * scale).collect();
        let scaled = intrinsic_delaunay(&mesh.with_positions(positions)).unwrap();
        assert_eq!(scaled.faces, faces);
        assert_eq!(scaled.outcome, Outcome::Converged);
    }
}

#[test]
fn flips_end_with_the_budget() {
    let mesh = sheared_torus(24, 12, 5.0);
    let mut complex = DeltaComplex::build(&mesh).unwrap();
    let (flips, within_budget) = complex.flip_until_delaunay(10, FlipRule::Any);
    assert_eq!((flips.len(), within_budget), (10, false));
    assert!(complex.negative_edges() > 0);
}

#[test]
fn input_without_lengths_is_refused_by_name() {
    let faces = vec![[0, 1, 2]];
    let mut positions = vec![Point3::origin(); 3];
    let mesh = TriangleMesh::build(positions.clone(), faces.clone()).unwrap();
    let error = intrinsic_delaunay(&mesh).unwrap_err();
    assert_eq!(
        error.to_string(),
        "all 3 edges have length zero: the vertices coincide; give distinct positions"
    );
    positions[2].x = f64::NAN;
    let error = intrinsic_delaunay(&mesh.with_positions(positions)).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the edge from vertex 1 to vertex 2 has length NaN; \
         give finite positions whose differences can be squared"
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn any_height_field_becomes_delaunay(
        heights in proptest::collection::vec(-2.0..2.0, 64),
        stretch in 0.1..3.0,
    ) {
        let mesh = height_field(8, stretch, |v| heights[v as usize]);
        let found = check_laws(&mesh);
        prop_assert_eq!(&found, &intrinsic_delaunay(&mesh).unwrap());
    }
}
