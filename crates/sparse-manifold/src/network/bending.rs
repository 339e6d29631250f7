//! How much a surface bends at its nodes: a thin plate on the grids of its patches.
//!
//! A second difference of nodes `h` apart measures a curvature times `h²`, so that those across a
//! narrow strip count for little beside those of the wide patches next to it: these would carry their
//! speed into the strip, which folds. Each is therefore divided by a power of `h`, as far apart as the
//! nodes are on the fill, or on the Coons patches of the curves.
//!
//! # Notation
//! A row is `(w, Σ f_i X_i)`; the energy is the sum of `w |Σ f_i X_i|²` over second differences along
//! both directions of the grids, and twice that over mixed ones.

use msplines_common::mesh::polygon::PolygonTopology;
use nalgebra::Vector3;

use super::fill::uniform_laplacian;
use super::nodes::Nodes;
use crate::domain::face_coordinates;

/// The power of the distance. With 2 the energy is free of scale, and narrow strips count so much that
/// curves around them are not followed; with 0 they fold.
const POWER: f64 = 1.5;

/// Bounds of a factor that distances lead to.
const FACTORS: [f64; 2] = [0.05, 1e4];

/// Least distance of nodes, of that on an edge of mean length.
const LEAST: f64 = 1e-3;

/// A weight, and nodes with their factors.
pub(super) type Row = (f64, Vec<(usize, f64)>);

/// Returns the rows of the energy. Differences at nodes where the surface does not bend, on creases,
/// the boundary and cones, do not count.
pub(super) fn bending_rows(
    topology: &PolygonTopology,
    nodes: &Nodes,
    shape: Option<&[Vector3<f64>]>,
) -> Vec<Row> {
    let mut rows = Rows {
        nodes,
        shape,
        list: Vec::new(),
    };
    for grid in &nodes.grids {
        rows.add_face(grid);
    }
    for edge in 0..topology.edge_count() as u32 {
        rows.add_edge(topology, edge);
    }
    let laplacian = uniform_laplacian(nodes);
    for v in 0..topology.vertex_count() as u32 {
        if topology.is_boundary_vertex(v) || !nodes.bends[v as usize] {
            continue;
        }
        let near: Vec<u32> = topology.spokes(v).map(|h| rows.node(h, [1, 0])).collect();
        if let [a, b, c, d] = near[..] {
            rows.add_line([a, v, c]);
            rows.add_line([b, v, d]);
        } else {
            let terms = laplacian.column(v as usize).collect();
            rows.list.push((1.0, terms));
        }
    }
    rows.list
}

struct Rows<'a> {
    nodes: &'a Nodes,
    shape: Option<&'a [Vector3<f64>]>,
    list: Vec<Row>,
}

impl Rows<'_> {
    /// Returns the node some steps along a half-edge and away from it.
    fn node(&self, h: u32, steps: [u32; 2]) -> u32 {
        let cells = f64::from(self.nodes.cells);
        let at = steps.map(|i| f64::from(i) / cells);
        let [column, row] = face_coordinates(h % 4, at).map(|c| (c * cells).round() as usize);
        self.nodes.grids[h as usize / 4][row * (self.nodes.cells as usize + 1) + column]
    }

    /// Returns what the least distance of pairs of nodes gives to a difference.
    fn factor<const N: usize>(&self, pairs: [[u32; 2]; N]) -> f64 {
        let Some(shape) = self.shape else { return 1.0 };
        let distance = |[a, b]: [u32; 2]| (shape[a as usize] - shape[b as usize]).norm();
        let least = pairs
            .map(distance)
            .into_iter()
            .fold(f64::INFINITY, f64::min);
        let steps = (least * f64::from(self.nodes.cells)).max(LEAST);
        steps.powf(-POWER).clamp(FACTORS[0], FACTORS[1])
    }

    fn add_line(&mut self, [a, b, c]: [u32; 3]) {
        if self.nodes.bends[b as usize] {
            let terms = [(a, 1.0), (b, -2.0), (c, 1.0)];
            let terms = terms.map(|(node, factor)| (node as usize, factor));
            let weight = self.factor([[a, b], [b, c]]);
            self.list.push((weight, terms.to_vec()));
        }
    }

    fn add_face(&mut self, grid: &[u32]) {
        let n = self.nodes.cells as usize;
        let at = |i: usize, j: usize| grid[j * (n + 1) + i];
        for (i, j) in (1..n).flat_map(|j| (1..n).map(move |i| (i, j))) {
            self.add_line([at(i - 1, j), at(i, j), at(i + 1, j)]);
            self.add_line([at(i, j - 1), at(i, j), at(i, j + 1)]);
        }
        for (i, j) in (0..n).flat_map(|j| (0..n).map(move |i| (i, j))) {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)];
            let weight = 2.0 * self.factor([[a, b], [a, c], [b, d], [c, d]]);
            let terms = [(a, 1.0), (b, -1.0), (c, -1.0), (d, 1.0)];
            let terms = terms.map(|(node, factor)| (node as usize, factor));
            self.list.push((weight, terms.to_vec()));
        }
    }

    /// Adds what is inside of an edge: along it, and across if the surface goes on smoothly.
    fn add_edge(&mut self, topology: &PolygonTopology, edge: u32) {
        if topology.is_boundary_edge(edge) {
            return;
        }
        let n = self.nodes.cells;
        let h = topology.edge_half_edge(edge);
        let twin = topology.twin(h);
        for i in 1..n {
            let here = self.node(h, [i, 0]);
            self.add_line([self.node(h, [i, 1]), here, self.node(twin, [n - i, 1])]);
            self.add_line([self.node(h, [i - 1, 0]), here, self.node(h, [i + 1, 0])]);
        }
    }
}
