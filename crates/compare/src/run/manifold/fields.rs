//! What pictures show of a manifold beside the surface itself.

use msplines_common::Point3;
use msplines_common::mesh::polygon::{PolygonMesh, PolygonTopology};
use msplines_common::mesh::{TriangleMesh, VertexAttribute};
use msplines_sparse_manifold::{SparseManifold, Tessellation};

use super::control::Control;
use super::{Companion, Problem};
use crate::case::SparseManifoldMethod;
use crate::error::RunError;

/// Returns curvatures, and the chart of every point.
pub(super) fn fields(
    spline: &SparseManifold,
    control: &Control,
    surface: &Tessellation,
    method: &SparseManifoldMethod,
) -> Result<Vec<VertexAttribute>, RunError> {
    let geometry = spline.geometry(&surface.places)?;
    let column = |name: &str, value: &mut dyn FnMut(usize) -> f64| VertexAttribute {
        name: name.to_owned(),
        values: (0..surface.places.len()).map(value).collect(),
    };
    let topology = control.mesh.topology();
    let chart = |i: usize| {
        let place = surface.places[i];
        let corner = match [place.at[0] > 0.5, place.at[1] > 0.5] {
            [false, false] => 0,
            [true, false] => 1,
            [true, true] => 2,
            [false, true] => 3,
        };
        f64::from(topology.origin(4 * place.face + corner))
    };
    let limit = control.limit_at(surface, method);
    let edge = control.mesh.mean_edge_length();
    let mut fields = vec![
        column("mean_curvature", &mut |i| geometry[i].mean_curvature),
        column("gaussian_curvature", &mut |i| {
            geometry[i].gaussian_curvature
        }),
        column("chart", &mut |i| chart(i)),
    ];
    if let Some(limit) = limit {
        let apart = |i: usize| (surface.positions[i] - limit[i]).norm() / edge;
        fields.push(column("distance_to_limit", &mut |i| apart(i)));
    }
    Ok(fields)
}

impl Control {
    /// Returns the limits at the points of a tessellation whose cells are a power of two.
    fn limit_at(
        &self,
        surface: &Tessellation,
        method: &SparseManifoldMethod,
    ) -> Option<Vec<Point3<f64>>> {
        if !method.cells.is_power_of_two() {
            return None;
        }
        let levels = method.cells.trailing_zeros();
        let grid = msplines_sparse_manifold::LimitGrid::build(
            &self.mesh,
            &self.sharpness,
            method.rules,
            levels,
        );
        let limits = grid.observations(self.mesh.positions());
        let cells = f64::from(method.cells);
        let at = surface.places.iter().map(|place| {
            let [column, row] = [0, 1].map(|i| (place.at[i] * cells).round() as usize);
            limits.points[limits.grid(place.face)[row * limits.side() + column] as usize]
        });
        Some(at.collect())
    }
}

/// Returns the control mesh, and what the surface approximates, as surfaces of triangles.
pub(crate) fn companions(
    problem: &Problem,
    spline: &SparseManifold,
    surface: &TriangleMesh,
    method: &SparseManifoldMethod,
) -> Vec<Companion> {
    let control = &problem.control;
    let mut companions = Vec::new();
    let topology = control.mesh.topology();
    let is_sharp = |e| !topology.is_boundary_edge(e) && control.sharpness.edge(e) > 0.0;
    let [edges, creases] = edge_lines(topology, is_sharp, method.cells.max(1));
    companions.push(Companion {
        name: "spline",
        mesh: None,
        edges: edges.clone(),
        creases: creases.clone(),
        fields: Vec::new(),
    });
    if let Some(mesh) = quads_in_triangles(&control.mesh) {
        let [edges, creases] = edge_lines(topology, is_sharp, 1);
        companions.push(Companion {
            name: "control",
            mesh: Some(mesh),
            edges,
            creases,
            fields: Vec::new(),
        });
    }
    let target = match &problem.scan {
        Some(scan) => Some((scan.clone(), Vec::new(), Vec::new())),
        None => limit_surface(control, surface, spline, method).map(|mesh| (mesh, edges, creases)),
    };
    if let Some((mesh, edges, creases)) = target {
        companions.push(Companion {
            name: "target",
            mesh: Some(mesh),
            edges,
            creases,
            fields: Vec::new(),
        });
    }
    companions
}

/// Returns the triangles of the surface with its points at their limits.
fn limit_surface(
    control: &Control,
    surface: &TriangleMesh,
    spline: &SparseManifold,
    method: &SparseManifoldMethod,
) -> Option<TriangleMesh> {
    let tessellator = msplines_sparse_manifold::Tessellator::build(spline, method.cells.max(1));
    let points = control.limit_at(&tessellator.surface(spline), method)?;
    Some(surface.with_positions(points))
}

fn quads_in_triangles(mesh: &PolygonMesh) -> Option<TriangleMesh> {
    let halves = mesh
        .topology()
        .faces()
        .flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]);
    TriangleMesh::build(mesh.positions().to_vec(), halves.collect()).ok()
}

/// Returns the edges of a mesh of quads on its tessellation of so many cells, and those of them that are
/// sharp.
pub(super) fn edge_lines(
    topology: &PolygonTopology,
    is_sharp: impl Fn(u32) -> bool,
    cells: u32,
) -> [Vec<[u32; 2]>; 2] {
    let (mut edges, mut creases) = (Vec::new(), Vec::new());
    let first = topology.vertex_count() as u32;
    for edge in 0..topology.edge_count() as u32 {
        let [a, b] = topology.edge_vertices(edge);
        // Inner points of an edge follow those of the edges before.
        let at = |step: u32| match step {
            0 => a,
            step if step == cells => b,
            step => first + edge * (cells - 1) + step - 1,
        };
        let pieces = (0..cells).map(|step| [at(step), at(step + 1)]);
        if is_sharp(edge) {
            creases.extend(pieces.clone());
        }
        edges.extend(pieces);
    }
    [edges, creases]
}
