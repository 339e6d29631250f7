//! Knots drawn back to zeros.

use super::Support;
use crate::complex::CylinderComplex;

impl Support {
    /// Shrinks the support until no zero of the form lies inside, in the direction in which that costs
    /// least of it. Knots stay distinct, so that the function is C2 where its support now ends;
    /// `stopped` says for both directions of both axes where a ray ran into a zero.
    pub(super) fn clamp(&mut self, complex: &CylinderComplex, stopped: [[bool; 2]; 2]) {
        loop {
            let ends = |k: &[i64; 5]| [k[0], k[4]];
            let zeros = complex
                .develop(self.node, ends(&self.x), ends(&self.y))
                .zeros;
            let Some(&[dx, dy]) = zeros.iter().reduce(|best, next| {
                if less(self.depth(*next), self.depth(*best)) {
                    next
                } else {
                    best
                }
            }) else {
                break;
            };
            let [across, along] = [share(&self.x, dx), share(&self.y, dy)];
            if dx != 0 && (dy == 0 || !less(across, along)) {
                draw_back(&mut self.x, dx);
            } else {
                draw_back(&mut self.y, dy);
            }
        }
        for (knots, stopped) in [&mut self.x, &mut self.y].into_iter().zip(stopped) {
            if stopped[0] && knots[1] == knots[0] {
                knots[1] = knots[0] / 2;
            }
            if stopped[1] && knots[3] == knots[4] {
                knots[3] = knots[4] / 2;
            }
        }
    }

    /// Returns how deep a zero lies inside: the larger of its two shares.
    fn depth(&self, [dx, dy]: [i64; 2]) -> [i64; 2] {
        let [across, along] = [share(&self.x, dx), share(&self.y, dy)];
        if less(across, along) { along } else { across }
    }
}

/// Returns a distance as a fraction of the knots on its side: numerator and denominator.
fn share(knots: &[i64; 5], distance: i64) -> [i64; 2] {
    match distance {
        0 => [0, 1],
        1.. => [distance, knots[4]],
        _ => [-distance, -knots[0]],
    }
}

/// Compares fractions.
fn less(a: [i64; 2], b: [i64; 2]) -> bool {
    i128::from(a[0]) * i128::from(b[1]) < i128::from(b[0]) * i128::from(a[1])
}

/// Ends knots at a distance, and keeps the one before it if it is clear of that.
fn draw_back(knots: &mut [i64; 5], distance: i64) {
    let (inner, outer) = if distance > 0 { (3, 4) } else { (1, 0) };
    if 4 * knots[inner].abs() >= 3 * distance.abs() {
        knots[inner] = distance / 2;
    }
    knots[outer] = distance;
}
