//! Writing surfaces and splines, by the extension of the file.

use std::path::{Path, PathBuf};

use msplines_common::Point3;
use msplines_common::mesh::{TriangleMesh, VertexAttribute};
use msplines_io::{Array, Surface, write_atomically, write_npy, write_surface};

use crate::error::RunError;
use crate::run::{Companion, RunOutput};
use crate::spline_file::SplineFile;

/// Extensions that surfaces are written to.
const SURFACES: [&str; 4] = ["ply", "obj", "vtu", "glb"];
/// Extension that values are written to.
const ARRAY: &str = "npy";

/// Checks before any work that every output has a known format and a folder.
///
/// # Errors
/// The first output that could not be written later.
pub fn check_outputs(outputs: &[PathBuf]) -> Result<(), RunError> {
    for path in outputs {
        let extension = extension(path);
        if !["json", ARRAY].contains(&extension.as_str()) && !SURFACES.contains(&extension.as_str())
        {
            return Err(RunError::UnknownOutput { path: path.clone() });
        }
        check_folder(path)?;
    }
    Ok(())
}

/// Checks that the folder of a file exists and that the file is not a folder itself.
///
/// # Errors
/// A folder that does not exist.
pub fn check_folder(path: &Path) -> Result<(), RunError> {
    let refused = |reason: &str| {
        Err(RunError::Write {
            path: path.to_owned(),
            reason: reason.to_owned(),
        })
    };
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    if folder.is_some_and(|folder| !folder.is_dir()) {
        return refused("its folder does not exist; make it, or give another path");
    }
    if path.is_dir() {
        refused("it is a folder; give the name of a file in it")
    } else {
        Ok(())
    }
}

/// Writes the spline, or its values at the vertices of `mesh`, to every output.
///
/// Values named `x, y, z` are the surface itself; others become attributes of `mesh`, as `fields`
/// always do.
///
/// # Errors
/// The first output that cannot be written.
pub fn write_outputs(
    outputs: &[PathBuf],
    spline: &SplineFile,
    mesh: &TriangleMesh,
    values: &[f64],
    names: &[String],
    fields: &[VertexAttribute],
) -> Result<(), RunError> {
    outputs.iter().try_for_each(|path| {
        if extension(path) == "json" {
            return write_spline(path, spline);
        }
        write_values(path, mesh, values, names, fields)
    })
}

/// Writes the spline, or the surface that it is at its vertices, to an output, with numbers at them.
///
/// # Errors
/// A file that cannot be written.
pub(crate) fn write_positions(
    path: &Path,
    spline: &SplineFile,
    mesh: &TriangleMesh,
    fields: &[VertexAttribute],
) -> Result<(), RunError> {
    if extension(path) == "json" {
        return write_spline(path, spline);
    }
    let values = coordinates(mesh.positions());
    write_values(path, mesh, &values, &coordinate_names(), fields)
}

fn write_spline(path: &Path, spline: &SplineFile) -> Result<(), RunError> {
    write_atomically(path, |out| spline.write(out)).map_err(RunError::unwritten(path))
}

/// Returns points as `[point][coordinate]`.
pub(crate) fn coordinates(points: &[Point3<f64>]) -> Vec<f64> {
    points.iter().flat_map(|p| [p.x, p.y, p.z]).collect()
}

/// Returns the names of the components of points.
pub(crate) fn coordinate_names() -> Vec<String> {
    ["x", "y", "z"].map(str::to_owned).to_vec()
}

/// Writes values at the vertices of `mesh`, as an array or as a surface.
fn write_values(
    path: &Path,
    mesh: &TriangleMesh,
    values: &[f64],
    names: &[String],
    fields: &[VertexAttribute],
) -> Result<(), RunError> {
    if is_array(path) {
        let shape = vec![values.len() / names.len(), names.len()];
        return write_array(path, shape, values.to_vec());
    }
    let are_positions = names == ["x", "y", "z"];
    let positions: Vec<Point3<f64>> = if are_positions {
        values.chunks_exact(3).map(Point3::from_slice).collect()
    } else {
        mesh.positions().to_vec()
    };
    let mut attributes = if are_positions {
        Vec::new()
    } else {
        attributes(values, names)
    };
    attributes.extend_from_slice(fields);
    let surface = Surface {
        positions: &positions,
        faces: mesh.faces(),
        attributes: &attributes,
        ..Surface::default()
    };
    write_surface(path, &surface).map_err(RunError::unwritten(path))
}

/// Returns whether an output takes values alone.
pub(crate) fn is_array(path: &Path) -> bool {
    extension(path) == ARRAY
}

/// Writes values as an array of this shape.
///
/// # Errors
/// A file that cannot be written.
pub(crate) fn write_array(
    path: &Path,
    shape: Vec<usize>,
    values: Vec<f64>,
) -> Result<(), RunError> {
    write_npy(path, &Array { shape, values }).map_err(RunError::unwritten(path))
}

/// Writes texture coordinates, a row of six numbers for every face.
///
/// # Errors
/// A file that cannot be written.
pub(crate) fn write_texture(path: &Path, texture: &[[[f64; 2]; 3]]) -> Result<(), RunError> {
    let values = texture.as_flattened().as_flattened().to_vec();
    write_array(path, vec![texture.len(), 6], values)
}

/// File of a row that holds its surface, or its domain with the fitted data as attributes.
pub const ROW_SURFACE: &str = "surface.ply";
/// File of a row that holds the places of its knots or control vertices on the domain.
pub const ROW_KNOTS: &str = "knots.ply";
/// Attributes of a surface that are its exact normals.
pub(crate) const NORMALS: [&str; 3] = ["normal_x", "normal_y", "normal_z"];
/// File of a row that holds the texture coordinates of its surface.
pub(crate) const ROW_TEXTURE: &str = "texture.npy";

/// Writes what pictures of a run are drawn from, and what later rows may start from, into
/// `folder`.
///
/// # Errors
/// A folder or file that cannot be written.
pub fn write_row_files(folder: &Path, output: &RunOutput) -> Result<(), RunError> {
    std::fs::create_dir_all(folder).map_err(RunError::unwritten(folder))?;
    write_values(
        &folder.join(ROW_SURFACE),
        &output.mesh,
        &output.values,
        &output.names,
        &output.fields,
    )?;
    if let Some(texture) = &output.texture {
        write_texture(&folder.join(ROW_TEXTURE), texture)?;
    }
    let points = Surface {
        positions: &output.knots,
        faces: &[],
        ..Surface::default()
    };
    if !output.knots.is_empty() {
        write_surface(&folder.join(ROW_KNOTS), &points).map_err(RunError::unwritten(folder))?;
    }
    output
        .frames
        .iter()
        .try_for_each(|frame| frame.write(folder))?;
    output
        .companions
        .iter()
        .try_for_each(|companion| write_companion(folder, companion))
}

/// Writes a surface beside the spline, and the lines on it as pairs of vertices.
fn write_companion(folder: &Path, companion: &Companion) -> Result<(), RunError> {
    let name = companion.name;
    if let Some(mesh) = &companion.mesh {
        let path = folder.join(companion_surface(name));
        let surface = Surface {
            positions: mesh.positions(),
            faces: mesh.faces(),
            attributes: &companion.fields,
            ..Surface::default()
        };
        write_surface(&path, &surface).map_err(RunError::unwritten(&path))?;
    }
    for (lines, pairs) in [
        (EDGE_LINES, &companion.edges),
        (CREASE_LINES, &companion.creases),
    ] {
        let path = folder.join(companion_lines(name, lines));
        let values = pairs.as_flattened().iter().map(|&v| f64::from(v)).collect();
        write_array(&path, vec![pairs.len(), 2], values)?;
    }
    Ok(())
}

/// Lines along the edges of a control mesh.
pub(crate) const EDGE_LINES: &str = "edges";
/// Lines along those edges that are sharp.
pub(crate) const CREASE_LINES: &str = "creases";

/// Returns the file of a surface beside the spline.
pub(crate) fn companion_surface(name: &str) -> String {
    format!("{name}-surface.ply")
}

/// Returns the file of lines on it.
pub(crate) fn companion_lines(name: &str, lines: &str) -> String {
    format!("{name}-{lines}.npy")
}

fn attributes(values: &[f64], names: &[String]) -> Vec<VertexAttribute> {
    let column = |component: usize| {
        values
            .iter()
            .skip(component)
            .step_by(names.len())
            .copied()
            .collect()
    };
    let named = names.iter().enumerate();
    named
        .map(|(i, name)| VertexAttribute {
            name: name.clone(),
            values: column(i),
        })
        .collect()
}

/// Returns the extension of a file in small letters.
pub(crate) fn extension(path: &Path) -> String {
    path.extension()
        .unwrap_or_default()
        .to_string_lossy()
        .to_ascii_lowercase()
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use msplines_common::Vector3;
    use msplines_common::progress::unobserved;
    use msplines_io::read_points;

    use super::*;
    use crate::case::{Case, Input, Knots, Method};
    use crate::generated::GeneratedSurface;
    use crate::run::run;

    #[test]
    fn knots_inside_faces_are_written_at_their_places() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let surface = GeneratedSurface::BumpySphere500;
        let mesh = surface.mesh();
        let faces = mesh.faces().iter().step_by(20);
        let corners = |face: &[u32; 3]| face.map(|vertex| mesh.positions()[vertex as usize].coords);
        let mut places: Vec<Point3<f64>> = faces
            .map(|face| Point3::from(corners(face).iter().sum::<Vector3<f64>>() / 3.0))
            .collect();
        places.push(mesh.positions()[7]);
        let file = folder.path().join("places.ply");
        let points = Surface {
            positions: &places,
            faces: &[],
            ..Surface::default()
        };
        write_surface(&file, &points).expect("written");
        for subdivide in [0, 1] {
            let method = Method::biharmonic(Knots::At(file.clone()));
            let case = Case {
                subdivide,
                ..Case::new(Input::Surface(surface), method)
            };
            let output = run(&case, Instant::now(), &mut unobserved()).expect("a result");
            write_row_files(folder.path(), &output).expect("written");
            let written = read_points(&folder.path().join(ROW_KNOTS)).expect("points");
            assert_eq!(written.len(), places.len());
            for place in &places {
                let apart = written.iter().map(|knot| (knot - place).norm());
                let nearest = apart.fold(f64::INFINITY, f64::min);
                assert!(nearest < 1e-12 * mesh.diagonal(), "{nearest}");
            }
        }
    }

    #[test]
    fn outputs_are_refused_before_any_work() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let check = |name: &str| check_outputs(&[folder.path().join(name)]);
        assert!(check("a.PLY").is_ok() && check("a.json").is_ok());
        assert!(matches!(
            check("a.stl"),
            Err(RunError::UnknownOutput { .. })
        ));
        assert!(matches!(check("a"), Err(RunError::UnknownOutput { .. })));
        assert!(matches!(check("none/a.ply"), Err(RunError::Write { .. })));
    }

    #[test]
    fn attributes_take_their_component_of_every_value() {
        let names = ["red".to_owned(), "blue".to_owned()];
        let columns = attributes(&[1.0, 2.0, 3.0, 4.0], &names);
        assert_eq!(columns[0].values, [1.0, 3.0]);
        assert_eq!(columns[1].values, [2.0, 4.0]);
    }
}
