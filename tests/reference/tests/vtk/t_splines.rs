//! Files of T-splines that were fitted to whole surfaces: Bézier cells as VTK evaluates them, and spline
//! files read back.

use msplines_common::bspline::CellShape;
use msplines_common::evaluate::{Order, Samples, SurfaceSpline};
use msplines_common::mesh::SurfacePoint;
use msplines_compare::spline_file::{
    SplineFile, StoredDomain, StoredMesh, StoredSpline, StoredTSpline,
};
use msplines_io::write_cells;
use msplines_reference::Library;
use msplines_reference::python::Python;
use msplines_reference::record::Comparison;
use msplines_reference::t_splines::{Whole, generated, model_names, models};
use msplines_t_spline::TSplineSurface;
use msplines_t_spline::caps::CapOptions;
use msplines_t_spline::cells::CellOptions;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde_json::json;

use crate::{Failure, POINTS, ROUNDING, VTK, coordinates, read};

/// How far cells of caps may be from the surface, over the diagonal, and their degree: what the program
/// writes.
const CELLS: (f64, u8) = (1e-6, 7);

fn fits() -> Vec<Whole> {
    let mut fits = generated();
    fits.extend(models(&model_names()));
    fits
}

#[test]
fn cells_of_fits_are_the_surface() -> Result<(), Failure> {
    let mut python = Python::start()?;
    let why = "relative to the diagonal";
    let mut exact = Comparison::new("exact cells of T-splines", Library::Vtk, ROUNDING, why);
    let why = "over the tolerance: between the points where it is measured a cell may be farther";
    let mut caps = Comparison::new("cells of caps of T-splines", Library::Vtk, 1.5, why);
    let mut random = Pcg64Mcg::seed_from_u64(12);
    for Whole {
        name,
        mesh,
        surface,
    } in fits()
    {
        let (share, degree) = CELLS;
        let tolerance = share * mesh.diagonal();
        let work = surface
            .spline()
            .patchwork(&CellOptions { tolerance, degree })?;
        let (cells, report) = (work.cells()?, work.report());
        assert_eq!(cells.shape(), CellShape::Quads);
        let folder = tempfile::tempdir()?;
        let path = folder.path().join("cells.vtu");
        write_cells(&path, &cells, &[], &[])?;
        let found = read(&mut python, VTK, &path)?;
        assert_eq!(found.points, coordinates(cells.points()), "{name}");
        assert_eq!(
            found.point_data["RationalWeights"],
            json!(cells.weights()),
            "{name}"
        );
        assert_eq!(
            found.cells["bezier quadrilateral"].len(),
            cells.len(),
            "{name}"
        );
        let places: Vec<(usize, [f64; 2])> = (0..POINTS)
            .map(|_| {
                let at = [0; 2].map(|_| match random.random_range(0..6) {
                    0 => 0.0,
                    1 => 1.0,
                    _ => random.random::<f64>(),
                });
                (random.random_range(0..cells.len()), at)
            })
            .collect();
        let asked: Vec<_> = places.iter().map(|(c, [r, s])| (c, r, s, 0.0)).collect();
        let theirs: Vec<[f64; 3]> =
            python.ask("bezier_points", &json!({"path": &path, "places": asked}))?;
        let points: Vec<_> = places
            .iter()
            .map(|&(cell, at)| work.place(cell, at))
            .collect();
        let ours = surface.spline().evaluate(&points, Order::Value).positions;
        assert_eq!(theirs.len(), ours.len(), "{name}");
        for ((ours, theirs), (cell, _)) in ours.iter().zip(theirs).zip(&places) {
            let apart = (ours - nalgebra::Point3::from(theirs)).norm();
            if *cell < report.exact {
                exact.add(&name, [apart / mesh.diagonal()]);
            } else {
                caps.add(&name, [apart / tolerance]);
            }
        }
        println!("{name}: {report:?}");
    }
    exact.finish();
    caps.finish();
    Ok(())
}

/// Points on faces, at corners and on edges.
fn points(surface: &TSplineSurface) -> Vec<SurfacePoint> {
    let faces = surface.domain().mesh().face_count() as u32;
    let places = [[1.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.2, 0.3, 0.5]];
    let stride = (faces as usize).div_ceil(2_000);
    let points = (0..faces).step_by(stride).zip(places.into_iter().cycle());
    points.map(|(face, at)| SurfacePoint { face, at }).collect()
}

/// The bits of positions and derivatives up to the second.
fn bits(surface: &TSplineSurface) -> Result<Vec<u64>, Failure> {
    let mut samples = Samples::default();
    surface
        .prepare(&points(surface), Order::Second)?
        .evaluate(&mut samples);
    let numbers = [samples.values, samples.first, samples.second].concat();
    Ok(numbers.into_iter().map(f64::to_bits).collect())
}

#[test]
fn spline_files_of_fits_give_the_same_bits() -> Result<(), Failure> {
    for Whole {
        name,
        mesh,
        surface,
    } in fits()
    {
        let stored = StoredTSpline::of(&surface, &CapOptions::default(), &[], &mesh);
        let domain = StoredDomain::Embedded {
            mesh: StoredMesh::of(&mesh),
        };
        let spline = StoredSpline::TSpline(Box::new(stored));
        let file = SplineFile::new(domain, json!({}), spline);
        let mut text = Vec::new();
        file.write(&mut text)?;
        let again: SplineFile = serde_json::from_slice(&text)?;
        assert_eq!(again, file, "{name}");
        let StoredSpline::TSpline(stored) = again.spline else {
            panic!("{name}: a T-spline");
        };
        let restored = stored.restore(&mesh)?;
        let expected = bits(&surface)?;
        assert!(!expected.is_empty(), "{name}");
        assert!(bits(&restored)? == expected, "{name}: other bits");
        println!(
            "{name}: {} bytes, {} numbers the same",
            text.len(),
            expected.len()
        );
    }
    Ok(())
}
