//! Sums of splines, and knots put in and taken out.
//!
//! In the implicit form a sum is a sum of coefficients on the union of the knots, and a knot of
//! coefficient zero changes nothing. Splines with creases have values instead, of which the same holds.
//!
//! # Reference
//! [Hou2017] §4, Theorem 2.

use std::sync::Arc;

use msplines_common::evaluate::EvaluateError;
use msplines_common::linalg::Mat;

use crate::fit::{ascending, fit_closely};
use crate::gram::{Gram, Sight};
use crate::knot_values::KnotValues;
use crate::space::Difference;
use crate::target::Centred;
use crate::{BiharmonicSpline, FitError, Form, PartsError};

/// Distance between a spline and its extension from the knots that is left, against the spline's
/// largest value, that rounding explains: no refit is needed then.
const ROUNDING: f64 = 1e-11;

/// Why splines cannot be combined.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CombineError {
    /// There is nothing to combine.
    #[error("no splines were given; give at least one")]
    Nothing,
    /// A factor is NaN or infinite.
    #[error("the factor of spline {index} is {factor:?}; give a finite one")]
    Factor {
        /// Index of the spline.
        index: usize,
        /// Its factor.
        factor: f64,
    },
    /// The values of two splines have different numbers of components.
    #[error(
        "spline {index} has {found} components and the first has {expected}; combine splines of one dimension"
    )]
    Dimension {
        /// Index of the spline.
        index: usize,
        /// Its components.
        found: usize,
        /// Components of the first spline.
        expected: usize,
    },
    /// The splines lie on different meshes.
    #[error("spline {index} lies on another mesh than the first; fit both to the same mesh")]
    Mesh {
        /// Index of the spline.
        index: usize,
    },
    /// The splines are made of different Laplacians.
    #[error(
        "spline {index} is made of another Laplacian than the first; fit both with the same one"
    )]
    Laplacian {
        /// Index of the spline.
        index: usize,
    },
    /// The splines have different creases.
    #[error("spline {index} has other creases than the first; fit both with the same ones")]
    Creases {
        /// Index of the spline.
        index: usize,
    },
    /// A spline with creases cannot be evaluated.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
    /// A sum is beyond the largest number.
    #[error(transparent)]
    Parts(#[from] PartsError),
}

/// Why knots cannot be put in or taken out.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum KnotError {
    /// A knot to be inserted is there already.
    #[error("vertex {vertex} is a knot already; insert other vertices")]
    AlreadyThere {
        /// The vertex.
        vertex: u32,
    },
    /// A knot to be removed is none.
    #[error("vertex {vertex} is no knot of the spline; remove some of its knots")]
    NotThere {
        /// The vertex.
        vertex: u32,
    },
    /// No knot would be left.
    #[error("all {knots} knots were to be removed; leave at least one")]
    NoneLeft {
        /// Knots of the spline.
        knots: usize,
    },
    /// Vertices that do not exist or are named twice, or remaining knots that cannot be fitted.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// The spline cannot be evaluated.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
}

/// A spline without some of its knots, and how far it moved.
#[derive(Debug)]
pub struct Removal {
    /// The spline on the remaining knots.
    pub spline: BiharmonicSpline,
    /// Root mean square over the vertices of the distance to the former spline.
    pub root_mean_square: f64,
    /// The largest distance at a vertex.
    pub largest: f64,
}

/// Returns `Σ αᵢ fᵢ`, a spline on the union of all knots, from pairs of a spline and its factor.
///
/// Smooth splines are added coefficient by coefficient, in no time. With creases each spline is
/// evaluated, at the cost of a factorisation where it has not been before.
///
/// # Reference
/// [Hou2017] Theorem 2.
///
/// # Errors
/// Splines of different meshes, Laplacians, creases or dimensions, or none at all.
pub fn combine(terms: &[(&BiharmonicSpline, f64)]) -> Result<BiharmonicSpline, CombineError> {
    let &(first, _) = terms.first().ok_or(CombineError::Nothing)?;
    for (index, &(spline, factor)) in terms.iter().enumerate() {
        check_term(index, spline, factor, first)?;
    }
    let mut knots: Vec<u32> = terms.iter().flat_map(|t| t.0.knots()).copied().collect();
    knots.sort_unstable();
    knots.dedup();
    let (space, dimension) = (first.space(), first.dimension());
    if !space.creases().is_empty() {
        let mut f = Mat::zeros(space.mesh().vertex_count(), dimension);
        let mut mean = vec![0.0; dimension];
        for &(spline, factor) in terms {
            f += faer::Scale(factor) * spline.at_vertices()?;
            add(&mut mean, &spline.offset(), factor);
        }
        return Ok(BiharmonicSpline::of_vertex_values(space, knots, &f, &mean));
    }
    let mut sums = vec![0.0; knots.len() * dimension];
    let mut sum = vec![0.0; dimension];
    for &(spline, factor) in terms {
        add(&mut sums, &spline.coefficients_at(&knots), factor);
        add(&mut sum, &spline.offset(), factor);
    }
    let form = Form::Implicit {
        coefficients: sums,
        constant: sum,
    };
    Ok(BiharmonicSpline::from_parts(space, dimension, knots, form)?)
}

fn add(sum: &mut [f64], values: &[f64], factor: f64) {
    sum.iter_mut()
        .zip(values)
        .for_each(|(s, v)| *s += factor * v);
}

fn check_term(
    index: usize,
    spline: &BiharmonicSpline,
    factor: f64,
    first: &BiharmonicSpline,
) -> Result<(), CombineError> {
    if !factor.is_finite() {
        return Err(CombineError::Factor { index, factor });
    }
    match first.space().difference(spline.space()) {
        Some(Difference::Mesh) => return Err(CombineError::Mesh { index }),
        Some(Difference::Laplacian) => return Err(CombineError::Laplacian { index }),
        Some(Difference::Creases) => return Err(CombineError::Creases { index }),
        None => {}
    }
    let (found, expected) = (spline.dimension(), first.dimension());
    if found == expected {
        Ok(())
    } else {
        Err(CombineError::Dimension {
            index,
            found,
            expected,
        })
    }
}

impl BiharmonicSpline {
    /// Returns the same function with more knots.
    ///
    /// The new coefficients are zero, so that not a bit changes at the vertices; a spline with creases
    /// takes its own values there.
    ///
    /// # Reference
    /// [Hou2017] §4.
    ///
    /// # Errors
    /// Vertices that do not exist, are named twice, or are knots already.
    pub fn insert_knots(&self, inserted: &[u32]) -> Result<Self, KnotError> {
        let new = ascending(self.space().mesh().vertex_count(), inserted)?;
        if let Some(&vertex) = new.iter().find(|v| self.knots().binary_search(v).is_ok()) {
            return Err(KnotError::AlreadyThere { vertex });
        }
        let mut knots = [self.knots(), &new].concat();
        knots.sort_unstable();
        match self.form() {
            Form::Implicit { constant, .. } => {
                let all = self.coefficients_at(&knots);
                Ok(self.implicit(knots, all, constant.clone()))
            }
            Form::KnotValues(_) => {
                let (f, offset) = (self.at_vertices()?, self.offset());
                Ok(Self::of_vertex_values(self.space(), knots, f, &offset))
            }
        }
    }

    /// Returns the spline with fewer knots that is nearest to this one at the vertices.
    ///
    /// Exact where the removed knots have coefficient zero. Otherwise one factorisation and some
    /// dozen solves.
    ///
    /// # Reference
    /// [Hou2017] §4, Eq. (11). Deviation: Eq. (11) for the values of the spline itself.
    ///
    /// # Errors
    /// Knots that are none or are named twice, or no knots left.
    pub fn remove_knots(&self, removed: &[u32]) -> Result<Removal, KnotError> {
        let old = ascending(self.space().mesh().vertex_count(), removed)?;
        if let Some(&vertex) = old.iter().find(|v| self.knots().binary_search(v).is_err()) {
            return Err(KnotError::NotThere { vertex });
        }
        if old.len() == self.knots().len() {
            return Err(KnotError::NoneLeft { knots: old.len() });
        }
        let kept = |v: &&u32| old.binary_search(v).is_err();
        let knots: Vec<u32> = self.knots().iter().filter(kept).copied().collect();
        if let Form::Implicit { constant, .. } = self.form()
            && self.coefficients_at(&old).iter().all(|&w| w == 0.0)
        {
            let left = self.coefficients_at(&knots);
            return Ok(Removal {
                spline: self.implicit(knots, left, constant.clone()),
                root_mean_square: 0.0,
                largest: 0.0,
            });
        }
        self.refitted(knots)
    }

    fn refitted(&self, knots: Vec<u32>) -> Result<Removal, KnotError> {
        let offset = self.offset();
        let target = Centred {
            data: self.at_vertices()?.clone(),
            mean: offset.clone(),
            weights: None,
        };
        let data = &target.data;
        let system = KnotValues::factor(self.space(), knots.clone())?;
        let mut f = system.extend(system.gather(data).as_ref());
        if (data - &f).norm_max() > ROUNDING * data.norm_max() {
            let nearest = Gram::on(self.space(), &system, &target, Sight::Ring)
                .and_then(|gram| fit_closely(self.space(), &system, &target, data, &gram));
            f = nearest.map_err(FitError::from)?.0;
        }
        let distances: Vec<f64> = (0..f.nrows())
            .map(|v| (f.row(v) - data.row(v)).norm_l2())
            .collect();
        let squares: f64 = distances.iter().map(|d| d * d).sum();
        Ok(Removal {
            spline: Self::of_vertex_values(self.space(), knots, &f, &offset),
            root_mean_square: (squares / f.nrows() as f64).sqrt(),
            largest: distances.iter().copied().fold(0.0, f64::max),
        })
    }

    /// Returns the coefficients at some vertices, zero where there is no knot.
    fn coefficients_at(&self, vertices: &[u32]) -> Vec<f64> {
        let dimension = self.dimension();
        let mut found = vec![0.0; vertices.len() * dimension];
        if let Form::Implicit { coefficients, .. } = self.form() {
            for (to, vertex) in found.chunks_mut(dimension.max(1)).zip(vertices) {
                if let Ok(k) = self.knots().binary_search(vertex) {
                    to.copy_from_slice(&coefficients[k * dimension..(k + 1) * dimension]);
                }
            }
        }
        found
    }

    fn implicit(&self, knots: Vec<u32>, coefficients: Vec<f64>, constant: Vec<f64>) -> Self {
        let form = Form::Implicit {
            coefficients,
            constant,
        };
        Self::of_form(Arc::clone(self.space()), self.dimension(), knots, form)
    }
}
