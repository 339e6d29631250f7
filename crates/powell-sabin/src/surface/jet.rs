//! Value, first and second derivatives, and how they change under maps of the plane.
//!
//! # Notation
//! First derivatives are by `u` and `v`, second ones by `uu`, `uv` and `vv`. Those of a map into the plane
//! are complex numbers.

use msplines_common::Vector3;
use msplines_common::evaluate::Order;
use nalgebra::Complex;

use crate::element::{MacroTriangle, gradient, value};
use crate::spline::PowellSabinSpline;
use crate::tangent::unit_normal;

/// A point of a surface and its derivatives; those above the order asked for are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Jet {
    pub(super) value: Vector3<f64>,
    pub(super) first: [Vector3<f64>; 2],
    pub(super) second: [Vector3<f64>; 3],
}

/// A number and its derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct ScalarJet {
    pub(super) value: f64,
    pub(super) first: [f64; 2],
    pub(super) second: [f64; 3],
}

/// A point of the plane and its derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct PlaneJet {
    pub(super) value: Complex<f64>,
    pub(super) first: [Complex<f64>; 2],
    pub(super) second: [Complex<f64>; 3],
}

/// Returns a function of nine numbers at the corners of a macro triangle.
pub(super) fn scalar_jet(
    triangle: &MacroTriangle,
    corners: &[f64; 9],
    at: [f64; 3],
    order: Order,
) -> ScalarJet {
    let at = triangle.locate(at);
    let mut jet = ScalarJet {
        value: value(&triangle.ordinates(corners), &at),
        ..ScalarJet::default()
    };
    if order > Order::Value {
        let gradients = triangle.gradients(corners);
        jet.first = gradient(&gradients, &at);
        if order > Order::First {
            jet.second = triangle.hessian(&gradients, at.micro);
        }
    }
    jet
}

/// Returns a spline of three components at a point of a face, by its flat coordinates.
pub(super) fn spline_jet(spline: &PowellSabinSpline, face: u32, at: [f64; 3], order: Order) -> Jet {
    let triangle = spline.macro_triangle(face);
    let parts = [0, 1, 2].map(|c| {
        let corners = spline.corner_numbers(face, c);
        scalar_jet(&triangle, &corners, at, order)
    });
    let vector = |f: &dyn Fn(&ScalarJet) -> f64| Vector3::from(parts.each_ref().map(f));
    Jet {
        value: vector(&|p| p.value),
        first: [0, 1].map(|i| vector(&|p| p.first[i])),
        second: [0, 1, 2].map(|i| vector(&|p| p.second[i])),
    }
}

impl Jet {
    /// Returns the derivatives by coordinates of which those here are affine functions, with the
    /// derivatives `change[new][old]`.
    pub(super) fn changed(&self, change: [[f64; 2]; 2]) -> Self {
        let first = change.map(|row| row[0] * self.first[0] + row[1] * self.first[1]);
        let [a, b] = change;
        Self {
            value: self.value,
            first,
            second: [self.bend(a, a), self.bend(a, b), self.bend(b, b)],
        }
    }

    /// Returns the unit normal, if the derivatives span a plane.
    pub(super) fn normal(&self) -> Option<Vector3<f64>> {
        let [u, v] = self.first;
        unit_normal(&u, &v)
    }

    /// The second derivative along two directions.
    fn bend(&self, x: [f64; 2], y: [f64; 2]) -> Vector3<f64> {
        let [uu, uv, vv] = self.second;
        x[0] * (uu * y[0] + uv * y[1]) + x[1] * (uv * y[0] + vv * y[1])
    }

    /// Returns the derivatives after a map, at whose value those here were taken.
    pub(super) fn after(&self, map: &PlaneJet) -> Self {
        let slope = |d: Complex<f64>| d.re * self.first[0] + d.im * self.first[1];
        let [u, v] = map.first.map(|d| [d.re, d.im]);
        let [uu, uv, vv] = map.second.map(slope);
        Self {
            value: self.value,
            first: map.first.map(slope),
            second: [
                self.bend(u, u) + uu,
                self.bend(u, v) + uv,
                self.bend(v, v) + vv,
            ],
        }
    }

    /// Adds `weight` times the way from `from` to `to`.
    pub(super) fn add_blend(&mut self, weight: &ScalarJet, from: &Self, to: &Self) {
        let value = to.value - from.value;
        let first = [0, 1].map(|i| to.first[i] - from.first[i]);
        self.value += weight.value * value;
        for (i, slope) in first.iter().enumerate() {
            self.first[i] += weight.first[i] * value + weight.value * slope;
        }
        for (entry, [i, j]) in [[0, 0], [0, 1], [1, 1]].into_iter().enumerate() {
            self.second[entry] += weight.second[entry] * value
                + weight.first[i] * first[j]
                + weight.first[j] * first[i]
                + weight.value * (to.second[entry] - from.second[entry]);
        }
    }
}
