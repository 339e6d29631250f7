//! Tetrahedra inside of a closed surface, by isosurface stuffing.
//!
//! A body-centred cubic lattice covers the surface. Which lattice points lie inside, and where
//! lattice edges cross the surface, is computed exactly on coordinates rounded to 2^-26 of the
//! box. Lattice points that lie close to a crossing are moved onto it; what is left of the lattice's
//! tetrahedra inside is cut by a few stencils. Dihedral angles are bounded whatever the surface is:
//! by 10.7 and 164.8 degrees as published, for which the tests look on many surfaces; 11.0 and 159.4
//! were the worst of seven scanned models on all lattices tried. Samples of each stencil alone,
//! which do not ask whether moves can happen together, reach 9.3 and 161.7.
//!
//! Where sheets of the boundary touch, lattice points keep their place and crossings keep their
//! distance from them, which undoes the contact and keeps the angles. If parts of the surface are
//! lost or its topology is not met, a finer lattice is tried.
//!
//! # Reference
//! [Labelle2007]. Deviation: winding numbers instead of a signed distance, nearest crossings first,
//! contacts undone.

mod attempt;
mod boundary;
mod crossings;
mod error;
mod grid;
mod lattice;
mod options;
mod parts;
mod report;
mod stencils;
#[cfg(test)]
mod tests;
mod tetrahedra;
mod warp;

use std::ops::ControlFlow;

use msplines_common::mesh::tet::TetMesh;
use msplines_common::mesh::{TriangleMesh, self_crossings};
use msplines_common::progress::{Observer, Progress};

pub use error::{MesherError, Shortfall};
pub use options::{Crossings, MesherOptions, Parts, Spacing, Wanted, volume};
pub use report::{Attempt, MesherReport};

/// Crossings closer to a lattice point than this fraction of a long edge attract it.
///
/// # Reference
/// [Labelle2007] Table 1.
pub const ALPHA_LONG: f64 = 0.24999;

/// Crossings closer to a lattice point than this fraction of a short edge attract it.
///
/// # Reference
/// [Labelle2007] Table 1.
pub const ALPHA_SHORT: f64 = 0.41189;

/// A solid filled with tetrahedra, and how it came about.
#[derive(Clone, Debug)]
pub struct Filled {
    /// The mesh; its boundary is near to the surface, with vertices of its own.
    pub mesh: TetMesh,
    /// All attempts, the last one successful.
    pub report: MesherReport,
}

/// Returns the inside of a closed surface, filled with tetrahedra.
///
/// Inside is where the surface winds around a point at least once, so that parts which overlap
/// become one. The surface may be oriented either way. The result is the same for any number of
/// threads. Cost: O(faces + lattice points), a lattice of n cells along the diagonal has up to
/// 0.4 n³ points.
///
/// # Errors
/// The surface is not closed, passes through itself, encloses nothing, or is not what `options.wanted` says; no lattice
/// keeps its parts and its topology; an option means nothing; the observer asks to stop.
pub fn fill(
    surface: &TriangleMesh,
    options: &MesherOptions,
    observer: &mut Observer<'_>,
) -> Result<Filled, MesherError> {
    options.check()?;
    let expected = examine(surface, options)?;
    let mut report = MesherReport::default();
    let spacings = options.spacings(surface);
    let mut shortfall = None;
    for (number, &spacing) in spacings.iter().enumerate() {
        let progress = Progress::new("domain", number as u64, spacings.len() as u64);
        if let ControlFlow::Break(()) = observer(&progress) {
            return Err(MesherError::Stopped);
        }
        let (attempt, result) = attempt::run(surface, spacing, expected, options)?;
        report.attempts.push(attempt);
        match result {
            Ok(mesh) => return Ok(Filled { mesh, report }),
            Err(reason) => shortfall = Some(reason),
        }
    }
    Err(MesherError::NoLattice {
        attempts: spacings.len(),
        spacing: spacings.last().copied().unwrap_or_default(),
        shortfall: shortfall.unwrap_or(Shortfall::Empty),
    })
}

/// Checks the surface, and returns the Euler characteristic that the boundary must have, if any.
fn examine(surface: &TriangleMesh, options: &MesherOptions) -> Result<Option<i64>, MesherError> {
    if let Some(vertex) = surface
        .positions()
        .iter()
        .position(|p| p.iter().any(|x| !x.is_finite()))
    {
        let vertex = vertex as u32;
        return Err(MesherError::NotFinite { vertex });
    }
    let topology = surface.topology();
    let loops = topology.boundary_loops();
    if let Some(first) = loops.first() {
        return Err(MesherError::Open {
            loops: loops.len(),
            vertex: topology.origin(first[0]),
        });
    }
    if surface.face_count() == 0 {
        return Err(MesherError::NoVolume);
    }
    if options.crossings == Crossings::Refused
        && let crossings = self_crossings(surface)
        && let Some(&faces) = crossings.first()
    {
        let count = crossings.len();
        return Err(MesherError::Crossing { count, faces });
    }
    let (labels, pieces) = topology.components();
    let euler = topology.euler_characteristic();
    match options.wanted {
        Wanted::Sphere if pieces > 1 => {
            let vertex = labels.iter().position(|&label| label == 1).unwrap_or(0);
            Err(MesherError::SeveralSurfaces {
                pieces,
                vertex: vertex as u32,
            })
        }
        Wanted::Sphere if euler != 2 => Err(MesherError::Genus {
            genus: ((2 - euler) / 2) as u32,
        }),
        Wanted::Sphere | Wanted::LikeInput => Ok(Some(euler)),
        Wanted::Anything => Ok(None),
    }
}
