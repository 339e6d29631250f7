//! Normal equations of samples, span by span through moments.
//!
//! # Notation
//! On a span the product of two basis functions of a direction is of degree 6: `B_p B_q = sum over a of
//! T_pqa β_a` with the Bernstein polynomials `β_a`. So 343 moments `sum of w β_a β_b β_c` of the
//! samples of a span stand for its 64² products, and turn into rows one direction after another.

use msplines_common::bspline::{bernstein, locate, weights};
use pulp::Arch;
use rayon::prelude::*;

use super::stencil::{REACH, Stencil, WIDTH, values};
use crate::samples::VolumeSamples;

/// Bernstein polynomials of a product of two cubics.
const MOMENTS: usize = 7;

/// A pair `(p, q)` of the 16 products of a span, with its coefficients `T_pqa`.
struct Pair {
    p: usize,
    q: usize,
    coefficients: [f64; MOMENTS],
}

/// Normal equations: a matrix, and a right-hand side of three columns.
pub(crate) struct Equations {
    pub(crate) matrix: Stencil,
    pub(crate) right: Vec<f64>,
}

/// Rounding of an energy, against the sum of squares of the points.
const ROUNDING: f64 = 1e-15;

impl Equations {
    /// What least squares minimise: `constant` is the sum of squares of the points. At least what
    /// rounding leaves of it.
    pub(crate) fn energy(&self, x: &[f64], constant: f64) -> f64 {
        let product = self.matrix.apply(x);
        let terms = x.iter().zip(&product).zip(&self.right);
        let sum: f64 = terms.map(|((x, ax), b)| x * (ax - 2.0 * b)).sum();
        (constant + sum).max(ROUNDING * constant)
    }
}

/// The normal equations of samples whose points are moved by `-centre`.
pub(crate) fn assemble(samples: &VolumeSamples, spans: usize, centre: [f64; 3]) -> Equations {
    let size = spans + 3;
    let mut matrix = Stencil::zero(size);
    let mut right = vec![0.0; 3 * size.pow(3)];
    let work = Work {
        samples,
        spans,
        centre,
        by_span: samples.by_span(spans),
        pairs: pairs(),
    };
    let (plane, right_plane) = (Stencil::plane(size), 3 * size * size);
    // Slabs of spans four apart share no control points.
    for colour in 0..4 {
        matrix.entries[colour * plane..]
            .par_chunks_mut(4 * plane)
            .zip(right[colour * right_plane..].par_chunks_mut(4 * right_plane))
            .enumerate()
            .filter(|(chunk, _)| colour + 4 * chunk < spans)
            .for_each(|(chunk, (rows, right))| work.slab(colour + 4 * chunk, rows, right));
    }
    let lattice = size.pow(3);
    let right = (0..3 * lattice).map(|at| right[at % lattice * 3 + at / lattice]);
    Equations {
        right: right.collect(),
        matrix,
    }
}

/// The products of the basis functions of a span.
fn pairs() -> Vec<Pair> {
    let pair = |at: usize| {
        let (p, q) = (at % 4, at / 4);
        let product = bernstein::product(&values(p), &values(q));
        let coefficients = std::array::from_fn(|a| product[a]);
        Pair { p, q, coefficients }
    };
    (0..16).map(pair).collect()
}

struct Work<'a> {
    samples: &'a VolumeSamples,
    spans: usize,
    centre: [f64; 3],
    by_span: (Vec<u32>, Vec<usize>),
    pairs: Vec<Pair>,
}

impl Work<'_> {
    /// Adds what the spans `(.., .., k)` give to their four planes of rows and right-hand sides.
    fn slab(&self, k: usize, rows: &mut [f64], right: &mut [f64]) {
        let (n, size) = (self.spans, self.spans + 3);
        let line = WIDTH * size;
        // Moments in the third direction of rows in the first two: [j][dj][c][di][i].
        let mut planar = vec![0.0; size * WIDTH * MOMENTS * line];
        let starts = |j: usize| &self.by_span.1[(k * n + j) * n..=(k * n + j + 1) * n];
        // Lines [c][b][di][i].
        let lines: Vec<Vec<f64>> = (0..n)
            .into_par_iter()
            .map(|j| self.along_lines(&self.moments(starts(j))))
            .collect();
        for (j, linear) in lines.iter().enumerate() {
            self.add_right(starts(j), right, j);
            for pair in &self.pairs {
                let target = ((j + pair.p) * WIDTH + pair.q + REACH - pair.p) * MOMENTS * line;
                for c in 0..MOMENTS {
                    let out = &mut planar[target + c * line..target + (c + 1) * line];
                    let from = &linear[c * MOMENTS * line..(c + 1) * MOMENTS * line];
                    add_combination(&pair.coefficients, from, out);
                }
            }
        }
        for pair in &self.pairs {
            let plane = &mut rows[pair.p * Stencil::plane(size)..];
            let dk = pair.q + REACH - pair.p;
            for (at, from) in planar.chunks_exact(MOMENTS * line).enumerate() {
                let (j, dj) = (at / WIDTH, at % WIDTH);
                let target = ((j * WIDTH + dk) * WIDTH + dj) * line;
                add_combination(&pair.coefficients, from, &mut plane[target..target + line]);
            }
        }
    }

    /// Moments `[c][b][a][i]` of a line of spans.
    fn moments(&self, starts: &[usize]) -> Vec<f64> {
        let n = self.spans;
        let mut out = vec![0.0; MOMENTS.pow(3) * n];
        for i in 0..n {
            let mut local = [0.0; MOMENTS * MOMENTS * MOMENTS];
            for &sample in &self.by_span.0[starts[i]..starts[i + 1]] {
                let at = self.samples.parameters()[sample as usize].map(|t| locate(n, t).1);
                add_moments(at, self.samples.weights()[sample as usize], &mut local);
            }
            for (at, moment) in local.into_iter().enumerate() {
                out[at * n + i] = moment;
            }
        }
        out
    }

    /// Adds what a line of spans gives to the right-hand sides.
    fn add_right(&self, starts: &[usize], right: &mut [f64], j: usize) {
        let (n, size) = (self.spans, self.spans + 3);
        for i in 0..n {
            for &sample in &self.by_span.0[starts[i]..starts[i + 1]] {
                let sample = sample as usize;
                let at = self.samples.parameters()[sample].map(|t| locate(n, t).1);
                let (weight, z) = (
                    self.samples.weights()[sample],
                    self.samples.points()[sample],
                );
                let z = [0, 1, 2].map(|d| weight * (z[d] - self.centre[d]));
                let [u, v, w] = at.map(weights);
                for qr in 0..16 {
                    let start = 3 * (i + size * (j + qr % 4 + size * (qr / 4)));
                    let vw = v[qr % 4] * w[qr / 4];
                    for (place, b) in right[start..start + 12].chunks_exact_mut(3).zip(u) {
                        for (sum, z) in place.iter_mut().zip(z) {
                            *sum += b * vw * z;
                        }
                    }
                }
            }
        }
    }

    /// Turns moments of the first direction into rows.
    fn along_lines(&self, moments: &[f64]) -> Vec<f64> {
        let (n, size) = (self.spans, self.spans + 3);
        let mut out = vec![0.0; MOMENTS * MOMENTS * WIDTH * size];
        for (rows, from) in out
            .chunks_exact_mut(WIDTH * size)
            .zip(moments.chunks_exact(MOMENTS * n))
        {
            for pair in &self.pairs {
                let target = (pair.q + REACH - pair.p) * size + pair.p;
                add_combination(&pair.coefficients, from, &mut rows[target..target + n]);
            }
        }
        out
    }
}

/// Adds a weighted product of Bernstein polynomials in three directions, the first fastest.
fn add_moments(at: [f64; 3], weight: f64, moments: &mut [f64]) {
    let [u, v, w] = at.map(|x| {
        let mut row = [0.0; MOMENTS];
        bernstein::values(x, &mut row);
        row
    });
    for (line, cb) in moments.chunks_exact_mut(MOMENTS).zip(0..) {
        let factor = weight * w[cb / MOMENTS] * v[cb % MOMENTS];
        for (moment, value) in line.iter_mut().zip(u) {
            *moment += factor * value;
        }
    }
}

/// Adds seven lines of `from` with their coefficients.
fn add_combination(coefficients: &[f64; MOMENTS], from: &[f64], out: &mut [f64]) {
    Arch::new().dispatch(
        #[inline(always)]
        || add_lines(coefficients, from, out),
    );
}

#[inline(always)]
fn add_lines(coefficients: &[f64; MOMENTS], from: &[f64], out: &mut [f64]) {
    let length = from.len() / MOMENTS;
    let lines: [&[f64]; MOMENTS] = std::array::from_fn(|a| &from[a * length..(a + 1) * length]);
    let c = coefficients;
    for (i, sum) in out[..length].iter_mut().enumerate() {
        *sum += c[0] * lines[0][i]
            + c[1] * lines[1][i]
            + c[2] * lines[2][i]
            + c[3] * lines[3][i]
            + c[4] * lines[4][i]
            + c[5] * lines[5][i]
            + c[6] * lines[6][i];
    }
}
