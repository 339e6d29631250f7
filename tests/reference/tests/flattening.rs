//! Flattenings of disks and their measures against CGAL's.

use msplines_common::mesh::{TriangleMesh, shapes, zoo};
use msplines_common::progress::unobserved;
use msplines_conformal::disk::{Route, flatten_disk};
use msplines_conformal::measure::{measure_planar, stretch};
use msplines_reference::record::Comparison;
use msplines_reference::{Library, cgal_harmonic, cgal_lscm, cgal_mean_value, meshes};
use nalgebra::{Matrix2, Point3, Vector2};

/// Singular values by another formula; the ratio of a thin image loses the digits of its thinness.
const TWO_FORMULAS: f64 = 1e-9;

/// How much more angles may be distorted than by the map that minimises that distortion: this one also
/// keeps the boundary as long as it is.
const NEARLY_LEAST: f64 = 0.02;

/// Factors of one matrix by two libraries, whose condition is that of a Laplacian of some thousand
/// vertices.
const CONDITION: f64 = 1e-11;

/// Disks with their names: generated, with random vertices, and the models that are disks.
fn disks() -> Vec<(String, TriangleMesh)> {
    let named = |name: &str, mesh| (name.to_owned(), mesh);
    let field = zoo::with_boundary();
    let mut disks = vec![
        named("fine height field", shapes::height_field(2500)),
        named("height field, jittered", meshes::jittered(&field, 0.2, 1)),
        named("bowl", shapes::bowl(1000)),
        named(
            "bowl, jittered",
            meshes::jittered(&shapes::bowl(1500), 0.2, 2),
        ),
        named("height field", field),
    ];
    disks.extend(meshes::models());
    disks.retain(|(_, mesh)| {
        let topology = mesh.topology();
        topology.boundary_loops().len() == 1 && topology.euler_characteristic() == 1
    });
    disks
}

/// A bent disk of nearly equilateral triangles, so that its edges are Delaunay.
fn nearly_equilateral(seed: u64) -> TriangleMesh {
    let side = 10 + 5 * seed as u32;
    let vertex = |i: u32, j: u32| i + j * (side + 1);
    let place = |i: u32, j: u32| {
        let (x, y) = (
            f64::from(i) + 0.5 * f64::from(j),
            0.75_f64.sqrt() * f64::from(j),
        );
        let (x, y) = (x / f64::from(side), y / f64::from(side));
        Point3::new(x, y, 0.15 * (3.0 * x + seed as f64).sin() * (2.0 * y).cos())
    };
    let places = (0..=side).flat_map(|j| (0..=side).map(move |i| place(i, j)));
    let cells = (0..side).flat_map(|j| (0..side).map(move |i| [i, j]));
    let faces = cells.flat_map(|[i, j]| {
        let [a, b] = [vertex(i, j), vertex(i + 1, j)];
        let [c, d] = [vertex(i, j + 1), vertex(i + 1, j + 1)];
        [[a, b, c], [b, d, c]]
    });
    let mesh = TriangleMesh::build(places.collect(), faces.collect()).expect("a disk");
    meshes::jittered(&mesh, 0.1, seed)
}

#[test]
fn maps_are_harmonic_inside_of_their_boundary() -> Result<(), Box<dyn std::error::Error>> {
    let why = "relative to the image's size: factors of two libraries";
    let mut comparison = Comparison::new("harmonic disk", Library::Cgal, CONDITION, why);
    for seed in 1..7 {
        let mesh = nearly_equilateral(seed);
        let ours = flatten_disk(&mesh, &mut unobserved())?;
        // Else its weights are those of other edges, or its points were moved.
        assert_eq!(
            (ours.route, ours.triangulation.flips.len()),
            (Route::BoundaryFirst, 0)
        );
        let theirs = cgal_harmonic(&mesh, &ours.points)?;
        let points = || ours.points.iter().map(|&p| Vector2::from(p));
        let size = points().map(|p| p.norm()).fold(0.0, f64::max);
        let pairs = points().zip(theirs);
        let name = format!("random disk of {} vertices", mesh.vertex_count());
        comparison.add(
            &name,
            pairs.map(|(p, q)| (p - Vector2::from(q)).norm() / size),
        );
    }
    comparison.finish();
    Ok(())
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
            ratios.add(&name, deviations);
        }
    }
    ratios.finish();
    Ok(())
}

#[test]
fn angles_are_kept_as_by_least_squares_and_better_than_by_mean_values()
-> Result<(), Box<dyn std::error::Error>> {
    let why = "relative, over that of least squares: this map also keeps its boundary's length";
    let quantity = "angle distortion of a map";
    let mut comparison = Comparison::new(quantity, Library::Cgal, NEARLY_LEAST, why);
    for (name, mesh) in disks() {
        let lengths = lengths(&mesh);
        let measure = |places: &[[f64; 2]]| measure_planar(mesh.faces(), &lengths, places);
        let ours = measure(&flatten_disk(&mesh, &mut unobserved())?.points);
        let least = measure(&cgal_lscm(&mesh)?);
        let other = measure(&cgal_mean_value(&mesh)?);
        assert_eq!((ours.flips, least.flips, other.flips), (0, 0, 0), "{name}");
        let means = [ours.angle_mean, least.angle_mean, other.angle_mean];
        comparison.add(&name, [(means[0] / means[1] - 1.0).max(0.0)]);
        assert!(means[0] < means[2], "{name}: {means:?}");
    }
    comparison.finish();
    Ok(())
}
