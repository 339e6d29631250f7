//! Catmull-Clark surfaces by OpenMesh and OpenSubdiv, with vertices in this project's order.
//!
//! Both libraries number the vertices of a refinement in their own way; [`Numbers`] follows each from
//! the vertices, edges and faces it is the point of, so that nothing is matched by position.

use std::collections::BTreeMap;

use msplines_common::mesh::polygon::{
    BoundaryCorners, CreaseRule, PolygonMesh, PolygonTopology, Rules, Sharpness,
};
use nalgebra::{Point3, Vector3};

use crate::bindings::{self, Control, PolygonLevel};
use crate::flat;

/// Sharpness from which on OpenSubdiv keeps edges and vertices sharp for ever.
const INFINITE: f32 = 10.0;

/// What OpenSubdiv says about the limits of the vertices of the last refinement.
#[derive(Clone, Debug)]
pub struct Limits {
    /// Position of each vertex.
    pub positions: Vec<Point3<f64>>,
    /// Two tangents of each vertex, whose cross product points to the outside.
    pub tangents: Vec<[Vector3<f64>; 2]>,
    /// The neighbour along the first edge of each vertex: the tangents of a corner belong to the
    /// face after it.
    pub first_neighbours: Vec<u32>,
    /// The neighbour along the first sharp edge of each vertex, or the vertex: the tangents of a
    /// crease belong to the faces after it.
    pub sharp_neighbours: Vec<u32>,
}

/// Returns the vertices of each of so many refinements without sharpness by OpenMesh.
///
/// # Panics
/// If OpenMesh has other vertices than this project.
#[must_use]
pub fn openmesh_catmull_clark(mesh: &PolygonMesh, levels: u32) -> Vec<Vec<Point3<f64>>> {
    let sharpness = Sharpness::smooth(mesh.topology(), Rules::default());
    let control = control(mesh, &sharpness, Rules::default(), levels);
    let refined = bindings::openmesh_catmull_clark(&control);
    positions_of(mesh.topology(), &refined).0
}

/// Returns the vertices of each of so many refinements by OpenSubdiv, and the limits of the last.
///
/// # Panics
/// If OpenSubdiv has other vertices than this project.
#[must_use]
pub fn opensubdiv(
    mesh: &PolygonMesh,
    sharpness: &Sharpness,
    rules: Rules,
    levels: u32,
) -> (Vec<Vec<Point3<f64>>>, Limits) {
    let control = control(mesh, sharpness, rules, levels);
    let refined = bindings::opensubdiv_refine(&control).expect("OpenSubdiv takes the mesh");
    let (positions, numbers) = positions_of(mesh.topology(), &refined.levels);
    let own = |vertices: &[u32]| {
        let own: Vec<u32> = vertices.iter().map(|&v| numbers.own[v as usize]).collect();
        numbers.arranged(&own)
    };
    let tangents = |flat: &[f64]| numbers.arranged(&vectors(flat));
    let [first, second] = [
        tangents(&refined.limits.first_tangents),
        tangents(&refined.limits.second_tangents),
    ];
    let pairs = first.iter().zip(second).map(|(&a, b)| [a, b]);
    let limits = Limits {
        positions: numbers.arranged(&points(&refined.limits.positions)),
        tangents: pairs.collect(),
        first_neighbours: own(&refined.limits.first_neighbours),
        sharp_neighbours: own(&refined.limits.sharp_neighbours),
    };
    (positions, limits)
}

pub(crate) fn control(
    mesh: &PolygonMesh,
    sharpness: &Sharpness,
    rules: Rules,
    levels: u32,
) -> Control {
    let topology = mesh.topology();
    let sharp = |s: f64| {
        if s.is_infinite() { INFINITE } else { s as f32 }
    };
    let mut control = Control {
        positions: flat(mesh.positions()),
        chaikin: rules.creases == CreaseRule::Chaikin,
        sharp_corners: rules.corners == BoundaryCorners::Sharp,
        levels,
        ..Control::default()
    };
    for face in topology.faces() {
        control.sizes.push(face.len() as i32);
        control.corners.extend(face.iter().map(|&v| v as i32));
    }
    for edge in 0..topology.edge_count() as u32 {
        // OpenSubdiv finds the boundary by itself.
        if sharpness.edge(edge) > 0.0 && !topology.is_boundary_edge(edge) {
            let ends = topology.edge_vertices(edge).map(|v| v as i32);
            control.crease_ends.extend(ends);
            control.crease_sharpness.push(sharp(sharpness.edge(edge)));
        }
    }
    for vertex in 0..topology.vertex_count() as u32 {
        let alone = topology.is_boundary_vertex(vertex) && topology.outgoing(vertex).count() == 1;
        if sharpness.vertex(vertex) > 0.0 && !(alone && control.sharp_corners) {
            control.corner_vertices.push(vertex as i32);
            let sharpness = sharp(sharpness.vertex(vertex));
            control.corner_sharpness.push(sharpness);
        }
    }
    control
}

/// Returns the vertices of every refinement in our order, and the numbers of the last one.
fn positions_of(
    topology: &PolygonTopology,
    levels: &[PolygonLevel],
) -> (Vec<Vec<Point3<f64>>>, Numbers) {
    let mut numbers = Numbers {
        own: (0..topology.vertex_count() as u32).collect(),
    };
    let mut topology = topology.clone();
    let mut all = Vec::new();
    for level in levels {
        numbers = numbers.of_refinement(&topology, level);
        topology = topology.cut_into_quads();
        all.push(numbers.arranged(&points(&level.positions)));
    }
    (all, numbers)
}

/// Our number of each of a library's vertices.
struct Numbers {
    own: Vec<u32>,
}

impl Numbers {
    /// Returns the numbers after a refinement of a mesh.
    fn of_refinement(&self, topology: &PolygonTopology, level: &PolygonLevel) -> Self {
        let (vertices, edges) = (topology.vertex_count() as u32, topology.edge_count() as u32);
        let sorted = |face: &[u32]| {
            let mut corners = face.to_vec();
            corners.sort_unstable();
            corners
        };
        let faces: BTreeMap<Vec<u32>, u32> = topology.faces().map(sorted).zip(0..).collect();
        let mut start = 0;
        let number = |&end: &usize| {
            let origin = &level.origins[std::mem::replace(&mut start, end)..end];
            let origin: Vec<u32> = origin.iter().map(|&v| self.own[v as usize]).collect();
            match origin[..] {
                [vertex] => vertex,
                [a, b] => vertices + topology.edge_between(a, b).expect("the same edges"),
                _ => vertices + edges + faces[&sorted(&origin)],
            }
        };
        Self {
            own: level.origin_ends.iter().map(number).collect(),
        }
    }

    /// Returns what belongs to the library's vertices in our order.
    fn arranged<T: Clone>(&self, theirs: &[T]) -> Vec<T> {
        let mut places = vec![usize::MAX; theirs.len()];
        for (place, &own) in self.own.iter().enumerate() {
            places[own as usize] = place;
        }
        places.iter().map(|&place| theirs[place].clone()).collect()
    }
}

fn vectors(flat: &[f64]) -> Vec<Vector3<f64>> {
    let (vectors, _) = flat.as_chunks::<3>();
    vectors.iter().map(|&v| Vector3::from(v)).collect()
}

fn points(flat: &[f64]) -> Vec<Point3<f64>> {
    vectors(flat).into_iter().map(Point3::from).collect()
}
