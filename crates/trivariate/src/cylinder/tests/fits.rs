//! Splines over cylindrical parameters.

use msplines_common::bspline::{locate, weights};
use msplines_common::mesh::{TriangleMesh, shapes, zoo};
use nalgebra::Point3;

use super::*;
use crate::cylinder::lattice::{Fitting, Grid};
use crate::measure::measure;

#[test]
fn volume_is_positive_whichever_way_normals_point() {
    let body = ellipsoid(1.5);
    let turned = body.faces().iter().map(|&[a, b, c]| [a, c, b]).collect();
    let turned = TriangleMesh::build(body.positions().to_vec(), turned).expect("a surface");
    let poles = Poles::Given([-1.5, 1.5].map(|z| nearest(&body, Point3::new(0.0, 0.0, z))));
    let options = Options { poles, ..small() };
    for surface in [body, turned] {
        let map = mapped(&surface, &options);
        assert!(volume(&map) > 6.0);
        assert!(mean_determinant(&fitted(&map, &options).spline) > 0.0);
        assert!(mean_determinant(&fitted(&map, &multilevel(2, 8)).spline) > 0.0);
    }
}

#[test]
fn splines_are_periodic_in_longitude() {
    /// Rounding of second derivatives at 8 spans of a solid of size 1.
    const ROUNDING: f64 = 1e-11;
    let map = mapped(&zoo::closed(), &small());
    for options in [
        small(),
        multilevel(4, 16),
        multilevel(1, 8),
        multilevel(2, 2),
    ] {
        let spline = fitted(&map, &options).spline;
        let (spans, size) = (spline.spans(), spline.size());
        for jk in 0..size * size {
            for i in 0..3 {
                let [a, b] = [i, spans + i].map(|i| [i, jk % size, jk / size]);
                assert_eq!(spline.point(a), spline.point(b));
            }
        }
        for (latitude, radius) in [(0.1, 1.0), (0.5, 0.3), (0.93, 0.8)] {
            let [a, b] = [0.0, 1.0].map(|t| spline.jet([t, latitude, radius]));
            assert!((a.value - b.value).norm() < 1e-12);
            let first = a.first.iter().zip(&b.first);
            let second = a.second.iter().zip(&b.second);
            assert!(first.chain(second).all(|(a, b)| (a - b).norm() < ROUNDING));
        }
    }
}

/// What each control point is asked for by all samples, straight from the formula.
fn by_samples(grid: &Grid<'_>, spans: usize) -> Vec<f64> {
    let size = spans + 3;
    let mut sums = vec![[0.0; 4]; size.pow(3)];
    let [u, v, w] = grid.parameters.map(<[f64]>::len);
    for sample in 0..u * v * w {
        let index = [sample % u, sample / u % v, sample / (u * v)];
        let located = [0, 1, 2].map(|axis| locate(spans, grid.parameters[axis][index[axis]]));
        let mut functions = vec![0.0; size.pow(3)];
        for p in 0..64 {
            let [i, j, k] = [p % 4, p / 4 % 4, p / 16];
            let [a, b, c] = [located[0].0 + i, located[1].0 + j, located[2].0 + k];
            let [x, y, z] = located.map(|(_, x)| weights(x));
            functions[a % spans + size * (b + size * c)] += x[i] * y[j] * z[k];
        }
        let squares: f64 = functions.iter().map(|f| f * f).sum();
        for (sum, f) in sums.iter_mut().zip(&functions) {
            let values = &grid.values[3 * sample..3 * sample + 3];
            for (sum, value) in sum.iter_mut().zip(values) {
                *sum += f * f * f * value / squares;
            }
            sum[3] += f * f;
        }
    }
    let value = |at: usize| sums[at - at % size + at % size % spans];
    let lattice = (0..size.pow(3)).map(value);
    lattice
        .flat_map(|[x, y, z, squares]| {
            [x, y, z].map(|c| if squares > 0.0 { c / squares } else { 0.0 })
        })
        .collect()
}

#[test]
fn levels_on_a_grid_follow_the_formula_for_samples() {
    let (u, v, w) = (
        [0.0, 0.1, 0.45, 0.8, 0.99],
        [0.0, 0.3, 0.35, 1.0],
        [0.2, 0.9],
    );
    for spans in [1, 2, 3, 4, 5] {
        let values: Vec<f64> = (0..120).map(|i| (1.7 * f64::from(i)).sin()).collect();
        let grid = || Grid {
            parameters: [&u, &v, &w],
            values: values.clone(),
        };
        let expected = by_samples(&grid(), spans);
        let mut fitting = Fitting::begin(grid());
        let level = fitting.add_level(spans);
        let (spline, residuals) = fitting.finish();
        for (found, expected) in spline.flat().iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-12, "{spans}");
        }
        let at = spline.position([0.45, 0.35, 0.9]);
        let sample = 3 * (2 + 5 * (2 + 4));
        for d in 0..3 {
            assert!((values[sample + d] - at[d] - residuals[sample + d]).abs() < 1e-12);
        }
        assert!(level.max >= level.rms && level.rms > 0.0);
    }
}

#[test]
fn least_squares_find_a_spline_again() {
    let map = mapped(&zoo::closed(), &small());
    let spline = fitted(&map, &multilevel(4, 4)).spline;
    let steps = |count: usize| (0..count).map(move |i| i as f64 / count as f64);
    let u: Vec<f64> = steps(23).collect();
    let v: Vec<f64> = steps(19).chain([1.0]).collect();
    let mut values = Vec::new();
    for &c in &v {
        for &b in &v {
            values.extend(
                u.iter()
                    .flat_map(|&a| <[f64; 3]>::from(spline.position([a, b, c]))),
            );
        }
    }
    let mut fitting = Fitting::begin(Grid {
        parameters: [&u, &v, &v],
        values,
    });
    let level = fitting.least_squares(4, 1e-14).expect("a fit");
    let (found, _) = fitting.finish();
    assert!(level.max < 1e-10, "{level:?}");
    for (a, b) in found.points().iter().zip(spline.points()) {
        assert!((a - b).norm() < 1e-8);
    }
}

#[test]
fn degenerate_elements_are_counted_by_place() {
    let options = small();
    let spline = fitted(&mapped(&shapes::sphere(1000), &options), &options).spline;
    let places = degenerate_places(&spline, 10, 1);
    assert_eq!(places.total(), measure(&spline, 10).degenerate);
    // Elements with an edge on the axis are flat up to rounding, a fourth of those next to it.
    assert!(places.axis > 100 && places.elsewhere < 50, "{places:?}");
    let all = degenerate_places(&spline, 10, 5);
    assert_eq!((all.poles, all.total()), (all.total(), places.total()));
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let body = zoo::closed();
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(|| {
            let map = mapped(&body, &small());
            let fit = fitted(&map, &small());
            (map, fit)
        })
    };
    assert_eq!(run(1), run(3));
}
