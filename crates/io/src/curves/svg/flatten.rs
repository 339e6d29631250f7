//! Strokes in the plane as polylines in space that share their nodes.

use std::collections::BTreeMap;

use nalgebra::{Point2, Point3};

use super::super::draft::{Draft, DraftCurve};
use super::shape::{Piece, Stroke};
use crate::error::{Fault, Place};

/// Nodes closer than this fraction of the drawing's diagonal are one: files round coordinates, and
/// relative commands add the rounding up.
const SAME_NODE: f64 = 1e-6;

/// How far a polyline may lie from its curve, as a fraction of the drawing's diagonal.
const FLATNESS: f64 = 1e-4;

/// Segments of one Bézier piece at most, so that memory stays within that of the file.
const MOST_SEGMENTS: usize = 32;

/// Returns the network of strokes.
pub(super) fn flattened(strokes: &[Stroke]) -> Result<Draft, Fault> {
    let mut draft = Draft::default();
    let Some(diagonal) = diagonal(strokes)? else {
        return Ok(draft);
    };
    let mut nodes = Nodes {
        cells: BTreeMap::new(),
        size: SAME_NODE * diagonal,
    };
    for stroke in strokes {
        let mut from = stroke.start;
        let mut points = vec![nodes.id(from, stroke.line, &mut draft)];
        for piece in &stroke.pieces {
            let inner = inside(from, piece, FLATNESS * diagonal);
            let end = nodes.id(piece.end(), stroke.line, &mut draft);
            from = piece.end();
            // A piece without length says nothing; one that comes back to its start does.
            if points.last() == Some(&end) && inner.is_empty() {
                continue;
            }
            for p in inner {
                draft.push(raised(p), stroke.line);
                points.push(draft.points.len() as i64);
            }
            points.push(end);
        }
        let creases = vec![stroke.crease; points.len() - 1];
        draft.curves.push(DraftCurve {
            points,
            creases,
            line: stroke.line,
        });
    }
    Ok(draft)
}

/// Returns the diagonal of all nodes and control points, if there are any.
fn diagonal(strokes: &[Stroke]) -> Result<Option<f64>, Fault> {
    let mut low = Point2::new(f64::INFINITY, f64::INFINITY);
    let mut high = -low;
    for stroke in strokes {
        let mut add = |p: &Point2<f64>| {
            if !(p.x.is_finite() && p.y.is_finite()) {
                let problem = "a coordinate is no finite number";
                return Err(Fault::malformed(Place::Line(stroke.line), problem));
            }
            (low, high) = (low.inf(p), high.sup(p));
            Ok(())
        };
        add(&stroke.start)?;
        for piece in &stroke.pieces {
            match piece {
                Piece::Line(end) => add(end)?,
                Piece::Cubic(points) => points.iter().try_for_each(&mut add)?,
            }
        }
    }
    let size = (high - low).norm();
    // Also passed over: no strokes, and a drawing of one point, whose curves are refused later.
    Ok((!strokes.is_empty() && size.is_finite()).then_some(size))
}

/// Returns the points of a piece between its ends.
fn inside(from: Point2<f64>, piece: &Piece, flatness: f64) -> Vec<Point2<f64>> {
    let Piece::Cubic([a, b, end]) = *piece else {
        return Vec::new();
    };
    // A chord of parameter length h is off by at most h² / 8 of the second derivative.
    let bends = [
        from.coords - 2.0 * a.coords + b.coords,
        a.coords - 2.0 * b.coords + end.coords,
    ];
    let second = 6.0 * bends[0].norm().max(bends[1].norm());
    let count = (second / (8.0 * flatness)).sqrt().ceil();
    // A comparison with NaN, of a drawing without size, gives one segment.
    let count = if count >= 1.0 {
        (count as usize).min(MOST_SEGMENTS)
    } else {
        1
    };
    let at = |i: usize| {
        let t = i as f64 / count as f64;
        let s = 1.0 - t;
        let sum = from.coords * (s * s * s)
            + a.coords * (3.0 * s * s * t)
            + b.coords * (3.0 * s * t * t)
            + end.coords * (t * t * t);
        Point2::from(sum)
    };
    (1..count).map(at).collect()
}

/// Returns a point of the drawing in space; y runs downwards in the file.
fn raised(p: Point2<f64>) -> Point3<f64> {
    Point3::new(p.x, -p.y, 0.0)
}

/// Nodes by cell of a grid.
struct Nodes {
    cells: BTreeMap<[i64; 2], Vec<(Point2<f64>, i64)>>,
    size: f64,
}

impl Nodes {
    /// Returns the number of a node, from 1, a new one if none is there.
    fn id(&mut self, p: Point2<f64>, line: u64, draft: &mut Draft) -> i64 {
        let cell = [p.x, p.y].map(|x| (x / self.size).floor() as i64);
        for dx in -1..=1 {
            for dy in -1..=1 {
                let near = [cell[0].saturating_add(dx), cell[1].saturating_add(dy)];
                let nodes = self.cells.get(&near).into_iter().flatten();
                for (node, id) in nodes {
                    if (node - p).norm() <= self.size {
                        return *id;
                    }
                }
            }
        }
        draft.push(raised(p), line);
        let id = draft.points.len() as i64;
        self.cells.entry(cell).or_default().push((p, id));
        id
    }
}
