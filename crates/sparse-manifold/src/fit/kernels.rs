//! Products with the matrix of a chart, as loops for the vector units of the machine.
//!
//! # Notation
//! `A` has a row for each of `K` samples and a column for each of `L` atoms; data are
//! `[component][sample]`, coefficients of all atoms `[component][atom]`, those of a support
//! `[atom][component]`.

use pulp::NullaryFnOnce;

/// Lanes of a sum that do not wait for each other.
const LANES: usize = 8;

/// Adds `Aᵀ t` to `out`, from the rows of `A`.
pub(super) struct Correlations<'a> {
    pub rows: &'a [f64],
    pub samples: usize,
    pub data: &'a [f64],
    pub out: &'a mut [f64],
}

impl NullaryFnOnce for Correlations<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let width = self.rows.len() / self.samples;
        let data = self.data.chunks_exact(self.samples);
        for (out, data) in self.out.chunks_exact_mut(width).zip(data) {
            let mut fours = self.rows.chunks_exact(4 * width);
            let mut factors = data.chunks_exact(4);
            for (four, f) in (&mut fours).zip(&mut factors) {
                let (a, rest) = four.split_at(width);
                let (b, rest) = rest.split_at(width);
                let (c, d) = rest.split_at(width);
                let rows = a.iter().zip(b).zip(c.iter().zip(d));
                for (sum, ((a, b), (c, d))) in out.iter_mut().zip(rows) {
                    *sum += (f[0] * a + f[1] * b) + (f[2] * c + f[3] * d);
                }
            }
            let rest = fours.remainder().chunks_exact(width);
            for (row, &factor) in rest.zip(factors.remainder()) {
                for (sum, x) in out.iter_mut().zip(row) {
                    *sum += factor * x;
                }
            }
        }
    }
}

/// Sets `out` to `A_Sᵀ t`, from the columns of `A`.
pub(super) struct Gradient<'a> {
    pub columns: &'a [f64],
    pub samples: usize,
    pub support: &'a [u16],
    pub data: &'a [f64],
    pub out: &'a mut [f64],
}

impl NullaryFnOnce for Gradient<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let n = self.samples;
        let components = self.data.len() / n;
        for (slot, &atom) in self.out.chunks_exact_mut(components).zip(self.support) {
            let column = &self.columns[usize::from(atom) * n..][..n];
            for (sum, data) in slot.iter_mut().zip(self.data.chunks_exact(n)) {
                *sum = dot(column, data);
            }
        }
    }
}

#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let (mut a, mut b) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    for (a, b) in (&mut a).zip(&mut b) {
        for i in 0..LANES {
            sums[i] += a[i] * b[i];
        }
    }
    let rest: f64 = a
        .remainder()
        .iter()
        .zip(b.remainder())
        .map(|(x, y)| x * y)
        .sum();
    sums.iter().sum::<f64>() + rest
}

/// Adds `A_S c` to `data`, from the columns of `A`.
pub(super) struct Accumulate<'a> {
    pub columns: &'a [f64],
    pub samples: usize,
    pub support: &'a [u16],
    pub coefficients: &'a [f64],
    pub data: &'a mut [f64],
}

impl NullaryFnOnce for Accumulate<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let n = self.samples;
        let components = self.data.len() / n;
        let coefficients = self.coefficients.chunks_exact(components);
        for (&atom, c) in self.support.iter().zip(coefficients) {
            let column = &self.columns[usize::from(atom) * n..][..n];
            for (data, &c) in self.data.chunks_exact_mut(n).zip(c) {
                for (sum, x) in data.iter_mut().zip(column) {
                    *sum += c * x;
                }
            }
        }
    }
}
