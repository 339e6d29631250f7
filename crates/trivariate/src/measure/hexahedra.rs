//! A solid as a mesh of hexahedra.

use msplines_common::{Point3, Vector3};

use crate::spline::TrivariateSpline;

/// A regular hexahedral mesh of a solid.
#[derive(Clone, Debug, PartialEq)]
pub struct Hexahedra {
    /// Points of a grid, the first index fastest.
    pub points: Vec<Point3<f64>>,
    /// Corners of each cell in the order of VTK, Gmsh and Abaqus: four around the bottom, and those
    /// above them.
    pub cells: Vec<[u32; 8]>,
    /// For each cell the least determinant of its three edges at a corner, each of length 1: 1 for a
    /// box, not positive where the cell is turned at a corner, 0 where an edge vanishes.
    pub scaled_jacobians: Vec<f64>,
}

/// Corners, and their neighbours along the three directions, of a cell.
const CORNERS: [[usize; 3]; 8] = [
    [0, 0, 0],
    [1, 0, 0],
    [1, 1, 0],
    [0, 1, 0],
    [0, 0, 1],
    [1, 0, 1],
    [1, 1, 1],
    [0, 1, 1],
];

/// Returns the hexahedra of `cells` cells in each direction.
#[must_use]
pub fn hexahedra(spline: &TrivariateSpline, cells: usize) -> Hexahedra {
    let (points, size) = (spline.grid(cells), cells + 1);
    let place = |[i, j, k]: [usize; 3]| i + size * (j + size * k);
    let (mut hexahedra, mut scaled_jacobians) = (Vec::new(), Vec::new());
    for at in 0..cells.pow(3) {
        let cell = [at % cells, at / cells % cells, at / (cells * cells)];
        let corner = |offset: [usize; 3]| place(std::array::from_fn(|d| cell[d] + offset[d]));
        hexahedra.push(CORNERS.map(|offset| corner(offset) as u32));
        let jacobian = CORNERS.map(|offset| {
            let edges: [Vector3<f64>; 3] = std::array::from_fn(|d| {
                let (mut low, mut high) = (offset, offset);
                low[d] = 0;
                high[d] = 1;
                let edge = points[corner(high)] - points[corner(low)];
                edge.try_normalize(0.0).unwrap_or_else(Vector3::zeros)
            });
            edges[0].dot(&edges[1].cross(&edges[2]))
        });
        scaled_jacobians.push(jacobian.into_iter().fold(f64::INFINITY, f64::min));
    }
    Hexahedra {
        points,
        cells: hexahedra,
        scaled_jacobians,
    }
}
