//! Bernstein coefficients of the determinant of the first derivatives, and their gradients.
//!
//! # Notation
//! On a span, in its own coordinates, the derivatives `D_u`, `D_v`, `D_w` are of degrees (2, 3, 3),
//! (3, 2, 3), (3, 3, 2); the determinant `D_u · (D_v × D_w)` is of degree (8, 8, 8). Coefficients times
//! their binomials multiply as plain polynomials do: no evaluation, no division, no system.
//!
//! # Rounding
//! Derivatives are differences of control points, one rounding each; everything after that adds up products
//! with positive weights that sum to one, 6 products of a component of each derivative in all, with
//! at most 256 roundings on any way. So with the largest absolute differences `M_u`, `M_v`, `M_w`
//! of the span every coefficient is off by at most `γ 6 M_u M_v M_w`, `γ = 256 u / (1 - 256 u)`.

use std::sync::LazyLock;

use msplines_common::Point3;
use msplines_common::bspline::bernstein::binomial;
use pulp::Arch;

/// Spans that are worked on side by side.
pub(crate) const LANES: usize = 8;

/// A number for each of the spans side by side.
pub(crate) type Lane = [f64; LANES];

/// Coefficients of a determinant.
pub(crate) const COEFFICIENTS: usize = 729;

/// A little above `6 · 256 u / (1 - 256 u)`, with the roundings of the bound itself.
const ROUNDING: f64 = 1.75e-13;

/// Differences between which no product of three leaves the range of normal numbers.
const SAFE: std::ops::Range<f64> = 1e-90..1e90;

/// Sizes of the arrays of the three derivatives, of `D_v × D_w` and of the determinant.
const SIZES: [[usize; 3]; 3] = [[3, 4, 4], [4, 3, 4], [4, 4, 3]];
const CROSS: [usize; 3] = [7, 6, 6];
const FULL: [usize; 3] = [9, 9, 9];

/// Determinants of a few spans.
pub(crate) struct Determinants {
    /// Coefficients of the derivatives times their binomials: `[direction][component]`.
    derivatives: [[Vec<Lane>; 3]; 3],
    cross: [Vec<Lane>; 3],
    /// Bernstein coefficients of the determinants, the first index fastest.
    pub(crate) coefficients: Vec<Lane>,
    /// How far each coefficient may be off, at most; infinite if that is not known.
    pub(crate) error: Lane,
    /// Whether some derivative vanishes on the whole span, so that the determinant does.
    pub(crate) flat: [bool; LANES],
}

impl Determinants {
    /// The determinants of spans with these control points, in lines of the first index.
    pub(crate) fn build(blocks: &[[[Point3<f64>; 4]; 16]; LANES]) -> Self {
        Arch::new().dispatch(
            #[inline(always)]
            || Self::build_here(blocks),
        )
    }

    #[inline(always)]
    fn build_here(blocks: &[[[Point3<f64>; 4]; 16]; LANES]) -> Self {
        let (mut error, mut flat) = ([0.0; LANES], [false; LANES]);
        let mut largest = [[0.0_f64; 3]; LANES];
        let derivatives = [0, 1, 2].map(|direction| {
            [0, 1, 2].map(|component| {
                let differences = differences(blocks, direction, component);
                for lane in 0..LANES {
                    let size = differences.iter().map(|d| d[lane].abs());
                    largest[lane][direction] = size.fold(largest[lane][direction], f64::max);
                }
                to_scaled_bernstein(differences, direction)
            })
        });
        for (lane, sizes) in largest.iter().enumerate() {
            flat[lane] = sizes.contains(&0.0);
            let safe = sizes.iter().all(|m| SAFE.contains(m));
            error[lane] = match (flat[lane], safe) {
                (true, _) => 0.0,
                (false, true) => ROUNDING * sizes.iter().product::<f64>(),
                (false, false) => f64::INFINITY,
            };
        }
        let [_, v, w] = &derivatives;
        let cross = [0, 1, 2].map(|c| {
            let (d, e) = ((c + 1) % 3, (c + 2) % 3);
            let mut out = vec![[0.0; LANES]; CROSS.iter().product()];
            convolve(&v[d], SIZES[1], &w[e], SIZES[2], &mut out, 1.0);
            convolve(&v[e], SIZES[1], &w[d], SIZES[2], &mut out, -1.0);
            out
        });
        let mut coefficients = vec![[0.0; LANES]; COEFFICIENTS];
        for c in 0..3 {
            convolve(
                &derivatives[0][c],
                SIZES[0],
                &cross[c],
                CROSS,
                &mut coefficients,
                1.0,
            );
        }
        for (coefficient, weight) in coefficients.iter_mut().zip(&BINOMIALS[3]) {
            coefficient.iter_mut().for_each(|c| *c /= weight);
        }
        Self {
            derivatives,
            cross,
            coefficients,
            error,
            flat,
        }
    }

    /// The gradient by the control points, in lines of the first index, of a function whose gradient by
    /// the coefficients is given.
    pub(crate) fn gradient(&self, by_coefficient: &[Lane]) -> [[[Lane; 3]; 4]; 16] {
        Arch::new().dispatch(
            #[inline(always)]
            || self.gradient_here(by_coefficient),
        )
    }

    #[inline(always)]
    fn gradient_here(&self, by_coefficient: &[Lane]) -> [[[Lane; 3]; 4]; 16] {
        let weighted = by_coefficient.iter().zip(&BINOMIALS[3]);
        let scaled = weighted.map(|(lane, weight)| lane.map(|g| g / weight));
        let g: Vec<Lane> = scaled.collect();
        let [u, v, w] = &self.derivatives;
        let zero = |size: [usize; 3]| vec![[0.0; LANES]; size.iter().product()];
        let mut by_u = [0, 1, 2].map(|_| zero(SIZES[0]));
        let mut by_cross = [0, 1, 2].map(|_| zero(CROSS));
        for c in 0..3 {
            correlate(&g, FULL, &self.cross[c], CROSS, &mut by_u[c], 1.0);
            correlate(&g, FULL, &u[c], SIZES[0], &mut by_cross[c], 1.0);
        }
        // g · (v × w) has the gradient w × g by v and g × v by w.
        let mut by_v = [0, 1, 2].map(|_| zero(SIZES[1]));
        let mut by_w = [0, 1, 2].map(|_| zero(SIZES[2]));
        for c in 0..3 {
            let (d, e) = ((c + 1) % 3, (c + 2) % 3);
            correlate(&by_cross[e], CROSS, &w[d], SIZES[2], &mut by_v[c], 1.0);
            correlate(&by_cross[d], CROSS, &w[e], SIZES[2], &mut by_v[c], -1.0);
            correlate(&by_cross[d], CROSS, &v[e], SIZES[1], &mut by_w[c], 1.0);
            correlate(&by_cross[e], CROSS, &v[d], SIZES[1], &mut by_w[c], -1.0);
        }
        let mut out = [[[[0.0; LANES]; 3]; 4]; 16];
        for (direction, components) in [by_u, by_v, by_w].into_iter().enumerate() {
            for (component, values) in components.into_iter().enumerate() {
                add_transposed(values, direction, component, &mut out);
            }
        }
        out
    }
}

/// Differences of a component of the control points along a direction.
#[inline(always)]
fn differences(
    blocks: &[[[Point3<f64>; 4]; 16]; LANES],
    direction: usize,
    component: usize,
) -> Vec<Lane> {
    let size = SIZES[direction];
    let step = [1, 4, 16][direction];
    (0..size.iter().product())
        .map(|at| {
            let from = place(at, size, [4; 3]);
            let value = |lane: usize, p: usize| blocks[lane][p / 4][p % 4][component];
            std::array::from_fn(|lane| value(lane, from + step) - value(lane, from))
        })
        .collect()
}

/// Index in an array of `to` sizes of the place that `at` is in one of `from` sizes.
fn place(at: usize, from: [usize; 3], to: [usize; 3]) -> usize {
    let [i, j, k] = [
        at % from[0],
        at / from[0] % from[1],
        at / (from[0] * from[1]),
    ];
    i + to[0] * (j + to[1] * k)
}

/// Binomials of the three degrees of all coefficients of an array.
fn binomials(size: [usize; 3]) -> Vec<f64> {
    let index = |at: usize| {
        [
            at % size[0],
            at / size[0] % size[1],
            at / (size[0] * size[1]),
        ]
    };
    let weight = |at| {
        (0..3)
            .map(|d| binomial(size[d] - 1, index(at)[d]))
            .product()
    };
    (0..size.iter().product()).map(weight).collect()
}

/// Binomials of the three derivatives and of the determinant.
static BINOMIALS: LazyLock<[Vec<f64>; 4]> =
    LazyLock::new(|| [SIZES[0], SIZES[1], SIZES[2], FULL].map(binomials));

/// From B-spline to Bernstein coefficients, quadratic or cubic; with these rows all weights are
/// positive and sum to one.
const QUADRATIC: [[f64; 3]; 3] = [[0.5, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.5, 0.5]];
const CUBIC: [[f64; 4]; 4] = [
    [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0, 0.0],
    [0.0, 2.0 / 3.0, 1.0 / 3.0, 0.0],
    [0.0, 1.0 / 3.0, 2.0 / 3.0, 0.0],
    [0.0, 1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0],
];

/// Bernstein coefficients, times their binomials, of B-spline coefficients of a derivative.
#[inline(always)]
fn to_scaled_bernstein(mut values: Vec<Lane>, direction: usize) -> Vec<Lane> {
    let size = SIZES[direction];
    for axis in 0..3 {
        change(&mut values, size, axis, |row, column| {
            if axis == direction {
                QUADRATIC[row][column]
            } else {
                CUBIC[row][column]
            }
        });
    }
    for (lane, weight) in values.iter_mut().zip(&BINOMIALS[direction]) {
        lane.iter_mut().for_each(|value| *value *= weight);
    }
    values
}

/// Adds the transpose of differences and [`to_scaled_bernstein`].
#[inline(always)]
fn add_transposed(
    mut values: Vec<Lane>,
    direction: usize,
    component: usize,
    out: &mut [[[Lane; 3]; 4]; 16],
) {
    let size = SIZES[direction];
    for (lane, weight) in values.iter_mut().zip(&BINOMIALS[direction]) {
        lane.iter_mut().for_each(|value| *value *= weight);
    }
    for axis in 0..3 {
        change(&mut values, size, axis, |row, column| {
            if axis == direction {
                QUADRATIC[column][row]
            } else {
                CUBIC[column][row]
            }
        });
    }
    let step = [1, 4, 16][direction];
    for (at, lane) in values.iter().enumerate() {
        let from = place(at, size, [4; 3]);
        let to = from + step;
        for (l, value) in lane.iter().enumerate() {
            out[from / 4][from % 4][component][l] -= value;
            out[to / 4][to % 4][component][l] += value;
        }
    }
}

/// Applies a small matrix along an axis.
#[inline(always)]
fn change(values: &mut [Lane], size: [usize; 3], axis: usize, entry: impl Fn(usize, usize) -> f64) {
    let stride: usize = size[..axis].iter().product();
    let count = size[axis];
    for block in values.chunks_exact_mut(stride * count) {
        for start in 0..stride {
            let mut line = [[0.0; LANES]; 4];
            for (row, sums) in line[..count].iter_mut().enumerate() {
                for column in 0..count {
                    let (weight, value) = (entry(row, column), block[start + column * stride]);
                    for l in 0..LANES {
                        sums[l] += weight * value[l];
                    }
                }
            }
            for (row, lane) in line[..count].iter().enumerate() {
                block[start + row * stride] = *lane;
            }
        }
    }
}

/// Adds `sign` times the product of two polynomials in plain powers.
#[inline(always)]
fn convolve(a: &[Lane], sa: [usize; 3], b: &[Lane], sb: [usize; 3], out: &mut [Lane], sign: f64) {
    let so: [usize; 3] = std::array::from_fn(|d| sa[d] + sb[d] - 1);
    for (at, x) in a.iter().enumerate() {
        let x = x.map(|value| sign * value);
        let offset = place(at, sa, so);
        for (row, line) in b.chunks_exact(sb[0]).enumerate() {
            let start = offset + so[0] * (row % sb[1] + so[1] * (row / sb[1]));
            for (sum, y) in out[start..start + sb[0]].iter_mut().zip(line) {
                for l in 0..LANES {
                    sum[l] += x[l] * y[l];
                }
            }
        }
    }
}

/// Adds `sign` times the transpose of a product with `b`, applied to `g`.
#[inline(always)]
fn correlate(g: &[Lane], sg: [usize; 3], b: &[Lane], sb: [usize; 3], out: &mut [Lane], sign: f64) {
    let so: [usize; 3] = std::array::from_fn(|d| sg[d] + 1 - sb[d]);
    for (at, sum) in out.iter_mut().enumerate() {
        let offset = place(at, so, sg);
        let mut total = [0.0; LANES];
        for (row, line) in b.chunks_exact(sb[0]).enumerate() {
            let start = offset + sg[0] * (row % sb[1] + sg[1] * (row / sb[1]));
            for (x, y) in g[start..start + sb[0]].iter().zip(line) {
                for l in 0..LANES {
                    total[l] += x[l] * y[l];
                }
            }
        }
        for l in 0..LANES {
            sum[l] += sign * total[l];
        }
    }
}
