//! Flattenings of disks and their measures against CGAL's.

use msplines_common::mesh::{TriangleMesh, shapes, zoo};
use msplines_common::progress::unobserved;
use msplines_conformal::disk::flatten_disk;
use msplines_conformal::measure::{measure_planar, stretch};
use msplines_reference::record::Comparison;
use msplines_reference::{Library, cgal_lscm, cgal_mean_value};
use nalgebra::{Matrix2, Vector2};

/// Singular values by another formula; the ratio of a thin image loses the digits of its thinness.
const TWO_FORMULAS: f64 = 1e-9;

/// How much more angles may be distorted than by the map that minimises that distortion: this one also
/// keeps the boundary as long as it is.
const NEARLY_LEAST: f64 = 1.02;

fn disks() -> Vec<(&'static str, TriangleMesh)> {
    vec![
        ("height field", zoo::with_boundary()),
        ("fine height field", shapes::height_field(2500)),
    ]
}

fn lengths(mesh: &TriangleMesh) -> Vec<[f64; 3]> {
    let faces = 0..mesh.face_count() as u32;
    let sides = faces.map(|f| {
        let [a, b, c] = mesh.triangle(f);
        [(b - a).norm(), (c - b).norm(), (a - c).norm()]
    });
    sides.collect()
}

#[test]
fn singular_values_of_maps_by_cgal_are_those_of_their_matrices()
-> Result<(), Box<dyn std::error::Error>> {
    let why = "relative: closed form of the ratio here, singular values of a matrix there";
    let mut ratios = Comparison::new(
        "angle distortion of a face",
        Library::Cgal,
        TWO_FORMULAS,
        why,
    );
    for (name, mesh) in disks() {
        for places in [cgal_lscm(&mesh)?, cgal_mean_value(&mesh)?] {
            let deviations = mesh.faces().iter().enumerate().map(|(face, corners)| {
                let [a, b, c] = mesh.triangle(face as u32);
                let [along, left] = mesh.face_frame(face as u32);
                let flat = |v: nalgebra::Vector3<f64>| Vector2::new(v.dot(&along), v.dot(&left));
                let source = Matrix2::from_columns(&[flat(b - a), flat(c - a)]);
                let [p, q, r] = corners.map(|v| Vector2::from(places[v as usize]));
                let image = Matrix2::from_columns(&[q - p, r - p]);
                let singular = (image * source.try_inverse().unwrap_or_default()).singular_values();
                let theirs = singular.max() / singular.min();
                let edges = [q - p, r - q, p - r].map(|v| [v.x, v.y]);
                let sides = [(b - a).norm(), (c - b).norm(), (a - c).norm()];
                (stretch(sides, edges).anisotropy / theirs - 1.0).abs()
            });
            ratios.add(name, deviations);
        }
    }
    ratios.finish();
    Ok(())
}

#[test]
fn angles_are_kept_as_by_least_squares_and_better_than_by_mean_values()
-> Result<(), Box<dyn std::error::Error>> {
    for (name, mesh) in disks() {
        let lengths = lengths(&mesh);
        let measure = |places: &[[f64; 2]]| measure_planar(mesh.faces(), &lengths, places);
        let ours = measure(&flatten_disk(&mesh, &mut unobserved())?.points);
        let least = measure(&cgal_lscm(&mesh)?);
        let other = measure(&cgal_mean_value(&mesh)?);
        assert_eq!((ours.flips, least.flips, other.flips), (0, 0, 0), "{name}");
        let means = [ours.angle_mean, least.angle_mean, other.angle_mean];
        assert!(
            means[0] < NEARLY_LEAST * means[1] && means[0] < means[2],
            "{name}: {means:?}"
        );
    }
    Ok(())
}
