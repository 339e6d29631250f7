//! A symmetric matrix over a lattice that joins places up to three apart in each direction.

use msplines_common::bspline::{bernstein, to_bezier};
use pulp::Arch;
use rayon::prelude::*;

/// Places that a row joins in one direction.
pub(crate) const WIDTH: usize = 7;

/// How far a row reaches.
pub(crate) const REACH: usize = 3;

/// Rows of up to 343 entries over a lattice of `size³` places.
///
/// The entry of row `(i, j, k)` and column `(i + di - 3, j + dj - 3, k + dk - 3)` stands at
/// `((((k size + j) 7 + dk) 7 + dj) 7 + di) size + i`: a product runs along lines of both.
/// Entries whose column lies outside are 0.
#[derive(Clone, Debug)]
pub(crate) struct Stencil {
    pub(crate) size: usize,
    pub(crate) entries: Vec<f64>,
}

impl Stencil {
    /// Numbers of a plane of rows `k`.
    pub(crate) fn plane(size: usize) -> usize {
        size * size * WIDTH.pow(3)
    }

    pub(crate) fn zero(size: usize) -> Self {
        let entries = vec![0.0; size * Self::plane(size)];
        Self { size, entries }
    }

    /// Start of the line of rows `(0.., j, k)` and the columns `(dj, dk)` away, for all `di`.
    fn line(&self, j: usize, k: usize, dj: usize, dk: usize) -> usize {
        (((k * self.size + j) * WIDTH + dk) * WIDTH + dj) * WIDTH * self.size
    }

    /// Adds `factor` times the sum of squared second derivatives in the three directions, integrated
    /// over the cube, where spans have length 1.
    pub(crate) fn add_second_derivatives(&mut self, factor: f64) {
        let size = self.size;
        let mass = products(size, values);
        let bending = products(size, second_derivatives);
        let line = WIDTH * size;
        let planes = self.entries.par_chunks_mut(Self::plane(size));
        planes.enumerate().for_each(|(k, plane)| {
            for (at, rows) in plane.chunks_exact_mut(line).enumerate() {
                let (j, dk, dj) = (at / WIDTH.pow(2), at / WIDTH % WIDTH, at % WIDTH);
                let [m, b] = [&mass, &bending].map(|table| [table[j][dj], table[k][dk]]);
                let (straight, bent) = (m[0] * m[1], b[0] * m[1] + m[0] * b[1]);
                for (di, row) in rows.chunks_exact_mut(size).enumerate() {
                    for (entry, (b, m)) in row.iter_mut().zip(bending.iter().zip(&mass)) {
                        *entry += factor * (straight * b[di] + bent * m[di]);
                    }
                }
            }
        });
    }

    /// The entry of a row and a column.
    pub(crate) fn entry(&self, row: [usize; 3], column: [usize; 3]) -> f64 {
        let offset = |axis: usize| (column[axis] + REACH).wrapping_sub(row[axis]);
        let [di, dj, dk] = [0, 1, 2].map(offset);
        if di.max(dj).max(dk) >= WIDTH {
            return 0.0;
        }
        self.entries[self.line(row[1], row[2], dj, dk) + di * self.size + row[0]]
    }

    /// The rows of some places, restricted to them: columns and entries.
    pub(crate) fn within(&self, places: &[u32]) -> Vec<Vec<(u32, f64)>> {
        let size = self.size;
        let mut known = vec![u32::MAX; size.pow(3)];
        for (&place, at) in places.iter().zip(0..) {
            known[place as usize] = at;
        }
        let row = |&place: &u32| {
            let place = place as usize;
            let row = [place % size, place / size % size, place / (size * size)];
            let around = |i: usize| i.saturating_sub(REACH)..(i + REACH + 1).min(size);
            let [x, y, z] = row.map(around);
            let mut entries = Vec::new();
            for (k, j) in z.flat_map(|k| y.clone().map(move |j| (k, j))) {
                for i in x.clone() {
                    let column = known[i + size * (j + size * k)];
                    if column != u32::MAX {
                        entries.push((column, self.entry(row, [i, j, k])));
                    }
                }
            }
            entries
        };
        places.par_iter().map(row).collect()
    }

    /// The product with several columns, one lattice after another.
    pub(crate) fn apply(&self, x: &[f64]) -> Vec<f64> {
        let size = self.size;
        let (plane, lattice) = (size * size, size.pow(3));
        let columns = x.len() / lattice;
        let padded = pad(size, x);
        // Planes of all columns, then sorted into columns.
        let mut planes = vec![0.0; x.len()];
        planes
            .par_chunks_mut(plane * columns)
            .enumerate()
            .for_each(|(k, out)| {
                Arch::new().dispatch(
                    #[inline(always)]
                    || self.apply_plane(k, &padded, out),
                );
            });
        let mut out = vec![0.0; x.len()];
        for (k, chunk) in planes.chunks_exact(plane * columns).enumerate() {
            for (column, values) in chunk.chunks_exact(plane).enumerate() {
                let start = column * lattice + k * plane;
                out[start..start + plane].copy_from_slice(values);
            }
        }
        out
    }

    #[inline(always)]
    fn apply_plane(&self, k: usize, padded: &[f64], out: &mut [f64]) {
        let size = self.size;
        let (long, plane) = (size + 2 * REACH, size * size);
        let lattice = long * plane;
        for j in 0..size {
            for dk in reachable(k, size) {
                for dj in reachable(j, size) {
                    let start = self.line(j, k, dj, dk);
                    let rows = &self.entries[start..start + WIDTH * size];
                    let from = ((k + dk - REACH) * size + j + dj - REACH) * long;
                    for (column, sums) in out.chunks_exact_mut(plane).enumerate() {
                        let line = &padded[column * lattice + from..][..long];
                        multiply(rows, line, &mut sums[j * size..(j + 1) * size]);
                    }
                }
            }
        }
    }
}

/// Adds seven diagonals times a padded line.
#[inline(always)]
fn multiply(rows: &[f64], line: &[f64], sums: &mut [f64]) {
    let size = sums.len();
    let row = |d: usize| &rows[d * size..(d + 1) * size];
    let column = |d: usize| &line[d..d + size];
    let (a, b): ([&[f64]; 7], [&[f64]; 7]) =
        (std::array::from_fn(row), std::array::from_fn(column));
    for (i, sum) in sums.iter_mut().enumerate() {
        *sum += a[0][i] * b[0][i]
            + a[1][i] * b[1][i]
            + a[2][i] * b[2][i]
            + a[3][i] * b[3][i]
            + a[4][i] * b[4][i]
            + a[5][i] * b[5][i]
            + a[6][i] * b[6][i];
    }
}

/// Lines with three zeros before and after.
fn pad(size: usize, x: &[f64]) -> Vec<f64> {
    let long = size + 2 * REACH;
    let mut padded = vec![0.0; x.len() / size * long];
    for (line, values) in padded.chunks_exact_mut(long).zip(x.chunks_exact(size)) {
        line[REACH..REACH + size].copy_from_slice(values);
    }
    padded
}

/// Offsets plus three that lead from a place to another in the lattice.
fn reachable(at: usize, size: usize) -> std::ops::Range<usize> {
    REACH.saturating_sub(at)..(size + REACH - at).min(WIDTH)
}

/// Bernstein coefficients of basis function `p` of a span.
pub(crate) fn values(p: usize) -> Vec<f64> {
    to_bezier(std::array::from_fn(|i| if i == p { 1.0 } else { 0.0 })).to_vec()
}

/// Bernstein coefficients of the second derivative of basis function `p` of a span.
fn second_derivatives(p: usize) -> Vec<f64> {
    let v = values(p);
    vec![
        6.0 * (v[0] - 2.0 * v[1] + v[2]),
        6.0 * (v[1] - 2.0 * v[2] + v[3]),
    ]
}

/// Rows of integrals of products of functions of a line of spans of length 1.
pub(crate) fn products(size: usize, function: fn(usize) -> Vec<f64>) -> Vec<[f64; WIDTH]> {
    let mut rows = vec![[0.0; WIDTH]; size];
    for (p, q) in (0..16).map(|pq| (pq / 4, pq % 4)) {
        let product = bernstein::product(&function(p), &function(q));
        // Bernstein polynomials of one degree have the same integral.
        let integral = product.iter().sum::<f64>() / product.len() as f64;
        for row in &mut rows[p..p + size - 3] {
            row[q + REACH - p] += integral;
        }
    }
    rows
}
