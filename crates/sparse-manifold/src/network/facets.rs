//! Where a surface folds, or turns more sharply than its tessellation can show.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use super::domain::NetworkDomain;
use super::nodes::{Nodes, is_crease};
use crate::numbers::Numbers;
use crate::tessellate::Tessellation;

/// Angle between neighbouring facets from which they count as sharp, in degrees.
const SHARP: f64 = 60.0;

/// How neighbouring facets of a tessellation meet away from creases.
#[derive(Default)]
pub(super) struct Facets {
    /// The largest angle between two, in degrees.
    pub largest: f64,
    /// How many pairs meet at more than 60 degrees.
    pub sharp: usize,
    /// The faces of the domain with such pairs, the largest angle first.
    pub faces: Vec<(f64, u32)>,
}

impl Facets {
    /// Measures a tessellation that has the nodes as its positions.
    pub(super) fn of(surface: &Tessellation, domain: &NetworkDomain, nodes: &Nodes) -> Self {
        let creases = crease_lines(domain, nodes.cells);
        let place = |i: u32| surface.positions[i as usize];
        let per_face = 2 * nodes.cells.pow(2) as usize;
        let mut waiting: BTreeMap<[u32; 2], (usize, Vector3<f64>)> = BTreeMap::new();
        let mut found = Self::default();
        let mut worst: BTreeMap<u32, f64> = BTreeMap::new();
        for (t, triangle) in surface.triangles.iter().enumerate() {
            let [a, b, c] = triangle.map(place);
            let normal = (b - a).cross(&(c - a));
            for i in 0..3 {
                let side = sorted(triangle[i], triangle[(i + 1) % 3]);
                let Some((other, before)) = waiting.remove(&side) else {
                    waiting.insert(side, (t, normal));
                    continue;
                };
                if creases.binary_search(&side).is_ok() {
                    continue;
                }
                let angle = normal.angle(&before).to_degrees();
                found.largest = found.largest.max(angle);
                if angle > SHARP {
                    found.sharp += 1;
                    for face in [t, other].map(|t| (t / per_face) as u32) {
                        let most = worst.entry(face).or_default();
                        *most = most.max(angle);
                    }
                }
            }
        }
        found.faces = worst
            .into_iter()
            .map(|(face, angle)| (angle, face))
            .collect();
        found
            .faces
            .sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        found
    }
}

/// Returns the sides of facets along creases, sorted.
fn crease_lines(domain: &NetworkDomain, cells: u32) -> Vec<[u32; 2]> {
    let topology = &**domain.mesh.topology();
    let numbers = Numbers { topology, cells };
    let edges = 0..topology.edge_count() as u32;
    let creases = edges.filter(|&edge| is_crease(domain, edge));
    let along = creases.flat_map(|edge| {
        let h = topology.edge_half_edge(edge);
        let at = |step: u32| numbers.on_edge(h, step);
        (0..cells)
            .map(move |step| sorted(at(step), at(step + 1)))
            .collect::<Vec<_>>()
    });
    let mut lines: Vec<[u32; 2]> = along.collect();
    lines.sort_unstable();
    lines
}

fn sorted(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}
