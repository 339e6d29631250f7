//! Uniform cubic B-splines over `[0, 1]`.
//!
//! # Notation
//! `n` spans of length `1/n`, `n + 3` coefficients `c_i`; on span `s` the spline is
//! `sum over p of B_p(x) c_(s+p)` with the local coordinate `x` in `[0, 1]`.
//!
//! # Reference
//! [Kim2014] Eq. (2), §5. Deviation: the parameter 1 belongs to the last span, with `x = 1`.

use super::axis::Axis;

/// Returns the span of a parameter in `[0, 1]` and the coordinate in it; a parameter outside
/// is moved to the nearer end, and what is not a number to 0.
#[must_use]
pub fn locate(spans: usize, parameter: f64) -> (usize, f64) {
    let scaled = parameter.clamp(0.0, 1.0) * spans as f64;
    // A cast of NaN gives 0.
    let span = (scaled as usize).min(spans.saturating_sub(1));
    let local = scaled - span as f64;
    (span, if local.is_nan() { 0.0 } else { local })
}

/// Returns the four basis functions that do not vanish on a span, at its coordinate `x`.
///
/// # Reference
/// [Kim2014] Eq. (2), §5.
#[must_use]
pub fn weights(x: f64) -> [f64; 4] {
    let y = 1.0 - x;
    let (x2, y2) = (x * x, y * y);
    [
        y2 * y / 6.0,
        ((3.0 * x - 6.0) * x2 + 4.0) / 6.0,
        ((3.0 * y - 6.0) * y2 + 4.0) / 6.0,
        x2 * x / 6.0,
    ]
}

/// Returns the derivatives of [`weights`] by `x`; by the parameter they are `n` times as large.
#[must_use]
pub fn slopes(x: f64) -> [f64; 4] {
    let y = 1.0 - x;
    [
        -0.5 * y * y,
        (1.5 * x - 2.0) * x,
        (2.0 - 1.5 * y) * y,
        0.5 * x * x,
    ]
}

/// Returns the second derivatives of [`weights`] by `x`; by the parameter they are `n²` times as
/// large.
#[must_use]
pub fn curvatures(x: f64) -> [f64; 4] {
    [1.0 - x, 3.0 * x - 2.0, 1.0 - 3.0 * x, x]
}

/// Returns the parameter at which coefficient `i` of `spans` spans acts: with these coefficients the
/// spline is the identity. The first and the last lie outside of `[0, 1]`.
#[must_use]
pub fn greville(spans: usize, i: usize) -> f64 {
    (i as f64 - 1.0) / spans as f64
}

/// Returns the Bézier coefficients on a span from its four B-spline coefficients.
#[must_use]
pub fn to_bezier(c: [f64; 4]) -> [f64; 4] {
    [
        (c[0] + 4.0 * c[1] + c[2]) / 6.0,
        (2.0 * c[1] + c[2]) / 3.0,
        (c[1] + 2.0 * c[2]) / 3.0,
        (c[1] + 4.0 * c[2] + c[3]) / 6.0,
    ]
}

/// Returns the four B-spline coefficients of a span from its Bézier coefficients.
#[must_use]
pub fn from_bezier(b: [f64; 4]) -> [f64; 4] {
    let (first, second) = (2.0 * b[1] - b[2], 2.0 * b[2] - b[1]);
    [
        6.0 * b[0] - 4.0 * first - second,
        first,
        second,
        6.0 * b[3] - first - 4.0 * second,
    ]
}

/// Returns the matrix from the four B-spline coefficients of a span to the Bézier coefficients on the
/// part `[from, to]` of it, by rows; all entries are non-negative for a part of `[0, 1]`.
#[must_use]
pub fn span_restriction(from: f64, to: f64) -> [[f64; 4]; 4] {
    let mut rows = [[0.0; 4]; 4];
    for (k, row) in rows.iter_mut().enumerate() {
        let arguments: [f64; 3] = std::array::from_fn(|i| if i < k { to } else { from });
        *row = blossom(arguments);
    }
    rows
}

/// Weights of the four coefficients in the polar form of a span, whose knots are -2, -1, 0, 1, 2, 3.
fn blossom(arguments: [f64; 3]) -> [f64; 4] {
    let mut rows = [
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
        [0.0, 0.0, 0.0, 1.0],
    ];
    for (step, &x) in arguments.iter().enumerate() {
        for i in 0..3 - step {
            // After `step` steps coefficient i spans the knots from i + step - 2 to i + 1.
            let (low, high) = ((i + step) as f64 - 2.0, i as f64 + 1.0);
            let (right, left) = ((x - low) / (high - low), (high - x) / (high - low));
            rows[i] = std::array::from_fn(|j| left * rows[i][j] + right * rows[i + 1][j]);
        }
    }
    rows[0]
}

/// Returns the coefficients of the same spline over twice as many spans.
///
/// # Panics
/// If there are fewer than four coefficients.
#[must_use]
pub fn refine(coefficients: &[f64]) -> Vec<f64> {
    let axis = Axis {
        outer: 1,
        count: coefficients.len(),
        inner: 1,
    };
    refine_axis(axis, coefficients)
}

/// Returns the coefficients of the same tensor product with twice as many spans along `axis`.
///
/// Exact but for rounding: the sums have the weights 1/2, 1/2 and 1/8, 6/8, 1/8.
///
/// # Panics
/// If the axis has fewer than four coefficients, or `values` is not an array of this shape.
#[must_use]
pub fn refine_axis(axis: Axis, values: &[f64]) -> Vec<f64> {
    assert!(axis.count >= 4, "a span needs four coefficients");
    let fine = 2 * axis.count - 3;
    let (mut first, mut rows) = (Vec::with_capacity(fine), Vec::with_capacity(fine));
    for j in 0..fine {
        let even = j % 2 == 0;
        first.push(if even { j / 2 } else { j.div_ceil(2) - 1 });
        rows.push(if even {
            [0.5, 0.5, 0.0]
        } else {
            [0.125, 0.75, 0.125]
        });
    }
    // The last even row has no third column; its first is moved so that all rows stay inside.
    if let (Some(start), Some(row)) = (first.last_mut(), rows.last_mut()) {
        *start -= 1;
        *row = [0.0, 0.5, 0.5];
    }
    axis.apply(&first, &rows, values)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of sums of a few numbers around 1.
    const ROUNDING: f64 = 1e-14;

    fn value(coefficients: &[f64], parameter: f64) -> f64 {
        let (span, x) = locate(coefficients.len() - 3, parameter);
        let row = weights(x);
        (0..4).map(|p| row[p] * coefficients[span + p]).sum()
    }

    fn wiggle(count: usize) -> Vec<f64> {
        (0..count).map(|i| (1.7 * i as f64).sin()).collect()
    }

    #[test]
    fn functions_sum_to_one_and_slopes_to_zero() {
        for step in 0..=20 {
            let x = f64::from(step) / 20.0;
            assert!((weights(x).iter().sum::<f64>() - 1.0).abs() < ROUNDING);
            assert!(slopes(x).iter().sum::<f64>().abs() < ROUNDING);
            assert!(curvatures(x).iter().sum::<f64>().abs() < ROUNDING);
        }
    }

    #[test]
    fn greville_coefficients_give_the_identity() {
        let coefficients: Vec<f64> = (0..8).map(|i| greville(5, i)).collect();
        for step in 0..=30 {
            let t = f64::from(step) / 30.0;
            assert!((value(&coefficients, t) - t).abs() < ROUNDING);
        }
    }

    #[test]
    fn slopes_are_differences_of_weights() {
        let h = 1e-5;
        for step in 1..10 {
            let x = f64::from(step) / 10.0;
            for p in 0..4 {
                let slope = (weights(x + h)[p] - weights(x - h)[p]) / (2.0 * h);
                let curvature = (slopes(x + h)[p] - slopes(x - h)[p]) / (2.0 * h);
                assert!((slope - slopes(x)[p]).abs() < 1e-9);
                assert!((curvature - curvatures(x)[p]).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn refining_keeps_the_function() {
        for spans in [1, 2, 5] {
            let coarse = wiggle(spans + 3);
            let fine = refine(&coarse);
            assert_eq!(fine.len(), 2 * spans + 3);
            for step in 0..=40 {
                let t = f64::from(step) / 40.0;
                assert!((value(&coarse, t) - value(&fine, t)).abs() < ROUNDING);
            }
        }
    }

    #[test]
    fn bezier_and_back() {
        // No coefficient is 2: twice 2 is also 2 more.
        let c = [0.3, -1.2, 1.9, 0.7];
        let back = from_bezier(to_bezier(c));
        let rows = span_restriction(0.0, 1.0);
        for i in 0..4 {
            assert!((back[i] - c[i]).abs() < ROUNDING);
            let restricted: f64 = (0..4).map(|j| rows[i][j] * c[j]).sum();
            assert!((restricted - to_bezier(c)[i]).abs() < ROUNDING);
        }
    }

    #[test]
    fn a_part_of_a_span_begins_and_ends_on_the_spline() {
        let rows = span_restriction(0.25, 0.5);
        for p in 0..4 {
            assert!((rows[0][p] - weights(0.25)[p]).abs() < ROUNDING);
            assert!((rows[3][p] - weights(0.5)[p]).abs() < ROUNDING);
            assert!(rows.iter().all(|row| row[p] >= 0.0));
        }
    }

    #[test]
    fn parameters_outside_are_moved_to_the_ends() {
        assert_eq!(locate(4, 1.0), (3, 1.0));
        assert_eq!(locate(4, 2.0), (3, 1.0));
        assert_eq!(locate(4, -1.0), (0, 0.0));
        assert_eq!(locate(4, f64::NAN), (0, 0.0));
    }

    #[test]
    fn transposed_is_the_transpose() {
        let axis = Axis::of(&[3, 5, 2], 1, 1);
        let (first, rows) = ([0, 3, 1], [[1.0, 2.0], [-1.0, 0.5], [0.25, 3.0]]);
        let (x, y) = (wiggle(30), wiggle(18));
        let forward = axis.apply(&first, &rows, &x);
        let backward = axis.apply_transposed(&first, &rows, &y);
        let left: f64 = forward.iter().zip(&y).map(|(a, b)| a * b).sum();
        let right: f64 = backward.iter().zip(&x).map(|(a, b)| a * b).sum();
        assert!((left - right).abs() < ROUNDING);
    }
}
