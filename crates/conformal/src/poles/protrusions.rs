//! Poles at the protrusions of a surface: where another pole makes forms most even.
//!
//! # Notation
//! `G_p` the potential of a unit source at vertex `p`; `v = Σ a_k H_k + Σ φ_p G_p`, `Σ φ_p = 0`, the
//! imaginary part of a form with poles; its length is `|∇v|`, and no conjugate is needed.
//!
//! # Reference
//! [He2006] §3.2, cuts at protrusions. Deviation: the paper chooses them by hand.

use msplines_common::linalg::{Mat, column};
use msplines_common::mesh::{Facts, TriangleMesh};
use msplines_common::operators::intrinsic::{
    FlipRule, IntrinsicTriangulation, intrinsic_delaunay_by,
};
use msplines_common::operators::{Poisson, assemble};
use msplines_common::progress::{Observer, Stages};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::search::balanced;
use super::tips::tips;
use crate::basis::HolomorphicBasis;
use crate::descent::minimise;
use crate::error::ConformalError;
use crate::uniformity::{Uniformity, gradient, sampled};

/// Samples that sets of poles are compared by.
const SAMPLES: usize = 2048;

/// Fluxes of a new pole that are tried, over the mean of those there are.
const NEW_FLUXES: [f64; 6] = [0.25, 0.5, 1.0, -0.25, -0.5, -1.0];

/// Lengths below this part of the root mean square count as this part: forms that fade are what further
/// poles are to mend, so that they have to be told.
const LEAST: f64 = 1e-8;

/// Random class coefficients that sets of poles are tried with on a surface with handles.
const STARTS: usize = 1;

/// Which poles are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ProtrusionOptions {
    /// Most poles.
    pub most: usize,
    /// By how much the variance of `log |ω|` has to fall for another pole to be taken.
    pub gain: f64,
}

impl Default for ProtrusionOptions {
    fn default() -> Self {
        Self {
            most: 12,
            gain: 0.07,
        }
    }
}

/// Poles at protrusions.
#[derive(Clone, Debug, PartialEq)]
pub struct Protrusions {
    /// The vertices, in the order in which they were chosen.
    pub vertices: Vec<u32>,
    /// The variance of `log |ω|` with the first so many of them, beginning with two.
    pub variances: Vec<f64>,
}

impl Protrusions {
    /// Returns the poles of a closed surface: of the tips of its protrusions the two between which forms
    /// are most even, and then one after the other that makes them more even than all others, as long as
    /// that is worth it. Cost: one factorisation of the Laplacian, some twenty solves, and as many
    /// distances.
    ///
    /// # Errors
    /// A surface that has a boundary or several parts; the observer asks to stop.
    pub fn of(
        mesh: &TriangleMesh,
        options: &ProtrusionOptions,
        observer: &mut Observer<'_>,
    ) -> Result<Self, ConformalError> {
        let mut stages = Stages::new("domain", 0, observer);
        stages.enter()?;
        let facts = Facts::measure(mesh);
        let Some(genus) = facts.genus else {
            let components = facts.components;
            return Err(ConformalError::NotConnected { components });
        };
        if facts.boundary_loops > 0 {
            let loops = facts.boundary_loops;
            let boundary = mesh.topology().boundary_loops().concat();
            let vertex = mesh.topology().origin(boundary[0]);
            return Err(ConformalError::Boundary { loops, vertex });
        }
        let tips = tips(mesh);
        stages.enter()?;
        let mut potentials = Potentials {
            weights: Vec::new(),
            sources: Vec::new(),
            classes: Vec::new(),
        };
        if genus > 0 {
            let basis = HolomorphicBasis::of(
                mesh,
                &crate::homology::Homology::build(mesh.topology())?,
                &[],
                &mut stages,
            )?;
            potentials.add_classes(&basis);
            potentials.add_sources(mesh, basis.triangulation(), &tips)?;
        } else {
            let triangulation = intrinsic_delaunay_by(mesh, FlipRule::Simplicial)?;
            potentials.add_sources(mesh, &triangulation, &tips)?;
        }
        stages.enter()?;
        let mut chosen = potentials.best_pair();
        let mut variances = vec![chosen.variance];
        while chosen.poles.len() < options.most.min(tips.len()) {
            stages.enter()?;
            let Some(next) = potentials.best_with_another(&chosen) else {
                break;
            };
            variances.push(next.variance);
            chosen = next;
        }
        let count = worthwhile(&variances, options.gain);
        variances.truncate(count);
        let kept = chosen.poles.iter().take(count + 1);
        Ok(Self {
            vertices: kept.map(|&tip| tips[tip]).collect(),
            variances,
        })
    }
}

/// How many of the variances to take: so many that all steps on together bring less than `gain` each.
/// One pole on one of two like limbs may bring nothing without the other.
fn worthwhile(variances: &[f64], gain: f64) -> usize {
    let cost = |&(count, variance): &(usize, &f64)| variance + gain * count as f64;
    let all = variances.iter().enumerate();
    let best = all.min_by(|a, b| cost(a).total_cmp(&cost(b)));
    best.map_or(1, |(count, _)| count + 1)
}

/// A set of poles, and the most even form that was found with them.
#[derive(Clone, Debug)]
struct Set {
    poles: Vec<usize>,
    /// Coefficients of the classes, then fluxes.
    coefficients: Vec<f64>,
    variance: f64,
}

/// Gradients of potentials on samples.
struct Potentials {
    weights: Vec<f64>,
    sources: Vec<Vec<[f64; 2]>>,
    classes: Vec<Vec<[f64; 2]>>,
}

impl Potentials {
    fn add_classes(&mut self, basis: &HolomorphicBasis) {
        let triangulation = basis.triangulation();
        let mut sides = vec![[0.0; 3]; basis.classes()];
        self.classes = vec![Vec::new(); basis.classes()];
        for face in sampled(triangulation, SAMPLES).0 {
            basis.potentials().sides(face, &mut sides);
            for (column, along) in self.classes.iter_mut().zip(&sides) {
                column.push(gradient(triangulation.lengths[face], [along[0], along[2]]));
            }
        }
    }

    fn add_sources(
        &mut self,
        mesh: &TriangleMesh,
        triangulation: &IntrinsicTriangulation,
        tips: &[u32],
    ) -> Result<(), ConformalError> {
        let vertices = mesh.vertex_count();
        let operators = assemble(vertices, &triangulation.faces, &triangulation.lengths);
        let poisson = Poisson::factor(&operators)?;
        let mut values = Mat::zeros(vertices, tips.len());
        for (source, &tip) in tips.iter().enumerate() {
            values[(tip as usize, source)] = 1.0;
        }
        poisson.solve_in_place(values.as_mut());
        let (chosen, weights) = sampled(triangulation, SAMPLES);
        self.weights = weights;
        let potential = |source: usize| {
            let values = column(values.as_ref(), source);
            let on_face = |&face: &usize| {
                let [a, b, c] = triangulation.faces[face].map(|v| values[v as usize]);
                gradient(triangulation.lengths[face], [b - a, a - c])
            };
            chosen.iter().map(on_face).collect()
        };
        self.sources = (0..tips.len()).map(potential).collect();
        Ok(())
    }

    /// The form with these poles that is most even near coefficients of classes and fluxes.
    fn settled(&self, poles: &[usize], start: &[f64]) -> Option<Set> {
        let classes = self.classes.len();
        let free = classes + poles.len() - 1;
        let samples = self.weights.len();
        let entry = |sample: usize, k: usize, part: usize| match k.checked_sub(classes) {
            None => self.classes[k][sample][part],
            Some(other) => {
                self.sources[poles[other + 1]][sample][part] - self.sources[poles[0]][sample][part]
            }
        };
        let parts = [0, 1].map(|part| DMatrix::from_fn(samples, free, |s, k| entry(s, k, part)));
        let gram = parts.iter().fold(DMatrix::zeros(free, free), |sum, part| {
            let weighted = DMatrix::from_fn(samples, free, |s, k| self.weights[s] * part[(s, k)]);
            sum + part.tr_mul(&weighted)
        });
        let root = nalgebra::Cholesky::new(gram)?.l().transpose();
        let inverse = root.clone().try_inverse()?;
        let measure = Uniformity::from_parts(&parts, self.weights.clone()).with_least(LEAST);
        let of = |fluxes: &[f64]| {
            let others = start[..classes].iter().chain(&fluxes[1..]).copied();
            DVector::from_iterator(free, others)
        };
        let x = &root * of(&start[classes..]);
        let (_, x) = minimise(&measure.in_basis(&inverse), x.normalize());
        let found = inverse * x;
        let others = found.rows(classes, poles.len() - 1);
        let fluxes = std::iter::once(-others.sum()).chain(others.iter().copied());
        let fluxes = balanced(fluxes.collect())?;
        let all = found.iter().take(classes).chain(&fluxes).copied();
        let coefficients: Vec<f64> = all.collect();
        let kept = coefficients[..classes]
            .iter()
            .chain(&coefficients[classes + 1..]);
        let kept = DVector::from_iterator(free, kept.copied());
        Some(Set {
            poles: poles.to_vec(),
            variance: measure.variance(&kept),
            coefficients,
        })
    }

    fn best_pair(&self) -> Set {
        let tips = self.sources.len();
        let classes = self.classes.len();
        let pairs: Vec<[usize; 2]> = (0..tips)
            .flat_map(|a| (a + 1..tips).map(move |b| [a, b]))
            .collect();
        let starts = if classes == 0 { 1 } else { STARTS };
        let settle = |pair: &[usize; 2]| {
            let starts = (0..starts).filter_map(|start| {
                let turned = |k: usize| ((start * classes + k + 1) as f64).sin();
                let mut coefficients: Vec<f64> = (0..classes).map(turned).collect();
                coefficients.extend([1.0, -1.0]);
                self.settled(pair, &coefficients)
            });
            starts.min_by(|a, b| a.variance.total_cmp(&b.variance))
        };
        let found: Vec<Set> = pairs.par_iter().filter_map(settle).collect();
        let best = found
            .into_iter()
            .min_by(|a, b| a.variance.total_cmp(&b.variance));
        best.unwrap_or(Set {
            poles: vec![0, 1],
            coefficients: Vec::new(),
            variance: f64::INFINITY,
        })
    }

    fn best_with_another(&self, set: &Set) -> Option<Set> {
        let others = (0..self.sources.len()).filter(|tip| !set.poles.contains(tip));
        let classes = self.classes.len();
        let fluxes = &set.coefficients[classes..];
        let mean = fluxes.iter().map(|f| f.abs()).sum::<f64>() / fluxes.len() as f64;
        let tried: Vec<(usize, f64)> = others
            .flat_map(|tip| NEW_FLUXES.map(|share| (tip, share * mean)))
            .collect();
        let with = |&(tip, flux): &(usize, f64)| {
            let mut poles = set.poles.clone();
            poles.push(tip);
            let mut coefficients = set.coefficients.clone();
            // What the new pole takes comes from the others in proportion.
            let same: f64 = fluxes
                .iter()
                .filter(|f| **f * flux < 0.0)
                .map(|f| f.abs())
                .sum();
            for own in &mut coefficients[classes..] {
                if *own * flux < 0.0 {
                    *own *= 1.0 + flux.abs() / same;
                }
            }
            coefficients.push(flux);
            self.settled(&poles, &coefficients)
        };
        let found: Vec<Set> = tried.par_iter().filter_map(with).collect();
        found
            .into_iter()
            .min_by(|a, b| a.variance.total_cmp(&b.variance))
    }
}
