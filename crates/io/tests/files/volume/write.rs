//! What is written, and what is not.

use std::path::Path;

use msplines_io::{Field, Volume, VolumeCells, WriteError, read_tets, write_volume};
use nalgebra::Point3;

use super::{CELLS, expected};
use crate::common::scratch;

#[test]
fn what_is_written_comes_back_exactly_and_again_alike() {
    let soup = expected();
    let quality = [0.5, 1e-310];
    let velocity: Vec<f64> = (0..15).map(f64::from).collect();
    let volume = Volume {
        positions: &soup.positions,
        cells: VolumeCells::Tetrahedra(&CELLS),
        point_data: &[Field {
            name: "velocity",
            components: 3,
            values: &velocity,
        }],
        cell_data: &[Field {
            name: "quality",
            components: 1,
            values: &quality,
        }],
    };
    for name in ["a.mesh", "a.msh", "a.vtu"] {
        let (_directory, path) = scratch(name);
        write_volume(&path, &volume).unwrap();
        assert_eq!(read_tets(&path).unwrap(), soup, "{name}");
        let first = std::fs::read(&path).unwrap();
        write_volume(&path, &volume).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), first);
    }
}

#[test]
fn hexahedra_are_written_and_refused_as_tetrahedra() {
    let corner = |i: u32| Point3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
    let positions: Vec<_> = (0..8).map(corner).collect();
    let volume = Volume {
        positions: &positions,
        cells: VolumeCells::Hexahedra(&[[0, 1, 3, 2, 4, 5, 7, 6]]),
        point_data: &[],
        cell_data: &[Field {
            name: "jacobian",
            components: 1,
            values: &[1.0],
        }],
    };
    for name in ["a.mesh", "a.msh", "a.vtu"] {
        let (_directory, path) = scratch(name);
        write_volume(&path, &volume).unwrap();
        let text = read_tets(&path).unwrap_err().to_string();
        assert!(
            text.contains("a cell that is a hexahedron is not supported"),
            "{text}"
        );
    }
}

#[test]
fn unfit_solids_are_not_written() {
    let soup = expected();
    let cells = VolumeCells::Tetrahedra(&CELLS);
    let bare = Volume {
        positions: &soup.positions,
        cells,
        point_data: &[],
        cell_data: &[],
    };
    let (_directory, path) = scratch("a.vtu");
    let refuse = |volume: &Volume<'_>| {
        let error = write_volume(&path, volume).unwrap_err();
        assert!(!path.exists());
        error.to_string()
    };
    let short = Volume {
        positions: &soup.positions[..4],
        ..bare
    };
    assert_eq!(
        refuse(&short),
        "cell 1 names vertex 4, but there are 4 vertices"
    );
}

#[test]
fn unfit_fields_are_not_written() {
    let soup = expected();
    let bare = Volume {
        positions: &soup.positions,
        cells: VolumeCells::Tetrahedra(&CELLS),
        point_data: &[],
        cell_data: &[],
    };
    let (_directory, path) = scratch("a.vtu");
    let refuse = |volume: &Volume<'_>| {
        let error = write_volume(&path, volume).unwrap_err();
        assert!(!path.exists());
        error.to_string()
    };
    let odd = [Field {
        name: "q",
        components: 2,
        values: &[1.0; 3],
    }];
    let text = refuse(&Volume {
        cell_data: &odd,
        ..bare
    });
    assert!(
        text.contains("`q` has 3 values for 2 vertices or cells of 2 each"),
        "{text}"
    );
    let odd = [Field {
        name: "q",
        components: 1,
        values: &[1.0, f64::NAN],
    }];
    assert!(
        refuse(&Volume {
            cell_data: &odd,
            ..bare
        })
        .contains("`q` of vertex 1 is not finite")
    );
    let odd = [Field {
        name: "two words",
        components: 1,
        values: &[1.0; 2],
    }];
    assert!(
        refuse(&Volume {
            cell_data: &odd,
            ..bare
        })
        .contains("attribute `two words`")
    );
    let error = write_volume(Path::new("a.xyz"), &bare).unwrap_err();
    assert!(matches!(error, WriteError::UnknownVolumeFormat { .. }));
}

/// A cell of degree 2 has 27 control points; only VTK has such cells.
#[test]
fn bezier_cells_are_written_for_vtk_alone() {
    let positions: Vec<_> = (0..27)
        .map(|i| Point3::new(f64::from(i), 0.5, -1.0))
        .collect();
    let points: Vec<u32> = (0..27).collect();
    let volume = |points| Volume {
        positions: &positions,
        cells: VolumeCells::BezierHexahedra { degree: 2, points },
        point_data: &[],
        cell_data: &[],
    };
    let (_directory, path) = scratch("a.vtu");
    write_volume(&path, &volume(&points)).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("version=\"2.2\"") && text.contains("NumberOfCells=\"1\""));
    for name in ["a.msh", "a.mesh"] {
        let (_directory, path) = scratch(name);
        let error = write_volume(&path, &volume(&points)).unwrap_err();
        assert!(matches!(error, WriteError::BezierFormat { .. }), "{error}");
    }
    let error = write_volume(&path, &volume(&points[1..])).unwrap_err();
    assert_eq!(
        error.to_string(),
        "26 control points do not fill cells of 27; give all points of every cell"
    );
}
