//! Real and damaged model files, where they are at hand.

use std::path::PathBuf;

use msplines_io::read_soup;

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
