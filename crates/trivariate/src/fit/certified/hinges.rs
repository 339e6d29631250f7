//! Hinges of sampled elements and of Bernstein coefficients.

use std::ops::Range;

use rayon::prelude::*;

use super::elements::Elements;
use crate::fit::least_squares::to_spline;
use crate::options::Certified as Options;
use crate::validity::{COEFFICIENTS, Determinants, LANES, uncertified};
use msplines_common::Point3;

/// Beyond this many times its scale a hinge goes on straight, so that an element far inside out does
/// not outweigh all others.
const STRAIGHT: f64 = 3.0;

/// Least size of a span, against the mean.
const LEAST_SIZE: f64 = 1e-6;

/// Cells and spans are watched whose elements and coefficients are below this many margins: what is not
/// watched folds unseen until the next look.
const WATCHED: f64 = 12.0;

/// By how much a weight may grow in all: descents only creep beyond.
pub(super) const MOST_GROWN: f64 = 1e4;

/// How far around a bad cell or span weights grow.
const AROUND: usize = 1;

/// The squared hinge `(1 - v / δ)²` below `δ`, straight further down, with its slope.
pub(super) fn hinge(v: f64, delta: f64) -> (f64, f64) {
    let t = 1.0 - v / delta;
    if t <= 0.0 {
        (0.0, 0.0)
    } else if t <= STRAIGHT {
        (t * t, -2.0 * t / delta)
    } else {
        (
            2.0 * STRAIGHT * t - STRAIGHT * STRAIGHT,
            -2.0 * STRAIGHT / delta,
        )
    }
}

/// Spans, and cells of each sampling.
#[derive(Clone, Debug)]
pub(super) struct Parts {
    pub(super) spans: Vec<u32>,
    pub(super) cells: Vec<Vec<u32>>,
}

impl Parts {
    pub(super) fn is_empty(&self) -> bool {
        self.len() == 0
    }

    pub(super) fn len(&self) -> usize {
        self.spans.len() + self.cells.iter().map(Vec::len).sum::<usize>()
    }
}

/// A span that is watched.
#[derive(Clone, Copy, Debug)]
struct Span {
    at: u32,
    /// The determinant that it would have if its edges had right angles.
    size: f64,
    weight: f64,
}

/// Hinges of the cells of some samplings and of the spans, where they are watched.
pub(super) struct Hinges {
    spans: usize,
    volume: f64,
    delta: f64,
    samplings: Vec<Elements>,
    /// The weight of each span, and the most it can become.
    weights: Vec<f64>,
    most_weight: f64,
    watched: Vec<Span>,
}

impl Hinges {
    /// Hinges of weights that are those of the options times `unit`.
    pub(super) fn build(spans: usize, volume: f64, options: &Options, unit: f64) -> Self {
        let samplings = options.samplings.iter();
        let build = |&cells| Elements::build(spans, cells, unit * options.element_weight);
        Self {
            spans,
            volume,
            delta: options.margin,
            samplings: samplings.map(build).collect(),
            weights: vec![unit * options.coefficient_weight; spans.pow(3)],
            most_weight: MOST_GROWN * unit * options.coefficient_weight,
            watched: Vec::new(),
        }
    }

    /// All spans and cells.
    pub(super) fn all(&self) -> Parts {
        Parts {
            spans: (0..self.spans.pow(3) as u32).collect(),
            cells: self.samplings.iter().map(Elements::all).collect(),
        }
    }

    /// Spans and cells that depend on a marked control point.
    pub(super) fn touching(&self, marked: &[bool]) -> Parts {
        let Parts { mut spans, cells } = self.all();
        let touched = |support: [Range<usize>; 3]| {
            lattice_places(self.spans + 3, support).any(|at| marked[at])
        };
        spans.retain(|&span| touched(self.support(span)));
        let near = |(elements, mut cells): (&Elements, Vec<u32>)| {
            cells.retain(|&cell| touched(elements.support(cell)));
            cells
        };
        let cells = self.samplings.iter().zip(cells).map(near).collect();
        Parts { spans, cells }
    }

    /// The control points that some spans and cells depend on, marked.
    pub(super) fn marked(&self, parts: &Parts) -> Vec<bool> {
        let mut marked = vec![false; (self.spans + 3).pow(3)];
        let spans = parts.spans.iter().map(|&span| self.support(span));
        let samplings = self.samplings.iter().zip(&parts.cells);
        let cells = samplings
            .flat_map(|(elements, cells)| cells.iter().map(|&cell| elements.support(cell)));
        for support in spans.chain(cells) {
            lattice_places(self.spans + 3, support).for_each(|at| marked[at] = true);
        }
        marked
    }

    fn support(&self, span: u32) -> [Range<usize>; 3] {
        self.span(span).map(|i| i..i + 4)
    }

    fn span(&self, at: u32) -> [usize; 3] {
        let (at, n) = (at as usize, self.spans);
        [at % n, at / n % n, at / (n * n)]
    }

    /// Looks among some parts for what is to be watched: spans with a Bernstein coefficient and cells
    /// with an element below a few margins.
    pub(super) fn watch(&mut self, x: &[f64], among: &Parts) {
        let least = WATCHED * self.delta;
        for (elements, among) in self.samplings.iter_mut().zip(&among.cells) {
            elements.watch(x, among, self.volume, least);
        }
        let groups: Vec<Vec<Span>> = among
            .spans
            .par_chunks(LANES)
            .map(|group| {
                let determinants = self.determinants(x, |l| group.get(l).or(group.last()));
                let low = |(l, &at): (usize, &u32)| {
                    let size = self.size(x, at);
                    let low = |c: &[f64; LANES]| c[l] < least * size;
                    let weight = self.weights[at as usize];
                    let any = determinants.coefficients.iter().any(low);
                    any.then_some(Span { at, size, weight })
                };
                group.iter().enumerate().filter_map(low).collect()
            })
            .collect();
        self.watched = groups.concat();
    }

    /// What is watched and not certified or degenerate.
    pub(super) fn bad(&self, x: &[f64], options: &Options) -> Parts {
        let spline = to_spline(self.spans, x, [0.0; 3]);
        let watched: Vec<usize> = self.watched.iter().map(|span| span.at as usize).collect();
        let spans = uncertified(&spline, &watched, &options.certificate);
        Parts {
            spans: spans.into_iter().map(|span| span as u32).collect(),
            cells: self.samplings.iter().map(|cells| cells.bad(x)).collect(),
        }
    }

    /// Multiplies the weights of some parts and those around them.
    pub(super) fn reinforce(&mut self, parts: &Parts, factor: f64) {
        let most = self.most_weight;
        reinforce(&mut self.weights, most, self.spans, &parts.spans, factor);
        for (elements, cells) in self.samplings.iter_mut().zip(&parts.cells) {
            elements.reinforce(cells, factor);
        }
    }

    /// The sum of all hinges watched, whose gradient by the control points is added.
    pub(super) fn add(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let samplings = self.samplings.iter();
        let elements: f64 = samplings.map(|e| e.add(x, self.delta, gradient)).sum();
        elements + self.add_coefficients(x, gradient)
    }

    fn add_coefficients(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let groups: Vec<_> = self
            .watched
            .par_chunks(LANES)
            .map(|group| {
                let span = |l: usize| group.get(l).or(group.last()).map(|span| &span.at);
                let determinants = self.determinants(x, span);
                let mut by_coefficient = vec![[0.0; LANES]; COEFFICIENTS];
                let (mut sum, mut any) = (0.0, false);
                for (slopes, values) in by_coefficient.iter_mut().zip(&determinants.coefficients) {
                    for (l, span) in group.iter().enumerate() {
                        let (value, slope) = hinge(values[l] / span.size, self.delta);
                        sum += span.weight * value;
                        any |= slope != 0.0;
                        slopes[l] = span.weight * slope / span.size;
                    }
                }
                (sum, any.then(|| determinants.gradient(&by_coefficient)))
            })
            .collect();
        let size = self.spans + 3;
        let mut total = 0.0;
        for (group, (sum, gradients)) in self.watched.chunks(LANES).zip(groups) {
            total += sum;
            let Some(gradients) = gradients else { continue };
            for (l, span) in group.iter().enumerate() {
                let [i, j, k] = self.span(span.at);
                for (jk, line) in gradients.iter().enumerate() {
                    let start = i + size * (j + jk % 4 + size * (k + jk / 4));
                    for (p, components) in line.iter().enumerate() {
                        for (d, lanes) in components.iter().enumerate() {
                            gradient[d * size.pow(3) + start + p] += lanes[l];
                        }
                    }
                }
            }
        }
        total
    }

    /// The determinant of a span if its derivatives kept their lengths and had right angles, at most
    /// the mean.
    fn size(&self, x: &[f64], at: u32) -> f64 {
        let block = self.block(x, at);
        let point = |[i, j, k]: [usize; 3]| block[j + 4 * k][i];
        let squares = [0, 1, 2].map(|axis| {
            let mut sum = 0.0;
            for place in 0..64 {
                let from = [place % 4, place / 4 % 4, place / 16];
                let mut to = from;
                to[axis] += 1;
                if to[axis] < 4 {
                    sum += (point(to) - point(from)).norm_squared();
                }
            }
            sum / 48.0
        });
        let mean = self.volume / (self.spans as f64).powi(3);
        squares
            .iter()
            .product::<f64>()
            .sqrt()
            .clamp(LEAST_SIZE * mean, mean)
    }

    fn determinants<'a>(&self, x: &[f64], span: impl Fn(usize) -> Option<&'a u32>) -> Determinants {
        let block = |l| self.block(x, span(l).copied().unwrap_or(0));
        Determinants::build(&std::array::from_fn(block))
    }

    /// Control points of a span, in lines of the first index.
    fn block(&self, x: &[f64], at: u32) -> [[Point3<f64>; 4]; 16] {
        let ([i, j, k], size) = (self.span(at), self.spans + 3);
        let lattice = size.pow(3);
        std::array::from_fn(|line| {
            let start = i + size * (j + line % 4 + size * (k + line / 4));
            std::array::from_fn(|p| {
                let [x, y, z] = [0, 1, 2].map(|d| x[d * lattice + start + p]);
                Point3::new(x, y, z)
            })
        })
    }
}

/// Parts of a lattice in a box.
fn lattice_places(size: usize, [x, y, z]: [Range<usize>; 3]) -> impl Iterator<Item = usize> {
    z.flat_map(move |k| {
        let x = x.clone();
        y.clone()
            .flat_map(move |j| x.clone().map(move |i| i + size * (j + size * k)))
    })
}

/// Multiplies the weights of some cells and of those around them, each once, up to a most.
pub(super) fn reinforce(weights: &mut [f64], most: f64, cells: usize, which: &[u32], factor: f64) {
    let around = |i: usize| i.saturating_sub(AROUND)..(i + AROUND + 1).min(cells);
    let near = |&at: &u32| {
        let at = at as usize;
        let [i, j, k] = [at % cells, at / cells % cells, at / (cells * cells)];
        lattice_places(cells, [i, j, k].map(around))
    };
    let mut all: Vec<usize> = which.iter().flat_map(near).collect();
    all.sort_unstable();
    all.dedup();
    for at in all {
        weights[at] = (weights[at] * factor).min(most);
    }
}
