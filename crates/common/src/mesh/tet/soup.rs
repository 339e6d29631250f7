//! Cells and positions as a file holds them, with nothing promised about them.

use nalgebra::Point3;

/// Positions and tetrahedra, unchecked: indices may lie outside, coordinates may be NaN.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TetSoup {
    /// Vertex positions.
    pub positions: Vec<Point3<f64>>,
    /// Vertex indices of each tetrahedron, zero-based.
    pub cells: Vec<[i64; 4]>,
}

impl TetSoup {
    /// Returns the soup of these cells.
    #[must_use]
    pub fn from_cells(positions: Vec<Point3<f64>>, cells: &[[u32; 4]]) -> Self {
        let cells = cells.iter().map(|cell| cell.map(i64::from)).collect();
        Self { positions, cells }
    }
}
