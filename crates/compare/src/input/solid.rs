//! Solids: tetrahedra from files and names, or the closed surfaces that are filled with them.

use std::path::Path;

use msplines_common::mesh::tet::{TetFacts, TetMesh, accept};
use msplines_common::mesh::{Policy, TriangleMesh};
use msplines_io::{Format, read_tets, sha256_file};
use msplines_trivariate::domain::Solid;
use sha2::{Digest, Sha256};

use super::{file_name, hexadecimal, load, unreadable};
use crate::case::Input;
use crate::clock::PhaseClock;
use crate::error::RunError;
use crate::record::{InputFacts, InputKind};

/// A solid as it is given.
#[derive(Clone, Debug)]
pub(crate) enum Given {
    /// By its surface.
    Surface(TriangleMesh),
    /// By tetrahedra.
    Cells(TetMesh),
}

impl Given {
    /// Returns what a fit takes.
    pub(crate) fn solid(&self) -> Solid<'_> {
        match self {
            Self::Surface(surface) => Solid::Surface(surface),
            Self::Cells(cells) => Solid::Cells(cells),
        }
    }

    /// Returns the surface of the solid.
    pub(crate) fn surface(&self) -> TriangleMesh {
        match self {
            Self::Surface(surface) => surface.clone(),
            Self::Cells(cells) => cells.boundary(),
        }
    }
}

/// A solid with what is known about where it comes from.
#[derive(Clone, Debug)]
pub(crate) struct LoadedSolid {
    pub(crate) given: Given,
    pub(crate) facts: InputFacts,
    /// What was mended.
    pub(crate) warnings: Vec<String>,
}

/// Returns whether a file holds tetrahedra and no surface, by its content and then its extension; one
/// that cannot be read does not.
#[must_use]
pub fn holds_tetrahedra(path: &Path) -> bool {
    let format = std::fs::read(path)
        .ok()
        .and_then(|bytes| Format::detect(path, &bytes));
    matches!(
        format,
        Some(Format::Medit | Format::Gmsh | Format::Vtk | Format::Vtu | Format::TetGen)
    )
}

/// Reads or makes a solid, in the phases `read` and `preflight`.
pub(crate) fn load_solid(input: &Input, clock: &mut PhaseClock) -> Result<LoadedSolid, RunError> {
    clock.enter("read");
    match input {
        Input::Solid(shape) => {
            let mesh = shape.mesh();
            let facts = facts(&mesh, shape.to_string(), digest(&mesh));
            clock.leave();
            Ok(LoadedSolid {
                given: Given::Cells(mesh),
                facts,
                warnings: Vec::new(),
            })
        }
        Input::File { path, repair } if holds_tetrahedra(path) => {
            let policy = if *repair {
                Policy::Repair
            } else {
                Policy::Refuse
            };
            read(path, policy, clock)
        }
        _ => {
            let loaded = load(input, clock)?;
            Ok(LoadedSolid {
                given: Given::Surface(loaded.mesh),
                facts: loaded.facts,
                warnings: loaded.warnings,
            })
        }
    }
}

fn read(path: &Path, policy: Policy, clock: &mut PhaseClock) -> Result<LoadedSolid, RunError> {
    let file = file_name(path);
    let refused = |reason: String| RunError::Input {
        file: file.clone(),
        reason,
    };
    let sha256 = sha256_file(path).map_err(|e| refused(unreadable(&e)))?;
    let soup = read_tets(path).map_err(|e| refused(e.to_string()))?;
    clock.enter("preflight");
    let accepted = accept(&soup, policy).map_err(|e| refused(e.to_string()))?;
    clock.leave();
    let repairs = accepted.repairs.iter();
    Ok(LoadedSolid {
        facts: facts(&accepted.mesh, file.clone(), sha256),
        warnings: repairs.map(|r| format!("repaired: {r}")).collect(),
        given: Given::Cells(accepted.mesh),
    })
}

/// Faces are those of the boundary.
fn facts(mesh: &TetMesh, file: String, sha256: String) -> InputFacts {
    let facts = TetFacts::measure(mesh);
    InputFacts {
        file,
        sha256,
        kind: InputKind::Tets,
        vertices: facts.vertices as u64,
        faces: facts.boundary_faces as u64,
        cells: facts.cells as u64,
        genus: facts.boundary_genus.map(u64::from),
        boundary_loops: 0,
    }
}

/// SHA-256 of positions and cells, as little-endian bytes.
fn digest(mesh: &TetMesh) -> String {
    let mut digest = Sha256::new();
    for position in mesh.positions() {
        position.iter().for_each(|x| digest.update(x.to_le_bytes()));
    }
    for cell in mesh.cells() {
        cell.iter().for_each(|v| digest.update(v.to_le_bytes()));
    }
    hexadecimal(&digest.finalize())
}
