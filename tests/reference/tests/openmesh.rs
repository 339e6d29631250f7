//! Topology and Loop subdivision against OpenMesh.

use std::collections::BTreeMap;

use msplines_common::mesh::Topology;
use msplines_reference::record::Comparison;
use msplines_reference::{Library, meshes, openmesh_facts};
use nalgebra::Point3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

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

/// Numbers the vertices that are used, so that unreferenced ones do not matter.
fn compact(faces: &[[u32; 3]]) -> (usize, Vec<[u32; 3]>) {
    let mut numbers = BTreeMap::new();
    for &vertex in faces.as_flattened() {
        let next = numbers.len() as u32;
        numbers.entry(vertex).or_insert(next);
    }
    (
        numbers.len(),
        faces
            .iter()
            .map(|face| face.map(|vertex| numbers[&vertex]))
            .collect(),
    )
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
            let (count, faces) = compact(&faces);
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
