//! Control meshes with their sharpness, from files and from names.

use std::path::{Path, PathBuf};

use msplines_common::Point3;
use msplines_common::mesh::polygon::{PolygonMesh, Refined, Sharpness};
use msplines_io::{read_creases, read_soup, sha256_file};
use msplines_sparse_manifold::LimitGrid;
use sha2::{Digest, Sha256};

use super::{Evaluation, Problem, facts};
use crate::case::{Creases, Input, Polygons, SparseManifoldMethod};
use crate::clock::PhaseClock;
use crate::error::{RunError, SplineFileError};
use crate::input::{file_name, hexadecimal, unreadable};
use crate::spline_file::{SplineFile, StoredDomain};

/// Catmull-Clark steps to the grid on which surfaces are compared: 16 by 16 cells in every face.
const DENSE_LEVELS: u32 = 4;

/// A control mesh of quads.
pub(crate) struct Control {
    pub(crate) mesh: PolygonMesh,
    pub(crate) sharpness: Sharpness,
    /// Limits of the vertices after [`DENSE_LEVELS`] steps.
    dense: LimitGrid,
    /// Whether it is not the mesh of the input any more.
    pub(crate) refined: bool,
}

/// Reads or makes a control mesh, in the phases `read` and `preflight`.
pub(super) fn load(
    input: &Input,
    method: &SparseManifoldMethod,
    clock: &mut PhaseClock,
) -> Result<Problem, RunError> {
    clock.enter("read");
    let (mesh, sharpness, file, sha256) = match input {
        Input::Control(shape) => {
            let (mesh, tags) = shape.mesh();
            let tags = match method.creases {
                Creases::None => Vec::new(),
                _ => tags,
            };
            let sharpness = Sharpness::build(mesh.topology(), method.rules, &tags);
            let sharpness = sharpness.map_err(|e| refused(&shape.to_string(), e.to_string()))?;
            let digest = digest(&mesh);
            (mesh, sharpness, shape.to_string(), digest)
        }
        Input::File { path, .. } => {
            let file = file_name(path);
            let sha256 = sha256_file(path).map_err(|e| refused(&file, unreadable(&e)))?;
            let soup = read_soup(path).map_err(|e| refused(&file, e.to_string()))?;
            clock.enter("preflight");
            let mesh = PolygonMesh::accept(&soup).map_err(|e| refused(&file, e.to_string()))?;
            let sharpness = file_sharpness(&mesh, path, method)?;
            (mesh, sharpness, file, sha256)
        }
        Input::Surface(surface) => return Err(no_control_mesh(surface)),
        Input::Network(network) => return Err(no_control_mesh(network)),
        Input::Chart(chart) => return Err(no_control_mesh(chart)),
        Input::Solid(solid) => return Err(no_control_mesh(solid)),
    };
    clock.leave();
    let facts = facts(&mesh, file.clone(), sha256);
    let control =
        Control::build(mesh, sharpness, method).map_err(|reason| refused(&file, reason))?;
    let levels = method.options.levels;
    let grid = LimitGrid::build(
        &control.mesh,
        &control.sharpness,
        method.rules,
        levels.min(6),
    );
    Ok(Problem {
        observations: grid.observations(control.mesh.positions()),
        control,
        scan: None,
        facts,
        warnings: Vec::new(),
    })
}

fn no_control_mesh(name: &dyn std::fmt::Display) -> RunError {
    let reason = "this is no control mesh; give one of quads, or the number of vertices of the \
                  control mesh of a scan";
    refused(&name.to_string(), reason.to_owned())
}

fn refused(file: &str, reason: String) -> RunError {
    RunError::Input {
        file: file.to_owned(),
        reason,
    }
}

/// Returns the sharpness that a file beside the mesh, or another one, says.
fn file_sharpness(
    mesh: &PolygonMesh,
    path: &Path,
    method: &SparseManifoldMethod,
) -> Result<Sharpness, RunError> {
    let Some(tags_file) = creases_file(path, &method.creases) else {
        return Ok(Sharpness::smooth(mesh.topology(), method.rules));
    };
    let name = file_name(&tags_file);
    let creases = read_creases(&tags_file).map_err(|e| refused(&name, e.to_string()))?;
    Sharpness::build(mesh.topology(), method.rules, &creases.tags).map_err(|e| {
        let line = creases.lines.get(e.tag()).copied().unwrap_or_default();
        refused(&name, format!("line {line}: {e}"))
    })
}

/// Returns the file that says what is sharp.
pub(crate) fn creases_file(mesh: &Path, creases: &Creases) -> Option<PathBuf> {
    match creases {
        Creases::None => None,
        Creases::File(path) => Some(path.clone()),
        Creases::Beside => Some(mesh.with_extension("creases")).filter(|path| path.is_file()),
    }
}

/// Returns the control mesh of a stored manifold: the one in its file, or the given one.
pub(super) fn domain_of(
    spline: &SplineFile,
    evaluation: &Evaluation,
) -> Result<PolygonMesh, RunError> {
    match (&spline.domain, &evaluation.mesh) {
        (StoredDomain::Polygons { polygons }, _) => Ok(polygons.restore()?),
        (StoredDomain::Embedded { .. } | StoredDomain::Cube { .. }, _) => {
            Err(SplineFileError::Polygons.into())
        }
        (StoredDomain::Digest { sha256, .. }, None) => Err(SplineFileError::DomainMissing {
            sha256: sha256.clone(),
        }
        .into()),
        (StoredDomain::Digest { sha256, .. }, Some(path)) => {
            let file = file_name(path);
            let found = sha256_file(path).map_err(|e| refused(&file, unreadable(&e)))?;
            if found != *sha256 {
                let expected = sha256.clone();
                return Err(SplineFileError::OtherDomain { expected, found }.into());
            }
            let soup = read_soup(path).map_err(|e| refused(&file, e.to_string()))?;
            PolygonMesh::accept(&soup).map_err(|e| refused(&file, e.to_string()))
        }
    }
}

pub(super) fn digest(mesh: &PolygonMesh) -> String {
    let mut digest = Sha256::new();
    for position in mesh.positions() {
        position.iter().for_each(|x| digest.update(x.to_le_bytes()));
    }
    for face in mesh.topology().faces() {
        face.iter().for_each(|v| digest.update(v.to_le_bytes()));
    }
    hexadecimal(&digest.finalize())
}

impl Control {
    /// Returns the control mesh that a fit takes: quads, after one step if that is asked for.
    pub(super) fn build(
        mesh: PolygonMesh,
        sharpness: Sharpness,
        method: &SparseManifoldMethod,
    ) -> Result<Self, String> {
        let needs_step = !mesh.topology().is_quad();
        if needs_step && method.polygons == Polygons::Refuse {
            let error = mesh.check_quads().err();
            let text = error.map(|e| e.to_string()).unwrap_or_default();
            return Err(format!("{text}; --refine-polygons does that"));
        }
        let (mesh, sharpness) = if needs_step {
            let step = Refined::none(mesh.topology(), &sharpness).again(method.rules);
            let positions = step.stencils.apply(mesh.positions());
            let refined = PolygonMesh::new(std::sync::Arc::new(step.topology), positions);
            (refined, step.sharpness)
        } else {
            (mesh, sharpness)
        };
        Ok(Self {
            dense: LimitGrid::build(&mesh, &sharpness, method.rules, DENSE_LEVELS),
            mesh,
            sharpness,
            refined: needs_step,
        })
    }

    /// Returns the limits of the points of a grid of 16 by 16 cells in every face.
    pub(super) fn limit_points(&self) -> Vec<Point3<f64>> {
        let limits = self.dense.observations(self.mesh.positions());
        let target = limits.grids.iter().map(|&o| limits.points[o as usize]);
        target.collect()
    }

    /// Returns the numbers of sharp edges inside of the surface, of sharp corners inside of it, and of
    /// vertices at which a crease ends.
    pub(super) fn sharp_counts(&self) -> [usize; 3] {
        let topology = self.mesh.topology();
        let sharp = |e: u32| !topology.is_boundary_edge(e) && self.sharpness.edge(e) > 0.0;
        let edges = (0..topology.edge_count() as u32)
            .filter(|&e| sharp(e))
            .count();
        let inner = |v: &u32| !topology.is_boundary_vertex(*v);
        let vertices = (0..topology.vertex_count() as u32).filter(inner);
        let corner = |v: u32| self.sharpness.vertex(v) > 0.0;
        let ends = |v: u32| {
            topology
                .spokes(v)
                .filter(|&h| sharp(topology.edge(h)))
                .count()
        };
        let corners = vertices.clone().filter(|&v| corner(v)).count();
        let darts = vertices.filter(|&v| !corner(v) && ends(v) == 1).count();
        [edges, corners, darts]
    }
}
