//! The search for coordinates that cost least: from short classes and rounded even forms, step by step.

use std::f64::consts::PI;

use nalgebra::{Cholesky, DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

use super::space::{ClassSpace, Sampled, State};
use crate::uniformity::Uniformity;

/// Samples that classes are compared by at first; the best few are compared by all.
const COARSE: usize = 2048;

/// Largest integer that even forms are scaled to before they are rounded.
const LARGEST_ENTRY: i32 = 3;

/// Directions of an even form that are rounded to classes.
const DIRECTIONS: u32 = 24;

/// Multiples of the real coordinates of even forms that each class is tried with, by the ratio of
/// their energies.
const SCALES: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];

/// Even forms whose real coordinates classes are tried with.
const PATTERNS: usize = 6;

/// Forms whose real coordinates are settled, and forms that are then improved step by step.
const SETTLED: usize = 36;
const CLIMBERS: usize = 12;

/// Steps that are settled before the best of them is taken.
const SETTLED_STEPS: usize = 4;

/// Climbers that are improved by all samples.
const FINALISTS: usize = 6;

/// Forms of any coordinates with locally least variance of `log |ω|`, best first, from random ones.
pub(crate) fn even_forms(
    measure: &Uniformity,
    gram: &DMatrix<f64>,
    seed: u64,
    starts: usize,
) -> Vec<(f64, DVector<f64>)> {
    let classes = gram.nrows();
    let identity = || DMatrix::identity(classes, classes);
    let root = Cholesky::new(gram.clone()).map_or_else(identity, |factor| factor.l().transpose());
    let to_coefficients = root.try_inverse().unwrap_or_else(identity);
    let whitened = measure.in_basis(&to_coefficients);
    let mut found: Vec<(f64, DVector<f64>)> = (0..starts)
        .into_par_iter()
        .map(|start| {
            let mut random = Pcg64Mcg::seed_from_u64(seed.wrapping_add(start as u64));
            let entry = |_, _| random.random::<f64>() - 0.5;
            let (value, x) = whitened.minimise(&DVector::from_fn(classes, entry));
            (value, &to_coefficients * x)
        })
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found
}

/// The coordinates that cost least, best first. O(g²) samples of forms are taken, and O(g) for each
/// step of each of a dozen climbers.
pub(crate) fn rank(
    space: &ClassSpace,
    measure: &Uniformity,
    seed: u64,
    starts: usize,
) -> Vec<DVector<f64>> {
    let few = measure.thinned(COARSE);
    let even = even_forms(&few, &space.gram, seed, starts);
    let even: Vec<DVector<f64>> = even.into_iter().map(|(_, x)| x).collect();
    let coarse = Sampled::of(space, &few);
    let first = sorted(beginnings(&coarse, &even), SETTLED);
    let settled = first.par_iter().map(|state| coarse.settled(state));
    let settled = sorted(settled.collect(), CLIMBERS);
    let climbed = settled
        .par_iter()
        .map(|state| climb(&coarse, state.clone()));
    let climbed = sorted(climbed.collect(), CLIMBERS);
    let fine = Sampled::of(space, measure);
    // Those that others climbed past stay, for where the best do not lie flat.
    let all: Vec<(usize, &State)> = climbed.iter().chain(&settled).enumerate().collect();
    let best = all.into_par_iter().map(|(place, state)| {
        let state = fine.settled(&fine.state(state.x.clone()));
        if place < FINALISTS.min(climbed.len()) {
            climb(&fine, state)
        } else {
            state
        }
    });
    let best = sorted(best.collect(), 2 * CLIMBERS);
    best.into_iter().map(|state| state.x).collect()
}

/// The forms that a search begins with.
fn beginnings(sampled: &Sampled<'_>, even: &[DVector<f64>]) -> Vec<State> {
    let space = sampled.space;
    let mut classes = short_classes(space.classes);
    classes.extend(even.iter().flat_map(|x| rounded(space, x)));
    classes.sort_unstable();
    classes.dedup();
    let real = space.gram.nrows() - space.classes;
    let whole = |class: &[i64], x: &[f64]| {
        let class = class.iter().map(|&n| n as f64);
        DVector::from_iterator(space.gram.nrows(), class.chain(x.iter().copied()))
    };
    let none = vec![0; space.classes];
    if real == 0 {
        classes.retain(|class| *class != none);
        let states = classes.par_iter();
        return states
            .map(|class| sampled.state(whole(class, &[])))
            .collect();
    }
    let patterns: Vec<&[f64]> = (even.iter().take(PATTERNS))
        .map(|x| &x.as_slice()[space.classes..])
        .collect();
    let energy = |x: &DVector<f64>| x.dot(&(&space.gram * x));
    let best = |class: &Vec<i64>| {
        let own = energy(&whole(class, &vec![0.0; real]));
        let tried = patterns.iter().flat_map(|&pattern| {
            let alone = energy(&whole(&none, pattern));
            let natural = if *class == none {
                1.0
            } else {
                (own / alone).sqrt()
            };
            let scales = SCALES.iter().flat_map(|s| [*s, -s]);
            scales.map(move |s| pattern.iter().map(|f| f * s * natural).collect())
        });
        let states = tried.map(|x: Vec<f64>| sampled.state(whole(class, &x)));
        states.min_by(|a, b| a.cost.total_cmp(&b.cost))
    };
    let mut found: Vec<State> = classes.par_iter().filter_map(best).collect();
    // Forms without periods, from every pattern.
    found.extend(
        patterns
            .iter()
            .map(|pattern| sampled.state(whole(&none, pattern))),
    );
    found
}

/// Classes of one and of two vectors of the short basis.
fn short_classes(classes: usize) -> Vec<Vec<i64>> {
    let unit = |k: usize, n: i64| (0..classes).map(move |j| if j == k { n } else { 0 });
    let mut found = Vec::new();
    for i in 0..classes {
        found.push(unit(i, 1).collect());
        for (j, sign) in (0..i).flat_map(|j| [(j, 1), (j, -1)]) {
            found.push(unit(j, 1).zip(unit(i, sign)).map(|(a, b)| a + b).collect());
        }
    }
    found
}

/// Classes near an even form, turned in all directions where it may be.
fn rounded(space: &ClassSpace, x: &DVector<f64>) -> Vec<Vec<i64>> {
    let turned = match &space.turn {
        None => vec![x.clone()],
        Some(turn) => {
            let conjugate = turn * x;
            let angles = (0..DIRECTIONS).map(|k| PI * f64::from(k) / f64::from(DIRECTIONS));
            angles.map(|a| x * a.cos() + &conjugate * a.sin()).collect()
        }
    };
    let round = |x: &DVector<f64>, largest: i32| {
        let class = x.rows(0, space.classes);
        let scale = f64::from(largest) / class.amax();
        class.iter().map(|n| (n * scale).round() as i64).collect()
    };
    let largest = if space.classes == 0 { 0 } else { LARGEST_ENTRY };
    let pairs = turned
        .iter()
        .flat_map(|x| (1..=largest).map(move |n| (x, n)));
    pairs.map(|(x, n)| round(x, n)).collect()
}

/// Changes one integer by one while that costs less.
fn climb(sampled: &Sampled<'_>, start: State) -> State {
    let classes = sampled.space.classes;
    let mut best = start;
    loop {
        let steps = (0..classes).flat_map(|entry| [(entry, -1.0), (entry, 1.0)]);
        let mut ranked: Vec<(f64, usize, f64)> = steps
            .map(|(entry, step)| (sampled.cost_of_step(&best, entry, step), entry, step))
            .collect();
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        let tried = ranked.iter().take(SETTLED_STEPS);
        let tried =
            tried.map(|&(_, entry, step)| sampled.settled(&sampled.stepped(&best, entry, step)));
        let found = tried.min_by(|a, b| a.cost.total_cmp(&b.cost));
        match found {
            Some(found) if found.cost < best.cost => best = found,
            _ => return best,
        }
    }
}

/// The first of all, best first; of forms and their opposites one each.
fn sorted(mut found: Vec<State>, count: usize) -> Vec<State> {
    for state in &mut found {
        let first = state.x.iter().find(|&&n| n != 0.0);
        if first.is_some_and(|&n| n < 0.0) {
            state.turn_round();
        }
    }
    let order = |a: &State, b: &State| {
        let entries = a.x.iter().zip(b.x.iter()).map(|(a, b)| a.total_cmp(b));
        let costs = a.cost.total_cmp(&b.cost);
        costs.then_with(|| entries.fold(std::cmp::Ordering::Equal, |all, one| all.then(one)))
    };
    found.sort_by(order);
    found.dedup_by(|a, b| (&a.x - &b.x).norm() <= SAME * b.x.norm());
    found.truncate(count);
    found
}

/// Relative distance of coordinates that are the same.
const SAME: f64 = 1e-4;
