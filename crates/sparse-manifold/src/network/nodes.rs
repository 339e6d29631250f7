//! The nodes of a network's quads: a grid on every face, shared along the edges.
//!
//! # Notation
//! An edge from `v` to `w` has the exponents `a = 4 / k_v` and `b = 4 / k_w` of the charts at its
//! ends; the point at the fraction `s` of it lies at the fraction `I_s(a, b)` of its curve, regraded so
//! that curves leave a vertex with speeds that suit its chart.

use msplines_common::mesh::polygon::PolygonTopology;
use nalgebra::{Point3, Vector3};

use super::domain::{DomainVertex, EdgeCurve, NetworkDomain};
use super::graph::CurveGraph;
use super::options::CurveSpeed;
use super::parameter::{length_fraction, regraded};
use super::speeds::Speeds;
use crate::domain::Star;
use crate::numbers::Numbers;

/// From so many creases on a vertex is a corner. Its shape functions are linear along the edges, not
/// powers, and so is the arc length there.
pub(super) const CORNER: usize = 3;

/// Curves over the edges of a domain.
pub(super) struct EdgeCurves<'a> {
    graph: &'a CurveGraph,
    domain: &'a NetworkDomain,
    /// The exponent of every vertex.
    exponents: Vec<f64>,
    speeds: Speeds,
}

impl<'a> EdgeCurves<'a> {
    pub(super) fn new(graph: &'a CurveGraph, domain: &'a NetworkDomain, speed: CurveSpeed) -> Self {
        let topology = domain.mesh.topology();
        let exponent = |v: u32| {
            let corner = creases_at(domain, v) >= CORNER;
            if corner || speed == CurveSpeed::Constant {
                return 1.0;
            }
            4.0 / f64::from(Star::of(topology, v).valence)
        };
        let vertices = 0..topology.vertex_count() as u32;
        let exponents: Vec<f64> = vertices.map(exponent).collect();
        Self {
            graph,
            domain,
            speeds: match speed {
                CurveSpeed::Adapted => Speeds::matched(graph, domain, &exponents),
                CurveSpeed::Constant => Speeds::natural(domain),
            },
            exponents,
        }
    }

    pub(super) fn graph(&self) -> &CurveGraph {
        self.graph
    }

    /// Returns how the curves leave the vertices.
    pub(super) fn speeds(&self) -> &Speeds {
        &self.speeds
    }

    /// Returns the arc and its length from the start where an edge has gone a fraction of its way.
    fn place(&self, edge: u32, s: f64) -> Option<(EdgeCurve, f64)> {
        let curve = self.domain.curves[edge as usize]?;
        let ends = self.domain.mesh.topology().edge_vertices(edge);
        let [from, to] = curve.interval;
        let fraction = length_fraction(s, ends.map(|v| self.exponents[v as usize]));
        let fraction = regraded(fraction, self.speeds.ratios[edge as usize]);
        Some((curve, from + fraction * (to - from)))
    }

    /// Returns the point of the curve of an edge where the edge has gone a fraction of its way.
    pub(super) fn point(&self, edge: u32, s: f64) -> Option<Point3<f64>> {
        let (curve, length) = self.place(edge, s)?;
        Some(self.graph.arcs()[curve.arc as usize].shape.point(length))
    }

    /// Returns the distance of a point, supposed to lie near the fraction `s` of an edge, from the
    /// arc of the edge.
    pub(super) fn distance(&self, edge: u32, s: f64, point: Point3<f64>) -> Option<f64> {
        /// Steps along the tangent; two reach the foot to a tenth of a thousandth of the distance.
        const STEPS: usize = 3;
        let (curve, mut length) = self.place(edge, s)?;
        let shape = &self.graph.arcs()[curve.arc as usize].shape;
        let mut least = (point - shape.point(length)).norm();
        for _ in 0..STEPS {
            let along = shape.tangent(length).dot(&(point - shape.point(length)));
            length = (length + along).clamp(0.0, shape.length());
            least = least.min((point - shape.point(length)).norm());
        }
        Some(least)
    }
}

/// Returns how many creases inside of the surface end at a vertex.
pub(super) fn creases_at(domain: &NetworkDomain, vertex: u32) -> usize {
    let topology = domain.mesh.topology();
    let spokes = topology.spokes(vertex).map(|h| topology.edge(h));
    spokes.filter(|&edge| is_crease(domain, edge)).count()
}

/// Returns whether the surface has a crease along an edge, inside.
pub(super) fn is_crease(domain: &NetworkDomain, edge: u32) -> bool {
    let crease = domain.curves[edge as usize].is_some_and(|curve| curve.crease);
    crease && !domain.mesh.topology().is_boundary_edge(edge)
}

/// Where lengths start and what they are measured in, so that nothing depends on either.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub centre: Vector3<f64>,
    /// The mean length of the arcs around patches.
    pub unit: f64,
}

impl Frame {
    pub(super) fn of(graph: &CurveGraph, domain: &NetworkDomain) -> Self {
        let unused = |arc: usize| domain.unused_arcs.contains(&(arc as u32));
        let arcs = graph.arcs().iter().enumerate();
        let used = arcs.filter(|pair| !unused(pair.0));
        let lengths: Vec<f64> = used.map(|pair| pair.1.shape.length()).collect();
        let positions = domain.mesh.positions();
        let sum: Vector3<f64> = positions.iter().map(|p| p.coords).sum();
        Self {
            centre: sum / positions.len() as f64,
            unit: lengths.iter().sum::<f64>() / lengths.len() as f64,
        }
    }
}

/// The nodes of all faces.
pub(super) struct Nodes {
    /// Cells along an edge.
    pub cells: u32,
    /// The nodes of every face: along its first edge first, then up.
    pub grids: Vec<Vec<u32>>,
    /// Where the nodes on curves are, in a frame.
    pub targets: Vec<Option<Vector3<f64>>>,
    /// Whether the surface is smooth at a node and on all sides of it.
    pub bends: Vec<bool>,
    /// Pairs of neighbours on grid lines, each once.
    pub lines: Vec<[u32; 2]>,
}

impl Nodes {
    pub(super) fn new(
        domain: &NetworkDomain,
        curves: &EdgeCurves<'_>,
        cells: u32,
        frame: Frame,
    ) -> Self {
        let topology = &**domain.mesh.topology();
        let numbers = Numbers { topology, cells };
        let mut targets = vec![None; numbers.count()];
        let mut bends = vec![true; numbers.count()];
        let framed = |p: Point3<f64>| (p.coords - frame.centre) / frame.unit;
        for (v, vertex) in domain.vertices.iter().enumerate() {
            let on_curve = !matches!(vertex, DomainVertex::Centre { .. });
            targets[v] = on_curve.then(|| framed(domain.mesh.positions()[v]));
            bends[v] = !curves.speeds.conical[v];
        }
        for edge in 0..topology.edge_count() as u32 {
            let h = topology.edge_half_edge(edge);
            let sharp = is_crease(domain, edge) || topology.is_boundary_edge(edge);
            for step in 0..=cells {
                let node = numbers.on_edge(h, step) as usize;
                bends[node] &= !sharp;
                if (1..cells).contains(&step) {
                    let s = f64::from(step) / f64::from(cells);
                    targets[node] = curves.point(edge, s).map(framed);
                }
            }
        }
        let grids: Vec<_> = (0..topology.face_count() as u32)
            .map(|face| numbers.grid(face))
            .collect();
        Self {
            cells,
            lines: lines(topology, &grids, cells),
            grids,
            targets,
            bends,
        }
    }

    pub(super) fn count(&self) -> usize {
        self.targets.len()
    }

    /// Returns the four nodes around every cell, counter-clockwise.
    pub(super) fn quads(&self) -> impl Iterator<Item = [u32; 4]> + '_ {
        let n = self.cells as usize;
        let side = n + 1;
        self.grids.iter().flat_map(move |grid| {
            (0..n * n).map(move |cell| {
                let at = cell / n * side + cell % n;
                [grid[at], grid[at + 1], grid[at + side + 1], grid[at + side]]
            })
        })
    }
}

/// Returns the pairs of neighbours; those on an edge come from its first face only.
fn lines(topology: &PolygonTopology, grids: &[Vec<u32>], cells: u32) -> Vec<[u32; 2]> {
    let n = cells as usize;
    let side = n + 1;
    let mut lines = Vec::new();
    for (face, grid) in grids.iter().enumerate() {
        let owns = |corner: u32| {
            let h = 4 * face as u32 + corner;
            topology.edge_half_edge(topology.edge(h)) == h
        };
        let [bottom, right, top, left] = [0, 1, 2, 3].map(owns);
        for i in 0..side {
            let along = (i > 0 || bottom) && (i < n || top);
            let up = (i > 0 || left) && (i < n || right);
            for j in 0..n {
                if along {
                    lines.push([grid[i * side + j], grid[i * side + j + 1]]);
                }
                if up {
                    lines.push([grid[j * side + i], grid[(j + 1) * side + i]]);
                }
            }
        }
    }
    lines
}
