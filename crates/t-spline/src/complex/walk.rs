//! Points between units, and straight ways over borders.

use serde::{Deserialize, Serialize};

use super::{Beyond, Border, CylinderComplex, Node};

/// A point, in units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Its cylinder.
    pub cylinder: u32,
    /// `x`, in `[0, C)`.
    pub x: f64,
    /// `y`, in `[0, H]`.
    pub y: f64,
}

/// Where a way ends before its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// At a boundary of the surface.
    Boundary(u32),
    /// At the end of a cylinder that closes around a point.
    Pole(u32),
}

impl From<Node> for Point {
    fn from(node: Node) -> Self {
        Self {
            cylinder: node.cylinder,
            x: node.x as f64,
            y: node.y as f64,
        }
    }
}

impl CylinderComplex {
    /// Returns a point on the border beyond a segment, and what is there instead if nothing is.
    fn cross(&self, cylinder: u32, border: Border, x: i64) -> Result<(u32, i64), Stop> {
        let size = self.cylinders[cylinder as usize].circumference;
        let segment = self.segment(cylinder, border, x);
        match segment.beyond {
            Beyond::Cylinder {
                cylinder: other,
                start,
            } => {
                let into = x.rem_euclid(size) - segment.start;
                let across = self.cylinders[other as usize].circumference;
                Ok((other, (start + into).rem_euclid(across)))
            }
            Beyond::Boundary { index } => Err(Stop::Boundary(index)),
            Beyond::Pole { index } => Err(Stop::Pole(index)),
        }
    }

    /// Returns the node at `(x, y)` of a cylinder, `0 <= y <= H`, in the cylinder it belongs to: points of
    /// a glued top belong to the cylinder above.
    ///
    /// # Panics
    /// If there is no such cylinder, or `y` is not within it.
    #[must_use]
    pub fn node(&self, cylinder: u32, x: i64, y: i64) -> Node {
        let own = &self.cylinders[cylinder as usize];
        assert!((0..=own.height).contains(&y), "y within the cylinder");
        let x = x.rem_euclid(own.circumference);
        if y == own.height
            && let Ok((cylinder, x)) = self.cross(cylinder, Border::Top, x)
        {
            return Node { cylinder, x, y: 0 };
        }
        Node { cylinder, x, y }
    }

    /// Returns the zero at a point of a border, if there is one.
    ///
    /// # Panics
    /// If there is no such cylinder.
    #[must_use]
    pub fn zero_at(&self, cylinder: u32, border: Border, x: i64) -> Option<u32> {
        let segment = self.segment(cylinder, border, x);
        let size = self.cylinders[cylinder as usize].circumference;
        let starts = segment.start == x.rem_euclid(size);
        segment.zero.filter(|_| starts)
    }

    /// Returns the node on the other side of a border.
    ///
    /// # Errors
    /// What is there where no cylinder is.
    ///
    /// # Panics
    /// If there is no such cylinder.
    pub fn across(&self, cylinder: u32, border: Border, x: i64) -> Result<Node, Stop> {
        let (other, x) = self.cross(cylinder, border, x)?;
        let y = match border {
            Border::Top => 0,
            Border::Bottom => self.cylinders[other as usize].height,
        };
        Ok(Node {
            cylinder: other,
            x,
            y,
        })
    }

    /// Returns whether a point lies exactly on a border where the surface ends.
    ///
    /// # Panics
    /// If there is no such cylinder.
    #[must_use]
    pub fn is_on_boundary(&self, point: Point) -> bool {
        let height = self.cylinders[point.cylinder as usize].height as f64;
        let border = if point.y == 0.0 {
            Border::Bottom
        } else if point.y == height {
            Border::Top
        } else {
            return false;
        };
        let segment = self.segment(point.cylinder, border, point.x as i64);
        matches!(segment.beyond, Beyond::Boundary { .. })
    }

    /// Returns where one comes from a point straight on by `(dx, dy)`, and what stopped the way before
    /// its end. It is the same way whatever borders it crosses; at a zero, ways part.
    ///
    /// # Panics
    /// If there is no such cylinder.
    #[must_use]
    pub fn walk(&self, from: Point, [dx, dy]: [f64; 2]) -> (Point, Option<Stop>) {
        let Point {
            mut cylinder,
            mut x,
            mut y,
        } = from;
        let (mut dx, mut dy) = (dx, dy);
        loop {
            let own = &self.cylinders[cylinder as usize];
            let (size, height) = (own.circumference as f64, own.height as f64);
            let border = if y + dy > height {
                Border::Top
            } else if y + dy < 0.0 {
                Border::Bottom
            } else {
                let x = (x + dx).rem_euclid(size);
                // Rounding may return the modulus itself.
                let x = if x < size { x } else { 0.0 };
                return (
                    Point {
                        cylinder,
                        x,
                        y: y + dy,
                    },
                    None,
                );
            };
            let edge = if border == Border::Top { height } else { 0.0 };
            let share = ((edge - y) / dy).clamp(0.0, 1.0);
            let at = (x + share * dx).rem_euclid(size);
            let at = if at < size { at } else { 0.0 };
            (dx, dy) = ((1.0 - share) * dx, y + dy - edge);
            let whole = at.floor();
            match self.cross(cylinder, border, whole as i64) {
                Ok((other, there)) => {
                    cylinder = other;
                    x = there as f64 + (at - whole);
                    y = match border {
                        Border::Top => 0.0,
                        Border::Bottom => self.cylinders[other as usize].height as f64,
                    };
                }
                Err(stop) => {
                    return (
                        Point {
                            cylinder,
                            x: at,
                            y: edge,
                        },
                        Some(stop),
                    );
                }
            }
        }
    }
}
