//! What cells share: faces, edges and vertices, in flat arrays.

use super::cell::{CELL_EDGES, CELL_FACES};
use crate::mesh::disjoint_sets::DisjointSets;

/// A face as one cell has it.
#[derive(Clone, Copy, Debug)]
pub(super) struct FaceUse {
    /// Its vertices, ascending.
    pub(super) vertices: [u32; 3],
    /// The cell.
    pub(super) cell: u32,
    /// The corner of the cell that the face is opposite to.
    pub(super) corner: u8,
    /// Whether the cell runs around it against the ascending order, seen from outside.
    pub(super) reversed: bool,
}

/// Returns the faces of all cells, those with the same vertices one after another, in O(n).
///
/// The corners of a cell must be vertices below `vertex_count`, and differ.
pub(super) fn face_uses(vertex_count: usize, cells: &[[u32; 4]]) -> Vec<FaceUse> {
    let uses = || {
        cells.iter().enumerate().flat_map(|(cell, corners)| {
            CELL_FACES
                .iter()
                .enumerate()
                .map(move |(corner, face)| face_use(cell as u32, corner as u8, face, corners))
        })
    };
    let offsets = offsets(vertex_count, uses().map(|face| face.vertices[0]));
    let mut places = offsets.clone();
    let nothing = FaceUse {
        vertices: [0; 3],
        cell: 0,
        corner: 0,
        reversed: false,
    };
    let mut sorted = vec![nothing; 4 * cells.len()];
    for face in uses() {
        let place = &mut places[face.vertices[0] as usize];
        sorted[*place as usize] = face;
        *place += 1;
    }
    // A vertex is the smallest one of few faces.
    for ends in offsets.windows(2) {
        sorted[ends[0] as usize..ends[1] as usize]
            .sort_by_key(|face| (face.vertices[1], face.vertices[2]));
    }
    sorted
}

fn face_use(cell: u32, corner: u8, face: &[usize; 3], corners: &[u32; 4]) -> FaceUse {
    let [mut a, mut b, mut c] = face.map(|i| corners[i]);
    let mut reversed = false;
    for (x, y) in [(0, 1), (1, 2), (0, 1)] {
        let mut vertices = [a, b, c];
        if vertices[x] > vertices[y] {
            vertices.swap(x, y);
            reversed = !reversed;
        }
        [a, b, c] = vertices;
    }
    FaceUse {
        vertices: [a, b, c],
        cell,
        corner,
        reversed,
    }
}

/// Returns where the items of each key start in an array sorted by key, and its length.
pub(super) fn offsets(keys: usize, items: impl Iterator<Item = u32>) -> Vec<u32> {
    let mut offsets = vec![0u32; keys + 1];
    for key in items {
        offsets[key as usize + 1] += 1;
    }
    for key in 0..keys {
        offsets[key + 1] += offsets[key];
    }
    offsets
}

/// Returns the cells of each vertex, ascending, as offsets and items.
pub(super) fn vertex_cells(vertex_count: usize, cells: &[[u32; 4]]) -> (Vec<u32>, Vec<u32>) {
    let starts = offsets(vertex_count, cells.iter().flatten().copied());
    let mut places = starts.clone();
    let mut items = vec![0u32; 4 * cells.len()];
    for (cell, corners) in cells.iter().enumerate() {
        for &vertex in corners {
            items[places[vertex as usize] as usize] = cell as u32;
            places[vertex as usize] += 1;
        }
    }
    (starts, items)
}

/// Returns all edges, ascending, and those of each cell.
pub(super) fn edges(vertex_count: usize, cells: &[[u32; 4]]) -> (Vec<[u32; 2]>, Vec<[u32; 6]>) {
    let ends = |corners: &[u32; 4], [i, j]: [usize; 2]| {
        let (a, b) = (corners[i], corners[j]);
        [a.min(b), a.max(b)]
    };
    let lows = cells
        .iter()
        .flat_map(|corners| CELL_EDGES.map(|edge| ends(corners, edge)[0]));
    let starts = offsets(vertex_count, lows);
    let mut places = starts.clone();
    let mut uses = vec![(0u32, 0u32); 6 * cells.len()];
    for (cell, corners) in cells.iter().enumerate() {
        for (local, edge) in CELL_EDGES.into_iter().enumerate() {
            let [low, high] = ends(corners, edge);
            let place = &mut places[low as usize];
            uses[*place as usize] = (high, (6 * cell + local) as u32);
            *place += 1;
        }
    }
    let mut edges = Vec::with_capacity(cells.len() * 5 / 4 + vertex_count);
    let mut cell_edges = vec![[0; 6]; cells.len()];
    for (low, range) in starts.windows(2).enumerate() {
        let uses = &mut uses[range[0] as usize..range[1] as usize];
        uses.sort_unstable();
        for same in uses.chunk_by(|a, b| a.0 == b.0) {
            for &(_, place) in same {
                cell_edges[place as usize / 6][place as usize % 6] = edges.len() as u32;
            }
            edges.push([low as u32, same[0].0]);
        }
    }
    (edges, cell_edges)
}

/// Returns the component of each cell, numbered by first cell; cells that share a face are in one.
pub(super) fn cell_components(vertex_count: usize, cells: &[(u32, [u32; 4])]) -> Vec<u32> {
    let corners: Vec<[u32; 4]> = cells.iter().map(|&(_, corners)| corners).collect();
    let mut sets = DisjointSets::new(cells.len());
    for same in face_uses(vertex_count, &corners).chunk_by(|a, b| a.vertices == b.vertices) {
        for other in &same[1..] {
            sets.join(same[0].cell, other.cell, false);
        }
    }
    let mut labels: Vec<u32> = Vec::with_capacity(cells.len());
    let mut count = 0;
    for cell in 0..cells.len() as u32 {
        // The root of a set is its smallest element, so it has its label already.
        let label = match sets.root(cell) {
            root if root == cell => {
                count += 1;
                count - 1
            }
            root => labels[root as usize],
        };
        labels.push(label);
    }
    labels
}
