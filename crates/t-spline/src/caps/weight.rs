//! The weight of a cap.

use nalgebra::Complex;

use super::{CapPoint, Jet};

impl CapPoint {
    /// Returns this point with another `w` and the same derivatives.
    pub(super) fn at(self, w: Complex<f64>) -> Self {
        Self { w, ..self }
    }
}

/// Returns a point of a cap from `w` and the first two derivatives of its logarithm.
pub(super) fn cap_point(
    cap: u32,
    w: Complex<f64>,
    [slope, curve]: [Complex<f64>; 2],
    core: f64,
) -> CapPoint {
    // q = |w| = exp(Re L), and by x and y the derivatives of Re L are Re L' and -Im L'.
    let q = w.norm();
    let (a, b) = (slope.re, -slope.im);
    let radius = Jet([
        q,
        q * a,
        q * b,
        q * (a * a + curve.re),
        q * (a * b - curve.im),
        q * (b * b - curve.re),
    ]);
    // Both weights from their own end, so that each keeps its relative accuracy where it vanishes: beside a
    // core the rest weighs quotients of functions that vanish there too.
    let rate = 1.0 / (1.0 - core);
    let (t, u) = ((1.0 - q) * rate, (q - core) * rate);
    let (phi, rest) = if u <= 0.0 {
        (Jet::ONE, Jet::default())
    } else {
        let first = 30.0 * t * t * u * u * rate;
        let second = 60.0 * t * u * (u - t) * rate * rate;
        (
            radius.through([step(t), -first, second]),
            radius.through([step(u), first, -second]),
        )
    };
    let dw = w * slope;
    CapPoint {
        cap,
        w,
        dw: [dw, dw * slope + w * curve],
        phi,
        rest,
    }
}

/// Returns the quintic that rises from 0 to 1, with two vanishing derivatives at either end.
fn step(t: f64) -> f64 {
    t * t * t * (10.0 + t * (6.0 * t - 15.0))
}
