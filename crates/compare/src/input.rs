//! From a file or a formula to a mesh that a method can take.

mod knots;
mod normals;
pub(crate) mod solid;

#[cfg(test)]
mod tests;

use std::path::Path;

use msplines_common::mesh::{
    Facts, Policy, PolygonSoup, TriangleMesh, VertexAttribute, accept, double_cover, subdivide_loop,
};
use msplines_io::{read_soup, sha256_file};

use crate::arrays::read_rows;
use crate::case::{Data, Input};
use crate::clock::PhaseClock;
use crate::error::{RunError, SplineFileError};
use crate::generated::{ControlShape, colour_image, colour_pattern, mesh_digest};
use crate::output::{coordinate_names, coordinates};
use crate::record::{InputFacts, InputKind};
use crate::spline_file::{SplineFile, StoredDomain};

pub use knots::{nearest_points, nearest_vertices};
pub use normals::{VertexNormals, vertex_normals};
pub use solid::holds_tetrahedra;

/// A mesh with what is known about where it comes from.
#[derive(Clone, Debug)]
pub struct LoadedInput {
    /// The mesh.
    pub mesh: TriangleMesh,
    /// What a record says about it.
    pub facts: InputFacts,
    /// Per-vertex data of the file.
    pub attributes: Vec<VertexAttribute>,
    /// What was mended.
    pub warnings: Vec<String>,
}

impl LoadedInput {
    /// Returns the input after rounds of Loop's subdivision, a smoother mesh of four times as many
    /// faces each, under the name and digest of the file. Its attributes are left behind.
    #[must_use]
    pub fn refined(self, rounds: u32) -> Self {
        let mesh = subdivide_loop(&self.mesh, rounds);
        let facts = InputFacts {
            vertices: mesh.vertex_count() as u64,
            faces: mesh.face_count() as u64,
            ..self.facts
        };
        Self {
            mesh,
            facts,
            attributes: Vec::new(),
            warnings: self.warnings,
        }
    }

    /// Returns the double cover of the input, whose facts stay those of the file.
    ///
    /// # Errors
    /// A surface without boundary, or one whose cover is no manifold.
    pub fn double_cover(self) -> Result<Self, RunError> {
        let refused = |reason: String| RunError::Input {
            file: self.facts.file.clone(),
            reason,
        };
        if self.facts.boundary_loops == 0 {
            return Err(refused("it has no boundary to cover it across".to_owned()));
        }
        let (mesh, _) = double_cover(&self.mesh).map_err(|e| refused(e.to_string()))?;
        Ok(Self {
            mesh,
            attributes: Vec::new(),
            ..self
        })
    }
}

/// Reads or generates an input, in the phases `read` and `preflight`.
///
/// # Errors
/// A file that cannot be read or parsed, or a mesh with defects that the policy does not mend.
pub fn load(input: &Input, clock: &mut PhaseClock) -> Result<LoadedInput, RunError> {
    clock.enter("read");
    let loaded = match input {
        Input::Surface(surface) => {
            let mesh = surface.mesh();
            let facts = facts(
                &mesh,
                surface.to_string(),
                mesh_digest(&mesh),
                InputKind::Triangles,
            );
            LoadedInput {
                mesh,
                facts,
                attributes: Vec::new(),
                warnings: Vec::new(),
            }
        }
        Input::Control(shape) => triangulated(shape)?,
        Input::Network(_) | Input::Chart(_) | Input::Solid(_) => {
            return Err(RunError::Input {
                file: input_name(input),
                reason: "this is no mesh; give one of triangles".to_owned(),
            });
        }
        Input::File { path, repair } => {
            let file = file_name(path);
            let refused = |reason: String| RunError::Input {
                file: file.clone(),
                reason,
            };
            let sha256 = sha256_file(path).map_err(|e| refused(unreadable(&e)))?;
            let soup = read_soup(path).map_err(|e| refused(e.to_string()))?;
            let kind = kind(&soup);
            clock.enter("preflight");
            let policy = if *repair {
                Policy::Repair
            } else {
                Policy::Refuse
            };
            let accepted = accept(&soup, policy).map_err(|e| refused(e.to_string()))?;
            LoadedInput {
                facts: facts(&accepted.mesh, file.clone(), sha256, kind),
                attributes: accepted.attributes,
                warnings: accepted
                    .repairs
                    .iter()
                    .map(|r| format!("repaired: {r}"))
                    .collect(),
                mesh: accepted.mesh,
            }
        }
    };
    clock.leave();
    Ok(loaded)
}

/// Returns the name of a generated input, or that of its file.
#[must_use]
pub fn input_name(input: &Input) -> String {
    match input {
        Input::File { path, .. } => file_name(path),
        Input::Surface(surface) => surface.to_string(),
        Input::Control(shape) => shape.to_string(),
        Input::Network(network) => network.to_string(),
        Input::Chart(chart) => chart.to_string(),
        Input::Solid(solid) => solid.to_string(),
    }
}

/// Returns a generated control mesh with its quads cut into triangles.
fn triangulated(shape: &ControlShape) -> Result<LoadedInput, RunError> {
    let (mesh, _) = shape.mesh();
    let mut soup = PolygonSoup {
        positions: mesh.positions().to_vec(),
        ..PolygonSoup::default()
    };
    for face in mesh.topology().faces() {
        soup.push_face(face.iter().map(|&v| i64::from(v)));
    }
    let accepted = accept(&soup, Policy::Refuse).map_err(|e| RunError::Input {
        file: shape.to_string(),
        reason: e.to_string(),
    })?;
    let digest = mesh_digest(&accepted.mesh);
    let kind = InputKind::Polygons;
    Ok(LoadedInput {
        facts: facts(&accepted.mesh, shape.to_string(), digest, kind),
        attributes: Vec::new(),
        warnings: Vec::new(),
        mesh: accepted.mesh,
    })
}

/// Returns the triangles of a file with their attributes, whatever shape they have; for files that
/// this program wrote.
///
/// # Errors
/// A file that cannot be read, or whose faces are no manifold of triangles.
pub fn read_surface(path: &Path) -> Result<(TriangleMesh, Vec<VertexAttribute>), RunError> {
    let refused = |reason: String| RunError::Input {
        file: file_name(path),
        reason,
    };
    let soup = read_soup(path).map_err(|e| refused(e.to_string()))?;
    let faces: Option<Vec<[u32; 3]>> = (0..soup.face_count())
        .map(|face| {
            let corners: [i64; 3] = soup.face(face).try_into().ok()?;
            let mut ids = [0; 3];
            for (id, corner) in ids.iter_mut().zip(corners) {
                *id = u32::try_from(corner).ok()?;
            }
            Some(ids)
        })
        .collect();
    let faces = faces.ok_or_else(|| refused("not all of its faces are triangles".to_owned()))?;
    let mesh = TriangleMesh::build(soup.positions, faces).map_err(|e| refused(e.to_string()))?;
    Ok((mesh, soup.attributes))
}

/// Returns the domain of a stored spline: the embedded mesh, or the given file where it has the
/// digest that the spline names.
///
/// # Errors
/// No domain, another one than the spline belongs to, or a file that cannot be read.
pub fn load_domain(
    spline: &SplineFile,
    given: Option<&Path>,
    name: &Path,
    clock: &mut PhaseClock,
) -> Result<LoadedInput, RunError> {
    let (embedded, repair) = match &spline.domain {
        StoredDomain::Embedded { mesh } => (Some(mesh.restore()?), false),
        StoredDomain::Polygons { .. } => return Err(SplineFileError::Polygons.into()),
        StoredDomain::Cube { .. } => return Err(SplineFileError::Cube.into()),
        StoredDomain::Digest { repair, .. } => (None, *repair),
    };
    let loaded = match given {
        Some(path) => Some(load(
            &Input::File {
                path: path.to_owned(),
                repair,
            },
            clock,
        )?),
        None => None,
    };
    let other = |expected: String, found: String| {
        RunError::Spline(SplineFileError::OtherDomain { expected, found })
    };
    match (embedded, loaded, &spline.domain) {
        (None, None, StoredDomain::Digest { sha256, .. }) => Err(SplineFileError::DomainMissing {
            sha256: sha256.clone(),
        }
        .into()),
        (None, Some(loaded), StoredDomain::Digest { sha256, .. })
            if loaded.facts.sha256 != *sha256 =>
        {
            Err(other(sha256.clone(), loaded.facts.sha256))
        }
        (Some(mesh), Some(loaded), _) if mesh_digest(&mesh) != mesh_digest(&loaded.mesh) => {
            Err(other(mesh_digest(&mesh), mesh_digest(&loaded.mesh)))
        }
        (_, Some(loaded), _) => Ok(loaded),
        (Some(mesh), None, _) => {
            let digest = mesh_digest(&mesh);
            let facts = facts(&mesh, file_name(name), digest, InputKind::Triangles);
            Ok(LoadedInput {
                mesh,
                facts,
                attributes: Vec::new(),
                warnings: Vec::new(),
            })
        }
        (None, None, _) => unreachable!("embedded meshes are restored"),
    }
}

/// Values to fit, with what their errors are divided by.
#[derive(Clone, Debug, PartialEq)]
pub struct FitData {
    /// Components of a value.
    pub dimension: usize,
    /// Values, `[vertex][component]`.
    pub values: Vec<f64>,
    /// Names of the components, for attributes in a file.
    pub names: Vec<String>,
    /// What errors are divided by.
    pub scale: f64,
}

/// Returns the values that `data` names at the vertices of an input.
///
/// # Errors
/// An attribute that the file does not have.
pub fn fit_data(data: &Data, input: &LoadedInput) -> Result<FitData, RunError> {
    match data {
        Data::Positions => Ok(FitData {
            dimension: 3,
            values: coordinates(input.mesh.positions()),
            names: coordinate_names(),
            scale: input.mesh.diagonal(),
        }),
        Data::ColourPattern | Data::ColourImage => Ok(FitData {
            dimension: 3,
            values: match data {
                Data::ColourImage => colour_image(&input.mesh),
                _ => colour_pattern(&input.mesh),
            },
            names: ["red", "green", "blue"].map(str::to_owned).to_vec(),
            scale: 1.0,
        }),
        Data::Attributes(chosen) => attribute_data(chosen, input),
        Data::Array(path) => array_data(path, input),
    }
}

fn attribute_data(chosen: &[String], input: &LoadedInput) -> Result<FitData, RunError> {
    let mut columns = Vec::with_capacity(chosen.len());
    for name in chosen {
        let found = input
            .attributes
            .iter()
            .find(|attribute| attribute.name == *name);
        columns.push(found.ok_or_else(|| missing_attribute(name, input))?);
    }
    let vertices = 0..input.mesh.vertex_count();
    let values: Vec<f64> = vertices
        .flat_map(|v| columns.iter().map(move |column| column.values[v]))
        .collect();
    if let Some(index) = values.iter().position(|x| !x.is_finite()) {
        let (vertex, name) = (index / chosen.len(), &chosen[index % chosen.len()]);
        let reason = format!("attribute `{name}` is not finite at vertex {vertex}; mend the file");
        return Err(RunError::Input {
            file: input.facts.file.clone(),
            reason,
        });
    }
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let colours = chosen
        .iter()
        .all(|name| ["red", "green", "blue"].contains(&name.as_str()));
    let in_unit_range = low >= 0.0 && high <= 1.0;
    let scale = if colours && in_unit_range || high <= low {
        1.0
    } else {
        high - low
    };
    Ok(FitData {
        dimension: chosen.len(),
        values,
        names: chosen.to_vec(),
        scale,
    })
}

fn array_data(path: &Path, input: &LoadedInput) -> Result<FitData, RunError> {
    let rows = read_rows(path, "--data")?;
    let refused = |reason: String| RunError::Array {
        option: "--data",
        file: file_name(path),
        reason,
    };
    let vertices = input.mesh.vertex_count();
    if rows.len() != vertices {
        let found = rows.len();
        return Err(refused(format!(
            "{found} rows for {vertices} vertices; give one row for each vertex"
        )));
    }
    let dimension = rows[0].len();
    if let Some(row) = rows.iter().position(|row| row.len() != dimension) {
        return Err(refused(format!(
            "row {row} has {} numbers, but row 0 has {dimension}; give every vertex as many",
            rows[row].len()
        )));
    }
    let values = rows.concat();
    if let Some(index) = values.iter().position(|x| !x.is_finite()) {
        let row = index / dimension;
        return Err(refused(format!("row {row} is not finite; mend the file")));
    }
    Ok(FitData {
        dimension,
        scale: range(&values),
        names: (0..dimension).map(|c| format!("value_{c}")).collect(),
        values,
    })
}

/// Returns the largest difference of two values, or 1 where all are equal.
pub(crate) fn range(values: &[f64]) -> f64 {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if high > low { high - low } else { 1.0 }
}

fn missing_attribute(name: &str, input: &LoadedInput) -> RunError {
    let names: Vec<&str> = input.attributes.iter().map(|a| a.name.as_str()).collect();
    RunError::NoSuchAttribute {
        file: input.facts.file.clone(),
        name: name.to_owned(),
        available: if names.is_empty() {
            "none".to_owned()
        } else {
            names.join(", ")
        },
    }
}

/// Returns bytes as lower-case hexadecimal digits.
#[must_use]
pub fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Returns the name of a file without its folder.
#[must_use]
pub fn file_name(path: &Path) -> String {
    path.file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned()
}

/// Returns what is said about a file that the system will not read.
#[must_use]
pub fn unreadable(error: &std::io::Error) -> String {
    format!("cannot be read: {error}; give the path of a mesh file")
}

fn kind(soup: &PolygonSoup) -> InputKind {
    let triangles = (0..soup.face_count()).all(|face| soup.face(face).len() == 3);
    if triangles {
        InputKind::Triangles
    } else {
        InputKind::Polygons
    }
}

fn facts(mesh: &TriangleMesh, file: String, sha256: String, kind: InputKind) -> InputFacts {
    let facts = Facts::measure(mesh);
    InputFacts {
        file,
        sha256,
        kind,
        vertices: mesh.vertex_count() as u64,
        faces: mesh.face_count() as u64,
        cells: 0,
        genus: facts.genus.map(u64::from),
        boundary_loops: facts.boundary_loops as u64,
    }
}
