//! Cylinders glued along critical trajectories, in exact integers.
//!
//! # Notation
//! A cylinder is `[0, C) x [0, H]`, `x` periodic with its circumference `C`. `x` and `y` are the integrals
//! of the real and imaginary part of the form, in units of `2^-44`. Its *bottom* is the border `y = 0`, its
//! *top* the border `y = H`; each is tiled by [`Segment`]s, over which the next cylinder lies by a
//! translation in `x`. A point on a border belongs to the cylinder above it, where there is one.
//!
//! All positions of knots are whole numbers of units, so that the intervals on opposite sides of a cell
//! are equal by identity, however far apart the borders are that they were carried over.
//!
//! # Reference
//! [He2006] §3.2. Deviation: the paper glues rectangles along critical graphs in real numbers; here the
//! lengths are rounded once, as a flow, and then exact.

mod develop;
mod error;
#[cfg(test)]
pub(crate) mod tests;
mod walk;

use serde::{Deserialize, Serialize};

pub use develop::{Development, Piece};
pub use error::ComplexError;
pub use walk::{Point, Stop};

/// Units per 1 of the form.
pub const UNITS: f64 = (1_u64 << 44) as f64;

/// What lies beyond a segment of a border.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Beyond {
    /// The opposite border of a cylinder.
    Cylinder {
        /// That cylinder.
        cylinder: u32,
        /// Where the segment starts on its border, in `[0, C)` of that cylinder.
        start: i64,
    },
    /// Nothing: a boundary of the surface.
    Boundary {
        /// Which one.
        index: u32,
    },
    /// Nothing but a point of the surface, around which the cylinder closes.
    Pole {
        /// Which one.
        index: u32,
    },
}

/// A piece of a border, of which all points lie beside the same cylinder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Segment {
    /// Where it starts, in `[0, C)`.
    pub start: i64,
    /// Its length; it ends at or before `C`.
    pub length: i64,
    /// What lies on its other side.
    pub beyond: Beyond,
    /// The zero of the form at its start, if there is one: segments also start where a table does.
    pub zero: Option<u32>,
}

/// One cylinder.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Cylinder {
    /// `C`.
    pub circumference: i64,
    /// `H`.
    pub height: i64,
    /// Segments of the border `y = 0`, ascending.
    pub bottom: Vec<Segment>,
    /// Segments of the border `y = H`, ascending.
    pub top: Vec<Segment>,
}

/// One of the two borders of a cylinder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Border {
    /// `y = 0`.
    Bottom,
    /// `y = H`.
    Top,
}

impl Border {
    /// Returns the other one.
    #[must_use]
    pub fn opposite(self) -> Self {
        match self {
            Self::Bottom => Self::Top,
            Self::Top => Self::Bottom,
        }
    }
}

/// A point in whole units.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Node {
    /// Its cylinder.
    pub cylinder: u32,
    /// `x`, in `[0, C)`.
    pub x: i64,
    /// `y`, in `[0, H]`; `H` only where no cylinder lies above.
    pub y: i64,
}

/// Cylinders and how they are glued.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct CylinderComplex {
    cylinders: Vec<Cylinder>,
}

impl CylinderComplex {
    /// Checks that borders are tiled, and that what is glued to one is glued back.
    ///
    /// # Errors
    /// The first cylinder, border and segment where that does not hold.
    pub fn build(cylinders: Vec<Cylinder>) -> Result<Self, ComplexError> {
        let complex = Self { cylinders };
        for (index, cylinder) in complex.cylinders.iter().enumerate() {
            let index = index as u32;
            if cylinder.circumference <= 0 || cylinder.height <= 0 {
                return Err(ComplexError::Size { cylinder: index });
            }
            for border in [Border::Bottom, Border::Top] {
                complex.check_tiling(index, border)?;
                complex.check_gluing(index, border)?;
            }
        }
        Ok(complex)
    }

    /// Returns the complex of a torus: one cylinder whose top is glued to its bottom with a twist.
    ///
    /// # Errors
    /// Sizes that are not positive.
    pub fn torus(circumference: i64, height: i64, twist: i64) -> Result<Self, ComplexError> {
        if circumference <= 0 || height <= 0 {
            return Err(ComplexError::Size { cylinder: 0 });
        }
        let border = |twist: i64| {
            let start = twist.rem_euclid(circumference);
            vec![Segment {
                start: 0,
                length: circumference,
                beyond: Beyond::Cylinder { cylinder: 0, start },
                zero: None,
            }]
        };
        Self::build(vec![Cylinder {
            circumference,
            height,
            bottom: border(-twist),
            top: border(twist),
        }])
    }

    /// Returns the cylinders.
    #[must_use]
    pub fn cylinders(&self) -> &[Cylinder] {
        &self.cylinders
    }

    /// Returns a border.
    ///
    /// # Panics
    /// If there is no such cylinder.
    #[must_use]
    pub fn border(&self, cylinder: u32, border: Border) -> &[Segment] {
        let cylinder = &self.cylinders[cylinder as usize];
        match border {
            Border::Bottom => &cylinder.bottom,
            Border::Top => &cylinder.top,
        }
    }

    /// Returns the segment of a border that holds `x`, which may be outside of `[0, C)`: the one that
    /// starts there, where two meet.
    ///
    /// # Panics
    /// If there is no such cylinder.
    #[must_use]
    pub fn segment(&self, cylinder: u32, border: Border, x: i64) -> &Segment {
        let x = x.rem_euclid(self.cylinders[cylinder as usize].circumference);
        let segments = self.border(cylinder, border);
        &segments[segments.partition_point(|s| s.start <= x) - 1]
    }

    /// Returns the number of zeros that borders name: one more than the largest index.
    #[must_use]
    pub fn zeros(&self) -> usize {
        let borders = self
            .cylinders
            .iter()
            .flat_map(|c| c.bottom.iter().chain(&c.top));
        let last = borders.filter_map(|s| s.zero).max();
        last.map_or(0, |last| last as usize + 1)
    }

    /// Returns the sum of `C H`, in square units: the area that the form lays out.
    #[must_use]
    pub fn area(&self) -> i128 {
        let area = |c: &Cylinder| i128::from(c.circumference) * i128::from(c.height);
        self.cylinders.iter().map(area).sum()
    }

    fn check_tiling(&self, cylinder: u32, border: Border) -> Result<(), ComplexError> {
        let mut end = 0;
        for (place, segment) in self.border(cylinder, border).iter().enumerate() {
            if segment.start != end || segment.length <= 0 {
                return Err(ComplexError::Tiling {
                    cylinder,
                    border,
                    segment: place,
                });
            }
            end += segment.length;
        }
        if end == self.cylinders[cylinder as usize].circumference {
            Ok(())
        } else {
            let segment = self.border(cylinder, border).len();
            Err(ComplexError::Tiling {
                cylinder,
                border,
                segment,
            })
        }
    }

    /// Checks that every part of every segment is glued back to where it is.
    fn check_gluing(&self, cylinder: u32, border: Border) -> Result<(), ComplexError> {
        for (place, segment) in self.border(cylinder, border).iter().enumerate() {
            let broken = ComplexError::Gluing {
                cylinder,
                border,
                segment: place,
            };
            let Beyond::Cylinder {
                cylinder: other,
                start,
            } = segment.beyond
            else {
                continue;
            };
            let Some(beyond) = self.cylinders.get(other as usize) else {
                return Err(broken);
            };
            let own = self.cylinders[cylinder as usize].circumference;
            let size = beyond.circumference;
            if !(0..size).contains(&start) || segment.length > size {
                return Err(broken);
            }
            let mut done = 0;
            while done < segment.length {
                let x = (start + done).rem_euclid(size);
                let back = self.segment(other, border.opposite(), x);
                let into = x - back.start;
                let expected = (segment.start + done - into).rem_euclid(own);
                let same = match back.beyond {
                    Beyond::Cylinder {
                        cylinder: home,
                        start,
                    } => home == cylinder && start.rem_euclid(own) == expected,
                    _ => false,
                };
                let zeros = [
                    (done == 0).then_some(segment.zero).flatten(),
                    (into == 0).then_some(back.zero).flatten(),
                ];
                // A zero at the start of one lies at the start of the other, or at its wrapped start.
                let inside = zeros[0] != zeros[1];
                if !same || inside {
                    return Err(broken);
                }
                done += back.length - into;
            }
        }
        Ok(())
    }
}
