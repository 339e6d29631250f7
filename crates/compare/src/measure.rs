//! The measures of a run, in the shape of its record.

use msplines_common::metrics::{UnitCubeError, VertexError, unit_cube_error, vertex_error};

use crate::case::Data;
use crate::input::{FitData, LoadedInput};
use crate::record::DistanceMeasure;

/// What was measured of one spline.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measured {
    /// Errors at the input vertices.
    pub error: Option<VertexError>,
    /// The same for positions, over the longest side of the bounding box.
    pub unit_cube: Option<UnitCubeError>,
    /// Distance between the surfaces.
    pub distance: Option<DistanceMeasure>,
}

/// Returns the errors of `values` against `data` at the vertices of the input.
///
/// `values` may go on beyond those of the input vertices, as those of a subdivision do. Nothing is
/// measured where all data are equal, as no scale is left to divide by.
#[must_use]
pub fn against_data(input: &LoadedInput, data: &FitData, values: &[f64], kind: &Data) -> Measured {
    let fitted = &values[..data.values.len().min(values.len())];
    let error = vertex_error(fitted, &data.values, data.dimension, data.scale).ok();
    let [low, high] = input.mesh.bounding_box();
    let unit_cube = match kind {
        Data::Positions => unit_cube_error(fitted, &data.values, (high - low).max()).ok(),
        Data::Attributes(_) | Data::ColourPattern => None,
    };
    Measured {
        error,
        unit_cube,
        distance: None,
    }
}
