//! Nodes between the curves, so that the surface through all nodes bends least.
//!
//! # Notation
//! `S` is a Laplacian with zero row sums, `D` a diagonal that is zero at nodes on creases and on the
//! boundary, over which nothing bends; `|D^(1/2) S X|²` is least with the nodes on curves held fast.
//!
//! # Reference
//! [Wang2016] §4.3 has no such step: it fits the charts to the curves alone. Deviation: those
//! oscillate between the curves.

use std::ops::ControlFlow;

use msplines_common::linalg::{Cholesky, Mat, Ordering, Symbolic, SymmetricMatrix};
use nalgebra::Vector3;

use super::error::NetworkError;
use super::nodes::Nodes;
use super::options::FillEnergy;

/// Bounds of the cotangent of an angle: beyond them triangles are slivers.
const COTANGENT: [f64; 2] = [-3.0, 20.0];

/// Least area of a node, of the median.
const LEAST_AREA: f64 = 1e-3;

/// How much of a step along the surface is made. The energy hardly tells where on the surface nodes
/// lie: with whole steps they drift, on even quads too, until normals are three times worse after
/// ten rounds; without any, those of a bad start stay bad.
const SLIDING: f64 = 0.1;

/// Change of the nodes, a root mean square in mean arc lengths, below which rounds end.
const SETTLED: f64 = 1e-3;

/// Nodes in patches.
pub(super) struct Fill {
    /// All nodes.
    pub nodes: Vec<Vector3<f64>>,
    /// Rounds of the cotangent energy.
    pub rounds: u32,
    /// Change of the nodes in the last round, a root mean square.
    pub change: f64,
}

impl Fill {
    pub(super) fn has_settled(&self) -> bool {
        self.change < SETTLED
    }
}

/// Returns nodes of least energy. The cotangent energy depends on the shape: it is minimised again on
/// the result, until nodes hardly move, `most` rounds have been made, or `go_on` says to stop.
///
/// # Errors
/// An energy without a least value.
pub(super) fn fill(
    nodes: &Nodes,
    energy: FillEnergy,
    most: u32,
    mut go_on: impl FnMut(u32) -> ControlFlow<()>,
) -> Result<Fill, NetworkError> {
    let start: Vec<Vector3<f64>> = nodes
        .targets
        .iter()
        .map(|t| t.unwrap_or_default())
        .collect();
    let unknown = |node: usize| nodes.targets[node].is_none();
    let keep: Vec<f64> = nodes
        .bends
        .iter()
        .map(|&b| f64::from(u8::from(b)))
        .collect();
    let uniform = uniform_laplacian(nodes).congruence(&keep);
    let ordering = Ordering::nested_dissection(&uniform)?;
    let symbolic = Symbolic::analyze_kept(&uniform, &ordering, unknown);
    let factor = Cholesky::factor(symbolic, &uniform)?;
    let mut fill = Fill {
        nodes: solve(&uniform, &factor, nodes, &start),
        rounds: 0,
        change: 0.0,
    };
    if energy == FillEnergy::Uniform {
        return Ok(fill);
    }
    let mut factor: Option<Cholesky> = None;
    fill.change = f64::INFINITY;
    while fill.rounds < most && !fill.has_settled() && go_on(fill.rounds).is_continue() {
        let (stiffness, areas) = cotangent_laplacian(nodes, &fill.nodes);
        let weights: Vec<f64> = keep
            .iter()
            .zip(areas)
            .map(|(keep, area)| keep / area)
            .collect();
        let matrix = stiffness.congruence(&weights);
        match &mut factor {
            Some(factor) => factor.refactor(&matrix)?,
            None => {
                // Its rows reach farther than those of the uniform energy.
                let ordering = Ordering::nested_dissection(&matrix)?;
                let symbolic = Symbolic::analyze_kept(&matrix, &ordering, unknown);
                factor = Some(Cholesky::factor(symbolic, &matrix)?);
            }
        }
        let Some(factor) = &factor else { break };
        let next = solve(&matrix, factor, nodes, &start);
        fill.change = advance(nodes, &mut fill.nodes, &next);
        fill.rounds += 1;
    }
    Ok(fill)
}

/// Moves a shape towards another, all the way along its normals; returns the root mean square step.
fn advance(nodes: &Nodes, shape: &mut [Vector3<f64>], next: &[Vector3<f64>]) -> f64 {
    let normals = normals(nodes, shape);
    let mut squares = 0.0;
    for ((x, next), normal) in shape.iter_mut().zip(next).zip(normals) {
        let step = next - *x;
        let along = normal * normal.dot(&step);
        let step = along + (step - along) * SLIDING;
        squares += step.norm_squared();
        *x += step;
    }
    (squares / shape.len() as f64).sqrt()
}

/// Returns all nodes, from those that are held fast and zeros.
fn solve(
    matrix: &SymmetricMatrix,
    factor: &Cholesky,
    nodes: &Nodes,
    start: &[Vector3<f64>],
) -> Vec<Vector3<f64>> {
    let fixed = Mat::from_fn(start.len(), 3, |i, side| start[i][side]);
    let mut x = -matrix.multiply(fixed.as_ref());
    factor.solve_in_place(x.as_mut());
    let solved = |i: usize| Vector3::from([0, 1, 2].map(|side| x[(i, side)]));
    let all = nodes.targets.iter().enumerate();
    all.map(|(i, target)| target.unwrap_or_else(|| solved(i)))
        .collect()
}

/// Returns the unit normals at nodes of a shape; zero where it has none.
fn normals(nodes: &Nodes, shape: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let mut normals = vec![Vector3::zeros(); nodes.count()];
    for quad in nodes.quads() {
        let [a, b, c, d] = quad.map(|v| shape[v as usize]);
        let area = (c - a).cross(&(d - b));
        quad.iter().for_each(|&v| normals[v as usize] += area);
    }
    let unit = |n: Vector3<f64>| n.try_normalize(f64::MIN_POSITIVE).unwrap_or_default();
    normals.into_iter().map(unit).collect()
}

/// Returns the graph Laplacian of the grid lines: valences on its diagonal.
pub(super) fn uniform_laplacian(nodes: &Nodes) -> SymmetricMatrix {
    let mut entries = Vec::with_capacity(3 * nodes.lines.len());
    for &[a, b] in &nodes.lines {
        entries.extend([(a, a, 1.0), (b, b, 1.0), (a.max(b), a.min(b), -1.0)]);
    }
    SymmetricMatrix::from_lower_triplets(nodes.count(), &entries)
}

/// Returns the cotangent stiffness of the cells and the areas of the nodes: means of both ways to cut
/// a cell.
fn cotangent_laplacian(nodes: &Nodes, shape: &[Vector3<f64>]) -> (SymmetricMatrix, Vec<f64>) {
    let mut entries = Vec::with_capacity(36 * nodes.grids.len() * nodes.cells.pow(2) as usize);
    let mut areas = vec![0.0; nodes.count()];
    for [a, b, c, d] in nodes.quads() {
        for triangle in [[a, b, c], [a, c, d], [a, b, d], [b, c, d]] {
            for i in 0..3 {
                let [p, q, r] = [i, i + 1, i + 2].map(|j| triangle[j % 3]);
                let [from, to] = [q, r].map(|v| shape[v as usize] - shape[p as usize]);
                let doubled = from.cross(&to).norm();
                let cotangent = from.dot(&to) / doubled.max(f64::MIN_POSITIVE);
                let weight = cotangent.clamp(COTANGENT[0], COTANGENT[1]);
                entries.extend([
                    (q, q, weight),
                    (r, r, weight),
                    (q.max(r), q.min(r), -weight),
                ]);
                areas[p as usize] += doubled;
            }
        }
    }
    let mut sorted = areas.clone();
    sorted.sort_unstable_by(f64::total_cmp);
    let least = (LEAST_AREA * sorted[sorted.len() / 2]).max(f64::MIN_POSITIVE);
    areas.iter_mut().for_each(|area| *area = area.max(least));
    let stiffness = SymmetricMatrix::from_lower_triplets(nodes.count(), &entries);
    (stiffness, areas)
}
