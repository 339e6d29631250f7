//! The measures of a run, in the shape of its record.

use std::path::Path;

use msplines_common::Point3;
use msplines_common::mesh::TriangleMesh;
use msplines_common::metrics::{
    Distance, UnitCubeError, VertexError, distance, unit_cube_error, vertex_error,
};

use serde_json::{Value, json};

use crate::case::Data;
use crate::error::RunError;
use crate::input::{FitData, LoadedInput, read_surface};
use crate::spline_file::StoredSpline;

/// Points drawn from each surface.
const SAMPLES: usize = 100_000;
/// The tessellation is fine enough once halving it changes the root mean square by less than this.
const SETTLED: f64 = 0.01;
/// A tessellation is halved so often at most: eight pieces along each edge of the input.
const MOST_ROUNDS: u32 = 3;
/// Nor does halving go beyond so many vertices, where a factorisation takes gigabytes.
const MOST_VERTICES: usize = 200_000;

/// What was measured of one spline.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measured {
    /// Errors at the input vertices.
    pub error: Option<VertexError>,
    /// The same for positions, over the longest side of the bounding box.
    pub unit_cube: Option<UnitCubeError>,
    /// Distance between the surfaces.
    pub distance: Option<Distance>,
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
        Data::Attributes(_) | Data::Array(_) | Data::ColourPattern | Data::ColourImage => None,
    };
    Measured {
        error,
        unit_cube,
        distance: None,
    }
}

/// Returns the two-sided distance between the input surface and the tessellated spline.
///
/// The tessellation starts at the input's faces and is halved until that changes little. A
/// least-squares mesh is linear on the faces, so that they are its tessellation.
///
/// # Errors
/// A subdivision that cannot be evaluated, or a surface without area.
pub fn surface_distance(
    spline: &StoredSpline,
    mesh: &TriangleMesh,
    seed: u64,
) -> Result<Distance, RunError> {
    let is_linear = matches!(spline, StoredSpline::LsMesh { .. });
    settled_distance(mesh, seed, |rounds| {
        let (domain, values) = spline.evaluate(mesh, rounds)?;
        let positions = values.chunks_exact(3).map(Point3::from_slice).collect();
        let too_many = 4 * domain.vertex_count() > MOST_VERTICES;
        Ok(Tessellated {
            mesh: domain.with_positions(positions),
            is_finest: is_linear || rounds == MOST_ROUNDS || too_many,
        })
    })
}

/// A spline as triangles.
pub(crate) struct Tessellated {
    /// The triangles.
    pub(crate) mesh: TriangleMesh,
    /// Whether halving them would make too many.
    pub(crate) is_finest: bool,
}

/// Returns the two-sided distance between a surface and a spline, whose tessellation after so many
/// rounds of halving is given, until halving changes little or that is the finest.
///
/// # Errors
/// A tessellation that cannot be made, or a surface without area.
pub(crate) fn settled_distance(
    surface: &TriangleMesh,
    seed: u64,
    mut tessellate: impl FnMut(u32) -> Result<Tessellated, RunError>,
) -> Result<Distance, RunError> {
    let mut coarser: Option<Distance> = None;
    let mut rounds = 0;
    loop {
        let Tessellated { mesh, is_finest } = tessellate(rounds)?;
        let found = distance(surface, &mesh, SAMPLES, seed)?;
        let is_settled =
            coarser.is_some_and(|before| (found.rms - before.rms).abs() <= SETTLED * before.rms);
        if is_settled || is_finest {
            return Ok(found);
        }
        coarser = Some(found);
        rounds += 1;
    }
}

/// Returns the two-sided distance between the spline, `values` at the vertices of `mesh`, and the
/// surface in the file `reference`, as a fraction of the diagonal of `input`.
///
/// # Errors
/// A file that is no mesh, or a surface without area.
pub fn to_reference(
    reference: &Path,
    input: &TriangleMesh,
    mesh: &TriangleMesh,
    values: &[f64],
    seed: u64,
) -> Result<[(String, Value); 3], RunError> {
    let (other, _) = read_surface(reference)?;
    let positions = values.chunks_exact(3).map(Point3::from_slice).collect();
    let found = distance(&other, &mesh.with_positions(positions), SAMPLES, seed)?;
    let scale = other.diagonal() / input.diagonal();
    let named = [
        ("reference_mean", found.mean),
        ("reference_rms", found.rms),
        ("reference_max", found.max),
    ];
    Ok(named.map(|(name, value)| (name.to_owned(), json!(scale * value))))
}
