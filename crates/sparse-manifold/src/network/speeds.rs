//! How fast curves run through the charts of a domain, and where charts need cones for them.
//!
//! A smooth chart has one derivative at its centre. The curves that leave a vertex ask for one each:
//! a short arc and a long one, of the same curve, have different speeds on either side if both run by
//! arc length, and curves that end there may have tangents that no plane holds, or no linear map of
//! the evenly spread rays of the chart.
//!
//! # Notation
//! Ray `j` of a chart of valence `k` has the direction `e_j = (cos 2πj/k, sin 2πj/k)`; the curve along
//! it has the unit tangent `t_j`, and left alone the speed `n_j`. The linear map `A` with the least
//! `Σ |t_j - A e_j / n_j|²` is the derivative of the chart, `d_j = t_j · A e_j` the speed of the curve
//! and `|d_j t_j - A e_j| / n_j` its misfit.

use std::f64::consts::TAU;

use nalgebra::{Matrix2, Matrix3x2, Vector2, Vector3};

use super::domain::{DomainVertex, NetworkDomain};
use super::graph::CurveGraph;
use super::nodes::{CORNER, creases_at};
use super::parameter::end_rates;
use crate::domain::Star;

/// Bounds of a speed, of the one that a curve has if left alone.
const RATIOS: [f64; 2] = [0.02, 3.0];

/// Misfit from which a chart has cones. On a Catmull-Clark surface of genus two the charts of valence
/// five have them, those of valence three do not.
const MISFIT: f64 = 0.05;

/// Angle from the plane of the derivative from which tangents are told to lie in none, in degrees.
const OUT_OF_PLANE: f64 = 10.0;

/// A junction whose curves no smooth surface can follow: it has a point there, like a cone.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct ConePoint {
    /// The point of the network.
    pub point: u32,
    /// The largest angle of a tangent with the plane of the derivative that suits all best.
    pub degrees: f64,
}

/// How curves leave the vertices of a domain.
pub(super) struct Speeds {
    /// The speeds of the curve at the first and the second vertex of every edge, of those that it has
    /// if left alone.
    pub ratios: Vec<[f64; 2]>,
    /// Which charts need cones.
    pub conical: Vec<bool>,
    /// Where tangents lie in no plane, and no crease tells why.
    pub points: Vec<ConePoint>,
}

impl Speeds {
    /// Returns the speeds that curves have if left alone.
    pub(super) fn natural(domain: &NetworkDomain) -> Self {
        let topology = domain.mesh.topology();
        Self {
            ratios: vec![[1.0; 2]; topology.edge_count()],
            conical: vec![false; topology.vertex_count()],
            points: Vec::new(),
        }
    }

    /// Returns the speeds for which charts fit best, given the exponents of all charts.
    pub(super) fn matched(graph: &CurveGraph, domain: &NetworkDomain, exponents: &[f64]) -> Self {
        let topology = domain.mesh.topology();
        let mut speeds = Self::natural(domain);
        for v in 0..topology.vertex_count() as u32 {
            let creases = creases_at(domain, v);
            if creases >= CORNER {
                continue;
            }
            let rays = rays(graph, domain, exponents, v);
            let map = derivative(&rays);
            for ray in &rays {
                let image = map * ray.direction;
                let speed = ray.tangent.dot(&image);
                let edge = topology.edge(ray.half_edge);
                let end = usize::from(topology.edge_vertices(edge)[0] != v);
                let ratio = (speed / ray.natural).clamp(RATIOS[0], RATIOS[1]);
                speeds.ratios[edge as usize][end] = ratio;
                let misfit = (ray.tangent * speed.max(0.0) - image).norm() / ray.natural;
                speeds.conical[v as usize] |= misfit > MISFIT;
            }
            let degrees = out_of_plane(&rays, &map).map_or(0.0, f64::to_degrees);
            let inside = !topology.is_boundary_vertex(v) && creases == 0;
            if let (true, DomainVertex::Junction(junction)) = (inside, domain.vertices[v as usize])
                && degrees > OUT_OF_PLANE
            {
                let point = graph.junctions()[junction as usize].point;
                speeds.points.push(ConePoint { point, degrees });
            }
        }
        speeds
    }
}

/// A curve that leaves a vertex.
struct Ray {
    half_edge: u32,
    direction: Vector2<f64>,
    tangent: Vector3<f64>,
    natural: f64,
}

fn rays(graph: &CurveGraph, domain: &NetworkDomain, exponents: &[f64], v: u32) -> Vec<Ray> {
    let topology = domain.mesh.topology();
    let turn = TAU / f64::from(Star::of(topology, v).valence);
    let ray = |(j, half_edge): (usize, u32)| {
        let edge = topology.edge(half_edge);
        let curve = domain.curves[edge as usize]?;
        let ends = topology.edge_vertices(edge);
        let end = usize::from(ends[0] != v);
        let shape = &graph.arcs()[curve.arc as usize].shape;
        let [from, to] = [curve.interval[end], curve.interval[1 - end]];
        let rate = end_rates(ends.map(|v| exponents[v as usize]))[end];
        let angle = turn * j as f64;
        Some(Ray {
            half_edge,
            direction: Vector2::new(angle.cos(), angle.sin()),
            tangent: shape.tangent(from) * (to - from).signum(),
            natural: (to - from).abs() * rate,
        })
    };
    topology.spokes(v).enumerate().filter_map(ray).collect()
}

fn derivative(rays: &[Ray]) -> Matrix3x2<f64> {
    let mut normal = Matrix2::zeros();
    let mut right = Matrix3x2::zeros();
    for ray in rays {
        let row = ray.direction / ray.natural;
        normal += row * row.transpose();
        right += ray.tangent * row.transpose();
    }
    // Two rays on one line leave the other direction open.
    let least = 1e-9 * normal.trace();
    right * normal.pseudo_inverse(least).unwrap_or_default()
}

/// Returns the largest angle of a tangent with the plane of a derivative, none if that is a line.
fn out_of_plane(rays: &[Ray], map: &Matrix3x2<f64>) -> Option<f64> {
    let area = map.column(0).cross(&map.column(1));
    let normal = area.try_normalize(1e-9 * map.norm_squared())?;
    let angle = |ray: &Ray| ray.tangent.dot(&normal).abs().min(1.0).asin();
    Some(rays.iter().map(angle).fold(0.0, f64::max))
}
