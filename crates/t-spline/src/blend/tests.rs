//! B-splines against the recursion in numbers, and their laws.

use super::Blend;

/// Cox and de Boor, half-open spans.
pub(crate) fn recursion(k: &[f64], p: usize, t: f64) -> f64 {
    if p == 0 {
        return f64::from(u8::from(k[0] <= t && t < k[1]));
    }
    let part = |up: f64, width: f64, n: f64| if width > 0.0 { up / width * n } else { 0.0 };
    part(t - k[0], k[p] - k[0], recursion(&k[..=p], p - 1, t))
        + part(k[p + 1] - t, k[p + 1] - k[1], recursion(&k[1..], p - 1, t))
}

const VECTORS: [[f64; 5]; 8] = [
    [-2.0, -1.0, 0.0, 1.0, 2.0],
    [-2.5, -1e-3, 0.0, 0.7, 0.9],
    [0.0, 0.0, 0.0, 0.0, 1.5],
    [0.0, 0.0, 0.0, 0.4, 1.5],
    [-0.3, -0.3, 0.0, 0.4, 1.5],
    [-1.0, 0.0, 0.0, 0.0, 0.0],
    [-1.0, -0.4, 0.0, 0.0, 0.0],
    [-1.0, -0.4, 0.0, 0.5, 0.5],
];

#[test]
fn values_are_those_of_the_recursion() {
    for k in VECTORS {
        let blend = Blend::new(k);
        for i in 0..1000 {
            let t = k[0] - 0.1 + (k[4] - k[0] + 0.2) * f64::from(i) / 999.0;
            let [value, ..] = blend.evaluate::<0>(t);
            // Power form of a function below 1: a few roundings.
            assert!((value - recursion(&k, 3, t)).abs() < 4e-15, "{k:?} {t}");
        }
    }
}

#[test]
fn derivatives_are_those_of_lower_degree() {
    for k in VECTORS {
        let blend = Blend::new(k);
        // k-th derivative of degree p: p (N_0 / (k_p - k_0) - N_1 / (k_{p+1} - k_1)).
        fn slope(k: &[f64], p: usize, times: usize, t: f64) -> f64 {
            if times == 0 {
                return recursion(k, p, t);
            }
            let part = |k: &[f64]| {
                let width = k[p] - k[0];
                if width > 0.0 {
                    slope(k, p - 1, times - 1, t) / width
                } else {
                    0.0
                }
            };
            p as f64 * (part(&k[..=p]) - part(&k[1..]))
        }
        for i in 0..500 {
            let t = k[0] + (k[4] - k[0]) * (f64::from(i) + 0.37) / 500.0;
            let [_, first, second] = blend.evaluate::<2>(t);
            let expected = [slope(&k, 3, 1, t), slope(&k, 3, 2, t)];
            assert!((first - expected[0]).abs() <= 1e-12 * (1.0 + expected[0].abs()));
            assert!((second - expected[1]).abs() <= 1e-12 * (1.0 + expected[1].abs()));
        }
    }
}

#[test]
fn ends_of_open_vectors_belong_to_the_support() {
    assert_eq!(Blend::new(VECTORS[2]).evaluate::<1>(0.0), [1.0, -2.0, 0.0]);
    assert_eq!(Blend::new(VECTORS[5]).evaluate::<1>(0.0), [1.0, 3.0, 0.0]);
    assert_eq!(Blend::new([1.0; 5]).evaluate::<2>(1.0), [0.0; 3]);
}

#[test]
fn mirrored_knots_give_mirrored_bits() {
    for k in VECTORS {
        let mut mirrored = k.map(|knot| -knot);
        mirrored.reverse();
        let (a, b) = (Blend::new(k), Blend::new(mirrored));
        for i in 0..100 {
            let t = k[0] + (k[4] - k[0]) * (f64::from(i) + 0.51) / 100.0;
            let (a, b) = (a.evaluate::<2>(t), b.evaluate::<2>(-t));
            assert_eq!(a, [b[0], -b[1], b[2]]);
        }
    }
}
