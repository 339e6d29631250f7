//! Topology, Loop and Catmull-Clark subdivision against OpenMesh.

use std::collections::BTreeMap;

use msplines_common::mesh::polygon::{Refined, Rules, Sharpness};
use msplines_common::mesh::{Topology, TriangleMesh, subdivide_butterfly, subdivide_loop};
use msplines_reference::polygon::openmesh_catmull_clark;
use msplines_reference::record::Comparison;
use msplines_reference::{Library, meshes, openmesh_butterfly, openmesh_facts, openmesh_loop};
use nalgebra::Point3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Both sides add a handful of products in different order.
const ROUNDING: f64 = 1e-14;

#[test]
fn euler_characteristic_and_boundary_agree() {
    let mut comparison = Comparison::new(
        "vertices edges faces Euler characteristic boundary loops",
        Library::OpenMesh,
        0.0,
        "counts are exact",
    );
    for (name, mesh) in meshes::all() {
        let theirs = openmesh_facts(mesh.positions(), mesh.faces());
        let topology = mesh.topology();
        let boundary = (0..mesh.vertex_count() as u32)
            .filter(|&vertex| topology.is_boundary_vertex(vertex))
            .count();
        let euler = theirs.vertices as i64 - theirs.edges as i64 + theirs.faces as i64;
        let pairs = [
            (topology.vertex_count(), theirs.vertices),
            (topology.edge_count(), theirs.edges),
            (topology.face_count(), theirs.faces),
            (topology.boundary_loops().len(), theirs.boundary_loops),
            (boundary, theirs.boundary_vertices),
        ];
        comparison.add(
            &name,
            pairs.map(|(ours, theirs)| ours.abs_diff(theirs) as f64),
        );
        comparison.add(
            &name,
            [topology.euler_characteristic().abs_diff(euler) as f64],
        );
        assert_eq!(
            (theirs.refused_faces, theirs.non_manifold_vertices),
            (0, 0),
            "{name}"
        );
    }
    comparison.finish();
}

/// What is done to a mesh at random.
fn damage(faces: &mut Vec<[u32; 3]>, random: &mut Pcg64Mcg) {
    let face = random.random_range(0..faces.len());
    let other = random.random_range(0..faces.len());
    match random.random_range(0..5) {
        0 => {
            faces.swap_remove(face);
        }
        1 => faces[face].swap(0, 1),
        2 => faces.push(faces[face]),
        // Two vertices become one: usually a bow tie.
        3 => {
            let (from, to) = (faces[face][0], faces[other][1]);
            faces
                .iter_mut()
                .flatten()
                .filter(|v| **v == from)
                .for_each(|v| *v = to);
            faces.retain(|[a, b, c]| a != b && b != c && c != a);
        }
        _ => faces.swap(face, other),
    }
}

#[test]
fn damaged_meshes_are_judged_manifold_or_not_alike() {
    let mut comparison = Comparison::new(
        "manifold or not",
        Library::OpenMesh,
        0.0,
        "both answer yes or no",
    );
    let mut manifold = 0;
    let mut broken = 0;
    for (name, mesh) in meshes::generated() {
        let mut random = Pcg64Mcg::seed_from_u64(7);
        for _ in 0..80 {
            let mut faces = mesh.faces().to_vec();
            for _ in 0..random.random_range(1..3) {
                damage(&mut faces, &mut random);
            }
            // Unreferenced vertices do not matter.
            let (used, faces) = meshes::compact(&faces);
            let count = used.len();
            let theirs = openmesh_facts(&vec![Point3::origin(); count], &faces);
            let theirs = theirs.refused_faces == 0 && theirs.non_manifold_vertices == 0;
            let ours = Topology::build(count, faces).is_ok();
            if ours {
                manifold += 1
            } else {
                broken += 1
            }
            comparison.add(&name, [f64::from(u8::from(ours != theirs))]);
        }
    }
    assert!(
        manifold > 50 && broken > 50,
        "{manifold} manifold, {broken} broken: one side only"
    );
    comparison.finish();
}

/// Returns the position of each vertex of a once subdivided mesh: by itself for old vertices, by
/// the two ends of its edge for new ones, since the order of new vertices is nobody's promise.
fn by_origin(
    old: usize,
    positions: &[Point3<f64>],
    faces: &[[u32; 3]],
) -> BTreeMap<(u32, u32), Point3<f64>> {
    let mut ends: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for face in faces {
        for (i, &vertex) in face.iter().enumerate() {
            for other in [face[(i + 1) % 3], face[(i + 2) % 3]] {
                if vertex as usize >= old && (other as usize) < old {
                    ends.entry(vertex).or_default().push(other);
                }
            }
        }
    }
    let old_vertices = (0..old).map(|v| ((v as u32, v as u32), positions[v]));
    let new_vertices = ends.iter().map(|(&vertex, ends)| {
        let low = ends.iter().min().copied().unwrap_or(vertex);
        let high = ends.iter().max().copied().unwrap_or(vertex);
        ((low, high), positions[vertex as usize])
    });
    old_vertices.chain(new_vertices).collect()
}

/// Deviations in diagonals of a mesh after one round of one scheme, here and there.
fn deviations(
    mesh: &TriangleMesh,
    ours: &TriangleMesh,
    (positions, faces): &(Vec<Point3<f64>>, Vec<[u32; 3]>),
) -> Vec<f64> {
    let ours = by_origin(mesh.vertex_count(), ours.positions(), ours.faces());
    let theirs = by_origin(mesh.vertex_count(), positions, faces);
    let expected = mesh.vertex_count() + mesh.topology().edge_count();
    assert_eq!((ours.len(), theirs.len()), (expected, expected));
    let diagonal = mesh.diagonal();
    ours.iter()
        .map(|(key, point)| (point - theirs[key]).norm() / diagonal)
        .collect()
}

#[test]
fn subdivision_moves_every_vertex_to_the_same_place() {
    let why = "in diagonals: a few products added in another order";
    let [mut smooth, mut butterfly] = ["Loop subdivision", "modified butterfly subdivision"]
        .map(|quantity| Comparison::new(quantity, Library::OpenMesh, ROUNDING, why));
    for (name, mesh) in meshes::all() {
        let finer = subdivide_loop(&mesh, 1);
        smooth.add(&name, deviations(&mesh, &finer, &openmesh_loop(&mesh)));
        let other = subdivide_butterfly(&mesh, 1);
        butterfly.add(&name, deviations(&mesh, &other, &openmesh_butterfly(&mesh)));
        if mesh.vertex_count() < 1_500 {
            let name = format!("{name}, second round");
            let finest = subdivide_loop(&finer, 1);
            smooth.add(&name, deviations(&finer, &finest, &openmesh_loop(&finer)));
            let finest = subdivide_butterfly(&other, 1);
            let theirs = openmesh_butterfly(&other);
            butterfly.add(&name, deviations(&other, &finest, &theirs));
        }
    }
    smooth.finish();
    butterfly.finish();
}

#[test]
fn catmull_clark_moves_every_vertex_of_a_closed_mesh_to_the_same_place() {
    const LEVELS: u32 = 4;
    let mut comparison = Comparison::new(
        "Catmull-Clark subdivision of smooth closed meshes",
        Library::OpenMesh,
        ROUNDING,
        "in diagonals: a few products added in another order",
    );
    for (name, mesh) in meshes::control() {
        // OpenMesh's mask of boundary vertices is another one.
        if !mesh.topology().boundary_loops().is_empty() {
            continue;
        }
        let rules = Rules::default();
        let sharpness = Sharpness::smooth(mesh.topology(), rules);
        let mut refined = Refined::none(mesh.topology(), &sharpness);
        for theirs in openmesh_catmull_clark(&mesh, LEVELS) {
            refined = refined.again(rules);
            let ours = refined.stencils.apply(mesh.positions());
            assert_eq!(ours.len(), theirs.len());
            let diagonal = mesh.diagonal();
            let pairs = ours.iter().zip(&theirs);
            comparison.add(&name, pairs.map(|(a, b)| (a - b).norm() / diagonal));
        }
    }
    comparison.finish();
}
