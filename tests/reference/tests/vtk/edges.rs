//! Edges of more than two triangles.

use std::collections::BTreeSet;

use msplines_common::mesh::{Defect, PolygonSoup, preflight};
use msplines_reference::python::Python;
use msplines_reference::record::Comparison;
use msplines_reference::{Library, meshes};
use nalgebra::Point3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde_json::json;

use super::{Failure, coordinates};

/// Random sets of triangles for each number of vertices.
const SOUPS: u64 = 300;

#[test]
fn the_same_edges_are_not_manifold() -> Result<(), Failure> {
    let mut python = Python::start()?;
    let why = "edges that one alone finds";
    let quantity = "edges of more than two triangles";
    let mut comparison = Comparison::new(quantity, Library::Vtk, 0.0, why);
    let mut total = 0;
    for vertices in 4..11 {
        let mut random = Pcg64Mcg::seed_from_u64(u64::from(vertices));
        let soups: Vec<Vec<[u32; 3]>> = (0..SOUPS)
            .map(|_| without_copies(meshes::random_triangles(vertices, &mut random)))
            .collect();
        let place = |_| Point3::from([0; 3].map(|_| random.random_range(-1.0..1.0)));
        let points: Vec<Point3<f64>> = (0..vertices).map(place).collect();
        let question = json!({"points": coordinates(&points), "soups": soups});
        let theirs: Vec<Vec<[u32; 2]>> = python.ask("non_manifold_edges", &question)?;
        for (faces, theirs) in soups.iter().zip(theirs) {
            let found = preflight(&PolygonSoup::from_triangles(points.clone(), faces));
            let ours = found.defects.iter().filter_map(|defect| match defect {
                Defect::NonManifoldEdge { edge, .. } => Some(*edge),
                _ => None,
            });
            let ours: BTreeSet<[u32; 2]> = ours.collect();
            // VTK may name an edge once for each of its faces.
            let theirs: BTreeSet<[u32; 2]> = theirs.into_iter().collect();
            total += theirs.len();
            let apart = ours.symmetric_difference(&theirs).count();
            comparison.add(&format!("soups of {vertices} vertices"), [apart as f64]);
        }
    }
    assert!(total > 1_000, "{total}");
    comparison.finish();
    Ok(())
}

/// Preflight names a copy of a face as such and leaves it aside.
fn without_copies(faces: Vec<[u32; 3]>) -> Vec<[u32; 3]> {
    let mut seen = BTreeSet::new();
    let is_first = |face: &[u32; 3]| {
        let mut set = *face;
        set.sort_unstable();
        seen.insert(set)
    };
    faces.into_iter().filter(is_first).collect()
}
