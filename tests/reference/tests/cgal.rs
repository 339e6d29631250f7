//! Areas, volume and the discrete operators against CGAL.

use msplines_common::mesh::{Facts, NONE, Range, Topology, TriangleMesh};
use msplines_common::operators::mesh_operators;
use msplines_reference::record::Comparison;
use msplines_reference::{
    Library, cgal_cotangent_weights, cgal_face_cotangents, cgal_measures, cgal_shape, meshes,
};
use nalgebra::{Point3, Vector3};

/// Rounding of one face, whose sides are of one magnitude.
const ROUNDING: f64 = 1e-12;
/// Two formulas for a cotangent: from three edge lengths here, from coordinates there. In a needle of
/// a jittered mesh the former loses a few digits.
const TWO_FORMULAS: f64 = 1e-11;
/// `cotangent_weight` of CGAL 5.5 is 2 (cot α + cot β), where the Laplacian wants half the sum.
const CGAL_FACTOR: f64 = 4.0;

#[test]
fn the_factor_of_the_cotangent_weight_is_four() -> Result<(), Box<dyn std::error::Error>> {
    // Two equilateral triangles: both cotangents are 1/√3, and so is half their sum.
    let height = 0.75_f64.sqrt();
    let positions = [[0.0, 0.0], [1.0, 0.0], [0.5, height], [0.5, -height]];
    let positions = positions.map(|[x, y]| Point3::new(x, y, 0.0)).to_vec();
    let mesh = TriangleMesh::build(positions, vec![[0, 1, 2], [1, 0, 3]])?;
    let weight = cgal_cotangent_weights(&mesh, &[[2, 0, 3, 1]])[0];
    assert!(
        (weight - CGAL_FACTOR / 3.0_f64.sqrt()).abs() < ROUNDING,
        "{weight}"
    );
    Ok(())
}

#[test]
fn areas_and_volume_agree() {
    let why = "relative: a few products in another order";
    let mut faces = Comparison::new("face area", Library::Cgal, ROUNDING, why);
    let mut whole = Comparison::new("surface area and volume", Library::Cgal, ROUNDING, why);
    for (name, mesh) in meshes::all() {
        let theirs = cgal_measures(&mesh);
        let areas = (0..mesh.face_count() as u32).map(|face| 0.5 * mesh.face_normal(face).norm());
        let largest = theirs.face_areas.iter().copied().fold(0.0, f64::max);
        let pairs = areas.clone().zip(&theirs.face_areas);
        faces.add(
            &name,
            pairs.map(|(ours, theirs)| (ours - theirs).abs() / largest),
        );
        let area: f64 = areas.sum();
        whole.add(&name, [(area - theirs.area).abs() / theirs.area]);
        if mesh.topology().boundary_loops().is_empty() {
            let volume = volume(&mesh);
            whole.add(
                &name,
                [(volume - theirs.volume).abs() / theirs.volume.abs()],
            );
        }
    }
    faces.finish();
    whole.finish();
}

#[test]
fn normals_lengths_and_angles_agree() {
    let new =
        |quantity: &str, bound, why: &str| Comparison::new(quantity, Library::Cgal, bound, why);
    let mut normals = new("normal of a face", ROUNDING, "of unit vectors");
    let why = "relative, of the shortest, the mean and the longest";
    let mut lengths = new("length of edges", ROUNDING, why);
    let why = "radians, of the least, the mean and the largest: arc tangent here, arc cosine there";
    let mut angles = new("angle of faces", ROUNDING, why);
    for (name, mesh) in meshes::all() {
        let (facts, theirs) = (Facts::measure(&mesh), cgal_shape(&mesh));
        let (units, _) = theirs.normals.as_chunks::<3>();
        let apart = units
            .iter()
            .zip(0_u32..)
            .map(|(&unit, face)| (mesh.face_normal(face).normalize() - Vector3::from(unit)).norm());
        normals.add(&name, apart);
        let pairs = of_range(facts.edge_length, &theirs.edge_lengths);
        lengths.add(
            &name,
            pairs.map(|[ours, theirs]| (ours / theirs - 1.0).abs()),
        );
        let pairs = of_range(facts.angle, &theirs.angles_degrees);
        let apart = pairs.map(|[ours, theirs]| (ours - theirs.to_radians()).abs());
        angles.add(&name, apart);
    }
    normals.finish();
    lengths.finish();
    angles.finish();
}

/// Returns smallest, mean and largest, here and there.
fn of_range(ours: Range, theirs: &[f64]) -> [[f64; 2]; 3] {
    let least = theirs.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = theirs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mean = theirs.iter().sum::<f64>() / theirs.len() as f64;
    [[ours.min, least], [ours.mean, mean], [ours.max, largest]]
}

/// Sum of the signed tetrahedra between the faces and one vertex.
fn volume(mesh: &TriangleMesh) -> f64 {
    let apex = mesh.positions()[0];
    let volumes = (0..mesh.face_count() as u32).map(|face| {
        let [a, b, c] = mesh.triangle(face).map(|corner| corner - apex);
        a.dot(&b.cross(&c)) / 6.0
    });
    volumes.sum()
}

/// Returns the mixed area of every vertex from CGAL's parts of triangles.
///
/// CGAL 5.5 gives *every* corner of an obtuse triangle half of it, three halves in all. By the
/// definition of mixed areas that is right for the obtuse corner, and the other two get a quarter.
fn cgal_mixed_areas(mesh: &TriangleMesh) -> Vec<f64> {
    let parts = cgal_measures(mesh).corner_areas;
    let cotangents = cgal_face_cotangents(mesh);
    let (parts, _) = parts.as_chunks::<3>();
    let (cotangents, _) = cotangents.as_chunks::<3>();
    let mut areas = vec![0.0; mesh.vertex_count()];
    for ((face, parts), cotangents) in mesh.faces().iter().zip(parts).zip(cotangents) {
        let obtuse = cotangents.iter().position(|&cotangent| cotangent < 0.0);
        for corner in 0..3 {
            let beside = obtuse.is_some_and(|obtuse| obtuse != corner);
            let share = if beside { 0.5 } else { 1.0 };
            areas[face[corner] as usize] += share * parts[corner];
        }
    }
    areas
}

#[test]
fn mixed_voronoi_areas_agree() {
    let why = "relative to the mean area: two formulas for a circumcentre";
    let mut comparison = Comparison::new("mixed Voronoi area", Library::Cgal, TWO_FORMULAS, why);
    let mut total = Comparison::new("sum of mixed areas", Library::Cgal, ROUNDING, "relative");
    for (name, mesh) in meshes::all() {
        let area = cgal_measures(&mesh).area;
        let ours = mesh_operators(&mesh).mass;
        let mean = area / ours.len() as f64;
        let theirs = cgal_mixed_areas(&mesh);
        let pairs = ours.iter().zip(&theirs);
        comparison.add(
            &name,
            pairs.map(|(ours, theirs)| (ours - theirs).abs() / mean),
        );
        total.add(&name, [(ours.iter().sum::<f64>() - area).abs() / area]);
    }
    comparison.finish();
    total.finish();
}

#[test]
fn cotangent_weights_agree() {
    let why = "relative to 1 + |weight|: lengths here, coordinates there";
    let mut comparison = Comparison::new("cotangent weight", Library::Cgal, TWO_FORMULAS, why);
    for (name, mesh) in meshes::all() {
        let laplacian = mesh_operators(&mesh).laplacian;
        let entry = |row: u32, column: u32| {
            let found = laplacian
                .column(column as usize)
                .find(|e| e.0 == row as usize);
            found.map_or(0.0, |e| e.1)
        };
        for (ends, theirs) in cgal_edge_weights(&mesh) {
            let ours = -entry(ends[0], ends[1]);
            comparison.add(&name, [(ours - theirs).abs() / (1.0 + theirs.abs())]);
        }
    }
    comparison.finish();
}

/// Returns (cot α + cot β) / 2 of every edge; an edge on the boundary has one angle.
fn cgal_edge_weights(mesh: &TriangleMesh) -> Vec<([u32; 2], f64)> {
    let topology = mesh.topology();
    let cotangents = cgal_face_cotangents(mesh);
    let (mut inner, mut flaps, mut weights) = (Vec::new(), Vec::new(), Vec::new());
    for edge in 0..topology.edge_count() as u32 {
        let half_edge = topology.edge_half_edge(edge);
        let twin = topology.twin(half_edge);
        let ends = topology.edge_vertices(edge);
        // The corner of the half-edge's face that lies opposite to it starts its predecessor.
        let opposite = Topology::previous(half_edge);
        if twin == NONE {
            weights.push((ends, 0.5 * cotangents[opposite as usize]));
        } else {
            let other = topology.origin(Topology::previous(twin));
            flaps.push([topology.origin(opposite), ends[0], other, ends[1]]);
            inner.push(ends);
        }
    }
    let found = cgal_cotangent_weights(mesh, &flaps);
    weights.extend(
        inner
            .into_iter()
            .zip(found.into_iter().map(|weight| weight / CGAL_FACTOR)),
    );
    weights
}
