//! Files of solids and of Bézier cells, and edges of random triangles, against VTK and meshio.

mod bezier;
mod edges;
mod t_splines;

use std::collections::BTreeMap;
use std::path::Path;

use msplines_common::mesh::shapes;
use msplines_common::mesh::tet::{TetMesh, TetSoup};
use msplines_io::{Field, Volume, VolumeCells, read_tets, write_volume};
use msplines_reference::python::{Python, PythonError};
use msplines_reference::record::Comparison;
use msplines_reference::solids::cgal_delaunay;
use msplines_reference::{Library, splines};
use msplines_trivariate::TrivariateSpline;
use msplines_trivariate::measure::{Hexahedra, hexahedra};
use nalgebra::{Point3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::Deserialize;
use serde_json::{Value, json};

type Failure = Box<dyn std::error::Error>;

/// Rounding of sums of 64 products.
const ROUNDING: f64 = 1e-12;
/// Rounding of differences of coordinates.
const DIFFERENCES: f64 = 1e-14;
/// Files whose text does not have all digits: VTK writes eleven of them, meshio twelve.
const SHORT: [&str; 3] = ["meshio.text.vtu", "vtk.ascii42.vtk", "vtk.ascii51.vtk"];
/// Half a unit of the last of eleven digits, against the smallest number that has them.
const ELEVEN_DIGITS: f64 = 5e-11;
/// Why points that are read are those that were written.
const EVERY_DIGIT: &str = "files hold every digit";
/// Points of each solid.
const POINTS: usize = 600;
/// Cells along the side of a span.
const CELLS: usize = 2;
/// Names of the questions that read a file.
const VTK: &str = "vtk_reads";
const MESHIO: &str = "meshio_reads";

/// What VTK or meshio reads in a file.
#[derive(Debug, Deserialize)]
struct Found {
    points: Vec<[f64; 3]>,
    cells: BTreeMap<String, Vec<Vec<u32>>>,
    point_data: BTreeMap<String, Value>,
    cell_data: BTreeMap<String, Value>,
}

fn read(python: &mut Python, reader: &str, path: &Path) -> Result<Found, PythonError> {
    python.ask(reader, &json!({"path": path}))
}

fn coordinates(points: &[Point3<f64>]) -> Vec<[f64; 3]> {
    points.iter().map(|p| p.coords.into()).collect()
}

/// Returns how far points are from where they should be.
fn apart(found: &[[f64; 3]], expected: &[Point3<f64>]) -> Vec<f64> {
    assert_eq!(found.len(), expected.len());
    let pairs = found.iter().zip(expected);
    pairs.map(|(&p, q)| (Point3::from(p) - q).norm()).collect()
}

#[test]
fn bezier_cells_are_the_solid() -> Result<(), Failure> {
    let mut python = Python::start()?;
    let why = "relative to the diagonal of the control points";
    let mut comparison = Comparison::new("Bézier hexahedra", Library::Vtk, ROUNDING, why);
    for (name, spline) in splines::all() {
        let folder = tempfile::tempdir()?;
        let paths = splines::write(&spline, folder.path(), &["solid.vtu"], CELLS);
        let n = spline.spans();
        let found = read(&mut python, VTK, &paths[0])?;
        let kinds: Vec<&String> = found.cells.keys().collect();
        assert_eq!(kinds, ["bezier hexahedron"], "{name}");
        assert_eq!(found.cells["bezier hexahedron"].len(), n.pow(3), "{name}");
        // Neighbours share the points between them.
        assert_eq!(found.points.len(), (3 * n + 1).pow(3), "{name}");
        let places = places(n);
        let question = json!({"path": &paths[0], "places": places});
        let theirs: Vec<[f64; 3]> = python.ask("bezier_points", &question)?;
        assert_eq!(theirs.len(), POINTS, "{name}");
        for ((cell, r, s, t), theirs) in places.into_iter().zip(theirs) {
            let span = [cell % n, cell / n % n, cell / (n * n)];
            let at = [r, s, t];
            let parameter = std::array::from_fn(|d| (span[d] as f64 + at[d]) / n as f64);
            let apart = spline.position(parameter) - Point3::from(theirs);
            comparison.add(&name, [apart.norm() / splines::size(&spline)]);
        }
    }
    comparison.finish();
    Ok(())
}

/// Random cells and parameters in them, some of them on faces, edges and corners.
fn places(spans: usize) -> Vec<(usize, f64, f64, f64)> {
    let mut random = Pcg64Mcg::seed_from_u64(8);
    let coordinate = |random: &mut Pcg64Mcg| match random.random_range(0..6) {
        0 => 0.0,
        1 => 1.0,
        _ => random.random(),
    };
    (0..POINTS)
        .map(|_| {
            let cell = random.random_range(0..spans.pow(3));
            let [r, s, t] = [0; 3].map(|_| coordinate(&mut random));
            (cell, r, s, t)
        })
        .collect()
}

#[test]
fn hexahedra_are_read_as_they_are() -> Result<(), Failure> {
    let mut python = Python::start()?;
    let quantity = "hexahedra that are written";
    let mut comparison = Comparison::new(quantity, Library::Meshio, 0.0, EVERY_DIGIT);
    for (name, spline) in splines::all() {
        let folder = tempfile::tempdir()?;
        let names = ["solid.msh", "solid.mesh", "solid.hex.vtu"];
        let paths = splines::write(&spline, folder.path(), &names, CELLS);
        let ours = hexahedra(&spline, CELLS * spline.spans());
        let cells: Vec<Vec<u32>> = ours.cells.iter().map(|cell| cell.to_vec()).collect();
        let readers = [(MESHIO, 0), (MESHIO, 1), (MESHIO, 2), (VTK, 2)];
        for (reader, path) in readers.map(|(reader, file)| (reader, &paths[file])) {
            let found = read(&mut python, reader, path)?;
            let place = format!("{name}: {reader} of {}", path.display());
            comparison.add(&name, apart(&found.points, &ours.points));
            let kinds: Vec<&String> = found.cells.keys().collect();
            assert_eq!(kinds, ["hexahedron"], "{place}");
            assert_eq!(found.cells["hexahedron"], cells, "{place}");
            if !path.ends_with("solid.mesh") {
                let stored = json!(ours.scaled_jacobians);
                assert_eq!(found.cell_data["scaled_jacobian"], stored, "{place}");
            }
        }
    }
    comparison.finish();
    Ok(())
}

/// Volumes and scaled Jacobians of cells by Verdict.
#[derive(Deserialize)]
struct Quality {
    #[serde(rename = "Volume")]
    volumes: Vec<f64>,
    #[serde(rename = "ScaledJacobian")]
    scaled_jacobians: Vec<f64>,
}

fn quality(python: &mut Python, ours: &Hexahedra) -> Result<Quality, PythonError> {
    let question = json!({"points": coordinates(&ours.points), "cells": ours.cells});
    python.ask("hexahedra_quality", &question)
}

/// The axes of a cell: sums of its four edges in each direction.
fn axes(ours: &Hexahedra, cell: usize) -> [Vector3<f64>; 3] {
    const EDGES: [[[usize; 2]; 4]; 3] = [
        [[0, 1], [3, 2], [4, 5], [7, 6]],
        [[0, 3], [1, 2], [4, 7], [5, 6]],
        [[0, 4], [1, 5], [2, 6], [3, 7]],
    ];
    let corners = ours.cells[cell].map(|v| ours.points[v as usize]);
    EDGES.map(|edges| edges.iter().map(|&[a, b]| corners[b] - corners[a]).sum())
}

/// Verdict takes the determinant of the axes, each of length 1, beside those at the corners.
#[test]
fn scaled_jacobians_are_those_of_verdict() -> Result<(), Failure> {
    let mut python = Python::start()?;
    let why = "relative to the largest coordinate over the shortest axis, whose digits are lost";
    let mut comparison = Comparison::new("scaled Jacobian", Library::Vtk, DIFFERENCES, why);
    for (name, spline) in splines::all() {
        let ours = hexahedra(&spline, CELLS * spline.spans());
        let theirs = quality(&mut python, &ours)?;
        let largest = ours
            .points
            .iter()
            .map(|p| p.coords.amax())
            .fold(0.0, f64::max);
        assert_eq!(theirs.scaled_jacobians.len(), ours.cells.len(), "{name}");
        for (cell, theirs) in theirs.scaled_jacobians.into_iter().enumerate() {
            let axes = axes(&ours, cell);
            let shortest = axes.iter().map(Vector3::norm).fold(f64::INFINITY, f64::min);
            let [x, y, z] = axes.map(|axis| axis.normalize());
            let expected = ours.scaled_jacobians[cell].min(x.dot(&y.cross(&z)));
            let lost = (largest / shortest).max(1.0);
            comparison.add(&name, [(expected - theirs).abs() / lost]);
        }
    }
    comparison.finish();
    Ok(())
}

#[test]
fn hexahedra_of_solids_that_do_not_fold_have_positive_volumes() -> Result<(), Failure> {
    let mut python = Python::start()?;
    let why = "volumes below zero, where the determinant is positive";
    let mut comparison = Comparison::new("folded hexahedra", Library::Vtk, 0.0, why);
    for (name, spline) in splines::solids() {
        let theirs = quality(&mut python, &hexahedra(&spline, CELLS * spline.spans()))?;
        let folded = theirs.volumes.iter().filter(|&&volume| volume <= 0.0);
        comparison.add(&name, [folded.count() as f64]);
    }
    comparison.finish();
    // Turned over, all of them are negative.
    let spline = TrivariateSpline::from_map(2, |[u, v, w]| Point3::new(u, w, v))?;
    let theirs = quality(&mut python, &hexahedra(&spline, 2))?;
    assert!(theirs.volumes.iter().all(|&volume| volume < 0.0));
    Ok(())
}

/// Tetrahedral meshes with their names: regular ones, and ones whose coordinates have all their digits.
fn tetrahedra() -> Vec<(String, TetMesh)> {
    let mut random = Pcg64Mcg::seed_from_u64(9);
    let mut point = |scale: f64| -> Point3<f64> {
        Point3::from([0; 3].map(|_| scale * random.random_range(-1.0..1.0)))
    };
    let mut meshes = vec![("box".to_owned(), shapes::box_solid([3, 2, 4]))];
    for scale in [1.0, 1e-9, 1e12, 0.3, 1e-3] {
        let points: Vec<Point3<f64>> = (0..200).map(|_| point(scale)).collect();
        let cells = cgal_delaunay(&points).cells;
        let mesh = TetMesh::build(points, cells).expect("a solid without holes");
        meshes.push((format!("Delaunay mesh of size {scale:e}"), mesh));
    }
    meshes
}

#[test]
fn tetrahedra_that_we_write_are_read_by_vtk_and_meshio() -> Result<(), Failure> {
    let mut python = Python::start()?;
    let folder = tempfile::tempdir()?;
    let quantity = "tetrahedra that are written";
    let mut comparison = Comparison::new(quantity, Library::Meshio, 0.0, EVERY_DIGIT);
    for (name, mesh) in tetrahedra() {
        let heights: Vec<f64> = mesh.positions().iter().map(|p| p.z).collect();
        let places: Vec<f64> = (0..mesh.cell_count() * 3).map(|i| 0.1 * i as f64).collect();
        let volume = Volume {
            positions: mesh.positions(),
            cells: VolumeCells::Tetrahedra(mesh.cells()),
            point_data: &[Field {
                name: "height",
                components: 1,
                values: &heights,
            }],
            cell_data: &[Field {
                name: "place",
                components: 3,
                values: &places,
            }],
        };
        let cells: Vec<Vec<u32>> = mesh.cells().iter().map(|cell| cell.to_vec()).collect();
        for (reader, file) in [
            (MESHIO, "a.mesh"),
            (MESHIO, "a.msh"),
            (MESHIO, "a.vtu"),
            (VTK, "a.vtu"),
        ] {
            let path = folder.path().join(file);
            write_volume(&path, &volume)?;
            let found = read(&mut python, reader, &path)?;
            let place = format!("{name}: {reader} of {file}");
            comparison.add(&name, apart(&found.points, mesh.positions()));
            let kinds: Vec<&String> = found.cells.keys().collect();
            assert_eq!(kinds, ["tetra"], "{place}");
            assert_eq!(found.cells["tetra"], cells, "{place}");
            // Medit's format holds no data.
            if file != "a.mesh" {
                let (rows, _) = places.as_chunks::<3>();
                assert_eq!(found.point_data["height"], json!(heights), "{place}");
                assert_eq!(found.cell_data["place"], json!(rows), "{place}");
            }
        }
    }
    comparison.finish();
    Ok(())
}

#[test]
fn tetrahedra_that_vtk_and_meshio_write_are_read() -> Result<(), Failure> {
    let mut python = Python::start()?;
    let why = "relative: every digit that the file holds, and half of the last of eleven in text";
    let [mut whole, mut short] =
        [("all", 0.0), ("eleven", ELEVEN_DIGITS)].map(|(digits, bound)| {
            let quantity = format!("tetrahedra that are read from {digits} digits");
            Comparison::new(&quantity, Library::Meshio, bound, why)
        });
    for (name, mesh) in tetrahedra() {
        let folder = tempfile::tempdir()?;
        let question = json!({
            "folder": folder.path(),
            "points": coordinates(mesh.positions()),
            "cells": mesh.cells(),
        });
        let files: Vec<String> = python.ask("write_tetrahedra", &question)?;
        let expected = TetSoup::from_cells(mesh.positions().to_vec(), mesh.cells());
        for file in files {
            let soup = read_tets(&folder.path().join(&file))
                .map_err(|error| format!("{name}, {file}: {error}"))?;
            assert_eq!(soup.cells, expected.cells, "{name}: {file}");
            let (found, given) = (&soup.positions, &expected.positions);
            assert_eq!(found.len(), given.len(), "{name}: {file}");
            let is_short = SHORT.contains(&file.as_str());
            let comparison = if is_short { &mut short } else { &mut whole };
            let pairs = found.iter().zip(given);
            let coordinates = pairs.flat_map(|(p, q)| (0..3).map(|d| (p[d], q[d])));
            let relative = |(read, written): (f64, f64)| {
                let apart = (read - written).abs();
                if apart == 0.0 {
                    0.0
                } else {
                    apart / written.abs()
                }
            };
            comparison.add(&name, coordinates.map(relative));
        }
    }
    whole.finish();
    short.finish();
    Ok(())
}
