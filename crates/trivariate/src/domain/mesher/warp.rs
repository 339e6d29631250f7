//! Lattice points moved onto cuts nearby.

use super::lattice::{Cut, Lattice};
use super::{ALPHA_LONG, ALPHA_SHORT};

/// Length of a short edge, in half spacings.
const SHORT: f64 = 1.732_050_807_568_877_2;
/// Length of a long edge, in half spacings.
const LONG: f64 = 2.0;

/// A lattice after its points were moved.
pub(super) struct Warped {
    /// 1 for points inside, -1 for points outside, 0 for points on the boundary.
    pub(super) values: Vec<i8>,
    /// Points on the boundary and their cut, by point.
    pub(super) moved: Vec<(u32, Cut)>,
    /// Cuts between points inside and outside that are left, by lower end and direction.
    pub(super) cuts: Vec<Cut>,
}

/// How near to an end of an edge a cut may lie, as a fraction of the edge.
pub(super) fn alpha(direction: u8) -> f64 {
    if direction < 3 {
        ALPHA_LONG
    } else {
        ALPHA_SHORT
    }
}

/// Moves each point that a cut lies close to onto the cut, nearest cuts first; a moved point is on
/// the boundary, and its other cuts are gone.
///
/// Points of `unmoved`, ascending, keep their place instead, and cuts keep their distance from them.
pub(super) fn warp(lattice: &Lattice, unmoved: &[u32]) -> Warped {
    let mut values: Vec<i8> = lattice
        .inside
        .iter()
        .map(|&inside| if inside { 1 } else { -1 })
        .collect();
    let mut close = Vec::new();
    for (number, cut) in lattice.cuts.iter().enumerate() {
        let length = if cut.direction < 3 { LONG } else { SHORT };
        for (end, fraction) in [(0, cut.fraction), (1, 1.0 - cut.fraction)] {
            let point = cut.ends[end];
            if fraction < alpha(cut.direction) && unmoved.binary_search(&point).is_err() {
                close.push((fraction * length, number as u32, end));
            }
        }
    }
    close.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut moved = Vec::new();
    for (_, number, end) in close {
        let cut = lattice.cuts[number as usize];
        if cut.ends.iter().all(|&point| values[point as usize] != 0) {
            values[cut.ends[end] as usize] = 0;
            moved.push((cut.ends[end], cut));
        }
    }
    moved.sort_unstable_by_key(|&(point, _)| point);
    let left = lattice.cuts.iter().filter(|cut| {
        let [lower, upper] = cut.ends.map(|point| values[point as usize]);
        lower * upper < 0
    });
    let kept = |cut: &Cut| {
        let alpha = alpha(cut.direction);
        Cut {
            fraction: cut.fraction.clamp(alpha, 1.0 - alpha),
            ..*cut
        }
    };
    let cuts = left.map(kept).collect();
    Warped {
        values,
        moved,
        cuts,
    }
}
