//! Changes of a spline after its fit, and how far they reach.

use std::collections::{BTreeMap, BTreeSet};

use msplines_common::evaluate::{Order, Samples, SurfaceSpline};
use msplines_common::mesh::{NONE, SurfacePoint, TriangleMesh};
use msplines_common::{Point3, Vector3};
use msplines_powell_sabin::{
    EditError, NewVertex, PowellSabinSpline, PowellSabinSurface, VertexCondition,
};
use serde_json::json;

use super::Produced;
use super::plane::surface;
use crate::case::SplineEdit;
use crate::error::{PowellSabinError, RunError};

/// Segments along a side of a face between which movements are measured.
const SEGMENTS: u32 = 3;
/// Points that move by more than this share of the diagonal count as moved: rounding does not.
const MOVED: f64 = 1e-13;

/// A place that is nearest to fractions of the sides of the bounding box.
pub(super) fn place(mesh: &TriangleMesh, at: [f64; 3]) -> Point3<f64> {
    let [low, high] = mesh.bounding_box();
    low + (high - low).component_mul(&Vector3::from(at))
}

/// Returns the nearest of some points, the first of several.
pub(super) fn nearest(points: &[Point3<f64>], at: &Point3<f64>) -> u32 {
    let distance = |i: &usize| (points[*i] - at).norm();
    let found = (0..points.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
    found.unwrap_or_default() as u32
}

/// What an edit did to the domain.
struct Step {
    /// The faces before.
    faces: Vec<[u32; 3]>,
    /// The new vertex and its place before.
    inserted: Option<(u32, SurfacePoint)>,
}

/// Changes a surface without holes, and measures how far that reaches.
///
/// # Errors
/// A surface with holes, or a change that is none.
pub(super) fn apply(
    produced: &mut Produced,
    before: &PowellSabinSurface,
    edits: &[SplineEdit],
) -> Result<(), RunError> {
    if !before.caps().is_empty() {
        let (what, remedy) = (
            "edits where its form has zeros",
            "leave them out, or take a torus or a surface with a boundary",
        );
        return Err(PowellSabinError::FitOnly { what, remedy }.into());
    }
    let mut spline = before.regular().clone();
    let (mut steps, mut places) = (Vec::new(), Vec::new());
    for edit in edits {
        let (edited, vertex, step) =
            one(&spline, edit, produced).map_err(PowellSabinError::from)?;
        spline = edited;
        steps.push(step);
        places.push(vertex);
    }
    produced.surface = surface(&spline)?;
    let positions = spline.vertex_values().as_chunks::<3>().0;
    let marks = places.iter().map(|&v| Point3::from(positions[v as usize]));
    produced.marks = marks.collect();
    let reach = Reach::measure(before, &produced.surface, &steps, &places);
    for (name, value) in [
        ("edits", json!(edits.len())),
        ("changed_faces", json!(reach.changed)),
        ("faces", json!(reach.faces)),
        ("largest_movement", json!(reach.largest)),
        ("movement_beyond", json!(reach.beyond)),
    ] {
        produced.checks.insert(name.to_owned(), value);
    }
    Ok(())
}

/// Returns the changed spline, the vertex at which it changed, and what happened to its domain.
fn one(
    spline: &PowellSabinSpline,
    edit: &SplineEdit,
    produced: &mut Produced,
) -> Result<(PowellSabinSpline, u32, Step), EditError> {
    let mesh = spline.flat_domain().mesh();
    let faces = mesh.faces().to_vec();
    let unchanged = Step {
        faces: faces.clone(),
        inserted: None,
    };
    let at_vertex = |at| nearest(mesh.positions(), &place(mesh, at));
    match *edit {
        SplineEdit::Turn { at, normal } => {
            let vertex = at_vertex(at);
            let normal = Vector3::from(normal);
            produced.conditions[vertex as usize] = VertexCondition::Interpolate {
                position: mesh.positions()[vertex as usize],
                normal,
            };
            Ok((spline.with_normal(vertex, normal)?, vertex, unchanged))
        }
        SplineEdit::Scale { at, factor } => {
            let vertex = at_vertex(at);
            let edited = spline.with_scaled_control_triangle(vertex, factor)?;
            Ok((edited, vertex, unchanged))
        }
        SplineEdit::Insert { at, by, normal } => {
            let middle = |&[a, b, c]: &[u32; 3]| {
                let corners = [a, b, c].map(|v| mesh.positions()[v as usize].coords);
                Point3::from(corners.iter().sum::<Vector3<f64>>() / 3.0)
            };
            let middles: Vec<Point3<f64>> = faces.iter().map(middle).collect();
            let new = NewVertex {
                place: SurfacePoint {
                    face: nearest(&middles, &place(mesh, at)),
                    at: [1.0 / 3.0; 3],
                },
                offset: Vector3::from(by) * mesh.diagonal(),
                normal: normal.map(Vector3::from),
            };
            let edited = spline.with_vertex(&new)?;
            let vertex = mesh.vertex_count() as u32;
            let position = edited.flat_domain().mesh().positions()[vertex as usize];
            produced.origins.push(None);
            produced.conditions.push(match new.normal {
                Some(normal) => VertexCondition::Interpolate { position, normal },
                None => VertexCondition::Position { position },
            });
            let inserted = Some((vertex, new.place));
            Ok((edited, vertex, Step { faces, inserted }))
        }
    }
}

/// How far changes reach.
struct Reach {
    /// Faces of the new domain on which some point moved.
    changed: usize,
    /// Faces of the new domain.
    faces: usize,
    /// Largest movement, over the diagonal, between points at the same place of the domain.
    largest: f64,
    /// Largest movement on faces that have no changed vertex, nor an edge in common with a split face.
    beyond: f64,
}

impl Reach {
    fn measure(
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

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use msplines_common::progress::unobserved;

    use crate::case::{Case, Input, Layout, Method, PowellSabinMethod, SplineEdit};
    use crate::generated::GeneratedSurface;
    use crate::record::Record;
    use crate::run::run;

    fn checks(surface: GeneratedSurface, edits: &[SplineEdit]) -> Record {
        let method = PowellSabinMethod {
            layout: if surface == GeneratedSurface::Hill {
                Layout::Plane
            } else {
                Layout::Atlas
            },
            edits: edits.to_vec(),
            ..PowellSabinMethod::default()
        };
        let case = Case::new(
            Input::Surface(surface),
            Method::PowellSabin(Box::new(method)),
        );
        let output = run(&case, Instant::now(), &mut unobserved());
        output.expect("a surface").record
    }

    const TOP: [f64; 3] = [0.5, 0.5, 1.0];

    #[test]
    fn edits_reach_the_faces_around_them_and_keep_interpolating() {
        let turn = SplineEdit::Turn {
            at: TOP,
            normal: [0.5, 0.0, 1.0],
        };
        let scale = SplineEdit::Scale {
            at: TOP,
            factor: 2.0,
        };
        let insert = SplineEdit::Insert {
            at: TOP,
            by: [0.0, 0.0, 0.05],
            normal: Some([0.0, 0.0, 1.0]),
        };
        for surface in [GeneratedSurface::Hill, GeneratedSurface::Torus500] {
            let whole = checks(surface, &[]);
            assert!(whole.checks.get("changed_faces").is_none());
            for edits in [
                vec![turn],
                vec![scale],
                vec![insert],
                vec![insert, turn, scale],
            ] {
                let record = checks(surface, &edits);
                let number = |name: &str| record.checks[name].as_f64().expect(name);
                assert!(number("largest_movement") > 1e-3, "{edits:?}");
                // Of other faces not one bit of their data changes; only the order of sums may.
                assert!(number("movement_beyond") < 1e-14, "{edits:?}");
                // Stars of up to three vertices, and three neighbours of a split face.
                let (changed, faces) = (number("changed_faces"), number("faces"));
                assert!(changed >= 3.0 && changed <= 24.0 && faces > 2.0 * changed);
                assert!(number("position_max") < 1e-14 && number("normal_max") < 1e-13);
            }
        }
    }

    #[test]
    fn zeros_and_changes_that_are_none_are_refused() {
        let run_with = |surface, edit| {
            let method = PowellSabinMethod {
                edits: vec![edit],
                ..PowellSabinMethod::default()
            };
            let case = Case::new(
                Input::Surface(surface),
                Method::PowellSabin(Box::new(method)),
            );
            let output = run(&case, Instant::now(), &mut unobserved());
            output.expect_err("refused").to_string()
        };
        let none = SplineEdit::Scale {
            at: TOP,
            factor: 0.0,
        };
        let torus = run_with(GeneratedSurface::Torus500, none);
        assert!(torus.contains("positive factor"), "{torus}");
        let zeros = run_with(GeneratedSurface::Genus2Coarse, none);
        assert!(zeros.contains("zeros"), "{zeros}");
    }
}
