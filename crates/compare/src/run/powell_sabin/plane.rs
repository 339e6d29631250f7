//! Splines over the plane of the first two coordinates.

use msplines_common::mesh::{Topology, TriangleMesh};
use msplines_common::progress::{Observer, Outcome};
use msplines_common::{Point3, Vector3};
use msplines_powell_sabin::surface::SurfaceParts;
use msplines_powell_sabin::{
    Basis, FlatDomain, PowellSabinSpline, PowellSabinSurface, SurfaceError, VertexCondition, fit,
};
use serde_json::json;

use super::edits::{nearest, place};
use super::{Produced, SPLINE, atlas};
use crate::case::{BasisFunction, PowellSabinMethod};
use crate::clock::PhaseClock;
use crate::error::RunError;
use crate::fit::following;
use crate::input::{LoadedInput, vertex_normals};
use crate::record::named;
use crate::run::enter;

/// Height of the graph of a function that is 1, over the diagonal of its domain.
const HEIGHT: f64 = 0.5;

/// Fits a surface through the vertices of a graph and their normals, flat over the plane.
pub(super) fn fitted(
    input: &LoadedInput,
    method: &PowellSabinMethod,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<Produced, RunError> {
    let normals = vertex_normals(input)?;
    let domain = domain(&input.mesh)?;
    let conditions = VertexCondition::of_mesh(&input.mesh, &normals.normals);
    enter("fit", clock, observer);
    let fit = {
        let mut timed = following(&["fit"], clock, observer);
        let options = &method.surface.spline;
        fit(&domain, &conditions, options, &mut timed).map_err(SurfaceError::Fit)?
    };
    let mut produced = produced(surface(&fit.spline)?, conditions);
    produced.outcome = fit.report.outcome;
    produced.checks.extend(atlas::of_fit(&fit.report));
    produced.warnings = normals.warnings;
    let of_fit = fit.report.warnings.iter().map(ToString::to_string);
    produced.warnings.extend(of_fit);
    Ok(produced)
}

/// Returns the graph of a basis function over the plane, without any fit.
pub(super) fn basis_function(
    input: &LoadedInput,
    function: &BasisFunction,
) -> Result<Produced, RunError> {
    let mesh = &input.mesh;
    let domain = domain(mesh)?;
    let vertex = nearest(mesh.positions(), &place(mesh, function.at));
    if function.corner > 2 {
        let (what, remedy) = ("fourth corner of a control triangle", "give 0, 1 or 2");
        return Err(RunError::without(SPLINE, what, remedy));
    }
    let basis = Basis::new(&domain).function(vertex, function.corner);
    let height = HEIGHT * mesh.diagonal();
    let rows = basis.vertex_values().iter();
    let rows = rows.zip(basis.vertex_gradients().as_chunks::<2>().0);
    let conditions: Vec<VertexCondition> = mesh
        .positions()
        .iter()
        .zip(rows)
        .map(|(p, (value, [by_u, by_v]))| VertexCondition::Fixed {
            position: Point3::new(p.x, p.y, height * value),
            gradient: [
                Vector3::new(1.0, 0.0, height * by_u),
                Vector3::new(0.0, 1.0, height * by_v),
            ],
        })
        .collect();
    let graph = fit(
        &domain,
        &conditions,
        &msplines_powell_sabin::Options::default(),
        &mut msplines_common::progress::unobserved(),
    );
    let mut produced = produced(
        surface(&graph.map_err(SurfaceError::Fit)?.spline)?,
        conditions,
    );
    let topology = mesh.topology();
    let star: Vec<u32> = topology.outgoing(vertex).collect();
    produced
        .checks
        .insert("support_faces".to_owned(), json!(star.len()));
    produced.marks = vec![mesh.positions()[vertex as usize]];
    let opposite = |h: u32| [topology.target(h), topology.target(Topology::next(h))];
    produced.molecule = star.into_iter().map(opposite).collect();
    Ok(produced)
}

/// The flat domain of a mesh over the plane of its first two coordinates.
fn domain(mesh: &TriangleMesh) -> Result<FlatDomain, RunError> {
    let at = |v: u32| mesh.positions()[v as usize];
    let side = |[from, to]: [u32; 2]| [at(to).x - at(from).x, at(to).y - at(from).y];
    let sides = mesh.faces().iter();
    let sides = sides.flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]].map(side));
    let domain = FlatDomain::build(mesh.clone(), sides.collect());
    Ok(domain.map_err(SurfaceError::Domain)?)
}

/// Returns the surface that a spline without holes is.
pub(super) fn surface(spline: &PowellSabinSpline) -> Result<PowellSabinSurface, RunError> {
    let domain = spline.flat_domain();
    let gradients = spline.vertex_gradients().as_chunks::<3>().0;
    let parts = SurfaceParts {
        edge_vectors: domain.edge_vectors().to_vec(),
        values: spline.vertex_values().as_chunks::<3>().0.to_vec(),
        gradients: gradients.as_chunks::<2>().0.to_vec(),
        holes: Vec::new(),
    };
    let surface = PowellSabinSurface::from_parts(domain.mesh().clone(), &parts);
    Ok(surface?)
}

fn produced(surface: PowellSabinSurface, conditions: Vec<VertexCondition>) -> Produced {
    Produced {
        origins: (0..conditions.len() as u32).map(Some).collect(),
        surface,
        conditions,
        marks: Vec::new(),
        molecule: Vec::new(),
        outcome: Outcome::Converged,
        checks: named([("zeros", json!(0)), ("holes", json!(0))]),
        warnings: Vec::new(),
    }
}
