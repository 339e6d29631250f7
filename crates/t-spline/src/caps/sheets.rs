//! The half disks around a zero.

use super::CapsError;
use crate::complex::{Beyond, Border, CylinderComplex};

/// A half disk: above the bottom of a cylinder or below its top.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Half {
    pub(super) cylinder: u32,
    pub(super) border: Border,
    pub(super) x: i64,
}

/// The surroundings of a zero.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Sheets {
    /// Half disks counterclockwise, upper and lower ones in turn.
    pub(super) halves: Vec<Half>,
    /// The shortest connection and the lowest cylinder at the zero: the smaller of both.
    pub(super) room: i64,
}

/// Walks once around a zero, from half disk to half disk.
pub(super) fn around(complex: &CylinderComplex, zero: u32) -> Result<Sheets, CapsError> {
    let broken = CapsError::Zero { zero };
    let count = |border| {
        let cylinders = 0..complex.cylinders().len() as u32;
        let segments =
            cylinders.flat_map(|c| complex.border(c, border).iter().map(move |s| (c, s)));
        let mut found = segments.filter(|(_, s)| s.zero == Some(zero));
        let first = found.next();
        (first, usize::from(first.is_some()) + found.count())
    };
    let (Some((cylinder, segment)), above) = count(Border::Bottom) else {
        return Err(broken);
    };
    let mut halves = Vec::with_capacity(2 * above);
    let first = (cylinder, segment.start);
    let mut at = first;
    loop {
        let (cylinder, x) = at;
        halves.push(Half {
            cylinder,
            border: Border::Bottom,
            x,
        });
        // Over the negative real axis: what lies below the segment that ends here.
        let below = complex.across(cylinder, Border::Bottom, x - 1);
        let below = below.map_err(|_| broken)?;
        let size = complex.cylinders()[below.cylinder as usize].circumference;
        let x = (below.x + 1).rem_euclid(size);
        halves.push(Half {
            cylinder: below.cylinder,
            border: Border::Top,
            x,
        });
        // Over the positive real axis: what lies above the segment that starts here.
        let next = complex.across(below.cylinder, Border::Top, x);
        let next = next.map_err(|_| broken)?;
        at = (next.cylinder, next.x);
        if at == first {
            break;
        }
        if halves.len() >= 2 * above {
            return Err(broken);
        }
    }
    if halves.len() != 2 * above || count(Border::Top).1 != above {
        return Err(broken);
    }
    let room = halves.iter().map(|half| room(complex, half)).min();
    let room = room.ok_or(broken)?;
    Ok(Sheets { halves, room })
}

/// Returns the height of the cylinder of a half disk and the distances to the next zeros on its border,
/// the least of these.
fn room(complex: &CylinderComplex, half: &Half) -> i64 {
    let own = &complex.cylinders()[half.cylinder as usize];
    let size = own.circumference;
    let segments = complex.border(half.cylinder, half.border);
    let others = segments.iter().filter(|s| s.zero.is_some());
    let nearest = others
        .flat_map(|s| [s.start - half.x, half.x - s.start])
        .map(|d| d.rem_euclid(size))
        .filter(|&d| d > 0)
        .min();
    let open = segments
        .iter()
        .any(|s| !matches!(s.beyond, Beyond::Cylinder { .. }));
    debug_assert!(!open || segments.len() > 1, "a zero has two sides");
    nearest.unwrap_or(size).min(own.height)
}
