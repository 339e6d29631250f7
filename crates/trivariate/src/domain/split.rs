//! Edges and faces of meshes split at their midpoints.

use msplines_common::mesh::TriangleMesh;
use msplines_common::mesh::tet::TetMesh;
use nalgebra::{Point3, center};

/// Cells of `N` corners that can be split, with the cells of every vertex.
struct Cells<const N: usize> {
    cells: Vec<[u32; N]>,
    of_vertex: Vec<Vec<u32>>,
}

impl<const N: usize> Cells<N> {
    fn new(vertices: usize, cells: &[[u32; N]]) -> Self {
        let mut of_vertex = vec![Vec::new(); vertices];
        for (cell, corners) in cells.iter().enumerate() {
            for &vertex in corners {
                of_vertex[vertex as usize].push(cell as u32);
            }
        }
        let cells = cells.to_vec();
        Self { cells, of_vertex }
    }

    /// Splits all cells that have these vertices into one for each of them, about a new vertex.
    fn split(&mut self, vertices: &[u32]) {
        let middle = self.of_vertex.len() as u32;
        let has_all = |&cell: &u32| {
            let corners = &self.cells[cell as usize];
            vertices.iter().all(|vertex| corners.contains(vertex))
        };
        let around: Vec<u32> = self.of_vertex[vertices[0] as usize]
            .iter()
            .copied()
            .filter(has_all)
            .collect();
        self.of_vertex.push(Vec::new());
        for cell in around {
            let corners = self.cells[cell as usize];
            for (number, &replaced) in vertices.iter().enumerate() {
                let part = corners.map(|v| if v == replaced { middle } else { v });
                if number == 0 {
                    self.cells[cell as usize] = part;
                    self.of_vertex[replaced as usize].retain(|&other| other != cell);
                    self.of_vertex[middle as usize].push(cell);
                } else {
                    let id = self.cells.len() as u32;
                    self.cells.push(part);
                    part.iter()
                        .for_each(|&v| self.of_vertex[v as usize].push(id));
                }
            }
        }
    }
}

/// Adds the midpoints of these simplices, one after another: later ones may name them.
fn add_midpoints(positions: &mut Vec<Point3<f64>>, simplices: &[Vec<u32>]) {
    for simplex in simplices {
        let sum: nalgebra::Vector3<f64> =
            simplex.iter().map(|&v| positions[v as usize].coords).sum();
        positions.push(Point3::from(sum / simplex.len() as f64));
    }
}

/// Returns the mesh with edges (two vertices) or faces (three) split, one after another; each gives
/// the next vertex number to its middle. Cells that are not touched keep their numbers.
pub(crate) fn split_tets(mesh: &TetMesh, simplices: &[Vec<u32>]) -> TetMesh {
    let mut cells = Cells::new(mesh.vertex_count(), mesh.cells());
    simplices.iter().for_each(|simplex| cells.split(simplex));
    let mut positions = mesh.positions().to_vec();
    add_midpoints(&mut positions, simplices);
    TetMesh::build(positions, cells.cells).expect("split simplices keep a solid a solid")
}

/// Returns the surface with edges split, one after another; each gives the next vertex number to
/// its midpoint.
pub(crate) fn split_surface(surface: &TriangleMesh, edges: &[[u32; 2]]) -> TriangleMesh {
    let mut cells = Cells::new(surface.vertex_count(), surface.faces());
    let mut positions = surface.positions().to_vec();
    for edge in edges {
        cells.split(edge);
        let [a, b] = edge.map(|v| positions[v as usize]);
        positions.push(center(&a, &b));
    }
    TriangleMesh::build(positions, cells.cells).expect("split edges keep a surface a surface")
}

#[cfg(test)]
mod tests {
    use msplines_common::mesh::shapes::box_solid;

    use super::*;

    #[test]
    fn splits_keep_the_volume_and_every_orientation() {
        let mesh = box_solid([2, 2, 2]);
        // The diagonal of a cube, half of it again, a face inside, an edge of the boundary.
        let simplices = [vec![0, 13], vec![0, 27], vec![13, 10, 9], vec![0, 1]];
        let split = split_tets(&mesh, &simplices);
        split.topology().sanity_check();
        assert_eq!(split.vertex_count(), 31);
        assert!(split.not_positive().is_empty());
        let volume: f64 = (0..split.cell_count() as u32)
            .map(|c| split.signed_volume(c))
            .sum();
        assert!((volume - 8.0).abs() < 1e-14);
        assert_eq!(split.positions()[27], Point3::new(0.5, 0.5, 0.5));
    }

    #[test]
    fn a_surface_splits_like_the_boundary_of_its_solid() {
        let mesh = box_solid([1, 1, 1]);
        let surface = split_surface(&mesh.boundary(), &[[0, 1], [0, 8]]);
        let solid = split_tets(&mesh, &[vec![0, 1], vec![0, 8]]);
        let sorted = |mesh: &TriangleMesh| {
            let mut faces: Vec<[u32; 3]> = mesh.faces().to_vec();
            faces.iter_mut().for_each(|face| {
                let first = (0..3).min_by_key(|&i| face[i]).unwrap();
                face.rotate_left(first);
            });
            faces.sort_unstable();
            faces
        };
        assert_eq!(sorted(&surface), sorted(&solid.boundary()));
    }
}
