//! Paths through several crates: file, mesh, spline, file.

use std::fs;

use msplines_common::evaluate::VertexData;
use msplines_common::mesh::{Facts, Policy, accept, zoo};
use msplines_common::progress::unobserved;
use msplines_io::{Surface, read_soup, write_surface};
use msplines_tests::{Places, mean_distance, methods, positions, spread};
use nalgebra::Point3;

type Failure = Box<dyn std::error::Error>;

#[test]
fn a_fitted_surface_written_and_read_is_the_same_surface() -> Result<(), Failure> {
    let folder = tempfile::tempdir()?;
    for (index, mesh) in zoo::all().into_iter().enumerate() {
        let values = positions(&mesh);
        for (name, fit) in methods() {
            let data = VertexData {
                dimension: 3,
                values: &values,
            };
            let places = Places::Given(spread(&mesh, mesh.vertex_count() / 8));
            let fitted = fit(&mesh, data, places, &mut unobserved())?;
            let (points, _) = fitted.values.as_chunks::<3>();
            let points: Vec<Point3<f64>> = points.iter().map(|&p| Point3::from(p)).collect();
            let surface = Surface {
                positions: &points,
                faces: mesh.faces(),
                ..Surface::default()
            };
            for ending in ["ply", "obj"] {
                let path = folder.path().join(format!("{name}-{index}.{ending}"));
                write_surface(&path, &surface)?;
                let soup = read_soup(&path)?;
                assert_eq!(soup.positions, points, "{name} on mesh {index}, {ending}");
                let back = accept(&soup, Policy::Refuse)?.mesh;
                assert_eq!(
                    back.faces(),
                    mesh.faces(),
                    "{name} on mesh {index}, {ending}"
                );
            }
        }
    }
    Ok(())
}

#[test]
fn the_same_fit_writes_the_same_bytes() -> Result<(), Failure> {
    let folder = tempfile::tempdir()?;
    let mesh = zoo::closed();
    let values = positions(&mesh);
    for (name, fit) in methods() {
        let write = |run: u32| -> Result<Vec<u8>, Failure> {
            let data = VertexData {
                dimension: 3,
                values: &values,
            };
            let fitted = fit(&mesh, data, Places::Chosen(50), &mut unobserved())?;
            let (points, _) = fitted.values.as_chunks::<3>();
            let points: Vec<Point3<f64>> = points.iter().map(|&p| Point3::from(p)).collect();
            let path = folder.path().join(format!("{name}-{run}.ply"));
            let surface = Surface {
                positions: &points,
                faces: mesh.faces(),
                ..Surface::default()
            };
            write_surface(&path, &surface)?;
            Ok(fs::read(path)?)
        };
        assert_eq!(write(1)?, write(2)?, "{name}");
    }
    Ok(())
}

#[test]
fn facts_and_fit_survive_a_detour_through_a_file() -> Result<(), Failure> {
    let folder = tempfile::tempdir()?;
    let mesh = zoo::genus(2);
    let path = folder.path().join("genus.ply");
    let surface = Surface {
        positions: mesh.positions(),
        faces: mesh.faces(),
        ..Surface::default()
    };
    write_surface(&path, &surface)?;
    let back = accept(&read_soup(&path)?, Policy::Refuse)?.mesh;
    assert_eq!(Facts::measure(&back).genus, Some(2));
    let (a, b) = (positions(&mesh), positions(&back));
    assert!(mean_distance(&a, &b) == 0.0);
    Ok(())
}
