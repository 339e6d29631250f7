//! The paper's way: pursuits on the curves alone.
//!
//! Every chart first takes the observations on its curves for itself, then the charts take turns with
//! the residual of the blended surface, as long as it falls. Nothing tells what lies between the
//! curves: at vertices of another valence than four, high powers cancel along them and explode
//! between. It is here to be compared with.
//!
//! # Reference
//! [Wang2016] §4.3, Alg. 1.

use std::collections::BTreeMap;

use msplines_common::mesh::polygon::PolygonTopology;
use nalgebra::Vector3;
use rayon::prelude::*;

use super::nodes::Nodes;
use super::system::sample_nodes;
use crate::dictionary::DictionaryKind;
use crate::domain::{Domain, Star};
use crate::fit::charts::{COMPONENTS, Designs, Function};
use crate::fit::design::{Blending, Design};
use crate::options::Components;
use crate::pursuit::{Problem, Selection, Workspace, pursue};

/// Most turns of all charts.
const MOST_SWEEPS: u32 = 10;

/// Squared length of an atom on the curves, of that on the whole chart, that is rounding.
const VANISHING: f64 = 1e-20;

/// How charts are pursued.
#[derive(Clone, Copy)]
pub(super) struct Pursuit {
    pub dictionary: DictionaryKind,
    pub degree: u32,
    pub sparsity: u32,
    pub selection: Selection,
    pub components: Components,
}

/// The observations of a chart on curves.
struct Observed {
    /// Nodes on curves, by row of the matrix.
    nodes: Vec<u32>,
    /// Atoms at these nodes, row after row.
    rows: Vec<f64>,
    gram: Vec<f64>,
    allowed: Vec<bool>,
}

impl Observed {
    fn new(design: &Design, nodes: &[u32], all: &Nodes, may_crease: bool) -> Self {
        let on_curve = |s: &usize| all.targets[nodes[*s] as usize].is_some();
        let samples: Vec<usize> = (0..nodes.len()).filter(on_curve).collect();
        let atoms = design.atoms;
        let row = |&s: &usize| design.rows[s * atoms..(s + 1) * atoms].iter().copied();
        let rows: Vec<f64> = samples.iter().flat_map(row).collect();
        let mut gram = vec![0.0; atoms * atoms];
        for row in rows.chunks_exact(atoms) {
            for (x, line) in row.iter().zip(gram.chunks_exact_mut(atoms)) {
                line.iter_mut().zip(row).for_each(|(g, y)| *g += x * y);
            }
        }
        // An atom that vanishes on the curves but for rounding would get a coefficient without bound.
        let seen = |atom: usize| {
            let [here, whole] = [&gram, &design.gram].map(|g| g[atom * (atoms + 1)]);
            here > VANISHING * whole
        };
        let allowed = |atom: usize| (may_crease || design.smooth[atom]) && seen(atom);
        Self {
            nodes: samples.iter().map(|&s| nodes[s]).collect(),
            allowed: (0..atoms).map(allowed).collect(),
            rows,
            gram,
        }
    }

    fn pursued(&self, data: &[Vector3<f64>], how: Pursuit, workspace: &mut Workspace) -> Function {
        let atoms = self.allowed.len();
        let mut alpha = vec![0.0; COMPONENTS * atoms];
        for (row, value) in self.rows.chunks_exact(atoms).zip(data) {
            for (alpha, t) in alpha.chunks_exact_mut(atoms).zip(value.iter()) {
                alpha.iter_mut().zip(row).for_each(|(a, x)| *a += t * x);
            }
        }
        let groups = match how.components {
            Components::Joint => 1,
            Components::Each => COMPONENTS,
        };
        let together = COMPONENTS / groups;
        let mut terms: BTreeMap<u16, [f64; COMPONENTS]> = BTreeMap::new();
        for (group, alpha) in alpha.chunks_exact(together * atoms).enumerate() {
            let problem = Problem {
                gram: &self.gram,
                components: together,
                alpha,
                allowed: &self.allowed,
            };
            let found = pursue(problem, how.selection, how.sparsity as usize, workspace);
            let found = found
                .support
                .iter()
                .zip(found.coefficients.chunks_exact(together));
            for (&atom, coefficients) in found {
                let term = terms.entry(atom).or_default();
                term[group * together..(group + 1) * together].copy_from_slice(coefficients);
            }
        }
        Function {
            support: terms.keys().copied().collect(),
            coefficients: terms.into_values().flatten().collect(),
        }
    }

    /// Adds a multiple of a function at the nodes.
    fn add(&self, function: &Function, factor: f64, values: &mut [Vector3<f64>]) {
        let atoms = self.allowed.len();
        for (row, &node) in self.rows.chunks_exact(atoms).zip(&self.nodes) {
            let terms = function.coefficients.chunks_exact(COMPONENTS);
            for (&atom, c) in function.support.iter().zip(terms) {
                let x = factor * row[usize::from(atom)];
                values[node as usize] += Vector3::new(x * c[0], x * c[1], x * c[2]);
            }
        }
    }
}

/// Returns the functions of all charts.
pub(super) fn chase(
    topology: &PolygonTopology,
    domain: &Domain,
    nodes: &Nodes,
    may_crease: &[bool],
    how: Pursuit,
) -> Vec<Function> {
    let observed = |blending: Blending| -> Vec<Observed> {
        let side = nodes.cells + 1;
        let mut designs = Designs::new(how.dictionary, Some(how.degree), side, blending);
        let of_chart = |(v, star): (usize, &Star)| {
            let design = designs.of(*star);
            let ids = sample_nodes(topology, nodes, v as u32, &design.samples);
            Observed::new(&design, &ids, nodes, may_crease[v])
        };
        domain.stars().iter().enumerate().map(of_chart).collect()
    };
    let targets: Vec<Vector3<f64>> = nodes
        .targets
        .iter()
        .map(|t| t.unwrap_or_default())
        .collect();
    let alone = observed(Blending::Alone);
    let first = |workspace: &mut Workspace, chart: &Observed| {
        let data: Vec<_> = chart.nodes.iter().map(|&n| targets[n as usize]).collect();
        chart.pursued(&data, how, workspace)
    };
    let mut functions: Vec<Function> = alone
        .par_iter()
        .map_init(Workspace::default, first)
        .collect();
    let blended = observed(Blending::Weighted);
    let mut rest = targets;
    for (chart, function) in blended.iter().zip(&functions) {
        chart.add(function, -1.0, &mut rest);
    }
    let energy = |rest: &[Vector3<f64>]| -> f64 { rest.iter().map(Vector3::norm_squared).sum() };
    let mut workspace = Workspace::default();
    for _ in 0..MOST_SWEEPS {
        let before = (functions.clone(), energy(&rest));
        for (chart, function) in blended.iter().zip(&mut functions) {
            chart.add(function, 1.0, &mut rest);
            let data: Vec<_> = chart.nodes.iter().map(|&n| rest[n as usize]).collect();
            *function = chart.pursued(&data, how, &mut workspace);
            chart.add(function, -1.0, &mut rest);
        }
        // Algorithm 1 goes on while the error is reduced.
        if energy(&rest) >= before.1 {
            return before.0;
        }
    }
    functions
}
