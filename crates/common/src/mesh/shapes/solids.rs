//! Solids of tetrahedra.

use nalgebra::Point3;

use crate::mesh::tet::TetMesh;

/// Order in which the axes are walked from the lowest corner of a cube to the highest: one
/// tetrahedron for each, the second half of them with its corners turned.
const WALKS: [[usize; 3]; 6] = [
    [0, 1, 2],
    [1, 2, 0],
    [2, 0, 1],
    [0, 2, 1],
    [1, 0, 2],
    [2, 1, 0],
];

/// Returns the box from the origin to `counts` as unit cubes of six tetrahedra each; all share the
/// diagonal of their cube. Vertices run along the first axis fastest.
///
/// # Panics
/// If a count is zero or the vertices are more than 32-bit ids name.
#[must_use]
pub fn box_solid(counts: [u32; 3]) -> TetMesh {
    assert!(counts.iter().all(|&n| n > 0), "at least one cube each way");
    let [nx, ny, nz] = counts;
    let id = |[i, j, k]: [u32; 3]| (k * (ny + 1) + j) * (nx + 1) + i;
    let mut positions = Vec::new();
    let mut cells = Vec::new();
    for k in 0..=nz {
        for j in 0..=ny {
            for i in 0..=nx {
                positions.push(Point3::from([i, j, k].map(f64::from)));
                if i == nx || j == ny || k == nz {
                    continue;
                }
                for (number, walk) in WALKS.iter().enumerate() {
                    let mut at = [i, j, k];
                    let mut corners = [id(at); 4];
                    for (step, &axis) in walk.iter().enumerate() {
                        at[axis] += 1;
                        corners[step + 1] = id(at);
                    }
                    if number >= 3 {
                        corners.swap(1, 2);
                    }
                    cells.push(corners);
                }
            }
        }
    }
    TetMesh::build(positions, cells).expect("a box of cubes is a solid")
}
