//! What a fit is asked for: whether it is a task, and where it begins.

use msplines_common::Vector3;

use super::error::FitError;
use super::samples::Sample;
use crate::complex::CylinderComplex;
use crate::options::{FitOptions, Refinement, Solver, Stop};
use crate::tmesh::Grid;

/// Columns that a support needs not to meet itself.
const LEAST_COLUMNS: usize = 4;

/// Returns a base grid for every cylinder, with as many faces as its share of the samples asks for.
pub(super) fn grids(complex: &CylinderComplex, samples: &[Sample], cells: usize) -> Vec<Grid> {
    let mut shares = vec![0.0; complex.cylinders().len()];
    samples
        .iter()
        .for_each(|s| shares[s.at.cylinder as usize] += s.weight);
    let total: f64 = shares.iter().sum();
    let cylinders = complex.cylinders().iter().zip(&shares);
    cylinders
        .map(|(cylinder, share)| {
            let mut grid = Grid::of_cells(cylinder, (cells as f64 * share / total).max(1.0), 1.0);
            grid.columns = grid.columns.max(LEAST_COLUMNS);
            grid
        })
        .collect()
}

/// Most control points of a fit: a factorisation of more takes tens of gigabytes.
const MOST_CONTROL_POINTS: usize = 2_000_000;

pub(super) fn centre(samples: &[Sample]) -> Vector3<f64> {
    let sum: Vector3<f64> = samples.iter().map(|s| s.position.coords).sum();
    sum / samples.len() as f64
}

pub(super) fn check(
    complex: &CylinderComplex,
    samples: &[Sample],
    options: &FitOptions,
) -> Result<(), FitError> {
    if samples.is_empty() {
        return Err(FitError::NoSamples);
    }
    let bad = |s: &Sample| {
        let numbers = [
            s.at.x,
            s.at.y,
            s.position.x,
            s.position.y,
            s.position.z,
            s.weight,
        ];
        numbers.iter().any(|n| !n.is_finite()) || s.weight < 0.0
    };
    if let Some(sample) = samples.iter().position(bad) {
        return Err(FitError::NotFinite { sample });
    }
    let cylinders = complex.cylinders().len();
    let beyond = |s: &Sample| s.at.cylinder as usize >= cylinders;
    if let Some(sample) = samples.iter().position(beyond) {
        return Err(FitError::NoCylinder {
            sample,
            cylinder: samples[sample].at.cylinder,
            cylinders,
        });
    }
    check_options(options)
}

fn check_options(options: &FitOptions) -> Result<(), FitError> {
    if let Stop::ControlPoints(given) = options.stop
        && given > MOST_CONTROL_POINTS
    {
        return Err(FitError::LargeBudget {
            given,
            most: MOST_CONTROL_POINTS,
        });
    }
    if let Stop::Tolerance(given) = options.stop
        && !(given > 0.0 && given.is_finite())
    {
        return Err(FitError::Tolerance { given });
    }
    if let Solver::ConjugateGradients { tolerance, .. } = options.solver
        && !(tolerance > 0.0 && tolerance < 1.0)
    {
        return Err(FitError::Option {
            option: "tolerance of conjugate gradients",
            range: "between 0 and 1",
            given: tolerance,
        });
    }
    let Refinement {
        share,
        exponent,
        ratio,
        ..
    } = options.refinement;
    let ranges = [
        ("share", share, "in (0, 1]", share > 0.0 && share <= 1.0),
        (
            "exponent",
            exponent,
            "positive",
            exponent > 0.0 && exponent.is_finite(),
        ),
        ("ratio", ratio, "1 or more", ratio >= 1.0),
        (
            "fairness",
            options.fairness,
            "0 or more",
            options.fairness >= 0.0 && options.fairness.is_finite(),
        ),
    ];
    let wrong = ranges.into_iter().find(|(.., good)| !good);
    wrong.map_or(Ok(()), |(option, given, range, _)| {
        Err(FitError::Option {
            option,
            range,
            given,
        })
    })
}
