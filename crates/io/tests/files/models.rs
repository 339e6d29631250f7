//! Real and damaged model files, where they are at hand.

use std::path::PathBuf;

use msplines_common::mesh::Policy;
use msplines_common::mesh::tet;
use msplines_io::{read_soup, read_tets};

/// Returns where model files are, if they are.
fn models(folder: &str) -> Option<PathBuf> {
    let here = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/models");
    let root = std::env::var_os("MSPLINES_MODELS").map_or_else(|| here.into(), PathBuf::from);
    Some(root.join(folder)).filter(|path| path.is_dir())
}

#[test]
fn every_hostile_file_is_read_or_refused_by_name() {
    let Some(folder) = models("hostile") else {
        println!("not run: every_hostile_file_is_read_or_refused_by_name");
        return;
    };
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match read_soup(&path) {
            Ok(soup) => {
                assert_eq!(soup.face_offsets.last(), Some(&soup.face_vertices.len()));
                for attribute in &soup.attributes {
                    assert_eq!(attribute.values.len(), soup.positions.len());
                }
            }
            Err(error) => {
                let name = path.file_name().unwrap().to_str().unwrap();
                assert!(error.to_string().contains(name), "{error}");
            }
        }
    }
}

#[test]
fn known_files_have_their_known_sizes() {
    let Some(folder) = models("hostile") else {
        println!("not run: known_files_have_their_known_sizes");
        return;
    };
    // A closed surface of genus 0 has twice as many faces as vertices, less four.
    let sizes = [
        ("igea_tristrips_raw.ply", 134_345, 2 * 134_345 - 4),
        ("bun_zipper_raw.ply", 35_947, 69_451),
        ("bones_26_components.off", 2_154, 4_204),
        ("made_far_from_origin.obj", 32, 64),
        ("made_nan_inf.ply", 32, 64),
    ];
    for (name, vertices, faces) in sizes {
        let soup = read_soup(&folder.join(name)).unwrap();
        assert_eq!(
            (soup.positions.len(), soup.face_count()),
            (vertices, faces),
            "{name}"
        );
    }
}

#[test]
fn solids_of_the_library_are_clean_and_of_known_size() {
    let Some(folder) = models("tet") else {
        println!("not run: solids_of_the_library_are_clean_and_of_known_size");
        return;
    };
    let sizes = [
        ("armadillo13k.mesh", 13_230, 54_985, 17_296, 0),
        ("bone.mesh", 8_316, 30_798, 12_088, 0),
        ("bunny_500.mesh", 638, 2_245, 996, 0),
        ("octopus_low.mesh", 452, 1_140, 898, 0),
        ("rocker_arm.mesh", 16_782, 70_920, 20_088, 1),
    ];
    for (name, vertices, cells, boundary, genus) in sizes {
        let soup = read_tets(&folder.join(name)).unwrap();
        let mesh = tet::accept(&soup, Policy::Refuse).unwrap().mesh;
        assert_eq!(
            (mesh.vertex_count(), mesh.cell_count()),
            (vertices, cells),
            "{name}"
        );
        assert_eq!(mesh.boundary().face_count(), boundary, "{name}");
        assert_eq!(mesh.require_sphere().is_ok(), genus == 0, "{name}");
    }
}
