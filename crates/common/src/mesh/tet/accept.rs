//! From a soup of tetrahedra to a mesh: refuse what is broken, or repair it.

use super::defect::TetDefect;
use super::mesh::TetMesh;
use super::preflight::{TetPreflight, checked_cell, drop_duplicates, orient, preflight};
use super::soup::TetSoup;
use super::topology::TetTopologyError;
use crate::mesh::accept::Policy;
use crate::mesh::defect::Remedy;
use crate::mesh::topology::NONE;

/// A tetrahedral mesh, and how it came from its soup.
#[derive(Clone, Debug)]
pub struct TetAccepted {
    /// The mesh; every cell is positive.
    pub mesh: TetMesh,
    /// What was done to the soup.
    pub repairs: Vec<TetRepair>,
    /// Input vertex of each vertex of the mesh.
    pub vertex_origin: Vec<u32>,
    /// Input cell of each cell of the mesh.
    pub cell_origin: Vec<u32>,
}

/// Something done to a soup.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TetRepair {
    /// All cells had their corners in the other order, as some programs write them.
    #[error("all {cells} tetrahedra had their corners in the other order, which was turned around")]
    TurnedAll {
        /// Number of cells.
        cells: usize,
    },
    /// Some cells had their corners in the other order.
    #[error(
        "the corners of {cells} inverted tetrahedra were put in order, first of tetrahedron {first}"
    )]
    TurnedSome {
        /// Number of cells.
        cells: usize,
        /// The first.
        first: u32,
    },
    /// Cells that could not be used were dropped.
    #[error("{cells} tetrahedra with unusable vertices were dropped, first tetrahedron {first}")]
    DroppedUnusable {
        /// Number of cells.
        cells: usize,
        /// The first.
        first: u32,
    },
    /// Copies of earlier cells were dropped.
    #[error("{cells} duplicate tetrahedra were dropped, first tetrahedron {first}")]
    DroppedDuplicates {
        /// Number of cells.
        cells: usize,
        /// The first.
        first: u32,
    },
    /// All components but the largest were dropped.
    #[error("{cells} tetrahedra of smaller components were dropped")]
    KeptLargestComponent {
        /// Number of cells dropped.
        cells: usize,
    },
    /// Vertices of no cell were dropped.
    #[error("{vertices} vertices of no tetrahedron were dropped, first vertex {first}")]
    DroppedVertices {
        /// Number of vertices.
        vertices: usize,
        /// The first.
        first: u32,
    },
}

/// Why a soup did not become a mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TetPreflightError {
    /// The soup has defects that the policy refuses or repair cannot mend.
    #[error("{}", refusal(.first, *.count))]
    Defects {
        /// The first defects.
        first: Vec<TetDefect>,
        /// How many there are.
        count: usize,
    },
    /// The cells do not fit together in a way that no single defect tells.
    #[error("the tetrahedra do not fill a solid: {0}; mesh it again, or give its surface alone")]
    Topology(#[from] TetTopologyError),
}

/// How many defects an error lists.
const LISTED: usize = 5;

/// Returns the mesh of a soup.
///
/// If every cell has its corners in the negative order, all are turned around under either policy.
/// [`Policy::Refuse`] keeps every vertex and cell and its id. [`Policy::Repair`] drops cells that
/// cannot be used and duplicates, turns inverted cells around, keeps the component of most cells and
/// drops unused vertices. Flat cells and cells that overlap are beyond repair: to drop them would
/// tear the mesh. Cost: O(n log n).
///
/// # Errors
/// The defects, if the policy refuses them or repair cannot mend them.
pub fn accept(soup: &TetSoup, policy: Policy) -> Result<TetAccepted, TetPreflightError> {
    let found = preflight(soup);
    let refused =
        |defect: &&TetDefect| policy == Policy::Refuse || defect.remedy() == Remedy::Author;
    let mut defects: Vec<_> = found.defects.iter().filter(refused).cloned().collect();
    if !defects.is_empty() && !mendable_by_dropping(&found, policy) {
        let count = defects.len();
        // What repair cannot mend comes first: it decides what the user has to do.
        defects.sort_by_key(|defect| defect.remedy() == Remedy::Repair);
        defects.truncate(LISTED);
        return Err(TetPreflightError::Defects {
            first: defects,
            count,
        });
    }
    build(soup, &found)
}

/// Returns whether defects beyond repair may lie in components that repair drops; what is kept is
/// then examined again.
fn mendable_by_dropping(found: &TetPreflight, policy: Policy) -> bool {
    policy == Policy::Repair && found.components.len() > 1
}

fn build(soup: &TetSoup, found: &TetPreflight) -> Result<TetAccepted, TetPreflightError> {
    let mut repairs = Vec::new();
    let mut cells = Vec::with_capacity(soup.cells.len());
    let mut unusable = Vec::new();
    for cell in 0..soup.cells.len() as u32 {
        match checked_cell(soup, cell) {
            Ok(Some(corners)) => cells.push((cell, corners)),
            _ => unusable.push(cell),
        }
    }
    if let Some(&first) = unusable.first() {
        let cells = unusable.len();
        repairs.push(TetRepair::DroppedUnusable { cells, first });
    }
    let mut log = TetPreflight::default();
    drop_duplicates(&mut cells, &mut log);
    if let Some(&TetDefect::DuplicateCell { cell: first, .. }) = log.defects.first() {
        let cells = log.defects.len();
        repairs.push(TetRepair::DroppedDuplicates { cells, first });
    }
    keep_largest(soup, &mut cells, found, &mut repairs)?;
    if cells.is_empty() {
        let vertices = soup.positions.len();
        let first = vec![TetDefect::NoCell { vertices }];
        return Err(TetPreflightError::Defects { first, count: 1 });
    }
    let mut log = TetPreflight::default();
    orient(soup, &mut cells, &mut log);
    if log.all_inverted {
        let cells = cells.len();
        repairs.push(TetRepair::TurnedAll { cells });
    }
    if let Some(TetDefect::Inverted { cells }) = log.defects.first() {
        repairs.push(TetRepair::TurnedSome {
            cells: cells.len(),
            first: cells[0],
        });
    }
    number(soup, &cells, repairs)
}

/// Keeps the component of most cells, and makes sure that nothing is wrong with it.
fn keep_largest(
    soup: &TetSoup,
    cells: &mut Vec<(u32, [u32; 4])>,
    found: &TetPreflight,
    repairs: &mut Vec<TetRepair>,
) -> Result<(), TetPreflightError> {
    if found.components.len() < 2 {
        return Ok(());
    }
    let before = cells.len();
    let labels = super::connectivity::cell_components(soup.positions.len(), cells);
    let mut sizes = vec![0usize; found.components.len()];
    labels.iter().for_each(|&label| sizes[label as usize] += 1);
    // The first of those of equal size.
    let largest = (0..sizes.len()).rev().max_by_key(|&label| sizes[label]);
    let mut labels = labels.into_iter();
    cells.retain(|_| labels.next().map(|label| label as usize) == largest);
    repairs.push(TetRepair::KeptLargestComponent {
        cells: before - cells.len(),
    });
    let kept = TetSoup {
        positions: soup.positions.clone(),
        cells: cells
            .iter()
            .map(|(_, corners)| corners.map(i64::from))
            .collect(),
    };
    let mut defects = preflight(&kept).defects;
    defects.retain(|defect| defect.remedy() == Remedy::Author);
    if defects.is_empty() {
        return Ok(());
    }
    let count = defects.len();
    defects.truncate(LISTED);
    Err(TetPreflightError::Defects {
        first: defects,
        count,
    })
}

fn number(
    soup: &TetSoup,
    cells: &[(u32, [u32; 4])],
    mut repairs: Vec<TetRepair>,
) -> Result<TetAccepted, TetPreflightError> {
    let mut ids = vec![NONE; soup.positions.len()];
    for &vertex in cells.iter().flat_map(|(_, corners)| corners) {
        ids[vertex as usize] = 0;
    }
    let mut vertex_origin = Vec::with_capacity(ids.len());
    for (vertex, id) in ids.iter_mut().enumerate().filter(|(_, id)| **id != NONE) {
        *id = vertex_origin.len() as u32;
        vertex_origin.push(vertex as u32);
    }
    if let Some(first) = ids.iter().position(|&id| id == NONE) {
        repairs.push(TetRepair::DroppedVertices {
            vertices: ids.len() - vertex_origin.len(),
            first: first as u32,
        });
    }
    let positions = vertex_origin.iter().map(|&v| soup.positions[v as usize]);
    let corners = cells
        .iter()
        .map(|(_, corners)| corners.map(|v| ids[v as usize]));
    Ok(TetAccepted {
        mesh: TetMesh::build(positions.collect(), corners.collect())?,
        repairs,
        vertex_origin,
        cell_origin: cells.iter().map(|&(cell, _)| cell).collect(),
    })
}

fn refusal(first: &[TetDefect], count: usize) -> String {
    let places: Vec<String> = first.iter().map(TetDefect::to_string).collect();
    let more = match count - first.len() {
        0 => String::new(),
        more => format!("; and {more} more defects"),
    };
    let hard = |defect: &&TetDefect| defect.remedy() == Remedy::Author;
    let remedy = match first.iter().find(hard) {
        Some(defect) => defect.remedy_text(),
        None if count == 1 => first[0].remedy_text(),
        None => "mend them with --repair",
    };
    format!("the solid is broken: {}{more}; {remedy}", places.join("; "))
}
