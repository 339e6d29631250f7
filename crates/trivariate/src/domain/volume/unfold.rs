//! Folds of a map of a solid, removed around where they are.
//!
//! Only cells within a few rings of a bad one move, boundary vertices along their face or edge of
//! the cube. What is around stays, so that shapes at rest are scaled to the room there is.

use msplines_common::mesh::NONE;
use msplines_common::mesh::tet::TetMesh;

use super::foldover::Shape;
use super::measure::bad_cells;
use super::part::Part;

/// Rings around bad cells and the form of the energy, round after round.
const CYCLE: [(u32, Shape); 16] = [
    (3, Shape::Cubic),
    (2, Shape::Cubic),
    (4, Shape::Quadratic),
    (3, Shape::Quadratic),
    (2, Shape::Quadratic),
    (5, Shape::Cubic),
    (4, Shape::Cubic),
    (6, Shape::Quadratic),
    (8, Shape::Cubic),
    (8, Shape::Quadratic),
    (12, Shape::Cubic),
    (12, Shape::Quadratic),
    (3, Shape::Cubic),
    (2, Shape::Quadratic),
    (16, Shape::Cubic),
    (16, Shape::Quadratic),
];

/// How far folds have been removed.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Unfolded {
    pub(super) rounds: u32,
    pub(super) evaluations: u64,
    /// Evaluations of single cells.
    pub(super) cell_evaluations: u64,
}

/// Removes cells that are inverted or whose determinant is not above `least`.
pub(super) fn unfold(
    mesh: &TetMesh,
    masks: &[u8],
    parameters: &mut [[f64; 3]],
    least: f64,
    limits: [u32; 2],
    go_on: &mut dyn FnMut(u32, usize) -> bool,
) -> Unfolded {
    let [rounds, evaluations] = limits;
    let mut done = Unfolded::default();
    for (round, (rings, shape)) in (0..rounds).zip(CYCLE.into_iter().cycle()) {
        let bad = bad_cells(mesh, parameters, least);
        if bad.is_empty() || !go_on(round, bad.len()) {
            break;
        }
        done.rounds += 1;
        for cells in surroundings(mesh, &bad, rings) {
            if let Some(mut part) = Part::new(mesh, masks, parameters, &cells) {
                let used = part.unfold(shape, least * part.scale, evaluations as usize);
                done.evaluations += used as u64;
                done.cell_evaluations += (used * cells.len()) as u64;
                part.write_back(parameters);
            }
        }
    }
    done
}

/// Returns the cells within some rings of bad ones, by parts that share faces.
fn surroundings(mesh: &TetMesh, bad: &[u32], rings: u32) -> Vec<Vec<u32>> {
    let topology = mesh.topology();
    let mut near = vec![false; mesh.cell_count()];
    bad.iter().for_each(|&cell| near[cell as usize] = true);
    let mut front: Vec<u32> = bad.to_vec();
    for _ in 0..rings {
        let mut next = Vec::new();
        for &vertex in front.iter().flat_map(|&cell| &mesh.cells()[cell as usize]) {
            for &cell in topology.vertex_cells(vertex) {
                if !std::mem::replace(&mut near[cell as usize], true) {
                    next.push(cell);
                }
            }
        }
        front = next;
    }
    let mut parts = Vec::new();
    for seed in 0..mesh.cell_count() as u32 {
        if !std::mem::take(&mut near[seed as usize]) {
            continue;
        }
        let mut part = vec![seed];
        let mut at = 0;
        while at < part.len() {
            for other in topology.neighbours()[part[at] as usize] {
                if other != NONE && std::mem::take(&mut near[other as usize]) {
                    part.push(other);
                }
            }
            at += 1;
        }
        part.sort_unstable();
        parts.push(part);
    }
    parts
}
