//! Numbers side by side, which the compiler turns into vector instructions.

use std::array::from_fn;
use std::ops::{Add, Mul, Neg, Sub};

/// How many numbers are side by side.
pub(super) const WIDTH: usize = 8;

/// One number for each of several cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lanes(pub(super) [f64; WIDTH]);

impl Lanes {
    #[inline(always)]
    pub(super) const fn of(value: f64) -> Self {
        Self([value; WIDTH])
    }

    #[inline(always)]
    fn each(self, f: impl Fn(f64) -> f64) -> Self {
        let mut out = self;
        for lane in 0..WIDTH {
            out.0[lane] = f(self.0[lane]);
        }
        out
    }

    #[inline(always)]
    fn with(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let mut out = self;
        for lane in 0..WIDTH {
            out.0[lane] = f(self.0[lane], other.0[lane]);
        }
        out
    }

    #[inline(always)]
    pub(super) fn sqrt(self) -> Self {
        self.each(f64::sqrt)
    }

    #[inline(always)]
    pub(super) fn inverse(self) -> Self {
        self.each(|a| 1.0 / a)
    }

    /// Returns `a^(-1/3)` of positive numbers, to a few units in the last place.
    #[inline(always)]
    pub(super) fn inverse_cube_root(self) -> Self {
        // A third of the exponent is good to 4 %; each Newton step doubles the digits.
        let mut root = self.each(|a| f64::from_bits(0x553e_f0ff_289d_d796 - a.to_bits() / 3));
        for _ in 0..4 {
            root = root.with(self, |r, a| r * (4.0 / 3.0 - (1.0 / 3.0) * a * r * r * r));
        }
        root
    }

    /// Returns `yes` where this is positive, else `no`.
    #[inline(always)]
    pub(super) fn choose(self, yes: Self, no: Self) -> Self {
        Self(from_fn(|lane| {
            if self.0[lane] > 0.0 {
                yes.0[lane]
            } else {
                no.0[lane]
            }
        }))
    }

    #[inline(always)]
    pub(super) fn all_positive(self) -> bool {
        self.0.iter().all(|&a| a > 0.0)
    }
}

impl Add for Lanes {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.with(other, |a, b| a + b)
    }
}

impl Sub for Lanes {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.with(other, |a, b| a - b)
    }
}

impl Mul for Lanes {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.with(other, |a, b| a * b)
    }
}

impl Neg for Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.each(|a| -a)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cube_roots_are_cube_roots() {
        for exponent in -290..290 {
            let a = 1.7 * 10f64.powi(exponent);
            let root = Lanes::of(a).inverse_cube_root().0[0];
            assert!((root * a.cbrt() - 1.0).abs() < 1e-14, "{a}");
        }
    }
}
