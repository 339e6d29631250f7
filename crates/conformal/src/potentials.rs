//! Functions whose differences are right to many digits even where they hardly change.
//!
//! Along a limb of a surface a harmonic form decays exponentially, soon below the last digit of the
//! function that it is the derivative of: by more than 10⁻³³ on a scanned dragon. So functions are sums
//! of several doubles, and are refined with residuals whose terms are right relative to the form nearby.
//!
//! # Notation
//! `H_k = W_k + df_k` harmonic, `W_k` integer closed; `c` weights of half-edges; `dᵀ c H_k` fluxes.
//!
//! # Reference
//! [Ogita2005] Algorithm 4.8, sums of doubles without loss.

use msplines_common::linalg::{Mat, column_mut};
use msplines_common::operators::Poisson;
use msplines_common::progress::{Stages, Stopped};
use rayon::prelude::*;

use crate::homology::Cocycle;

/// Doubles that a function is the sum of.
const PARTS: usize = 5;

/// Most solves: each gains the digits that the one before lost, ten or more.
const SOLVES: usize = 16;

/// Flux out of a vertex, relative to the largest one beside it, below which nothing is refined.
const BALANCED: f64 = 1e-9;

/// Flux out of a vertex, relative to the largest one beside it, that counts as rounding.
const ROUNDING: f64 = 1e-13;

/// Relative difference above which the first two parts of a function tell it to all digits.
const PLAIN: f64 = 1e-8;

/// Faces that one task handles: a fixed number, so that results do not depend on the threads.
const FACES_PER_TASK: usize = 1024;

/// Faces whose values are held at once.
const FACES_AT_ONCE: usize = 16 * FACES_PER_TASK;

/// Integer closed forms and the functions that make them harmonic.
#[derive(Clone, Debug)]
pub(crate) struct Potentials {
    classes: usize,
    faces: Vec<[u32; 3]>,
    /// `values[vertex * classes + k]`, the largest part first.
    values: Vec<[f64; PARTS]>,
    /// For each face where its entries in `integers` start.
    starts: Vec<u32>,
    /// Class and values on the three sides, for the classes whose integer form is not zero there.
    integers: Vec<(u32, [i32; 3])>,
}

impl Potentials {
    /// Returns the integer forms with functions that are zero.
    pub(crate) fn start(vertices: usize, faces: &[[u32; 3]], cocycles: &[Cocycle]) -> Self {
        let mut entries: Vec<(u32, u32, [i32; 3])> = Vec::new();
        for (k, cocycle) in (0u32..).zip(cocycles) {
            for &(half_edge, value) in cocycle {
                let (face, i) = (half_edge / 3, (half_edge % 3) as usize);
                if entries
                    .last()
                    .is_none_or(|last| (last.0, last.1) != (face, k))
                {
                    entries.push((face, k, [0; 3]));
                }
                if let Some(last) = entries.last_mut() {
                    last.2[i] = value;
                }
            }
        }
        entries.sort_unstable();
        let mut starts = vec![0u32; faces.len() + 1];
        entries.iter().for_each(|e| starts[e.0 as usize + 1] += 1);
        for face in 0..faces.len() {
            starts[face + 1] += starts[face];
        }
        Self {
            classes: cocycles.len(),
            faces: faces.to_vec(),
            values: vec![[0.0; PARTS]; vertices * cocycles.len()],
            starts,
            integers: entries
                .into_iter()
                .map(|(_, k, sides)| (k, sides))
                .collect(),
        }
    }

    /// Returns the same functions with the integer forms on other faces over the same vertices.
    pub(crate) fn on(&self, faces: &[[u32; 3]], cocycles: &[Cocycle]) -> Self {
        Self {
            values: self.values.clone(),
            ..Self::start(0, faces, cocycles)
        }
    }

    /// Makes the forms harmonic; returns the largest remaining flux out of a vertex relative to the
    /// largest one beside that vertex.
    ///
    /// # Errors
    /// The observer asks to stop, before one of the solves.
    pub(crate) fn solve(
        &mut self,
        poisson: &Poisson,
        weights: &[f64],
        stages: &mut Stages<'_, '_>,
    ) -> Result<f64, Stopped> {
        let mut fluxes = self.fluxes(weights);
        let mut solves = 0;
        loop {
            stages.enter()?;
            poisson.solve_balanced_in_place(fluxes.into_vertices.as_mut());
            for (place, value) in self.values.iter_mut().enumerate() {
                let (vertex, k) = (place / self.classes, place % self.classes);
                add(value, fluxes.into_vertices[(vertex, k)]);
            }
            fluxes = self.fluxes(weights);
            solves += 1;
            if fluxes.unrest <= BALANCED || solves == SOLVES {
                return Ok(fluxes.unrest);
            }
            for (k, &vertex) in fluxes.strongest.iter().enumerate() {
                let column = column_mut(fluxes.into_vertices.as_mut(), k);
                // What rounding leaves where the form is large would, solved for, leave its own
                // rounding where the form is small.
                for (flux, beside) in column.iter_mut().zip(&fluxes.beside) {
                    if flux.abs() <= ROUNDING * beside {
                        *flux = 0.0;
                    }
                }
                balance(column, vertex as usize);
            }
        }
    }

    /// The fluxes of the forms.
    fn fluxes(&self, weights: &[f64]) -> Fluxes {
        let vertices = self.values.len() / self.classes;
        let mut into: Mat<f64> = Mat::zeros(vertices, self.classes);
        let mut beside = vec![0.0f64; vertices];
        let mut strongest = vec![(0.0f64, 0u32); self.classes];
        for first in (0..self.faces.len()).step_by(FACES_AT_ONCE) {
            let faces = first..(first + FACES_AT_ONCE).min(self.faces.len());
            let sides: Vec<[f64; 3]> = faces
                .clone()
                .into_par_iter()
                .flat_map_iter(|face| {
                    let mut sides = vec![[0.0; 3]; self.classes];
                    self.sides(face, &mut sides);
                    sides
                })
                .collect();
            for k in 0..self.classes {
                let column = column_mut(into.as_mut(), k);
                for face in faces.clone() {
                    let corners = self.faces[face];
                    let values = sides[(face - first) * self.classes + k];
                    for i in 0..3 {
                        let through = weights[3 * face + i] * values[i];
                        let [from, to] = [corners[i] as usize, corners[(i + 1) % 3] as usize];
                        if through.abs() > strongest[k].0 {
                            strongest[k] = (through.abs(), corners[i]);
                        }
                        column[from] += through;
                        column[to] -= through;
                        beside[from] = beside[from].max(through.abs());
                        beside[to] = beside[to].max(through.abs());
                    }
                }
            }
        }
        let columns = into
            .col_iter()
            .flat_map(|c| (0..vertices).map(move |v| (v, c[v])));
        let relative = columns.map(|(v, flux)| flux.abs() / beside[v].max(f64::MIN_POSITIVE));
        Fluxes {
            unrest: relative.fold(0.0, f64::max),
            into_vertices: into,
            beside,
            strongest: strongest.into_iter().map(|s| s.1).collect(),
        }
    }

    /// Writes the values of all forms `H_k` on the three sides of a face.
    pub(crate) fn sides(&self, face: usize, out: &mut [[f64; 3]]) {
        let at = self.faces[face].map(|v| v as usize * self.classes);
        for (k, sides) in out.iter_mut().enumerate() {
            let f = at.map(|start| &self.values[start + k]);
            *sides = std::array::from_fn(|i| difference(f[(i + 1) % 3], f[i], 0.0));
        }
        let entries = self.starts[face] as usize..self.starts[face + 1] as usize;
        for &(k, integers) in &self.integers[entries] {
            let k = k as usize;
            let f = at.map(|start| &self.values[start + k]);
            let along = |i: usize| difference(f[(i + 1) % 3], f[i], f64::from(integers[i]));
            out[k] = std::array::from_fn(along);
        }
    }

    /// Returns the combination of the functions, without the integer forms, by vertex.
    pub(crate) fn function(&self, coefficients: &[f64]) -> Vec<f64> {
        let vertices = self.values.chunks_exact(self.classes);
        let sum = |values: &[[f64; PARTS]]| {
            let terms = values.iter().zip(coefficients);
            terms.map(|(value, a)| a * value.iter().sum::<f64>()).sum()
        };
        vertices.map(sum).collect()
    }

    /// Returns, by half-edge, the combinations of the forms with two sets of coefficients.
    pub(crate) fn combine(&self, parts: [&[f64]; 2]) -> Vec<[f64; 2]> {
        let mut form = vec![[0.0; 2]; 3 * self.faces.len()];
        let tasks = form.par_chunks_mut(3 * FACES_PER_TASK).enumerate();
        tasks.for_each(|(task, chunk)| {
            let mut sides = vec![[0.0; 3]; self.classes];
            for (place, out) in chunk.as_chunks_mut::<3>().0.iter_mut().enumerate() {
                self.sides(task * FACES_PER_TASK + place, &mut sides);
                for (i, value) in out.iter_mut().enumerate() {
                    let along = |a: &[f64]| a.iter().zip(&sides).map(|(a, s)| a * s[i]).sum();
                    *value = parts.map(along);
                }
            }
        });
        form
    }
}

/// How much of the forms flows into each vertex.
struct Fluxes {
    /// `-dᵀ c H_k`, one column each.
    into_vertices: Mat<f64>,
    /// Largest of them relative to the largest flux of any form through a half-edge beside.
    unrest: f64,
    /// For each vertex the largest flux of any form through a half-edge there.
    beside: Vec<f64>,
    /// For each form a vertex at the half-edge of its largest flux.
    strongest: Vec<u32>,
}

/// Adds a number to a sum of doubles.
fn add(value: &mut [f64; PARTS], mut number: f64) {
    for part in value.iter_mut() {
        (*part, number) = two_sum(*part, number);
    }
    // What was added may be larger than parts before: once more, so that parts do not overlap.
    for i in 0..PARTS - 1 {
        (value[i], value[i + 1]) = two_sum(value[i], value[i + 1]);
    }
}

/// Returns `to - from + integer`, right to its own size.
fn difference(to: &[f64; PARTS], from: &[f64; PARTS], integer: f64) -> f64 {
    let (first, error) = two_sum(to[0], -from[0]);
    let (sum, more) = two_sum(first, integer);
    if sum.abs() > PLAIN * (to[0].abs() + integer.abs()) {
        return sum + (more + error + (to[1] - from[1]));
    }
    let mut terms = [0.0; 2 * PARTS + 1];
    [terms[0], terms[1], terms[2]] = [sum, more, error];
    for i in 1..PARTS {
        (terms[2 * i + 1], terms[2 * i + 2]) = two_sum(to[i], -from[i]);
    }
    // Each pass carries what the sum of the terms before has lost to the next pass.
    for _ in 1..PARTS {
        for i in 1..terms.len() {
            (terms[i], terms[i - 1]) = two_sum(terms[i], terms[i - 1]);
        }
    }
    terms.iter().sum()
}

/// Makes values sum to zero by changing one of them: there, where it matters least.
fn balance(values: &mut [f64], place: usize) {
    let (mut sum, mut rest) = (0.0, 0.0);
    values[place] = 0.0;
    for &value in values.iter() {
        let (next, error) = two_sum(sum, value);
        (sum, rest) = (next, rest + error);
    }
    values[place] = -(sum + rest);
}

/// Returns the rounded sum, and what rounding took away.
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let other = sum - a;
    (sum, (a - (sum - other)) + (b - other))
}
