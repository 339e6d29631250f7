//! What a spline is fitted to: data at the vertices, and how much each vertex counts.

use msplines_common::evaluate::VertexData;
use msplines_common::linalg::Mat;
use msplines_common::mesh::SurfacePoint;

use crate::{FitError, Space};

/// Data at the vertices with weights: a fit minimises `Σ cᵢ² |sᵢ - fᵢ|²`.
///
/// # Reference
/// [Hou2017] Eq. (13).
#[derive(Clone, Copy, Debug)]
pub struct Target<'a> {
    /// The data.
    pub data: VertexData<'a>,
    /// The weight `cᵢ` of each vertex, not negative; all 1 where absent.
    pub weights: Option<&'a [f64]>,
}

impl<'a> From<VertexData<'a>> for Target<'a> {
    fn from(data: VertexData<'a>) -> Self {
        Self {
            data,
            weights: None,
        }
    }
}

/// A checked target: the data less its mean, and the weights.
///
/// Constants belong to every spline space, so the mean is set aside: data far from the origin keeps
/// its digits.
pub(crate) struct Centred {
    /// n × d, of zero mean.
    pub(crate) data: Mat<f64>,
    /// The mean that was taken off.
    pub(crate) mean: Vec<f64>,
    /// The weights, where they are not all 1.
    pub(crate) weights: Option<Vec<f64>>,
}

/// Largest datum and weight: the sum of a million squares is finite yet.
const LARGEST: f64 = 1e150;

impl Centred {
    /// Checks a target on a mesh of so many vertices.
    pub(crate) fn check(vertices: usize, target: &Target<'_>) -> Result<Self, FitError> {
        let VertexData { dimension, values } = target.data;
        if dimension == 0 || values.len() != vertices * dimension {
            return Err(FitError::DataLength {
                values: values.len(),
                vertices,
                dimension,
            });
        }
        if let Some(at) = values
            .iter()
            .position(|value| value.is_nan() || value.abs() > LARGEST)
        {
            return Err(FitError::DataNotFinite {
                vertex: at / dimension,
                component: at % dimension,
                value: values[at],
            });
        }
        let mean: Vec<f64> = (0..dimension)
            .map(|c| {
                // Two passes: the first mean may have lost digits far from the origin.
                let component = || values.iter().skip(c).step_by(dimension);
                let rough = component().sum::<f64>() / vertices as f64;
                rough + component().map(|value| value - rough).sum::<f64>() / vertices as f64
            })
            .collect();
        let data = Mat::from_fn(vertices, dimension, |v, c| {
            values[v * dimension + c] - mean[c]
        });
        let weights = match target.weights {
            Some(weights) => checked_weights(vertices, weights)?,
            None => None,
        };
        Ok(Self {
            data,
            mean,
            weights,
        })
    }

    /// Returns the target at the vertices of the mesh of a space: those beyond the domain have no
    /// weight, and data between those of their face to start from.
    pub(crate) fn on(mut self, space: &Space) -> Self {
        let added = space.added_points();
        if added.is_empty() {
            return self;
        }
        let (known, dimension) = (self.data.nrows(), self.data.ncols());
        let between = |point: &SurfacePoint, c: usize| {
            let corners = space.domain().faces()[point.face as usize];
            let parts = corners.iter().zip(point.at);
            parts.map(|(&v, b)| b * self.data[(v as usize, c)]).sum()
        };
        self.data = Mat::from_fn(known + added.len(), dimension, |v, c| {
            match v.checked_sub(known) {
                Some(beyond) => between(&added[beyond], c),
                None => self.data[(v, c)],
            }
        });
        let mut weights = self.weights.unwrap_or_else(|| vec![1.0; known]);
        weights.resize(known + added.len(), 0.0);
        self.weights = Some(weights);
        self
    }

    /// Returns the weight of a vertex.
    pub(crate) fn weight(&self, vertex: usize) -> f64 {
        self.weights.as_ref().map_or(1.0, |weights| weights[vertex])
    }

    /// Returns how many vertices count.
    pub(crate) fn counted(&self) -> usize {
        match &self.weights {
            Some(weights) => weights.iter().filter(|&&c| c > 0.0).count(),
            None => self.data.nrows(),
        }
    }

    /// Returns `Σ cᵢ²`.
    pub(crate) fn total_weight(&self) -> f64 {
        match &self.weights {
            Some(weights) => weights.iter().map(|c| c * c).sum(),
            None => self.data.nrows() as f64,
        }
    }

    /// Multiplies row `i` by `cᵢ`.
    pub(crate) fn weigh(&self, rows: &mut Mat<f64>) {
        self.scale(rows, |c| c);
    }

    /// Multiplies row `i` by `cᵢ²`.
    pub(crate) fn weigh_twice(&self, rows: &mut Mat<f64>) {
        self.scale(rows, |c| c * c);
    }

    fn scale(&self, rows: &mut Mat<f64>, factor: impl Fn(f64) -> f64) {
        let Some(weights) = &self.weights else {
            return;
        };
        for side in 0..rows.ncols() {
            for (row, &weight) in weights.iter().enumerate() {
                rows[(row, side)] *= factor(weight);
            }
        }
    }
}

fn checked_weights(vertices: usize, weights: &[f64]) -> Result<Option<Vec<f64>>, FitError> {
    if weights.len() != vertices {
        return Err(FitError::WeightCount {
            found: weights.len(),
            vertices,
        });
    }
    if let Some(vertex) = weights.iter().position(|c| !(0.0..=LARGEST).contains(c)) {
        return Err(FitError::Weight {
            vertex,
            weight: weights[vertex],
        });
    }
    let all_one = weights.iter().all(|&c| c == 1.0);
    Ok((!all_one).then(|| weights.to_vec()))
}
