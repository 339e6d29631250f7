//! Poles of surfaces: those that are given, those at protrusions, and those that a surface needs.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use msplines_common::mesh::{Facts, TriangleMesh};
use msplines_common::progress::Observer;
use msplines_conformal::poles::{ProtrusionOptions, Protrusions};
use msplines_t_spline::domain::DomainError;

use crate::case::{NamedPuncture, Puncture};
use crate::error::{RunError, TSplineError};

/// Poles of a surface.
pub(super) struct Poles {
    pub(super) vertices: Vec<u32>,
    /// What is to be said of them.
    pub(super) warning: Option<String>,
}

impl Poles {
    /// Returns the poles that are given or found at protrusions; where none are asked for, as many as the
    /// surface needs, far from each other and from the boundary along edges.
    ///
    /// # Errors
    /// A vertex that the mesh does not have; a surface of several parts; the observer asks to stop.
    pub(super) fn of(
        mesh: &TriangleMesh,
        given: &Puncture,
        observer: &mut Observer<'_>,
    ) -> Result<Self, RunError> {
        let facts = Facts::measure(mesh);
        let automatic = match given {
            Puncture::Vertices(given) if !given.is_empty() => return Self::given(mesh, given),
            Puncture::Vertices(_) | Puncture::Named(NamedPuncture::Needed) => None,
            Puncture::Named(NamedPuncture::Auto) => Some(ProtrusionOptions::default()),
            Puncture::Protrusions(options) => Some(*options),
        };
        let (chosen, said) = match (facts.genus, facts.boundary_loops, automatic) {
            (_, 0, Some(options)) => {
                let found = Protrusions::of(mesh, &options, observer);
                let found = found.map_err(DomainError::from);
                let found = found.map_err(TSplineError::from)?;
                (found.vertices, "found at protrusions")
            }
            (Some(0), 0, None) => {
                // The end of a longest path: twice there and back, as in a tree.
                let first = farthest(mesh, &[0]);
                let chosen = vec![farthest(mesh, &[first]), first];
                (chosen, "chosen, far from each other")
            }
            (_, 1, _) => {
                let boundary = mesh.topology().boundary_loops().concat();
                let rim: Vec<u32> = boundary
                    .iter()
                    .map(|&h| mesh.topology().origin(h))
                    .collect();
                (vec![farthest(mesh, &rim)], "chosen, far from the boundary")
            }
            _ => (Vec::new(), ""),
        };
        let listed: Vec<String> = chosen.iter().map(u32::to_string).collect();
        let warning = (!chosen.is_empty()).then(|| {
            let listed = listed.join(",");
            format!("poles: vertices {listed} were {said}; choose others with --puncture")
        });
        Ok(Self {
            vertices: chosen,
            warning,
        })
    }

    fn given(mesh: &TriangleMesh, given: &[u32]) -> Result<Self, RunError> {
        let vertices = mesh.vertex_count();
        match given.iter().find(|&&v| v as usize >= vertices) {
            Some(&vertex) => Err(TSplineError::NoSuchVertex { vertex, vertices }.into()),
            None => Ok(Self {
                vertices: given.to_vec(),
                warning: None,
            }),
        }
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
    use msplines_common::progress::unobserved;

    use super::*;

    fn poles(mesh: &TriangleMesh, given: &Puncture) -> Result<Poles, RunError> {
        Poles::of(mesh, given, &mut unobserved())
    }

    #[test]
    fn poles_of_a_sphere_are_opposite_and_tori_need_none() {
        let needed = Puncture::default();
        let sphere = shapes::sphere(400);
        let found = poles(&sphere, &needed).expect("vertices").vertices;
        let [a, b] = [0, 1].map(|i| sphere.positions()[found[i] as usize].coords.normalize());
        // Along edges some detours are shorter than others.
        assert!(found.len() == 2 && a.dot(&b) < -0.8, "{a} {b}");
        let torus = shapes::torus(1.0, 0.4, 400);
        assert!(poles(&torus, &needed).expect("none").vertices.is_empty());
        let auto = Puncture::Named(NamedPuncture::Auto);
        let asked = poles(&torus, &auto).expect("some");
        assert!(asked.vertices.len() >= 2);
        assert!(asked.warning.expect("said").contains("protrusions"));
        let sheet = poles(&shapes::height_field(225), &auto).expect("one");
        assert_eq!(sheet.vertices.len(), 1);
        assert!(sheet.warning.expect("said").contains("--puncture"));
        let missing = Puncture::Vertices(vec![4000]);
        assert!(poles(&sphere, &missing).is_err());
    }
}
