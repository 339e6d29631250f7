//! Poles of surfaces: those that are given, those at protrusions, those that a surface needs, and what is
//! said of ends that were chosen.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use msplines_common::mesh::{Facts, TriangleMesh};
use msplines_common::progress::Observer;
use msplines_conformal::poles::{ProtrusionOptions, Protrusions};
use msplines_t_spline::Domain;
use msplines_t_spline::domain::DomainError;

use crate::case::{NamedPuncture, Puncture};
use crate::error::{RunError, TSplineError};

/// Poles that are asked for.
pub(super) struct Wanted {
    pub(super) vertices: Vec<u32>,
    /// How they were found; nothing if they were given.
    found: Option<&'static str>,
}

impl Wanted {
    /// Returns the poles that are given or found at protrusions; where none are asked for, as many as a
    /// closed surface needs, far from each other along edges. Those of surfaces with boundary are chosen
    /// with their cylinders.
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
        let (vertices, found) = match (facts.genus, facts.boundary_loops, automatic) {
            (_, 0, Some(options)) => {
                let found = Protrusions::of(mesh, &options, observer);
                let found = found.map_err(DomainError::from);
                let found = found.map_err(TSplineError::from)?;
                (found.vertices, "found at protrusions")
            }
            (Some(0), 0, None) => {
                // The end of a longest path: twice there and back, as in a tree.
                let first = farthest(mesh, &[0]);
                (vec![farthest(mesh, &[first]), first], FAR)
            }
            _ => (Vec::new(), FAR),
        };
        let found = Some(found);
        Ok(Self { vertices, found })
    }

    fn given(mesh: &TriangleMesh, given: &[u32]) -> Result<Self, RunError> {
        let vertices = mesh.vertex_count();
        match given.iter().find(|&&v| v as usize >= vertices) {
            Some(&vertex) => Err(TSplineError::NoSuchVertex { vertex, vertices }.into()),
            None => Ok(Self {
                vertices: given.to_vec(),
                found: None,
            }),
        }
    }
}

/// What is said of poles that nobody named.
const FAR: &str = "chosen, far from each other and from boundaries";

/// Poles of a surface.
pub(super) struct Poles {
    pub(super) vertices: Vec<u32>,
    /// What is to be said of them.
    pub(super) warnings: Vec<String>,
}

impl Poles {
    /// Returns the poles of a domain, and says which were not named and how many holes were closed.
    pub(super) fn of(domain: &Domain, wanted: &Wanted) -> Self {
        let vertices: Vec<u32> = domain.poles().iter().map(|pole| pole.vertex).collect();
        let mut warnings = Vec::new();
        let is_named = |vertex: &&u32| wanted.found.is_none() && wanted.vertices.contains(vertex);
        let chosen = vertices.iter().filter(|vertex| !is_named(vertex));
        let listed: Vec<String> = chosen.map(u32::to_string).collect();
        if !listed.is_empty() {
            warnings.push(format!(
                "poles: vertices {} were {}; choose others with --puncture",
                listed.join(","),
                wanted.found.unwrap_or(FAR)
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

    fn wanted(mesh: &TriangleMesh, given: &Puncture) -> Result<Wanted, RunError> {
        Wanted::of(mesh, given, &mut unobserved())
    }

    fn poles(mesh: &TriangleMesh, wanted: &Wanted) -> Poles {
        let options = DomainOptions {
            poles: wanted.vertices.clone(),
            ..DomainOptions::default()
        };
        let domain = Domain::of_surface(mesh, &options, &mut unobserved());
        Poles::of(&domain.expect("a domain"), wanted)
    }

    #[test]
    fn poles_of_a_sphere_are_opposite_and_other_surfaces_are_left_alone() {
        let needed = Puncture::default();
        let sphere = shapes::sphere(400);
        let found = wanted(&sphere, &needed).expect("vertices").vertices;
        let [a, b] = [0, 1].map(|i| sphere.positions()[found[i] as usize].coords.normalize());
        // Along edges some detours are shorter than others.
        assert!(found.len() == 2 && a.dot(&b) < -0.8, "{a} {b}");
        for other in [shapes::torus(1.0, 0.4, 400), shapes::height_field(225)] {
            let none = wanted(&other, &needed).expect("none");
            assert!(none.vertices.is_empty());
        }
        let missing = Puncture::Vertices(vec![4000]);
        assert!(wanted(&sphere, &missing).is_err());
    }

    #[test]
    fn what_nobody_named_is_said() {
        let auto = Puncture::Named(NamedPuncture::Auto);
        let torus = shapes::torus(1.0, 0.4, 400);
        let asked = wanted(&torus, &auto).expect("some");
        assert!(asked.vertices.len() >= 2);
        assert!(poles(&torus, &asked).warnings[0].contains("protrusions"));
        let sheet = shapes::height_field(225);
        let chosen = poles(&sheet, &wanted(&sheet, &auto).expect("none"));
        assert_eq!(chosen.vertices.len(), 1);
        assert!(chosen.warnings[0].contains("--puncture"));
        let named = wanted(&sheet, &Puncture::Vertices(chosen.vertices)).expect("given");
        assert!(poles(&sheet, &named).warnings.is_empty());
    }
}
