//! The charts during a fit, and the turns they take.

use msplines_common::mesh::polygon::{PolygonMesh, PolygonTopology};
use rayon::prelude::*;

use super::charts::{COMPONENTS, Chart, Designs, Function, chart_observations};
use super::design::{Blending, Design};
use crate::dictionary::DictionaryKind;
use crate::domain::Domain;
use crate::observations::Observations;
use crate::options::{Acceptance, Components, Gate, Local, Options};
use crate::pursuit::{Found, Problem, Workspace, pursue, refit};
use crate::spline::SparseManifold;

/// Charts, their functions, and what these leave of the observations.
#[derive(Clone, Debug)]
pub(crate) struct State {
    pub domain: Domain,
    pub charts: Vec<Chart>,
    /// Residual of every observation.
    pub residual: Vec<[f64; COMPONENTS]>,
}

/// Rooms of a turn, kept between charts.
#[derive(Default)]
pub(super) struct Rooms {
    pub data: Vec<f64>,
    pub alpha: Vec<f64>,
    allowed: Vec<bool>,
    workspace: Workspace,
}

impl State {
    /// Returns the charts, each with the function that fits its own observations best.
    pub(crate) fn start(
        topology: &PolygonTopology,
        domain: Domain,
        sharp: &[bool],
        observations: &Observations,
        options: &Options,
    ) -> Self {
        let (kind, degree) = dictionary(options.local);
        let side = observations.side() as u32;
        let mut blended = Designs::new(kind, degree, side, Blending::Weighted);
        let mut alone = Designs::new(kind, degree, side, Blending::Alone);
        let charts = domain.stars().iter().enumerate().map(|(vertex, &star)| {
            let (vertex, design) = (vertex as u32, blended.of(star));
            let gated = options.gate == Gate::Sharp && !sharp[vertex as usize];
            Chart {
                observations: chart_observations(topology, observations, vertex, &design.samples),
                design,
                alone: alone.of(star),
                may_crease: !gated && !options.smooth_charts.contains(&vertex),
                function: Function::default(),
                part: Vec::new(),
            }
        });
        let mut state = Self {
            charts: charts.collect(),
            domain,
            residual: observations
                .points
                .iter()
                .map(|p| p.coords.into())
                .collect(),
        };
        for chart in &mut state.charts {
            chart.renew_part();
        }
        let all: Vec<u32> = (0..state.charts.len() as u32).collect();
        state.start_charts(&all, topology, observations, options);
        state
    }

    /// Gives charts the functions that fit their own observations best, whatever the others are.
    ///
    /// # Reference
    /// [Wang2016] Eq. (7).
    pub(crate) fn start_charts(
        &mut self,
        charts: &[u32],
        topology: &PolygonTopology,
        observations: &Observations,
        options: &Options,
    ) {
        let point = |o: u32| observations.points[o as usize].coords.into();
        let found: Vec<(Function, Vec<f64>)> = charts
            .par_iter()
            .map_init(Rooms::default, |rooms, &vertex| {
                let chart = &self.charts[vertex as usize];
                let places =
                    chart_observations(topology, observations, vertex, &chart.alone.samples);
                gather(&places, point, &mut rooms.data);
                let function = best(&chart.alone, chart.may_crease, None, options, rooms);
                let mut part = vec![0.0; COMPONENTS * chart.observations.len()];
                let (support, coefficients) = (&function.support, &function.coefficients);
                chart.design.accumulate(support, coefficients, &mut part);
                (function, part)
            })
            .collect();
        for (&chart, (function, part)) in charts.iter().zip(found) {
            self.replace(chart as usize, function, part);
        }
    }

    /// Computes what every function adds to the surface.
    pub(crate) fn renew_parts(&mut self) {
        self.charts.par_iter_mut().for_each(Chart::renew_part);
    }

    /// Returns the sum of squared residuals.
    pub(crate) fn e_fit(&self) -> f64 {
        self.residual.iter().flatten().map(|r| r * r).sum()
    }

    /// Gives every chart of these sets its turn; charts of a set have no face in common.
    ///
    /// # Reference
    /// [Wang2016] Eq. (8), with the Gauss-Seidel technique.
    pub(crate) fn select(&mut self, colours: &[Vec<u32>], options: &Options) {
        for colour in colours {
            let turns: Vec<(Function, Vec<f64>)> = colour
                .par_iter()
                .map_init(Rooms::default, |rooms, &chart| {
                    self.turn(chart, options, rooms)
                })
                .collect();
            for (&chart, (function, part)) in colour.iter().zip(turns) {
                self.replace(chart as usize, function, part);
            }
        }
    }

    /// Gives all charts their turn with what the others were, and goes a fraction of the way.
    ///
    /// # Reference
    /// [Wang2016] Alg. 1.
    pub(crate) fn select_all_at_once(&mut self, damping: f64, options: &Options) {
        let turns: Vec<(Function, Vec<f64>)> = (0..self.charts.len() as u32)
            .into_par_iter()
            .map_init(Rooms::default, |rooms, chart| {
                self.turn(chart, options, rooms)
            })
            .collect();
        for (chart, (function, mut part)) in turns.into_iter().enumerate() {
            let old = &self.charts[chart];
            for (new, old) in part.iter_mut().zip(&old.part) {
                *new = damping * *new + (1.0 - damping) * old;
            }
            self.replace(chart, mixed(&old.function, &function, damping), part);
        }
    }

    /// Returns the new function of a chart, and what it adds to the surface.
    fn turn(&self, chart: u32, options: &Options, rooms: &mut Rooms) -> (Function, Vec<f64>) {
        let chart = &self.charts[chart as usize];
        let design = &chart.design;
        gather(
            &chart.observations,
            |o| self.residual[o as usize],
            &mut rooms.data,
        );
        rooms
            .data
            .iter_mut()
            .zip(&chart.part)
            .for_each(|(t, part)| *t += part);
        let old = (options.acceptance == Acceptance::Better).then_some(&chart.function);
        let function = best(design, chart.may_crease, old, options, rooms);
        let mut part = vec![0.0; rooms.data.len()];
        design.accumulate(&function.support, &function.coefficients, &mut part);
        (function, part)
    }

    fn replace(&mut self, chart: usize, function: Function, part: Vec<f64>) {
        let chart = &mut self.charts[chart];
        chart.scatter(&chart.part, 1.0, &mut self.residual);
        chart.scatter(&part, -1.0, &mut self.residual);
        chart.function = function;
        chart.part = part;
    }

    /// Returns the surface that the charts make.
    pub(crate) fn spline(&self, mesh: &PolygonMesh, options: &Options) -> SparseManifold {
        let (kind, degree) = dictionary(options.local);
        let functions = self
            .charts
            .iter()
            .map(|chart| chart.function.clone())
            .collect();
        SparseManifold::new(mesh, self.domain.clone(), kind, degree, functions)
    }

    /// Returns the shape functions of a chart and a coordinate, on average over smooth and over sharp
    /// charts.
    pub(crate) fn shape_counts(&self, sharp: &[bool]) -> [f64; 2] {
        [false, true].map(|sharp_ones| {
            let charts = self
                .charts
                .iter()
                .zip(sharp)
                .filter(|(_, s)| **s == sharp_ones);
            let (charts, shapes) = charts.fold((0, 0), |(charts, shapes), (chart, _)| {
                (
                    charts + 1,
                    shapes + chart.function.shapes(&chart.design.smooth),
                )
            });
            shapes as f64 / (COMPONENTS * charts.max(1)) as f64
        })
    }

    /// Returns all that a sweep may change, where it may have to be undone.
    pub(super) fn clone_functions(&self, options: &Options) -> Option<Self> {
        (options.acceptance == Acceptance::Always).then(|| self.clone())
    }

    pub(super) fn restore(&mut self, before: Self) {
        *self = before;
    }
}

/// Returns the dictionary of a way to find functions, and the degree of its monomials if all charts
/// have the same.
pub(crate) fn dictionary(local: Local) -> (DictionaryKind, Option<u32>) {
    match local {
        Local::Sparse { dictionary, .. } => (dictionary, Some(crate::dictionary::DEGREE)),
        Local::Polynomial { degree } => (DictionaryKind::Polynomials, degree),
        Local::Spline => (DictionaryKind::Splines, Some(0)),
    }
}

pub(super) fn gather(
    places: &[u32],
    value: impl Fn(u32) -> [f64; COMPONENTS],
    data: &mut Vec<f64>,
) {
    let n = places.len();
    data.clear();
    data.resize(COMPONENTS * n, 0.0);
    for (sample, &o) in places.iter().enumerate() {
        for (component, x) in value(o).into_iter().enumerate() {
            data[component * n + sample] = x;
        }
    }
}

/// Returns the best function for the data in `rooms`: of newly chosen atoms, or of those of `old`.
fn best(
    design: &Design,
    may_crease: bool,
    old: Option<&Function>,
    options: &Options,
    rooms: &mut Rooms,
) -> Function {
    let Rooms {
        data,
        alpha,
        allowed,
        workspace,
    } = rooms;
    design.correlations(data, alpha);
    allowed.clear();
    allowed.extend(design.smooth.iter().map(|&smooth| smooth || may_crease));
    let Local::Sparse {
        sparsity,
        selection,
        components,
        ..
    } = options.local
    else {
        let all: Vec<u16> = (0..design.atoms as u16).collect();
        let problem = Problem {
            gram: &design.gram,
            components: COMPONENTS,
            alpha,
            allowed,
        };
        return Function::of(refit(problem, &all, workspace));
    };
    let find = |alpha: &[f64], old: Option<Vec<u16>>, workspace: &mut Workspace| {
        let problem = Problem {
            gram: &design.gram,
            components: alpha.len() / design.atoms,
            alpha,
            allowed,
        };
        let new = pursue(problem, selection, sparsity as usize, workspace);
        match old {
            None => new,
            Some(support) => {
                let kept = refit(problem, &support, workspace);
                if new.explained > kept.explained {
                    new
                } else {
                    kept
                }
            }
        }
    };
    match components {
        Components::Joint => {
            let support = old.map(|old| old.support.clone());
            Function::of(find(alpha, support, workspace))
        }
        Components::Each => {
            let found = [0, 1, 2].map(|component| {
                let alpha = &alpha[component * design.atoms..(component + 1) * design.atoms];
                let support = old.map(|old| old.support_of(component));
                find(alpha, support, workspace)
            });
            Function::merged(&found)
        }
    }
}

impl Chart {
    /// Computes what the function adds to the surface.
    pub(crate) fn renew_part(&mut self) {
        self.part.clear();
        self.part.resize(COMPONENTS * self.observations.len(), 0.0);
        let function = &self.function;
        self.design
            .accumulate(&function.support, &function.coefficients, &mut self.part);
    }

    /// Adds values at the samples, times a factor, to those at the observations.
    pub(super) fn scatter(&self, values: &[f64], factor: f64, out: &mut [[f64; COMPONENTS]]) {
        let n = self.observations.len();
        for (component, values) in values.chunks_exact(n).enumerate() {
            for (&o, value) in self.observations.iter().zip(values) {
                out[o as usize][component] += factor * value;
            }
        }
    }
}

impl Function {
    /// Returns the number of coefficients of shape functions that are not zero.
    fn shapes(&self, smooth: &[bool]) -> usize {
        let atoms = self
            .support
            .iter()
            .zip(self.coefficients.chunks_exact(COMPONENTS));
        let shapes = atoms.filter(|(atom, _)| !smooth[usize::from(**atom)]);
        shapes
            .map(|(_, c)| c.iter().filter(|c| **c != 0.0).count())
            .sum()
    }

    fn of(found: Found) -> Self {
        Self {
            support: found.support,
            coefficients: found.coefficients,
        }
    }

    /// Returns the atoms that a coordinate has.
    fn support_of(&self, component: usize) -> Vec<u16> {
        let atoms = self
            .support
            .iter()
            .zip(self.coefficients.chunks_exact(COMPONENTS));
        let used = atoms.filter(|(_, c)| c[component] != 0.0);
        used.map(|(&atom, _)| atom).collect()
    }

    /// Returns the function of coordinates that were found apart.
    fn merged(found: &[Found; COMPONENTS]) -> Self {
        let mut support: Vec<u16> = found
            .iter()
            .flat_map(|f| f.support.iter().copied())
            .collect();
        support.sort_unstable();
        support.dedup();
        let mut coefficients = vec![0.0; COMPONENTS * support.len()];
        for (component, found) in found.iter().enumerate() {
            for (atom, &c) in found.support.iter().zip(&found.coefficients) {
                if let Ok(place) = support.binary_search(atom) {
                    coefficients[COMPONENTS * place + component] = c;
                }
            }
        }
        Self {
            support,
            coefficients,
        }
    }
}

/// Returns `(1 - t) one + t two`.
fn mixed(one: &Function, two: &Function, t: f64) -> Function {
    let mut support: Vec<u16> = one.support.iter().chain(&two.support).copied().collect();
    support.sort_unstable();
    support.dedup();
    let mut coefficients = vec![0.0; COMPONENTS * support.len()];
    for (function, factor) in [(one, 1.0 - t), (two, t)] {
        let terms = function
            .support
            .iter()
            .zip(function.coefficients.chunks_exact(COMPONENTS));
        for (atom, c) in terms {
            if let Ok(place) = support.binary_search(atom) {
                let slot = &mut coefficients[COMPONENTS * place..][..COMPONENTS];
                slot.iter_mut()
                    .zip(c)
                    .for_each(|(sum, c)| *sum += factor * c);
            }
        }
    }
    Function {
        support,
        coefficients,
    }
}
