//! Knots: where the lines of the mesh cross a ray.

use super::{Side, TMesh, wrap};
use crate::complex::{Border, Node, Stop};

/// The direction of a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Towards smaller `x`.
    Left,
    /// Towards larger `x`.
    Right,
    /// Towards smaller `y`.
    Down,
    /// Towards larger `y`.
    Up,
}

/// Why a ray ends before its second crossing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayStop {
    /// It ran into a zero of the form.
    Zero,
    /// It ran into a boundary.
    Boundary,
    /// It ran into the end of a cylinder that closes around a point.
    Pole,
}

/// The first two crossings of a ray with lines of the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ray {
    /// Their distances; if the ray is stopped, what remains repeats the distance of the stop.
    pub crossings: [i64; 2],
    /// What stopped the ray at or before its last crossing but in front of a second one.
    pub stop: Option<RayStop>,
}

impl Ray {
    /// Returns a ray from the crossings before its end.
    fn of(crossings: &[i64], stop: Option<RayStop>) -> Self {
        let first = crossings.first().copied().unwrap_or(0);
        Self {
            crossings: [first, crossings.get(1).copied().unwrap_or(first)],
            stop,
        }
    }
}

impl TMesh {
    /// Follows a ray from a node over two lines of the mesh. A line that ends on the ray counts, from
    /// whichever side it comes.
    ///
    /// # Panics
    /// If there is no such cylinder, or the node is not in the cylinder it belongs to.
    #[must_use]
    pub fn ray(&self, node: Node, direction: Direction) -> Ray {
        match direction {
            Direction::Left => self.ray_across(node, Side::Low),
            Direction::Right => self.ray_across(node, Side::High),
            Direction::Down => self.ray_along(node, Side::Low),
            Direction::Up => self.ray_along(node, Side::High),
        }
    }

    fn ray_across(&self, node: Node, side: Side) -> Ray {
        let sign = if side == Side::High { 1 } else { -1 };
        let mut at = node;
        let mut crossings = Vec::with_capacity(2);
        let mut way = 0;
        while crossings.len() < 2 {
            let leaves = [self.side_above(at, side), self.side_below(at, side)];
            let step = leaves.into_iter().flatten().min();
            let mut step = step.expect("a point has a side");
            let zero = self.next_zero(at, side).filter(|&zero| zero <= step);
            step = zero.unwrap_or(step);
            way += step;
            crossings.push(way);
            if zero.is_some() {
                let stop = (crossings.len() < 2).then_some(RayStop::Zero);
                return Ray::of(&crossings, stop);
            }
            at.x += sign * step;
        }
        Ray::of(&crossings, None)
    }

    /// Returns how far the leaf above a node extends to a side.
    fn side_above(&self, at: Node, side: Side) -> Option<i64> {
        let own = &self.complex.cylinders()[at.cylinder as usize];
        (at.y < own.height).then(|| self.extent(at, [side, Side::High]))
    }

    /// Returns how far the leaf below a node extends to a side, over a border too.
    fn side_below(&self, at: Node, side: Side) -> Option<i64> {
        if at.y > 0 {
            return Some(self.extent(at, [side, Side::Low]));
        }
        let below = self
            .complex
            .across(at.cylinder, Border::Bottom, at.x)
            .ok()?;
        Some(self.extent(below, [side, Side::Low]))
    }

    fn extent(&self, at: Node, sides: [Side; 2]) -> i64 {
        let leaf = self.locate(at.cylinder, [at.x, at.y], sides);
        let size = self.complex.cylinders()[at.cylinder as usize].circumference;
        let x = wrap(at.x, size, sides[0]);
        let leaf = &self.leaves[leaf as usize];
        match sides[0] {
            Side::Low => x - leaf.x[0],
            Side::High => leaf.x[1] - x,
        }
    }

    /// Returns the distance to the next zero on a bottom border, if the node lies on one.
    fn next_zero(&self, at: Node, side: Side) -> Option<i64> {
        if at.y > 0 {
            return None;
        }
        let own = &self.complex.cylinders()[at.cylinder as usize];
        let zeros = own.bottom.iter().filter(|s| s.zero.is_some());
        let distance = |start: i64| match side {
            Side::Low => at.x - start,
            Side::High => start - at.x,
        };
        zeros
            .map(|s| wrap(distance(s.start), own.circumference, Side::Low))
            .min()
    }

    fn ray_along(&self, node: Node, side: Side) -> Ray {
        let border = match side {
            Side::Low => Border::Bottom,
            Side::High => Border::Top,
        };
        let mut at = node;
        let mut crossings = Vec::with_capacity(2);
        let mut way = 0;
        while crossings.len() < 2 {
            let height = self.complex.cylinders()[at.cylinder as usize].height;
            let end = if side == Side::High { height } else { 0 };
            if at.y == end {
                if self.complex.zero_at(at.cylinder, border, at.x).is_some() {
                    return Ray::of(&crossings, Some(RayStop::Zero));
                }
                match self.complex.across(at.cylinder, border, at.x) {
                    Ok(next) => at = next,
                    Err(Stop::Boundary(_)) => return Ray::of(&crossings, Some(RayStop::Boundary)),
                    Err(Stop::Pole(_)) => return Ray::of(&crossings, Some(RayStop::Pole)),
                }
            }
            let far = [Side::Low, Side::High].map(|left| {
                let leaf = self.locate(at.cylinder, [at.x, at.y], [left, side]);
                let y = self.leaves[leaf as usize].y;
                match side {
                    Side::Low => at.y - y[0],
                    Side::High => y[1] - at.y,
                }
            });
            let step = far[0].min(far[1]);
            way += step;
            crossings.push(way);
            at.y += if side == Side::High { step } else { -step };
        }
        Ray::of(&crossings, None)
    }
}
