//! Atlases in files, by their extensions.

use std::path::{Path, PathBuf};

use msplines_common::mesh::TriangleMesh;
use msplines_io::{Surface, write_atomically, write_surface};

use crate::atlas_file::AtlasFile;
use crate::error::{AtlasError, RunError};
use crate::output::{check_folder, extension, is_array, write_texture};

/// Extensions of what holds an atlas.
const FORMATS: [&str; 5] = ["json", "obj", "ply", "glb", "npy"];

/// Checks before any work that every output has a known format and a folder.
pub(super) fn check(outputs: &[PathBuf]) -> Result<(), RunError> {
    for path in outputs {
        if !FORMATS.contains(&extension(path).as_str()) {
            return Err(AtlasError::Output { path: path.clone() }.into());
        }
        check_folder(path)?;
    }
    Ok(())
}

/// Writes an atlas to every output: the mesh with its texture, the texture alone, or all of it.
pub(super) fn write(
    outputs: &[PathBuf],
    file: &AtlasFile,
    mesh: &TriangleMesh,
    texture: &[[[f64; 2]; 3]],
) -> Result<(), RunError> {
    let surface = Surface {
        positions: mesh.positions(),
        faces: mesh.faces(),
        corner_texture: Some(texture.as_flattened()),
        ..Surface::default()
    };
    let write_one = |path: &Path| {
        if extension(path) == "json" {
            return write_atomically(path, |out| file.write(out));
        }
        write_surface(path, &surface)
    };
    outputs.iter().try_for_each(|path| {
        if is_array(path) {
            return write_texture(path, texture);
        }
        write_one(path).map_err(RunError::unwritten(path))
    })
}
