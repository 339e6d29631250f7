//! The functions that a chart is a combination of.
//!
//! # Notation
//! `(x, y)` is the position in the chart divided by the chart's radius, so that all of it lies in the
//! unit disk.
//!
//! # Reference
//! [Wang2016] §4.1, §4.2 (Figure 11), Appendix. Deviation: monomials are scaled by the radius, and by
//! default a chart has the shape functions of its own valence only.

use std::f64::consts::{PI, TAU};

use crate::cones::{cone, cones};
use crate::domain::{Star, power_jets};
use crate::jet::Jet;

/// Largest degree of the monomials.
pub const DEGREE: u32 = 14;

/// Valences whose shape functions the paper gives to every chart.
const COMMON_VALENCES: std::ops::RangeInclusive<u32> = 3..=7;

/// Frequencies of sine and cosine along each axis.
const FREQUENCIES: u32 = 3;

/// Intervals of the spline atoms along each axis.
const SPLINE_INTERVALS: u32 = 5;

/// Degree of the spline atoms, which are smooth to order three.
const SPLINE_DEGREE: u32 = 4;

/// What a dictionary holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DictionaryKind {
    /// Monomials up to degree 14, and the shape functions of the chart's own valence.
    #[default]
    Own,
    /// Monomials, and the 55 shape functions of the valences 3 to 7 (and the chart's own).
    AllShapes,
    /// Those of [`Self::Own`], then cones about the centre.
    Cones,
    /// Monomials only.
    Polynomials,
    /// Shape functions of the chart's own valence only.
    Shapes,
    /// Monomials, splines, sines and cosines, and shape functions of the chart's own valence.
    Rich,
    /// Tensor products of quartic splines only.
    Splines,
}

/// One function of a dictionary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Atom {
    /// `x^i y^j`.
    Monomial([u8; 2]),
    /// A bilinear shape function over the sectors of a star: of its centre, an edge or a far corner.
    Shape {
        /// Valence of the star.
        valence: u8,
        /// 0 for the centre, then the edges, then the far corners.
        node: u8,
    },
    /// `r^i cos(j θ)` or `r^i sin(j θ)` about the centre, where it is not smooth.
    Cone {
        /// The power `i` of the distance from the centre.
        power: u8,
        /// How often it turns about the centre, `j`.
        turns: u8,
        /// Whether it is the sine.
        sine: bool,
    },
    /// Products of `cos(i x)` or `sin(i x)` with those of `y`.
    Wave {
        /// Frequencies along the axes, in half turns across the chart.
        frequency: [u8; 2],
        /// Whether it is the sine along an axis.
        sine: [bool; 2],
    },
    /// A tensor product of B-splines.
    Spline([u8; 2]),
}

impl Atom {
    /// Returns whether the function has kinks along the edges of a star.
    #[must_use]
    pub fn is_shape(&self) -> bool {
        matches!(self, Self::Shape { .. })
    }

    /// Returns whether the function is smooth everywhere but at the centre of a star.
    #[must_use]
    pub fn is_cone(&self) -> bool {
        matches!(self, Self::Cone { .. })
    }
}

/// The atoms of a chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Dictionary {
    star: Star,
    atoms: Vec<Atom>,
}

impl Dictionary {
    /// Returns the dictionary of this kind for charts of this shape; `degree` bounds its monomials.
    #[must_use]
    pub fn new(kind: DictionaryKind, degree: u32, star: Star) -> Self {
        use DictionaryKind::{AllShapes, Cones, Own, Polynomials, Rich, Shapes, Splines};
        let mut atoms = Vec::new();
        if matches!(kind, Own | Cones | AllShapes | Polynomials | Rich) {
            let powers = (0..=degree).flat_map(|d| (0..=d).map(move |j| [(d - j) as u8, j as u8]));
            atoms.extend(powers.map(Atom::Monomial));
        }
        if matches!(kind, Rich | Splines) {
            let count = (SPLINE_INTERVALS + SPLINE_DEGREE) as u8;
            let places = (0..count).flat_map(|row| (0..count).map(move |column| [column, row]));
            atoms.extend(places.map(Atom::Spline));
        }
        if kind == Rich {
            atoms.extend(waves());
        }
        match kind {
            Own | Cones | Rich | Shapes => atoms.extend(shapes(star.valence)),
            AllShapes => {
                atoms.extend(COMMON_VALENCES.flat_map(shapes));
                if !COMMON_VALENCES.contains(&star.valence) {
                    atoms.extend(shapes(star.valence));
                }
            }
            Polynomials | Splines => {}
        }
        if kind == Cones {
            atoms.extend(cones(star));
        }
        Self { star, atoms }
    }

    /// Returns the functions.
    #[must_use]
    pub fn atoms(&self) -> &[Atom] {
        &self.atoms
    }

    /// Returns the value of every function at a point of the chart.
    #[must_use]
    pub fn values(&self, sector: u32, at: [f64; 2]) -> Vec<f64> {
        let place = Place::new(self.star, sector, at, false);
        self.atoms
            .iter()
            .map(|atom| place.jet(*atom).value)
            .collect()
    }

    /// Returns a point of the chart, at which its functions can be asked for one by one.
    pub(crate) fn place(&self, sector: u32, at: [f64; 2], derivatives: bool) -> Place {
        Place::new(self.star, sector, at, derivatives)
    }
}

fn waves() -> impl Iterator<Item = Atom> {
    let frequencies = 0..=FREQUENCIES as u8;
    let pairs = frequencies
        .clone()
        .flat_map(move |i| frequencies.clone().map(move |j| [i, j]));
    let phases = [[false, false], [true, false], [false, true], [true, true]];
    pairs
        .filter(|pair| *pair != [0, 0])
        .flat_map(move |frequency| {
            let vanishes = move |sine: &[bool; 2]| {
                (sine[0] && frequency[0] == 0) || (sine[1] && frequency[1] == 0)
            };
            let phases = phases.into_iter().filter(move |sine| !vanishes(sine));
            phases.map(move |sine| Atom::Wave { frequency, sine })
        })
}

fn shapes(valence: u32) -> impl Iterator<Item = Atom> {
    let valence = valence as u8;
    (0..=2 * valence).map(move |node| Atom::Shape { valence, node })
}

/// A point of a chart, with what its atoms have in common.
pub(crate) struct Place {
    star: Star,
    sector: u32,
    at: [f64; 2],
    /// Position over the radius.
    xy: [f64; 2],
    /// The same with derivatives by the corner coordinates, where they are asked for.
    jets: Option<[Jet; 2]>,
    /// Powers of both coordinates.
    powers: [[f64; DEGREE as usize + 1]; 2],
}

impl Place {
    fn new(star: Star, sector: u32, at: [f64; 2], derivatives: bool) -> Self {
        let scale = 1.0 / star.radius();
        let xy = star.position(sector, at).map(|c| c * scale);
        let mut powers = [[1.0; DEGREE as usize + 1]; 2];
        for (powers, c) in powers.iter_mut().zip(xy) {
            for i in 1..powers.len() {
                powers[i] = powers[i - 1] * c;
            }
        }
        let jets = derivatives.then(|| star.jets(sector, at).map(|jet| jet * scale));
        Self {
            star,
            sector,
            at,
            xy,
            jets,
            powers,
        }
    }

    /// Returns the jet of a function by the corner coordinates; without derivatives if the place has
    /// none.
    pub(crate) fn jet(&self, atom: Atom) -> Jet {
        if let Atom::Shape { valence, node } = atom {
            return self.shape(u32::from(valence), u32::from(node));
        }
        let plane = self.plane_jet(atom);
        match &self.jets {
            Some([x, y]) => Jet::of_composition(&plane, x, y),
            None => plane,
        }
    }

    /// Returns the jet of a smooth function by the scaled position in the chart.
    pub(crate) fn plane_jet(&self, atom: Atom) -> Jet {
        match atom {
            Atom::Monomial(powers) => {
                let [f, g] = [0, 1].map(|axis| self.power(axis, usize::from(powers[axis])));
                Jet::of_product(f, g)
            }
            Atom::Cone { power, turns, sine } => cone(self.xy, power, turns, sine),
            Atom::Wave { frequency, sine } => {
                let [f, g] = [0, 1].map(|axis| {
                    let rate = 0.5 * PI * f64::from(frequency[axis]);
                    wave(rate, self.xy[axis], sine[axis])
                });
                Jet::of_product(f, g)
            }
            Atom::Spline(place) => {
                let [f, g] = [0, 1].map(|axis| b_spline(place[axis], self.xy[axis]));
                Jet::of_product(f, g)
            }
            Atom::Shape { .. } => unreachable!("shape functions belong to sectors"),
        }
    }

    fn power(&self, axis: usize, n: usize) -> [f64; 3] {
        let powers = &self.powers[axis];
        let n_real = n as f64;
        [
            powers[n],
            if n > 0 { n_real * powers[n - 1] } else { 0.0 },
            if n > 1 {
                n_real * (n_real - 1.0) * powers[n - 2]
            } else {
                0.0
            },
        ]
    }

    /// Returns a shape function of a star of any valence about the same centre.
    fn shape(&self, valence: u32, node: u32) -> Jet {
        if valence == self.star.valence {
            return bilinear(valence, node, self.sector, self.at);
        }
        let [x, y] = self.star.position(self.sector, self.at);
        let other = Star {
            sectors: valence,
            valence,
        };
        let (sector, at) = other.locate([x, y]);
        let shape = bilinear(valence, node, sector, at);
        if self.jets.is_none() {
            return shape;
        }
        // Its corner coordinates are a power of those here.
        let own = TAU * f64::from(self.sector) / f64::from(self.star.valence);
        let turn = (own - TAU * f64::from(sector) / f64::from(valence)) * f64::from(valence) / 4.0;
        let power = f64::from(valence) / f64::from(self.star.valence);
        let [u, v] = power_jets(power, turn, self.at);
        Jet::of_composition(&shape, &u, &v)
    }
}

/// Returns a bilinear shape function of a star by the corner coordinates of a sector.
fn bilinear(valence: u32, node: u32, sector: u32, [u, v]: [f64; 2]) -> Jet {
    let (near, far) = (|c: f64| [1.0 - c, -1.0, 0.0], |c: f64| [c, 1.0, 0.0]);
    let next = (sector + 1) % valence;
    match node {
        0 => Jet::of_product(near(u), near(v)),
        n if n == 1 + sector => Jet::of_product(far(u), near(v)),
        n if n == 1 + next => Jet::of_product(near(u), far(v)),
        n if n == 1 + valence + sector => Jet::of_product(far(u), far(v)),
        _ => Jet::default(),
    }
}

fn wave(rate: f64, x: f64, sine: bool) -> [f64; 3] {
    let (sin, cos) = (rate * x).sin_cos();
    if sine {
        [sin, rate * cos, -rate * rate * sin]
    } else {
        [cos, -rate * sin, -rate * rate * cos]
    }
}

/// Returns a uniform quartic B-spline over [-1, 1] with its first two derivatives.
fn b_spline(index: u8, x: f64) -> [f64; 3] {
    let rate = 0.5 * f64::from(SPLINE_INTERVALS);
    let t = (x + 1.0) * rate - (f64::from(index) - f64::from(SPLINE_DEGREE));
    let cardinal = |degree: u32, t: f64| cardinal_b_spline(degree, t);
    let d = SPLINE_DEGREE;
    let first = cardinal(d - 1, t) - cardinal(d - 1, t - 1.0);
    let second = cardinal(d - 2, t) - 2.0 * cardinal(d - 2, t - 1.0) + cardinal(d - 2, t - 2.0);
    [cardinal(d, t), rate * first, rate * rate * second]
}

/// Returns the B-spline of the knots 0, 1, .., degree + 1.
fn cardinal_b_spline(degree: u32, t: f64) -> f64 {
    if degree == 0 {
        return f64::from(u8::from((0.0..1.0).contains(&t)));
    }
    if t <= 0.0 || t >= f64::from(degree + 1) {
        return 0.0;
    }
    let d = f64::from(degree);
    (t * cardinal_b_spline(degree - 1, t) + (d + 1.0 - t) * cardinal_b_spline(degree - 1, t - 1.0))
        / d
}
