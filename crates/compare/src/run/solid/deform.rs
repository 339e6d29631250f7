//! Solids deformed by their control points.

use msplines_common::{Point3, Vector3};
use msplines_trivariate::TrivariateSpline;

use crate::case::LatticeMove;
use crate::error::{RunError, TrivariateError};

/// Returns a solid after control points have been moved.
pub(super) fn moved(
    spline: &TrivariateSpline,
    moves: &[LatticeMove],
    diagonal: f64,
) -> Result<TrivariateSpline, RunError> {
    let size = spline.size();
    let place = |at: usize| [at % size, at / size % size, at / (size * size)];
    let share = |i: usize| i as f64 / (size - 1) as f64;
    let mut targets: Vec<([usize; 3], Point3<f64>)> = Vec::new();
    for (at, point) in spline.points().iter().enumerate() {
        let index = place(at);
        let inside = |step: &&LatticeMove| {
            (0..3).all(|d| (step.low[d]..=step.high[d]).contains(&share(index[d])))
        };
        let by: Vector3<f64> = moves
            .iter()
            .filter(inside)
            .map(|step| Vector3::from(step.by) * diagonal)
            .sum();
        if by != Vector3::zeros() {
            targets.push((index, point + by));
        }
    }
    Ok(spline.with_moved(&targets).map_err(TrivariateError::Move)?)
}
