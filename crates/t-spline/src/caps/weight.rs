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
    let t = (1.0 - q) / (1.0 - core);
    let phi = if t >= 1.0 {
        Jet([1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    } else {
        let rate = -1.0 / (1.0 - core);
        let value = t * t * t * (10.0 + t * (6.0 * t - 15.0));
        let first = 30.0 * t * t * (1.0 - t) * (1.0 - t) * rate;
        let second = 60.0 * t * (1.0 - t) * (1.0 - 2.0 * t) * rate * rate;
        radius.through([value, first, second])
    };
    let dw = w * slope;
    CapPoint {
        cap,
        w,
        dw: [dw, dw * slope + w * curve],
        phi,
    }
}
