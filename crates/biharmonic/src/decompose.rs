//! Hierarchical decomposition: data as a sum of splines from coarse to fine, and what is left.
//!
//! # Notation
//! `S = S₁ + S₂ + … + R`: each layer `Sᵢ` is a spline fitted to what the layers before it left, with
//! knots of its own; the residual `R` is data at the vertices.
//!
//! # Reference
//! [Hou2017] §7.2, Alg. 4, Eq. (13). Deviation: knots by elimination and exchange, in whose scores
//! the weights of the vertices stand.

use std::sync::Arc;

use msplines_common::evaluate::{EvaluateError, VertexData};
use msplines_common::progress::{Observer, Outcome};

use crate::{Fit, FitError, KnotChoice, Options, Space, Target, fit_in};

/// One layer of a decomposition.
#[derive(Clone, Debug)]
pub struct Layer<'a> {
    /// The knots of its spline.
    pub knots: KnotChoice,
    /// How much each vertex counts; all alike where absent.
    pub weights: Option<&'a [f64]>,
}

/// Data as a sum of splines and a residual.
#[derive(Debug)]
pub struct Decomposition {
    /// The splines, coarse to fine, and how they were fitted.
    pub layers: Vec<Fit>,
    /// Their values at the vertices, n × d each.
    pub layer_values: Vec<Vec<f64>>,
    /// What they leave of the data, n × d.
    pub residual: Vec<f64>,
}

/// Why data cannot be decomposed or put together again.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DecomposeError {
    /// No layers were asked for.
    #[error("a decomposition has at least one layer of splines; name its knots")]
    NoLayers,
    /// A layer cannot be fitted.
    #[error("layer {layer}: {source}")]
    Layer {
        /// Index of the layer, from 1.
        layer: usize,
        /// Why.
        source: FitError,
    },
    /// A layer cannot be evaluated.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
    /// There is not one factor for every part.
    #[error(
        "{found} factors were given for {parts} parts; give one for each layer and one for the residual"
    )]
    Factors {
        /// Factors given.
        found: usize,
        /// Layers and the residual.
        parts: usize,
    },
    /// A factor is NaN or infinite.
    #[error("factor {index} is {value}; give finite factors")]
    Factor {
        /// Index of the factor.
        index: usize,
        /// Its value.
        value: f64,
    },
}

/// Decomposes data at the vertices into splines and a residual.
///
/// The seed of each layer follows from that of `options`, whose knots are not looked at. The cost is
/// that of one fit per layer. When the observer breaks, the layer in work is stopped and those after
/// it are fitted with what its first sample of knots gives.
///
/// # Errors
/// No layers, or a layer that cannot be fitted.
pub fn decompose(
    space: &Arc<Space>,
    data: VertexData<'_>,
    layers: &[Layer<'_>],
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<Decomposition, DecomposeError> {
    if layers.is_empty() {
        return Err(DecomposeError::NoLayers);
    }
    let mut residual = data.values.to_vec();
    let (mut fits, mut values) = (Vec::new(), Vec::new());
    for (index, layer) in layers.iter().enumerate() {
        let target = Target {
            data: VertexData {
                dimension: data.dimension,
                values: &residual,
            },
            weights: layer.weights,
        };
        let options = Options {
            knots: layer.knots.clone(),
            seed: options.seed.wrapping_add(index as u64),
            ..options.clone()
        };
        let fit =
            fit_in(space, target, &options, observer).map_err(|source| DecomposeError::Layer {
                layer: index + 1,
                source,
            })?;
        let found = fit.spline.vertex_values()?;
        residual.iter_mut().zip(&found).for_each(|(r, f)| *r -= f);
        values.push(found);
        fits.push(fit);
    }
    Ok(Decomposition {
        layers: fits,
        layer_values: values,
        residual,
    })
}

impl Decomposition {
    /// Returns the sum of all parts, each times its factor: one for every layer and the last one for
    /// the residual. Factors of 1 give the data, larger ones exaggerate.
    ///
    /// # Errors
    /// Not one finite factor for each part.
    pub fn recombine(&self, factors: &[f64]) -> Result<Vec<f64>, DecomposeError> {
        let parts = self.layers.len() + 1;
        if factors.len() != parts {
            return Err(DecomposeError::Factors {
                found: factors.len(),
                parts,
            });
        }
        if let Some(index) = factors.iter().position(|factor| !factor.is_finite()) {
            return Err(DecomposeError::Factor {
                index,
                value: factors[index],
            });
        }
        let mut sum = vec![0.0; self.residual.len()];
        let values = self.layer_values.iter().chain([&self.residual]);
        for (values, factor) in values.zip(factors) {
            sum.iter_mut()
                .zip(values)
                .for_each(|(s, x)| *s += factor * x);
        }
        Ok(sum)
    }

    /// Returns how the decomposition ended: the worst of its layers.
    #[must_use]
    pub fn outcome(&self) -> Outcome {
        let of = |wanted| self.layers.iter().any(|fit| fit.report.outcome == wanted);
        [Outcome::Stopped, Outcome::MaxIterations, Outcome::Stalled]
            .into_iter()
            .find(|&outcome| of(outcome))
            .unwrap_or(Outcome::Converged)
    }
}
