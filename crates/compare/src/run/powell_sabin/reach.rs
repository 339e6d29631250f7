//! How far changes of a spline reach.

use std::collections::{BTreeMap, BTreeSet};

use msplines_common::Point3;
use msplines_common::evaluate::{Order, Samples, SurfaceSpline};
use msplines_common::mesh::{NONE, SurfacePoint, TriangleMesh};
use msplines_powell_sabin::PowellSabinSurface;

/// Segments along a side of a face between which movements are measured.
const SEGMENTS: u32 = 3;
/// Points that move by more than this share of the diagonal count as moved: rounding does not.
const MOVED: f64 = 1e-13;

/// What a change did to the domain.
pub(super) struct Step {
    /// The faces before.
    pub(super) faces: Vec<[u32; 3]>,
    /// The new vertex and its place before.
    pub(super) inserted: Option<(u32, SurfacePoint)>,
}

/// How far changes reach.
pub(super) struct Reach {
    /// Faces of the new domain on which some point moved.
    pub(super) changed: usize,
    /// Faces of the new domain.
    pub(super) faces: usize,
    /// Largest movement, over the diagonal, between points at the same place of the domain.
    pub(super) largest: f64,
    /// Largest movement on faces that have no changed vertex, nor an edge in common with a split face.
    pub(super) beyond: f64,
}

impl Reach {
    /// Compares a surface with the one before some steps, at whose ends these vertices changed.
    pub(super) fn measure(
        before: &PowellSabinSurface,
        after: &PowellSabinSurface,
        steps: &[Step],
        places: &[u32],
    ) -> Self {
        let movements = movements(before, after, steps);
        let topology = after.mesh().topology();
        let mut allowed: BTreeSet<u32> = BTreeSet::new();
        let pairs = steps.iter().zip(places);
        for (step, &vertex) in pairs {
            for half_edge in topology.outgoing(vertex) {
                allowed.insert(half_edge / 3);
                let across = topology.twin(3 * (half_edge / 3) + (half_edge + 1) % 3);
                if step.inserted.is_some() && across != NONE {
                    allowed.insert(across / 3);
                }
            }
        }
        let largest = |over: &mut dyn Iterator<Item = &f64>| over.copied().fold(0.0, f64::max);
        let faces = movements.iter().enumerate();
        let mut outside = faces
            .filter(|(face, _)| !allowed.contains(&(*face as u32)))
            .map(|(_, movement)| movement);
        Self {
            changed: movements.iter().filter(|&&m| m > MOVED).count(),
            faces: movements.len(),
            beyond: largest(&mut outside),
            largest: largest(&mut movements.iter()),
        }
    }
}

/// The largest movement on every face of the new surface, over the diagonal.
fn movements(before: &PowellSabinSurface, after: &PowellSabinSurface, steps: &[Step]) -> Vec<f64> {
    let steps: Vec<Traced<'_>> = steps.iter().map(Traced::new).collect();
    let n = SEGMENTS;
    let weights: Vec<[f64; 3]> = (0..=n)
        .flat_map(|i| (0..=n - i).map(move |j| [i, j, n - i - j]))
        .map(|counts| counts.map(|c| f64::from(c) / f64::from(n)))
        .collect();
    let mesh = after.mesh();
    let faces = 0..mesh.face_count() as u32;
    let points = |face: u32| weights.iter().map(move |&at| SurfacePoint { face, at });
    let now: Vec<SurfacePoint> = faces.clone().flat_map(points).collect();
    let then: Vec<SurfacePoint> = now.iter().map(|p| traced(&steps, mesh, *p)).collect();
    let (now, then) = (values(after, &now), values(before, &then));
    let moved: Vec<f64> = now
        .iter()
        .zip(&then)
        .map(|(a, b)| (a - b).norm() / before.mesh().diagonal())
        .collect();
    let per_face = moved.chunks_exact(weights.len());
    per_face
        .map(|face| face.iter().copied().fold(0.0, f64::max))
        .collect()
}

fn values(surface: &PowellSabinSurface, points: &[SurfacePoint]) -> Vec<Point3<f64>> {
    let mut samples = Samples::default();
    let prepared = surface.prepare(points, Order::Value);
    prepared
        .expect("points of a surface without holes")
        .evaluate(&mut samples);
    samples
        .values
        .chunks_exact(3)
        .map(Point3::from_slice)
        .collect()
}

/// A step with the faces before it by their vertices.
struct Traced<'a> {
    step: &'a Step,
    by_vertices: BTreeMap<[u32; 3], u32>,
}

impl<'a> Traced<'a> {
    fn new(step: &'a Step) -> Self {
        let faces = step.faces.iter().zip(0..);
        let by_vertices = faces
            .map(|(face, number)| (sorted(*face), number))
            .collect();
        Self { step, by_vertices }
    }
}

fn sorted(mut face: [u32; 3]) -> [u32; 3] {
    face.sort_unstable();
    face
}

/// Returns where a point of the last domain was on the first one.
fn traced(steps: &[Traced<'_>], mesh: &TriangleMesh, point: SurfacePoint) -> SurfacePoint {
    let mut corners = mesh.faces()[point.face as usize];
    let mut point = point;
    for Traced { step, by_vertices } in steps.iter().rev() {
        let face = match (by_vertices.get(&sorted(corners)), step.inserted) {
            (Some(&face), _) => face,
            (None, Some((_, place))) => place.face,
            (None, None) => point.face,
        };
        let old = step.faces[face as usize];
        let mut at = [0.0; 3];
        for (vertex, weight) in corners.into_iter().zip(point.at) {
            match (old.iter().position(|&v| v == vertex), step.inserted) {
                (Some(corner), _) => at[corner] += weight,
                (None, Some((_, place))) => {
                    (0..3).for_each(|i| at[i] += weight * place.at[i]);
                }
                (None, None) => {}
            }
        }
        (corners, point) = (old, SurfacePoint { face, at });
    }
    point
}
