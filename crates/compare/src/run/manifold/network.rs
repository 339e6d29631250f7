//! Runs of surfaces over curve networks.

use std::f64::consts::TAU;

use msplines_common::Vector3;
use msplines_common::mesh::curves::CurveNetwork;
use msplines_common::mesh::polygon::Rules;
use msplines_common::mesh::{TriangleMesh, VertexAttribute};
use msplines_common::progress::Observer;
use msplines_io::{read_curves, sha256_file};
use msplines_sparse_manifold::network::{NetworkDomain, NetworkFit, surface_network};
use msplines_sparse_manifold::{LimitSurface, SparseManifold, Tessellation, Tessellator};
use serde_json::json;
use sha2::{Digest, Sha256};

use super::fields::edge_lines;
use super::{Companion, check, facts, triangles, write};
use crate::case::{Case, CurveNetworkMethod, Input};
use crate::clock::PhaseClock;
use crate::error::RunError;
use crate::fit::following;
use crate::input::{hexadecimal, input_name, unreadable};
use crate::record::{Checks, InputFacts, InputKind, Record, named};
use crate::run::{RunOutput, enter, steps};
use crate::spline_file::{SplineFile, StoredDomain, StoredManifold, StoredPolygons, StoredSpline};

/// Curves are drawn as bars of this radius, as a fraction of the diagonal.
const BAR: f64 = 2.5e-3;

/// Points of the surface are compared with the true one on so many cells along each side of a face.
const COMPARED_CELLS: u32 = 8;

/// A network with where it comes from.
struct Loaded {
    network: CurveNetwork,
    name: String,
    sha256: String,
    /// The surface that its curves lie on, where that is known.
    truth: Option<LimitSurface>,
}

/// Runs a case whose method is a surface over a curve network.
pub(in crate::run) fn run(
    case: &Case,
    method: &CurveNetworkMethod,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<RunOutput, RunError> {
    check(case)?;
    clock.enter("read");
    let loaded = load(case)?;
    enter("domain", clock, observer);
    let fit = {
        let mut timed = following(&["fit"], clock, observer);
        surface_network(&loaded.network, &method.options, &mut timed)?
    };
    let mesh = fit.spline.mesh();
    let mut options = json!(method.options);
    options["cells"] = json!(method.cells);
    let domain = StoredDomain::Polygons {
        polygons: StoredPolygons::of(mesh),
    };
    let stored = StoredSpline::SparseManifold(StoredManifold::of(&fit.spline));
    let spline = SplineFile::new(domain, options, stored);
    let restored = spline.spline.manifold("evaluation")?.restore(mesh)?;
    enter("evaluate", clock, observer);
    let cells = method.cells.max(1);
    let surface = Tessellator::build(&restored, cells).surface(&restored);
    let tessellated = triangles(&surface)?;
    enter("measure", clock, observer);
    let facts = facts(mesh, loaded.name.clone(), loaded.sha256.clone());
    let mut record = record(case, &fit, &spline, facts);
    record.checks.extend(shape_checks(&loaded, &fit, &restored));
    let fields = fields(&restored, &fit.domain, &surface)?;
    enter("write", clock, observer);
    write(&case.outputs, &spline, &tessellated, &fields)?;
    steps::finish(&mut record, clock);
    Ok(RunOutput {
        companions: companions(&loaded, &fit.domain, cells),
        fields,
        ..RunOutput::of_surface(record, Some(spline), tessellated)
    })
}

/// Returns how far the surface is from the one that its curves lie on.
fn shape_checks(loaded: &Loaded, fit: &NetworkFit, surface: &SparseManifold) -> Checks {
    let Some(truth) = &loaded.truth else {
        return Checks::new();
    };
    let error = truth.error(surface, COMPARED_CELLS);
    let unit = fit.report.unit;
    named([
        ("surface_rms", json!(error.rms / unit)),
        ("surface_max", json!(error.max / unit)),
        ("normals_mean_degrees", json!(error.normals_degrees)),
    ])
}

fn load(case: &Case) -> Result<Loaded, RunError> {
    let name = input_name(&case.input);
    let refused = |reason: String| RunError::Input {
        file: name.clone(),
        reason,
    };
    match &case.input {
        Input::File { path, .. } => {
            let sha256 = sha256_file(path).map_err(|e| refused(unreadable(&e)))?;
            let network = read_curves(path).map_err(|e| refused(e.to_string()))?;
            Ok(Loaded {
                network,
                name,
                sha256,
                truth: None,
            })
        }
        Input::Network(shape) => {
            let truth = shape.limit_of().and_then(|(mesh, sharpness)| {
                LimitSurface::build(&mesh, &sharpness, Rules::default())
            });
            let sha256 = hexadecimal(&Sha256::digest(name.as_bytes()));
            Ok(Loaded {
                network: shape.network(case.seed),
                name,
                sha256,
                truth,
            })
        }
        Input::Surface(_) | Input::Control(_) | Input::Chart(_) | Input::Solid(_) => {
            Err(refused("this is no curve network".to_owned()))
        }
    }
}

/// Returns curvatures, and the cycle around every point.
fn fields(
    spline: &SparseManifold,
    domain: &NetworkDomain,
    surface: &Tessellation,
) -> Result<Vec<VertexAttribute>, RunError> {
    let geometry = spline.geometry(&surface.places)?;
    let cycle = |face: u32| f64::from(domain.cycles[face as usize]);
    let column = |name: &str, values: Vec<f64>| VertexAttribute {
        name: name.to_owned(),
        values,
    };
    Ok(vec![
        column(
            "mean_curvature",
            geometry.iter().map(|g| g.mean_curvature).collect(),
        ),
        column(
            "gaussian_curvature",
            geometry.iter().map(|g| g.gaussian_curvature).collect(),
        ),
        column(
            "patch",
            surface.places.iter().map(|p| cycle(p.face)).collect(),
        ),
    ])
}

/// Returns the curves, and the surface that they lie on where it is known.
fn companions(loaded: &Loaded, domain: &NetworkDomain, cells: u32) -> Vec<Companion> {
    let is_crease = |edge: u32| domain.curves[edge as usize].is_some_and(|curve| curve.crease);
    let [edges, creases] = edge_lines(domain.mesh.topology(), is_crease, cells);
    let mut companions = vec![Companion {
        name: "spline",
        mesh: None,
        edges,
        creases,
        fields: Vec::new(),
    }];
    companions.extend(bars(&loaded.network));
    if let Some(truth) = &loaded.truth {
        companions.push(Companion {
            name: "target",
            mesh: Some(truth.mesh().clone()),
            edges: Vec::new(),
            creases: Vec::new(),
            fields: Vec::new(),
        });
    }
    companions
}

/// Returns the segments of all curves as thin bars, those of creases with red lines along them.
fn bars(network: &CurveNetwork) -> Option<Companion> {
    let radius = BAR * network.diagonal();
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    let mut creases = Vec::new();
    for curve in network.curves() {
        for (ends, &is_crease) in curve.points.windows(2).zip(&curve.creases) {
            let [a, b] = [ends[0], ends[1]].map(|p| network.points()[p as usize]);
            let along = b - a;
            let axis = along.map(f64::abs).imin();
            let side = along.cross(&Vector3::ith(axis, 1.0)).normalize() * radius;
            let up = along.cross(&side).normalize() * radius;
            let first = positions.len() as u32;
            for end in [a, b] {
                positions.extend([0.0, 1.0, 2.0].map(|corner| {
                    let (sin, cos) = f64::sin_cos(corner * TAU / 3.0);
                    end + side * cos + up * sin
                }));
            }
            let corner = |end: u32, i: u32| first + 3 * end + i % 3;
            for i in 0..3 {
                let [p, q] = [corner(0, i), corner(0, i + 1)];
                let [r, s] = [corner(1, i + 1), corner(1, i)];
                triangles.extend([[p, q, r], [p, r, s]]);
                if is_crease {
                    creases.push([p, s]);
                }
            }
            triangles.push([corner(0, 2), corner(0, 1), corner(0, 0)]);
            triangles.push([corner(1, 0), corner(1, 1), corner(1, 2)]);
        }
    }
    Some(Companion {
        name: "control",
        mesh: Some(TriangleMesh::build(positions, triangles).ok()?),
        edges: Vec::new(),
        creases,
        fields: Vec::new(),
    })
}

fn record(case: &Case, fit: &NetworkFit, spline: &SplineFile, facts: InputFacts) -> Record {
    let mut warnings = fit.cycles.report.warnings.clone();
    warnings.extend(fit.report.warnings.iter().cloned());
    let input = InputFacts {
        kind: InputKind::Curves,
        ..facts
    };
    Record {
        outcome: fit.report.outcome,
        dofs: fit.spline.coefficient_count() as u64,
        domain_bytes: steps::polygon_bytes(fit.spline.mesh()),
        checks: checks(fit),
        warnings,
        ..Record::start(case.method.name(), input, spline.options.clone(), case.seed)
    }
}

/// Distances in mean arc lengths, angles in degrees.
fn checks(fit: &NetworkFit) -> Checks {
    let (report, cycles) = (&fit.report, &fit.cycles.report);
    named([
        ("charts", json!(report.charts)),
        ("patches", json!(cycles.patches)),
        ("openings", json!(cycles.holes)),
        (
            "euler_characteristic",
            json!(cycles.euler.iter().sum::<i64>()),
        ),
        ("curve_rms", json!(report.curve_rms)),
        ("curve_max", json!(report.curve_max)),
        ("kink_mean_degrees", json!(report.kink_mean_degrees)),
        ("kink_max_degrees", json!(report.kink_max_degrees)),
        ("turn_mean_degrees", json!(report.turn_mean_degrees)),
        ("turn_max_degrees", json!(report.turn_max_degrees)),
        (
            "facet_turn_max_degrees",
            json!(report.facet_turn_max_degrees),
        ),
        ("sharp_facets", json!(report.sharp_facets)),
        ("cone_points", json!(report.cone_points.len())),
        ("c0_atoms_crease", json!(report.c0_atoms_crease)),
        ("c0_atoms_smooth", json!(report.c0_atoms_smooth)),
        ("fill_rounds", json!(report.fill_rounds)),
    ])
}
