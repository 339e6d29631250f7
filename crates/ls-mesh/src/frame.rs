//! Data in a frame of their own: centred, and of extent one.

use msplines_common::evaluate::VertexData;
use msplines_common::linalg::{Mat, MatRef};

use crate::error::FitError;

/// A shift and a scale that bring data into [-1, 1].
///
/// A least-squares mesh commutes with both, and tolerances become relative to the extent of the
/// data, wherever they are.
#[derive(Clone, Debug)]
pub(crate) struct Frame {
    mean: Vec<f64>,
    scale: f64,
}

impl Frame {
    pub(crate) fn measure(data: VertexData<'_>) -> Result<Self, FitError> {
        let dimension = data.dimension;
        let rows = (data.values.len() / dimension) as f64;
        let mut mean = vec![0.0; dimension];
        for row in data.values.chunks_exact(dimension) {
            mean.iter_mut()
                .zip(row)
                .for_each(|(sum, value)| *sum += value / rows);
        }
        let mut scale = 0.0_f64;
        for (vertex, row) in data.values.chunks_exact(dimension).enumerate() {
            for (component, (&value, mean)) in row.iter().zip(&mean).enumerate() {
                let deviation = (value - mean).abs();
                if !deviation.is_finite() {
                    return Err(FitError::NotFinite {
                        vertex,
                        component,
                        value,
                    });
                }
                scale = scale.max(deviation);
            }
        }
        // Constant data have no extent of their own.
        Ok(Self {
            mean,
            scale: if scale > 0.0 { scale } else { 1.0 },
        })
    }

    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    pub(crate) fn normalise(&self, data: VertexData<'_>) -> Mat<f64> {
        let dimension = data.dimension;
        Mat::from_fn(data.values.len() / dimension, dimension, |row, side| {
            (data.values[row * dimension + side] - self.mean[side]) / self.scale
        })
    }

    pub(crate) fn restore(&self, values: MatRef<'_, f64>) -> Vec<f64> {
        let rows = 0..values.nrows();
        let value = |row: usize, side: usize| values[(row, side)] * self.scale + self.mean[side];
        rows.flat_map(|row| (0..values.ncols()).map(move |side| value(row, side)))
            .collect()
    }
}

/// Returns the mean of the rows of each component at all its vertices.
pub(crate) fn component_means(
    values: MatRef<'_, f64>,
    labels: &[u32],
    components: u32,
) -> Mat<f64> {
    let mut sums: Mat<f64> = Mat::zeros(components as usize, values.ncols());
    let mut sizes = vec![0.0; components as usize];
    for (vertex, &label) in labels.iter().enumerate() {
        sizes[label as usize] += 1.0;
        for side in 0..values.ncols() {
            sums[(label as usize, side)] += values[(vertex, side)];
        }
    }
    Mat::from_fn(values.nrows(), values.ncols(), |vertex, side| {
        let label = labels[vertex] as usize;
        sums[(label, side)] / sizes[label]
    })
}
