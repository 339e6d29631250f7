//! Six patches between twelve paths, and which face of the cube each is.

use msplines_common::mesh::{NONE, Topology};

use super::error::BoundaryError;
use crate::domain::cube::{corner_mask, edge_mask, edge_sides};

/// A face whose patch is not known yet.
const UNKNOWN: u8 = u8::MAX;

/// Returns, for every triangle, the face of the cube whose patch it belongs to.
///
/// What lies to the left of a path must be the face to the left of its edge, and each patch a disc.
pub(super) fn label(topology: &Topology, paths: &[Vec<u32>; 12]) -> Result<Vec<u8>, BoundaryError> {
    let mut labels = vec![UNKNOWN; topology.face_count()];
    let mut walls = vec![false; topology.edge_count()];
    for (edge, path) in paths.iter().enumerate() {
        let sides = edge_sides(edge);
        for step in path.windows(2) {
            let half_edge = topology
                .outgoing(step[0])
                .find(|&h| topology.target(h) == step[1])
                .ok_or(BoundaryError::NotCube {
                    face: sides[0],
                    vertex: step[0],
                })?;
            walls[topology.edge(half_edge) as usize] = true;
            for (half_edge, face) in [half_edge, topology.twin(half_edge)].into_iter().zip(sides) {
                set(&mut labels, topology, half_edge / 3, face as u8)?;
            }
        }
    }
    flood(&mut labels, topology, &walls)?;
    check_discs(&labels, topology)?;
    Ok(labels)
}

fn set(labels: &mut [u8], topology: &Topology, face: u32, label: u8) -> Result<(), BoundaryError> {
    let old = std::mem::replace(&mut labels[face as usize], label);
    if old == UNKNOWN || old == label {
        return Ok(());
    }
    let vertex = topology.faces()[face as usize][0];
    Err(BoundaryError::NotCube {
        face: label.into(),
        vertex,
    })
}

fn flood(labels: &mut [u8], topology: &Topology, walls: &[bool]) -> Result<(), BoundaryError> {
    let known = (0..labels.len() as u32).filter(|&face| labels[face as usize] != UNKNOWN);
    let mut stack: Vec<u32> = known.collect();
    while let Some(face) = stack.pop() {
        for half_edge in 3 * face..3 * face + 3 {
            let twin = topology.twin(half_edge);
            if walls[topology.edge(half_edge) as usize] || twin == NONE {
                continue;
            }
            if labels[(twin / 3) as usize] == UNKNOWN {
                stack.push(twin / 3);
            }
            set(labels, topology, twin / 3, labels[face as usize])?;
        }
    }
    match labels.iter().position(|&label| label == UNKNOWN) {
        None => Ok(()),
        Some(face) => {
            let vertex = topology.faces()[face][0];
            Err(BoundaryError::NotCube { face: 0, vertex })
        }
    }
}

/// Checks that each patch, with its border, has the Euler characteristic of a disc.
fn check_discs(labels: &[u8], topology: &Topology) -> Result<(), BoundaryError> {
    let mut euler = [0i64; 6];
    let mut first = [0u32; 6];
    let mut add = |mask: u8, sign: i64| {
        (0..6)
            .filter(|face| mask >> face & 1 == 1)
            .for_each(|face| euler[face] += sign);
    };
    for (face, &label) in labels.iter().enumerate() {
        add(1 << label, 1);
        first[usize::from(label)] = topology.faces()[face][0];
    }
    for edge in 0..topology.edge_count() as u32 {
        let half_edge = topology.edge_half_edge(edge);
        let sides = [half_edge, topology.twin(half_edge)];
        add(
            sides
                .iter()
                .fold(0, |mask, &h| mask | 1 << labels[(h / 3) as usize]),
            -1,
        );
    }
    for vertex in 0..topology.vertex_count() as u32 {
        let around = topology.outgoing(vertex);
        add(
            around.fold(0, |mask, h| mask | 1 << labels[(h / 3) as usize]),
            1,
        );
    }
    match euler.iter().position(|&characteristic| characteristic != 1) {
        None => Ok(()),
        Some(face) => Err(BoundaryError::NotCube {
            face,
            vertex: first[face],
        }),
    }
}

/// Returns the faces of the cube that every vertex lies on.
pub(super) fn masks(
    topology: &Topology,
    labels: &[u8],
    corners: &[u32; 8],
    paths: &[Vec<u32>; 12],
) -> Vec<u8> {
    let mut masks = vec![0; topology.vertex_count()];
    for (face, &label) in topology.faces().iter().zip(labels) {
        face.iter()
            .for_each(|&vertex| masks[vertex as usize] = 1 << label);
    }
    for (edge, path) in paths.iter().enumerate() {
        path.iter()
            .for_each(|&vertex| masks[vertex as usize] = edge_mask(edge));
    }
    for (corner, &vertex) in corners.iter().enumerate() {
        masks[vertex as usize] = corner_mask(corner);
    }
    masks
}

/// Returns the edges that join two vertices of one path without belonging to it: a map to the cube
/// would make the triangles between them flat.
pub(super) fn chords(topology: &Topology, paths: &[Vec<u32>; 12]) -> Vec<[u32; 2]> {
    let mut chords = Vec::new();
    let mut place = vec![NONE; topology.vertex_count()];
    for path in paths {
        path.iter()
            .zip(0..)
            .for_each(|(&vertex, at)| place[vertex as usize] = at);
        for &vertex in path {
            let here = place[vertex as usize];
            let farther = topology
                .neighbours(vertex)
                .filter(|&other| place[other as usize] != NONE && place[other as usize] > here + 1);
            chords.extend(farther.map(|other| [vertex, other]));
        }
        path.iter()
            .for_each(|&vertex| place[vertex as usize] = NONE);
    }
    chords.sort_unstable();
    chords
}
