//! Spherical maps, flattenings and bounded forms of surfaces of the library of models.
#![allow(clippy::print_stdout, reason = "the measures of every model are shown")]

#[path = "../../../tests/library.rs"]
mod library;

use msplines_common::mesh::TriangleMesh;
use msplines_common::operators::intrinsic::FlipRule;
use msplines_common::progress::unobserved;
use msplines_conformal::bounded::bounded_form;
use msplines_conformal::disk::{Route, flatten_disk};
use msplines_conformal::sphere::spherical_map;

/// Closed models of genus 0 and the angle distortion that their faces leave, rounded up.
const CLOSED: [(&str, f64); 8] = [
    ("bunny_35k", 1.03),
    ("nefertiti_50k", 1.035),
    ("igea_134k", 1.01),
    ("maxplanck_49k", 1.015),
    ("horse_48k", 1.06),
    ("lucy_50k", 1.07),
    ("gargoyle_28632", 1.045),
    ("armadillo_43k", 1.07),
];

const DISKS: [(&str, f64); 4] = [
    ("face_4k", 1.055),
    ("maxplanck_8k7_open", 1.055),
    ("mannequin_devil_open", 1.07),
    ("demosthenes_8k", 1.07),
];

#[test]
fn closed_models_map_to_the_sphere_without_flips() {
    for (name, largest) in CLOSED {
        let Some(mesh) = library::model(name) else {
            continue;
        };
        let map =
            spherical_map(&mesh, FlipRule::Simplicial, &mut unobserved()).expect("a spherical map");
        println!("{name}: {:?}, {} moved", map.distortion, map.moved);
        assert_eq!(map.distortion.flips, 0);
        assert!(map.corrected && map.distortion.angle_mean < largest);
    }
}

#[test]
fn open_models_flatten_without_flips() {
    for (name, largest) in DISKS {
        let Some(mesh) = library::model(name) else {
            continue;
        };
        let map = flatten_disk(&mesh, &mut unobserved()).expect("a flattening");
        println!("{name}: {:?}, {:?}", map.distortion, map.route);
        assert_eq!(map.distortion.flips, 0);
        assert!(map.route != Route::Convex && map.distortion.angle_mean < largest);
    }
}

#[test]
fn five_holes_give_three_zeros_and_few_flips() {
    let Some(mesh) = library::model("bunny_35k_open") else {
        return;
    };
    let topology = mesh.topology();
    let loops = topology.boundary_loops().len();
    assert_eq!(loops, 5);
    let levels = [0.0, 1.0, 1.0, 1.0, 1.0];
    let result =
        bounded_form(&mesh, &levels, FlipRule::Simplicial, &mut unobserved()).expect("a form");
    let faces = &result.triangulation.faces;
    let on_boundary = |&v: &u32| topology.is_boundary_vertex(v);
    let ears = faces.iter().filter(|f| f.iter().all(on_boundary)).count();
    println!("{:?}, {ears} ears", result.distortion);
    // Two zeros have one each; one lies two edges from a hole, where 16 turn over.
    assert!(result.distortion.flips <= ears + 18);
    assert!(result.distortion.angle_p50 < 1.03);
    assert_eq!(saddles(&mesh, faces, &result.form), loops - 2);
}

/// Returns how many inner vertices see the first part of a form change its sign four times or more.
fn saddles(mesh: &TriangleMesh, faces: &[[u32; 3]], form: &[[f64; 2]]) -> usize {
    let mut changes = vec![0; mesh.vertex_count()];
    for (corners, sides) in faces.iter().zip(form.as_chunks::<3>().0) {
        for (i, &corner) in corners.iter().enumerate() {
            let [ahead, behind] = [sides[i][0], -sides[(i + 2) % 3][0]];
            changes[corner as usize] += u32::from((ahead > 0.0) != (behind > 0.0));
        }
    }
    let inner = |v: usize| !mesh.topology().is_boundary_vertex(v as u32);
    let vertices = 0..mesh.vertex_count();
    vertices.filter(|&v| inner(v) && changes[v] > 2).count()
}
