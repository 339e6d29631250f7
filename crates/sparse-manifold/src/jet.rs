//! Functions of two variables with their derivatives up to order two.

use std::ops::{Add, Mul};

/// A value with its first derivatives `f_u, f_v` and its second ones `f_uu, f_uv, f_vv`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Jet {
    pub value: f64,
    pub first: [f64; 2],
    pub second: [f64; 3],
}

impl Jet {
    /// Returns `f(x(u, v), y(u, v))`, given the jet of `f` by `x` and `y`, and those of `x` and `y`.
    pub(crate) fn of_composition(f: &Self, x: &Self, y: &Self) -> Self {
        let [fx, fy] = f.first;
        let [fxx, fxy, fyy] = f.second;
        let pair = |a: usize, b: usize, second: usize| {
            fxx * x.first[a] * x.first[b]
                + fxy * (x.first[a] * y.first[b] + x.first[b] * y.first[a])
                + fyy * y.first[a] * y.first[b]
                + fx * x.second[second]
                + fy * y.second[second]
        };
        Self {
            value: f.value,
            first: [0, 1].map(|a| fx * x.first[a] + fy * y.first[a]),
            second: [pair(0, 0, 0), pair(0, 1, 1), pair(1, 1, 2)],
        }
    }

    /// Returns the product of a function of the first variable and one of the second, each with its
    /// first two derivatives.
    pub(crate) fn of_product(f: [f64; 3], g: [f64; 3]) -> Self {
        Self {
            value: f[0] * g[0],
            first: [f[1] * g[0], f[0] * g[1]],
            second: [f[2] * g[0], f[1] * g[1], f[0] * g[2]],
        }
    }

    /// Returns the product of two functions of the same variables.
    pub(crate) fn times(&self, g: &Self) -> Self {
        let f = self;
        let mixed = |a: usize, b: usize, i: usize| {
            f.second[i] * g.value
                + f.first[a] * g.first[b]
                + f.first[b] * g.first[a]
                + f.value * g.second[i]
        };
        Self {
            value: f.value * g.value,
            first: [0, 1].map(|i| f.first[i] * g.value + f.value * g.first[i]),
            second: [mixed(0, 0, 0), mixed(0, 1, 1), mixed(1, 1, 2)],
        }
    }

    /// Returns the jet by new variables of which the old ones are `rows` times the new.
    pub(crate) fn turned(&self, rows: [[f64; 2]; 2]) -> Self {
        let linear = |row: [f64; 2]| Self {
            value: 0.0,
            first: row,
            second: [0.0; 3],
        };
        Self::of_composition(self, &linear(rows[0]), &linear(rows[1]))
    }
}

impl Add for Jet {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            first: [0, 1].map(|i| self.first[i] + other.first[i]),
            second: [0, 1, 2].map(|i| self.second[i] + other.second[i]),
        }
    }
}

impl Mul<f64> for Jet {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self {
            value: factor * self.value,
            first: self.first.map(|x| factor * x),
            second: self.second.map(|x| factor * x),
        }
    }
}
