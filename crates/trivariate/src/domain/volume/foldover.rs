//! An energy of maps that resists folds, and is finite where there are some.
//!
//! # Notation
//! `J` is the Jacobian of the map from a cell at rest to the cube, `D` its determinant and
//! `χ(D) = (D + sqrt(ε² + D²)) / 2`, which is positive and tends to the positive part of `D`.

use nalgebra::Matrix3;
use rayon::prelude::*;

use super::lanes::{Lanes, WIDTH};

/// Cells or vertices of one task.
const CHUNK: usize = 512;

/// How distortion of angles is measured; both add `(1 + D²) / χ` for that of volumes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    /// `|J|² / χ^(2/3)`.
    Quadratic,
    /// `|J|³ / (√3 χ)`.
    Cubic,
}

/// What becomes of inverted cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Folds {
    /// They are allowed, with this `ε²`.
    Allowed(f64),
    /// A single one makes the energy infinite; `ε` is 0.
    Refused,
}

/// Some cells side by side; the last ones may be copies without weight.
struct Block {
    /// Corners of each cell.
    cells: [[u32; 4]; WIDTH],
    /// Inverse of the matrix of edges at rest from the first corner, by rows.
    inverse: [[Lanes; 3]; 3],
    weight: Lanes,
}

/// The gradient of a cell's energy by each of its corners.
type ByCorner = [[f64; 3]; 4];

/// The energy of some cells of a solid.
pub(super) struct Foldover {
    blocks: Vec<Block>,
    /// For every vertex the places `4 * cell + corner` where it occurs.
    starts: Vec<u32>,
    places: Vec<u32>,
    free: Vec<[bool; 3]>,
    by_corner: Vec<[ByCorner; WIDTH]>,
}

impl Foldover {
    /// Returns the energy of cells with these edges at rest, as columns; weights are volumes.
    pub(super) fn new(cells: &[[u32; 4]], edges: &[Matrix3<f64>], free: Vec<[bool; 3]>) -> Self {
        let total: f64 = edges.iter().map(Matrix3::determinant).sum();
        let blocks = cells.chunks(WIDTH).zip(edges.chunks(WIDTH));
        let blocks: Vec<Block> = blocks
            .map(|(cells, edges)| block(cells, edges, total))
            .collect();
        let mut starts = vec![0u32; free.len() + 1];
        cells
            .iter()
            .flatten()
            .for_each(|&v| starts[v as usize + 1] += 1);
        (0..free.len()).for_each(|v| starts[v + 1] += starts[v]);
        let mut next = starts.clone();
        let mut places = vec![0; 4 * cells.len()];
        for (&vertex, place) in cells.iter().flatten().zip(0u32..) {
            places[next[vertex as usize] as usize] = place;
            next[vertex as usize] += 1;
        }
        let by_corner = vec![[[[0.0; 3]; 4]; WIDTH]; blocks.len()];
        Self {
            blocks,
            starts,
            places,
            free,
            by_corner,
        }
    }

    /// Returns the smallest determinant.
    pub(super) fn smallest_determinant(&self, x: &[f64]) -> f64 {
        let least = |block: &Block| {
            let j = jacobian(block, x);
            let det = dot(&j[0], &cross(&j[1], &j[2]));
            det.0.into_iter().fold(f64::INFINITY, f64::min)
        };
        let blocks = self.blocks.par_iter().with_min_len(CHUNK / WIDTH);
        blocks.map(least).reduce(|| f64::INFINITY, f64::min)
    }

    /// Returns the energy at `x` and writes its gradient, zero for what is not free.
    pub(super) fn evaluate(
        &mut self,
        shape: Shape,
        folds: Folds,
        x: &[f64],
        gradient: &mut [f64],
    ) -> f64 {
        let chunks = self.blocks.par_chunks(CHUNK / WIDTH);
        let parts: Vec<f64> = chunks
            .zip(self.by_corner.par_chunks_mut(CHUNK / WIDTH))
            .map(|(blocks, by_corner)| {
                let mut sum = Lanes::of(0.0);
                for (block, by_corner) in blocks.iter().zip(by_corner) {
                    sum = sum + block_energy(block, shape, folds, x, by_corner);
                }
                sum.0.iter().sum()
            })
            .collect();
        let energy: f64 = parts.iter().sum();
        if energy.is_finite() {
            self.gather(gradient);
        }
        energy
    }

    fn gather(&self, gradient: &mut [f64]) {
        let flat = self.by_corner.as_flattened().as_flattened();
        gradient
            .par_chunks_mut(3 * CHUNK)
            .enumerate()
            .for_each(|(chunk, part)| {
                for (k, out) in part.chunks_exact_mut(3).enumerate() {
                    let vertex = chunk * CHUNK + k;
                    let range = self.starts[vertex] as usize..self.starts[vertex + 1] as usize;
                    let mut sum = [0.0; 3];
                    for &place in &self.places[range] {
                        let by_corner = &flat[place as usize];
                        (0..3).for_each(|d| sum[d] += by_corner[d]);
                    }
                    for d in 0..3 {
                        out[d] = if self.free[vertex][d] { sum[d] } else { 0.0 };
                    }
                }
            });
    }

    /// Returns the diagonal of the Laplacian of the cells at rest, for every coordinate.
    pub(super) fn diagonal(&self) -> Vec<f64> {
        let mut diagonal = vec![0.0; 3 * self.free.len()];
        for block in &self.blocks {
            let rows = &block.inverse;
            let first = [0, 1, 2].map(|j| -(rows[0][j] + rows[1][j] + rows[2][j]));
            for (corner, gradient) in [first, rows[0], rows[1], rows[2]].iter().enumerate() {
                let squares = block.weight * dot(gradient, gradient);
                for (cell, square) in block.cells.iter().zip(squares.0) {
                    let at = 3 * cell[corner] as usize;
                    diagonal[at..at + 3].iter_mut().for_each(|d| *d += square);
                }
            }
        }
        diagonal
    }
}

fn block(cells: &[[u32; 4]], edges: &[Matrix3<f64>], total: f64) -> Block {
    let mut block = Block {
        cells: [cells[cells.len() - 1]; WIDTH],
        inverse: [[Lanes::of(0.0); 3]; 3],
        weight: Lanes::of(0.0),
    };
    block.cells[..cells.len()].copy_from_slice(cells);
    for lane in 0..WIDTH {
        let edges = &edges[lane.min(cells.len() - 1)];
        let inverse = edges.try_inverse().unwrap_or_default();
        for (i, row) in block.inverse.iter_mut().enumerate() {
            row.iter_mut()
                .enumerate()
                .for_each(|(j, entry)| entry.0[lane] = inverse[(i, j)]);
        }
        if lane < cells.len() {
            block.weight.0[lane] = edges.determinant() / total;
        }
    }
    block
}

/// Returns the columns of `J`.
#[inline(always)]
fn jacobian(block: &Block, x: &[f64]) -> [[Lanes; 3]; 3] {
    let mut edges = [[Lanes::of(0.0); 3]; 3];
    for (lane, cell) in block.cells.iter().enumerate() {
        let at = 3 * cell[0] as usize;
        let origin = [x[at], x[at + 1], x[at + 2]];
        for k in 0..3 {
            let at = 3 * cell[k + 1] as usize;
            for d in 0..3 {
                edges[k][d].0[lane] = x[at + d] - origin[d];
            }
        }
    }
    let mut columns = [[Lanes::of(0.0); 3]; 3];
    for (j, column) in columns.iter_mut().enumerate() {
        for (d, entry) in column.iter_mut().enumerate() {
            *entry = edges[0][d] * block.inverse[0][j]
                + edges[1][d] * block.inverse[1][j]
                + edges[2][d] * block.inverse[2][j];
        }
    }
    columns
}

#[inline(always)]
fn cross(a: &[Lanes; 3], b: &[Lanes; 3]) -> [Lanes; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[inline(always)]
fn dot(a: &[Lanes; 3], b: &[Lanes; 3]) -> Lanes {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Returns `χ` and its derivative.
#[inline(always)]
fn positive_part(det: Lanes, folds: Folds) -> (Lanes, Lanes) {
    let Folds::Allowed(square) = folds else {
        return (det, Lanes::of(1.0));
    };
    let (square, half) = (Lanes::of(square), Lanes::of(0.5));
    let root = (square + det * det).sqrt();
    // Both forms are the same number; each keeps its digits where it is taken.
    let chi = det.choose(half * (det + root), half * square * (root - det).inverse());
    (chi, chi * root.inverse())
}

/// Returns the energy of each cell and writes the gradients by their corners.
///
/// # Reference
/// [Garanzha2021]. Deviation: the cubic form of the distortion of angles.
#[inline]
fn block_energy(
    block: &Block,
    shape: Shape,
    folds: Folds,
    x: &[f64],
    by_corner: &mut [ByCorner; WIDTH],
) -> Lanes {
    let j = jacobian(block, x);
    let cofactor = [
        cross(&j[1], &j[2]),
        cross(&j[2], &j[0]),
        cross(&j[0], &j[1]),
    ];
    let det = dot(&j[0], &cofactor[0]);
    if folds == Folds::Refused && !det.all_positive() {
        return Lanes::of(f64::INFINITY);
    }
    let (chi, slope) = positive_part(det, folds);
    let square = dot(&j[0], &j[0]) + dot(&j[1], &j[1]) + dot(&j[2], &j[2]);
    let inverse = chi.inverse();
    // The energy of angles, and its derivatives by |J|² (twice) and by χ.
    let (angles, by_square, by_chi) = match shape {
        Shape::Cubic => {
            let norm = square.sqrt();
            let factor = inverse * Lanes::of(1.0 / 3f64.sqrt());
            let value = square * norm * factor;
            (value, Lanes::of(3.0) * norm * factor, -(value * inverse))
        }
        Shape::Quadratic => {
            let root = chi.inverse_cube_root();
            let factor = root * root;
            let value = square * factor;
            (
                value,
                Lanes::of(2.0) * factor,
                Lanes::of(-2.0 / 3.0) * value * inverse,
            )
        }
    };
    let volumes = (Lanes::of(1.0) + det * det) * inverse;
    let by_det = (by_chi - volumes * inverse) * slope + Lanes::of(2.0) * det * inverse;
    let (by_square, by_det) = (block.weight * by_square, block.weight * by_det);
    for d in 0..3 {
        let mut stress = [Lanes::of(0.0); 3];
        for k in 0..3 {
            stress[k] = by_square * j[k][d] + by_det * cofactor[k][d];
        }
        let mut first = Lanes::of(0.0);
        for k in 0..3 {
            let value = dot(&stress, &block.inverse[k]);
            first = first - value;
            (0..WIDTH).for_each(|lane| by_corner[lane][k + 1][d] = value.0[lane]);
        }
        (0..WIDTH).for_each(|lane| by_corner[lane][0][d] = first.0[lane]);
    }
    block.weight * (angles + volumes)
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    fn one_cell() -> Foldover {
        let edges = Matrix3::from_columns(&[
            Vector3::new(1.0, 0.1, 0.0),
            Vector3::new(0.2, 1.1, 0.1),
            Vector3::new(-0.1, 0.3, 0.9),
        ]);
        Foldover::new(&[[0, 1, 2, 3]], &[edges], vec![[true; 3]; 4])
    }

    #[test]
    fn gradients_are_those_of_differences() {
        let mut energy = one_cell();
        let good = [0.0, 0.0, 0.0, 1.1, 0.2, 0.0, 0.1, 0.8, 0.2, 0.2, 0.1, 1.3];
        let mut bad = good;
        (bad[9], bad[10], bad[11]) = (0.3, 0.2, -0.4);
        for shape in [Shape::Cubic, Shape::Quadratic] {
            for (x, folds) in [
                (good, Folds::Refused),
                (good, Folds::Allowed(0.1)),
                (bad, Folds::Allowed(0.1)),
            ] {
                let (mut g, mut unused) = ([0.0; 12], [0.0; 12]);
                let value = energy.evaluate(shape, folds, &x, &mut g);
                for at in 0..12 {
                    let mut moved = x;
                    moved[at] += 1e-6;
                    let up = energy.evaluate(shape, folds, &moved, &mut unused);
                    moved[at] -= 2e-6;
                    let down = energy.evaluate(shape, folds, &moved, &mut unused);
                    let difference = (up - down) / 2e-6;
                    assert!(
                        (difference - g[at]).abs() < 1e-6 * value,
                        "{difference} {}",
                        g[at]
                    );
                }
            }
        }
    }

    #[test]
    fn rest_is_the_least_and_folds_are_refused() {
        let mut energy = one_cell();
        let rest = [0.0, 0.0, 0.0, 1.0, 0.1, 0.0, 0.2, 1.1, 0.1, -0.1, 0.3, 0.9];
        let mut g = [0.0; 12];
        for shape in [Shape::Cubic, Shape::Quadratic] {
            let value = energy.evaluate(shape, Folds::Refused, &rest, &mut g);
            assert!((value - 5.0).abs() < 1e-12);
            assert!(g.iter().all(|g| g.abs() < 1e-12));
        }
        assert!((energy.smallest_determinant(&rest) - 1.0).abs() < 1e-14);
        let mirrored = rest.map(|x| -x);
        let value = energy.evaluate(Shape::Cubic, Folds::Refused, &mirrored, &mut g);
        assert_eq!(value, f64::INFINITY);
    }
}
