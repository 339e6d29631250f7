//! Charts and the residual they share.

use std::collections::BTreeMap;
use std::sync::Arc;

use msplines_common::mesh::polygon::PolygonTopology;

use super::design::{Blending, Design, Sample};
use crate::dictionary::DictionaryKind;
use crate::domain::{Star, face_coordinates};
use crate::observations::Observations;

/// Coordinates of a point.
pub(crate) const COMPONENTS: usize = 3;

/// A function of a chart: atoms and their coefficients, `[atom][coordinate]`.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Function {
    pub support: Vec<u16>,
    pub coefficients: Vec<f64>,
}

/// One chart.
#[derive(Clone, Debug)]
pub(crate) struct Chart {
    pub design: Arc<Design>,
    /// The same without weights, out to the far edges of its faces.
    pub alone: Arc<Design>,
    /// Observation of each sample of the design.
    pub observations: Vec<u32>,
    /// Whether it may have shape functions.
    pub may_crease: bool,
    pub function: Function,
    /// What it adds to the surface at its samples, `[coordinate][sample]`.
    pub part: Vec<f64>,
}

/// Matrices by shape of the chart.
#[derive(Clone, Debug)]
pub(crate) struct Designs {
    kind: DictionaryKind,
    degree: Option<u32>,
    side: u32,
    blending: Blending,
    known: BTreeMap<Star, Arc<Design>>,
}

impl Designs {
    pub(crate) fn new(
        kind: DictionaryKind,
        degree: Option<u32>,
        side: u32,
        blending: Blending,
    ) -> Self {
        Self {
            kind,
            degree,
            side,
            blending,
            known: BTreeMap::new(),
        }
    }

    pub(crate) fn of(&mut self, star: Star) -> Arc<Design> {
        let degree = self.degree.unwrap_or_else(|| default_degree(star));
        let build = || Design::build(self.kind, degree, star, self.side, self.blending);
        Arc::clone(self.known.entry(star).or_insert_with(|| Arc::new(build())))
    }
}

/// Returns the degree of least-squares polynomials on a chart.
///
/// # Reference
/// [YingZorin2004].
pub(crate) fn default_degree(star: Star) -> u32 {
    (star.valence + 1).min(crate::dictionary::DEGREE)
}

/// Returns the observations at the samples of a chart.
pub(crate) fn chart_observations(
    topology: &PolygonTopology,
    observations: &Observations,
    vertex: u32,
    samples: &[Sample],
) -> Vec<u32> {
    let corners: Vec<u32> = topology.outgoing(vertex).collect();
    let cells = observations.side() as f64 - 1.0;
    samples
        .iter()
        .map(|sample| {
            let h = corners[sample.sector as usize];
            let at = sample.grid.map(|i| f64::from(i) / cells);
            let [s, t] = face_coordinates(h % 4, at);
            let [column, row] = [s, t].map(|c| (c * cells).round() as usize);
            observations.grid(h / 4)[row * observations.side() + column]
        })
        .collect()
}
