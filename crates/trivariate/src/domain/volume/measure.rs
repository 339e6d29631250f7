//! Folds and distortion of a map of a solid.

use msplines_common::mesh::tet::{Orientation, TetMesh, orientation};
use nalgebra::Point3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Determinants below this count as this in means of logarithms.
const FLOOR: f64 = 1e-9;

/// What can be said about a map to the cube in numbers; determinants are relative to their mean
/// over the volume, which is 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Quality {
    /// Cells that are inverted or flat in the cube, decided exactly.
    pub flipped: usize,
    /// Smallest determinant.
    pub smallest_determinant: f64,
    /// Mean of `|ln det J|` over all cells; determinants below 1e-9 count as 1e-9.
    pub distortion: f64,
    /// The same, weighted by the volume of cells.
    pub distortion_by_volume: f64,
}

/// Returns the determinant of the map in every cell, relative to the volume of the solid.
pub(super) fn determinants(mesh: &TetMesh, image: &TetMesh) -> Vec<f64> {
    let volumes = |mesh: &TetMesh| -> Vec<f64> {
        let cells = 0..mesh.cell_count() as u32;
        cells
            .into_par_iter()
            .map(|cell| mesh.signed_volume(cell))
            .collect()
    };
    let (rest, mapped) = (volumes(mesh), volumes(image));
    let total: f64 = rest.iter().sum();
    rest.iter()
        .zip(mapped)
        .map(|(rest, mapped)| mapped / rest * total)
        .collect()
}

/// Returns the mesh with parameters as positions.
pub(super) fn image(mesh: &TetMesh, parameters: &[[f64; 3]]) -> TetMesh {
    mesh.with_positions(parameters.iter().map(|&p| Point3::from(p)).collect())
}

/// Returns the cells that are not positive in the cube, or whose determinant is not above `least`.
pub(super) fn bad_cells(mesh: &TetMesh, parameters: &[[f64; 3]], least: f64) -> Vec<u32> {
    let image = image(mesh, parameters);
    let determinants = determinants(mesh, &image);
    let bad = |&cell: &u32| {
        determinants[cell as usize] <= least
            || orientation(&image.tetrahedron(cell)) != Orientation::Positive
    };
    (0..mesh.cell_count() as u32)
        .into_par_iter()
        .filter(bad)
        .collect()
}

/// Returns the quality of a map.
#[must_use]
pub fn measure(mesh: &TetMesh, parameters: &[[f64; 3]]) -> Quality {
    let image = image(mesh, parameters);
    let determinants = determinants(mesh, &image);
    let logarithms: Vec<f64> = determinants
        .par_iter()
        .map(|det| det.max(FLOOR).ln().abs())
        .collect();
    let volume = |cell: u32| mesh.signed_volume(cell);
    let weighted = logarithms
        .iter()
        .zip(0u32..)
        .map(|(log, cell)| log * volume(cell));
    let total: f64 = (0..mesh.cell_count() as u32).map(volume).sum();
    Quality {
        flipped: image.not_positive().len(),
        smallest_determinant: determinants.iter().copied().fold(f64::INFINITY, f64::min),
        distortion: logarithms.iter().sum::<f64>() / logarithms.len() as f64,
        distortion_by_volume: weighted.sum::<f64>() / total,
    }
}
