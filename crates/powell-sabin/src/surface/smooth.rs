//! Smooth caps: a spline over the chart of a zero, blended with the surface around.

use msplines_common::Vector3;
use msplines_common::evaluate::Order;
use msplines_common::mesh::TriangleMesh;
use msplines_common::progress::unobserved;
use msplines_conformal::Zero;

use super::chart::{Chart, Reach};
use super::error::NoSmoothCap;
use super::jet::{Jet, PlaneJet, spline_jet};
use super::options::SurfaceOptions;
use super::part::Part;
use super::parts::{CapParts, rows, spline};
use crate::domain::FlatDomain;
use crate::element::{MacroTriangle, ORDINATES};
use crate::fit::{Report, VertexCondition, fit};
use crate::spline::PowellSabinSpline;
use crate::tangent::unit_normal;

/// How far charts go, in the order in which they are tried. One ring around the hole is covered where
/// that is possible, because the sides of the hole itself pass by the zero at their own length, and bend
/// much in its chart. Beyond the ring that is blended there is one more, so that its points stay on the
/// chart.
const REACHES: [Reach; 7] = [
    reach(1, 3),
    reach(1, 4),
    reach(2, 4),
    reach(2, 5),
    reach(3, 5),
    reach(0, 2),
    reach(0, 3),
];

/// Steps along the sides of a face at which folds are looked for.
const FOLD_STEPS: u32 = 4;

/// One ring is covered for so many faces along the side of a square that a hole has for itself.
const FACES_PER_RING: f64 = 20.0;

/// Most rings that are covered; the places in a chart are found by a dense factorisation.
const MOST_COVERED: u32 = 16;

/// Returns how far charts around holes go, in the order in which they are tried.
///
/// Beside a zero the surface is no smooth function of `z`: at the distance of `k` edges its slope changes by the
/// share `1 / k` along each. A cap of a fixed size on the surface therefore keeps the order of accuracy,
/// and one of a fixed number of rings does not.
fn reaches(around: &Around<'_>) -> Vec<Reach> {
    let faces = around.mesh.face_count() as f64 / around.holes as f64;
    let mut covered = ((faces.sqrt() / FACES_PER_RING) as u32).min(MOST_COVERED);
    let mut wide = Vec::new();
    while covered > 1 {
        wide.push(reach(covered, covered + 2));
        covered /= 2;
    }
    wide.extend(REACHES);
    wide
}

const fn reach(covered: u32, rings: u32) -> Reach {
    Reach { covered, rings }
}

/// What caps are fitted to.
pub(super) struct Around<'a> {
    pub(super) mesh: &'a TriangleMesh,
    /// Number of holes in it.
    pub(super) holes: usize,
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
    /// around. It covers no vertex that is taken.
    pub(super) fn fit(
        around: &Around<'_>,
        zero: &Zero,
        taken: &[bool],
    ) -> Result<(Self, Report), NoSmoothCap> {
        let in_hole = |face: u32| around.part.face(face).is_none();
        let mut failed = None;
        let mut best: Option<(usize, Self, Report)> = None;
        for reach in reaches(around) {
            let chart = Chart::build(around.mesh, around.form, in_hole, zero, reach);
            let placed = chart.and_then(|mut chart| {
                if chart.covered_vertices().any(|v| taken[v as usize]) {
                    return Err(NoSmoothCap::NoDisk);
                }
                chart.place_zero()?;
                Self::over(around, chart)
            });
            match placed {
                Ok((cap, report)) => {
                    let folds = cap.folds(around.mesh) + report.violations_after;
                    if best.as_ref().is_none_or(|(least, ..)| folds < *least) {
                        best = Some((folds, cap, report));
                    }
                    if folds == 0 {
                        break;
                    }
                }
                // The first reason is that of the chart that is most likely to work.
                Err(reason) => failed = failed.or(Some(reason)),
            }
        }
        best.map(|(_, cap, report)| (cap, report))
            .ok_or_else(|| failed.unwrap_or(NoSmoothCap::NoDisk))
    }

    /// Returns at how many points of a grid the cap faces away from the faces of the mesh.
    fn folds(&self, mesh: &TriangleMesh) -> usize {
        let steps = 0..FOLD_STEPS;
        let grid: Vec<[f64; 3]> = steps
            .flat_map(|i| (0..FOLD_STEPS - i).map(move |j| [i, j]))
            .map(|at| {
                let [a, b] = at.map(|k| (f64::from(k) + 1.0 / 3.0) / f64::from(FOLD_STEPS));
                [1.0 - a - b, a, b]
            })
            .collect();
        let rim = self.chart.rim();
        let on_rim = |v: &u32| rim.binary_search(v).is_ok();
        let corners = self.chart.mesh.faces().iter();
        let shown = corners
            .zip(&self.chart.covered)
            .map(|(corners, &covered)| covered || corners.iter().any(on_rim));
        let opposed = |local: u32, covered: bool, at: [f64; 3]| {
            let map = if covered {
                self.chart.inside(local, at)
            } else {
                self.chart.outside(local, at)
            };
            let face = mesh.face_normal(self.chart.part.faces[local as usize]);
            let normal = self.composed(local, at, &map, Order::First).normal();
            normal.is_some_and(|normal| normal.dot(&face) < 0.0)
        };
        let faces = shown.enumerate().filter(|(_, shown)| *shown);
        faces
            .map(|(local, _)| {
                let covered = self.chart.covered[local];
                let points = grid.iter();
                points
                    .filter(|&&at| opposed(local as u32, covered, at))
                    .count()
            })
            .sum()
    }

    fn over(around: &Around<'_>, chart: Chart) -> Result<(Self, Report), NoSmoothCap> {
        let domain = FlatDomain::build(chart.mesh.clone(), chart.edge_vectors())
            .map_err(|_| NoSmoothCap::Folded)?;
        if !chart.is_sound() {
            return Err(NoSmoothCap::Bent);
        }
        let condition = |(local, &vertex): (usize, &u32)| {
            let inside = chart.inner.binary_search(&(local as u32)).is_ok();
            let regular = around.part.vertex(vertex).filter(|_| !inside);
            let Some(regular) = regular else {
                return without_gradient(around.conditions[vertex as usize]);
            };
            let [x, y] = around.regular.vertex_gradient(regular);
            let slope = chart.slope(local as u32);
            let gradient = [slope.re * x + slope.im * y, slope.re * y - slope.im * x];
            VertexCondition::Fixed {
                position: around.regular.vertex_position(regular),
                gradient: around.conditions[vertex as usize].kept(gradient),
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

    /// Returns how far the chart goes.
    #[must_use]
    pub fn reach(&self) -> Reach {
        self.chart.reach
    }

    /// Returns the faces over which the surface is the spline of the cap alone, ascending.
    pub(super) fn covered_faces(&self) -> impl Iterator<Item = u32> + '_ {
        let faces = self.chart.part.faces.iter().zip(&self.chart.covered);
        faces
            .filter(|(_, covered)| **covered)
            .map(|(&face, _)| face)
    }

    /// Returns the vertices around these, ascending.
    pub(super) fn rim(&self) -> impl Iterator<Item = u32> + '_ {
        let rim = self.chart.rim().into_iter();
        rim.map(|v| self.chart.part.vertices[v as usize])
    }

    /// Returns all vertices of these faces.
    pub(super) fn covered_vertices(&self) -> impl Iterator<Item = u32> + '_ {
        self.chart.covered_vertices()
    }

    /// Returns the number of vertices inside of what the cap covers.
    pub(super) fn inner_vertices(&self) -> usize {
        self.chart.inner.len()
    }

    /// Returns the numbers of the cap.
    pub(super) fn parts(&self) -> CapParts {
        let (values, gradients) = rows(&self.spline);
        CapParts::Smooth {
            reach: self.chart.reach,
            zero: [self.chart.z0.re, self.chart.z0.im],
            chart: self.chart.w.iter().map(|w| [w.re, w.im]).collect(),
            values,
            gradients,
        }
    }

    /// Returns the cap of stored numbers.
    pub(super) fn restore(
        mesh: &TriangleMesh,
        form: &[[f64; 2]],
        in_hole: impl Fn(u32) -> bool,
        zero: &Zero,
        reach: Reach,
        (place, chart): (&[f64; 2], &[[f64; 2]]),
        (values, gradients): (&[[f64; 3]], &[[[f64; 3]; 2]]),
    ) -> Result<Self, NoSmoothCap> {
        let places = chart;
        let mut chart = Chart::build(mesh, form, in_hole, zero, reach)?;
        chart.set_places(*place, places)?;
        let domain = FlatDomain::build(chart.mesh.clone(), chart.edge_vectors())
            .map_err(|_| NoSmoothCap::Folded)?;
        let spline = spline(domain, values, gradients).map_err(|error| NoSmoothCap::Fit {
            reason: error.to_string(),
        })?;
        Ok(Self { chart, spline })
    }

    /// Whether the map of a covered face into the chart is linear.
    pub(super) fn is_straight(&self, face: u32) -> bool {
        let local = self.local(face);
        let covered = self.chart.covered[local as usize];
        covered && !(0..3).any(|side| self.chart.is_rim(3 * local + side))
    }

    /// Returns the Bézier ordinates of the spline on a face of the chart.
    pub(super) fn ordinates(&self, face: u32, component: usize) -> [f64; ORDINATES] {
        self.spline.ordinates(self.local(face), component)
    }

    /// Returns the split of a face of the chart.
    pub(super) fn split(&self, face: u32) -> MacroTriangle {
        self.spline.macro_triangle(self.local(face))
    }

    /// Returns the cap at a point of the hole, by the second and third barycentric coordinate.
    pub(super) fn inside(&self, face: u32, at: [f64; 3], order: Order) -> Jet {
        let local = self.local(face);
        self.composed(local, at, &self.chart.inside(local, at), order)
    }

    /// Returns the normal at a vertex of the chart, by the flat coordinates of the chart.
    pub(super) fn vertex_normal(&self, vertex: u32) -> Option<Vector3<f64>> {
        let [u, v] = self.spline.vertex_gradient(self.chart.part.vertex(vertex)?);
        unit_normal(&u, &v)
    }

    /// Returns the cap at a point outside of the hole, by the flat coordinates of the form.
    pub(super) fn beside(&self, face: u32, at: [f64; 3], order: Order) -> Jet {
        let local = self.local(face);
        self.composed(local, at, &self.chart.outside(local, at), order)
    }

    fn local(&self, face: u32) -> u32 {
        self.chart.part.face(face).expect("a face of the chart")
    }

    /// Returns the spline after a map of a face, at whose point `at` it was taken.
    fn composed(&self, face: u32, at: [f64; 3], map: &PlaneJet, order: Order) -> Jet {
        // Corners are themselves, without the rounding of a search.
        if at.contains(&1.0) {
            return spline_jet(&self.spline, face, at, order).after(map);
        }
        let place = self.chart.locate(face, map.value);
        spline_jet(&self.spline, place.face, place.at, order).after(map)
    }
}

/// Prescribed gradients are by coordinates that the inside of a cap does not have: their plane is kept.
fn without_gradient(condition: VertexCondition) -> VertexCondition {
    match condition {
        VertexCondition::Fixed { position, gradient } => {
            let [u, v] = gradient;
            match unit_normal(&u, &v) {
                Some(normal) => VertexCondition::Interpolate { position, normal },
                None => VertexCondition::Position { position },
            }
        }
        other => other,
    }
}
