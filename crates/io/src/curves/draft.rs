//! A network as its file has it, with the line of everything.

use msplines_common::mesh::curves::{Curve, CurveNetwork, CurvesError};
use nalgebra::Point3;

use crate::error::{Fault, Place};

/// Points and curves with the lines they come from; points are numbered from 1.
#[derive(Default)]
pub(super) struct Draft {
    pub(super) points: Vec<Point3<f64>>,
    pub(super) point_lines: Vec<u64>,
    pub(super) curves: Vec<DraftCurve>,
}

/// One curve of a file.
pub(super) struct DraftCurve {
    pub(super) points: Vec<i64>,
    pub(super) creases: Vec<bool>,
    pub(super) line: u64,
}

impl Draft {
    /// Adds a point.
    pub(super) fn push(&mut self, point: Point3<f64>, line: u64) {
        self.points.push(point);
        self.point_lines.push(line);
    }

    /// Returns the network, if all indices exist and each curve is one.
    pub(super) fn finish(self) -> Result<CurveNetwork, Fault> {
        let count = self.points.len();
        let mut curves = Vec::with_capacity(self.curves.len());
        let lines: Vec<u64> = self.curves.iter().map(|curve| curve.line).collect();
        for curve in self.curves {
            let outside = |&&p: &&i64| p < 1 || p as u64 > count as u64;
            if let Some(point) = curve.points.iter().find(outside) {
                let problem =
                    format!("the curve names point {point}, but there are {count}, from 1");
                return Err(Fault::malformed(Place::Line(curve.line), problem));
            }
            curves.push(Curve {
                points: curve.points.iter().map(|&p| (p - 1) as u32).collect(),
                creases: curve.creases,
            });
        }
        CurveNetwork::build(self.points, curves).map_err(|error| {
            let line = match &error {
                CurvesError::NotFinite { point } => self.point_lines[*point as usize],
                error => error.curve().map_or(1, |curve| lines[curve]),
            };
            Fault::malformed(Place::Line(line), told(&error))
        })
    }
}

/// Returns what is wrong in the numbers of the file, which count from 1.
fn told(error: &CurvesError) -> String {
    let place = |points: &[u32; 2]| points.map(|p| p + 1);
    match error {
        CurvesError::NotFinite { .. } => "a coordinate is no finite number".to_owned(),
        CurvesError::TooShort { points, .. } => {
            format!("the curve has {points} points, and needs two or more")
        }
        CurvesError::ZeroLength { points, .. } => {
            let [a, b] = place(points);
            format!("the curve goes from point {a} to point {b}, which is the same place")
        }
        CurvesError::TurnsBack { points, .. } => {
            let [a, b] = place(points);
            format!("the curve goes from point {a} to point {b} and straight back")
        }
        other => other.to_string(),
    }
}
