//! Smooth caps: a spline over the chart of a zero, blended with the surface around.

use msplines_common::evaluate::Order;
use msplines_common::mesh::TriangleMesh;
use msplines_conformal::Zero;

use super::chart::Chart;
use super::error::NoSmoothCap;
use super::jet::{Jet, PlaneJet, spline_jet};
use super::options::SurfaceOptions;
use super::part::Part;
use crate::domain::FlatDomain;
use crate::fit::{Report, VertexCondition, fit};
use crate::spline::PowellSabinSpline;
use msplines_common::progress::unobserved;

/// Rings of faces around a hole that its chart covers: most first. Two are needed, so that points of
/// the ring that is blended stay on the chart.
const RINGS: [u32; 2] = [3, 2];

/// What caps are fitted to.
pub(super) struct Around<'a> {
    pub(super) mesh: &'a TriangleMesh,
    pub(super) form: &'a [[f64; 2]],
    pub(super) regular: &'a PowellSabinSpline,
    pub(super) part: &'a Part,
    pub(super) conditions: &'a [VertexCondition],
    pub(super) options: &'a SurfaceOptions,
}

/// A spline over the chart of a zero.
#[derive(Clone, Debug)]
pub struct SmoothCap {
    chart: Chart,
    spline: PowellSabinSpline,
}

impl SmoothCap {
    /// Returns the fairest spline inside of a hole that has value and gradient of the regular part
    /// around.
    pub(super) fn fit(around: &Around<'_>, zero: &Zero) -> Result<(Self, Report), NoSmoothCap> {
        let in_hole = |face: u32| around.part.face(face).is_none();
        let mut failed = NoSmoothCap::NoDisk;
        for rings in RINGS {
            let chart = Chart::build(around.mesh, around.form, in_hole, zero, rings);
            match chart.and_then(|chart| Self::over(around, chart)) {
                Ok(found) => return Ok(found),
                Err(reason) => failed = reason,
            }
        }
        Err(failed)
    }

    fn over(around: &Around<'_>, chart: Chart) -> Result<(Self, Report), NoSmoothCap> {
        let domain = FlatDomain::build(chart.mesh.clone(), chart.edge_vectors())
            .map_err(|_| NoSmoothCap::Folded)?;
        if !chart.is_sound() {
            return Err(NoSmoothCap::Bent);
        }
        let condition = |(local, &vertex): (usize, &u32)| {
            let Some(regular) = around.part.vertex(vertex) else {
                return around.conditions[vertex as usize];
            };
            let [x, y] = around.regular.vertex_gradient(regular);
            let slope = chart.slope(local as u32);
            VertexCondition::Fixed {
                position: around.regular.vertex_position(regular),
                gradient: [slope.re * x + slope.im * y, slope.re * y - slope.im * x],
            }
        };
        let conditions: Vec<_> = chart
            .part
            .vertices
            .iter()
            .enumerate()
            .map(condition)
            .collect();
        let options = &around.options.spline;
        let found = fit(&domain, &conditions, options, &mut unobserved()).map_err(|error| {
            NoSmoothCap::Fit {
                reason: error.renamed(&chart.part.vertices).to_string(),
            }
        })?;
        let spline = found.spline;
        Ok((Self { chart, spline }, found.report))
    }

    /// Returns the spline over the chart; its flat coordinates are `w`.
    #[must_use]
    pub fn spline(&self) -> &PowellSabinSpline {
        &self.spline
    }

    /// Returns the vertices of the chart as those of the whole mesh.
    #[must_use]
    pub fn vertices(&self) -> &[u32] {
        &self.chart.part.vertices
    }

    /// Returns the faces of the chart as those of the whole mesh.
    #[must_use]
    pub fn faces(&self) -> &[u32] {
        &self.chart.part.faces
    }

    /// Returns how many rings of faces around the hole the chart covers.
    #[must_use]
    pub fn rings(&self) -> u32 {
        self.chart.rings
    }

    /// Returns the cap at a point of the hole, by the second and third barycentric coordinate.
    pub(super) fn inside(&self, face: u32, at: [f64; 3], order: Order) -> Jet {
        let local = self.local(face);
        self.composed(local, &self.chart.inside(local, at), order)
    }

    /// Returns the cap at a point outside of the hole, by the flat coordinates of the form.
    pub(super) fn beside(&self, face: u32, at: [f64; 3], order: Order) -> Jet {
        let local = self.local(face);
        self.composed(local, &self.chart.outside(local, at), order)
    }

    fn local(&self, face: u32) -> u32 {
        self.chart.part.face(face).expect("a face of the chart")
    }

    fn composed(&self, face: u32, map: &PlaneJet, order: Order) -> Jet {
        let place = self.chart.locate(face, map.value);
        spline_jet(&self.spline, place.face, place.at, order).after(map)
    }
}
