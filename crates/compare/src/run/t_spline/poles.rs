//! Poles of surfaces that need some and are given none.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use msplines_common::mesh::{Facts, TriangleMesh};

use crate::error::{RunError, TSplineError};

/// Poles of a surface.
pub(super) struct Poles {
    pub(super) vertices: Vec<u32>,
    /// What is to be said of them.
    pub(super) warning: Option<String>,
}

impl Poles {
    /// Returns the poles that are given; where none are, as many as the surface needs, far from each other
    /// and from the boundary along edges.
    ///
    /// # Errors
    /// A vertex that the mesh does not have.
    pub(super) fn of(mesh: &TriangleMesh, given: &[u32]) -> Result<Self, RunError> {
        let vertices = mesh.vertex_count();
        if let Some(&vertex) = given.iter().find(|&&v| v as usize >= vertices) {
            return Err(TSplineError::NoSuchVertex { vertex, vertices }.into());
        }
        let facts = Facts::measure(mesh);
        let chosen = match (facts.genus, facts.boundary_loops) {
            _ if !given.is_empty() => {
                return Ok(Self {
                    vertices: given.to_vec(),
                    warning: None,
                });
            }
            (Some(0), 0) => {
                // The end of a longest path: twice there and back, as in a tree.
                let first = farthest(mesh, &[0]);
                vec![farthest(mesh, &[first]), first]
            }
            (_, 1) => {
                let boundary = mesh.topology().boundary_loops().concat();
                let rim: Vec<u32> = boundary
                    .iter()
                    .map(|&h| mesh.topology().origin(h))
                    .collect();
                vec![farthest(mesh, &rim)]
            }
            _ => Vec::new(),
        };
        let listed: Vec<String> = chosen.iter().map(u32::to_string).collect();
        let warning = (!chosen.is_empty()).then(|| {
            format!(
                "the surface needs poles: vertices {} were chosen, far from each other and from boundaries; choose with --puncture",
                listed.join(",")
            )
        });
        Ok(Self {
            vertices: chosen,
            warning,
        })
    }
}

/// Returns the vertex farthest from others along edges, the first of several. O(n log n).
fn farthest(mesh: &TriangleMesh, from: &[u32]) -> u32 {
    let at = mesh.positions();
    let mut neighbours = vec![Vec::new(); mesh.vertex_count()];
    for face in mesh.faces() {
        for i in 0..3 {
            let (a, b) = (face[i], face[(i + 1) % 3]);
            neighbours[a as usize].push(b);
            neighbours[b as usize].push(a);
        }
    }
    let mut distances = vec![f64::INFINITY; mesh.vertex_count()];
    from.iter().for_each(|&v| distances[v as usize] = 0.0);
    // Bits of numbers that are not negative are in their order.
    let mut queue: BinaryHeap<Reverse<(u64, u32)>> =
        from.iter().map(|&v| Reverse((0, v))).collect();
    while let Some(Reverse((bits, vertex))) = queue.pop() {
        let here = f64::from_bits(bits);
        if here > distances[vertex as usize] {
            continue;
        }
        for &next in &neighbours[vertex as usize] {
            let there = here + (at[next as usize] - at[vertex as usize]).norm();
            if there < distances[next as usize] {
                distances[next as usize] = there;
                queue.push(Reverse((there.to_bits(), next)));
            }
        }
    }
    let reached = (0..).zip(&distances).filter(|(_, d)| d.is_finite());
    reached
        .fold(
            (0, -1.0),
            |best, (v, &d)| if d > best.1 { (v, d) } else { best },
        )
        .0
}

#[cfg(test)]
mod tests {
    use msplines_common::mesh::shapes;

    use super::*;

    #[test]
    fn poles_of_a_sphere_are_opposite_and_tori_need_none() {
        let sphere = shapes::sphere(400);
        let poles = Poles::of(&sphere, &[]).expect("vertices").vertices;
        let [a, b] = [0, 1].map(|i| sphere.positions()[poles[i] as usize].coords.normalize());
        // Along edges some detours are shorter than others.
        assert!(a.dot(&b) < -0.8, "{a} {b}");
        assert!(
            Poles::of(&shapes::torus(1.0, 0.4, 400), &[])
                .expect("none")
                .vertices
                .is_empty()
        );
        let sheet = Poles::of(&shapes::height_field(225), &[]).expect("one");
        assert_eq!(sheet.vertices.len(), 1);
        assert!(sheet.warning.expect("said").contains("--puncture"));
        assert!(Poles::of(&sphere, &[4000]).is_err());
    }
}
