//! What pictures of a Powell-Sabin spline show beside it.

use msplines_common::mesh::TriangleMesh;
use msplines_powell_sabin::PowellSabinSurface;

use crate::run::Companion;

/// Returns the control triangles, and the edges of the domain on the surface.
pub(super) fn companions(spline: &PowellSabinSurface) -> Vec<Companion> {
    let triangles = spline.control_triangles();
    let faces = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    let mesh = TriangleMesh::build(triangles.concat(), faces.collect());
    let control = Companion {
        name: "control",
        mesh: mesh.ok(),
        edges: Vec::new(),
        creases: Vec::new(),
        fields: Vec::new(),
    };
    let curves = Companion {
        name: "curves",
        mesh: None,
        edges: edges_on_surface(spline, super::SHOWN_SEGMENTS),
        creases: Vec::new(),
        fields: Vec::new(),
    };
    vec![control, curves]
}

/// The images of the edges of the domain, as pairs of points of a tessellation.
fn edges_on_surface(spline: &PowellSabinSurface, segments: u32) -> Vec<[u32; 2]> {
    let tessellation = spline.tessellate(segments);
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
