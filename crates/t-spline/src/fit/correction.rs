//! Samples moved over the cylinders towards the nearest points of the surface.
//!
//! # Notation
//! `r = p - F`, `J = (F_x, F_y)`; a step `δ` of Gauss and Newton solves `Jᵀ J δ = Jᵀ r`. No step is longer
//! than half a leaf, and none is taken that leads further away. On a boundary `F_y` counts as 0.
//!
//! # Reference
//! [Hoschek1988], the correction of parameters. Deviation from [He2006], which has none: its errors are
//! measured at fixed parameters.

use msplines_common::Vector3;
use msplines_common::evaluate::Order;
use nalgebra::{Matrix2, Vector2};
use rayon::prelude::*;

use super::samples::Sorted;
use crate::complex::{CylinderComplex, Point, UNITS};
use crate::space::Rows;
use crate::spline::{SurfaceSamples, TSpline};

/// Share of the length of the larger derivative below which directions count as dependent.
const DAMPING: f64 = 1e-9;

/// Moves samples once, where that brings the surface nearer; `rows` are theirs, with derivatives. Returns
/// the share that moved.
pub(super) fn correct(spline: &TSpline, sorted: &mut Sorted, rows: &Rows) -> f64 {
    let mut here = SurfaceSamples::default();
    spline.apply(rows, Order::First, &mut here);
    let mesh = spline.space().mesh();
    let complex = mesh.complex();
    let tried: Vec<(Point, [f64; 2])> = (0..sorted.samples.len())
        .into_par_iter()
        .map(|i| {
            let sample = &sorted.samples[i];
            if !sample.movable {
                return (sample.at, [0.0; 2]);
            }
            let leaf = mesh.leaves()[mesh.leaf_of(sample.at) as usize];
            let [x, y] = here.first[i];
            let residual = sample.position - here.positions[i];
            // Samples of a boundary stay on it, so that the surface ends where they do.
            let across = if complex.is_on_boundary(sample.at) {
                Vector3::zeros()
            } else {
                y
            };
            let step = step(
                [x.dot(&x), x.dot(&across), across.dot(&across)],
                [x.dot(&residual), across.dot(&residual)],
            );
            let longest = leaf.size().map(|s| 0.5 * s as f64 / UNITS);
            let excess = (step.x.abs() / longest[0]).max(step.y.abs() / longest[1]);
            let step = [step.x, step.y].map(|d| d / excess.max(1.0) * UNITS);
            walked(complex, sorted.beginning(i), step).unwrap_or((sample.at, [0.0; 2]))
        })
        .collect();
    let points: Vec<Point> = tried.iter().map(|t| t.0).collect();
    let there = spline.evaluate(&points, Order::Value);
    let mut moved = 0;
    for (i, sample) in sorted.samples.iter_mut().enumerate() {
        let before = (sample.position - here.positions[i]).norm_squared();
        let after = (sample.position - there.positions[i]).norm_squared();
        if after < before {
            let (at, way) = tried[i];
            sample.at = at;
            sample.shift = [0, 1].map(|k| sample.shift[k] + way[k]);
            moved += 1;
        }
    }
    moved as f64 / sorted.samples.len() as f64
}

/// Returns where a sample comes that began at a point, has moved and makes one more step, and the step: along
/// a border where the surface ends. Nothing if there is no way.
///
/// The whole way is walked straight on from the beginning: what is known of a sample at the end is how far it has moved,
/// and a way in steps may pass a zero on the other side.
fn walked(
    complex: &CylinderComplex,
    (from, moved): (Point, [f64; 2]),
    step: [f64; 2],
) -> Option<(Point, [f64; 2])> {
    if step.iter().any(|d| !d.is_finite()) {
        return None;
    }
    let tried = [step, [step[0], 0.0]].into_iter().map(|step| {
        let (to, stopped) = complex.walk(from, [0, 1].map(|k| moved[k] + step[k]));
        stopped.is_none().then_some((to, step))
    });
    tried.flatten().next()
}

fn step([xx, xy, yy]: [f64; 3], [x, y]: [f64; 2]) -> Vector2<f64> {
    let damping = DAMPING * (xx + yy);
    let matrix = Matrix2::new(xx + damping, xy, xy, yy + damping);
    matrix
        .cholesky()
        .map_or(Vector2::zeros(), |c| c.solve(&Vector2::new(x, y)))
}

#[cfg(test)]
mod tests {
    use crate::complex::{Beyond, Segment};
    use crate::samples::double_zero;

    use super::*;

    /// In two steps past a zero one may come to another place than straight on: samples are where their whole
    /// way leads.
    #[test]
    fn samples_are_where_their_whole_way_leads() {
        let complex = double_zero(0.2345);
        let own = &complex.cylinders()[0];
        let is_narrow = |s: &&Segment| matches!(s.beyond, Beyond::Cylinder { cylinder: 1, .. });
        // Where the wide cylinder begins to border on the narrow one there is a zero.
        let narrow = own.top.iter().find(is_narrow).expect("a border");
        let from = Point {
            cylinder: 0,
            x: narrow.start as f64 - 0.01 * UNITS,
            y: own.height as f64 - 0.01 * UNITS,
        };
        let (first, second) = (
            [0.005 * UNITS, 0.03 * UNITS],
            [0.04 * UNITS, -0.005 * UNITS],
        );
        let (there, way) = walked(&complex, (from, [0.0; 2]), first).expect("a way");
        assert_eq!((there, way), (complex.walk(from, first).0, first));
        let (to, way) = walked(&complex, (from, first), second).expect("a way");
        assert_eq!(way, second);
        let whole = [0, 1].map(|k| first[k] + second[k]);
        assert_eq!(to, complex.walk(from, whole).0);
        // The zero lies between the two ways.
        assert_ne!(to.cylinder, complex.walk(there, second).0.cylinder);
    }
}
