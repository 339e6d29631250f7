//! Decimation by edge collapses in the order of quadric errors.

mod quadric;
mod surface;

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use nalgebra::Point3;

use self::quadric::Quadric;
use self::surface::{Surface, Tolerance};
use super::triangle::TriangleMesh;

/// A mesh with fewer vertices.
#[derive(Clone, Debug)]
pub struct Decimated {
    /// The mesh.
    pub mesh: TriangleMesh,
    /// For each of its vertices the smallest of the input vertices merged into it, ascending.
    pub vertex_origin: Vec<u32>,
}

/// Why a mesh cannot be decimated.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DecimateError {
    /// More vertices are asked for than there are.
    #[error(
        "{target} vertices are asked for, but the mesh has only {vertices}; ask for fewer, or subdivide first"
    )]
    TooMany {
        /// Vertices asked for.
        target: usize,
        /// Vertices of the mesh.
        vertices: usize,
    },
    /// No edge can be collapsed any more without changing the topology or folding the surface.
    #[error(
        "decimation to {target} vertices came to a stop at {reached}: no edge can go without changing the topology or folding the surface; ask for at least {reached}"
    )]
    Stalled {
        /// Vertices asked for.
        target: usize,
        /// Vertices reached.
        reached: usize,
    },
}

/// Share of the squared edge length in the cost of a collapse. Small enough to matter only where
/// the surface is flat and the quadrics vanish, where it keeps triangles round.
const EVENNESS: f64 = 1e-6;

/// Returns the mesh decimated to exactly `target_vertices`.
///
/// Edges collapse in the order of their quadric error, ties by vertex ids, if the link condition
/// holds and no face turns over or becomes a sliver; so genus, boundary loops and components stay.
/// Boundaries are held by quadrics of planes across them. Quadrics are taken relative to the centre
/// of the bounding box. Cost: O(n log n).
///
/// # Reference
/// [Garland1997] §4-§6. Deviation: planes are weighted by area, and a small share of the edge
/// length is added to the cost.
///
/// # Errors
/// If the mesh has fewer vertices, or no edge can be collapsed any more; the error says at how many.
pub fn decimate(mesh: &TriangleMesh, target_vertices: usize) -> Result<Decimated, DecimateError> {
    decimate_evenly(mesh, target_vertices, EVENNESS)
}

/// As [`decimate`], with the share of the edge length given: about 1 makes edges equally long
/// rather than errors small.
pub(super) fn decimate_evenly(
    mesh: &TriangleMesh,
    target: usize,
    evenness: f64,
) -> Result<Decimated, DecimateError> {
    let vertices = mesh.vertex_count();
    if target > vertices {
        return Err(DecimateError::TooMany { target, vertices });
    }
    if target == vertices {
        let vertex_origin = (0..vertices as u32).collect();
        return Ok(Decimated {
            mesh: mesh.clone(),
            vertex_origin,
        });
    }
    let mut run = Run::new(mesh, evenness);
    // What is refused at first may be possible once its surroundings have changed, and what makes
    // a narrow triangle may be better than no collapse at all.
    for tolerance in [
        Tolerance::Strict,
        Tolerance::Strict,
        Tolerance::Loose,
        Tolerance::Loose,
    ] {
        run.collapse_until(target, tolerance);
    }
    if run.surface.vertices > target {
        return Err(DecimateError::Stalled {
            target,
            reached: run.surface.vertices,
        });
    }
    Ok(run.finish(mesh))
}

/// A collapse to be tried; the least costly, and among equals that of the smallest ids, is greatest.
#[derive(PartialEq)]
struct Candidate {
    cost: f64,
    ends: [u32; 2],
    /// Sum of the stamps of the ends, which only grow: if it differs, the candidate is out of date.
    stamp: u32,
}

impl Eq for Candidate {}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        let (one, two) = ((self.ends, self.stamp), (other.ends, other.stamp));
        other.cost.total_cmp(&self.cost).then(two.cmp(&one))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

struct Run {
    surface: Surface,
    quadrics: Vec<Quadric>,
    stamps: Vec<u32>,
    evenness: f64,
    centre: Point3<f64>,
    diagonal: f64,
}

impl Run {
    fn new(mesh: &TriangleMesh, evenness: f64) -> Self {
        let [low, high] = mesh.bounding_box();
        let centre = nalgebra::center(&low, &high);
        let diagonal = mesh.diagonal().max(f64::MIN_POSITIVE);
        let positions = mesh
            .positions()
            .iter()
            .map(|p| Point3::from((p - centre) / diagonal));
        let unit = mesh.with_positions(positions.collect());
        let quadrics = quadric::of_vertices(&unit);
        let stamps = vec![0; quadrics.len()];
        Self {
            surface: Surface::new(&unit),
            quadrics,
            stamps,
            evenness,
            centre,
            diagonal,
        }
    }

    fn collapse_until(&mut self, target: usize, tolerance: Tolerance) {
        let mut queue: BinaryHeap<Candidate> = self
            .surface
            .edges()
            .map(|ends| self.candidate(ends))
            .collect();
        while self.surface.vertices > target {
            let Some(next) = queue.pop() else { return };
            if next.stamp != self.stamp(next.ends) {
                continue;
            }
            // Computing the place again is cheaper than keeping it in the queue.
            let (_, position) = self.cost(next.ends);
            if !self.surface.collapse(next.ends, position, tolerance) {
                continue;
            }
            let [kept, gone] = next.ends.map(|v| v as usize);
            let merged = self.quadrics[kept] + self.quadrics[gone];
            self.quadrics[kept] = merged;
            self.stamps[kept] += 1;
            self.stamps[gone] += 1;
            for neighbour in self.surface.neighbours(next.ends[0]) {
                let ends = [next.ends[0].min(neighbour), next.ends[0].max(neighbour)];
                queue.push(self.candidate(ends));
            }
        }
    }

    fn candidate(&self, ends: [u32; 2]) -> Candidate {
        Candidate {
            cost: self.cost(ends).0,
            ends,
            stamp: self.stamp(ends),
        }
    }

    fn stamp(&self, [a, b]: [u32; 2]) -> u32 {
        self.stamps[a as usize] + self.stamps[b as usize]
    }

    /// Returns the cost of collapsing an edge and the place of the vertex that remains.
    fn cost(&self, ends: [u32; 2]) -> (f64, Point3<f64>) {
        let [a, b] = ends.map(|v| self.surface.positions[v as usize]);
        let sum = self.quadrics[ends[0] as usize] + self.quadrics[ends[1] as usize];
        let (error, position) = sum.best_position(a, b);
        let squared = (b - a).norm_squared();
        (error + self.evenness * squared * squared, position)
    }

    fn finish(self, mesh: &TriangleMesh) -> Decimated {
        let (faces, vertex_origin) = self.surface.compact();
        // A vertex that nothing was merged into keeps the very bits of its position.
        let place = |&v: &u32| match self.stamps[v as usize] {
            0 => mesh.positions()[v as usize],
            _ => self.centre + self.surface.positions[v as usize].coords * self.diagonal,
        };
        let positions = vertex_origin.iter().map(place).collect();
        let mesh = TriangleMesh::build(positions, faces)
            .expect("collapses under the link condition keep a manifold");
        Decimated {
            mesh,
            vertex_origin,
        }
    }
}

#[cfg(test)]
mod tests;
