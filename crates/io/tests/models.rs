//! Real and damaged model files, where they are at hand.

use std::path::PathBuf;

use msplines_io::read_soup;

fn models() -> PathBuf {
    std::env::var_os("MSPLINES_MODELS").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/models")),
        PathBuf::from,
    )
}

#[test]
fn every_hostile_file_is_read_or_refused_with_its_name() {
    let Ok(entries) = std::fs::read_dir(models().join("hostile")) else {
        eprintln!("not run: hostile model files");
        return;
    };
    for entry in entries {
        let path = entry.unwrap().path();
        match read_soup(&path) {
            Ok(soup) => {
                assert_eq!(soup.face_offsets.last(), Some(&soup.face_vertices.len()));
                eprintln!(
                    "{}: {} {}",
                    path.display(),
                    soup.positions.len(),
                    soup.face_count()
                );
            }
            Err(error) => {
                let text = error.to_string();
                eprintln!("{text}");
                assert!(text.contains(path.file_name().unwrap().to_str().unwrap()));
            }
        }
    }
}
