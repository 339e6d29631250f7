//! Trivariate splines, and their files as the harness writes them.

use std::f64::consts::{PI, TAU};
use std::fs::File;
use std::path::{Path, PathBuf};
use std::time::Instant;

use msplines_common::progress::unobserved;
use msplines_compare::record::InputKind;
use msplines_compare::run::{Evaluation, TSplineChanges, evaluate};
use msplines_compare::spline_file::{
    SplineFile, StoredCube, StoredDomain, StoredSpline, StoredTrivariate,
};
use msplines_trivariate::fit::least_squares;
use msplines_trivariate::{TrivariateSpline, VolumeSamples};
use nalgebra::Point3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Samples of the fitted solid.
const SAMPLES: usize = 4_000;

/// Returns generated solids that do not fold, with their names: made from maps, and fitted.
///
/// # Panics
/// Never: maps and samples are finite.
#[must_use]
pub fn solids() -> Vec<(String, TrivariateSpline)> {
    let of_map = |spans, map: fn([f64; 3]) -> Point3<f64>| {
        TrivariateSpline::from_map(spans, map).expect("finite control points")
    };
    vec![
        ("one span".to_owned(), of_map(1, sheared)),
        ("sheared cube".to_owned(), of_map(3, sheared)),
        ("bent bar".to_owned(), of_map(6, bent_bar)),
        ("coarse bent bar".to_owned(), of_map(2, bent_bar)),
        ("fitted bar".to_owned(), fitted()),
    ]
}

/// Returns [`solids`] and lattices of random points, which fold, at the origin and far from it.
///
/// # Panics
/// Never: the points fill the lattices.
#[must_use]
pub fn all() -> Vec<(String, TrivariateSpline)> {
    let mut splines = solids();
    for (spans, shift) in [(1, 0.0), (2, 0.0), (5, 100.0)] {
        let mut random = Pcg64Mcg::seed_from_u64(spans as u64);
        let points = (0..(spans + 3usize).pow(3)).map(|_| {
            let at: [f64; 3] = std::array::from_fn(|_| shift + random.random_range(-1.0..1.0));
            Point3::from(at)
        });
        let spline = TrivariateSpline::build(spans, points.collect()).expect("a full lattice");
        splines.push((format!("random points, {spans} spans"), spline));
    }
    splines
}

/// Returns random parameters, a third of them with a coordinate that is 0, 1 or between two spans.
#[must_use]
pub fn parameters(spans: usize, count: usize, seed: u64) -> Vec<[f64; 3]> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let parameter = |place: usize| {
        let mut at: [f64; 3] = std::array::from_fn(|_| random.random());
        if place.is_multiple_of(3) {
            at[place / 3 % 3] = random.random_range(0..=spans) as f64 / spans as f64;
        }
        at
    };
    (0..count).map(parameter).collect()
}

/// Writes a solid in the formats that these names ask for, with so many cells along the side of a span
/// where it is cut into hexahedra, and returns the paths.
///
/// # Panics
/// If the harness refuses one of them.
#[must_use]
pub fn write(
    spline: &TrivariateSpline,
    folder: &Path,
    names: &[&str],
    cells: usize,
) -> Vec<PathBuf> {
    let stored = StoredSpline::Trivariate(StoredTrivariate::of(spline));
    let cube = StoredCube {
        sha256: String::new(),
        kind: InputKind::Tets,
        vertices: 8,
        faces: 12,
        cells: 6,
    };
    let file = SplineFile::new(StoredDomain::Cube { cube }, serde_json::json!({}), stored);
    let path = folder.join("spline.json");
    let mut to = File::create(&path).expect("a folder that can be written");
    file.write(&mut to).expect("a file that can be written");
    let outputs: Vec<PathBuf> = names.iter().map(|name| folder.join(name)).collect();
    let evaluation = Evaluation {
        spline: path,
        mesh: None,
        shifts: Vec::new(),
        sum: None,
        subdivide: 0,
        cells: Some(cells),
        at: None,
        moved: Vec::new(),
        changes: Vec::new(),
        t_spline: TSplineChanges::default(),
        outputs: outputs.clone(),
        seed: 0,
    };
    // The start of the process only goes into the record, which nobody looks at.
    let written = evaluate(&evaluation, Instant::now(), &mut unobserved());
    written.unwrap_or_else(|error| panic!("{error}"));
    outputs
}

fn sheared(at: [f64; 3]) -> Point3<f64> {
    let x = at[0] + 0.1 * (TAU * at[1]).sin();
    let y = at[1] + 0.2 * x * x;
    Point3::new(x, y, at[2] + 0.3 * x * y)
}

/// A bar that is bent by half a turn.
fn bent_bar([u, v, w]: [f64; 3]) -> Point3<f64> {
    let (sin, cos) = (PI * w).sin_cos();
    Point3::new((1.0 + u) * cos, v - 0.5, (1.0 + u) * sin)
}

/// The bar by least squares, with what a fit leaves in the last digits.
fn fitted() -> TrivariateSpline {
    let parameters = parameters(1, SAMPLES, 5);
    let points = parameters.iter().map(|&at| bent_bar(at)).collect();
    let samples = VolumeSamples::build(parameters, points).expect("samples of a map");
    let options = least_squares::Options {
        finest: 4,
        ..Default::default()
    };
    let fit = least_squares::fit(&samples, &options, &mut unobserved());
    fit.expect("samples everywhere").spline
}

/// Returns the diagonal of the box of the control points.
#[must_use]
pub fn size(spline: &TrivariateSpline) -> f64 {
    let infinity = Point3::from([f64::INFINITY; 3]);
    let points = spline.points().iter();
    let (low, high) = points.fold((infinity, -infinity), |(low, high), p| {
        (low.inf(p), high.sup(p))
    });
    (high - low).norm()
}
