use msplines_common::mesh::shapes;
use msplines_common::mesh::zoo;
use msplines_common::progress::unobserved;
use nalgebra::{Point3, Rotation3, Vector3};

use super::*;

/// Returns a cap of the unit sphere up to an angle from the pole, in rings of about equal width.
fn cap(angle: f64, rings: u32) -> TriangleMesh {
    let place = |ring: u32, i: u32| {
        let polar = angle * f64::from(ring) / f64::from(rings);
        let around = TAU * f64::from(i) / f64::from(6 * ring.max(1));
        Point3::new(
            polar.sin() * around.cos(),
            polar.sin() * around.sin(),
            polar.cos(),
        )
    };
    let id = |ring: u32, i: u32| match ring {
        0 => 0,
        _ => 1 + 3 * ring * (ring - 1) + i % (6 * ring),
    };
    let (mut positions, mut faces) = (vec![place(0, 0)], Vec::new());
    for ring in 1..=rings {
        positions.extend((0..6 * ring).map(|i| place(ring, i)));
        for sector in 0..6 {
            for i in 0..ring {
                let (inside, outside) = (sector * (ring - 1) + i, sector * ring + i);
                let [a, b] = [id(ring, outside), id(ring, outside + 1)];
                faces.push([id(ring - 1, inside), a, b]);
                if i + 1 < ring {
                    faces.push([id(ring - 1, inside), b, id(ring - 1, inside + 1)]);
                }
            }
        }
    }
    TriangleMesh::build(positions, faces).expect("a cap")
}

fn distance(map: &DiskMap, a: usize, b: usize) -> f64 {
    (map.points[a][0] - map.points[b][0]).hypot(map.points[a][1] - map.points[b][1])
}

#[test]
fn a_flat_disk_stays_congruent() {
    /// Rounding of solves on a few hundred vertices.
    const ROUNDING: f64 = 1e-11;
    let patch = zoo::with_boundary();
    let turn = Rotation3::from_euler_angles(0.3, 1.1, -0.7);
    let flat = |p: &Point3<f64>| turn * Point3::new(p.x + 0.2 * p.z, p.y - 0.1 * p.z, 0.0);
    let mesh = patch.with_positions(patch.positions().iter().map(flat).collect());
    let map = flatten_disk(&mesh, &mut unobserved()).expect("a flattening");
    assert_eq!((map.route, map.distortion.flips), (Route::BoundaryFirst, 0));
    for (a, b) in [(0, 440), (20, 200), (77, 301)] {
        let expected = (mesh.positions()[a] - mesh.positions()[b]).norm();
        assert!((distance(&map, a, b) - expected).abs() < ROUNDING);
    }
    assert!(map.distortion.angle_p99 < 1.0 + ROUNDING);
}

#[test]
fn a_spherical_cap_becomes_its_stereographic_image() {
    const ANGLE: f64 = 1.2;
    let errors: Vec<f64> = [8, 16, 32]
        .map(|rings| {
            let mesh = cap(ANGLE, rings);
            let map = flatten_disk(&mesh, &mut unobserved()).expect("a flattening");
            assert_eq!(map.route, Route::BoundaryFirst);
            let scale = ANGLE.sin() / (0.5 * ANGLE).tan();
            let error = |v: usize| {
                let polar = mesh.positions()[v].z.min(1.0).acos();
                (distance(&map, 0, v) - scale * (0.5 * polar).tan()).abs()
            };
            (0..mesh.vertex_count()).map(error).fold(0.0, f64::max)
        })
        .to_vec();
    for pair in errors.windows(2) {
        // Second order is a ratio of 4.
        assert!(pair[0] / pair[1] > 3.4, "{errors:?}");
    }
    assert!(errors[2] < 2e-3, "{errors:?}");
}

#[test]
fn curved_disks_have_no_flips() {
    // What the size of the faces leaves; the cap is all but a closed sphere.
    let (patch, fine, cap) = (
        zoo::with_boundary(),
        shapes::height_field(5000),
        cap(2.9, 20),
    );
    for (mesh, largest) in [(patch, 1.03), (fine, 1.01), (cap, 1.13)] {
        let map = flatten_disk(&mesh, &mut unobserved()).expect("a flattening");
        assert_eq!(map.distortion.flips, 0);
        assert!(map.distortion.angle_mean < largest, "{:?}", map.distortion);
    }
}

#[test]
fn the_convex_map_is_one_to_one() {
    let mesh = zoo::with_boundary();
    let triangulation = intrinsic_delaunay_by(&mesh, FlipRule::Simplicial).expect("a mesh");
    let disk = Disk::of(mesh.vertex_count(), &triangulation);
    let mut weights = cotangent_weights(&triangulation);
    bound_below(&mut weights, WEIGHT_FLOOR);
    let matrix = laplacian(mesh.vertex_count(), &triangulation, &weights);
    let ordering = Ordering::minimum_degree(&matrix, |_| true).expect("an ordering");
    let points = disk.convex(&matrix, &ordering).expect("a map");
    assert!(disk.is_locally_injective(&points));
    // A reflection turns every face over.
    let turned: Vec<[f64; 2]> = points.iter().map(|p| [p[0], -p[1]]).collect();
    assert_eq!(
        planar_flips(&triangulation.faces, &turned).len(),
        mesh.face_count()
    );
    // z² goes around the middle twice without any flip.
    let mesh = cap(1.0, 8);
    let triangulation = intrinsic_delaunay_by(&mesh, FlipRule::Simplicial).expect("a mesh");
    let disk = Disk::of(mesh.vertex_count(), &triangulation);
    let square = |p: &Point3<f64>| [p.x * p.x - p.y * p.y, 2.0 * p.x * p.y];
    let doubled: Vec<[f64; 2]> = mesh.positions().iter().map(square).collect();
    assert!(planar_flips(&triangulation.faces, &doubled).is_empty());
    assert!(!disk.is_locally_injective(&doubled));
}

#[test]
fn size_place_and_threads_do_not_matter() {
    let mesh = zoo::with_boundary();
    let map = flatten_disk(&mesh, &mut unobserved()).expect("a flattening");
    let shift = Vector3::new(3.0, -2.0, 1.0);
    let larger = mesh.with_positions(mesh.positions().iter().map(|p| p * 37.0 + shift).collect());
    let scaled = flatten_disk(&larger, &mut unobserved()).expect("a flattening");
    for v in 0..mesh.vertex_count() {
        assert!((distance(&scaled, 0, v) - 37.0 * distance(&map, 0, v)).abs() < 1e-9);
    }
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("a pool").install(|| {
            flatten_disk(&mesh, &mut unobserved())
                .expect("a flattening")
                .points
        })
    };
    assert_eq!(on(1), on(2));
}

#[test]
fn what_is_no_disk_is_refused() {
    let error = |mesh: &TriangleMesh| {
        flatten_disk(mesh, &mut unobserved())
            .expect_err("no disk")
            .to_string()
    };
    assert!(error(&zoo::closed()).contains("0 boundary loops"));
    assert!(error(&zoo::with_two_boundaries()).contains("2 boundary loops"));
    let torus = zoo::genus(1);
    let (open, _) = crate::bounded::puncture(&torus, &[7]).expect("a hole");
    assert!(error(&open).contains("genus 1"));
}
