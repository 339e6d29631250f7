//! Laws of the project's own files: splines, records, experiments, models.

use msplines_common::mesh::TriangleMesh;
use msplines_compare::atlas_file::AtlasFile;
use msplines_compare::case::Case;
use msplines_compare::experiment::Experiment;
use msplines_compare::models::Manifest;
use msplines_compare::record::Record;
use msplines_compare::row_process::{RowProgress, RowRequest};
use msplines_compare::spline_file::{SplineFile, StoredDomain, StoredSpline};
use msplines_compare::store::EndedRow;
use msplines_powell_sabin::PowellSabinSurface;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::memory::within;

/// Meshes of more vertices are read but not evaluated, to keep executions fast.
const MOST_VERTICES: usize = 300;

/// A value of JSON takes 32 bytes and may be told in two, `1,`; it is held twice while its kind is found
/// out, and growing arrays are twice as large as their content.
const BYTES_PER_BYTE: usize = 128;

/// Messages, and tables of fixed size.
const SLACK: usize = 1 << 18;

/// What a spline over a mesh of so few vertices may take, its matrices included.
const MOST_BYTES: usize = 256 << 20;

fn most(bytes: &[u8]) -> usize {
    BYTES_PER_BYTE * bytes.len() + SLACK
}

/// Holds spline files to their laws: what was read is written and read again alike, and what it holds
/// becomes a spline or is refused.
pub fn spline(bytes: &[u8]) {
    let read = within(most(bytes), || SplineFile::parse(bytes));
    let file = match read {
        Ok(file) => file,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    let mut written = Vec::new();
    if let Err(error) = file.write(&mut written) {
        panic!("memory takes all bytes: {error}");
    }
    match SplineFile::parse(&written) {
        Ok(again) => assert_eq!(again, file),
        Err(error) => panic!("what was written: {error}"),
    }
    within(MOST_BYTES, || restore(&file));
}

/// Makes a spline of what a file holds; a refusal has a text.
fn restore(file: &SplineFile) {
    let refusal = match &file.domain {
        StoredDomain::Embedded { mesh } if mesh.positions.len() <= MOST_VERTICES => {
            match mesh.restore() {
                Ok(mesh) => on_triangles(&file.spline, &mesh),
                Err(error) => Some(error.to_string()),
            }
        }
        StoredDomain::Polygons { polygons } if polygons.positions.len() <= MOST_VERTICES => {
            match (polygons.restore(), &file.spline) {
                (Ok(mesh), StoredSpline::SparseManifold(stored)) => {
                    stored.restore(&mesh).err().map(|e| e.to_string())
                }
                (Err(error), _) => Some(error.to_string()),
                _ => None,
            }
        }
        _ => match &file.spline {
            StoredSpline::Trivariate(stored) => stored.restore().err().map(|e| e.to_string()),
            StoredSpline::Chart(stored) => stored.restore().err().map(|e| e.to_string()),
            _ => None,
        },
    };
    assert_ne!(refusal.as_deref(), Some(""));
}

fn on_triangles(spline: &StoredSpline, mesh: &TriangleMesh) -> Option<String> {
    match spline {
        StoredSpline::PowellSabin(parts) => {
            let surface = PowellSabinSurface::from_parts(mesh.clone(), parts);
            surface.err().map(|error| error.to_string())
        }
        StoredSpline::TSpline(stored) => {
            for level in 0..stored.level_count().min(3) {
                if let Err(error) = stored.at_level(level, mesh) {
                    return Some(error.to_string());
                }
            }
            stored.restore(mesh).err().map(|error| error.to_string())
        }
        other => {
            let places = other
                .knots()
                .iter()
                .all(|&v| (v as usize) < mesh.vertex_count());
            if places {
                assert_eq!(other.knot_places(mesh).len(), other.knots().len());
            }
            match other.evaluate(mesh, 0) {
                Ok((_, values)) => {
                    assert_eq!(values.len(), other.dimension() * mesh.vertex_count());
                    None
                }
                Err(error) => Some(error.to_string()),
            }
        }
    }
}

/// Holds the records, cases, atlases and rows that runs store to their laws.
pub fn records(bytes: &[u8]) {
    same_again::<Record>(bytes);
    same_again::<Case>(bytes);
    same_again::<AtlasFile>(bytes);
    same_again::<EndedRow>(bytes);
    same_again::<RowRequest>(bytes);
    same_again::<RowProgress>(bytes);
}

fn same_again<T: DeserializeOwned + Serialize + PartialEq + std::fmt::Debug>(bytes: &[u8]) {
    let read = within(most(bytes), || serde_json::from_slice::<T>(bytes));
    if let Ok(value) = read {
        let again = serde_json::to_vec(&value).and_then(|text| serde_json::from_slice::<T>(&text));
        match again {
            Ok(again) => assert_eq!(again, value),
            Err(error) => panic!("what was written: {error}"),
        }
    }
}

/// Holds experiment files to their laws: each row can be asked for alone, with what it needs.
pub fn experiment(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    match Experiment::parse(text, "fuzzed.toml") {
        Ok(experiment) => {
            for row in &experiment.rows {
                let mut alone = experiment.clone();
                assert!(alone.restrict(&row.id));
                assert!(!row.series().is_empty());
            }
        }
        Err(error) => assert!(error.to_string().contains("fuzzed.toml")),
    }
}

/// Holds the list of models to its laws.
pub fn models(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    match Manifest::parse(text, "fuzzed.toml") {
        Ok(manifest) => {
            for model in &manifest.models {
                assert!(manifest.model(&model.name).is_some());
            }
        }
        Err(error) => assert!(error.to_string().contains("fuzzed.toml")),
    }
}
