//! Where along an edge of the domain a point of its curve goes.
//!
//! A chart of valence `k` maps the distance `s` from its centre along an edge to `s^(4/k)`. A curve
//! whose arc length grew with `s` would have infinite speed there for `k = 3` and none for `k > 4`.
//! The regularised incomplete beta function grows like `s^(4/k)` at both ends instead, so that the
//! speed in both charts is finite and positive.
//!
//! # Notation
//! `I_s(a, b) = B(s; a, b) / B(1; a, b)` with `B(s; a, b) = ∫₀ˢ t^(a-1) (1-t)^(b-1) dt`.
//!
//! # Reference
//! [Wang2016] §4.3 parameterises curves by arc length. Deviation: this is that only in charts of
//! valence four.

/// Terms of a continued fraction; it needs about the root of the larger exponent of them.
const MOST_TERMS: u32 = 200;

/// Change of a factor below which a continued fraction has settled.
const SETTLED: f64 = 1e-16;

/// Stands for a denominator that vanishes.
const TINY: f64 = 1e-300;

/// Returns the fraction of the arc length at the fraction `s` of an edge: `I_s(a, b)`, for exponents
/// above zero at its start and its end.
pub(super) fn length_fraction(s: f64, [a, b]: [f64; 2]) -> f64 {
    if s <= 0.0 {
        return 0.0;
    }
    if s >= 1.0 {
        return 1.0;
    }
    if a == 1.0 && b == 1.0 {
        return s;
    }
    // The fraction settles fast on the near side of the mean only.
    if s > (a + 1.0) / (a + b + 2.0) {
        1.0 - lower(1.0 - s, b, a)
    } else {
        lower(s, a, b)
    }
}

/// Returns the factors of `s^a` and `(1 - s)^b` as which the fraction of the arc length, and what is
/// left of it, leave the ends of an edge.
pub(super) fn end_rates([a, b]: [f64; 2]) -> [f64; 2] {
    let beta = (log_gamma(a) + log_gamma(b) - log_gamma(a + b)).exp();
    [1.0 / (a * beta), 1.0 / (b * beta)]
}

/// Returns a fraction that leaves the ends of an edge `ratios` times as fast as `x`, and always grows.
///
/// # Reference
/// [GregoryDelbourgo1982].
pub(super) fn regraded(x: f64, [m, n]: [f64; 2]) -> f64 {
    let y = x * (1.0 - x);
    (x * x + m * y) / (1.0 + (m + n - 2.0) * y)
}

/// Returns `I_s(a, b)` by its continued fraction, from front to back after Lentz.
fn lower(s: f64, a: f64, b: f64) -> f64 {
    let log_beta = log_gamma(a) + log_gamma(b) - log_gamma(a + b);
    let front = (a * s.ln() + b * (-s).ln_1p() - log_beta).exp() / a;
    let away = |x: f64| if x.abs() < TINY { TINY } else { x };
    let mut c = 1.0;
    let mut d = 1.0 / away(1.0 - (a + b) * s / (a + 1.0));
    let mut fraction = d;
    for m in 1..=MOST_TERMS {
        let m = f64::from(m);
        let even = m * (b - m) * s / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * s / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let mut change = 1.0;
        for term in [even, odd] {
            d = 1.0 / away(1.0 + term * d);
            c = away(1.0 + term / c);
            change = c * d;
            fraction *= change;
        }
        if (change - 1.0).abs() < SETTLED {
            break;
        }
    }
    front * fraction
}

/// Returns the logarithm of the gamma function of a positive number, to about 1e-15: the series of
/// Lanczos, with the well-known coefficients for `g = 7` and nine terms.
fn log_gamma(x: f64) -> f64 {
    const G: f64 = 7.0;
    const TERMS: [f64; 9] = [
        0.999_999_999_999_809_9,
        676.520_368_121_885_1,
        -1_259.139_216_722_402_8,
        771.323_428_777_653_1,
        -176.615_029_162_140_6,
        12.507_343_278_686_905,
        -0.138_571_095_265_720_12,
        9.984_369_578_019_572e-6,
        1.505_632_735_149_311_6e-7,
    ];
    if x < 0.5 {
        // Away from the pole at zero.
        return log_gamma(x + 1.0) - x.ln();
    }
    let y = x - 1.0;
    let later = TERMS[1..].iter().zip(1..);
    let sum = TERMS[0] + later.map(|(c, i)| c / (y + f64::from(i))).sum::<f64>();
    let t = y + G + 0.5;
    0.5 * std::f64::consts::TAU.ln() + (y + 0.5) * t.ln() - t + sum.ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest error against closed forms: a few roundings of the logarithms.
    const ERROR: f64 = 2e-14;

    fn steps() -> impl Iterator<Item = f64> {
        (0..=64).map(|i| f64::from(i) / 64.0)
    }

    #[test]
    fn one_exponent_of_one_is_a_power() {
        for s in steps() {
            assert_eq!(length_fraction(s, [1.0, 1.0]), s);
            for a in [4.0 / 3.0, 0.8, 2.0 / 3.0, 0.5, 0.4, 4.0 / 120.0] {
                assert!(
                    (length_fraction(s, [a, 1.0]) - s.powf(a)).abs() < ERROR,
                    "{s} {a}"
                );
                let mirrored = 1.0 - (1.0 - s).powf(a);
                assert!(
                    (length_fraction(s, [1.0, a]) - mirrored).abs() < ERROR,
                    "{s} {a}"
                );
            }
        }
    }

    #[test]
    fn whole_exponents_give_polynomials() {
        for s in steps() {
            let found = length_fraction(s, [2.0, 2.0]);
            assert!((found - s * s * (3.0 - 2.0 * s)).abs() < ERROR);
            let found = length_fraction(s, [2.0, 3.0]);
            assert!((found - s * s * (6.0 - 8.0 * s + 3.0 * s * s)).abs() < ERROR);
        }
    }

    #[test]
    fn ends_are_left_at_the_rates_and_ratios_asked_for() {
        const NEAR: f64 = 1e-7;
        // The next term is about fifty times NEAR to the power of the smaller exponent.
        const ERROR: f64 = 5e-3;
        for exponents in [[1.0, 1.0], [4.0 / 3.0, 0.8], [2.0 / 3.0, 1.0]] {
            for ratios in [[1.0, 1.0], [0.02, 3.0], [0.5, 0.1]] {
                let [m, n] = [0, 1].map(|end| ratios[end] * end_rates(exponents)[end]);
                let at = |s: f64| regraded(length_fraction(s, exponents), ratios);
                let start = at(NEAR) / NEAR.powf(exponents[0]);
                let end = (1.0 - at(1.0 - NEAR)) / NEAR.powf(exponents[1]);
                assert!((start / m - 1.0).abs() < ERROR, "{start} {m}");
                assert!((end / n - 1.0).abs() < ERROR, "{end} {n}");
            }
        }
    }

    #[test]
    fn regrading_always_grows_and_may_do_nothing() {
        for ratios in [[0.02, 0.02], [0.02, 3.0], [3.0, 3.0], [1.0, 0.3]] {
            let all: Vec<f64> = steps().map(|x| regraded(x, ratios)).collect();
            assert!(all.windows(2).all(|w| w[1] > w[0]), "{ratios:?}");
            assert_eq!((all[0], all[64]), (0.0, 1.0));
        }
        assert!(steps().all(|x| (regraded(x, [1.0, 1.0]) - x).abs() < 1e-15));
    }

    #[test]
    fn halves_give_the_arcsine() {
        for s in steps() {
            let found = length_fraction(s, [0.5, 0.5]);
            let arcsine = std::f64::consts::FRAC_2_PI * s.sqrt().asin();
            assert!((found - arcsine).abs() < ERROR, "{s}");
        }
    }

    #[test]
    fn the_other_direction_is_the_rest_and_it_always_grows() {
        for k in 3..=120 {
            for l in [3, 4, 5, 6, 120] {
                let [a, b] = [k, l].map(|k| 4.0 / f64::from(k));
                let mut last = 0.0;
                for s in steps().skip(1) {
                    let here = length_fraction(s, [a, b]);
                    let rest = length_fraction(1.0 - s, [b, a]);
                    assert!((here + rest - 1.0).abs() < ERROR, "{k} {l} {s}");
                    assert!(here > last, "{k} {l} {s}");
                    last = here;
                }
            }
        }
    }

    #[test]
    fn the_speed_at_an_end_is_that_of_the_chart() {
        for k in [3, 5, 6, 8] {
            let a = 4.0 / f64::from(k);
            let rate = |s: f64| length_fraction(s, [a, 0.8]) / s.powf(a);
            assert!((rate(1e-4) / rate(1e-8) - 1.0).abs() < 1e-4, "{k}");
        }
    }
}
