//! Least squares over all charts at once.
//!
//! # Notation
//! `E` has a row for each node and a column for each atom of each chart: the blended surface at the
//! nodes is `E c`. A row of the system is a combination of rows of `E`; it touches the charts of one
//! face, or of a few. The normal equations consist of a dense block for each pair of charts that a row
//! has in common.

use std::collections::BTreeMap;
use std::sync::Arc;

use msplines_common::linalg::{Cholesky, Mat, Ordering, Symbolic, SymmetricMatrix};
use msplines_common::mesh::polygon::PolygonTopology;
use nalgebra::Vector3;
use rayon::prelude::*;

use super::error::NetworkError;
use super::nodes::Nodes;
use crate::dictionary::DictionaryKind;
use crate::domain::{Domain, Star, face_coordinates};
use crate::fit::charts::{COMPONENTS, Designs};
use crate::fit::design::{Blending, Design, Sample};

/// What keeps the coefficients of atoms that no node tells apart small.
const TIKHONOV: f64 = 1e-8;

/// Weight of a kink across a smooth edge. The kinks left in the networks of our tests are below 0.01
/// degrees.
const NO_KINK: f64 = 1e3;

/// Which atoms a chart may use beside the smooth ones.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gate {
    /// Shape functions.
    pub shapes: bool,
    /// Cones.
    pub cones: bool,
}

/// A chart and the nodes that it sees.
pub(super) struct FitChart {
    pub design: Arc<Design>,
    /// The node of each sample of the design.
    pub nodes: Vec<u32>,
    /// The atoms that it may use.
    pub support: Vec<u16>,
}

impl FitChart {
    /// Returns the charts of a domain.
    pub(super) fn all(
        topology: &PolygonTopology,
        domain: &Domain,
        nodes: &Nodes,
        degree: u32,
        gates: &[Gate],
    ) -> Vec<Self> {
        let kind = DictionaryKind::Cones;
        let mut designs = Designs::new(kind, Some(degree), nodes.cells + 1, Blending::Weighted);
        let stars = domain.stars().iter().zip(gates).enumerate();
        let chart = |(v, (star, gate)): (usize, (&Star, &Gate))| {
            let design = designs.of(*star);
            let samples = design.samples.len();
            // On an open star the shape functions of missing sectors vanish.
            let counts = |&atom: &usize| {
                let column = &design.columns[atom * samples..(atom + 1) * samples];
                match (design.smooth[atom], design.cones[atom]) {
                    (true, _) => true,
                    (_, true) => gate.cones,
                    _ => gate.shapes && column.iter().any(|x| *x != 0.0),
                }
            };
            Self {
                nodes: sample_nodes(topology, nodes, v as u32, &design.samples),
                support: (0..design.atoms).filter(counts).map(|a| a as u16).collect(),
                design,
            }
        };
        stars.map(chart).collect()
    }

    /// Returns the combinations of unknowns that vanish if the chart has no kink along an edge: shape
    /// functions are bilinear, and so is the sum of their slopes away from the edge on both sides.
    fn kinks(&self, star: Star, edge: u32) -> Option<[Vec<f64>; 2]> {
        let shape = |&atom: &usize| !self.design.smooth[atom] && !self.design.cones[atom];
        let first = (0..self.design.atoms).find(shape)?;
        let k = star.valence as usize;
        let edge = edge as usize;
        let (next, before) = ((edge + 1) % k, (edge + k - 1) % k);
        let combination = |terms: [(usize, f64); 3]| {
            let mut row = vec![0.0; self.support.len()];
            for (node, factor) in terms {
                let at = self.support.binary_search(&((first + node) as u16));
                if let Ok(at) = at {
                    row[at] += factor;
                }
            }
            row
        };
        Some([
            combination([(1 + next, 1.0), (1 + before, 1.0), (0, -2.0)]),
            combination([(1 + k + edge, 1.0), (1 + k + before, 1.0), (1 + edge, -2.0)]),
        ])
    }

    /// Adds a multiple of the row of a sample.
    fn add_row(&self, sample: usize, factor: f64, out: &mut [f64]) {
        let atoms = self.design.atoms;
        let row = &self.design.rows[sample * atoms..(sample + 1) * atoms];
        for (out, &atom) in out.iter_mut().zip(&self.support) {
            *out += factor * row[usize::from(atom)];
        }
    }
}

/// Returns the node of each sample of a chart.
pub(super) fn sample_nodes(
    topology: &PolygonTopology,
    nodes: &Nodes,
    vertex: u32,
    samples: &[Sample],
) -> Vec<u32> {
    let corners: Vec<u32> = topology.outgoing(vertex).collect();
    let cells = f64::from(nodes.cells);
    let node = |sample: &Sample| {
        let h = corners[sample.sector as usize];
        let at = sample.grid.map(|i| f64::from(i) / cells);
        let [column, row] = face_coordinates(h % 4, at).map(|c| (c * cells).round() as usize);
        nodes.grids[h as usize / 4][row * (nodes.cells as usize + 1) + column]
    };
    samples.iter().map(node).collect()
}

/// A row of the system: its weight, what it asks for, and its coefficients by chart.
struct Row {
    weight: f64,
    target: Vector3<f64>,
    parts: Vec<(u32, Vec<f64>)>,
}

/// The rows of a least-squares problem.
pub(super) struct System<'a> {
    charts: &'a [FitChart],
    /// The charts and samples at every node.
    at: Vec<Vec<(u32, u32)>>,
    rows: Vec<Row>,
}

/// One dense block of the normal equations, by the chart of its columns.
type Blocks = BTreeMap<u32, Vec<f64>>;

impl<'a> System<'a> {
    pub(super) fn new(charts: &'a [FitChart], nodes: &Nodes) -> Self {
        let mut at = vec![Vec::new(); nodes.count()];
        for (c, chart) in charts.iter().enumerate() {
            for (sample, &node) in chart.nodes.iter().enumerate() {
                at[node as usize].push((c as u32, sample as u32));
            }
        }
        Self {
            charts,
            at,
            rows: Vec::new(),
        }
    }

    /// Returns the number of unknowns of one coordinate.
    pub(super) fn unknowns(&self) -> usize {
        self.charts.iter().map(|chart| chart.support.len()).sum()
    }

    /// Adds rows, each a weight, a target, and nodes with their factors.
    pub(super) fn add<I>(&mut self, rows: Vec<(f64, Vector3<f64>, I)>)
    where
        I: IntoIterator<Item = (usize, f64)> + Send,
    {
        let row = |(weight, target, terms): (f64, Vector3<f64>, I)| {
            let mut parts: BTreeMap<u32, Vec<f64>> = BTreeMap::new();
            for (node, factor) in terms {
                for &(c, sample) in &self.at[node] {
                    let chart = &self.charts[c as usize];
                    let part = parts.entry(c);
                    let part = part.or_insert_with(|| vec![0.0; chart.support.len()]);
                    chart.add_row(sample as usize, factor, part);
                }
            }
            let parts = parts.into_iter().collect();
            Row {
                weight,
                target,
                parts,
            }
        };
        let rows: Vec<Row> = rows.into_par_iter().map(row).collect();
        self.rows.extend(rows);
    }

    /// Asks a chart, if it has shape functions, for no kink along an edge inside of it.
    pub(super) fn forbid_kink(&mut self, chart: u32, star: Star, edge: u32) {
        let kinks = self.charts[chart as usize].kinks(star, edge);
        let rows = kinks.into_iter().flatten().map(|part| Row {
            weight: NO_KINK,
            target: Vector3::zeros(),
            parts: vec![(chart, part)],
        });
        self.rows.extend(rows);
    }

    /// Returns the coefficients of least squares, `[atom][coordinate]` for each chart.
    ///
    /// # Errors
    /// Numbers that are not finite.
    pub(super) fn solve(&self) -> Result<Vec<Vec<f64>>, NetworkError> {
        let starts: Vec<usize> = std::iter::once(0)
            .chain(self.charts.iter().scan(0, |sum, chart| {
                *sum += chart.support.len();
                Some(*sum)
            }))
            .collect();
        let blocks = self.blocks();
        let matrix = assemble(&starts, &blocks);
        let ordering = ordering(&starts, &blocks)?;
        let factor = Cholesky::factor(Symbolic::analyze(&matrix, &ordering), &matrix)?;
        let mut right = Mat::zeros(self.unknowns(), COMPONENTS);
        for row in &self.rows {
            for (c, part) in &row.parts {
                for (i, x) in part.iter().enumerate() {
                    for side in 0..COMPONENTS {
                        right[(starts[*c as usize] + i, side)] += row.weight * x * row.target[side];
                    }
                }
            }
        }
        let mut solution = right.clone();
        factor.solve_in_place(solution.as_mut());
        // The equations square the condition of the rows; one step wins back what they lose.
        let mut rest = right - matrix.multiply(solution.as_ref());
        factor.solve_in_place(rest.as_mut());
        solution += rest;
        let of_chart = |c: usize| {
            let unknowns = starts[c]..starts[c + 1];
            let sides = unknowns.flat_map(|i| (0..COMPONENTS).map(move |side| (i, side)));
            sides.map(|at| solution[at]).collect()
        };
        Ok((0..self.charts.len()).map(of_chart).collect())
    }

    /// Returns the blocks of every chart with itself and those after it.
    fn blocks(&self) -> Vec<Blocks> {
        let mut rows_of: Vec<Vec<(u32, u32)>> = vec![Vec::new(); self.charts.len()];
        for (r, row) in self.rows.iter().enumerate() {
            for (place, (c, _)) in row.parts.iter().enumerate() {
                rows_of[*c as usize].push((r as u32, place as u32));
            }
        }
        let of_chart = |(c, rows): (usize, &Vec<(u32, u32)>)| {
            let height = self.charts[c].support.len();
            let mut blocks = Blocks::new();
            for &(r, place) in rows {
                let row = &self.rows[r as usize];
                let own = &row.parts[place as usize].1;
                for (other, part) in &row.parts[place as usize..] {
                    let block = blocks.entry(*other);
                    let block = block.or_insert_with(|| vec![0.0; height * part.len()]);
                    for (x, line) in own.iter().zip(block.chunks_exact_mut(part.len())) {
                        let factor = row.weight * x;
                        line.iter_mut()
                            .zip(part)
                            .for_each(|(b, y)| *b += factor * y);
                    }
                }
            }
            let own = blocks.entry(c as u32);
            let own = own.or_insert_with(|| vec![0.0; height * height]);
            own.iter_mut()
                .step_by(height + 1)
                .for_each(|d| *d += TIKHONOV);
            blocks
        };
        rows_of.par_iter().enumerate().map(of_chart).collect()
    }
}

fn assemble(starts: &[usize], blocks: &[Blocks]) -> SymmetricMatrix {
    let mut entries = Vec::new();
    for (c, blocks) in blocks.iter().enumerate() {
        for (&other, block) in blocks {
            let width = starts[other as usize + 1] - starts[other as usize];
            for (i, line) in block.chunks_exact(width).enumerate() {
                let column = (starts[c] + i) as u32;
                let rows = starts[other as usize] as u32..;
                // Of blocks on the diagonal the upper half is not read.
                entries.extend(rows.zip(line).map(|(row, &x)| (row, column, x)));
            }
        }
    }
    SymmetricMatrix::from_lower_triplets(starts[starts.len() - 1], &entries)
}

/// Returns an order of the unknowns that keeps those of a chart together.
fn ordering(starts: &[usize], blocks: &[Blocks]) -> Result<Ordering, NetworkError> {
    let pairs = blocks.iter().enumerate();
    let pairs =
        pairs.flat_map(|(c, blocks)| blocks.keys().map(move |&other| (other, c as u32, 1.0)));
    let pattern = SymmetricMatrix::from_lower_triplets(blocks.len(), &pairs.collect::<Vec<_>>());
    let charts = Ordering::nested_dissection(&pattern)?;
    let unknowns = charts.as_slice().iter().flat_map(|&c| {
        let [from, to] = [c, c + 1].map(|c| starts[c as usize] as u32);
        from..to
    });
    Ok(Ordering::given(unknowns.collect()))
}
