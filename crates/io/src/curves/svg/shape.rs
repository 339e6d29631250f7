//! The strokes of the shapes of an SVG file.

use std::str::FromStr;

use nalgebra::{Matrix3, Point2};
use svgtypes::PointsParser;

use super::bad_attribute;
use super::path::path;
use crate::error::Fault;

/// An affine map of the plane.
pub(super) type Affine = Matrix3<f64>;

/// One piece of a stroke, up to its end.
#[derive(Clone, Copy, Debug)]
pub(super) enum Piece {
    Line(Point2<f64>),
    Cubic([Point2<f64>; 3]),
}

impl Piece {
    pub(super) fn end(&self) -> Point2<f64> {
        match self {
            Self::Line(end) | Self::Cubic([_, _, end]) => *end,
        }
    }
}

/// A curve drawn without lifting the pen.
#[derive(Clone, Debug)]
pub(super) struct Stroke {
    pub(super) start: Point2<f64>,
    pub(super) pieces: Vec<Piece>,
    pub(super) crease: bool,
    pub(super) line: u64,
}

impl Stroke {
    /// Returns a stroke without pieces.
    pub(super) fn new(start: Point2<f64>, line: u64) -> Self {
        Self {
            start,
            pieces: Vec::new(),
            crease: false,
            line,
        }
    }

    /// Draws back to the start, unless the stroke ends there.
    pub(super) fn close(&mut self) {
        if self.pieces.last().is_some_and(|p| p.end() != self.start) {
            self.pieces.push(Piece::Line(self.start));
        }
    }

    pub(super) fn apply(&mut self, map: &Affine) {
        let mapped = |p: Point2<f64>| map.transform_point(&p);
        self.start = mapped(self.start);
        for piece in &mut self.pieces {
            *piece = match piece {
                Piece::Line(end) => Piece::Line(mapped(*end)),
                Piece::Cubic(points) => Piece::Cubic(points.map(mapped)),
            };
        }
    }
}

/// Returns the map of a `transform` attribute.
pub(super) fn transform(text: &str, line: u64) -> Result<Affine, Fault> {
    let t = svgtypes::Transform::from_str(text)
        .map_err(|error| bad_attribute(line, "the transform", &error))?;
    Ok(Affine::new(t.a, t.c, t.e, t.b, t.d, t.f, 0.0, 0.0, 1.0))
}

/// Returns the strokes of an element, none if it is no shape.
pub(super) fn strokes(
    name: &str,
    value: &dyn Fn(&str) -> Result<Option<String>, Fault>,
    line: u64,
) -> Result<Vec<Stroke>, Fault> {
    match name {
        "path" => path(&value("d")?.unwrap_or_default(), line),
        "polyline" | "polygon" => {
            let text = value("points")?.unwrap_or_default();
            let mut points = PointsParser::from(text.as_str()).map(|(x, y)| Point2::new(x, y));
            let Some(start) = points.next() else {
                return Ok(Vec::new());
            };
            let mut stroke = Stroke::new(start, line);
            stroke.pieces = points.map(Piece::Line).collect();
            if name == "polygon" {
                stroke.close();
            }
            Ok(vec![stroke])
        }
        "line" => {
            let mut ends = [0.0; 4];
            for (end, key) in ends.iter_mut().zip(["x1", "y1", "x2", "y2"]) {
                if let Some(text) = value(key)? {
                    *end = svgtypes::Number::from_str(&text)
                        .map_err(|error| bad_attribute(line, key, &error))?
                        .0;
                }
            }
            let mut stroke = Stroke::new(Point2::new(ends[0], ends[1]), line);
            stroke
                .pieces
                .push(Piece::Line(Point2::new(ends[2], ends[3])));
            Ok(vec![stroke])
        }
        _ => Ok(Vec::new()),
    }
}
