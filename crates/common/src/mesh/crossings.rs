//! Pairs of faces that pass through each other, decided exactly.

use nalgebra::Point3;
use rayon::prelude::*;

use super::tet::{Orientation, orientation};
use super::triangle::TriangleMesh;

/// Faces whose boxes one task compares.
const CHUNK: usize = 512;

/// A face with its box.
#[derive(Clone, Copy, Debug)]
struct Boxed {
    face: u32,
    low: Point3<f64>,
    high: Point3<f64>,
}

/// Returns the pairs of faces of which an edge of one passes through the inside of the other, ascending.
///
/// Decided exactly for the coordinates as they are; faces that only touch, or overlap in one plane, do not
/// count. Cost: boxes are sorted along the longest side of the mesh and compared while they overlap there:
/// O(n log n) plus the overlaps, about n^1.5 for scans.
///
/// # Reference
/// [Shewchuk1997] §4.3.
#[must_use]
pub fn self_crossings(mesh: &TriangleMesh) -> Vec<[u32; 2]> {
    let [low, high] = mesh.bounding_box();
    let axis = (high - low).imax();
    let mut boxes: Vec<Boxed> = (0..mesh.face_count() as u32)
        .map(|face| {
            let [a, b, c] = mesh.triangle(face);
            Boxed {
                face,
                low: a.inf(&b).inf(&c),
                high: a.sup(&b).sup(&c),
            }
        })
        .collect();
    boxes.sort_by(|a, b| {
        a.low[axis]
            .total_cmp(&b.low[axis])
            .then(a.face.cmp(&b.face))
    });
    let starts: Vec<usize> = (0..boxes.len()).step_by(CHUNK).collect();
    let found: Vec<Vec<[u32; 2]>> = starts
        .into_par_iter()
        .map(|start| {
            let mut pairs = Vec::new();
            for at in start..boxes.len().min(start + CHUNK) {
                let first = boxes[at];
                let rest = boxes[at + 1..].iter();
                let near = rest.take_while(|other| other.low[axis] <= first.high[axis]);
                for other in near.filter(|other| overlap(&first, other)) {
                    if cross(mesh, first.face, other.face) {
                        let (a, b) = (first.face, other.face);
                        pairs.push([a.min(b), a.max(b)]);
                    }
                }
            }
            pairs
        })
        .collect();
    let mut pairs = found.concat();
    pairs.sort_unstable();
    pairs
}

fn overlap(a: &Boxed, b: &Boxed) -> bool {
    (0..3).all(|d| a.low[d] <= b.high[d] && b.low[d] <= a.high[d])
}

/// Whether an edge of one face passes through the other; faces with a common edge never do.
fn cross(mesh: &TriangleMesh, first: u32, second: u32) -> bool {
    let [a, b] = [first, second].map(|face| mesh.faces()[face as usize]);
    let shared = a.iter().filter(|v| b.contains(v)).count();
    shared < 2 && (passes(mesh, a, b) || passes(mesh, b, a))
}

/// Whether an edge of `edges` passes through the inside of `face`. Edges at common vertices only touch.
fn passes(mesh: &TriangleMesh, edges: [u32; 3], face: [u32; 3]) -> bool {
    let point = |v: u32| mesh.positions()[v as usize];
    let [a, b, c] = face.map(point);
    (0..3).any(|side| {
        let ends = [edges[side], edges[(side + 1) % 3]];
        if ends.iter().any(|v| face.contains(v)) {
            return false;
        }
        let [p, q] = ends.map(point);
        let sides = [p, q].map(|end| orientation(&[a, b, c, end]));
        if sides.contains(&Orientation::Flat) || sides[0] == sides[1] {
            return false;
        }
        let around = [[a, b], [b, c], [c, a]].map(|[from, to]| orientation(&[p, q, from, to]));
        around[0] != Orientation::Flat && around[0] == around[1] && around[1] == around[2]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;

    #[test]
    fn clean_surfaces_have_none() {
        for mesh in [
            shapes::sphere(500),
            shapes::torus(1.0, 0.3, 600),
            shapes::cube(4),
        ] {
            assert_eq!(self_crossings(&mesh), Vec::<[u32; 2]>::new());
        }
    }

    #[test]
    fn a_vertex_pushed_through_the_other_side_is_found() {
        let sphere = shapes::sphere(200);
        let mut positions = sphere.positions().to_vec();
        positions[0] = Point3::from(positions[0].coords * -1.5);
        let crossings = self_crossings(&sphere.with_positions(positions));
        let around: Vec<u32> = sphere.topology().outgoing(0).map(|h| h / 3).collect();
        assert!(crossings.len() >= around.len(), "{crossings:?}");
        let with = |pair: &[u32; 2]| around.contains(&pair[0]) || around.contains(&pair[1]);
        assert!(crossings.iter().all(with), "{crossings:?}");
    }

    #[test]
    fn two_tetrahedra_cross_as_often_as_every_pair_says() {
        // All pairs by the definition, without boxes.
        let tetrahedron = |shift: f64| {
            [
                [0.0, 0.0, 0.0],
                [1.0, 0.0, 0.0],
                [0.0, 1.0, 0.0],
                [0.0, 0.0, 1.0],
            ]
            .map(|[x, y, z]| Point3::new(x + shift, y + 0.7 * shift, z + 0.4 * shift))
        };
        let positions = [tetrahedron(0.0), tetrahedron(0.1)].concat();
        let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
        let faces = [faces, faces.map(|face| face.map(|v| v + 4))].concat();
        let mesh = TriangleMesh::build(positions, faces).expect("two surfaces");
        let mut pairs = Vec::new();
        for a in 0..8 {
            pairs.extend((a + 1..8).filter(|&b| cross(&mesh, a, b)).map(|b| [a, b]));
        }
        assert!(!pairs.is_empty());
        assert_eq!(self_crossings(&mesh), pairs);
    }
}
