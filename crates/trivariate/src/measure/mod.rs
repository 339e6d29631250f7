//! How good a solid is as a mesh of finite elements.
//!
//! The cube is cut into `k³` cells and each cell into 24 tetrahedra of its centre, the centre of one of
//! its faces and two neighbouring corners of that face; their images are the elements.
//!
//! # Reference
//! [Kim2014] Eq. (3), Table 1, §6. Deviation: edges of cells have no midpoints, which the text names but
//! 24 tetrahedra have no place for.

mod elements;
mod hexahedra;

use nalgebra::Matrix3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::spline::TrivariateSpline;
pub(crate) use elements::{Places, determinant, is_degenerate};
pub use hexahedra::{Hexahedra, hexahedra};

/// Least ratio of a volume to the mean that a logarithm is taken of.
const LEAST_RATIO: f64 = 1e-9;

/// What Table 1 lists for one sampling.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ElementMeasures {
    /// Cells in each direction.
    pub cells: usize,
    /// Tetrahedra: 24 for each cell.
    pub elements: usize,
    /// Tetrahedra whose signed volume is not positive, decided exactly for the stored corners.
    pub degenerate: usize,
    /// Sum over all tetrahedra of `|ln r|`, `r` the ratio of the volumes of a tetrahedron and its
    /// image, each divided by the total volume on its side. The volume of an image counts without
    /// its sign, and as 10⁻⁹ of the mean where it is smaller: so a degenerate element costs what its
    /// size says, at most 20.7.
    pub distortion_sum: f64,
    /// The same for one tetrahedron, on average.
    pub distortion_mean: f64,
    /// Largest singular value of an affine map from a tetrahedron to its image, the solid scaled to
    /// volume 1.
    pub stretch: f64,
    /// Total volume of the images, without their signs.
    pub volume: f64,
}

/// One layer of cells: six times the volumes of its elements, and its sums.
struct Layer {
    determinants: Vec<f64>,
    degenerate: usize,
    stretch: f64,
}

/// Returns the measures of Table 1 at `cells` cells in each direction.
///
/// # Reference
/// [Kim2014] Eq. (3), Table 1, §6. Deviation: volumes count without sign, and at least 10⁻⁹ of the mean;
/// the paper does not say what a negative or vanishing volume does to its logarithm.
#[must_use]
pub fn measure(spline: &TrivariateSpline, cells: usize) -> ElementMeasures {
    let (grid, places) = (doubled_grid(spline, cells), Places::build(cells));
    let layers: Vec<Layer> = (0..cells)
        .into_par_iter()
        .map(|k| layer(&grid, cells, &places, k))
        .collect();
    let count = 24 * cells.pow(3);
    let sums = layers
        .par_iter()
        .map(|l| l.determinants.iter().map(|d| d.abs()).sum());
    let volume = sums.collect::<Vec<f64>>().iter().sum::<f64>() / 6.0;
    let mean = 6.0 * volume / count as f64;
    let logarithms = layers.par_iter().map(|layer| {
        let ratios = layer.determinants.iter().map(|d| d.abs() / mean);
        ratios
            .map(|r| if r > LEAST_RATIO { r } else { LEAST_RATIO }.ln().abs())
            .sum()
    });
    let distortion_sum = logarithms.collect::<Vec<f64>>().iter().sum();
    ElementMeasures {
        cells,
        elements: count,
        degenerate: layers.iter().map(|l| l.degenerate).sum(),
        distortion_sum,
        distortion_mean: distortion_sum / count as f64,
        stretch: layers.iter().map(|l| l.stretch).fold(0.0, f64::max) / volume.cbrt(),
        volume,
    }
}

/// Returns how many elements at `cells` cells in each direction have a signed volume that is not
/// positive, decided exactly for the stored corners.
#[must_use]
pub fn degenerate(spline: &TrivariateSpline, cells: usize) -> usize {
    let (grid, places) = (doubled_grid(spline, cells), Places::build(cells));
    let layers = (0..cells).into_par_iter().map(|k| {
        let elements = layer_cells(cells, k).flat_map(|cell| places.of_cell(cells, cell));
        elements
            .filter(|at| is_degenerate(&at.map(|index| grid[index])))
            .count()
    });
    layers.sum()
}

/// Positions at corners and centres of cells and of their faces.
fn doubled_grid(spline: &TrivariateSpline, cells: usize) -> Vec<[f64; 3]> {
    spline
        .grid(2 * cells)
        .iter()
        .map(|p| p.coords.into())
        .collect()
}

/// The cells of a layer.
fn layer_cells(cells: usize, k: usize) -> std::ops::Range<usize> {
    k * cells * cells..(k + 1) * cells * cells
}

fn layer(grid: &[[f64; 3]], cells: usize, places: &Places, k: usize) -> Layer {
    let mut layer = Layer {
        determinants: Vec::with_capacity(24 * cells * cells),
        degenerate: 0,
        stretch: 0.0,
    };
    // Elements are compared in units of half a cell.
    let mut greatest = 0.0;
    for at in layer_cells(cells, k).flat_map(|cell| places.of_cell(cells, cell)) {
        let points = at.map(|index| grid[index]);
        layer.determinants.push(determinant(&points));
        layer.degenerate += usize::from(is_degenerate(&points));
        let squares = squares(&points);
        if exceeds(&squares, greatest) {
            let found = symmetric(&squares).symmetric_eigenvalues().max();
            greatest = if found > greatest { found } else { greatest };
        }
    }
    layer.stretch = greatest.sqrt() * 2.0 * cells as f64;
    layer
}

/// Products `xx, xy, xz, yy, yz, zz` of the derivatives of the affine map to an element, up to the
/// order and signs of the directions: from cell centre to face centre, half of the edge between the
/// corners, and from the face centre to the middle of that edge.
fn squares(points: &[[f64; 3]; 4]) -> [f64; 6] {
    let [c, f, a, b] = points;
    let x = [0, 1, 2].map(|d| f[d] - c[d]);
    let y = [0, 1, 2].map(|d| 0.5 * (b[d] - a[d]));
    let z = [0, 1, 2].map(|d| 0.5 * (a[d] + b[d]) - f[d]);
    let dot = |p: [f64; 3], q: [f64; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    [
        dot(x, x),
        dot(x, y),
        dot(x, z),
        dot(y, y),
        dot(y, z),
        dot(z, z),
    ]
}

fn symmetric([xx, xy, xz, yy, yz, zz]: &[f64; 6]) -> Matrix3<f64> {
    Matrix3::new(*xx, *xy, *xz, *xy, *yy, *yz, *xz, *yz, *zz)
}

/// Whether an eigenvalue may exceed `bound`: whether `bound - S` is not positive definite.
fn exceeds([xx, xy, xz, yy, yz, zz]: &[f64; 6], bound: f64) -> bool {
    let (a, b, c) = (bound - xx, bound - yy, bound - zz);
    let minor = a * b - xy * xy;
    let whole = c * minor - a * yz * yz - b * xz * xz - 2.0 * xy * yz * xz;
    !(a > 0.0 && minor > 0.0 && whole > 0.0)
}
