//! Functions that are smooth but for the centre of a chart: powers of the distance times waves about it.
//!
//! With them a surface can leave its vertex along every edge in a direction of its own, which no smooth
//! function of the chart can beyond two of them.

use crate::dictionary::Atom;
use crate::domain::Star;
use crate::jet::Jet;

/// Largest power of the distance in cones.
const CONE_POWERS: u32 = 2;

/// Returns the cones that differ on the edges of a star, so that a function may leave the centre along
/// each of them as it likes; those that are polynomials are left out.
pub(crate) fn cones(star: Star) -> impl Iterator<Item = Atom> {
    let closed = star.is_closed();
    let edges = star.sectors + u32::from(!closed);
    // On half of a star cosines are enough; on a whole one a sine can vanish on all edges.
    let seen = move |&(turns, sine): &(u32, bool)| match (sine, closed) {
        (false, _) => true,
        (true, true) => turns > 0 && 2 * turns != star.valence,
        (true, false) => false,
    };
    (1..=CONE_POWERS).flat_map(move |power| {
        let all = (0..).flat_map(|turns| [(turns, false), (turns, true)]);
        let some = all.filter(seen).take(edges as usize);
        let some = some.filter(move |(turns, _)| *turns > power || (turns + power) % 2 == 1);
        some.map(move |(turns, sine)| Atom::Cone {
            power: power as u8,
            turns: turns as u8,
            sine,
        })
    })
}

/// Returns the jet of `r^power` times the cosine or sine of so many times the angle; at the centre
/// that of zero.
pub(crate) fn cone([x, y]: [f64; 2], power: u8, turns: u8, sine: bool) -> Jet {
    let (length, angle) = (x.hypot(y), y.atan2(x));
    if length == 0.0 {
        return Jet::default();
    }
    // It is the real or the imaginary part of z^a z̄^b.
    let [a, b] = [1.0, -1.0].map(|sign| 0.5 * (f64::from(power) + sign * f64::from(turns)));
    let term = |factor: f64, a: f64, b: f64| {
        let size = factor * length.powf(a + b);
        let (sin, cos) = (angle * (a - b)).sin_cos();
        [size * cos, size * sin]
    };
    let value = term(1.0, a, b);
    let (z, zb) = (term(a, a - 1.0, b), term(b, a, b - 1.0));
    let zz = term(a * (a - 1.0), a - 2.0, b);
    let mixed = term(2.0 * a * b, a - 1.0, b - 1.0);
    let bb = term(b * (b - 1.0), a, b - 2.0);
    // By x it is the sum of both derivatives, by y their difference times i.
    let real = |c: [f64; 2]| if sine { c[1] } else { c[0] };
    let times_i = |c: [f64; 2]| [-c[1], c[0]];
    let sum = |c: [f64; 2], d: [f64; 2]| [c[0] + d[0], c[1] + d[1]];
    let difference = |c: [f64; 2], d: [f64; 2]| [c[0] - d[0], c[1] - d[1]];
    Jet {
        value: real(value),
        first: [real(sum(z, zb)), real(times_i(difference(z, zb)))],
        second: [
            real(sum(sum(zz, bb), mixed)),
            real(times_i(difference(zz, bb))),
            real(difference(mixed, sum(zz, bb))),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dictionary::{Dictionary, DictionaryKind};

    #[test]
    fn derivatives_of_cones_are_differences() {
        const STEP: f64 = 1e-5;
        for (power, turns) in [(1, 0), (1, 2), (1, 3), (2, 1), (2, 3)] {
            for sine in [false, true] {
                let at = |x: f64, y: f64| cone([x, y], power, turns, sine);
                let (x, y) = (0.3, -0.4);
                let [e, w] = [STEP, -STEP].map(|h| at(x + h, y));
                let [n, s] = [STEP, -STEP].map(|h| at(x, y + h));
                let slope = |a: f64, b: f64| (a - b) / (2.0 * STEP);
                let here = at(x, y);
                for (found, wanted) in [
                    (here.first[0], slope(e.value, w.value)),
                    (here.first[1], slope(n.value, s.value)),
                    (here.second[0], slope(e.first[0], w.first[0])),
                    (here.second[1], slope(e.first[1], w.first[1])),
                    (here.second[2], slope(n.first[1], s.first[1])),
                ] {
                    assert!((found - wanted).abs() < 1e-8, "{power} {turns} {sine}");
                }
            }
        }
    }

    #[test]
    fn cones_and_linear_functions_leave_a_centre_along_every_edge_as_they_like() {
        for valence in 3..=8 {
            let star = Star {
                sectors: valence,
                valence,
            };
            let first = |atom: &Atom| matches!(atom, Atom::Cone { power: 1, .. });
            assert_eq!(cones(star).filter(first).count() as u32, valence - 2);
            let linear = [Atom::Monomial([1, 0]), Atom::Monomial([0, 1])];
            let atoms: Vec<Atom> = linear
                .into_iter()
                .chain(cones(star).filter(first))
                .collect();
            let n = valence as usize;
            let dictionary = Dictionary::new(DictionaryKind::Polynomials, 1, star);
            let on_edges = nalgebra::DMatrix::from_fn(n, n, |edge, atom| {
                let place = dictionary.place(edge as u32, [1.0, 0.0], false);
                place.jet(atoms[atom]).value
            });
            assert!(on_edges.determinant().abs() > 1e-3, "{valence}");
        }
    }
}
