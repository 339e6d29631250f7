//! The spline: one lattice of control points over the unit cube.
//!
//! # Notation
//! `n` spans in each direction, `m = n + 3` control points `c_ijk`, at `i + m (j + m k)`.

mod bezier;
mod evaluate;
mod face;
mod inverse;

use msplines_common::Point3;
use msplines_common::bspline::{Axis, greville, refine_axis};

pub use evaluate::Jet;
pub(crate) use evaluate::grid_rows;
pub use face::{End, Face, FaceSpline};
pub use inverse::{Inverse, Inverter, Miss};

/// Most spans in a direction: a lattice of 515³ control points takes 3.3 GB.
pub const MOST_SPANS: usize = 512;

/// A solid: a uniform cubic tensor product over the unit cube.
///
/// # Reference
/// [Kim2014] Eq. (2), §5. Deviation: the same number of spans in all directions.
#[derive(Clone, Debug, PartialEq)]
pub struct TrivariateSpline {
    spans: usize,
    points: Vec<Point3<f64>>,
}

/// Why numbers are no spline.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SplineError {
    /// Too few or too many spans.
    #[error("{spans} spans in a direction; ask for 1 to {MOST_SPANS}")]
    Spans {
        /// What was asked for.
        spans: usize,
    },
    /// The lattice is not full.
    #[error("{found} control points for {spans} spans; give ({spans} + 3)³ = {expected}")]
    Points {
        /// Spans in a direction.
        spans: usize,
        /// How many control points were given.
        found: usize,
        /// How many are due.
        expected: usize,
    },
    /// A control point is NaN, infinite, or so far that the solid has no finite volume.
    #[error("control point {index:?} is not finite, or too far away; give coordinates up to 1e100")]
    NotFinite {
        /// Its place in the lattice.
        index: [usize; 3],
    },
    /// A control point that does not exist.
    #[error("there is no control point {index:?}; places go from 0 to {last} in each direction")]
    NoSuchPoint {
        /// The place asked for.
        index: [usize; 3],
        /// The last place of a direction.
        last: usize,
    },
    /// Cells that no uniform cubic spline has.
    #[error("the cells are not the spans of a uniform cubic solid: {reason}")]
    Cells {
        /// What is wrong.
        reason: String,
    },
}

/// Largest coordinate of a control point: volumes are finite yet.
const LARGEST: f64 = 1e100;

impl TrivariateSpline {
    /// Returns the spline with these control points, the first index of which varies fastest.
    ///
    /// # Errors
    /// No spans or too many, a wrong number of points, a point that is not finite.
    pub fn build(spans: usize, points: Vec<Point3<f64>>) -> Result<Self, SplineError> {
        if !(1..=MOST_SPANS).contains(&spans) {
            return Err(SplineError::Spans { spans });
        }
        let size = spans + 3;
        if points.len() != size.pow(3) {
            return Err(SplineError::Points {
                spans,
                found: points.len(),
                expected: size.pow(3),
            });
        }
        let bad = |p: &Point3<f64>| !p.iter().all(|x| x.abs() <= LARGEST);
        if let Some(at) = points.iter().position(bad) {
            let index = [at % size, at / size % size, at / (size * size)];
            return Err(SplineError::NotFinite { index });
        }
        Ok(Self { spans, points })
    }

    /// Returns the spline whose control points are values of `map` at their parameters; for an affine
    /// map it is that map. The outermost parameters lie one span outside of the unit cube.
    ///
    /// # Errors
    /// As [`build`](Self::build).
    pub fn from_map(
        spans: usize,
        mut map: impl FnMut([f64; 3]) -> Point3<f64>,
    ) -> Result<Self, SplineError> {
        let size = if spans <= MOST_SPANS { spans + 3 } else { 0 };
        let at = |i| greville(spans.max(1), i);
        let mut points = Vec::with_capacity(size.pow(3));
        for k in 0..size {
            for j in 0..size {
                points.extend((0..size).map(|i| map([at(i), at(j), at(k)])));
            }
        }
        Self::build(spans, points)
    }

    /// Spans in each direction.
    #[must_use]
    pub fn spans(&self) -> usize {
        self.spans
    }

    /// Control points in each direction: three more than spans.
    #[must_use]
    pub fn size(&self) -> usize {
        self.spans + 3
    }

    /// All control points, the first index fastest.
    #[must_use]
    pub fn points(&self) -> &[Point3<f64>] {
        &self.points
    }

    /// Control point `(i, j, k)`, if there is one.
    #[must_use]
    pub fn point(&self, index: [usize; 3]) -> Option<Point3<f64>> {
        let size = self.size();
        let inside = index.iter().all(|&i| i < size);
        inside.then(|| self.points[index[0] + size * (index[1] + size * index[2])])
    }

    /// Returns the spline with some control points moved to new positions. It changes only where a
    /// parameter lies within two spans of that of a moved point.
    ///
    /// # Reference
    /// [Kim2014] Fig. 10, §6.
    ///
    /// # Errors
    /// A control point that does not exist, or a position that is not finite.
    pub fn with_moved(&self, moves: &[([usize; 3], Point3<f64>)]) -> Result<Self, SplineError> {
        let (size, mut points) = (self.size(), self.points.clone());
        for &(index, position) in moves {
            if index.iter().any(|&i| i >= size) {
                let last = size - 1;
                return Err(SplineError::NoSuchPoint { index, last });
            }
            points[index[0] + size * (index[1] + size * index[2])] = position;
        }
        Self::build(self.spans, points)
    }

    /// Returns the same solid over twice as many spans in each direction.
    ///
    /// # Reference
    /// [Kim2014] Fig. 5, §5.
    ///
    /// # Errors
    /// More than [`MOST_SPANS`] spans.
    pub fn refined(&self) -> Result<Self, SplineError> {
        let spans = 2 * self.spans;
        if spans > MOST_SPANS {
            return Err(SplineError::Spans { spans });
        }
        Ok(Self::from_flat(
            spans,
            &refine_lattice(self.spans, 3, &self.flat()),
        ))
    }

    /// Coordinates of the control points, one after another.
    pub(crate) fn flat(&self) -> Vec<f64> {
        self.points.iter().flat_map(|p| [p.x, p.y, p.z]).collect()
    }

    /// The spline of a full lattice of finite coordinates.
    pub(crate) fn from_flat(spans: usize, flat: &[f64]) -> Self {
        let points = flat.chunks_exact(3).map(|c| Point3::new(c[0], c[1], c[2]));
        Self {
            spans,
            points: points.collect(),
        }
    }

    /// Sum of two solids, coordinate by coordinate; of as many spans.
    pub(crate) fn plus(&self, other: &Self) -> Self {
        let sum = |(a, b): (&Point3<f64>, &Point3<f64>)| a + b.coords;
        Self {
            spans: self.spans,
            points: self.points.iter().zip(&other.points).map(sum).collect(),
        }
    }
}

/// A lattice of `components` numbers at each place, over twice as many spans.
pub(crate) fn refine_lattice(spans: usize, components: usize, values: &[f64]) -> Vec<f64> {
    let mut sizes = [spans + 3; 3];
    let mut fine = values.to_vec();
    for axis in 0..3 {
        fine = refine_axis(Axis::of(&sizes, axis, components), &fine);
        sizes[axis] = 2 * spans + 3;
    }
    fine
}
