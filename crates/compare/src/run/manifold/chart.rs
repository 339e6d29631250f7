//! Runs of functions of single charts.

use msplines_common::Point3;
use msplines_common::mesh::polygon::PolygonMesh;
use msplines_common::mesh::{TriangleMesh, VertexAttribute};
use msplines_common::metrics::{VertexError, vertex_error};
use msplines_common::progress::Observer;
use msplines_sparse_manifold::{ChartPoint, Local, LocalFunction, Star, fit_local};
use serde_json::json;
use sha2::{Digest, Sha256};

use super::{Companion, check};
use crate::case::{Case, ChartMethod, Input};
use crate::clock::PhaseClock;
use crate::error::RunError;
use crate::generated::{ChartFunction, Height, Sampled, grid};
use crate::input::hexadecimal;
use crate::output::write_outputs;
use crate::record::{Checks, InputFacts, InputKind, Record, named};
use crate::run::{RunOutput, check_finite, enter, steps};
use crate::spline_file::{SplineFile, StoredDomain, StoredLocal, StoredPolygons, StoredSpline};

/// Atoms that are shown one by one.
const SHOWN_ATOMS: usize = 5;

/// A polynomial is recovered if no coefficient is off by more than this fraction of its least one.
const RECOVERED: f64 = 1e-6;

/// Runs a case whose method is the function of a single chart.
pub(in crate::run) fn run(
    case: &Case,
    method: &ChartMethod,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<RunOutput, RunError> {
    check(case)?;
    let Input::Chart(chart) = &case.input else {
        return Err(RunError::Task {
            task: "fit of a surface; it takes functions such as chart-5+roof+samples-100",
            method: case.method.name(),
        });
    };
    let refused = |reason: String| RunError::Input {
        file: chart.to_string(),
        reason,
    };
    enter("fit", clock, observer);
    let searched = search(chart, method.local, case.seed).map_err(refused)?;
    let Searched {
        sampled,
        found,
        recovered,
    } = searched;
    let domain = star_mesh(chart.star(), method.cells).map_err(refused)?;
    let stored = StoredLocal::of(&found);
    let function = stored.restore()?;
    enter("evaluate", clock, observer);
    let dense = Dense::of(&function, &sampled.function, &domain.points);
    check_finite(&dense.found, 1)?;
    let error = dense.error().map_err(refused)?;
    let spline = stored_file(case, method, &domain, stored);
    let mut checks = checks(&sampled, &function);
    checks.extend(named([
        ("recovered", json!(recovered)),
        ("trials", json!(chart.trials())),
        ("function_rms", json!(error.rms)),
        ("function_max", json!(error.max)),
    ]));
    let mesh = domain.raised(&dense.found);
    let (values, fields) = (dense.found, dense.fields);
    let names = vec!["height".to_owned()];
    enter("write", clock, observer);
    write_outputs(&case.outputs, &spline, &mesh, &values, &names, &fields)?;
    let mut record = Record {
        error: Some(error),
        dofs: function.support().len() as u64,
        checks,
        ..record(case, chart, &spline)
    };
    steps::finish(&mut record, clock);
    Ok(RunOutput {
        companions: domain.companions(&dense.truth),
        fields,
        knots: sampled.places(chart.star()),
        ..RunOutput::new(record, Some(spline), mesh, values, names)
    })
}

fn stored_file(
    case: &Case,
    method: &ChartMethod,
    domain: &StarMesh,
    stored: StoredLocal,
) -> SplineFile {
    let mut options = json!(method);
    options["seed"] = json!(case.seed);
    let polygons = StoredPolygons::of(&domain.polygons);
    let domain = StoredDomain::Polygons { polygons };
    SplineFile::new(domain, options, StoredSpline::Chart(stored))
}

/// What all trials gave.
struct Searched {
    /// What the last one was about.
    sampled: Sampled,
    /// What it found.
    found: LocalFunction,
    /// In how many of them the polynomial was found again.
    recovered: u32,
}

fn search(chart: &ChartFunction, local: Local, seed: u64) -> Result<Searched, String> {
    let mut recovered = 0;
    let mut last = None;
    for trial in 0..chart.trials() {
        let sampled = chart.sampled(seed, trial);
        let found = fit_local(chart.star(), &sampled.points, &sampled.values, local);
        let found = found.map_err(|e| e.to_string())?;
        let (atoms, coefficients) = (found.atoms(), found.coefficients());
        let exact = (sampled.function).is_recovered(&atoms, coefficients, RECOVERED);
        recovered += u32::from(exact);
        last = Some((sampled, found));
    }
    let (sampled, found) = last.ok_or("no trials")?;
    Ok(Searched {
        sampled,
        found,
        recovered,
    })
}

fn checks(sampled: &Sampled, function: &LocalFunction) -> Checks {
    let (points, values) = (&sampled.points, &sampled.values);
    let residual = |(p, v): (&ChartPoint, &f64)| (function.value(*p) - v).powi(2);
    let squares: f64 = points.iter().zip(values).map(residual).sum();
    let shapes = function.atoms().iter().filter(|a| a.is_shape()).count();
    named([
        ("samples", json!(points.len())),
        ("sample_rms", json!((squares / points.len() as f64).sqrt())),
        ("atoms", json!(function.support().len())),
        ("c0_atoms", json!(shapes)),
    ])
}

fn record(case: &Case, chart: &ChartFunction, spline: &SplineFile) -> Record {
    let sha256 = hexadecimal(&Sha256::digest(chart.to_string().as_bytes()));
    let valence = u64::from(chart.star().valence);
    let input = InputFacts {
        file: chart.to_string(),
        sha256,
        kind: InputKind::Polygons,
        vertices: 2 * valence + 1,
        faces: valence,
        cells: 0,
        genus: Some(0),
        boundary_loops: 1,
    };
    Record {
        domain_bytes: 4,
        ..steps::record(spline, &input, case.seed)
    }
}

/// A chart cut into triangles.
struct StarMesh {
    /// The sectors as quads in the plane.
    polygons: PolygonMesh,
    points: Vec<ChartPoint>,
    flat: TriangleMesh,
    /// Pieces of the edges of the star.
    spokes: Vec<[u32; 2]>,
}

fn star_mesh(star: Star, cells: u32) -> Result<StarMesh, String> {
    let cells = cells.max(1);
    let k = star.valence;
    let points = grid(k, cells);
    // The centre, then for each sector columns of `cells + 1` points; its last edge is the first one
    // of the next sector.
    let at = |sector: u32, i: u32, j: u32| match (i, j) {
        (0, 0) => 0,
        (0, j) => 1 + ((sector + 1) % k) * cells * (cells + 1) + (j - 1) * (cells + 1),
        (i, j) => 1 + sector * cells * (cells + 1) + (i - 1) * (cells + 1) + j,
    };
    let (mut triangles, mut spokes) = (Vec::new(), Vec::new());
    for sector in 0..k {
        for i in 0..cells {
            spokes.push([at(sector, i, 0), at(sector, i + 1, 0)]);
            for j in 0..cells {
                let [a, b] = [at(sector, i, j), at(sector, i + 1, j)];
                let [c, d] = [at(sector, i + 1, j + 1), at(sector, i, j + 1)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    let place = |p: &ChartPoint| {
        let [x, y] = star.position(p.sector, p.at);
        Point3::new(x, y, 0.0)
    };
    let flat = TriangleMesh::build(points.iter().map(place).collect(), triangles);
    let corners = |sector: u32| {
        [
            0,
            at(sector, cells, 0),
            at(sector, cells, cells),
            at(sector, 0, cells),
        ]
    };
    let flat = flat.map_err(|e| e.to_string())?;
    let quads: Vec<u32> = (0..k).flat_map(corners).collect();
    let mut used = quads.clone();
    used.sort_unstable();
    used.dedup();
    let number = |v: &u32| used.partition_point(|u| u < v) as u32;
    let positions = used.iter().map(|&v| flat.positions()[v as usize]).collect();
    let offsets = (0..=k).map(|face| 4 * face).collect();
    let polygons = PolygonMesh::build(positions, quads.iter().map(number).collect(), offsets);
    Ok(StarMesh {
        polygons: polygons.map_err(|e| e.to_string())?,
        points,
        flat,
        spokes,
    })
}

impl StarMesh {
    fn raised(&self, heights: &[f64]) -> TriangleMesh {
        let pairs = self.flat.positions().iter().zip(heights);
        let raise = |(p, &z): (&Point3<f64>, &f64)| Point3::new(p.x, p.y, z);
        self.flat.with_positions(pairs.map(raise).collect())
    }

    fn companions(&self, truth: &[f64]) -> Vec<Companion> {
        let lines = |name, mesh| Companion {
            name,
            mesh,
            edges: self.spokes.clone(),
            creases: Vec::new(),
            fields: Vec::new(),
        };
        vec![
            lines("spline", None),
            lines("control", Some(self.raised(truth))),
        ]
    }
}

/// The function on a grid, beside what it should be.
struct Dense {
    found: Vec<f64>,
    truth: Vec<f64>,
    fields: Vec<VertexAttribute>,
}

impl Dense {
    /// Returns how far the function is from what it should be.
    fn error(&self) -> Result<VertexError, String> {
        let error = vertex_error(&self.found, &self.truth, 1, 1.0).map_err(|e| e.to_string())?;
        Ok(VertexError {
            kind: "function".to_owned(),
            ..error
        })
    }

    fn of(function: &LocalFunction, height: &Height, points: &[ChartPoint]) -> Self {
        let atoms: Vec<Vec<f64>> = points.iter().map(|&p| function.atom_values(p)).collect();
        let sum = |values: &Vec<f64>| -> f64 {
            let terms = values.iter().zip(function.coefficients());
            terms.map(|(value, coefficient)| value * coefficient).sum()
        };
        let found: Vec<f64> = atoms.iter().map(sum).collect();
        let truth: Vec<f64> = points.iter().map(|&p| height.at(p)).collect();
        let apart = found.iter().zip(&truth).map(|(a, b)| a - b);
        let mut fields = vec![VertexAttribute {
            name: "error".to_owned(),
            values: apart.collect(),
        }];
        for atom in 0..function.support().len().min(SHOWN_ATOMS) {
            fields.push(VertexAttribute {
                name: format!("atom_{}", atom + 1),
                values: atoms.iter().map(|values| values[atom]).collect(),
            });
        }
        Self {
            found,
            truth,
            fields,
        }
    }
}
