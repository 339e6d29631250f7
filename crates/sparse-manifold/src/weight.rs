//! The weight of a chart along one direction of a face.
//!
//! # Notation
//! `h(s)` is 1 up to `s = d`, 0 from `s = 1 - d` on, and smooth between:
//! `exp(2 exp(-1/x) / (x - 1))` with `x = (s - d) / (1 - 2 d)`. The weight is
//! `w(s) = h(s) / (h(s) + h(1 - s))`, so that `w(s) + w(1 - s) = 1`, and the weight of a chart is
//! `w(u) w(v)`: those of the four corners of a face sum to `(w(u) + w(1-u)) (w(v) + w(1-v)) = 1`.
//!
//! # Reference
//! [YingZorin2004]; [Wang2016] §4.1. Deviation: normalised in one direction instead of over the four
//! products, which keeps the sum exact; `d = 1/8`.

/// Up to here a weight is one, and from one minus it on it is zero.
pub(crate) const FLAT: f64 = 0.125;

/// Returns the weight at `s`, and its first two derivatives.
pub(crate) fn weight(s: f64) -> [f64; 3] {
    let (h, mirrored) = (bump(s), bump(1.0 - s));
    let g = [mirrored[0], -mirrored[1], mirrored[2]];
    // Neither vanishes where the other does.
    let sum = [0, 1, 2].map(|i| h[i] + g[i]);
    let value = h[0] / sum[0];
    let first = (h[1] - value * sum[1]) / sum[0];
    let second = (h[2] - 2.0 * first * sum[1] - value * sum[2]) / sum[0];
    [value, first, second]
}

fn bump(s: f64) -> [f64; 3] {
    let scale = 1.0 / (1.0 - 2.0 * FLAT);
    let x = (s - FLAT) * scale;
    if x <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    if x >= 1.0 {
        return [0.0; 3];
    }
    let rise = (-1.0 / x).exp();
    let rise = [
        rise,
        rise / (x * x),
        rise * (1.0 - 2.0 * x) / (x * x * x * x),
    ];
    let pole = 1.0 / (x - 1.0);
    let pole = [pole, -pole * pole, 2.0 * pole * pole * pole];
    let exponent = [
        2.0 * rise[0] * pole[0],
        2.0 * (rise[1] * pole[0] + rise[0] * pole[1]),
        2.0 * (rise[2] * pole[0] + 2.0 * rise[1] * pole[1] + rise[0] * pole[2]),
    ];
    let h = exponent[0].exp();
    if h == 0.0 {
        return [0.0; 3];
    }
    [
        h,
        h * exponent[1] * scale,
        h * (exponent[2] + exponent[1] * exponent[1]) * scale * scale,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opposite_weights_sum_to_one_and_are_flat_at_the_ends() {
        for i in 0..=1000 {
            let s = f64::from(i) / 1000.0;
            let (one, other) = (weight(s), weight(1.0 - s));
            assert!((one[0] + other[0] - 1.0).abs() <= f64::EPSILON, "{s}");
            assert!((0.0..=1.0).contains(&one[0]));
            assert!((one[1] - other[1]).abs() < 1e-12 && (one[2] + other[2]).abs() < 1e-10);
        }
        assert_eq!(weight(FLAT), [1.0, 0.0, 0.0]);
        assert_eq!(weight(1.0 - FLAT), [0.0, 0.0, 0.0]);
    }

    #[test]
    fn derivatives_are_those_of_the_weight() {
        const STEP: f64 = 1e-5;
        for i in 1..200 {
            let s = f64::from(i) / 200.0;
            let [_, first, second] = weight(s);
            let (low, here, high) = (weight(s - STEP), weight(s), weight(s + STEP));
            assert!((first - (high[0] - low[0]) / (2.0 * STEP)).abs() < 1e-7);
            assert!((second - (high[1] - low[1]) / (2.0 * STEP)).abs() < 1e-5);
            assert!(here[0].is_finite());
        }
    }
}
