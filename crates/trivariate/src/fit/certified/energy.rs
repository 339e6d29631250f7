//! What a certified fit minimises, over control points in one lattice for each coordinate.

use msplines_common::bspline::Axis;
use rayon::prelude::*;

use super::descent::Descent;
use crate::fit::least_squares::{System, to_spline};
use crate::measure::{Places, determinant};
use crate::spline::{TrivariateSpline, grid_rows};
use crate::validity::{COEFFICIENTS, Determinants, LANES};

/// Beyond this many times its scale a hinge goes on straight, so that an element far inside out does
/// not outweigh all others.
const STRAIGHT: f64 = 3.0;

/// The squared hinge `(1 - v / δ)²` below `δ`, straight further down, with its slope.
fn hinge(v: f64, delta: f64) -> (f64, f64) {
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

/// Cells that one task looks at.
const CELLS: usize = 512;

/// Least size of a cell or span, against the mean.
const LEAST_SIZE: f64 = 1e-6;

/// Cells and spans are watched whose elements and coefficients are below this many margins.
const WATCHED: f64 = 4.0;

/// One regular grid of elements.
pub(super) struct Grid {
    cells: usize,
    places: Places,
    /// Cells that are watched, and the determinant that their elements would have if their edges had
    /// right angles.
    active: Vec<(usize, f64)>,
    first: Vec<usize>,
    rows: Vec<[f64; 4]>,
}

impl Grid {
    pub(super) fn build(spans: usize, cells: usize) -> Self {
        let (first, rows) = grid_rows(spans, 2 * cells);
        Self {
            cells,
            places: Places::build(cells),
            active: Vec::new(),
            first,
            rows,
        }
    }

    /// Positions of the grid, from lattices.
    fn positions(&self, spans: usize, x: &[f64]) -> Vec<[f64; 3]> {
        let lattice = x.len() / 3;
        let columns: Vec<Vec<f64>> = x
            .par_chunks(lattice)
            .map(|column| {
                let (mut sizes, mut values) = ([spans + 3; 3], column.to_vec());
                for axis in (0..3).rev() {
                    values = Axis::of(&sizes, axis, 1).apply(&self.first, &self.rows, &values);
                    sizes[axis] = self.first.len();
                }
                values
            })
            .collect();
        (0..columns[0].len())
            .map(|at| [0, 1, 2].map(|d| columns[d][at]))
            .collect()
    }

    /// The transpose of [`positions`](Self::positions).
    fn pull_back(&self, spans: usize, gradient: &[[f64; 3]]) -> Vec<f64> {
        let columns: Vec<Vec<f64>> = (0..3)
            .into_par_iter()
            .map(|d| {
                let mut sizes = [self.first.len(); 3];
                let mut values: Vec<f64> = gradient.iter().map(|g| g[d]).collect();
                for axis in 0..3 {
                    sizes[axis] = spans + 3;
                    let axis = Axis::of(&sizes, axis, 1);
                    values = axis.apply_transposed(&self.first, &self.rows, &values);
                }
                values
            })
            .collect();
        columns.concat()
    }

    /// The determinant of an element of mean volume.
    fn mean(&self, volume: f64) -> f64 {
        volume / 4.0 / (self.cells as f64).powi(3)
    }

    /// The determinant of the elements of a cell if its edges kept their lengths and had right
    /// angles, at most the mean.
    fn size(&self, cell: usize, positions: &[[f64; 3]], mean: f64) -> f64 {
        let [n, row] = [self.cells, 2 * self.cells + 1];
        let corner = [cell % n, cell / n % n, cell / (n * n)].map(|i| 2 * i);
        let steps = [1, row, row * row];
        let start = corner.iter().zip(steps).map(|(i, step)| i * step).sum();
        let squares = [0, 1, 2].map(|axis| {
            let [a, b] = [steps[(axis + 1) % 3], steps[(axis + 2) % 3]].map(|step| 2 * step);
            let edges = [start, start + a, start + b, start + a + b].map(|from: usize| {
                let to = positions[from + 2 * steps[axis]];
                (0..3)
                    .map(|d| (to[d] - positions[from][d]).powi(2))
                    .sum::<f64>()
            });
            0.25 * edges.iter().sum::<f64>()
        });
        (0.25 * squares.iter().product::<f64>().sqrt()).clamp(LEAST_SIZE * mean, mean)
    }

    /// Watches the cells with an element whose volume is below `least` times its size.
    fn find_active(&mut self, spans: usize, x: &[f64], volume: f64, least: f64) {
        let (positions, mean) = (self.positions(spans, x), self.mean(volume));
        let watched = (0..self.cells.pow(3)).into_par_iter().filter_map(|cell| {
            let size = self.size(cell, &positions, mean);
            let low = |at: [usize; 4]| determinant(&at.map(|i| positions[i])) < least * size;
            let mut elements = self.places.of_cell(self.cells, cell);
            elements.any(low).then_some((cell, size))
        });
        self.active = watched.collect();
    }

    /// Sum of the hinges of the elements of watched cells, and its gradient by the positions of the
    /// grid.
    fn hinges(&self, positions: &[[f64; 3]], delta: f64) -> (f64, Vec<[f64; 3]>) {
        let active: Vec<Vec<([usize; 4], f64, f64)>> = self
            .active
            .par_chunks(CELLS)
            .map(|cells| {
                let all = cells.iter().flat_map(|&(cell, size)| {
                    let elements = self.places.of_cell(self.cells, cell);
                    elements.map(move |at| (at, size))
                });
                let ratio = |at: [usize; 4], size| determinant(&at.map(|i| positions[i])) / size;
                all.map(|(at, size)| (at, size, ratio(at, size)))
                    .filter(|(_, _, ratio)| *ratio < delta)
                    .collect()
            })
            .collect();
        let (mut sum, mut gradient) = (0.0, vec![[0.0; 3]; positions.len()]);
        for (at, size, ratio) in active.into_iter().flatten() {
            let (value, slope) = hinge(ratio, delta);
            sum += value;
            add_determinant_gradient(at, positions, slope / size, &mut gradient);
        }
        (sum, gradient)
    }
}

/// Adds `factor` times the gradient of the determinant of an element by its corners.
fn add_determinant_gradient(
    at: [usize; 4],
    positions: &[[f64; 3]],
    factor: f64,
    gradient: &mut [[f64; 3]],
) {
    let edge = |p: usize| [0, 1, 2].map(|d| positions[at[p]][d] - positions[at[0]][d]);
    let edges = [edge(1), edge(2), edge(3)];
    for p in 0..3 {
        let (a, b) = (edges[(p + 1) % 3], edges[(p + 2) % 3]);
        let normal = [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ];
        for (d, share) in normal.into_iter().enumerate() {
            gradient[at[p + 1]][d] += factor * share;
            gradient[at[0]][d] -= factor * share;
        }
    }
}

/// Weights of the hinges.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weights {
    pub(super) elements: f64,
    pub(super) coefficients: f64,
}

/// Squared distances with smoothing, over the mean square size, and hinges on sampled elements and on
/// Bernstein coefficients of some spans.
pub(super) struct Energy<'a> {
    pub(super) spans: usize,
    pub(super) system: &'a System,
    /// Divides the sum of squares: total weight times the squared diagonal of the solid.
    pub(super) scale: f64,
    /// Sum of squares of the samples, so that the energy of a perfect fit is 0.
    pub(super) constant: f64,
    pub(super) volume: f64,
    pub(super) delta: f64,
    pub(super) grids: Vec<Grid>,
    /// Spans that are watched, and the determinant that they would have if their edges had right
    /// angles.
    pub(super) active: Vec<(usize, f64)>,
    pub(super) weights: Weights,
}

impl Energy<'_> {
    /// Squared distances and smoothing only.
    pub(super) fn data(&self, x: &[f64]) -> f64 {
        self.squares(x, |_| {})
    }

    /// Squared distances and smoothing; `each` is told the gradient, number after number.
    fn squares(&self, x: &[f64], mut each: impl FnMut(f64)) -> f64 {
        let equations = &self.system.equations;
        let product = equations.matrix.apply(x);
        let mut value = self.constant;
        for ((&x, &ax), &b) in x.iter().zip(&product).zip(&equations.right) {
            value += x * (ax - 2.0 * b);
            each(2.0 * (ax - b) / self.scale);
        }
        value / self.scale
    }

    /// Looks for what is to be watched: spans with a Bernstein coefficient and cells with an element
    /// below a few margins.
    pub(super) fn find_active(&mut self, x: &[f64]) {
        for grid in &mut self.grids {
            grid.find_active(self.spans, x, self.volume, WATCHED * self.delta);
        }
        let spline = to_spline(self.spans, x, [0.0; 3]);
        let all: Vec<usize> = (0..self.spans.pow(3)).collect();
        let least = WATCHED * self.delta;
        let groups: Vec<Vec<(usize, f64)>> = all
            .par_chunks(LANES)
            .map(|group| {
                let determinants = self.determinants(&spline, group);
                let sizes: Vec<f64> = group.iter().map(|&at| self.size(&spline, at)).collect();
                let low = |l: &usize| {
                    let least = least * sizes[*l];
                    determinants.coefficients.iter().any(|c| c[*l] < least)
                };
                let watched = (0..group.len()).filter(low);
                watched.map(|l| (group[l], sizes[l])).collect()
            })
            .collect();
        self.active = groups.concat();
    }

    /// The determinant of a span if its derivatives kept their lengths and had right angles, at most
    /// the mean.
    fn size(&self, spline: &TrivariateSpline, at: usize) -> f64 {
        let block = spline.block(self.span(at));
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
        let mean = self.mean_determinant();
        squares
            .iter()
            .product::<f64>()
            .sqrt()
            .clamp(LEAST_SIZE * mean, mean)
    }

    /// The mean determinant by the coordinates of a span.
    fn mean_determinant(&self) -> f64 {
        self.volume / (self.spans as f64).powi(3)
    }

    fn determinants(&self, spline: &TrivariateSpline, group: &[usize]) -> Determinants {
        let blocks: [_; LANES] =
            std::array::from_fn(|l| spline.block(self.span(group[l.min(group.len() - 1)])));
        Determinants::build(&blocks)
    }

    fn span(&self, at: usize) -> [usize; 3] {
        [
            at % self.spans,
            at / self.spans % self.spans,
            at / self.spans.pow(2),
        ]
    }

    /// Hinges of the active spans, added to the gradient by the control points.
    fn add_coefficients(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let spline = to_spline(self.spans, x, [0.0; 3]);
        let groups: Vec<_> = self
            .active
            .par_chunks(LANES)
            .map(|group| {
                let spans: Vec<usize> = group.iter().map(|(at, _)| *at).collect();
                let determinants = self.determinants(&spline, &spans);
                let mut by_coefficient = vec![[0.0; LANES]; COEFFICIENTS];
                let (mut sum, mut any) = (0.0, false);
                for (slopes, values) in by_coefficient.iter_mut().zip(&determinants.coefficients) {
                    for (l, (_, size)) in group.iter().enumerate() {
                        let (value, slope) = hinge(values[l] / size, self.delta);
                        sum += value;
                        any |= slope != 0.0;
                        slopes[l] = self.weights.coefficients * slope / size;
                    }
                }
                (sum, any.then(|| determinants.gradient(&by_coefficient)))
            })
            .collect();
        let size = self.spans + 3;
        let mut total = 0.0;
        for (group, (sum, gradients)) in self.active.chunks(LANES).zip(groups) {
            total += sum;
            let Some(gradients) = gradients else { continue };
            for (l, &(at, _)) in group.iter().enumerate() {
                let [i, j, k] = self.span(at);
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
        self.weights.coefficients * total
    }
}

impl Descent for Energy<'_> {
    fn evaluate(&self, x: &[f64]) -> (f64, Vec<f64>) {
        let mut gradient = Vec::with_capacity(x.len());
        let mut value = self.squares(x, |g| gradient.push(g));
        for grid in &self.grids {
            let positions = grid.positions(self.spans, x);
            let (sum, by_position) = grid.hinges(&positions, self.delta);
            if sum > 0.0 {
                value += self.weights.elements * sum;
                let pulled = grid.pull_back(self.spans, &by_position);
                for (g, p) in gradient.iter_mut().zip(pulled) {
                    *g += self.weights.elements * p;
                }
            }
        }
        value += self.add_coefficients(x, &mut gradient);
        (value, gradient)
    }

    fn precondition(&self, gradient: &[f64]) -> Vec<f64> {
        let mut step = self.system.inverse.apply(gradient);
        step.iter_mut().for_each(|s| *s *= 0.5 * self.scale);
        step
    }
}
