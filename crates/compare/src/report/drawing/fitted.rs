//! How a spline compares with the data that it was fitted to.

use msplines_common::mesh::{TriangleMesh, VertexAttribute};
use msplines_picture::Rgb;

use super::source::missing;
use crate::experiment::RowData;
use crate::input::{FitData, LoadedInput, fit_data};

/// A fit beside its data.
pub(super) struct Fitted {
    /// Colours of the data and of the spline, where the data are colours.
    pub(super) colours: Option<[Vec<Rgb>; 2]>,
    /// Error at each vertex of the input, over the scale of the data.
    pub(super) errors: Vec<f64>,
}

impl Fitted {
    /// Compares a spline with the data of its row.
    pub(super) fn of(
        data: RowData,
        input: &LoadedInput,
        spline: &TriangleMesh,
        attributes: &[VertexAttribute],
    ) -> Result<Self, String> {
        if spline.vertex_count() < input.mesh.vertex_count() {
            return Err(missing());
        }
        let fitted = fit_data(&data.data(), input).map_err(|e| e.to_string())?;
        let values = values(spline, attributes, &fitted)?;
        Ok(Self {
            errors: errors(&fitted, &values),
            colours: data
                .are_colours()
                .then(|| [colours(&fitted.values), colours(&values)]),
        })
    }

    /// Compares a spline with a frame of an animation of its input.
    pub(super) fn of_frame(
        original: &TriangleMesh,
        spline: &TriangleMesh,
        input: &LoadedInput,
    ) -> Self {
        let pairs = original.positions().iter().zip(spline.positions());
        // One scale for all frames.
        let scale = input.mesh.diagonal();
        Self {
            errors: pairs.map(|(a, b)| (a - b).norm() / scale).collect(),
            colours: None,
        }
    }

    /// Returns the mean of the errors.
    pub(super) fn mean_error(&self) -> f64 {
        self.errors.iter().sum::<f64>() / self.errors.len().max(1) as f64
    }

    /// Returns the error below which the share `share` of the vertices lies.
    pub(super) fn error_quantile(&self, share: f64) -> f64 {
        let mut sorted = self.errors.clone();
        sorted.sort_by(f64::total_cmp);
        let at = (share * sorted.len() as f64) as usize;
        sorted
            .get(at.min(sorted.len().saturating_sub(1)))
            .copied()
            .unwrap_or(0.0)
    }
}

/// Returns the spline's values, `[vertex][component]`.
fn values(
    spline: &TriangleMesh,
    attributes: &[VertexAttribute],
    data: &FitData,
) -> Result<Vec<f64>, String> {
    if data.names == ["x", "y", "z"] {
        let positions = spline.positions().iter();
        return Ok(positions.flat_map(|p| [p.x, p.y, p.z]).collect());
    }
    let mut columns = Vec::with_capacity(data.names.len());
    for name in &data.names {
        let found = attributes.iter().find(|attribute| attribute.name == *name);
        columns.push(
            &found
                .ok_or_else(|| format!("its file has no `{name}`"))?
                .values,
        );
    }
    let vertices = 0..spline.vertex_count();
    Ok(vertices
        .flat_map(|vertex| columns.iter().map(move |column| column[vertex]))
        .collect())
}

fn errors(data: &FitData, values: &[f64]) -> Vec<f64> {
    let pairs = data.values.chunks(data.dimension);
    pairs
        .zip(values.chunks(data.dimension))
        .map(|(expected, found)| {
            let squares = expected.iter().zip(found).map(|(a, b)| (a - b) * (a - b));
            squares.sum::<f64>().sqrt() / data.scale
        })
        .collect()
}

/// Returns the colours whose channels in 0..=1 are `values`, `[vertex][channel]`.
pub(super) fn colours(values: &[f64]) -> Vec<Rgb> {
    let byte = |value: f64| (255.0 * value.clamp(0.0, 1.0)).round() as u8;
    values
        .chunks_exact(3)
        .map(|c| Rgb::new(byte(c[0]), byte(c[1]), byte(c[2])))
        .collect()
}
