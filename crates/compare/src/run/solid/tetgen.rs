//! The program `tetgen` in place of our own mesher.

use std::fmt::Write;
use std::io::ErrorKind;
use std::path::Path;
use std::process::{Command, Stdio};

use msplines_common::mesh::tet::{TetMesh, accept};
use msplines_common::mesh::{Policy, TriangleMesh};
use msplines_io::read_tets;
use msplines_trivariate::domain::mesher::{Spacing, volume};

use crate::error::{RunError, TrivariateError};

/// The program.
const PROGRAM: &str = "tetgen";
/// Largest ratio of the radius of a tetrahedron's sphere to its shortest edge.
const RATIO: &str = "1.414";

/// Returns the tetrahedra that the program fills a closed surface with. Its vertices keep their numbers, and
/// others follow them.
pub(super) fn fill(surface: &TriangleMesh, spacing: Spacing) -> Result<TetMesh, RunError> {
    let failed = |reason: String| TrivariateError::Tetgen { reason };
    let folder = tempfile::tempdir().map_err(|e| failed(format!("no temporary folder: {e}")))?;
    let path = folder.path().join("solid.smesh");
    std::fs::write(&path, smesh(surface)).map_err(|e| failed(e.to_string()))?;
    run(folder.path(), largest_volume(surface, spacing))?;
    let soup = read_tets(&folder.path().join("solid.1.ele"));
    let soup = soup.map_err(|e| failed(format!("it wrote what cannot be read: {e}")))?;
    let accepted = accept(&soup, Policy::Refuse);
    let accepted = accepted.map_err(|e| failed(format!("it made no solid: {e}")))?;
    Ok(accepted.mesh)
}

fn run(folder: &Path, volume: f64) -> Result<(), TrivariateError> {
    let ran = Command::new(PROGRAM)
        .arg(format!("-pq{RATIO}a{volume:.9}Q"))
        .arg("solid.smesh")
        .current_dir(folder)
        .stdin(Stdio::null())
        .output();
    match ran {
        Ok(output) if output.status.success() => Ok(()),
        Ok(output) => {
            let text = [output.stdout, output.stderr].concat();
            let text = String::from_utf8_lossy(&text).into_owned();
            let last = text.lines().rev().find(|line| !line.trim().is_empty());
            Err(TrivariateError::Tetgen {
                reason: format!(
                    "the program ended with {}, saying `{}`",
                    output.status,
                    last.unwrap_or("nothing").trim()
                ),
            })
        }
        Err(error) if error.kind() == ErrorKind::NotFound => Err(TrivariateError::NoTetgen),
        Err(error) => Err(TrivariateError::Tetgen {
            reason: format!("the program cannot be run: {error}"),
        }),
    }
}

/// Volume of the tetrahedron all of whose edges are as long as those of the lattice would be.
fn largest_volume(surface: &TriangleMesh, spacing: Spacing) -> f64 {
    let length = match spacing {
        Spacing::AlongDiagonal(count) => surface.diagonal() / count,
        Spacing::Length(length) => length,
        Spacing::Cells(cells) => return volume(surface) / f64::from(cells),
    };
    length.powi(3) / 72f64.sqrt()
}

/// The surface as TetGen reads it: vertices and faces, numbered from zero, no holes and no regions.
fn smesh(surface: &TriangleMesh) -> String {
    let mut text = format!("{} 3 0 0\n", surface.vertex_count());
    for (vertex, p) in surface.positions().iter().enumerate() {
        // Writing to a string never fails.
        let _ = writeln!(text, "{vertex} {:?} {:?} {:?}", p.x, p.y, p.z);
    }
    let _ = writeln!(text, "{} 0", surface.face_count());
    for [a, b, c] in surface.faces() {
        let _ = writeln!(text, "3 {a} {b} {c}");
    }
    text.push_str("0\n0\n");
    text
}

#[cfg(test)]
mod tests {
    use msplines_common::mesh::shapes;

    use super::*;

    #[test]
    fn the_file_lists_vertices_faces_and_no_holes() {
        let text = smesh(&shapes::cube(1));
        let mut lines = text.lines();
        assert_eq!(lines.next(), Some("8 3 0 0"));
        assert_eq!(lines.nth(8), Some("12 0"));
        assert_eq!(lines.skip(12).collect::<Vec<_>>(), ["0", "0"]);
    }
}
