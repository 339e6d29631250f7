//! Moving control points of a surface after its fit.
//!
//! # Notation
//! A point of the surface is `Σ R_i c_i`. To bring some points to where they should be, control vectors
//! change by `δ = Aᵀ λ` with rows `R` in `A`: the least change, `Σ |δ_i|²`, that does it.
//!
//! # Reference
//! [He2006] Eq. (1).

#[cfg(test)]
mod tests;

use std::sync::Arc;

use msplines_common::evaluate::Order;
use msplines_common::{Point3, Vector3};
use nalgebra::{DMatrix, DVector};

use crate::caps::CapKind;
use crate::complex::{Border, Point};
use crate::space::TSplineSpace;
use crate::spline::TSpline;

/// How far beyond the end of its cylinder a pole is put, in circumferences: `exp(-16 pi)` is nothing.
const FAR: f64 = 8.0;
/// Points to be moved are too near to each other for different movements if the least eigenvalue of the
/// products of their rows, of length 1, is below this.
const APART: f64 = 1e-9;

/// What a control vector is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ControlKind {
    /// The control point of a blending function.
    Point,
    /// The constant of the polynomial of a cap: the point of the surface at its centre.
    Centre {
        /// The cap.
        cap: u32,
    },
    /// Another coefficient of a cap: a vector, not a point.
    Coefficient {
        /// The cap.
        cap: u32,
        /// Its place among the monomials, by degree, from 1.
        monomial: u32,
    },
}

/// A control vector and where it belongs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlPoint {
    /// What it is.
    pub kind: ControlKind,
    /// The anchor of its function, or the centre of its cap: of a pole, far beyond the end of its cylinder.
    pub at: Point,
    /// Its position in space.
    pub position: Point3<f64>,
}

/// A movement of all control points near a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drag {
    /// The place.
    pub at: Point3<f64>,
    /// By how much control points in the middle move.
    pub by: Vector3<f64>,
    /// Distance within which they move, less and less towards it; the nearest one goes wholly.
    pub within: f64,
}

/// A point of the surface, and where it should be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pull {
    /// Where it lies on the cylinders.
    pub at: Point,
    /// Where it should be in space.
    pub to: Point3<f64>,
}

/// A change that is none.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EditError {
    /// A control point that is not there.
    #[error("there is no control point {index}: there are {count}, counted from 0")]
    NoSuchPoint {
        /// What was asked for.
        index: u32,
        /// How many there are.
        count: usize,
    },
    /// A number that is not finite, or a negative distance.
    #[error(
        "movement {index} has a number that is not finite or too large, or a negative distance; give others"
    )]
    Number {
        /// The movement.
        index: usize,
    },
    /// Points of the surface that are the same, or nearly.
    #[error(
        "points of the surface that should go to different places are too near to each other on it; move one of them"
    )]
    TooNear,
}

impl TSplineSpace {
    /// Returns where the centre of a cap lies; that of a pole beyond the end of its cylinder, as far as makes
    /// no difference.
    ///
    /// # Panics
    /// If there is no such cap.
    #[must_use]
    pub fn centre(&self, cap: u32) -> Point {
        let complex = self.mesh().complex();
        match self.caps().caps()[cap as usize].kind {
            CapKind::Zero { index, .. } => {
                let cylinders = 0..complex.cylinders().len() as u32;
                let mut found = cylinders.filter_map(|cylinder| {
                    let mut bottom = complex.border(cylinder, Border::Bottom).iter();
                    let start = bottom.find(|s| s.zero == Some(index))?.start;
                    Some(complex.node(cylinder, start, 0))
                });
                found.next().expect("a zero lies below a cylinder").into()
            }
            CapKind::Pole {
                cylinder, border, ..
            } => {
                let own = &complex.cylinders()[cylinder as usize];
                let [size, height] = [own.circumference, own.height].map(|n| n as f64);
                let y = match border {
                    Border::Bottom => -FAR * size,
                    Border::Top => height + FAR * size,
                };
                Point {
                    cylinder,
                    x: 0.0,
                    y,
                }
            }
        }
    }
}

/// Whether a number may be a length: finite, and its square, too.
fn is_length(x: &f64) -> bool {
    /// The largest that may.
    const LARGEST: f64 = 1e100;
    x.abs() <= LARGEST
}

impl TSpline {
    /// Returns all control vectors, in the order of [`TSpline::control`].
    #[must_use]
    pub fn control_points(&self) -> Vec<ControlPoint> {
        let space = self.space();
        let points = space
            .functions()
            .iter()
            .map(|f| (ControlKind::Point, Point::from(f.node)));
        let caps = (0..).zip(space.caps().caps());
        let coefficients = caps.flat_map(|(cap, own)| {
            let at = space.centre(cap);
            (0..own.coefficients() as u32).map(move |monomial| match monomial {
                0 => (ControlKind::Centre { cap }, at),
                _ => (ControlKind::Coefficient { cap, monomial }, at),
            })
        });
        let kinds = points.chain(coefficients).zip(self.control());
        kinds
            .map(|((kind, at), position)| ControlPoint {
                kind,
                at,
                position: Point3::from(*position),
            })
            .collect()
    }

    /// Returns the surface with some control vectors moved: it changes in their supports only, and not by a
    /// bit elsewhere. One vector may be named several times.
    ///
    /// # Errors
    /// A control point that is not there, or a number that is not finite.
    pub fn with_moved(&self, moves: &[(u32, Vector3<f64>)]) -> Result<Self, EditError> {
        let mut control = self.control().to_vec();
        for (index, &(point, by)) in moves.iter().enumerate() {
            if !by.iter().all(is_length) {
                return Err(EditError::Number { index });
            }
            let count = self.control().len();
            let place = control.get_mut(point as usize);
            *place.ok_or(EditError::NoSuchPoint {
                index: point,
                count,
            })? += by;
        }
        Ok(Self::new(Arc::clone(self.space()), control))
    }

    /// Returns which control points a drag takes along, and how far. Coefficients of caps that are no points
    /// stay.
    ///
    /// # Errors
    /// A number that is not finite, or a negative distance.
    pub fn dragged_by(&self, drag: &Drag) -> Result<Vec<(u32, Vector3<f64>)>, EditError> {
        let mut numbers = drag.at.coords.iter().chain(&drag.by).chain([&drag.within]);
        if !numbers.all(is_length) || drag.within < 0.0 {
            return Err(EditError::Number { index: 0 });
        }
        let is_point = |kind| !matches!(kind, ControlKind::Coefficient { .. });
        let points = self.control_points().into_iter().enumerate();
        let points = points.filter(|(_, p)| is_point(p.kind));
        let distances = points.map(|(i, p)| (i as u32, (p.position - drag.at).norm()));
        let distances: Vec<(u32, f64)> = distances.collect();
        let nearest = distances
            .iter()
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|n| n.0);
        let share = |index: u32, distance: f64| {
            let relative = distance / drag.within;
            if Some(index) == nearest {
                1.0
            } else if relative < 1.0 {
                (1.0 - relative * relative).powi(2)
            } else {
                0.0
            }
        };
        let shares = distances.iter().map(|&(i, d)| (i, share(i, d)));
        let moved = shares.filter(|(_, share)| *share > 0.0);
        Ok(moved.map(|(i, share)| (i, drag.by * share)).collect())
    }

    /// Returns which control vectors move so that points of the surface come to where they should be: the
    /// least change that does it.
    ///
    /// # Errors
    /// Points that are too near to each other on the surface, or a number that is not finite.
    ///
    /// # Panics
    /// If a point names a cylinder that is not there.
    pub fn pulled_by(&self, pulls: &[Pull]) -> Result<Vec<(u32, Vector3<f64>)>, EditError> {
        if pulls.is_empty() {
            return Ok(Vec::new());
        }
        let finite = |p: &Pull| p.to.iter().chain([&p.at.x, &p.at.y]).all(is_length);
        if let Some(index) = pulls.iter().position(|p| !finite(p)) {
            return Err(EditError::Number { index });
        }
        let places: Vec<Point> = pulls.iter().map(|p| p.at).collect();
        let now = self.evaluate(&places, Order::Value).positions;
        let lines = self.lines(&places);
        let mut unknowns: Vec<u32> = lines.iter().flatten().map(|entry| entry.0).collect();
        unknowns.sort_unstable();
        unknowns.dedup();
        let mut rows = DMatrix::<f64>::zeros(pulls.len(), unknowns.len());
        for (i, line) in lines.iter().enumerate() {
            for (unknown, value) in line {
                if let Ok(place) = unknowns.binary_search(unknown) {
                    rows[(i, place)] += value;
                }
            }
        }
        let lengths: Vec<f64> = rows.row_iter().map(|row| row.norm()).collect();
        for (mut row, length) in rows.row_iter_mut().zip(&lengths) {
            row /= *length;
        }
        let products = &rows * rows.transpose();
        if products.symmetric_eigenvalues().min() < APART {
            return Err(EditError::TooNear);
        }
        let factor = products.cholesky().ok_or(EditError::TooNear)?;
        let mut moves = vec![Vector3::zeros(); unknowns.len()];
        for c in 0..3 {
            let due = |i: usize| (pulls[i].to[c] - now[i][c]) / lengths[i];
            let weights = factor.solve(&DVector::from_fn(pulls.len(), |i, _| due(i)));
            let change = rows.tr_mul(&weights);
            moves
                .iter_mut()
                .zip(change.iter())
                .for_each(|(m, x)| m[c] = *x);
        }
        Ok(unknowns.into_iter().zip(moves).collect())
    }

    /// Returns the rows of points.
    fn lines(&self, places: &[Point]) -> Vec<Vec<(u32, f64)>> {
        let rows = self.space().rows(places, Order::Value);
        let line = |i: usize| {
            let row = rows.row(i);
            row.unknowns
                .iter()
                .copied()
                .zip(row.values.iter().copied())
                .collect()
        };
        (0..places.len()).map(line).collect()
    }
}
