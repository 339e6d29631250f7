//! From curves to a surface.

use std::ops::ControlFlow;

use msplines_common::mesh::curves::CurveNetwork;
use msplines_common::progress::{Observer, Outcome, Progress};
use nalgebra::Vector3;

use super::bending::bending_rows;
use super::chase::{Pursuit, chase};
use super::coons::coons;
use super::cycles::{Cycles, find_cycles};
use super::domain::NetworkDomain;
use super::error::NetworkError;
use super::fill::{Fill, fill};
use super::graph::CurveGraph;
use super::nodes::{EdgeCurves, Frame, Nodes, creases_at, is_crease};
use super::options::{C0Atoms, NetworkOptions, SurfaceMethod};
use super::report::{NetworkReport, measure};
use super::system::{FitChart, Gate, System};
use crate::dictionary::DictionaryKind;
use crate::domain::{Domain, Star};
use crate::fit::MOST_VALENCE;
use crate::spline::SparseManifold;

/// A surface over a network, and how it came about.
#[derive(Clone, Debug)]
pub struct NetworkFit {
    /// The surface; its control mesh is that of the domain.
    pub spline: SparseManifold,
    /// The quads, and the curves along their edges.
    pub domain: NetworkDomain,
    /// The patches and holes.
    pub cycles: Cycles,
    /// How good it is.
    pub report: NetworkReport,
}

/// Returns a surface that follows the curves of a network, smooth across all but the creases, and
/// bends little between them.
///
/// Patches are found, cut into quads where they are none, and a chart put on every vertex. In one step
/// the charts are those with the least sum of squared distances from the curves and bending energy of
/// the surface; in two, nodes inside of patches are placed first, and the charts follow these too.
///
/// Curves pass a vertex at a speed that suits the chart there. Where none does, since curves end with
/// tangents that a smooth chart does not have, the chart has cones: the surface is smooth but for the
/// vertex. If no plane holds the tangents, it has a point there, and the report tells where.
///
/// # Reference
/// [Wang2016] §4.3. Deviation: charts are polynomials of full degree, found together, with a bending
/// energy between the curves. The options of the paper, `network::PAPER`, pursue atoms on the curves
/// alone.
///
/// ```
/// use msplines_common::mesh::shapes::dome_network;
/// use msplines_common::progress::unobserved;
/// use msplines_sparse_manifold::network::{NetworkOptions, surface_network};
///
/// let network = dome_network(2).network;
/// let fit = surface_network(&network, &NetworkOptions::default(), &mut unobserved())?;
/// assert!(fit.report.curve_rms < 5e-3);
/// # Ok::<(), msplines_sparse_manifold::network::NetworkError>(())
/// ```
///
/// An observer that stops gets the surface from the rounds of the fill made so far.
///
/// # Errors
/// Options out of range, curves that bound no surface, a vertex with too many patches around it.
pub fn surface_network(
    network: &CurveNetwork,
    options: &NetworkOptions,
    observer: &mut Observer<'_>,
) -> Result<NetworkFit, NetworkError> {
    options.check()?;
    let mut watch = Watch {
        observer,
        stopped: false,
    };
    let graph = CurveGraph::build(network)?;
    let _ = watch.step("cycles", 0, 1);
    let cycles = find_cycles(&graph, &options.cycles)?;
    let domain = NetworkDomain::build(&graph, &cycles)?;
    check_valences(&domain)?;
    let curves = EdgeCurves::new(&graph, &domain, options.speed);
    let fitter = Fitter {
        options,
        domain: &domain,
        charts: Domain::build(domain.mesh.topology()),
        curves: &curves,
        frame: Frame::of(&graph, &domain),
    };
    let (spline, steps) = fitter.fit(&mut watch)?;
    let mut report = measure(&spline, &domain, &curves, fitter.frame, &steps);
    report.warnings.extend(cycles.report.warnings.clone());
    if watch.stopped {
        report.outcome = Outcome::Stopped;
    }
    Ok(NetworkFit {
        spline,
        domain,
        cycles,
        report,
    })
}

/// How a surface was made.
pub(super) struct Steps {
    pub method: SurfaceMethod,
    pub unknowns: usize,
    pub fill: Option<Fill>,
    pub nodes: Nodes,
}

/// Tells the observer, and remembers what it said.
struct Watch<'a, 'b> {
    observer: &'a mut Observer<'b>,
    stopped: bool,
}

impl Watch<'_, '_> {
    fn step(&mut self, phase: &'static str, done: u64, total: u64) -> ControlFlow<()> {
        if (self.observer)(&Progress::new(phase, done, total)).is_break() {
            self.stopped = true;
        }
        if self.stopped {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

struct Fitter<'a> {
    options: &'a NetworkOptions,
    domain: &'a NetworkDomain,
    charts: Domain,
    curves: &'a EdgeCurves<'a>,
    frame: Frame,
}

impl Fitter<'_> {
    fn fit(&self, watch: &mut Watch<'_, '_>) -> Result<(SparseManifold, Steps), NetworkError> {
        let nodes = Nodes::new(self.domain, self.curves, self.options.cells, self.frame);
        let method = match self.options.method {
            SurfaceMethod::Automatic if self.domain.split => SurfaceMethod::TwoStep,
            SurfaceMethod::Automatic => SurfaceMethod::OneStep,
            chosen => chosen,
        };
        let mut steps = Steps {
            method,
            unknowns: 0,
            fill: None,
            nodes,
        };
        if let SurfaceMethod::Pursuit { dictionary, .. } = method {
            let charts = self.pursued(&mut steps);
            let degree = Some(self.options.degree);
            let mesh = &self.domain.mesh;
            return Ok((
                SparseManifold::from_parts(mesh, dictionary, degree, charts)?,
                steps,
            ));
        }
        if method == SurfaceMethod::TwoStep {
            let (energy, rounds) = (self.options.fill, self.options.rounds);
            let total = u64::from(rounds);
            let go_on = |round| watch.step("fill", u64::from(round), total);
            steps.fill = Some(fill(&steps.nodes, energy, rounds, go_on)?);
        }
        let _ = watch.step("fit", 0, 1);
        let spline = self.least_squares(&mut steps)?;
        Ok((spline, steps))
    }

    /// Returns which charts have shape functions.
    fn may_crease(&self) -> Vec<bool> {
        let touched = |v: u32| match self.options.c0_atoms {
            C0Atoms::Gated => creases_at(self.domain, v) > 0,
            C0Atoms::With => true,
            C0Atoms::Without => false,
        };
        (0..self.domain.mesh.vertex_count() as u32)
            .map(touched)
            .collect()
    }

    fn least_squares(&self, steps: &mut Steps) -> Result<SparseManifold, NetworkError> {
        let (options, nodes) = (self.options, &steps.nodes);
        let topology = self.domain.mesh.topology();
        let gates = self
            .may_crease()
            .into_iter()
            .zip(&self.curves.speeds().conical);
        let gates: Vec<Gate> = gates
            .map(|(shapes, &cones)| Gate { shapes, cones })
            .collect();
        let charts = FitChart::all(topology, &self.charts, nodes, options.degree, &gates);
        let mut system = System::new(&charts, nodes);
        let weight = |node: usize| match nodes.targets[node] {
            Some(_) => options.curve_weight,
            None => 1.0,
        };
        let fill = steps.fill.as_ref().map(|fill| &fill.nodes);
        let wanted = |i: usize| fill.map_or(nodes.targets[i], |fill| Some(fill[i]));
        let followed = |i: usize| Some((weight(i), wanted(i)?, [(i, 1.0)]));
        system.add((0..nodes.count()).filter_map(followed).collect());
        let patches = fill.cloned().or_else(|| coons(nodes));
        let rows = bending_rows(topology, nodes, patches.as_deref());
        let row = |(weight, terms)| (options.bending * weight, Vector3::zeros(), terms);
        system.add(rows.into_iter().map(row).collect());
        if options.c0_atoms == C0Atoms::Gated {
            self.keep_smooth(&mut system);
        }
        steps.unknowns = system.unknowns();
        let solved = system.solve()?;
        let parts = charts.iter().zip(solved);
        let parts = parts.map(|(chart, c)| (chart.support.clone(), self.placed(c)));
        let (kind, degree) = (DictionaryKind::Cones, Some(options.degree));
        Ok(SparseManifold::from_parts(
            &self.domain.mesh,
            kind,
            degree,
            parts.collect(),
        )?)
    }

    /// Lets shape functions have kinks along creases only.
    fn keep_smooth(&self, system: &mut System<'_>) {
        let topology = self.domain.mesh.topology();
        for (v, &star) in self.charts.stars().iter().enumerate() {
            for (sector, h) in topology.outgoing(v as u32).enumerate() {
                let edge = topology.edge(h);
                if !topology.is_boundary_edge(edge) && !is_crease(self.domain, edge) {
                    system.forbid_kink(v as u32, star, sector as u32);
                }
            }
        }
    }

    /// Returns coefficients in the space of the network, the constant atom first.
    fn placed(&self, mut coefficients: Vec<f64>) -> Vec<f64> {
        coefficients.iter_mut().for_each(|c| *c *= self.frame.unit);
        for (c, centre) in coefficients.iter_mut().zip(self.frame.centre.iter()) {
            *c += centre;
        }
        coefficients
    }

    /// Returns atoms and coefficients of charts pursued on the curves alone.
    fn pursued(&self, steps: &mut Steps) -> Vec<(Vec<u16>, Vec<f64>)> {
        let SurfaceMethod::Pursuit {
            dictionary,
            sparsity,
            selection,
            components,
        } = steps.method
        else {
            return Vec::new();
        };
        let how = Pursuit {
            dictionary,
            degree: self.options.degree,
            sparsity,
            selection,
            components,
        };
        // A pursuit sees where the origin is: that of the network.
        let nodes = &mut steps.nodes;
        let origin = self.frame.centre / self.frame.unit;
        for target in nodes.targets.iter_mut().flatten() {
            *target += origin;
        }
        let topology = self.domain.mesh.topology();
        let found = chase(topology, &self.charts, nodes, &self.may_crease(), how);
        steps.unknowns = found.iter().map(|f| f.support.len()).sum();
        let scaled = |c: Vec<f64>| c.into_iter().map(|c| c * self.frame.unit).collect();
        found
            .into_iter()
            .map(|f| (f.support, scaled(f.coefficients)))
            .collect()
    }
}

fn check_valences(domain: &NetworkDomain) -> Result<(), NetworkError> {
    let topology = domain.mesh.topology();
    let most = MOST_VALENCE;
    for v in 0..topology.vertex_count() as u32 {
        let valence = Star::of(topology, v).valence;
        if valence > most {
            return Err(NetworkError::Valence {
                position: domain.mesh.positions()[v as usize],
                valence,
                most,
            });
        }
    }
    Ok(())
}
