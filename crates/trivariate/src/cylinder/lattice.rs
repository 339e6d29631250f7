//! Fits to samples on a grid of parameters, periodic along the first.
//!
//! On a grid all that multilevel B-splines and least squares do to samples is a product of what
//! they do along each axis.
//!
//! # Notation
//! Along an axis, `n` spans, `n + 3` coefficients; `B_i(t)` the basis function of coefficient `i`
//! at parameter `t`. Along the first axis coefficients `n`, `n + 1`, `n + 2` are `0`, `1`, `2`.

use msplines_common::bspline::{Axis, locate, weights};
use nalgebra::{DMatrix, Point3};

use crate::error::FitError;
use crate::fit::multilevel::Level;
use crate::spline::{TrivariateSpline, refine_lattice};

/// Samples on a grid, the first axis fastest.
pub(super) struct Grid<'a> {
    /// Parameters along each axis; those of the first lie in `[0, 1)`.
    pub(super) parameters: [&'a [f64]; 3],
    /// Three coordinates for each sample.
    pub(super) values: Vec<f64>,
}

/// Basis functions of a lattice at the parameters of an axis.
struct Rows {
    /// Number of coefficients.
    count: usize,
    /// The first coefficient of each row.
    first: Vec<usize>,
    /// Functions of it and the next three.
    basis: Vec<[f64; 4]>,
    periodic: bool,
}

impl Rows {
    fn build(spans: usize, parameters: &[f64], axis: usize) -> Self {
        let periodic = axis == 0;
        let located = parameters.iter().map(|&t| locate(spans, t));
        let (first, basis) = located
            .map(|(span, x)| (span, folded(spans, weights(x), periodic)))
            .unzip();
        Self {
            count: spans + 3,
            first,
            basis,
            periodic,
        }
    }

    /// Returns the transposed product with rows along an axis of an array, whose other axes have
    /// these sizes. Along a periodic axis coefficients that are the same get the same sum.
    fn gather(&self, mut axis: Axis, rows: &[[f64; 4]], values: &[f64]) -> Vec<f64> {
        axis.count = self.count;
        let mut sums = axis.apply_transposed(&self.first, rows, values);
        if self.periodic {
            let spans = self.count - 3;
            for block in sums.chunks_exact_mut(axis.count * axis.inner) {
                let (own, copies) = block.split_at_mut(spans * axis.inner);
                for at in 0..copies.len() {
                    own[at % (spans * axis.inner)] += copies[at];
                }
                for at in 0..copies.len() {
                    copies[at] = own[at % (spans * axis.inner)];
                }
            }
        }
        sums
    }

    /// For each coefficient the sum of the squares of its function.
    fn squares(&self) -> Vec<f64> {
        let axis = Axis::of(&[self.first.len()], 0, 1);
        let squares: Vec<[f64; 4]> = self.basis.iter().map(|b| b.map(|b| b * b)).collect();
        self.gather(axis, &squares, &vec![1.0; self.first.len()])
    }

    /// Rows of `B³ / sum of B²`.
    fn cubes(&self) -> Vec<[f64; 4]> {
        let cubes = self.basis.iter().map(|row| {
            let squares: f64 = row.iter().map(|b| b * b).sum();
            row.map(|b| b * b * b / squares)
        });
        cubes.collect()
    }

    /// The inverse of the normal equations of least squares with smoothing, one row and column for
    /// each coefficient, equal ones repeated.
    fn inverse(&self, smoothing: f64) -> Result<DMatrix<f64>, FitError> {
        let free = if self.periodic {
            self.count - 3
        } else {
            self.count
        };
        let mut normal = DMatrix::zeros(free, free);
        let place = |i: usize| i % free;
        for (first, row) in self.first.iter().zip(&self.basis) {
            for (p, a) in row.iter().enumerate() {
                for (q, b) in row.iter().enumerate() {
                    normal[(place(first + p), place(first + q))] += a * b;
                }
            }
        }
        let mean = smoothing * normal.trace() / free as f64;
        let differences = if self.periodic {
            free
        } else {
            self.count.saturating_sub(2)
        };
        for start in 0..differences {
            for (p, a) in [1.0, -2.0, 1.0].into_iter().enumerate() {
                for (q, b) in [1.0, -2.0, 1.0].into_iter().enumerate() {
                    normal[(place(start + p), place(start + q))] += mean * a * b;
                }
            }
        }
        let factor = normal.cholesky().ok_or(FitError::Undetermined)?;
        let inverse = factor.inverse();
        let all = |i: usize, j: usize| inverse[(place(i), place(j))];
        Ok(DMatrix::from_fn(self.count, self.count, all))
    }
}

/// Basis functions of a row; with less than four spans around, those of one coefficient together.
fn folded(spans: usize, row: [f64; 4], periodic: bool) -> [f64; 4] {
    let mut sums = [0.0; 4];
    for (p, b) in row.into_iter().enumerate() {
        sums[if periodic { p % spans } else { p }] += b;
    }
    sums
}

/// Returns what multilevel B-splines add at one level.
///
/// # Reference
/// [LeeWolbergShin1997] Eq. (3), Eq. (5), §3. Deviation: periodic along the first axis.
fn approximate(grid: &Grid<'_>, rows: &[Rows; 3]) -> Vec<f64> {
    let cubes: [_; 3] = std::array::from_fn(|axis| rows[axis].cubes());
    let mut lattice = gathered(grid, rows, &cubes);
    let [u, v, w]: [_; 3] = std::array::from_fn(|axis| rows[axis].squares());
    let size = rows[0].count;
    for (at, place) in lattice.chunks_exact_mut(3).enumerate() {
        let squares = u[at % size] * v[at / size % size] * w[at / (size * size)];
        let share = if squares > 0.0 { 1.0 / squares } else { 0.0 };
        place.iter_mut().for_each(|c| *c *= share);
    }
    lattice
}

/// The transposed product with rows along all axes.
fn gathered(grid: &Grid<'_>, rows: &[Rows; 3], entries: &[Vec<[f64; 4]>; 3]) -> Vec<f64> {
    let mut sizes = grid.parameters.map(<[f64]>::len);
    let mut values: Option<Vec<f64>> = None;
    for axis in (0..3).rev() {
        let source = values.as_deref().unwrap_or(&grid.values);
        let of = Axis::of(&sizes, axis, 3);
        let next = rows[axis].gather(of, &entries[axis], source);
        sizes[axis] = rows[axis].count;
        values = Some(next);
    }
    values.unwrap_or_default()
}

/// Takes the values of a lattice from the samples.
fn subtract(grid: &mut Grid<'_>, rows: &[Rows; 3], lattice: &[f64]) {
    let mut sizes = rows.each_ref().map(|rows| rows.count);
    let mut values = lattice.to_vec();
    for axis in 0..3 {
        let of = Axis::of(&sizes, axis, 3);
        values = of.apply(&rows[axis].first, &rows[axis].basis, &values);
        sizes[axis] = rows[axis].first.len();
    }
    for (sample, value) in grid.values.iter_mut().zip(values) {
        *sample -= value;
    }
}

/// Sum over what was fitted so far, and what is left of the samples.
pub(super) struct Fitting<'a> {
    grid: Grid<'a>,
    spans: usize,
    lattice: Vec<f64>,
}

impl<'a> Fitting<'a> {
    pub(super) fn begin(grid: Grid<'a>) -> Self {
        Self {
            grid,
            spans: 0,
            lattice: Vec::new(),
        }
    }

    /// Adds a level of multilevel B-splines with these spans, those of the last level or a power
    /// of two times as many.
    pub(super) fn add_level(&mut self, spans: usize) -> Level {
        let rows = self.rows(spans);
        let correction = approximate(&self.grid, &rows);
        self.add(spans, correction, &rows)
    }

    /// Fits by least squares with smoothing along each axis.
    pub(super) fn least_squares(
        &mut self,
        spans: usize,
        smoothing: f64,
    ) -> Result<Level, FitError> {
        let rows = self.rows(spans);
        let basis: [_; 3] = std::array::from_fn(|axis| rows[axis].basis.clone());
        let mut lattice = gathered(&self.grid, &rows, &basis);
        let sizes = rows.each_ref().map(|rows| rows.count);
        for (axis, rows) in rows.iter().enumerate() {
            let inverse = rows.inverse(smoothing)?;
            // The copies of a periodic axis hold the same sums and count once.
            let free = if rows.periodic {
                rows.count - 3
            } else {
                rows.count
            };
            lattice = apply_dense(Axis::of(&sizes, axis, 3), &inverse, free, &lattice);
        }
        Ok(self.add(spans, lattice, &rows))
    }

    fn rows(&self, spans: usize) -> [Rows; 3] {
        std::array::from_fn(|axis| Rows::build(spans, self.grid.parameters[axis], axis))
    }

    fn add(&mut self, spans: usize, correction: Vec<f64>, rows: &[Rows; 3]) -> Level {
        subtract(&mut self.grid, rows, &correction);
        if self.spans == 0 {
            self.lattice = correction;
        } else {
            while self.spans < spans {
                self.lattice = refine_lattice(self.spans, 3, &self.lattice);
                self.spans *= 2;
            }
            let pairs = self.lattice.iter_mut().zip(correction);
            pairs.for_each(|(sum, c)| *sum += c);
        }
        self.spans = spans;
        self.close();
        let supported = rows.iter().map(|rows| {
            let squares = rows.squares();
            squares.iter().filter(|&&square| square > 0.0).count()
        });
        let residuals = || self.grid.values.chunks_exact(3);
        let norm = |r: &[f64]| r.iter().map(|x| x * x).sum::<f64>();
        let squares: f64 = residuals().map(norm).sum();
        Level {
            spans,
            rms: (squares / residuals().len() as f64).sqrt(),
            max: residuals().map(norm).fold(0.0, f64::max).sqrt(),
            supported: supported.product(),
        }
    }

    /// Copies the first three layers to the last three, whatever rounding refinement has caused.
    fn close(&mut self) {
        for line in self.lattice.chunks_exact_mut(3 * (self.spans + 3)) {
            for at in 3 * self.spans..line.len() {
                line[at] = line[at - 3 * self.spans];
            }
        }
    }

    /// The spline, and what it leaves of the samples.
    pub(super) fn finish(self) -> (TrivariateSpline, Vec<f64>) {
        let spline = TrivariateSpline::from_flat(self.spans, &self.lattice);
        (spline, self.grid.values)
    }
}

/// A square matrix applied along an axis, of which only the first `free` columns count.
fn apply_dense(axis: Axis, matrix: &DMatrix<f64>, free: usize, values: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; values.len()];
    let block = axis.count * axis.inner;
    for (source, target) in values.chunks_exact(block).zip(out.chunks_exact_mut(block)) {
        for (row, line) in target.chunks_exact_mut(axis.inner).enumerate() {
            for (column, from) in source.chunks_exact(axis.inner).take(free).enumerate() {
                let weight = matrix[(row, column)];
                line.iter_mut()
                    .zip(from)
                    .for_each(|(sum, x)| *sum += weight * x);
            }
        }
    }
    out
}

/// Samples of a cylinder: each point of the axis joined to those of its loop.
pub(super) fn cylinder_values(
    axis: &[Point3<f64>],
    loops: &[Point3<f64>],
    meridians: usize,
    radii: &[f64],
) -> Vec<f64> {
    let mut values = Vec::with_capacity(3 * loops.len() * radii.len());
    for &radius in radii {
        for (centre, points) in axis.iter().zip(loops.chunks_exact(meridians)) {
            for point in points {
                let p = centre + (point - centre) * radius;
                values.extend([p.x, p.y, p.z]);
            }
        }
    }
    values
}
