//! Changes of a spline after its fit.

use msplines_common::mesh::{SurfacePoint, TriangleMesh};
use msplines_common::{Point3, Vector3};
use msplines_powell_sabin::{
    EditError, NewVertex, PowellSabinSpline, PowellSabinSurface, VertexCondition,
};
use serde_json::json;

use super::plane::surface;
use super::reach::{Reach, Step};
use super::{Produced, SPLINE};
use crate::case::SplineEdit;
use crate::error::RunError;
use crate::record::{Checks, named};

/// A change of a Powell-Sabin spline at a place, in the coordinates of its mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    /// The place.
    pub at: Point3<f64>,
    /// What changes there.
    pub what: ChangeKind,
}

/// What changes at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ChangeKind {
    /// A new vertex, in the middle of the face whose middle is nearest.
    Insert {
        /// How far the surface moves there.
        by: Vector3<f64>,
        /// The normal there; that of the surface where absent.
        normal: Option<Vector3<f64>>,
    },
    /// Another normal at the nearest vertex.
    Turn(Vector3<f64>),
    /// The factor by which the control triangle of the nearest vertex grows.
    Scale(f64),
}

impl Change {
    fn of(edit: &SplineEdit, mesh: &TriangleMesh) -> Self {
        let (at, what) = match *edit {
            SplineEdit::Insert { at, by, normal } => {
                let by = Vector3::from(by) * mesh.diagonal();
                let normal = normal.map(Vector3::from);
                (at, ChangeKind::Insert { by, normal })
            }
            SplineEdit::Turn { at, normal } => (at, ChangeKind::Turn(Vector3::from(normal))),
            SplineEdit::Scale { at, factor } => (at, ChangeKind::Scale(factor)),
        };
        let at = place(mesh, at);
        Self { at, what }
    }
}

/// Returns the place of fractions of the sides of the bounding box.
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

/// Changes what a run produced, and measures how far that reaches.
///
/// # Errors
/// A surface with holes, or a change that is none.
pub(super) fn apply(produced: &mut Produced, edits: &[SplineEdit]) -> Result<(), RunError> {
    let mesh = produced.surface.mesh();
    let changes: Vec<Change> = edits.iter().map(|e| Change::of(e, mesh)).collect();
    let edited = edited(&produced.surface, &changes)?;
    for (vertex, condition) in edited.conditions {
        if vertex as usize == produced.conditions.len() {
            produced.origins.push(None);
            produced.conditions.push(condition);
        } else {
            produced.conditions[vertex as usize] = condition;
        }
    }
    let positions = edited.surface.mesh().positions();
    let marks = edited.vertices.iter().map(|&v| positions[v as usize]);
    produced.marks = marks.collect();
    produced.surface = edited.surface;
    produced.checks.extend(edited.checks);
    Ok(())
}

/// A changed surface.
pub(super) struct Edited {
    pub(super) surface: PowellSabinSurface,
    /// The vertex of every change.
    vertices: Vec<u32>,
    /// What the surface does now at changed vertices; new ones in their order.
    conditions: Vec<(u32, VertexCondition)>,
    /// How far the changes reach.
    pub(super) checks: Checks,
}

/// Changes a surface without holes.
///
/// # Errors
/// A surface with holes, or a change that is none.
pub(super) fn edited(before: &PowellSabinSurface, changes: &[Change]) -> Result<Edited, RunError> {
    if !before.caps().is_empty() {
        return Err(RunError::without(
            SPLINE,
            "edits where its form has zeros",
            "leave them out, or take a torus or a surface with a boundary",
        ));
    }
    let mut spline = before.regular().clone();
    let (mut steps, mut vertices, mut conditions) = (Vec::new(), Vec::new(), Vec::new());
    for change in changes {
        let made = Made::by(&spline, change)?;
        spline = made.spline;
        vertices.push(made.vertex);
        conditions.extend(made.condition.map(|condition| (made.vertex, condition)));
        steps.push(made.step);
    }
    let surface = surface(&spline)?;
    let reach = Reach::measure(before, &surface, &steps, &vertices);
    let checks = named([
        ("edits", json!(changes.len())),
        ("changed_faces", json!(reach.changed)),
        ("faces", json!(reach.faces)),
        ("largest_movement", json!(reach.largest)),
        ("movement_beyond", json!(reach.beyond)),
    ]);
    Ok(Edited {
        surface,
        vertices,
        conditions,
        checks,
    })
}

/// What one change makes.
struct Made {
    spline: PowellSabinSpline,
    vertex: u32,
    condition: Option<VertexCondition>,
    step: Step,
}

impl Made {
    fn by(spline: &PowellSabinSpline, change: &Change) -> Result<Self, EditError> {
        let mesh = spline.flat_domain().mesh();
        let step = Step {
            faces: mesh.faces().to_vec(),
            inserted: None,
        };
        let vertex = nearest(mesh.positions(), &change.at);
        match change.what {
            ChangeKind::Turn(normal) => {
                let position = mesh.positions()[vertex as usize];
                Ok(Self {
                    spline: spline.with_normal(vertex, normal)?,
                    vertex,
                    condition: Some(VertexCondition::Interpolate { position, normal }),
                    step,
                })
            }
            ChangeKind::Scale(factor) => Ok(Self {
                spline: spline.with_scaled_control_triangle(vertex, factor)?,
                vertex,
                condition: None,
                step,
            }),
            ChangeKind::Insert { by, normal } => {
                let middle = |&[a, b, c]: &[u32; 3]| {
                    let corners = [a, b, c].map(|v| mesh.positions()[v as usize].coords);
                    Point3::from(corners.iter().sum::<Vector3<f64>>() / 3.0)
                };
                let middles: Vec<Point3<f64>> = mesh.faces().iter().map(middle).collect();
                let place = SurfacePoint {
                    face: nearest(&middles, &change.at),
                    at: [1.0 / 3.0; 3],
                };
                let spline = spline.with_vertex(&NewVertex {
                    place,
                    offset: by,
                    normal,
                })?;
                let vertex = mesh.vertex_count() as u32;
                let position = spline.flat_domain().mesh().positions()[vertex as usize];
                Ok(Self {
                    spline,
                    vertex,
                    condition: Some(match normal {
                        Some(normal) => VertexCondition::Interpolate { position, normal },
                        None => VertexCondition::Position { position },
                    }),
                    step: Step {
                        inserted: Some((vertex, place)),
                        ..step
                    },
                })
            }
        }
    }
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
            assert!(!whole.checks.contains_key("changed_faces"));
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
                assert!((3.0..=24.0).contains(&changed) && faces > 2.0 * changed);
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
