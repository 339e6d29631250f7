//! Cells that every map to the cube makes flat, split beforehand.
//!
//! An edge inside of the solid whose ends lie on one face of the cube cannot be mapped without
//! folds: its cells would have to fit around it into a half-space. The same holds for a triangle
//! inside whose sides all lie on the boundary. Their midpoints are inside, so that one pass is
//! enough.

use msplines_common::mesh::NONE;
use msplines_common::mesh::tet::{CELL_EDGES, TetMesh, TetTopology};

use crate::domain::split::split_tets;

/// A solid without cells that must become flat.
pub(super) struct Presplit {
    pub(super) mesh: TetMesh,
    pub(super) edges: usize,
    pub(super) faces: usize,
}

/// Splits what must become flat; `masks` gets an entry for each new vertex.
pub(super) fn presplit(mesh: &TetMesh, masks: &mut Vec<u8>) -> Presplit {
    let edges = edges_inside(mesh.topology(), masks);
    let mut result = Presplit {
        mesh: mesh.clone(),
        edges: edges.len(),
        faces: 0,
    };
    if !edges.is_empty() {
        result.mesh = split_tets(mesh, &edges);
        masks.resize(result.mesh.vertex_count(), 0);
    }
    let faces = faces_inside(result.mesh.topology(), masks);
    result.faces = faces.len();
    if !faces.is_empty() {
        result.mesh = split_tets(&result.mesh, &faces);
        masks.resize(result.mesh.vertex_count(), 0);
    }
    result
}

fn edges_inside(topology: &TetTopology, masks: &[u8]) -> Vec<Vec<u32>> {
    let mut outside = vec![false; topology.edges().len()];
    for &(cell, corner) in topology.boundary_faces() {
        for (edge, ends) in topology.cell_edges()[cell as usize]
            .into_iter()
            .zip(CELL_EDGES)
        {
            outside[edge as usize] |= !ends.contains(&usize::from(corner));
        }
    }
    let on_one_face = |&[a, b]: &[u32; 2]| masks[a as usize] & masks[b as usize] != 0;
    let edges = topology.edges().iter().zip(outside);
    edges
        .filter(|(edge, outside)| !outside && on_one_face(edge))
        .map(|(edge, _)| edge.to_vec())
        .collect()
}

fn faces_inside(topology: &TetTopology, masks: &[u8]) -> Vec<Vec<u32>> {
    let mut faces = Vec::new();
    for cell in 0..topology.cell_count() as u32 {
        for corner in 0..4 {
            let other = topology.neighbours()[cell as usize][corner];
            let face = topology.face(cell, corner);
            let shared = face
                .iter()
                .fold(u8::MAX, |mask, &v| mask & masks[v as usize]);
            if other != NONE && cell < other && shared != 0 {
                faces.push(face.to_vec());
            }
        }
    }
    faces
}

#[cfg(test)]
mod tests {
    use msplines_common::mesh::shapes::box_solid;

    use super::*;

    fn masks_of(mesh: &TetMesh, sides: [f64; 3]) -> Vec<u8> {
        let mask = |p: &nalgebra::Point3<f64>| {
            (0..3).fold(0, |mask, d| {
                mask | u8::from(p[d] == 0.0) << (2 * d) | u8::from(p[d] == sides[d]) << (2 * d + 1)
            })
        };
        mesh.positions().iter().map(mask).collect()
    }

    #[test]
    fn a_box_needs_no_splits() {
        let mesh = box_solid([3, 3, 3]);
        let mut masks = masks_of(&mesh, [3.0; 3]);
        let split = presplit(&mesh, &mut masks);
        assert_eq!((split.edges, split.faces), (0, 0));
        assert_eq!(split.mesh.cell_count(), mesh.cell_count());
    }

    /// With one face of the cube spread over three sides of the box, the edges between those are cut.
    #[test]
    fn no_cell_keeps_four_corners_on_one_face() {
        let mesh = box_solid([2, 2, 2]);
        let mut masks = masks_of(&mesh, [2.0; 3]);
        masks
            .iter_mut()
            .for_each(|mask| *mask = if *mask & 0b10_1010 == 0 { *mask } else { 1 });
        let split = presplit(&mesh, &mut masks);
        assert!(split.edges > 0);
        assert_eq!(masks.len(), split.mesh.vertex_count());
        assert!(split.mesh.not_positive().is_empty());
        for cell in split.mesh.cells() {
            assert_eq!(
                cell.iter()
                    .fold(u8::MAX, |mask, &v| mask & masks[v as usize]),
                0
            );
        }
        let again = presplit(&split.mesh, &mut masks);
        assert_eq!((again.edges, again.faces), (0, 0));
    }
}
