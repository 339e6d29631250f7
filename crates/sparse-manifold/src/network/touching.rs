//! Curves that meet without sharing a point.

use std::collections::BTreeSet;

use nalgebra::{Point3, Vector3};

use super::error::NetworkError;
use super::segments::Segments;

/// Segments nearer than this fraction of the network's diagonal touch.
const TOUCHING: f64 = 1e-9;

/// Returns the curves that cross themselves, if segments otherwise meet at shared points only.
///
/// Surfaces that fold have curves that cross themselves, so that is no error.
pub(super) fn check_touching(segments: &Segments<'_>) -> Result<BTreeSet<usize>, NetworkError> {
    let near = TOUCHING * segments.network.diagonal();
    let bounds = |s: usize| {
        let [a, b] = [2 * s as u32, 2 * s as u32 + 1].map(|end| segments.point(end));
        let margin = Vector3::repeat(near);
        [a.inf(&b) - margin, a.sup(&b) + margin]
    };
    let boxes: Vec<[Point3<f64>; 2]> = (0..segments.list.len()).map(bounds).collect();
    let axis = longest_axis(&boxes);
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    order.sort_by(|&a, &b| {
        boxes[a][0][axis]
            .total_cmp(&boxes[b][0][axis])
            .then(a.cmp(&b))
    });
    let mut found: Option<([usize; 2], NetworkError)> = None;
    let mut crossed = BTreeSet::new();
    let mut open: Vec<usize> = Vec::new();
    for &s in &order {
        open.retain(|&other| boxes[other][1][axis] >= boxes[s][0][axis]);
        for &other in &open {
            let apart = (0..3).any(|i| {
                boxes[s][0][i] > boxes[other][1][i] || boxes[other][0][i] > boxes[s][1][i]
            });
            let pair = [s.min(other), s.max(other)];
            let earlier = found.as_ref().is_none_or(|(first, _)| pair < *first);
            if apart || !earlier {
                continue;
            }
            match meeting(segments, pair, near) {
                Some(NetworkError::Touching { curves: [a, b], .. }) if a == b => {
                    crossed.insert(a);
                }
                Some(error) => found = Some((pair, error)),
                None => {}
            }
        }
        open.push(s);
    }
    found.map_or(Ok(crossed), |(_, error)| Err(error))
}

fn longest_axis(boxes: &[[Point3<f64>; 2]]) -> usize {
    let first = boxes[0];
    let [low, high] = boxes
        .iter()
        .fold(first, |[low, high], b| [low.inf(&b[0]), high.sup(&b[1])]);
    (high - low).imax()
}

/// Returns what is wrong with two segments, if they meet elsewhere than at one shared point.
fn meeting(segments: &Segments<'_>, pair: [usize; 2], near: f64) -> Option<NetworkError> {
    let [one, two] = pair.map(|s| &segments.list[s]);
    let curves = [one.curve, two.curve];
    let place = |id: u32| segments.network.points()[id as usize];
    let ends = |s: usize| segments.list[s].points.map(place);
    let shared: Vec<usize> = (0..2)
        .filter(|&i| two.points.contains(&one.points[i]))
        .collect();
    match shared[..] {
        [] => {
            let (position, distance) = closest(ends(pair[0]), ends(pair[1]));
            (distance <= near).then_some(NetworkError::Touching { curves, position })
        }
        [i] => {
            // From a shared point on, they overlap if the end of one lies on the other.
            let common = one.points[i];
            let j = usize::from(two.points[1] == common);
            let far = [place(one.points[1 - i]), place(two.points[1 - j])];
            let on = |p: Point3<f64>, end: Point3<f64>| closest([p, p], [place(common), end]).1;
            let over = on(far[0], far[1]).min(on(far[1], far[0])) <= near;
            let position = nalgebra::center(&place(common), &far[0]);
            over.then_some(NetworkError::Overlapping { curves, position })
        }
        _ => {
            let [a, b] = ends(pair[0]);
            let position = nalgebra::center(&a, &b);
            Some(NetworkError::Overlapping { curves, position })
        }
    }
}

/// Returns a point of the first segment nearest to the second, and their distance.
fn closest(one: [Point3<f64>; 2], two: [Point3<f64>; 2]) -> (Point3<f64>, f64) {
    let (d, e, r) = (one[1] - one[0], two[1] - two[0], one[0] - two[0]);
    let (dd, ee, de) = (d.norm_squared(), e.norm_squared(), d.dot(&e));
    let (dr, er) = (d.dot(&r), e.dot(&r));
    let along = |t: f64| {
        if dd > 0.0 {
            ((de * t - dr) / dd).clamp(0.0, 1.0)
        } else {
            0.0
        }
    };
    let across = |s: f64| {
        if ee > 0.0 {
            ((de * s + er) / ee).clamp(0.0, 1.0)
        } else {
            0.0
        }
    };
    let denominator = dd * ee - de * de;
    // The minimum is inside both segments or at an end of one; of parallel ones, at an end.
    let inside = (denominator > 0.0)
        .then(|| ((de * er - ee * dr) / denominator).clamp(0.0, 1.0))
        .map(|s| [along(across(s)), across(s)]);
    let at_ends = [
        [0.0, across(0.0)],
        [1.0, across(1.0)],
        [along(0.0), 0.0],
        [along(1.0), 1.0],
    ];
    let distance = |[s, t]: [f64; 2]| ((one[0] + d * s) - (two[0] + e * t)).norm();
    let candidates = inside.into_iter().chain(at_ends);
    let best = candidates.min_by(|a, b| distance(*a).total_cmp(&distance(*b)));
    let best = best.unwrap_or([0.0, 0.0]);
    (one[0] + d * best[0], distance(best))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_closest_points_are_found_inside_at_ends_and_between_parallels() {
        let p = |x: f64, y: f64, z: f64| Point3::new(x, y, z);
        let one = [p(0.0, 0.0, 0.0), p(2.0, 0.0, 0.0)];
        for (two, distance) in [
            ([p(1.0, -1.0, 3.0), p(1.0, 1.0, 3.0)], 3.0),
            ([p(3.0, 0.0, 0.0), p(4.0, 5.0, 0.0)], 1.0),
            ([p(0.5, 2.0, 0.0), p(1.5, 2.0, 0.0)], 2.0),
            ([p(5.0, 4.0, 0.0), p(5.0, 4.0, 0.0)], 5.0),
            ([p(1.0, 0.0, 0.0), p(1.0, 7.0, 0.0)], 0.0),
        ] {
            assert!((closest(one, two).1 - distance).abs() < 1e-14, "{two:?}");
            assert!((closest(two, one).1 - distance).abs() < 1e-14, "{two:?}");
        }
    }
}
