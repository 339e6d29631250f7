//! Cubic B-splines on five knots.
//!
//! # Notation
//! Knots `k_0 <= .. <= k_4`; span `i` is `[k_i, k_{i+1}]`. On it the function is a cubic in
//! `s = scale (t - origin)`, which runs from 0 at the outer end of the span to 1 at the inner one: near
//! both ends of the support values keep their relative accuracy, and mirrored knots give mirrored bits.
//!
//! # Reference
//! [He2006] Eq. (1); the recursion of Cox and de Boor.

#[cfg(test)]
pub(crate) mod tests;

/// A cubic on one span.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Span {
    origin: f64,
    scale: f64,
    /// Coefficients of `1, s, s^2, s^3`.
    power: [f64; 4],
}

/// One cubic B-spline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blend {
    knots: [f64; 5],
    spans: [Span; 4],
}

impl Blend {
    /// Returns the function of ascending knots, which may be repeated; it is zero if all are equal.
    #[must_use]
    pub fn new(knots: [f64; 5]) -> Self {
        let mut spans = [Span::default(); 4];
        for i in 0..4 {
            let width = knots[i + 1] - knots[i];
            if width > 0.0 {
                let (origin, scale) = if i < 2 {
                    (knots[i], 1.0 / width)
                } else {
                    (knots[i + 1], -1.0 / width)
                };
                let slope = if i < 2 { width } else { -width };
                let power = cubic(&knots, i, origin, slope);
                spans[i] = Span {
                    origin,
                    scale,
                    power,
                };
            } else if i > 0 {
                // Only the end of the support is looked up in an empty span, and belongs to the last one.
                spans[i] = spans[i - 1];
            }
        }
        Self { knots, spans }
    }

    /// Returns the knots.
    #[must_use]
    pub fn knots(&self) -> &[f64; 5] {
        &self.knots
    }

    /// Returns the value and, up to `ORDER`, derivatives; zeros beyond the support, whose ends belong to
    /// it. At a repeated knot inside, values are those to its right.
    #[must_use]
    #[inline]
    pub fn evaluate<const ORDER: usize>(&self, t: f64) -> [f64; 3] {
        let k = &self.knots;
        if !(k[0] <= t && t <= k[4]) {
            return [0.0; 3];
        }
        let place = usize::from(t >= k[1]) + usize::from(t >= k[2]) + usize::from(t >= k[3]);
        let Span {
            origin,
            scale,
            power: [a, b, c, d],
        } = self.spans[place];
        let s = scale * (t - origin);
        let value = a + s * (b + s * (c + s * d));
        let mut out = [value, 0.0, 0.0];
        if ORDER > 0 {
            out[1] = scale * (b + s * (2.0 * c + s * (3.0 * d)));
        }
        if ORDER > 1 {
            out[2] = scale * scale * (2.0 * c + s * (6.0 * d));
        }
        out
    }

    /// Returns the Bernstein coefficients over an interval that no knot divides, by the blossom.
    #[must_use]
    pub(crate) fn bernstein(&self, ends: [f64; 2]) -> [f64; 4] {
        let k = &self.knots;
        let middle = 0.5 * (ends[0] + ends[1]);
        if !(k[0] < middle && middle < k[4]) {
            return [0.0; 4];
        }
        let after = |knot: f64| usize::from(middle >= knot);
        let span = self.spans[after(k[1]) + after(k[2]) + after(k[3])];
        let [u, v] = ends.map(|t| span.scale * (t - span.origin));
        let [a, b, c, d] = span.power;
        [[u, u, u], [u, u, v], [u, v, v], [v, v, v]].map(|[p, q, r]| {
            a + b * ((p + q + r) / 3.0) + c * ((p * q + q * r + r * p) / 3.0) + d * (p * q * r)
        })
    }
}

/// Returns the cubic on a span by the recursion, in polynomials of `s` with `t = origin + slope s`.
fn cubic(k: &[f64; 5], span: usize, origin: f64, slope: f64) -> [f64; 4] {
    let mut n = [[0.0; 4]; 4];
    n[span][0] = 1.0;
    for p in 1..=3 {
        for i in 0..=3 - p {
            let rising = k[i + p] - k[i];
            let up = [origin - k[i], slope];
            let falling = k[i + p + 1] - k[i + 1];
            let down = [k[i + p + 1] - origin, -slope];
            let terms = [
                product(&n[i], up, rising),
                product(&n[i + 1], down, falling),
            ];
            n[i] = std::array::from_fn(|c| terms[0][c] + terms[1][c]);
        }
    }
    n[0]
}

/// Returns a polynomial times a line over a width, or zero if that is zero.
fn product(polynomial: &[f64; 4], line: [f64; 2], width: f64) -> [f64; 4] {
    if width <= 0.0 {
        return [0.0; 4];
    }
    let [a, b] = line.map(|c| c / width);
    let p = polynomial;
    [
        p[0] * a,
        p[1] * a + p[0] * b,
        p[2] * a + p[1] * b,
        p[3] * a + p[2] * b,
    ]
}
