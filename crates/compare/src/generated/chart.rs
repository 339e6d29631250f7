//! Heights above a single chart, with the samples that a fit sees.

use std::fmt;
use std::str::FromStr;

use msplines_common::Point3;
use msplines_sparse_manifold::{Atom, ChartPoint, DEGREE, Star};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::{Deserialize, Serialize};

/// Heights of the centre, the edges and the far corners of a roof, in turns.
const ROOF: [f64; 7] = [0.55, 0.1, 0.6, -0.15, 0.45, 0.0, 0.3];
/// Sizes of the coefficients of random polynomials.
const COEFFICIENTS: std::ops::Range<f64> = 0.1..1.0;

/// A function of a chart: a kind, and words that say how it is sampled.
///
/// `chart-5+roof+samples-100+noise-0.02`: a function with a kink along every edge of a star of valence
/// 5, known at 100 random points but for noise of that standard deviation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct ChartFunction {
    name: String,
    valence: u32,
    kind: Kind,
    places: Places,
    noise: f64,
    trials: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// Waves without kinks.
    Smooth,
    /// Waves, and a kink along two edges.
    Ridge,
    /// Weak waves, and kinks along all edges that no atom has alike.
    Roof,
    /// The polynomial of four terms that the paper names.
    Printed,
    /// A random polynomial of so many terms.
    Terms(u32),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Places {
    /// So many random points, evenly in the corner coordinates.
    Random(u32),
    /// The corners of so many cells along each side of every sector.
    Grid(u32),
}

/// A function to be found, with samples of it.
#[derive(Clone, Debug)]
pub(crate) struct Sampled {
    pub(crate) function: Height,
    pub(crate) points: Vec<ChartPoint>,
    /// Heights at the points, with noise.
    pub(crate) values: Vec<f64>,
}

impl Sampled {
    /// Returns the samples in space.
    pub(crate) fn places(&self, star: Star) -> Vec<Point3<f64>> {
        let raise = |(p, &z): (&ChartPoint, &f64)| {
            let [x, y] = star.position(p.sector, p.at);
            Point3::new(x, y, z)
        };
        self.points.iter().zip(&self.values).map(raise).collect()
    }
}

/// A function of a chart.
#[derive(Clone, Debug)]
pub(crate) struct Height {
    star: Star,
    kind: Kind,
    /// Exponents and coefficients of a polynomial of the position over the radius.
    pub(crate) terms: Vec<([u8; 2], f64)>,
}

impl ChartFunction {
    /// Returns the shape of the chart.
    #[must_use]
    pub fn star(&self) -> Star {
        Star {
            sectors: self.valence,
            valence: self.valence,
        }
    }

    /// Returns how many functions of this kind are tried.
    #[must_use]
    pub fn trials(&self) -> u32 {
        self.trials
    }

    /// Returns the function of a trial and its samples.
    pub(crate) fn sampled(&self, seed: u64, trial: u32) -> Sampled {
        // Streams of one generator: trials have nothing in common.
        let mut random = Pcg64Mcg::seed_from_u64(seed.wrapping_add(u64::from(trial) << 32));
        let function = Height {
            star: self.star(),
            kind: self.kind,
            terms: self.terms(&mut random),
        };
        let points = self.points(&mut random);
        let noisy = |point: &ChartPoint| function.at(*point) + self.noise * normal(&mut random);
        let values = points.iter().map(noisy).collect();
        Sampled {
            function,
            points,
            values,
        }
    }

    fn terms(&self, random: &mut Pcg64Mcg) -> Vec<([u8; 2], f64)> {
        let count = match self.kind {
            Kind::Printed => {
                return vec![
                    ([2, 0], 0.6),
                    ([0, 2], 0.25),
                    ([4, 2], 0.09),
                    ([6, 7], 0.12),
                ];
            }
            Kind::Terms(count) => count as usize,
            Kind::Smooth | Kind::Ridge | Kind::Roof => 0,
        };
        let mut terms: Vec<([u8; 2], f64)> = Vec::with_capacity(count);
        while terms.len() < count {
            let total = random.random_range(0..=DEGREE as u8);
            let second = random.random_range(0..=total);
            let powers = [total - second, second];
            if terms.iter().all(|(known, _)| *known != powers) {
                let size = random.random_range(COEFFICIENTS);
                let sign = if random.random_bool(0.5) { 1.0 } else { -1.0 };
                terms.push((powers, sign * size));
            }
        }
        terms
    }

    fn points(&self, random: &mut Pcg64Mcg) -> Vec<ChartPoint> {
        match self.places {
            Places::Random(count) => (0..count)
                .map(|_| ChartPoint {
                    sector: random.random_range(0..self.valence),
                    at: [random.random(), random.random()],
                })
                .collect(),
            Places::Grid(cells) => grid(self.valence, cells),
        }
    }
}

/// Returns the corners of the cells of all sectors, each once: a sector has its first edge, not its
/// last one.
pub(crate) fn grid(sectors: u32, cells: u32) -> Vec<ChartPoint> {
    let step = move |i: u32| f64::from(i) / f64::from(cells);
    let mut points = vec![ChartPoint {
        sector: 0,
        at: [0.0; 2],
    }];
    for sector in 0..sectors {
        let places = (1..=cells).flat_map(|i| (0..=cells).map(move |j| [step(i), step(j)]));
        points.extend(places.map(|at| ChartPoint { sector, at }));
    }
    points
}

/// Returns a number of the standard normal distribution.
fn normal(random: &mut Pcg64Mcg) -> f64 {
    let (radius, angle): (f64, f64) = (random.random(), random.random());
    (-2.0 * (1.0 - radius).ln()).sqrt() * (std::f64::consts::TAU * angle).cos()
}

impl Height {
    /// Returns the height above a point.
    pub(crate) fn at(&self, point: ChartPoint) -> f64 {
        let radius = self.star.radius();
        let [x, y] = self.star.position(point.sector, point.at);
        let [x, y] = [x / radius, y / radius];
        let waves = 0.2 * (2.5 * x + 0.4).sin() * (2.0 * y).cos() + 0.15 * x * y;
        match self.kind {
            Kind::Smooth => waves,
            Kind::Ridge => waves + 0.4 * self.ridge(point),
            Kind::Roof => {
                let bent = 1.0 + 0.35 * (3.0 * x - y).sin();
                0.5 * waves + 0.6 * bent * self.roof(point)
            }
            Kind::Printed | Kind::Terms(_) => {
                let term = |([i, j], c): &([u8; 2], f64)| {
                    c * x.powi(i32::from(*i)) * y.powi(i32::from(*j))
                };
                self.terms.iter().map(term).sum()
            }
        }
    }

    /// Returns a function that is one along two opposite edges and falls off to both sides.
    fn ridge(&self, ChartPoint { sector, at: [u, v] }: ChartPoint) -> f64 {
        let k = self.star.valence;
        let on = |edge: u32| f64::from(u8::from(edge.is_multiple_of(k) || edge == k / 2));
        (1.0 - u) * (1.0 - v) + on(sector) * u * (1.0 - v) + on(sector + 1) * v * (1.0 - u)
    }

    /// Returns the function with given heights at the centre, the edges and the far corners.
    fn roof(&self, ChartPoint { sector, at: [u, v] }: ChartPoint) -> f64 {
        let k = self.star.valence;
        let height = |node: u32| ROOF[node as usize % ROOF.len()];
        let (first, second) = (1 + sector, 1 + (sector + 1) % k);
        height(0) * (1.0 - u) * (1.0 - v)
            + height(first) * u * (1.0 - v)
            + height(second) * v * (1.0 - u)
            + height(1 + k + sector) * u * v
    }

    /// Returns whether these atoms with their coefficients are the polynomial, but for others whose
    /// coefficients are smaller than all of its own by the factor `tolerance`.
    pub(crate) fn is_recovered(
        &self,
        atoms: &[Atom],
        coefficients: &[f64],
        tolerance: f64,
    ) -> bool {
        let least = self.terms.iter().map(|(_, c)| c.abs());
        let allowed = tolerance * least.fold(f64::INFINITY, f64::min);
        let due = |atom: &Atom| match atom {
            Atom::Monomial(powers) => {
                let term = self.terms.iter().find(|(own, _)| own == powers);
                term.map_or(0.0, |(_, c)| *c)
            }
            _ => 0.0,
        };
        let pairs = atoms.iter().zip(coefficients);
        let all_right = pairs
            .clone()
            .all(|(atom, c)| (c - due(atom)).abs() <= allowed);
        let found = pairs.filter(|(atom, _)| due(atom) != 0.0).count();
        all_right && found == self.terms.len() && !self.terms.is_empty()
    }
}

impl fmt::Display for ChartFunction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)
    }
}

impl From<ChartFunction> for String {
    fn from(function: ChartFunction) -> Self {
        function.name
    }
}

impl TryFrom<String> for ChartFunction {
    type Error = UnknownFunction;

    fn try_from(name: String) -> Result<Self, UnknownFunction> {
        name.parse()
    }
}

/// No function of a chart has this name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "no function `{name}`; give chart-VALENCE, then each after a +, one of smooth, ridge, roof, printed and terms-N, one of samples-N and grid-N, and perhaps noise-DEVIATION and trials-N"
)]
pub struct UnknownFunction {
    /// The name.
    pub name: String,
}

/// Largest numbers in a name.
const MOST_SAMPLES: u32 = 100_000;
const MOST_CELLS: u32 = 100;
const MOST_TERMS: u32 = 100;
const MOST_TRIALS: u32 = 10_000;
const VALENCES: std::ops::RangeInclusive<u32> = 3..=24;

impl FromStr for ChartFunction {
    type Err = UnknownFunction;

    fn from_str(name: &str) -> Result<Self, UnknownFunction> {
        let unknown = || UnknownFunction {
            name: name.to_owned(),
        };
        let mut parts = name.split('+');
        let valence = parts.next().and_then(|base| base.strip_prefix("chart-"));
        let valence = valence.and_then(|n| n.parse().ok());
        let valence = valence.filter(|n| VALENCES.contains(n));
        let (mut kind, mut places, mut noise, mut trials) = (None, None, 0.0, 1);
        for part in parts {
            let (word, number) = part.split_once('-').unwrap_or((part, ""));
            let whole = |most: u32| {
                let number = number.parse::<u32>().ok();
                number
                    .filter(|n| (1..=most).contains(n))
                    .ok_or_else(unknown)
            };
            match word {
                "smooth" => kind = Some(Kind::Smooth),
                "ridge" => kind = Some(Kind::Ridge),
                "roof" => kind = Some(Kind::Roof),
                "printed" => kind = Some(Kind::Printed),
                "terms" => kind = Some(Kind::Terms(whole(MOST_TERMS)?)),
                "samples" => places = Some(Places::Random(whole(MOST_SAMPLES)?)),
                "grid" => places = Some(Places::Grid(whole(MOST_CELLS)?)),
                "trials" => trials = whole(MOST_TRIALS)?,
                "noise" => {
                    let number = number.parse::<f64>().ok();
                    let number = number.filter(|x| x.is_finite() && *x >= 0.0);
                    noise = number.ok_or_else(unknown)?;
                }
                _ => return Err(unknown()),
            }
        }
        let (Some(valence), Some(kind), Some(places)) = (valence, kind, places) else {
            return Err(unknown());
        };
        Ok(Self {
            name: name.to_owned(),
            valence,
            kind,
            places,
            noise,
            trials,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn function(name: &str) -> ChartFunction {
        name.parse().expect(name)
    }

    #[test]
    fn functions_are_continuous_across_the_edges_of_the_star() {
        for name in [
            "chart-5+roof+grid-4",
            "chart-6+ridge+grid-4",
            "chart-3+smooth+grid-4",
        ] {
            let chart = function(name);
            let height = chart.sampled(1, 0).function;
            for sector in 0..chart.valence {
                let next = (sector + 1) % chart.valence;
                let edge = |sector, at| height.at(ChartPoint { sector, at });
                let gap = edge(sector, [0.0, 0.7]) - edge(next, [0.7, 0.0]);
                assert!(gap.abs() < 1e-12, "{name}: {gap}");
            }
        }
    }

    #[test]
    fn samples_are_the_same_every_time_and_noisy_as_asked() {
        let chart = function("chart-4+smooth+samples-4000+noise-0.05");
        let sampled = chart.sampled(7, 0);
        assert_eq!(sampled.values, chart.sampled(7, 0).values);
        assert_ne!(sampled.values, chart.sampled(7, 1).values);
        let apart = |(p, v): (&ChartPoint, &f64)| (v - sampled.function.at(*p)).powi(2);
        let squares: f64 = sampled.points.iter().zip(&sampled.values).map(apart).sum();
        let deviation = (squares / 4000.0).sqrt();
        assert!((deviation - 0.05).abs() < 3e-3, "{deviation}");
        assert_eq!(
            function("chart-4+smooth+grid-8").sampled(0, 0).points.len(),
            289
        );
    }

    #[test]
    fn a_polynomial_is_recovered_by_its_own_terms_and_nothing_else() {
        let height = function("chart-4+printed+grid-8").sampled(0, 0).function;
        let (mut atoms, mut coefficients): (Vec<Atom>, Vec<f64>) = height
            .terms
            .iter()
            .map(|(p, c)| (Atom::Monomial(*p), *c))
            .unzip();
        assert!(height.is_recovered(&atoms, &coefficients, 1e-6));
        atoms.push(Atom::Monomial([1, 1]));
        coefficients.push(1e-3);
        assert!(!height.is_recovered(&atoms, &coefficients, 1e-6));
        coefficients[4] = 1e-9;
        assert!(height.is_recovered(&atoms, &coefficients, 1e-6));
        assert!(!height.is_recovered(&atoms[1..], &coefficients[1..], 1e-6));
    }

    #[test]
    fn other_names_are_refused_with_what_there_is() {
        for name in [
            "chart-5",
            "chart-2+smooth+grid-4",
            "chart-5+smooth",
            "chart-5+smooth+grid-0",
            "chart-5+smooth+grid-4+noise-nan",
            "chart-5+smooth+grid-4+loud",
        ] {
            let error = name.parse::<ChartFunction>().expect_err(name).to_string();
            assert!(error.contains("give chart-VALENCE"), "{error}");
        }
    }
}
