//! The error of a fit at the vertices it was fitted to.

use serde::{Deserialize, Serialize};

/// Vertex errors as fractions of a scale.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VertexError {
    /// What was compared: always `vertices` here.
    pub kind: String,
    /// Mean of the errors.
    pub mean: f64,
    /// Root of the mean of their squares.
    pub rms: f64,
    /// Largest error.
    pub max: f64,
    /// Length that stands for 1: what the errors were divided by.
    pub scale: f64,
    /// Peak signal-to-noise ratio per component, in decibels; `None` if there is no error at all.
    pub psnr_db: Option<f64>,
}

/// Vertex errors as fractions of the longest side of the bounding box.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct UnitCubeError {
    /// Root of the mean of the squared errors.
    pub rms: f64,
    /// Largest error.
    pub max: f64,
}

/// Why errors cannot be measured.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VertexErrorError {
    /// The values do not belong together.
    #[error(
        "{fitted} fitted and {reference} reference values are not two sets of vectors of dimension {dimension}"
    )]
    Shape {
        /// Number of fitted values.
        fitted: usize,
        /// Number of reference values.
        reference: usize,
        /// Components of each vector.
        dimension: usize,
    },
    /// The scale cannot be divided by.
    #[error("the scale of the data is {scale}; it must be positive and finite")]
    Scale {
        /// The scale.
        scale: f64,
    },
}

/// Returns the Euclidean errors of `fitted` against `reference` (both n × `dimension`, row-major)
/// divided by `scale`: the bounding-box diagonal for positions, 1 for colours in [0, 1], the range
/// of other data.
///
/// `psnr_db` is `10 log10(dimension · scale² / mean squared norm)`.
///
/// # Errors
/// If the values do not form as many vectors, at least one, or the scale is not positive.
pub fn vertex_error(
    fitted: &[f64],
    reference: &[f64],
    dimension: usize,
    scale: f64,
) -> Result<VertexError, VertexErrorError> {
    let [sum, squares, max] = sums(fitted, reference, dimension, scale)?;
    let count = (fitted.len() / dimension) as f64;
    let mean_square = squares / count;
    Ok(VertexError {
        kind: "vertices".to_owned(),
        mean: sum / count / scale,
        rms: mean_square.sqrt() / scale,
        max: max / scale,
        scale,
        psnr_db: (mean_square > 0.0)
            .then(|| 10.0 * (dimension as f64 * scale * scale / mean_square).log10()),
    })
}

/// Returns the errors of positions divided by `side`, the longest side of the bounding box.
///
/// # Errors
/// As [`vertex_error`].
pub fn unit_cube_error(
    fitted: &[f64],
    reference: &[f64],
    side: f64,
) -> Result<UnitCubeError, VertexErrorError> {
    let [_, squares, max] = sums(fitted, reference, 3, side)?;
    let count = (fitted.len() / 3) as f64;
    Ok(UnitCubeError {
        rms: (squares / count).sqrt() / side,
        max: max / side,
    })
}

/// Returns the sum of the errors, the sum of their squares, and the largest.
fn sums(
    fitted: &[f64],
    reference: &[f64],
    dimension: usize,
    scale: f64,
) -> Result<[f64; 3], VertexErrorError> {
    let whole = dimension > 0 && !fitted.is_empty() && fitted.len().is_multiple_of(dimension);
    if !whole || fitted.len() != reference.len() {
        let (fitted, reference) = (fitted.len(), reference.len());
        return Err(VertexErrorError::Shape {
            fitted,
            reference,
            dimension,
        });
    }
    if !(scale > 0.0 && scale.is_finite()) {
        return Err(VertexErrorError::Scale { scale });
    }
    let rows = fitted
        .chunks_exact(dimension)
        .zip(reference.chunks_exact(dimension));
    let norms = rows.map(|(a, b)| {
        a.iter()
            .zip(b)
            .map(|(x, y)| (x - y) * (x - y))
            .sum::<f64>()
            .sqrt()
    });
    // A NaN among the data must show in the result; the maximum of floats would drop it.
    let larger = |a: f64, b: f64| if b > a || b.is_nan() { b } else { a };
    Ok(norms.fold([0.0; 3], |[sum, squares, max], e| {
        [sum + e, squares + e * e, larger(max, e)]
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_of_known_offsets_are_exact() {
        let reference = [0.0; 6];
        let fitted = [3.0, 4.0, 0.0, 0.0, 0.0, 0.0];
        let error = vertex_error(&fitted, &reference, 3, 10.0).unwrap();
        assert_eq!((error.mean, error.max, error.scale), (0.25, 0.5, 10.0));
        assert!((error.rms - 12.5f64.sqrt() / 10.0).abs() < 1e-15);
        // d · scale² / mean squared norm = 3 · 100 / 12.5 = 24
        assert!((error.psnr_db.unwrap() - 10.0 * 24f64.log10()).abs() < 1e-12);
        let cube = unit_cube_error(&fitted, &reference, 5.0).unwrap();
        assert_eq!(cube.max, 1.0);
    }

    #[test]
    fn an_exact_fit_has_no_signal_to_noise_ratio() {
        let error = vertex_error(&[1.0, 2.0], &[1.0, 2.0], 1, 1.0).unwrap();
        assert_eq!((error.max, error.psnr_db), (0.0, None));
    }

    #[test]
    fn wrong_shapes_and_scales_are_named() {
        let text = |result: Result<VertexError, VertexErrorError>| result.unwrap_err().to_string();
        assert_eq!(
            text(vertex_error(&[1.0; 4], &[1.0; 4], 3, 1.0)),
            "4 fitted and 4 reference values are not two sets of vectors of dimension 3"
        );
        assert_eq!(
            text(vertex_error(&[1.0], &[1.0], 1, 0.0)),
            "the scale of the data is 0; it must be positive and finite"
        );
        assert!(vertex_error(&[], &[], 3, 1.0).is_err());
        assert!(
            vertex_error(&[f64::NAN], &[1.0], 1, 1.0)
                .unwrap()
                .max
                .is_nan()
        );
    }
}
