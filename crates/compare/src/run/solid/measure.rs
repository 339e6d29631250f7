//! What is measured of a solid and its spline, as flat values of a record.

use msplines_common::mesh::TriangleMesh;
use msplines_common::metrics::Distance;
use msplines_trivariate::TrivariateSpline;
use msplines_trivariate::domain::Domain;
use msplines_trivariate::fit::certified::creases;
use msplines_trivariate::measure::measure;
use msplines_trivariate::options::{Fitting, Solid};
use msplines_trivariate::solid::{Fitted, SolidFit};
use msplines_trivariate::validity::{self, BoundaryOptions, BoundaryVerdict, Certificate, certify};
use serde_json::json;

use super::boundary::{CubeSurface, positions};
use crate::error::RunError;
use crate::measure::{Tessellated, settled_distance};
use crate::record::{Checks, Record, named};
use crate::run::steps;

/// The distance is measured to a tessellation of at most so many squares along an edge of the cube.
const MOST_SQUARES: usize = 256;

/// How often spans are halved of solids that were not fitted to be proved.
const DEPTH: u32 = 2;
/// How often pieces of the boundary of a solid are halved that may fold.
const OBVIOUS: u32 = 5;
/// How many pairs of them are looked at then.
const OBVIOUS_PAIRS: usize = 300_000;

/// Returns how a spline is certified: as its fit was, where that was.
pub(super) fn certificate_options(options: &Solid) -> validity::Options {
    match &options.fitting {
        Fitting::Certified(certified) => certified.certificate,
        _ => validity::Options { depth: DEPTH },
    }
}

/// How the boundary of a solid is looked at: as well as it can be where the solid is proved not to fold, and
/// only for obvious contacts where it is not.
fn boundary_options(certificate: &Certificate) -> BoundaryOptions {
    if certificate.holds() {
        return BoundaryOptions::default();
    }
    BoundaryOptions {
        depth: OBVIOUS,
        contact_depth: OBVIOUS,
        most_pairs: OBVIOUS_PAIRS,
    }
}

/// Returns what is known about folds of a spline, and what to warn of.
pub(super) fn folds(
    spline: &TrivariateSpline,
    options: &validity::Options,
) -> (Certificate, Checks, Vec<String>) {
    let certificate = certify(spline, options);
    let boundary = validity::boundary(spline, &boundary_options(&certificate));
    let is_injective = boundary.verdict == BoundaryVerdict::Injective;
    let bound = certificate.bound.is_finite().then_some(certificate.bound);
    let checks = named([
        ("spans", json!(certificate.spans)),
        ("spans_certified", json!(certificate.certified)),
        ("spans_refuted", json!(certificate.refuted.len())),
        ("certified", json!(certificate.holds())),
        ("min_det_jacobian_bound", json!(bound)),
        ("volume", json!(certificate.volume)),
        (
            "boundary_self_intersections",
            json!(boundary.contacts.len()),
        ),
        ("boundary_injective", json!(is_injective)),
    ]);
    let mut warnings = Vec::new();
    if !certificate.holds() {
        let open = certificate.spans - certificate.certified;
        warnings.push(format!(
            "the solid may fold: in {open} of {} spans its determinant is not proved positive",
            certificate.spans
        ));
    }
    if !is_injective {
        warnings.push(format!(
            "the boundary is not proved to be free of contacts with itself; {} were found",
            boundary.contacts.len()
        ));
    }
    (certificate, checks, warnings)
}

/// Returns the quality of samplings of `cells` cells in each direction as finite elements.
pub(super) fn elements(spline: &TrivariateSpline, samplings: &[usize]) -> Checks {
    let mut checks = Checks::new();
    for &cells in samplings {
        let found = measure(spline, cells);
        let values = [
            ("degenerate", json!(found.degenerate)),
            ("volume_distortion", json!(found.distortion_mean)),
            ("volume_distortion_sum", json!(found.distortion_sum)),
            ("stretch_linf", json!(found.stretch)),
        ];
        checks.extend(values.map(|(name, value)| (format!("{name}_{cells}"), value)));
    }
    checks
}

/// Returns how far the stored spline is from the solid, and how the map to the cube came about.
pub(super) fn fit(fit: &SolidFit, stored: &TrivariateSpline) -> Checks {
    let domain = &fit.domain;
    let deviation = if fit.fitted.spline() == stored {
        fit.deviation
    } else {
        domain.deviation(stored)
    };
    let (map, creases) = (&domain.map().report, creases(stored));
    let mut checks = named([
        ("surface_rms", json!(deviation.surface_rms)),
        ("surface_max", json!(deviation.surface_max)),
        ("interior_rms", json!(deviation.interior_rms)),
        ("interior_max", json!(deviation.interior_max)),
        ("tets", json!(domain.map().mesh.cell_count())),
        ("tet_vertices", json!(domain.map().mesh.vertex_count())),
        ("flipped_tets", json!(map.quality.flipped)),
        ("boundary_folded", json!(map.folded)),
        ("map_distortion", json!(map.quality.distortion)),
        (
            "map_least_determinant",
            json!(map.quality.smallest_determinant),
        ),
        ("harmonic_flips", json!(map.harmonic.flipped)),
        ("harmonic_distortion", json!(map.harmonic.distortion)),
        ("ways_tried", json!(map.trials)),
        ("crease_least", json!(creases.least)),
        ("crease_mean", json!(creases.mean)),
        ("crease_greatest", json!(creases.greatest)),
    ]);
    let corners = domain.map().corners.iter().enumerate();
    checks.extend(corners.map(|(c, &vertex)| (format!("corner_{c}"), json!(vertex))));
    if let Some(last) = domain.filled().and_then(|report| report.attempts.last()) {
        checks.extend(named([
            ("mesher_spacing", json!(last.spacing)),
            ("mesher_farthest", json!(last.farthest)),
            ("mesher_least_angle", json!(last.smallest_angle)),
        ]));
    }
    checks.extend(of_fitted(&fit.fitted, domain));
    checks
}

fn of_fitted(fitted: &Fitted, domain: &Domain) -> Checks {
    match fitted {
        Fitted::Multilevel(fit) => named([("levels", json!(fit.levels.len()))]),
        Fitted::LeastSquares(fit) => {
            let iterations: u32 = fit.levels.iter().map(|level| level.iterations).sum();
            named([
                ("levels", json!(fit.levels.len())),
                ("iterations", json!(iterations)),
            ])
        }
        Fitted::Certified(fit) => {
            let start = domain.deviation(&fit.start);
            named([
                ("levels", json!(fit.report.levels.len())),
                ("rounds", json!(fit.report.rounds)),
                ("evaluations", json!(fit.report.evaluations)),
                ("local_evaluations", json!(fit.report.local_evaluations)),
                ("spans_certified_before", json!(fit.report.certified_before)),
                ("surface_rms_uncertified", json!(start.surface_rms)),
                ("interior_rms_uncertified", json!(start.interior_rms)),
            ])
        }
    }
}

/// Fills in the errors at the vertices of the surface, at their own parameters.
pub(super) fn vertex_errors(
    record: &mut Record,
    spline: &TrivariateSpline,
    parameters: &[[f64; 3]],
    surface: &TriangleMesh,
) {
    let found = positions(spline, parameters);
    steps::errors(record, [&found, surface.positions()], surface);
    if let Some(error) = &mut record.error {
        "samples".clone_into(&mut error.kind);
    }
}

/// Returns the two-sided distance between the surface and the boundary of the spline.
pub(super) fn surface_distance(
    spline: &TrivariateSpline,
    surface: &TriangleMesh,
    seed: u64,
) -> Result<Distance, RunError> {
    settled_distance(surface, seed, |rounds| {
        let squares = (4 * spline.spans()) << rounds;
        Ok(Tessellated {
            mesh: CubeSurface::new(squares).of(spline)?,
            is_finest: 2 * squares > MOST_SQUARES,
        })
    })
}
