//! Polish: the largest error falls, all else stays nearly as it was.

use msplines_common::evaluate::VertexData;
use msplines_common::mesh::{TriangleMesh, shapes, zoo};
use msplines_common::progress::unobserved;

use super::{fit_positions, positions};
use crate::{Fit, KnotChoice, Options, Selection, Target, fit};

/// The polish compares fits whose squared error exceeds its minimum by 1e-5.
const FIT_TOLERANCE: f64 = 1e-3;

fn options(count: usize, polish: bool) -> Options {
    Options {
        knots: KnotChoice::Optimised { count },
        seed: 3,
        polish,
        ..Options::default()
    }
}

/// Largest, mean and mean squared distance, with weights.
#[derive(Debug)]
struct Errors {
    largest: f64,
    mean: f64,
    mean_square: f64,
}

impl Errors {
    fn of(fit: &Fit, mesh: &TriangleMesh, weight: impl Fn(usize) -> f64) -> Self {
        let (found, wanted) = (fit.spline.vertex_values().unwrap(), positions(mesh));
        let pairs = found.chunks(3).zip(wanted.chunks(3));
        let square = |(a, b): (&[f64], &[f64])| -> f64 {
            a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum()
        };
        let distances: Vec<f64> = pairs
            .enumerate()
            .map(|(vertex, pair)| weight(vertex) * square(pair).sqrt())
            .collect();
        let mean = |values: &dyn Fn(f64) -> f64| {
            distances.iter().map(|&d| values(d)).sum::<f64>() / distances.len() as f64
        };
        Self {
            largest: distances.iter().copied().fold(0.0, f64::max),
            mean: mean(&|d| d),
            mean_square: mean(&|d| d * d),
        }
    }

    /// Checks what every polish promises against the fit without it.
    fn check(&self, before: &Self) {
        let slack = 1.0 + FIT_TOLERANCE;
        let allowed = 1.01 * slack;
        assert!(
            self.largest <= slack * before.largest
                && self.mean <= allowed * before.mean
                && self.mean_square <= allowed * before.mean_square,
            "{self:?} {before:?}"
        );
    }
}

#[test]
fn the_largest_error_never_rises_and_the_others_hardly() {
    for (mesh, count) in [
        (zoo::closed(), 40),
        (zoo::with_boundary(), 40),
        (zoo::knotted(), 60),
        (zoo::genus(2), 80),
    ] {
        let before = fit_positions(&mesh, &options(count, false));
        let after = fit_positions(&mesh, &options(count, true));
        assert_eq!(after.spline.knots().len(), count);
        assert_eq!(before.report.polish_rounds, [0, 0]);
        let [tried, kept] = after.report.polish_rounds;
        assert!(tried > 0 && kept <= tried);
        Errors::of(&after, &mesh, |_| 1.0).check(&Errors::of(&before, &mesh, |_| 1.0));
    }
}

/// On scans the largest error falls by a fifth after the standard effort.
#[test]
fn the_largest_error_falls() {
    let mesh = shapes::bumpy_sphere(4000);
    let before = fit_positions(&mesh, &options(160, false));
    let after = fit_positions(&mesh, &options(160, true));
    let [before, after] = [before, after].map(|fit| Errors::of(&fit, &mesh, |_| 1.0));
    after.check(&before);
    assert!(
        after.largest < 0.95 * before.largest,
        "{after:?} {before:?}"
    );
}

/// Weights count: what is far where the weight is small is no peak.
#[test]
fn the_largest_weighted_error_never_rises() {
    let mesh = shapes::bumpy_sphere(2000);
    let values = positions(&mesh);
    let weight = |vertex: usize| if values[3 * vertex] > 0.0 { 1.0 } else { 0.1 };
    let weights: Vec<f64> = (0..mesh.vertex_count()).map(weight).collect();
    let target = Target {
        data: VertexData {
            dimension: 3,
            values: &values,
        },
        weights: Some(&weights),
    };
    let [before, after] = [false, true].map(|polish| {
        let fit = fit(&mesh, target, &options(100, polish), &mut unobserved()).unwrap();
        Errors::of(&fit, &mesh, weight)
    });
    after.check(&before);
    assert!(after.largest < before.largest, "{after:?} {before:?}");
}

#[test]
fn any_selection_can_be_polished() {
    let mesh = zoo::closed();
    for selection in [Selection::L1, Selection::Curvature, Selection::BlueNoise] {
        let [before, after] = [false, true].map(|polish| {
            let options = Options {
                selection,
                ..options(40, polish)
            };
            let fit = fit_positions(&mesh, &options);
            assert_eq!(fit.spline.knots().len(), 40);
            Errors::of(&fit, &mesh, |_| 1.0)
        });
        after.check(&before);
    }
}

#[test]
fn any_number_of_threads_polishes_to_the_same_bits() {
    let mesh = zoo::knotted();
    let [one, three] = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let polished = || fit_positions(&mesh, &options(50, true)).spline;
        pool.build().unwrap().install(polished)
    });
    assert_eq!(one.knots(), three.knots());
    assert_eq!(one.form(), three.form());
}

#[test]
fn few_and_nearly_all_knots_can_be_polished() {
    let mesh = zoo::with_two_boundaries();
    let n = mesh.vertex_count();
    for count in [1, 2, n - 1] {
        let fit = fit_positions(&mesh, &options(count, true));
        assert_eq!(fit.spline.knots().len(), count);
    }
}
