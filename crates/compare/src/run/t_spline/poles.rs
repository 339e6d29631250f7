//! Poles of closed surfaces that need some and are given none, and what is said of ends that were chosen.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use msplines_common::mesh::{Facts, TriangleMesh};
use msplines_t_spline::Domain;

use crate::error::{RunError, TSplineError};

/// Poles of a surface.
pub(super) struct Poles {
    pub(super) vertices: Vec<u32>,
    /// What is to be said of them.
    pub(super) warnings: Vec<String>,
}

impl Poles {
    /// Returns the poles that are given; where none are, as many as a closed surface needs, far from each
    /// other along edges. Those of surfaces with boundary are chosen with their cylinders.
    ///
    /// # Errors
    /// A vertex that the mesh does not have.
    pub(super) fn wanted(mesh: &TriangleMesh, given: &[u32]) -> Result<Vec<u32>, RunError> {
        let vertices = mesh.vertex_count();
        if let Some(&vertex) = given.iter().find(|&&v| v as usize >= vertices) {
            return Err(TSplineError::NoSuchVertex { vertex, vertices }.into());
        }
        let facts = Facts::measure(mesh);
        if !given.is_empty() || (facts.genus, facts.boundary_loops) != (Some(0), 0) {
            return Ok(given.to_vec());
        }
        // The end of a longest path: twice there and back, as in a tree.
        let first = farthest(mesh, &[0]);
        Ok(vec![farthest(mesh, &[first]), first])
    }

    /// Returns the poles of a domain, and says which were chosen and how many holes were closed.
    pub(super) fn of(domain: &Domain, given: &[u32]) -> Self {
        let vertices: Vec<u32> = domain.poles().iter().map(|pole| pole.vertex).collect();
        let mut warnings = Vec::new();
        let chosen = vertices.iter().filter(|vertex| !given.contains(vertex));
        let listed: Vec<String> = chosen.map(u32::to_string).collect();
        if !listed.is_empty() {
            warnings.push(format!(
                "the surface needs poles: vertices {} were chosen, far from each other and from boundaries; choose with --puncture",
                listed.join(",")
            ));
        }
        let holes = domain.report().closed_holes;
        if holes > 0 {
            warnings.push(format!(
                "{holes} boundary loops are no ends of cylinders: the spline goes on over their holes, which files of triangles leave open"
            ));
        }
        Self { vertices, warnings }
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
    use msplines_t_spline::DomainOptions;

    use super::*;

    #[test]
    fn poles_of_a_sphere_are_opposite_and_other_surfaces_are_left_alone() {
        let sphere = shapes::sphere(400);
        let poles = Poles::wanted(&sphere, &[]).expect("vertices");
        let [a, b] = [0, 1].map(|i| sphere.positions()[poles[i] as usize].coords.normalize());
        // Along edges some detours are shorter than others.
        assert!(a.dot(&b) < -0.8, "{a} {b}");
        for other in [shapes::torus(1.0, 0.4, 400), shapes::height_field(225)] {
            assert!(Poles::wanted(&other, &[]).expect("none").is_empty());
        }
        assert!(Poles::wanted(&sphere, &[4000]).is_err());
    }

    #[test]
    fn what_was_chosen_for_an_open_surface_is_said() {
        let mesh = shapes::height_field(225);
        let options = DomainOptions::default();
        let domain = Domain::of_surface(&mesh, &options, &mut unobserved()).expect("a domain");
        let poles = Poles::of(&domain, &[]);
        assert_eq!(poles.vertices.len(), 1);
        assert!(poles.warnings[0].contains("--puncture"));
        assert!(Poles::of(&domain, &poles.vertices).warnings.is_empty());
    }
}
