//! Levels and moved control points of stored T-splines.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use msplines_common::mesh::TriangleMesh;
use msplines_common::{Point3, Vector3};
use msplines_io::write_atomically;
use msplines_t_spline::TSplineSurface;
use msplines_t_spline::complex::{Point, UNITS};
use msplines_t_spline::edit::{ControlKind, Drag, Pull};
use serde_json::{Value, json};

use crate::error::{RunError, TSplineError};
use crate::output::check_folder;
use crate::spline_file::{SplineFile, StoredSpline};

/// Vertices that move by more than this share of the largest movement count as moved.
const MOVED: f64 = 0.01;

/// What is asked of a T-spline alone: a level, and movements of its control points, in this order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TSplineChanges {
    /// The level, 0 the coarsest; the surface itself where absent.
    pub level: Option<usize>,
    /// Control points by number, and by how much they move.
    pub moves: Vec<(u32, Vector3<f64>)>,
    /// Movements of all control points near a place.
    pub drags: Vec<Drag>,
    /// Vertices of the input, and where the surface should be there.
    pub pulls: Vec<(u32, Point3<f64>)>,
    /// File for a list of the control points.
    pub list: Option<PathBuf>,
}

impl TSplineChanges {
    /// Returns whether the surface stays as it is.
    pub(super) fn moves_nothing(&self) -> bool {
        self.moves.is_empty() && self.drags.is_empty() && self.pulls.is_empty()
    }

    /// Refuses what splines of other methods do not have.
    pub(in crate::run) fn check_method(&self, spline: &StoredSpline) -> Result<(), RunError> {
        if *self == Self::default() || matches!(spline, StoredSpline::TSpline(_)) {
            return Ok(());
        }
        let method = spline.method();
        Err(TSplineError::NotATSpline { method }.into())
    }

    /// Refuses a list that could not be written later.
    pub(super) fn check_list(&self) -> Result<(), RunError> {
        self.list.as_deref().map_or(Ok(()), check_folder)
    }
}

/// Replaces a file by that of the level that is asked for.
pub(super) fn at_level(
    file: SplineFile,
    level: Option<usize>,
    input: &TriangleMesh,
) -> Result<SplineFile, RunError> {
    match (&file.spline, level) {
        (StoredSpline::TSpline(stored), Some(level)) => {
            let stored = stored.at_level(level, input)?;
            let spline = StoredSpline::TSpline(Box::new(stored));
            Ok(SplineFile { spline, ..file })
        }
        _ => Ok(file),
    }
}

/// A changed surface.
pub(super) struct Edited {
    pub(super) file: SplineFile,
    pub(super) surface: TSplineSurface,
    /// How many control vectors have moved.
    moved: usize,
}

/// Moves control points; coarser levels are none of the new surface.
pub(super) fn edited(
    file: SplineFile,
    surface: &TSplineSurface,
    changes: &TSplineChanges,
) -> Result<Edited, RunError> {
    let StoredSpline::TSpline(mut stored) = file.spline else {
        let method = file.spline.method();
        return Err(TSplineError::NotATSpline { method }.into());
    };
    let before = surface.spline();
    let mut spline = before
        .with_moved(&changes.moves)
        .map_err(TSplineError::from)?;
    for drag in &changes.drags {
        let moves = spline.dragged_by(drag).map_err(TSplineError::from)?;
        spline = spline.with_moved(&moves).map_err(TSplineError::from)?;
    }
    let pulls: Result<Vec<Pull>, RunError> = (changes.pulls.iter())
        .map(|&(vertex, to)| {
            Ok(Pull {
                at: place_of(surface, vertex)?,
                to,
            })
        })
        .collect();
    let moves = spline.pulled_by(&pulls?).map_err(TSplineError::from)?;
    spline = spline.with_moved(&moves).map_err(TSplineError::from)?;
    let pairs = spline.control().iter().zip(before.control());
    let moved = pairs.filter(|(a, b)| a != b).count();
    let control = spline.control().iter();
    stored.control = control.map(|c| [c.x, c.y, c.z]).collect();
    stored.levels.clear();
    let (domain, shifts) = (surface.domain().clone(), surface.shifts().to_vec());
    Ok(Edited {
        file: SplineFile {
            spline: StoredSpline::TSpline(stored),
            ..file
        },
        surface: TSplineSurface::new(domain, shifts, spline),
        moved,
    })
}

/// Returns where a vertex of the input lies on the cylinders.
fn place_of(surface: &TSplineSurface, vertex: u32) -> Result<Point, RunError> {
    let domain = surface.domain();
    let own = domain.origins().iter().position(|o| *o == Some(vertex));
    let at = match own {
        Some(own) => {
            let from = domain.vertex(own as u32);
            domain.complex().walk(from, surface.shifts()[own]).0
        }
        None => {
            let pole = domain.poles().into_iter().find(|p| p.vertex == vertex);
            pole.ok_or(TSplineError::NotOnSurface { vertex })?.at
        }
    };
    Ok(at)
}

impl Edited {
    /// Returns how far the change reaches, at the vertices of the input.
    pub(super) fn checks(
        &self,
        before: &TriangleMesh,
        after: &TriangleMesh,
    ) -> [(String, Value); 3] {
        let pairs = before.positions().iter().zip(after.positions());
        let scale = before.diagonal();
        let movements: Vec<f64> = pairs.map(|(a, b)| (b - a).norm() / scale).collect();
        let largest = movements.iter().copied().fold(0.0, f64::max);
        let count = movements.iter().filter(|&&x| x > MOVED * largest).count();
        let share = count as f64 / movements.len().max(1) as f64;
        [
            ("moved_control_points", json!(self.moved)),
            ("largest_movement", json!(largest)),
            ("moved_share", json!(share)),
        ]
        .map(|(name, value)| (name.to_owned(), value))
    }
}

/// Writes the control points as a table: number, kind, cylinder, place in units of the form's 1, position.
pub(super) fn write_list(path: &Path, surface: &TSplineSurface) -> Result<(), RunError> {
    let mut text = String::from("index,kind,cylinder,domain_x,domain_y,x,y,z\n");
    for (index, point) in surface.spline().control_points().iter().enumerate() {
        let kind = match point.kind {
            ControlKind::Point => "point".to_owned(),
            ControlKind::Centre { cap } => format!("centre of cap {cap}"),
            ControlKind::Coefficient { cap, monomial } => {
                format!("coefficient {monomial} of cap {cap}")
            }
        };
        let (at, [x, y]) = (point.at, [point.at.x, point.at.y].map(|c| c / UNITS));
        let p = point.position;
        let line = writeln!(
            text,
            "{index},{kind},{},{x},{y},{},{},{}",
            at.cylinder, p.x, p.y, p.z
        );
        debug_assert!(line.is_ok(), "memory takes all text");
    }
    let written = write_atomically(path, |out| out.write_all(text.as_bytes()));
    written.map_err(|error| RunError::Write {
        path: path.to_owned(),
        reason: error.to_string(),
    })
}
