//! Values with two derivatives, and the monomials of caps.

use nalgebra::Complex;

/// A function of `x` and `y` up to second order: value, `x`, `y`, `xx`, `xy`, `yy`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Jet(pub [f64; 6]);

impl Jet {
    /// The function 1.
    pub const ONE: Self = Self([1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);

    /// Returns the product.
    #[must_use]
    #[inline]
    pub fn times(self, other: Self) -> Self {
        let (Self(f), Self(g)) = (self, other);
        Self([
            f[0] * g[0],
            f[1] * g[0] + f[0] * g[1],
            f[2] * g[0] + f[0] * g[2],
            f[3] * g[0] + 2.0 * f[1] * g[1] + f[0] * g[3],
            f[4] * g[0] + f[1] * g[2] + f[2] * g[1] + f[0] * g[4],
            f[5] * g[0] + 2.0 * f[2] * g[2] + f[0] * g[5],
        ])
    }

    /// Returns a function of this one, from its value and first two derivatives.
    #[must_use]
    #[inline]
    pub fn through(self, [value, first, second]: [f64; 3]) -> Self {
        let Self(g) = self;
        Self([
            value,
            first * g[1],
            first * g[2],
            first * g[3] + second * g[1] * g[1],
            first * g[4] + second * g[1] * g[2],
            first * g[5] + second * g[2] * g[2],
        ])
    }
}

/// Calls back for every monomial `Re(w)^(n-j) Im(w)^j` up to a total degree `n`, by `n`, then by `j`, with
/// its derivatives by `x` and `y`, from `w` and its derivatives by `z`.
#[inline]
pub fn monomials(
    degree: u8,
    w: Complex<f64>,
    [first, second]: [Complex<f64>; 2],
    mut each: impl FnMut(usize, Jet),
) {
    let a = Jet([w.re, first.re, -first.im, second.re, -second.im, -second.re]);
    let b = Jet([w.im, first.im, first.re, second.im, second.re, -second.im]);
    // Row n of the triangle is a times row n - 1, and b times its last.
    let degree = usize::from(degree);
    let mut row = Vec::with_capacity(degree + 1);
    row.push(Jet::ONE);
    each(0, Jet::ONE);
    let mut place = 1;
    for _ in 0..degree {
        let last = row[row.len() - 1].times(b);
        for jet in &mut row {
            *jet = jet.times(a);
        }
        row.push(last);
        for &jet in &row {
            each(place, jet);
            place += 1;
        }
    }
}
