//! Forms by coordinates, the first of which are integers, and what they cost.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::ClassObjective;
use crate::descent::{Objective, minimise};
use crate::uniformity::{FLOOR, Uniformity};

/// Forms by coordinates.
#[derive(Clone, Debug)]
pub(crate) struct ClassSpace {
    /// Inner products of the forms of unit coordinates.
    pub(crate) gram: DMatrix<f64>,
    /// Coordinates that are integers: the first ones.
    pub(crate) classes: usize,
    /// What turns coordinates into the levels of the holes against the first one.
    pub(crate) levels: DMatrix<f64>,
    /// What turns the coordinates of an imaginary part into those of its conjugate, where that is one of
    /// these forms too.
    pub(crate) turn: Option<DMatrix<f64>>,
    pub(crate) objective: ClassObjective,
}

impl ClassSpace {
    pub(super) fn is_zero(&self, x: &DVector<f64>) -> bool {
        x.iter().take(self.classes).all(|&n| n == 0.0)
    }

    /// What the energy of a form with these coordinates adds to its cost.
    pub(crate) fn cost_of_energy_of(&self, x: &DVector<f64>) -> f64 {
        self.cost_of_energy(x, x.dot(&(&self.gram * x)))
    }

    /// What the energy of a form adds to its cost. Without periods the range of its levels is the unit.
    fn cost_of_energy(&self, x: &DVector<f64>, energy: f64) -> f64 {
        if self.classes == 0 {
            return 0.0;
        }
        if !self.is_zero(x) {
            return self.objective.cost(0.0, energy);
        }
        let levels = &self.levels * x;
        let [low, high] = [levels.min().min(0.0), levels.max().max(0.0)];
        self.objective.cost(0.0, energy / (high - low).powi(2))
    }
}

/// A form and what it costs.
#[derive(Clone, Debug)]
pub(super) struct State {
    pub(super) x: DVector<f64>,
    pub(super) cost: f64,
    /// Derivatives on the samples.
    values: Vec<[f64; 2]>,
    /// `G x` and `xᵀ G x`.
    image: DVector<f64>,
    energy: f64,
}

impl State {
    /// Takes the opposite form, which costs the same.
    pub(super) fn turn_round(&mut self) {
        self.x.neg_mut();
        self.image.neg_mut();
        self.values
            .iter_mut()
            .for_each(|[a, b]| [*a, *b] = [-*a, -*b]);
    }
}

/// A space with the derivatives of its forms on samples of the surface.
pub(super) struct Sampled<'a> {
    pub(super) space: &'a ClassSpace,
    /// By coordinate and sample.
    columns: Vec<Vec<[f64; 2]>>,
    weights: Vec<f64>,
    /// Mean square of derivatives over the energy, times that of the least length counted.
    floor: f64,
    /// What turns real coordinates of unit energy into those of the space.
    whitened: DMatrix<f64>,
}

impl<'a> Sampled<'a> {
    pub(super) fn of(space: &'a ClassSpace, measure: &Uniformity) -> Self {
        let columns = measure.columns();
        let weights = measure.weights().to_vec();
        let square = |column: &Vec<[f64; 2]>| -> f64 {
            let terms = column.iter().zip(&weights);
            terms.map(|([a, b], w)| w * (a * a + b * b)).sum()
        };
        let squares: f64 = columns.iter().map(square).sum();
        let real = space.gram.nrows() - space.classes;
        let from = (space.classes, space.classes);
        let identity = || DMatrix::identity(real, real);
        let root = Cholesky::new(space.gram.view(from, (real, real)).into_owned());
        let root = root.map_or_else(identity, |factor| factor.l().transpose());
        Self {
            floor: FLOOR * FLOOR * squares / space.gram.trace(),
            whitened: root.try_inverse().unwrap_or_else(identity),
            space,
            columns,
            weights,
        }
    }

    /// The variance of `log |ω|` from derivatives. O(1) for each sample.
    fn variance(&self, values: impl Iterator<Item = [f64; 2]>, energy: f64) -> f64 {
        let floor = self.floor * energy;
        let (mut sum, mut squares) = (0.0, 0.0);
        for ([a, b], weight) in values.zip(&self.weights) {
            let log = 0.5 * (a * a + b * b + floor).ln();
            sum += weight * log;
            squares += weight * log * log;
        }
        squares - sum * sum
    }

    /// A form by its coordinates; those of a class with a common divisor are divided by it.
    pub(super) fn state(&self, mut x: DVector<f64>) -> State {
        x /= divisor(x.iter().take(self.space.classes).copied());
        let mut state = self.undivided(x);
        let variance = self.variance(state.values.iter().copied(), state.energy);
        state.cost = variance + self.space.cost_of_energy(&state.x, state.energy);
        state
    }

    /// The same as it is, without its cost.
    fn undivided(&self, x: DVector<f64>) -> State {
        let mut values = vec![[0.0; 2]; self.weights.len()];
        for (column, &factor) in self.columns.iter().zip(x.iter()) {
            if factor != 0.0 {
                for (value, q) in values.iter_mut().zip(column) {
                    *value = [value[0] + factor * q[0], value[1] + factor * q[1]];
                }
            }
        }
        let image = &self.space.gram * &x;
        State {
            energy: x.dot(&image),
            cost: f64::INFINITY,
            x,
            values,
            image,
        }
    }

    /// The cost of a form with one integer coordinate changed: O(1) for each sample.
    pub(super) fn cost_of_step(&self, from: &State, entry: usize, step: f64) -> f64 {
        let others = (0..self.space.classes).all(|k| k == entry || from.x[k] == 0.0);
        if others && from.x[entry] + step == 0.0 {
            return f64::INFINITY;
        }
        let own = self.space.gram[(entry, entry)];
        let energy = from.energy + 2.0 * step * from.image[entry] + step * step * own;
        let values = from.values.iter().zip(&self.columns[entry]);
        let variance = self.variance(
            values.map(|(v, q)| [v[0] + step * q[0], v[1] + step * q[1]]),
            energy,
        );
        let moved = |k: usize| from.x[k] + if k == entry { step } else { 0.0 };
        let divisor = divisor((0..self.space.classes).map(moved));
        self.space
            .objective
            .cost(variance, energy / (divisor * divisor))
    }

    /// The form of the same class whose real coordinates cost least nearby.
    pub(super) fn settled(&self, from: &State) -> State {
        let real = from.x.len() - self.space.classes;
        if real == 0 {
            return from.clone();
        }
        let problem = Settling {
            sampled: self,
            class: from.x.rows(0, self.space.classes).into_owned(),
            energy: if self.space.is_zero(&from.x) {
                0.0
            } else {
                self.space.objective.energy
            },
            scale: from.energy.sqrt(),
        };
        let start = self.whitened.clone().try_inverse().map_or_else(
            || DVector::zeros(real),
            |inverse| inverse * from.x.rows(self.space.classes, real) / problem.scale,
        );
        let (_, found) = minimise(&problem, start);
        let settled = self.state(problem.coordinates(&found));
        if settled.cost < from.cost {
            settled
        } else {
            from.clone()
        }
    }

    /// The form after a step, with its real coordinates.
    pub(super) fn stepped(&self, from: &State, entry: usize, step: f64) -> State {
        let mut x = from.x.clone();
        x[entry] += step;
        self.state(x)
    }
}

/// The cost of the forms of one class by their real coordinates.
struct Settling<'a> {
    sampled: &'a Sampled<'a>,
    class: DVector<f64>,
    energy: f64,
    scale: f64,
}

impl Settling<'_> {
    fn coordinates(&self, y: &DVector<f64>) -> DVector<f64> {
        let real = &self.sampled.whitened * y * self.scale;
        let all = self.class.iter().chain(real.iter()).copied();
        DVector::from_iterator(self.class.len() + y.len(), all)
    }
}

impl Objective for Settling<'_> {
    fn evaluate(&self, y: &DVector<f64>) -> (f64, DVector<f64>) {
        let sampled = self.sampled;
        let state = sampled.undivided(self.coordinates(y));
        let floor = sampled.floor * state.energy;
        let squares = |value: &[f64; 2]| value[0] * value[0] + value[1] * value[1] + floor;
        let logs: Vec<f64> = state.values.iter().map(|v| 0.5 * squares(v).ln()).collect();
        let weighted = logs.iter().zip(&sampled.weights);
        let mean: f64 = weighted.clone().map(|(log, w)| w * log).sum();
        let variance: f64 = weighted
            .map(|(log, w)| w * (log - mean) * (log - mean))
            .sum();
        // Derivatives of the variance by the squares, doubled.
        let factors: Vec<f64> = logs
            .iter()
            .zip(&sampled.weights)
            .zip(&state.values)
            .map(|((log, w), value)| 2.0 * w * (log - mean) / squares(value))
            .collect();
        let of_floor = sampled.floor * factors.iter().sum::<f64>();
        let energy = self.energy / state.energy;
        let by_coordinate = |j: usize| {
            let terms = factors.iter().zip(&state.values).zip(&sampled.columns[j]);
            let along: f64 = terms
                .map(|((factor, [a, b]), [p, q])| factor * (a * p + b * q))
                .sum();
            along + (of_floor + 2.0 * energy) * state.image[j]
        };
        let classes = self.class.len();
        let gradient = DVector::from_fn(y.len(), |j, _| by_coordinate(classes + j));
        let by_y = sampled.whitened.tr_mul(&gradient) * self.scale;
        (variance + self.energy * state.energy.ln(), by_y)
    }
}

/// The greatest common divisor of whole numbers, at least 1.
fn divisor(entries: impl Iterator<Item = f64>) -> f64 {
    let found = entries.fold(0, |a, b| greatest_common_divisor(a, b.abs() as i64));
    found.max(1) as f64
}

fn greatest_common_divisor(a: i64, b: i64) -> i64 {
    if b == 0 {
        a
    } else {
        greatest_common_divisor(b, a % b)
    }
}
