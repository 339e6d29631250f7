use msplines_common::mesh::{shapes, zoo};
use msplines_common::progress::unobserved;
use nalgebra::{Matrix3, Point3};

use super::*;

/// Rounding of the solves, relative to the unit sphere.
const ROUNDING: f64 = 1e-9;

fn map(mesh: &TriangleMesh) -> SphericalMap {
    spherical_map(mesh, FlipRule::Simplicial, &mut unobserved()).expect("a spherical map")
}

/// Returns the largest distance of two sets of points after the best rotation.
fn distance_up_to_rotation(from: &[Vector3<f64>], to: &[Vector3<f64>]) -> f64 {
    let both = from.iter().zip(to);
    let moment: Matrix3<f64> = both.clone().map(|(p, q)| q * p.transpose()).sum();
    let svd = moment.svd(true, true);
    let (u, v) = (svd.u.expect("asked for"), svd.v_t.expect("asked for"));
    let turn = u * v;
    assert!(turn.determinant() > 0.0, "a reflection");
    both.map(|(p, q)| (turn * p - q).norm()).fold(0.0, f64::max)
}

#[test]
fn a_sphere_maps_to_itself() {
    let errors = [162, 642, 2562].map(|vertices| {
        let mesh = shapes::sphere(vertices);
        let map = map(&mesh);
        assert_eq!(
            (map.distortion.flips, map.flips_of_mesh, map.moved),
            (0, 0, 0)
        );
        let truth: Vec<_> = mesh.positions().iter().map(|p| p.coords).collect();
        distance_up_to_rotation(&map.points, &truth)
    });
    assert!(
        errors[0] / errors[1] > 3.0 && errors[1] / errors[2] > 3.0,
        "{errors:?}"
    );
    assert!(errors[2] < 2e-3, "{errors:?}");
}

#[test]
fn bumps_are_mapped_without_flips() {
    let coarse = map(&shapes::bumpy_sphere(642)).distortion;
    let fine = map(&shapes::bumpy_sphere(10_242)).distortion;
    assert_eq!((coarse.flips, fine.flips), (0, 0));
    assert!(fine.angle_mean < 1.03, "{fine:?}");
    assert!(
        fine.angle_mean - 1.0 < 0.5 * (coarse.angle_mean - 1.0),
        "{coarse:?} {fine:?}"
    );
}

#[test]
fn the_image_is_centred() {
    let mesh = zoo::closed();
    let map = map(&mesh);
    let areas = vertex_areas(mesh.vertex_count(), &map.triangulation);
    let sum: Vector3<f64> = map.points.iter().zip(&areas).map(|(p, &a)| p * a).sum();
    assert!(sum.norm() < 1e-12 * areas.iter().sum::<f64>());
    // A Möbius map is undone up to a rotation.
    let off = Vector3::new(0.3, -0.2, 0.4);
    let push = |p: &Vector3<f64>| {
        let q = p + off;
        q * ((1.0 - off.norm_squared()) / q.norm_squared()) + off
    };
    let mut moved: Vec<_> = map.points.iter().map(push).collect();
    moebius::centre(&mut moved, &areas);
    assert!(distance_up_to_rotation(&moved, &map.points) < ROUNDING);
}

#[test]
fn numbering_size_and_threads_do_not_matter() {
    let mesh = zoo::closed();
    let points = map(&mesh).points;
    let count = mesh.vertex_count() as u32;
    // 7 has no factor in common with 642 = 2 · 3 · 107.
    let renamed = |v: u32| (7 * v + 5) % count;
    let mut positions = vec![Point3::origin(); count as usize];
    for (v, p) in (0u32..).zip(mesh.positions()) {
        positions[renamed(v) as usize] = Point3::from(p.coords * 130.0 + Vector3::repeat(9.0));
    }
    let faces = mesh.faces().iter().rev();
    let faces = faces.map(|&[a, b, c]| [b, c, a].map(renamed)).collect();
    let other = map(&TriangleMesh::build(positions, faces).expect("a mesh")).points;
    let back: Vec<_> = (0..count).map(|v| other[renamed(v) as usize]).collect();
    let distance = distance_up_to_rotation(&back, &points);
    assert!(distance < ROUNDING, "{distance}");
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("a pool").install(|| map(&mesh).points)
    };
    assert_eq!(on(1), on(2));
}

#[test]
fn stereographic_charts_are_plane_and_oriented() {
    let map = map(&zoo::closed());
    for v in [0, 100, 641] {
        let pole = map.points[v];
        let chart = map.stereographic(pole);
        assert_eq!(chart[v], [f64::INFINITY; 2]);
        let faces = map.triangulation.faces.iter();
        let away: Vec<_> = faces
            .copied()
            .filter(|f| !f.contains(&(v as u32)))
            .collect();
        let far = chart
            .iter()
            .zip(&map.points)
            .find(|(_, p)| p.dot(&pole) < 0.0);
        let ([x, y], p) = far.expect("the other side");
        let cosine = p.dot(&pole);
        let modulus = ((1.0 + cosine) / (1.0 - cosine)).sqrt();
        assert!((x.hypot(*y) - modulus).abs() < 1e-12);
        assert_eq!(crate::measure::planar_flips(&away, &chart), []);
    }
}

#[test]
fn the_smallest_surface_is_mapped() {
    let corners = [[1., 1., 1.], [1., -1., -1.], [-1., 1., -1.], [-1., -1., 1.]];
    let faces = vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
    let mesh = TriangleMesh::build(corners.map(Point3::from).to_vec(), faces).expect("a mesh");
    assert_eq!(map(&mesh).distortion.flips, 0);
    assert_eq!(map(&shapes::cube(1)).distortion.flips, 0);
}

#[test]
fn turned_triangles_are_turned_back() {
    let mut map = map(&zoo::closed());
    let link = map.triangulation.faces[100];
    // One corner is pushed through the opposite side.
    let [a, b, c] = link.map(|v| map.points[v as usize]);
    map.points[link[0] as usize] = (b + c - a * 0.5).normalize();
    let flips = spherical_flips(&map.triangulation.faces, &map.points).len();
    assert!(flips > 0);
    assert!(untangle_sphere(&map.triangulation, &mut map.points) > 0);
    assert_eq!(spherical_flips(&map.triangulation.faces, &map.points), []);
    assert!(check_one_to_one(&map.triangulation.faces, &map.points).is_ok());
}

#[test]
fn what_is_no_sphere_is_refused() {
    let error = |mesh: &TriangleMesh| {
        let refused = spherical_map(mesh, FlipRule::Any, &mut unobserved());
        refused.expect_err("no sphere").to_string()
    };
    assert!(error(&zoo::genus(1)).contains("genus 1"));
    assert!(error(&zoo::with_boundary()).contains("1 boundary loops"));
    let one = shapes::sphere(12);
    let mut positions = one.positions().to_vec();
    positions.extend(one.positions().iter().map(|p| p + Vector3::repeat(4.0)));
    let shift = one.vertex_count() as u32;
    let mut faces = one.faces().to_vec();
    faces.extend(one.faces().iter().map(|f| f.map(|v| v + shift)));
    let two = TriangleMesh::build(positions, faces).expect("a mesh");
    assert!(error(&two).contains("2 components"));
    let flat = one.with_positions(vec![Point3::origin(); one.vertex_count()]);
    assert!(error(&flat).contains("coincide"));
}
