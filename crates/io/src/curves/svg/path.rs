//! The `d` attribute of a path as strokes.
//!
//! `svgtypes` reads the segments. They are followed here, because its own simplification cuts arcs until
//! they are off by a tenth of a unit: into pieces without number where a file has large coordinates.

use kurbo::{Arc, PathEl, SvgArc, Vec2};
use nalgebra::{Point2, Vector2};
use svgtypes::{PathParser, PathSegment};

use super::bad_attribute;
use super::shape::{Piece, Stroke};
use crate::error::{Fault, Place};

/// How far the pieces of an arc may lie from it, as a fraction of its larger radius: seven for a turn.
const ROUNDNESS: f64 = 1e-5;

/// Ends of an arc that are closer than this fraction of its size say nothing about its direction.
const SAME_END: f64 = 1e-12;

/// What a shorthand reflects.
#[derive(Clone, Copy)]
enum Handle {
    None,
    Cubic(Point2<f64>),
    Quadratic(Point2<f64>),
}

impl Handle {
    /// Returns the first control point of a smooth cubic piece.
    fn cubic(self, from: Point2<f64>) -> Point2<f64> {
        match self {
            Self::Cubic(before) => from + (from - before),
            _ => from,
        }
    }

    /// Returns the control point of a smooth quadratic piece.
    fn quadratic(self, from: Point2<f64>) -> Point2<f64> {
        match self {
            Self::Quadratic(before) => from + (from - before),
            _ => from,
        }
    }
}

/// An elliptical arc from the pen's place.
struct Elliptical {
    radii: [f64; 2],
    /// Angle of the first axis, in degrees.
    rotation: f64,
    is_large: bool,
    is_sweep: bool,
    end: Point2<f64>,
}

/// What is drawn so far, and where the pen is.
struct Pen {
    strokes: Vec<Stroke>,
    at: Point2<f64>,
    handle: Handle,
    /// Whether the next piece begins a stroke without a move.
    is_closed: bool,
    line: u64,
}

/// Returns the strokes of path data that are longer than a move.
pub(super) fn path(data: &str, line: u64) -> Result<Vec<Stroke>, Fault> {
    let mut pen = Pen {
        strokes: Vec::new(),
        at: Point2::origin(),
        handle: Handle::None,
        is_closed: false,
        line,
    };
    for segment in PathParser::from(data) {
        let segment = segment.map_err(|error| bad_attribute(line, "the path data", &error))?;
        pen.follow(segment)?;
    }
    pen.strokes.retain(|stroke| !stroke.pieces.is_empty());
    Ok(pen.strokes)
}

impl Pen {
    fn follow(&mut self, segment: PathSegment) -> Result<(), Fault> {
        let from = self.at;
        let base = if segment.is_abs() {
            Vector2::zeros()
        } else {
            from.coords
        };
        let place = |x: f64, y: f64| Point2::new(x, y) + base;
        let handle = std::mem::replace(&mut self.handle, Handle::None);
        match segment {
            PathSegment::MoveTo { x, y, .. } => {
                self.at = place(x, y);
                self.is_closed = false;
                self.strokes.push(Stroke::new(self.at, self.line));
            }
            PathSegment::ClosePath { .. } => self.close(),
            PathSegment::LineTo { x, y, .. } => self.draw(Piece::Line(place(x, y)))?,
            PathSegment::HorizontalLineTo { x, .. } => {
                self.draw(Piece::Line(Point2::new(x + base.x, from.y)))?;
            }
            PathSegment::VerticalLineTo { y, .. } => {
                self.draw(Piece::Line(Point2::new(from.x, y + base.y)))?;
            }
            PathSegment::CurveTo {
                x1,
                y1,
                x2,
                y2,
                x,
                y,
                ..
            } => self.cubic([place(x1, y1), place(x2, y2), place(x, y)])?,
            PathSegment::SmoothCurveTo { x2, y2, x, y, .. } => {
                self.cubic([handle.cubic(from), place(x2, y2), place(x, y)])?;
            }
            PathSegment::Quadratic { x1, y1, x, y, .. } => {
                self.quadratic(place(x1, y1), place(x, y))?;
            }
            PathSegment::SmoothQuadratic { x, y, .. } => {
                self.quadratic(handle.quadratic(from), place(x, y))?;
            }
            PathSegment::EllipticalArc {
                rx,
                ry,
                x_axis_rotation,
                large_arc,
                sweep,
                x,
                y,
                ..
            } => self.arc(&Elliptical {
                radii: [rx.abs(), ry.abs()],
                rotation: x_axis_rotation,
                is_large: large_arc,
                is_sweep: sweep,
                end: place(x, y),
            })?,
        }
        Ok(())
    }

    fn close(&mut self) {
        if let Some(stroke) = self.strokes.last_mut() {
            stroke.close();
            self.at = stroke.start;
            self.is_closed = true;
        }
    }

    fn draw(&mut self, piece: Piece) -> Result<(), Fault> {
        if self.is_closed {
            self.strokes.push(Stroke::new(self.at, self.line));
            self.is_closed = false;
        }
        let Some(stroke) = self.strokes.last_mut() else {
            let problem = "the path data does not start with a move";
            return Err(Fault::malformed(Place::Line(self.line), problem));
        };
        self.at = piece.end();
        stroke.pieces.push(piece);
        Ok(())
    }

    fn cubic(&mut self, points: [Point2<f64>; 3]) -> Result<(), Fault> {
        self.handle = Handle::Cubic(points[1]);
        self.draw(Piece::Cubic(points))
    }

    fn quadratic(&mut self, control: Point2<f64>, end: Point2<f64>) -> Result<(), Fault> {
        self.handle = Handle::Quadratic(control);
        let raised = [self.at, end].map(|p| p + (control - p) * (2.0 / 3.0));
        self.draw(Piece::Cubic([raised[0], raised[1], end]))
    }

    fn arc(&mut self, arc: &Elliptical) -> Result<(), Fault> {
        let (from, chord) = (self.at, arc.end - self.at);
        // At the size of one, so that neither huge nor tiny drawings leave the range of numbers.
        let size = arc.radii[0].max(arc.radii[1]).max(chord.norm());
        let unit = chord / size;
        let curved = (unit.norm() > SAME_END)
            .then(|| {
                Arc::from_svg_arc(&SvgArc {
                    from: kurbo::Point::ORIGIN,
                    to: kurbo::Point::new(unit.x, unit.y),
                    radii: Vec2::new(arc.radii[0] / size, arc.radii[1] / size),
                    x_rotation: arc.rotation.to_radians(),
                    large_arc: arc.is_large,
                    sweep: arc.is_sweep,
                })
            })
            .flatten();
        let Some(curved) = curved else {
            return self.draw(Piece::Line(arc.end));
        };
        let mut pieces = curved
            .append_iter(ROUNDNESS * curved.radii.x.max(curved.radii.y))
            .peekable();
        while let Some(piece) = pieces.next() {
            let PathEl::CurveTo(a, b, c) = piece else {
                continue;
            };
            let mut points = [a, b, c].map(|p| from + size * Vector2::new(p.x, p.y));
            if pieces.peek().is_none() {
                points[2] = arc.end;
            }
            self.draw(Piece::Cubic(points))?;
        }
        Ok(())
    }
}
