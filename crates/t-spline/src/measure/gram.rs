//! How independent the functions of a space are.
//!
//! # Notation
//! `G_ij = ∫ φ_i φ_j dx dy` over the cylinders, of the blending functions over their sum and the monomials
//! of caps, as they are evaluated. `D⁻¹ G D⁻¹`, `D` the roots of the diagonal, has the same condition in
//! whatever units monomials are.
//!
//! # Reference
//! [He2006] §3.3. Deviation: here it is measured.

use msplines_common::evaluate::Order;
use msplines_common::linalg::{
    Cholesky, FactorError, Mat, Ordering, OrderingError, Symbolic, SymmetricMatrix,
};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::lanczos::{Extreme, largest};
use crate::complex::{Point, UNITS};
use crate::space::TSplineSpace;
use crate::tmesh::Leaf;

/// Gauss's rule of four on `[0, 1]`: exact for products of cubics.
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];
/// Cells along a side of a leaf: functions have knots in the middle of leaves.
const CELLS: usize = 2;
/// Cells that meet a cap are at most so wide, over its radius.
const IN_CAP: f64 = 0.25;
/// Relative accuracy of eigenvalues.
const ACCURACY: f64 = 1e-8;
/// Functions are dependent if the least eigenvalue is below this share of the largest: products and sums of
/// the matrix are rounded to not much less.
const DEPENDENT: f64 = 1e-14;

/// How independent functions are.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gram {
    /// The largest eigenvalue of the scaled matrix.
    pub largest: f64,
    /// The least one; nothing if rounding hides it.
    pub smallest: Option<f64>,
    /// Their ratio; its relative error is about the ratio times `1e-16`, and below `1e-7` otherwise.
    pub condition: Option<f64>,
    /// Whether no combination of functions vanishes, apart from those without influence: the least
    /// eigenvalue is above `1e-14` of the largest.
    pub independent: bool,
    /// Unknowns without any influence on the surface: functions within the core of a cap. They are left
    /// out of the matrix.
    pub idle: usize,
}

/// Why functions cannot be measured.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GramError {
    /// A matrix that cannot be ordered.
    #[error("the products of the functions: {0}")]
    Ordering(#[from] OrderingError),
    /// A matrix of another pattern.
    #[error("the products of the functions: {0}")]
    Factor(FactorError),
}

/// Returns the extreme eigenvalues of the scaled Gram matrix of a space, by Lanczos's method with it and
/// with its inverse.
///
/// The cost is that of the rows of 64 points per leaf, a sparse factorisation, and some dozen solves.
///
/// # Errors
/// A matrix that cannot be ordered.
pub fn gram(space: &TSplineSpace, seed: u64) -> Result<Gram, GramError> {
    let whole = matrix(space);
    let diagonal = whole.diagonal();
    let idle = diagonal.iter().filter(|d| **d <= 0.0).count();
    let scaled = scaled(&whole, &diagonal);
    let size = scaled.size();
    let top = largest(size, |x| scaled.multiply(x), ACCURACY, seed);
    let ordering = Ordering::nested_dissection(&scaled)?;
    let symbolic = Symbolic::analyze_kept(&scaled, &ordering, |i| diagonal[i] > 0.0);
    let factored = Cholesky::factor_kept(symbolic, &scaled, |i| diagonal[i] > 0.0);
    let smallest = match factored {
        Ok(factor) => {
            let solve = |x: msplines_common::linalg::MatRef<'_, f64>| {
                let mut x = Mat::from_fn(
                    size,
                    1,
                    |i, _| {
                        if diagonal[i] > 0.0 { x[(i, 0)] } else { 0.0 }
                    },
                );
                factor.solve_in_place(x.as_mut());
                x
            };
            let Extreme { value, .. } = largest(size, solve, ACCURACY, seed);
            Some(1.0 / value)
        }
        Err(FactorError::NotPositiveDefinite { .. }) => None,
        Err(error) => return Err(GramError::Factor(error)),
    };
    let smallest = smallest.filter(|s| *s > 0.0);
    Ok(Gram {
        largest: top.value,
        smallest,
        condition: smallest.map(|s| top.value / s),
        independent: smallest.is_some_and(|s| s > DEPENDENT * top.value),
        idle,
    })
}

/// Returns the matrix with a diagonal of ones, and zeros where there is nothing.
fn scaled(matrix: &SymmetricMatrix, diagonal: &[f64]) -> SymmetricMatrix {
    let scale = |d: f64| if d > 0.0 { 1.0 / d.sqrt() } else { 0.0 };
    let scales: Vec<f64> = diagonal.iter().map(|&d| scale(d)).collect();
    let mut scaled = matrix.clone();
    let starts = matrix.starts();
    for column in 0..matrix.size() {
        for at in starts[column]..starts[column + 1] {
            let factor = scales[column] * scales[matrix.rows()[at] as usize];
            scaled.values_mut()[at] *= factor;
        }
    }
    scaled
}

/// Returns the Gram matrix, leaf by leaf.
fn matrix(space: &TSplineSpace) -> SymmetricMatrix {
    let of_leaf = |leaf: &Leaf| products(space, leaf);
    let leaves = space.mesh().leaves().par_iter();
    let mut entries: Vec<(u32, u32, f64)> = leaves.flat_map_iter(of_leaf).collect();
    entries.extend((0..space.unknowns() as u32).map(|i| (i, i, 0.0)));
    SymmetricMatrix::from_lower_triplets(space.unknowns(), &entries)
}

/// Returns the lower triangle of what a leaf adds.
fn products(space: &TSplineSpace, leaf: &Leaf) -> Vec<(u32, u32, f64)> {
    let points = quadrature(space, leaf);
    let places: Vec<Point> = points.iter().map(|p| p.0).collect();
    let rows = space.rows(&places, Order::Value);
    let mut unknowns: Vec<u32> = (0..rows.len())
        .flat_map(|i| rows.row(i).unknowns.to_vec())
        .collect();
    unknowns.sort_unstable();
    unknowns.dedup();
    let size = unknowns.len();
    let mut sums = vec![0.0; size * size];
    let mut dense = vec![0.0; size];
    for (i, &(_, weight)) in points.iter().enumerate() {
        let row = rows.row(i);
        dense.fill(0.0);
        for (unknown, value) in row.unknowns.iter().zip(row.values) {
            if let Ok(place) = unknowns.binary_search(unknown) {
                dense[place] += value;
            }
        }
        for a in (0..size).filter(|&a| dense[a] != 0.0) {
            let factor = weight * dense[a];
            let line = &mut sums[a * size..a * size + a + 1];
            line.iter_mut()
                .zip(&dense)
                .for_each(|(s, b)| *s += factor * b);
        }
    }
    let pairs = (0..size).flat_map(|a| (0..=a).map(move |b| (a, b)));
    let kept = pairs.filter(|&(a, b)| sums[a * size + b] != 0.0);
    kept.map(|(a, b)| (unknowns[a], unknowns[b], sums[a * size + b]))
        .collect()
}

/// Returns points of a leaf and their weights, in square units of the form's 1.
fn quadrature(space: &TSplineSpace, leaf: &Leaf) -> Vec<(Point, f64)> {
    let side = |[from, to]: [i64; 2]| [from as f64, to as f64];
    let mut pending = vec![([side(leaf.x), side(leaf.y)], 0)];
    let mut points = Vec::new();
    while let Some(([x, y], depth)) = pending.pop() {
        let [w, h] = [x[1] - x[0], y[1] - y[0]];
        let radii = space
            .caps()
            .meeting(leaf.cylinder, x, y)
            .map(|cap| cap.radius);
        let least = IN_CAP * UNITS * radii.fold(f64::INFINITY, f64::min);
        let cuts = if depth == 0 {
            [CELLS; 2]
        } else {
            [w, h].map(|side| if side > least { 2 } else { 1 })
        };
        if cuts == [1, 1] {
            let inner = GAUSS.into_iter().flat_map(|s| GAUSS.map(|t| (s, t)));
            points.extend(inner.map(|((s, a), (t, b))| {
                let at = Point {
                    cylinder: leaf.cylinder,
                    x: x[0] + s * w,
                    y: y[0] + t * h,
                };
                (at, a * b * w * h / (UNITS * UNITS))
            }));
            continue;
        }
        let part = |[from, to]: [f64; 2], cuts: usize, k: usize| {
            let at = |k: usize| from + (to - from) * k as f64 / cuts as f64;
            [at(k), at(k + 1)]
        };
        for (i, j) in (0..cuts[0]).flat_map(|i| (0..cuts[1]).map(move |j| (i, j))) {
            pending.push(([part(x, cuts[0], i), part(y, cuts[1], j)], depth + 1));
        }
    }
    points
}
