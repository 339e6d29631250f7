//! Hinges of the elements of one sampling.

use std::ops::Range;

use rayon::prelude::*;

use super::hinges::{MOST_GROWN, hinge, reinforce};
use crate::measure::{Places, determinant, is_degenerate};
use crate::spline::grid_rows;

/// Cells and nodes that one task looks at.
const BATCH: usize = 512;

/// Least size of a cell, against the mean.
const LEAST_SIZE: f64 = 1e-6;

/// An element that is watched.
#[derive(Clone, Copy, Debug)]
struct Element {
    /// Its corners among the nodes.
    at: [u32; 4],
    /// The determinant that it would have if the edges of its cell had right angles.
    size: f64,
    weight: f64,
}

/// The cells of a regular grid, some of which are watched.
pub(super) struct Elements {
    spans: usize,
    cells: usize,
    places: Places,
    /// First control point and weights of every line of the grid.
    first: Vec<usize>,
    rows: Vec<[f64; 4]>,
    /// The weight of each cell, and the most it can become.
    weights: Vec<f64>,
    most_weight: f64,
    /// The cells watched.
    watched: Vec<u32>,
    /// Their elements, 24 for each cell.
    elements: Vec<Element>,
    /// The points of the grid that those have as corners.
    nodes: Vec<[u32; 3]>,
}

impl Elements {
    pub(super) fn build(spans: usize, cells: usize, weight: f64) -> Self {
        let (first, rows) = grid_rows(spans, 2 * cells);
        Self {
            spans,
            cells,
            places: Places::build(cells),
            first,
            rows,
            weights: vec![weight; cells.pow(3)],
            most_weight: MOST_GROWN * weight,
            watched: Vec::new(),
            elements: Vec::new(),
            nodes: Vec::new(),
        }
    }

    /// All cells.
    pub(super) fn all(&self) -> Vec<u32> {
        (0..self.cells.pow(3) as u32).collect()
    }

    /// The control points that a cell depends on, along each axis.
    pub(super) fn support(&self, cell: u32) -> [Range<usize>; 3] {
        let along = |i: usize| self.first[2 * i]..self.first[2 * i + 2] + 4;
        self.cell(cell).map(along)
    }

    fn cell(&self, at: u32) -> [usize; 3] {
        let (at, n) = (at as usize, self.cells);
        [at % n, at / n % n, at / (n * n)]
    }

    /// Watches those of some cells with an element whose volume is below `least` times its size.
    pub(super) fn watch(&mut self, x: &[f64], among: &[u32], volume: f64, least: f64) {
        let mean = volume / 4.0 / (self.cells as f64).powi(3);
        let elements: Vec<[usize; 4]> = Places::build(1).of_cell(1, 0).collect();
        let watched: Vec<Option<(u32, f64)>> = among
            .par_iter()
            .with_min_len(BATCH)
            .map(|&cell| {
                let start = self.cell(cell).map(|i| 2 * i as u32);
                let positions: [_; 27] = std::array::from_fn(|at| {
                    let step = [at % 3, at / 3 % 3, at / 9];
                    let node = [0, 1, 2].map(|d| start[d] + step[d] as u32);
                    self.position(&node, x)
                });
                let size = right_angled(&elements, &positions, mean);
                let low = |at: &[usize; 4]| determinant(&at.map(|i| positions[i])) < least * size;
                elements.iter().any(low).then_some((cell, size))
            })
            .collect();
        self.gather(watched.into_iter().flatten());
    }

    /// Lists the elements of some cells with their sizes, and their nodes.
    fn gather(&mut self, cells: impl Iterator<Item = (u32, f64)>) {
        let size = 2 * self.cells + 1;
        let mut known = vec![u32::MAX; size.pow(3)];
        self.watched.clear();
        self.elements.clear();
        self.nodes.clear();
        for (cell, right_angled) in cells {
            self.watched.push(cell);
            for places in self.places.of_cell(self.cells, cell as usize) {
                let at = places.map(|place| {
                    if known[place] == u32::MAX {
                        known[place] = self.nodes.len() as u32;
                        let node = [place % size, place / size % size, place / (size * size)];
                        self.nodes.push(node.map(|i| i as u32));
                    }
                    known[place]
                });
                self.elements.push(Element {
                    at,
                    size: right_angled,
                    weight: self.weights[cell as usize],
                });
            }
        }
    }

    /// Control points and weights of a node.
    fn terms(&self, node: &[u32; 3]) -> impl Iterator<Item = (usize, f64)> {
        let size = self.spans + 3;
        let [i, j, k] = node.map(|i| i as usize);
        let [rows_i, rows_j, rows_k] = [i, j, k].map(|line| self.rows[line]);
        let start = self.first[i] + size * (self.first[j] + size * self.first[k]);
        (0..16).flat_map(move |line| {
            let (q, r) = (line % 4, line / 4);
            let (from, weight) = (start + size * (q + size * r), rows_j[q] * rows_k[r]);
            (0..4).map(move |p| (from + p, rows_i[p] * weight))
        })
    }

    /// Position of a node, from lattices.
    fn position(&self, node: &[u32; 3], x: &[f64]) -> [f64; 3] {
        let lattice = x.len() / 3;
        let mut sum = [0.0; 3];
        for (at, weight) in self.terms(node) {
            for (d, sum) in sum.iter_mut().enumerate() {
                *sum += weight * x[d * lattice + at];
            }
        }
        sum
    }

    fn positions(&self, x: &[f64]) -> Vec<[f64; 3]> {
        let nodes = self.nodes.par_iter().with_min_len(BATCH);
        nodes.map(|node| self.position(node, x)).collect()
    }

    /// Sum of the hinges of the elements watched, whose gradient by the control points is added.
    pub(super) fn add(&self, x: &[f64], delta: f64, gradient: &mut [f64]) -> f64 {
        let positions = self.positions(x);
        let ratio = |e: &Element| determinant(&corners(e, &positions)) / e.size;
        let low: Vec<Vec<(&Element, f64)>> = self
            .elements
            .par_chunks(24 * BATCH)
            .map(|elements| {
                let all = elements.iter().map(|element| (element, ratio(element)));
                all.filter(|(_, ratio)| *ratio < delta).collect()
            })
            .collect();
        let mut sum = 0.0;
        let mut by_position = vec![[0.0; 3]; positions.len()];
        for (element, ratio) in low.into_iter().flatten() {
            let (value, slope) = hinge(ratio, delta);
            sum += element.weight * value;
            let factor = element.weight * slope / element.size;
            add_determinant_gradient(element, &positions, factor, &mut by_position);
        }
        let lattice = x.len() / 3;
        for (node, slope) in self.nodes.iter().zip(&by_position) {
            if *slope == [0.0; 3] {
                continue;
            }
            for (at, weight) in self.terms(node) {
                for (d, slope) in slope.iter().enumerate() {
                    gradient[d * lattice + at] += weight * slope;
                }
            }
        }
        sum
    }

    /// Cells watched that have a degenerate element.
    pub(super) fn bad(&self, x: &[f64]) -> Vec<u32> {
        let positions = self.positions(x);
        let cells = self.watched.iter().zip(self.elements.chunks_exact(24));
        let bad = |e: &Element| is_degenerate(&corners(e, &positions));
        cells
            .filter(|(_, elements)| elements.iter().any(bad))
            .map(|(&cell, _)| cell)
            .collect()
    }

    /// Multiplies the weights of cells and of those around them.
    pub(super) fn reinforce(&mut self, cells: &[u32], factor: f64) {
        reinforce(
            &mut self.weights,
            self.most_weight,
            self.cells,
            cells,
            factor,
        );
    }
}

/// The determinant of the elements of a cell if its edges kept their lengths and had right angles, at
/// most the mean.
fn right_angled(elements: &[[usize; 4]], positions: &[[f64; 3]; 27], mean: f64) -> f64 {
    // The last edges of the elements are those of the cell, each of them twice.
    let mut squares = [0.0; 3];
    for &[.., a, b] in elements {
        let axis = match a.abs_diff(b) {
            2 => 0,
            6 => 1,
            _ => 2,
        };
        let square = (0..3).map(|d| (positions[b][d] - positions[a][d]).powi(2));
        squares[axis] += square.sum::<f64>() / 8.0;
    }
    (0.25 * squares.iter().product::<f64>().sqrt()).clamp(LEAST_SIZE * mean, mean)
}

fn corners(element: &Element, positions: &[[f64; 3]]) -> [[f64; 3]; 4] {
    element.at.map(|node| positions[node as usize])
}

/// Adds `factor` times the gradient of the determinant of an element by its corners.
fn add_determinant_gradient(
    element: &Element,
    positions: &[[f64; 3]],
    factor: f64,
    gradient: &mut [[f64; 3]],
) {
    let at = element.at.map(|node| node as usize);
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
