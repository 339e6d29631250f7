//! What several tests of files need.

use std::path::PathBuf;

use msplines_common::mesh::PolygonSoup;
use tempfile::TempDir;

/// Returns a new folder, which goes when dropped, and the path of `name` in it.
pub(crate) fn scratch(name: &str) -> (TempDir, PathBuf) {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join(name);
    (directory, path)
}

/// Returns a soup with its numbers as bits, so that -0 differs from 0 and NaN equals itself.
#[allow(clippy::type_complexity, reason = "a tuple to compare, not to use")]
pub(crate) fn bits(soup: &PolygonSoup) -> (Vec<[u64; 3]>, Vec<Vec<i64>>, Vec<(String, Vec<u64>)>) {
    (
        soup.positions
            .iter()
            .map(|p| [p.x, p.y, p.z].map(f64::to_bits))
            .collect(),
        (0..soup.face_count())
            .map(|face| soup.face(face).to_vec())
            .collect(),
        soup.attributes
            .iter()
            .map(|a| {
                (
                    a.name.clone(),
                    a.values.iter().map(|v| v.to_bits()).collect(),
                )
            })
            .collect(),
    )
}
