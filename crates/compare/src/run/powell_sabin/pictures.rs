//! What pictures of a Powell-Sabin spline show beside it.

use msplines_common::mesh::{TriangleMesh, VertexAttribute};
use msplines_common::{Point3, Vector3};
use msplines_powell_sabin::{PowellSabinSurface, Tessellation};

use crate::run::Companion;

/// Returns the components of exact normals, as pictures shade by them.
pub(super) fn normals(normals: &[Vector3<f64>]) -> Vec<VertexAttribute> {
    let component = |(name, axis): (&str, usize)| VertexAttribute {
        name: name.to_owned(),
        values: normals.iter().map(|n| n[axis]).collect(),
    };
    let named = crate::output::NORMALS.into_iter().zip(0..);
    named.map(component).collect()
}

/// Returns the domain, the control triangles, and the edges of the domain on the tessellated surface.
pub(super) fn companions(spline: &PowellSabinSurface, shown: &Tessellation) -> Vec<Companion> {
    let triangles = spline.control_triangles();
    let faces = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    let mesh = TriangleMesh::build(triangles.concat(), faces.collect());
    let control = Companion {
        mesh: mesh.ok(),
        ..Companion::bare("control")
    };
    let domain = Companion {
        mesh: Some(spline.mesh().clone()),
        edges: msplines_picture::edges(spline.mesh().faces()),
        ..Companion::bare("input")
    };
    let curves = Companion {
        edges: edges_on_surface(shown),
        ..Companion::bare("spline")
    };
    vec![domain, control, curves]
}

/// Marks the outline of some faces of the domain.
pub(super) fn add_molecule(companions: &mut [Companion], outline: Vec<[u32; 2]>) {
    if let Some(domain) = companions.iter_mut().find(|c| c.name == "input") {
        domain.creases = outline;
    }
}

/// Returns the domain with every face split into six; the edges of the domain are the sharp ones.
pub(super) fn refinement(spline: &PowellSabinSurface) -> Companion {
    let domain = spline.flat_domain();
    let mesh = domain.mesh();
    let mut positions: Vec<Point3<f64>> = Vec::new();
    let (mut faces, mut edges, mut creases) = (Vec::new(), Vec::new(), Vec::new());
    for (face, vertices) in mesh.faces().iter().enumerate() {
        let triangle = domain.macro_triangle(face as u32);
        let corners = vertices.map(|v| mesh.positions()[v as usize].coords);
        for micro in 0..6 {
            let first = positions.len() as u32;
            let place = |at: [f64; 3]| {
                let sum = corners
                    .iter()
                    .zip(at)
                    .map(|(corner, weight)| corner * weight);
                Point3::from(sum.sum::<Vector3<f64>>())
            };
            positions.extend(triangle.micro_corners(micro).map(place));
            faces.push([first, first + 1, first + 2]);
            edges.extend([[first, first + 2], [first + 1, first + 2]]);
            creases.push([first, first + 1]);
        }
    }
    Companion {
        mesh: TriangleMesh::build(positions, faces).ok(),
        edges,
        creases,
        ..Companion::bare("refinement")
    }
}

/// The images of the edges of the domain, as pairs of points of a tessellation.
pub(super) fn edges_on_surface(tessellation: &Tessellation) -> Vec<[u32; 2]> {
    let zeros = |i: u32| tessellation.points[i as usize].at.map(|x| x == 0.0);
    let on_edge = |a: u32, b: u32| {
        let count = |i: u32| zeros(i).into_iter().filter(|&zero| zero).count();
        match [count(a), count(b)] {
            // Two points inside of sides: of the same side.
            [1, 1] => {
                let same = |i: u32| (tessellation.points[i as usize].face, zeros(i));
                same(a) == same(b)
            }
            // A corner is joined to points of its own sides and to no others.
            [one, other] => one > 0 && other > 0,
        }
    };
    let mut pairs: Vec<[u32; 2]> = Vec::new();
    for &[a, b, c] in &tessellation.faces {
        let sides = [[a, b], [b, c], [c, a]];
        pairs.extend(
            sides
                .into_iter()
                .filter(|&[from, to]| from < to && on_edge(from, to)),
        );
    }
    pairs
}
