//! Paths made fair before they become edges of the cube.
//!
//! A path along edges of the mesh zigzags, and a spline would follow it. Its vertices are moved
//! towards the middles of their neighbours on the path, along the surface; vertices around them give
//! way. No move makes the worst cell at a vertex worse than [`GOOD`], unless it was.

use msplines_common::mesh::NONE;
use msplines_common::mesh::tet::{TetMesh, signed_volume};
use msplines_common::metrics::SurfaceTree;
use nalgebra::{Point3, center};

/// Shape of a cell, 1 for a regular one, that a move may make: of the volume against the mean square
/// edge.
const GOOD: f64 = 0.2;

/// Shares of the way to where a vertex should be that are tried.
const SHARES: [f64; 3] = [1.0, 0.5, 0.2];

/// Edges from a path within which vertices give way.
const RINGS: usize = 3;

/// Returns the mesh with fair paths, which name vertices of the boundary.
pub(super) fn fair(mesh: &TetMesh, paths: &[Vec<u32>; 12], rounds: u32) -> TetMesh {
    let mut fairing = Fairing::new(mesh);
    let around = fairing.around(paths);
    for _ in 0..rounds {
        for path in paths {
            for at in path.windows(3) {
                let [from, to] = [at[0], at[2]].map(|v| fairing.positions[v as usize]);
                fairing.approach(at[1], center(&from, &to));
            }
        }
        for &vertex in &around {
            let middle = fairing.middle(vertex);
            fairing.approach(vertex, middle);
        }
    }
    mesh.with_positions(fairing.positions)
}

/// Vertices on their way.
struct Fairing<'a> {
    mesh: &'a TetMesh,
    tree: SurfaceTree,
    surface: msplines_common::mesh::TriangleMesh,
    neighbours: Vec<Vec<u32>>,
    positions: Vec<Point3<f64>>,
}

impl<'a> Fairing<'a> {
    fn new(mesh: &'a TetMesh) -> Self {
        let surface = mesh.boundary();
        let mut neighbours = vec![Vec::new(); mesh.vertex_count()];
        for &[a, b] in mesh.topology().edges() {
            neighbours[a as usize].push(b);
            neighbours[b as usize].push(a);
        }
        Self {
            tree: SurfaceTree::build(&surface),
            surface,
            neighbours,
            positions: mesh.positions().to_vec(),
            mesh,
        }
    }

    fn is_outside(&self, vertex: u32) -> bool {
        self.mesh.topology().boundary_vertex(vertex) != NONE
    }

    /// The vertices near to paths that are on none, ascending.
    fn around(&self, paths: &[Vec<u32>; 12]) -> Vec<u32> {
        let mut ring = vec![usize::MAX; self.positions.len()];
        let mut front: Vec<u32> = paths.iter().flatten().copied().collect();
        front.iter().for_each(|&v| ring[v as usize] = 0);
        for distance in 1..=RINGS {
            let mut next = Vec::new();
            for &vertex in &front {
                for &other in &self.neighbours[vertex as usize] {
                    if ring[other as usize] == usize::MAX {
                        ring[other as usize] = distance;
                        next.push(other);
                    }
                }
            }
            front = next;
        }
        let near = (0..ring.len() as u32).filter(|&v| (1..=RINGS).contains(&ring[v as usize]));
        near.collect()
    }

    /// The mean of a vertex's neighbours, of those on the boundary if it is on it.
    fn middle(&self, vertex: u32) -> Point3<f64> {
        let outside = self.is_outside(vertex);
        let neighbours = self.neighbours[vertex as usize].iter();
        let counted = neighbours.filter(|&&v| !outside || self.is_outside(v));
        let (mut sum, mut count) = (nalgebra::Vector3::zeros(), 0.0);
        for &other in counted {
            sum += self.positions[other as usize].coords;
            count += 1.0;
        }
        Point3::from(sum / count)
    }

    /// Moves a vertex towards a place, as far as its cells allow.
    fn approach(&mut self, vertex: u32, place: Point3<f64>) {
        let here = self.positions[vertex as usize];
        let least = self.worst(vertex).min(GOOD);
        for share in SHARES {
            let mut there = here + (place - here) * share;
            if self.is_outside(vertex)
                && let Some(closest) = self.tree.closest(&there)
            {
                there = self.surface.position(closest.point);
            }
            self.positions[vertex as usize] = there;
            if self.worst(vertex) >= least {
                return;
            }
        }
        self.positions[vertex as usize] = here;
    }

    /// Shape of the worst cell at a vertex.
    fn worst(&self, vertex: u32) -> f64 {
        let topology = self.mesh.topology();
        let cells = topology.vertex_cells(vertex).iter();
        let shapes = cells.map(|&cell| {
            let corners = self.mesh.cells()[cell as usize];
            shape(&corners.map(|v| self.positions[v as usize]))
        });
        shapes.fold(f64::INFINITY, f64::min)
    }
}

/// Volume against the mean square edge, 1 for a regular tetrahedron; negative if it is inverted.
fn shape(corners: &[Point3<f64>; 4]) -> f64 {
    let mut squares = 0.0;
    for first in 0..4 {
        for second in 0..first {
            squares += (corners[first] - corners[second]).norm_squared();
        }
    }
    let mean = squares / 6.0;
    signed_volume(corners) * 72f64.sqrt() / (mean * mean.sqrt())
}
