//! Points of a surface that a T-spline is fitted to.
//!
//! Vertices alone leave a spline free between them: on large facets of a coarse mesh, and wherever a
//! T-mesh becomes finer than the mesh. Faces that are large for the number of control points are
//! sampled inside too.
//!
//! # Notation
//! `A` the area of the surface, `n` the number of samples it should have, `h = √(A / n)` their spacing. A
//! face whose longest side is `e` gets `m²` points, the centres of equal parts, `m = ⌊e / (1.5 h)⌋`. In a
//! regular mesh of `n` vertices `e = 1.07 h`, so that none is added to it.

use msplines_common::Point3;
use msplines_common::mesh::{SurfacePoint, TriangleMesh};
use msplines_common::metrics::SurfaceTree;
use rayon::prelude::*;

use crate::domain::Domain;
use crate::fit::{FitError, Sample, Sampling, Stop};

/// Weight of a vertex at a zero, which cannot move to where the surface would be nearer: the others
/// around it can, and follow. With 1 it is where bunny_30k is met worst (0.64 % instead of 0.45 %); 5 and
/// 100 do as well.
const AT_ZERO: f64 = 20.0;

/// Weight of a vertex at the boundary, which has neighbours on one side only: on scans it takes a twentieth to
/// three fifths off the errors there, and leaves those elsewhere.
const AT_BOUNDARY: f64 = 4.0;

/// Weight of what lies between vertices, beside theirs.
const IN_FACES: f64 = 0.25;

/// Sides longer than this many spacings have points between their ends.
const LONG: f64 = 1.5;

/// Most points along the side of a face.
const MOST: f64 = 32.0;

impl Sampling {
    /// Most samples per control point.
    pub const MOST_PER_CONTROL_POINT: f64 = 1000.0;

    /// Refuses what is no number of samples.
    ///
    /// # Errors
    /// A number that is not finite or out of its range.
    pub fn check(&self) -> Result<(), FitError> {
        let (given, most) = (self.per_control_point, Self::MOST_PER_CONTROL_POINT);
        if (0.0..=most).contains(&given) {
            return Ok(());
        }
        Err(FitError::Sampling { given, most })
    }

    /// Returns what a spline over a domain is fitted to: the vertices of [`Domain::mesh`] by number, then the
    /// poles, then points inside of faces.
    ///
    /// `surface` is the mesh that the domain was made of; edges may have been flipped since. Vertices that
    /// were added count as points of faces, at which errors are not measured. Vertices at boundaries weigh
    /// more, those at zeros too and stay where they are, as poles do; nothing in closed holes counts. Points
    /// inside of faces are put onto `surface` and weigh a quarter of what the vertices of a part as large do.
    /// O(n log n).
    ///
    /// # Errors
    /// A number that is not finite or out of its range.
    ///
    /// # Panics
    /// If `surface` does not have the vertices that are poles of the domain: those of its own mesh are.
    pub fn samples(
        &self,
        domain: &Domain,
        surface: &TriangleMesh,
        stop: Stop,
    ) -> Result<Vec<Sample>, FitError> {
        self.check()?;
        let mut samples = vertices(domain);
        samples.extend(domain.poles().iter().map(|pole| Sample {
            movable: false,
            ..Sample::vertex(pole.at, surface.positions()[pole.vertex as usize])
        }));
        if self.per_control_point > 0.0 {
            let wanted = match stop {
                Stop::ControlPoints(most) => (self.per_control_point * most as f64) as usize,
                Stop::Tolerance(_) => 0,
            };
            samples.extend(in_faces(domain, surface, wanted));
        }
        Ok(samples)
    }
}

fn vertices(domain: &Domain) -> Vec<Sample> {
    let positions = domain.mesh().positions().iter().enumerate();
    let mut samples: Vec<Sample> = positions
        .map(|(v, &position)| Sample {
            measured: domain.origins()[v].is_some(),
            ..Sample::vertex(domain.vertex(v as u32), position)
        })
        .collect();
    for vertex in domain.boundary_vertices() {
        samples[vertex as usize].weight = AT_BOUNDARY;
    }
    for zero in domain.zeros() {
        let sample = &mut samples[zero.vertex as usize];
        sample.movable = false;
        sample.weight = AT_ZERO;
    }
    for (sample, own) in samples.iter_mut().zip(domain.vertices_on_surface()) {
        if !own {
            (sample.weight, sample.movable) = (0.0, false);
        }
    }
    samples
}

/// Points inside of faces that are too large for `wanted` samples, or as many as there are vertices, to be as
/// dense everywhere; none in closed holes.
fn in_faces(domain: &Domain, surface: &TriangleMesh, wanted: usize) -> Vec<Sample> {
    let mesh = domain.mesh();
    let areas: Vec<f64> = (0..mesh.face_count() as u32)
        .map(|face| area_of(mesh, face))
        .collect();
    let area: f64 = areas.iter().sum();
    let vertices = mesh.vertex_count();
    let spacing = (area / wanted.max(vertices) as f64).sqrt();
    let per_vertex = area / vertices as f64;
    let parts = |face: u32| {
        if domain.outside().binary_search(&face).is_ok() {
            return 0;
        }
        let corners = mesh.triangle(face);
        let side = |i: usize| (corners[(i + 1) % 3] - corners[i]).norm();
        let longest = side(0).max(side(1)).max(side(2));
        (longest / (LONG * spacing)).floor().min(MOST) as u32
    };
    let tree = SurfaceTree::build(surface);
    let sampled: Vec<Vec<Sample>> = (0..mesh.face_count() as u32)
        .into_par_iter()
        .map(|face| {
            let parts = parts(face);
            let weight = IN_FACES * areas[face as usize] / (f64::from(parts * parts) * per_vertex);
            let points = centres(parts).map(|at| SurfacePoint { face, at });
            let sample = |point: SurfacePoint| Sample {
                weight,
                measured: false,
                ..Sample::vertex(
                    domain.place(&point),
                    onto(surface, &tree, mesh.position(point)),
                )
            };
            points.map(sample).collect()
        })
        .collect();
    sampled.into_iter().flatten().collect()
}

fn area_of(mesh: &TriangleMesh, face: u32) -> f64 {
    let [a, b, c] = mesh.triangle(face);
    0.5 * (b - a).cross(&(c - a)).norm()
}

fn onto(surface: &TriangleMesh, tree: &SurfaceTree, point: Point3<f64>) -> Point3<f64> {
    tree.closest(&point)
        .map_or(point, |found| surface.position(found.point))
}

/// Returns the barycentric coordinates of the centres of `n²` equal parts of a triangle.
fn centres(n: u32) -> impl Iterator<Item = [f64; 3]> {
    let third = 1.0 / 3.0;
    let at = move |i: u32, j: u32, offset: f64| {
        let [b, c] = [i, j].map(|k| (f64::from(k) + offset) / f64::from(n));
        [1.0 - b - c, b, c]
    };
    (0..n).flat_map(move |j| {
        let upright = (0..n - j).map(move |i| at(i, j, third));
        let turned = (0..(n - j).saturating_sub(1)).map(move |i| at(i, j, 2.0 * third));
        upright.chain(turned)
    })
}

#[cfg(test)]
mod tests {
    use msplines_common::mesh::shapes;
    use msplines_common::progress::unobserved;

    use super::*;
    use crate::domain::DomainOptions;

    #[test]
    fn centres_are_those_of_equal_parts() {
        for n in 1..6 {
            let found: Vec<[f64; 3]> = centres(n).collect();
            assert_eq!(found.len(), (n * n) as usize);
            for k in 0..3 {
                let mean = found.iter().map(|at| at[k]).sum::<f64>() / found.len() as f64;
                assert!((mean - 1.0 / 3.0).abs() < 1e-15, "{n}: {mean}");
            }
            let inside = |at: &[f64; 3]| at.iter().all(|b| *b > 0.2 / f64::from(n));
            assert!(found.iter().all(inside));
        }
        assert_eq!(centres(0).count(), 0);
    }

    #[test]
    fn numbers_of_samples_that_are_none_are_refused() {
        for given in [-1.0, f64::NAN, f64::INFINITY, 1000.5] {
            let sampling = Sampling {
                per_control_point: given,
            };
            let error = sampling.check().expect_err("no number of samples");
            let start = format!("{given:?} samples are wanted per control point");
            let error = error.to_string();
            assert!(error.starts_with(&start), "{error}");
            assert!(error.ends_with("to 1000"), "{error}");
        }
        for given in [0.0, 8.0, Sampling::MOST_PER_CONTROL_POINT] {
            let sampling = Sampling {
                per_control_point: given,
            };
            assert_eq!(sampling.check(), Ok(()));
        }
    }

    #[test]
    fn samples_are_vertices_then_poles_then_points_of_faces() {
        let mesh = shapes::sphere(300);
        let options = DomainOptions {
            poles: vec![0, 150],
            ..DomainOptions::default()
        };
        let domain = Domain::of_surface(&mesh, &options, &mut unobserved()).expect("a domain");
        let samples = |per_control_point: f64, stop: Stop| {
            let found = Sampling { per_control_point }.samples(&domain, &mesh, stop);
            found.expect("samples")
        };
        let vertices = domain.mesh().vertex_count();
        let budget = Stop::ControlPoints(400);
        let alone = samples(0.0, budget);
        assert_eq!(alone.len(), vertices + 2);
        for (sample, position) in alone.iter().zip(domain.mesh().positions()) {
            assert_eq!(sample.position, *position);
        }
        for (sample, pole) in alone[vertices..].iter().zip(domain.poles()) {
            assert_eq!(sample.at, pole.at);
            assert_eq!(sample.position, mesh.positions()[pole.vertex as usize]);
            assert!(sample.measured && !sample.movable);
        }
        for (stop, wanted) in [(budget, 3200), (Stop::Tolerance(0.1), 0)] {
            let found = samples(8.0, stop);
            let (first, rest) = found.split_at(alone.len());
            assert_eq!(first, alone);
            assert_eq!(rest, in_faces(&domain, &mesh, wanted));
        }
        let more = samples(8.0, budget).len();
        assert!(more > 2 * alone.len(), "{more}");
    }

    #[test]
    fn faces_are_sampled_where_they_are_large_and_in_proportion() {
        let mesh = shapes::torus(1.0, 0.4, 800);
        let domain = Domain::of_surface(&mesh, &DomainOptions::default(), &mut unobserved());
        let domain = domain.expect("a domain");
        for wanted in [3_000, 10_000] {
            let found = in_faces(&domain, &mesh, wanted);
            let all = (found.len() + mesh.vertex_count()) as f64;
            assert!(
                (0.4..=2.5).contains(&(all / wanted as f64)),
                "{all} of {wanted}"
            );
            let weight: f64 = found.iter().map(|s| s.weight).sum();
            let vertices = mesh.vertex_count() as f64;
            assert!(weight <= vertices * (1.0 + 1e-12), "{weight}");
            assert!(found.iter().all(|s| !s.measured && s.movable));
            // The chords of the torus leave it by no more than this.
            for sample in &found {
                let p = sample.position;
                let miss = (p.x.hypot(p.y) - 1.0).hypot(p.z) - 0.4;
                assert!(miss.abs() < 0.02, "{miss}");
            }
        }
        assert!(in_faces(&domain, &mesh, 0).len() < mesh.face_count() / 2);
    }
}
