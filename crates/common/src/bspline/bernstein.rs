//! Polynomials in Bernstein form over `[0, 1]`, along one axis of an array.

use super::axis::Axis;

/// Returns `n` over `k`; exact up to `n = 50`.
#[must_use]
pub fn binomial(n: usize, k: usize) -> f64 {
    if k > n {
        return 0.0;
    }
    (0..k.min(n - k)).fold(1.0, |product, i| product * (n - i) as f64 / (i + 1) as f64)
}

/// Writes the `degree + 1` Bernstein polynomials at `x` into `out`, whose length says the degree.
pub fn values(x: f64, out: &mut [f64]) {
    let Some(first) = out.first_mut() else { return };
    *first = 1.0;
    for degree in 1..out.len() {
        let mut carried = 0.0;
        for value in &mut out[..degree] {
            let old = *value;
            *value = carried + (1.0 - x) * old;
            carried = x * old;
        }
        out[degree] = carried;
    }
}

/// Returns the value at `x`, by de Casteljau's algorithm.
#[must_use]
pub fn evaluate(coefficients: &[f64], x: f64) -> f64 {
    let mut row = coefficients.to_vec();
    for count in (1..row.len()).rev() {
        for i in 0..count {
            row[i] = (1.0 - x) * row[i] + x * row[i + 1];
        }
    }
    row.first().copied().unwrap_or(0.0)
}

/// Replaces `values` by the coefficients over the lower half of the axis, and returns those over
/// the upper half.
///
/// Each number is the mean of two before, `count - 1` times over: the error of rounding is at
/// most `count - 1` units in the last place of the largest coefficient.
#[must_use]
pub fn halve(axis: Axis, values: &mut [f64]) -> Vec<f64> {
    let mut upper = vec![0.0; values.len()];
    let (inner, block) = (axis.inner, axis.count * axis.inner);
    if block == 0 {
        return upper;
    }
    for (low, high) in values
        .chunks_exact_mut(block)
        .zip(upper.chunks_exact_mut(block))
    {
        for step in 0..axis.count {
            let last = axis.count - 1 - step;
            high[last * inner..(last + 1) * inner]
                .copy_from_slice(&low[(axis.count - 1) * inner..]);
            for at in ((step + 1) * inner..block).rev() {
                low[at] = 0.5 * (low[at - inner] + low[at]);
            }
        }
    }
    upper
}

/// Returns the coefficients of the product of two polynomials.
#[must_use]
pub fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    let (p, q) = (a.len().saturating_sub(1), b.len().saturating_sub(1));
    let mut out = vec![0.0; p + q + 1];
    for (i, &x) in a.iter().enumerate() {
        for (j, &y) in b.iter().enumerate() {
            let weight = binomial(p, i) * binomial(q, j) / binomial(p + q, i + j);
            out[i + j] += weight * x * y;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROUNDING: f64 = 1e-14;

    #[test]
    fn values_are_sums_of_the_polynomials() {
        let coefficients = [2.0, -1.0, 0.5, 3.0, -4.0];
        let mut row = [0.0; 5];
        for step in 0..=10 {
            let x = f64::from(step) / 10.0;
            values(x, &mut row);
            let sum: f64 = row.iter().zip(coefficients).map(|(b, c)| b * c).sum();
            assert!((evaluate(&coefficients, x) - sum).abs() < ROUNDING);
            assert_eq!(evaluate(&[7.5], x), 7.5);
        }
        assert_eq!(evaluate(&[], 0.5), 0.0);
    }

    #[test]
    fn values_sum_to_one_and_reproduce_the_identity() {
        let mut row = [0.0; 9];
        for step in 0..=10 {
            let x = f64::from(step) / 10.0;
            values(x, &mut row);
            let mean: f64 = row
                .iter()
                .enumerate()
                .map(|(i, v)| v * i as f64 / 8.0)
                .sum();
            assert!((row.iter().sum::<f64>() - 1.0).abs() < ROUNDING);
            assert!((mean - x).abs() < ROUNDING);
        }
    }

    #[test]
    fn halves_are_the_polynomial() {
        let coefficients = [1.0, -2.0, 0.5, 3.0, 1.5];
        let axis = Axis {
            outer: 1,
            count: 5,
            inner: 1,
        };
        let mut low = coefficients.to_vec();
        let high = halve(axis, &mut low);
        for step in 0..=10 {
            let x = f64::from(step) / 10.0;
            let expected = [x / 2.0, 0.5 + x / 2.0].map(|t| evaluate(&coefficients, t));
            assert!((evaluate(&low, x) - expected[0]).abs() < ROUNDING);
            assert!((evaluate(&high, x) - expected[1]).abs() < ROUNDING);
        }
    }

    #[test]
    fn halves_along_an_axis_leave_other_lines_alone() {
        let axis = Axis {
            outer: 2,
            count: 3,
            inner: 2,
        };
        let mut low: Vec<f64> = (0..12).map(f64::from).collect();
        let high = halve(axis, &mut low);
        assert_eq!(
            low,
            [0.0, 1.0, 1.0, 2.0, 2.0, 3.0, 6.0, 7.0, 7.0, 8.0, 8.0, 9.0]
        );
        assert_eq!(
            high,
            [
                2.0, 3.0, 3.0, 4.0, 4.0, 5.0, 8.0, 9.0, 9.0, 10.0, 10.0, 11.0
            ]
        );
    }

    #[test]
    fn product_is_the_product() {
        let (a, b) = ([1.0, 2.0, -1.0], [0.5, -3.0, 2.0, 4.0]);
        let c = product(&a, &b);
        for step in 0..=10 {
            let x = f64::from(step) / 10.0;
            assert!((evaluate(&c, x) - evaluate(&a, x) * evaluate(&b, x)).abs() < ROUNDING);
        }
    }

    #[test]
    fn binomials() {
        assert_eq!(binomial(8, 3), 56.0);
        assert_eq!(binomial(3, 5), 0.0);
        assert_eq!(binomial(50, 25), 126_410_606_437_752.0);
    }
}
