//! A triangle surface whose edges can be collapsed.

use nalgebra::{Point3, Vector3};

use crate::mesh::triangle::TriangleMesh;

/// How far a collapse may deform the faces around it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Tolerance {
    /// Normals turn by less than 80 degrees and no sliver appears.
    Strict,
    /// Normals turn by less than 90 degrees; slivers may appear.
    Loose,
}

impl Tolerance {
    /// Least cosine between old and new normal.
    fn cosine(self) -> f64 {
        match self {
            Self::Strict => 0.17,
            Self::Loose => 1e-3,
        }
    }

    /// Least quality of a new face, unless the old one was no better.
    fn quality(self) -> f64 {
        match self {
            Self::Strict => 0.02,
            Self::Loose => 1e-6,
        }
    }
}

/// Faces, and the faces around each vertex; a face that is gone has no corners listed anywhere.
pub(super) struct Surface {
    pub(super) positions: Vec<Point3<f64>>,
    /// Number of vertices left.
    pub(super) vertices: usize,
    faces: Vec<[u32; 3]>,
    around: Vec<Vec<u32>>,
    boundary: Vec<bool>,
    /// Whether a vertex is beside the one looked at; all false in between.
    marked: Vec<bool>,
}

impl Surface {
    pub(super) fn new(mesh: &TriangleMesh) -> Self {
        let topology = mesh.topology();
        let vertices = 0..mesh.vertex_count() as u32;
        Self {
            positions: mesh.positions().to_vec(),
            vertices: mesh.vertex_count(),
            faces: mesh.faces().to_vec(),
            around: vertices
                .clone()
                .map(|v| {
                    topology
                        .outgoing(v)
                        .map(|half_edge| half_edge / 3)
                        .collect()
                })
                .collect(),
            boundary: vertices.map(|v| topology.is_boundary_vertex(v)).collect(),
            marked: vec![false; mesh.vertex_count()],
        }
    }

    /// Returns the vertices beside a vertex, ascending.
    pub(super) fn neighbours(&self, vertex: u32) -> Vec<u32> {
        let faces = self.around[vertex as usize].iter();
        let mut ids: Vec<u32> = faces
            .flat_map(|&f| self.faces[f as usize])
            .filter(|&other| other != vertex)
            .collect();
        ids.sort_unstable();
        ids.dedup();
        ids
    }

    /// Returns all edges, the smaller vertex first.
    pub(super) fn edges(&self) -> impl Iterator<Item = [u32; 2]> {
        (0..self.around.len() as u32).flat_map(|a| {
            self.neighbours(a)
                .into_iter()
                .filter(move |&b| b > a)
                .map(move |b| [a, b])
        })
    }

    /// Merges the second vertex of an edge into the first at `position`; returns false, and does
    /// nothing, if that would change the topology or deform faces beyond the tolerance.
    pub(super) fn collapse(
        &mut self,
        [kept, gone]: [u32; 2],
        position: Point3<f64>,
        tolerance: Tolerance,
    ) -> bool {
        let shared: Vec<u32> = self.around[kept as usize]
            .iter()
            .copied()
            .filter(|&f| self.faces[f as usize].contains(&gone))
            .collect();
        if !self.link_condition([kept, gone], &shared) {
            return false;
        }
        if [kept, gone]
            .into_iter()
            .any(|v| self.deforms(v, &shared, position, tolerance))
        {
            return false;
        }
        for &face in &shared {
            for vertex in self.faces[face as usize] {
                self.around[vertex as usize].retain(|&f| f != face);
            }
        }
        let moved = std::mem::take(&mut self.around[gone as usize]);
        for &face in &moved {
            let corners = &mut self.faces[face as usize];
            *corners = corners.map(|v| if v == gone { kept } else { v });
        }
        self.around[kept as usize].extend(moved);
        self.boundary[kept as usize] |= self.boundary[gone as usize];
        self.positions[kept as usize] = position;
        self.vertices -= 1;
        true
    }

    /// Returns whether merging the ends of an edge keeps the surface the manifold it is: the ends
    /// have no common neighbours but the corners opposite to the edge, the edge is no chord of the
    /// boundary, and those corners keep enough faces.
    ///
    /// # Reference
    /// [Dey1999] link condition of a 2-complex.
    fn link_condition(&mut self, [a, b]: [u32; 2], shared: &[u32]) -> bool {
        let inner = shared.len() == 2;
        if inner && self.boundary[a as usize] && self.boundary[b as usize] {
            return false;
        }
        let opposite = shared.iter().flat_map(|&f| self.faces[f as usize]);
        let enough = opposite.filter(|&v| v != a && v != b).all(|v| {
            let least = if self.boundary[v as usize] { 2 } else { 4 };
            self.around[v as usize].len() >= least
        });
        enough && self.common_neighbours(a, b) == shared.len()
    }

    /// Returns the number of vertices beside both.
    fn common_neighbours(&mut self, a: u32, b: u32) -> usize {
        let (faces, marked) = (&self.faces, &mut self.marked);
        let beside = |v: u32| {
            let around = self.around[v as usize].iter();
            around
                .flat_map(|&f| faces[f as usize])
                .filter(move |&other| other != v)
        };
        beside(a).for_each(|v| marked[v as usize] = true);
        // Unmarking what is counted counts it once.
        let common = beside(b)
            .filter(|&v| std::mem::take(&mut marked[v as usize]))
            .count();
        beside(a).for_each(|v| marked[v as usize] = false);
        common
    }

    fn deforms(
        &self,
        vertex: u32,
        shared: &[u32],
        position: Point3<f64>,
        tolerance: Tolerance,
    ) -> bool {
        let faces = self.around[vertex as usize]
            .iter()
            .filter(|f| !shared.contains(f));
        faces.into_iter().any(|&face| {
            let corners = self.faces[face as usize];
            let old = corners.map(|v| self.positions[v as usize]);
            let new = std::array::from_fn(|i| {
                if corners[i] == vertex {
                    position
                } else {
                    old[i]
                }
            });
            let (before, after) = (normal(&old), normal(&new));
            let limit = tolerance.cosine() * before.norm() * after.norm();
            let turned = before.dot(&after) <= limit && before.norm_squared() > 0.0;
            let (was, is) = (quality(&old), quality(&new));
            turned || (is < tolerance.quality() && is <= was)
        })
    }

    /// Returns the remaining faces over renumbered vertices, and the former id of each.
    pub(super) fn compact(&self) -> (Vec<[u32; 3]>, Vec<u32>) {
        let ids = 0..self.around.len() as u32;
        let kept: Vec<u32> = ids
            .filter(|&v| !self.around[v as usize].is_empty())
            .collect();
        let mut number = vec![0; self.around.len()];
        for (id, &vertex) in kept.iter().enumerate() {
            number[vertex as usize] = id as u32;
        }
        let alive = |face: u32| {
            let first = self.faces[face as usize][0];
            self.around[first as usize].contains(&face)
        };
        let faces = (0..self.faces.len() as u32).filter(|&f| alive(f));
        let renumbered = faces.map(|f| self.faces[f as usize].map(|v| number[v as usize]));
        (renumbered.collect(), kept)
    }
}

fn normal([a, b, c]: &[Point3<f64>; 3]) -> Vector3<f64> {
    (b - a).cross(&(c - a))
}

/// Returns twice the area over the sum of squared sides: 0.29 for equal sides, 0 on a line.
fn quality(corners: &[Point3<f64>; 3]) -> f64 {
    let [a, b, c] = corners;
    let sides = (b - a).norm_squared() + (c - b).norm_squared() + (a - c).norm_squared();
    if sides > 0.0 {
        normal(corners).norm() / sides
    } else {
        0.0
    }
}
