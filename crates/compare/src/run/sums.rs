//! Sums of splines in files.

use std::path::PathBuf;

use msplines_biharmonic::{BiharmonicSpline, combine};

use crate::clock::PhaseClock;
use crate::error::{RunError, SplineFileError};
use crate::generated::mesh_digest;
use crate::input::{LoadedInput, load_domain};
use crate::spline_file::{SplineFile, StoredBiharmonic, StoredDomain, StoredSpline};

/// Returns the sum of a spline and others on the same mesh, each times its factor.
///
/// # Errors
/// Splines of another method, on another mesh or of another dimension.
pub(super) fn sum(
    first: &SplineFile,
    factor: f64,
    others: &[(PathBuf, f64)],
    input: &LoadedInput,
    clock: &mut PhaseClock,
) -> Result<StoredSpline, RunError> {
    let digest = mesh_digest(&input.mesh);
    let restored = |stored: &StoredSpline| -> Result<BiharmonicSpline, RunError> {
        Ok(stored.biharmonic("combine")?.restore(&input.mesh)?)
    };
    let mut splines = vec![(restored(&first.spline)?, factor)];
    for (path, factor) in others {
        let other = SplineFile::read(path)?;
        // A digest names the file of the mesh, which is at hand already.
        let same_file = matches!(&other.domain, StoredDomain::Digest { sha256, .. } if *sha256 == input.facts.sha256);
        if !same_file {
            let found = mesh_digest(&load_domain(&other, None, path, clock)?.mesh);
            if found != digest {
                let expected = digest;
                return Err(SplineFileError::OtherDomain { expected, found }.into());
            }
        }
        splines.push((restored(&other.spline)?, *factor));
    }
    let terms: Vec<(&BiharmonicSpline, f64)> = splines.iter().map(|(s, f)| (s, *f)).collect();
    Ok(StoredSpline::Biharmonic(StoredBiharmonic::of(&combine(
        &terms,
    )?)))
}
