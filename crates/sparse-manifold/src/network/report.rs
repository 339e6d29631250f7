//! How well a surface follows its network.

use msplines_common::mesh::SurfacePoint;
use msplines_common::progress::Outcome;
use nalgebra::Vector3;
use rayon::prelude::*;

use super::domain::{DomainVertex, NetworkDomain};
use super::facets::Facets;
use super::fill::uniform_laplacian;
use super::graph::CurveGraph;
use super::nodes::{EdgeCurves, Frame, Nodes, creases_at, is_crease};
use super::options::SurfaceMethod;
use super::speeds::ConePoint;
use super::surface::Steps;
use crate::domain::face_coordinates;
use crate::fit::charts::COMPONENTS;
use crate::spline::SparseManifold;
use crate::tessellate::{Tessellation, Tessellator};

/// Points of the surface along an edge at which it is compared with the curve.
const POINTS: u32 = 32;

/// Fractions of an edge where normals are compared.
const PLACES: [f64; 3] = [0.25, 0.5, 0.75];

/// How far from an edge on both sides the normals are that tell how much the surface turns.
const BESIDE: f64 = 1.0 / 16.0;

/// Kinks beyond this angle across smooth curves are worth a warning, in degrees.
const VISIBLE: f64 = 10.0;

/// Most places that a warning lists.
const LISTED: usize = 8;

/// How a surface follows its network. Lengths are in mean arc lengths.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct NetworkReport {
    /// How it ended: with [`Outcome::MaxIterations`] if rounds of the fill were used up.
    pub outcome: Outcome,
    /// How the surface was found.
    pub method: SurfaceMethod,
    /// The mean arc length, the unit of lengths.
    pub unit: f64,
    /// Root of the mean squared distance of the surface from the curves, at 33 points of every edge
    /// of the domain along a curve.
    pub curve_rms: f64,
    /// The largest of these distances.
    pub curve_max: f64,
    /// Mean angle between the two tangent planes of the surface at points of smooth curves.
    pub kink_mean_degrees: f64,
    /// The largest of these angles.
    pub kink_max_degrees: f64,
    /// Mean angle by which the surface turns from a sixteenth of a face before the middle of a smooth
    /// curve to a sixteenth behind it; it counts waves that follow a curve.
    pub turn_mean_degrees: f64,
    /// The largest of these angles.
    pub turn_max_degrees: f64,
    /// The largest angle between neighbouring facets of the surface away from creases, every face of
    /// the domain cut into as many cells as the fit has.
    pub facet_turn_max_degrees: f64,
    /// Pairs of neighbouring facets with more than 60 degrees between them.
    pub sharp_facets: usize,
    /// Junctions where the tangents of curves lie in no plane: no smooth surface follows them, and
    /// this one has a point there.
    pub cone_points: Vec<ConePoint>,
    /// Root of the mean squared graph Laplacian of the surface at the nodes, times the square of the
    /// cells along an edge: about the size of the second derivatives on the domain.
    pub bending: f64,
    /// Number of charts.
    pub charts: usize,
    /// Unknown coefficients of a coordinate.
    pub unknowns: usize,
    /// Shape functions of a chart and a coordinate, on average over charts that a crease touches.
    pub c0_atoms_crease: f64,
    /// The same over the other charts.
    pub c0_atoms_smooth: f64,
    /// Rounds of the fill.
    pub fill_rounds: u32,
    /// What the caller should look at.
    pub warnings: Vec<String>,
}

/// Measures a surface.
pub(super) fn measure(
    spline: &SparseManifold,
    domain: &NetworkDomain,
    curves: &EdgeCurves<'_>,
    frame: Frame,
    steps: &Steps,
) -> NetworkReport {
    let edges: Vec<EdgeMeasure> = (0..domain.curves.len() as u32)
        .into_par_iter()
        .map(|edge| EdgeMeasure::of(spline, domain, curves, edge))
        .collect();
    let squares: Vec<f64> = edges
        .iter()
        .flat_map(|e| e.squares.iter().copied())
        .collect();
    let kinks: Vec<f64> = edges.iter().flat_map(|e| e.kinks.iter().copied()).collect();
    let turns: Vec<f64> = edges.iter().filter_map(|e| e.turn).collect();
    let degrees = |angles: &[f64]| {
        let [mean, max] = mean_and_max(angles);
        [mean.to_degrees(), max.to_degrees()]
    };
    let [mean_square, max_square] = mean_and_max(&squares);
    let [kink_mean_degrees, kink_max_degrees] = degrees(&kinks);
    let [turn_mean_degrees, turn_max_degrees] = degrees(&turns);
    let [c0_atoms_smooth, c0_atoms_crease] = c0_atoms(spline, domain);
    let tessellation = Tessellator::build(spline, steps.nodes.cells).surface(spline);
    let facets = Facets::of(&tessellation, domain, &steps.nodes);
    let cone_points = curves.speeds().points.clone();
    let settled = steps.fill.as_ref().is_none_or(|fill| fill.has_settled());
    NetworkReport {
        outcome: if settled {
            Outcome::Converged
        } else {
            Outcome::MaxIterations
        },
        method: steps.method,
        unit: frame.unit,
        curve_rms: mean_square.sqrt() / frame.unit,
        curve_max: max_square.sqrt() / frame.unit,
        kink_mean_degrees,
        kink_max_degrees,
        turn_mean_degrees,
        turn_max_degrees,
        facet_turn_max_degrees: facets.largest,
        sharp_facets: facets.sharp,
        bending: bending(&tessellation, &steps.nodes) / frame.unit,
        charts: domain.mesh.vertex_count(),
        unknowns: steps.unknowns,
        c0_atoms_crease,
        c0_atoms_smooth,
        fill_rounds: steps.fill.as_ref().map_or(0, |fill| fill.rounds),
        warnings: warnings(
            domain,
            curves.graph(),
            kink_max_degrees,
            &cone_points,
            &facets,
        ),
        cone_points,
    }
}

fn warnings(
    domain: &NetworkDomain,
    graph: &CurveGraph,
    kink: f64,
    cones: &[ConePoint],
    facets: &Facets,
) -> Vec<String> {
    let mut warnings = Vec::new();
    let unused = domain.unused_arcs.len();
    if unused > 0 {
        warnings.push(format!(
            "{unused} arcs lie between holes, and the surface does not follow them"
        ));
    }
    if kink > VISIBLE {
        warnings.push(format!(
            "the surface has a kink of {kink:.0} degrees across a smooth curve; is it a crease?"
        ));
    }
    let mut steepest = cones.to_vec();
    steepest.sort_by(|a, b| b.degrees.total_cmp(&a.degrees).then(a.point.cmp(&b.point)));
    if let [first, ..] = steepest[..] {
        let points: Vec<u32> = steepest.iter().take(LISTED).map(|c| c.point).collect();
        warnings.push(format!(
            "no plane holds the tangents of the curves at {} points, by up to {:.0} degrees, where the \
             surface is a cone; the steepest are {points:?}: flag creases there, or round the curves",
            cones.len(),
            first.degrees
        ));
    }
    if !facets.faces.is_empty() {
        let worst = facets.faces.iter().take(LISTED);
        let worst: Vec<Vec<u32>> = worst.map(|pair| corners(domain, graph, pair.1)).collect();
        warnings.push(format!(
            "the surface turns by up to {:.0} degrees between neighbouring facets in {} faces; the \
             worst are between the points {worst:?}: add curves there, or flag creases",
            facets.largest,
            facets.faces.len()
        ));
    }
    warnings
}

/// Returns the points of the network at the corners of a face.
fn corners(domain: &NetworkDomain, graph: &CurveGraph, face: u32) -> Vec<u32> {
    let corners = domain.mesh.topology().face_vertices(face).iter();
    let junction = |v: &u32| match domain.vertices[*v as usize] {
        DomainVertex::Junction(junction) => Some(graph.junctions()[junction as usize].point),
        _ => None,
    };
    corners.filter_map(junction).collect()
}

/// What one edge of the domain says.
#[derive(Default)]
struct EdgeMeasure {
    /// Squared distances from the curve.
    squares: Vec<f64>,
    /// Angles between the tangent planes of both sides, if the edge is smooth and inside.
    kinks: Vec<f64>,
    turn: Option<f64>,
}

impl EdgeMeasure {
    fn of(
        spline: &SparseManifold,
        domain: &NetworkDomain,
        curves: &EdgeCurves<'_>,
        edge: u32,
    ) -> Self {
        let topology = domain.mesh.topology();
        let h = topology.edge_half_edge(edge);
        let mut measure = Self::default();
        if domain.curves[edge as usize].is_none() {
            return measure;
        }
        for step in 0..=POINTS {
            let s = f64::from(step) / f64::from(POINTS);
            let point = spline.position(h / 4, face_coordinates(h % 4, [s, 0.0]));
            let distance = curves.distance(edge, s, point);
            measure.squares.extend(distance.map(|d| d * d));
        }
        if !topology.is_boundary_edge(edge) && !is_crease(domain, edge) {
            let twin = topology.twin(h);
            let turn = |s: f64, beside: f64| {
                let here = normal(spline, h, [s, beside]);
                angle(here, normal(spline, twin, [1.0 - s, beside]))
            };
            measure.kinks.extend(PLACES.iter().map(|&s| turn(s, 0.0)));
            measure.turn = Some(turn(0.5, BESIDE));
        }
        measure
    }
}

/// Returns the unit normal at coordinates of the corner where a half-edge starts.
fn normal(spline: &SparseManifold, h: u32, at: [f64; 2]) -> Vector3<f64> {
    let [s, t] = face_coordinates(h % 4, at);
    let point = SurfacePoint {
        face: h / 4,
        at: [s, t, 0.0],
    };
    let geometry = spline.geometry(&[point]).expect("a point of a face");
    geometry[0].normal
}

fn angle(a: Vector3<f64>, b: Vector3<f64>) -> f64 {
    a.cross(&b).norm().atan2(a.dot(&b))
}

fn mean_and_max(values: &[f64]) -> [f64; 2] {
    let max = values.iter().copied().fold(0.0, f64::max);
    [values.iter().sum::<f64>() / values.len().max(1) as f64, max]
}

/// Returns the numbers of shape functions on smooth charts and on others.
fn c0_atoms(spline: &SparseManifold, domain: &NetworkDomain) -> [f64; 2] {
    let mut counts = [(0, 0); 2];
    for v in 0..domain.mesh.vertex_count() as u32 {
        let (sum, charts) = &mut counts[usize::from(creases_at(domain, v) > 0)];
        *charts += 1;
        let (support, coefficients) = spline.chart(v);
        let atoms = spline.dictionary(v).atoms();
        for (&atom, c) in support.iter().zip(coefficients.chunks_exact(COMPONENTS)) {
            if atoms[usize::from(atom)].is_shape() {
                *sum += c.iter().filter(|c| **c != 0.0).count();
            }
        }
    }
    counts.map(|(sum, charts)| sum as f64 / (COMPONENTS * charts.max(1)) as f64)
}

/// Returns the root of the mean squared Laplacian.
fn bending(tessellation: &Tessellation, nodes: &Nodes) -> f64 {
    let laplacian = uniform_laplacian(nodes);
    let smooth = (0..nodes.count()).filter(|&i| nodes.bends[i]);
    let squares: Vec<f64> = smooth
        .map(|i| {
            let terms = laplacian.column(i);
            let sum: Vector3<f64> = terms
                .map(|(j, w)| tessellation.positions[j].coords * w)
                .sum();
            sum.norm_squared()
        })
        .collect();
    mean_and_max(&squares)[0].sqrt() * f64::from(nodes.cells).powi(2)
}
