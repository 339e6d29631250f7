//! Positivity of the determinant, span by span.

use msplines_common::bspline::{Axis, bernstein};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::determinant::{COEFFICIENTS, Determinants, LANES};
use crate::spline::TrivariateSpline;

/// Roundings of halving an array of degree 8 in three directions, in units of its largest
/// coefficient: 8 means each, and a little more for the bound itself.
const HALVING: f64 = 25.0 * f64::EPSILON;

/// Options of [`certify`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// How often a span is halved in all directions before it stays undecided.
    pub depth: u32,
}

impl Default for Options {
    fn default() -> Self {
        Self { depth: 4 }
    }
}

/// What is proved about the determinant of the first derivatives.
///
/// `certified` and `refuted` hold in exact arithmetic of the stored control points, whatever was
/// rounded on the way.
#[derive(Clone, Debug, PartialEq)]
pub struct Certificate {
    /// Spans in all: `n³`.
    pub spans: usize,
    /// Spans on which it is positive, faces, edges and corners included.
    pub certified: usize,
    /// Spans with a point where it is not.
    pub refuted: Vec<Refuted>,
    /// Spans where neither was shown.
    pub undecided: Vec<[usize; 3]>,
    /// A lower bound on the whole cube, divided by the mean: 1 for an affine map. Not positive
    /// unless all spans are certified; minus infinity where the mean is 0.
    pub bound: f64,
    /// The mean: the signed volume of the solid.
    pub volume: f64,
}

/// A span with a point where the determinant is not positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refuted {
    /// The span.
    pub span: [usize; 3],
    /// Coordinates in the span, exact.
    pub local: [f64; 3],
    /// The same point as a parameter of the solid.
    pub parameter: [f64; 3],
    /// The determinant there by the parameters of the solid, divided by the mean.
    pub determinant: f64,
}

impl Certificate {
    /// Whether the determinant is positive on the whole closed cube.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.certified == self.spans
    }
}

/// Verdict on a part of a span, with a lower bound.
enum Verdict {
    Positive(f64),
    Refuted([f64; 3], f64),
    Open(f64),
}

/// Returns where the determinant of the first derivatives is proved positive.
///
/// Bernstein coefficients bound it from below; where that does not suffice the span is halved in all
/// directions. Costs about 50,000 multiplications for each span.
#[must_use]
pub fn certify(spline: &TrivariateSpline, options: &Options) -> Certificate {
    let n = spline.spans();
    let count = n.pow(3);
    let span = |at: usize| [at % n, at / n % n, at / (n * n)];
    let verdicts = judge_all(spline, &(0..count).collect::<Vec<_>>(), options);
    let volume: f64 = verdicts.iter().map(|(volume, _)| volume).sum();
    let scale = if volume == 0.0 {
        f64::INFINITY
    } else {
        count as f64 / volume.abs()
    };
    let mut certificate = Certificate {
        spans: count,
        certified: 0,
        refuted: Vec::new(),
        undecided: Vec::new(),
        bound: f64::INFINITY,
        volume,
    };
    for (at, (_, verdict)) in verdicts.iter().enumerate() {
        let bound = match verdict {
            Verdict::Positive(bound) => {
                certificate.certified += 1;
                bound * scale
            }
            Verdict::Open(bound) => {
                certificate.undecided.push(span(at));
                (bound * scale).min(0.0)
            }
            &Verdict::Refuted(local, value) => {
                let span = span(at);
                let determinant = value * scale;
                certificate.refuted.push(Refuted {
                    span,
                    local,
                    parameter: std::array::from_fn(|d| (span[d] as f64 + local[d]) / n as f64),
                    determinant,
                });
                determinant.min(0.0)
            }
        };
        certificate.bound = certificate.bound.min(bound);
    }
    if volume == 0.0 {
        certificate.bound = f64::NEG_INFINITY;
    }
    certificate
}

/// Those of some spans, by their numbers, that are not certified.
pub(crate) fn uncertified(
    spline: &TrivariateSpline,
    spans: &[usize],
    options: &Options,
) -> Vec<usize> {
    let verdicts = judge_all(spline, spans, options);
    let open = spans
        .iter()
        .zip(&verdicts)
        .filter(|(_, (_, verdict))| !matches!(verdict, Verdict::Positive(_)));
    open.map(|(&span, _)| span).collect()
}

/// Volumes of spans and the verdicts on them.
fn judge_all(spline: &TrivariateSpline, spans: &[usize], options: &Options) -> Vec<(f64, Verdict)> {
    let n = spline.spans();
    let groups: Vec<Vec<(f64, Verdict)>> = spans
        .par_chunks(LANES)
        .map(|group| {
            let block = |l: usize| {
                let at = group[l.min(group.len() - 1)];
                spline.block([at % n, at / n % n, at / (n * n)])
            };
            let determinants = Determinants::build(&std::array::from_fn(block));
            (0..group.len())
                .map(|l| judge(&determinants, l, options.depth))
                .collect()
        })
        .collect();
    groups.into_iter().flatten().collect()
}

/// Volume of a span and the verdict on it.
fn judge(determinants: &Determinants, lane: usize, depth: u32) -> (f64, Verdict) {
    let all = determinants.coefficients.iter();
    let coefficients: Vec<f64> = all.map(|lanes| lanes[lane]).collect();
    let volume = coefficients.iter().sum::<f64>() / COEFFICIENTS as f64;
    if determinants.flat[lane] {
        return (volume, Verdict::Refuted([0.0; 3], 0.0));
    }
    let part = Part {
        coefficients,
        error: determinants.error[lane],
        low: [0.0; 3],
        width: 1.0,
    };
    (volume, part.judge(depth))
}

/// A part of a span: coefficients that are off by at most `error`.
struct Part {
    coefficients: Vec<f64>,
    error: f64,
    low: [f64; 3],
    width: f64,
}

impl Part {
    fn least(&self) -> f64 {
        let least = self
            .coefficients
            .iter()
            .copied()
            .fold(f64::INFINITY, f64::min);
        // Not a number is no bound.
        if least.is_finite() {
            least - self.error
        } else {
            f64::NEG_INFINITY
        }
    }

    fn judge(self, depth: u32) -> Verdict {
        let least = self.least();
        if least > 0.0 {
            return Verdict::Positive(least);
        }
        // Coefficients of corners are values.
        for corner in 0..8 {
            let [i, j, k] = [corner & 1, corner >> 1 & 1, corner >> 2];
            let value = self.coefficients[8 * (i + 9 * (j + 9 * k))];
            if value + self.error <= 0.0 {
                let ends = [i, j, k].map(|end| end as f64 * self.width);
                return Verdict::Refuted(std::array::from_fn(|d| self.low[d] + ends[d]), value);
            }
        }
        if depth == 0 || !self.error.is_finite() {
            return Verdict::Open(least);
        }
        let mut parts = self.halved();
        parts.sort_by(|a, b| a.least().total_cmp(&b.least()));
        let (mut bound, mut open) = (f64::INFINITY, false);
        for part in parts {
            match part.judge(depth - 1) {
                Verdict::Positive(least) => bound = bound.min(least),
                Verdict::Open(least) => {
                    bound = bound.min(least);
                    open = true;
                }
                refuted @ Verdict::Refuted(..) => return refuted,
            }
        }
        if open {
            Verdict::Open(bound)
        } else {
            Verdict::Positive(bound)
        }
    }

    /// The eight halves in all directions.
    fn halved(self) -> Vec<Self> {
        let largest = self
            .coefficients
            .iter()
            .fold(0.0_f64, |m, c| m.max(c.abs()));
        let error = self.error + HALVING * largest;
        let width = 0.5 * self.width;
        let mut parts = vec![(self.low, self.coefficients)];
        for axis in 0..3 {
            let mut halves = Vec::with_capacity(2 * parts.len());
            for (low, mut lower) in parts {
                let upper = bernstein::halve(Axis::of(&[9; 3], axis, 1), &mut lower);
                let mut high = low;
                high[axis] += width;
                halves.extend([(low, lower), (high, upper)]);
            }
            parts = halves;
        }
        let part = |(low, coefficients)| Self {
            coefficients,
            error,
            low,
            width,
        };
        parts.into_iter().map(part).collect()
    }
}
