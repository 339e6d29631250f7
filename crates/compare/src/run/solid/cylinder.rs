//! Solids over a cylinder: the baseline of the comparison.

use msplines_common::Point3;
use msplines_common::mesh::TriangleMesh;
use msplines_common::metrics::distance;
use msplines_common::progress::Observer;
use msplines_picture::edges;
use msplines_trivariate::TrivariateSpline;
use msplines_trivariate::cylinder::{
    self, Approximation, CylinderFit, CylinderMap, Options, degenerate_places,
};
use msplines_trivariate::options::Fitting;
use msplines_trivariate::validity::certify;
use serde_json::json;

use super::write::Written;
use super::{measure, pictures, record, squares, write};
use crate::case::{Case, TrivariateMethod};
use crate::clock::PhaseClock;
use crate::error::RunError;
use crate::fit::following;
use crate::input::solid::LoadedSolid;
use crate::record::{Checks, named};
use crate::run::{Companion, RunOutput, enter, steps};
use crate::spline_file::{SplineFile, StoredCube, StoredDomain, StoredSpline, StoredTrivariate};

/// Layers of cells at the poles and around the axis that count as lying there.
const LAYERS: usize = 1;
/// Points drawn from each surface when their distance is measured.
const SAMPLES: usize = 100_000;
/// Squares along a side of the surface by which that is done.
const SQUARES: usize = 256;

/// Runs a case whose solid is mapped to a cylinder.
pub(super) fn run(
    case: &Case,
    method: &TrivariateMethod,
    input: &LoadedSolid,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<RunOutput, RunError> {
    enter("domain", clock, observer);
    let surface = input.given.surface();
    let asked = options(method);
    let (map, fit) = fitted(&surface, &asked, clock, observer)?;
    let mut options = json!(asked);
    options["map"] = json!(method.map);
    options["validate_at"] = json!(method.validate_at);
    options["cells"] = json!(method.cells);
    options["seed"] = json!(case.seed);
    let cube = StoredCube::of(&input.facts);
    let stored = StoredSpline::Trivariate(StoredTrivariate::of(&fit.spline));
    let file = SplineFile::new(StoredDomain::Cube { cube }, options, stored);
    let stored = file.spline.trivariate("evaluation")?.restore()?;
    enter("evaluate", clock, observer);
    let mesh = outside(&stored, squares(&stored, method.cells))?;
    enter("measure", clock, observer);
    let mut record = record(case.seed, &input.facts, &file, &stored);
    record.outcome = fit.outcome;
    record.checks = measure::elements(&stored, &method.validate_at);
    let mean = checks(&mut record.checks, &map, &fit, method);
    if case.measure_distance {
        let fine = outside(&stored, SQUARES)?;
        record.distance = Some(distance(&surface, &fine, SAMPLES, case.seed)?);
    }
    let mut companions = vec![
        lines(&mesh, squares(&stored, method.cells), stored.spans()),
        Companion {
            name: "input",
            edges: edges(surface.faces()),
            mesh: Some(surface),
            creases: Vec::new(),
            fields: Vec::new(),
        },
    ];
    companions.extend(pictures::cut_open(&stored, method.cut, mean));
    enter("write", clock, observer);
    let written = Written {
        file: &file,
        spline: &stored,
        cells: method.cells,
        boundary: &mesh,
        fields: &[],
    };
    write::write(&case.outputs, &written)?;
    record.warnings.clone_from(&input.warnings);
    record.check("evaluated_points", mesh.vertex_count());
    steps::finish(&mut record, clock);
    Ok(RunOutput {
        companions,
        ..RunOutput::of_surface(record, Some(file), mesh)
    })
}

fn fitted(
    surface: &TriangleMesh,
    options: &Options,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<(CylinderMap, CylinderFit), RunError> {
    let mut timed = following(&["domain", "fit"], clock, observer);
    let map = cylinder::map(surface, options, &mut timed)?;
    let fit = cylinder::fit(&map, options, &mut timed)?;
    Ok((map, fit))
}

/// The options of a cylinder that is fitted as the method says.
fn options(method: &TrivariateMethod) -> Options {
    match &method.options.fitting {
        Fitting::Multilevel(multilevel) => Options {
            approximation: Approximation::Multilevel(*multilevel),
            ..Options::PAPER
        },
        Fitting::LeastSquares(options) => least_squares(options.finest),
        Fitting::Certified(options) => least_squares(options.least_squares.finest),
    }
}

fn least_squares(spans: usize) -> Options {
    let base = Options::default();
    let approximation = match base.approximation {
        Approximation::LeastSquares { smoothing, .. } => {
            Approximation::LeastSquares { spans, smoothing }
        }
        other => other,
    };
    Options {
        approximation,
        ..base
    }
}

/// Adds what is known about the solid, and returns its mean determinant.
fn checks(
    checks: &mut Checks,
    map: &CylinderMap,
    fit: &CylinderFit,
    method: &TrivariateMethod,
) -> f64 {
    let certificate = certify(&fit.spline, &measure::certificate_options(&method.options));
    checks.extend(named([
        ("spans", json!(certificate.spans)),
        ("spans_certified", json!(certificate.certified)),
        ("volume", json!(certificate.volume)),
        ("surface_rms", json!(fit.surface.rms)),
        ("surface_max", json!(fit.surface.max)),
        ("pole_0", json!(map.poles[0])),
        ("pole_1", json!(map.poles[1])),
    ]));
    for &cells in &method.validate_at {
        let places = degenerate_places(&fit.spline, cells, LAYERS);
        let values = [
            ("degenerate_poles", places.poles),
            ("degenerate_axis", places.axis),
            ("degenerate_elsewhere", places.elsewhere),
        ];
        checks.extend(values.map(|(name, count)| (format!("{name}_{cells}"), json!(count))));
    }
    certificate.volume
}

/// The surface at the largest radius, cut open along its seam, in squares of two triangles.
fn outside(spline: &TrivariateSpline, squares: usize) -> Result<TriangleMesh, RunError> {
    let side = squares + 1;
    let at = |i: usize| i as f64 / squares as f64;
    let positions: Vec<Point3<f64>> = (0..side * side)
        .map(|v| spline.position([at(v % side), at(v / side), 1.0]))
        .collect();
    let mut faces = Vec::with_capacity(2 * squares * squares);
    for square in 0..squares * squares {
        let corner = square % squares + side * (square / squares);
        let [a, b, c, d] = [0, 1, side + 1, side].map(|step| (corner + step) as u32);
        faces.extend([[a, b, c], [a, c, d]]);
    }
    steps::tessellation(positions, faces)
}

/// Lines of constant longitude and latitude, at the ends of spans.
fn lines(mesh: &TriangleMesh, squares: usize, spans: usize) -> Companion {
    let (side, step) = (squares + 1, (squares / spans).max(1));
    debug_assert_eq!(mesh.vertex_count(), side * side);
    let mut edges = Vec::new();
    for at in (0..side).step_by(step) {
        for along in 0..squares {
            edges.push([at * side + along, at * side + along + 1]);
            edges.push([along * side + at, (along + 1) * side + at]);
        }
    }
    Companion {
        name: "spline",
        mesh: None,
        edges: edges.iter().map(|ends| ends.map(|v| v as u32)).collect(),
        creases: Vec::new(),
        fields: Vec::new(),
    }
}
