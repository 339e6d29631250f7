//! All methods behind one signature, so that a law is written once and tested on each.

use msplines_common::evaluate::{SurfaceSpline, VertexData};
use msplines_common::mesh::TriangleMesh;
use msplines_common::progress::{Observer, Outcome};

/// The examples of the README compile.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
pub struct Readme;

/// What every method gives.
pub struct Fitted {
    /// The spline as the harness sees it.
    pub spline: Box<dyn SurfaceSpline>,
    /// Its values at the vertices, vertex after vertex.
    pub values: Vec<f64>,
    /// How the fit ended.
    pub outcome: Outcome,
}

/// Which vertices carry the coefficients.
#[derive(Clone, Debug)]
pub enum Places {
    /// So many, chosen by the method.
    Chosen(usize),
    /// These.
    Given(Vec<u32>),
}

/// A fit by one method; the error is its text.
pub type Fit =
    fn(&TriangleMesh, VertexData<'_>, Places, &mut Observer<'_>) -> Result<Fitted, String>;

/// Returns every method with its name.
#[must_use]
pub fn methods() -> [(&'static str, Fit); 2] {
    [("biharmonic", biharmonic), ("ls-mesh", ls_mesh)]
}

fn biharmonic(
    mesh: &TriangleMesh,
    data: VertexData<'_>,
    places: Places,
    observer: &mut Observer<'_>,
) -> Result<Fitted, String> {
    use msplines_biharmonic::{KnotChoice, Options, fit};
    let knots = match places {
        Places::Chosen(count) => KnotChoice::Optimised { count },
        Places::Given(vertices) => KnotChoice::Given(vertices),
    };
    let options = Options {
        knots,
        ..Options::default()
    };
    let fitted = fit(mesh, data, &options, observer).map_err(|error| error.to_string())?;
    let values = fitted
        .spline
        .vertex_values()
        .map_err(|error| error.to_string())?;
    Ok(Fitted {
        spline: Box::new(fitted.spline),
        values,
        outcome: fitted.report.outcome,
    })
}

fn ls_mesh(
    mesh: &TriangleMesh,
    data: VertexData<'_>,
    places: Places,
    observer: &mut Observer<'_>,
) -> Result<Fitted, String> {
    use msplines_ls_mesh::{ControlChoice, Options, fit};
    let controls = match places {
        Places::Chosen(count) => ControlChoice::Selected { count },
        Places::Given(vertices) => ControlChoice::Given(vertices),
    };
    let options = Options {
        controls,
        ..Options::default()
    };
    let fitted = fit(mesh, data, &options, observer).map_err(|error| error.to_string())?;
    let values = fitted.spline.vertex_values().to_vec();
    Ok(Fitted {
        spline: Box::new(fitted.spline),
        values,
        outcome: fitted.report.outcome,
    })
}

/// Returns the positions of a mesh as vertex data of dimension 3.
#[must_use]
pub fn positions(mesh: &TriangleMesh) -> Vec<f64> {
    mesh.positions()
        .iter()
        .flat_map(|p| [p.x, p.y, p.z])
        .collect()
}

/// Returns `count` vertices spread evenly over the numbering.
#[must_use]
pub fn spread(mesh: &TriangleMesh, count: usize) -> Vec<u32> {
    (0..count)
        .map(|k| (k * mesh.vertex_count() / count) as u32)
        .collect()
}

/// Returns the mean distance between two lists of points.
#[must_use]
pub fn mean_distance(a: &[f64], b: &[f64]) -> f64 {
    let (a, _) = a.as_chunks::<3>();
    let (b, _) = b.as_chunks::<3>();
    let distances = a.iter().zip(b).map(|(a, b)| {
        a.iter()
            .zip(b)
            .map(|(a, b)| (a - b).powi(2))
            .sum::<f64>()
            .sqrt()
    });
    distances.sum::<f64>() / a.len() as f64
}

/// Returns the largest difference between two lists of numbers.
#[must_use]
pub fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}
