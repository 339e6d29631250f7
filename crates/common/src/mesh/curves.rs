//! Networks of curves in space: what surfaces are sketched with.
//!
//! Curves meet where they share a point, by its index: two points at the same place are two points.

use nalgebra::Point3;

/// One polyline of a network.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Curve {
    /// Its points in order, by index; the first again at the end if it is closed.
    pub points: Vec<u32>,
    /// Whether the surface has a crease along each segment: one flag fewer than points.
    pub creases: Vec<bool>,
}

impl Curve {
    /// Returns a curve along which the surface is smooth.
    #[must_use]
    pub fn smooth(points: Vec<u32>) -> Self {
        let creases = vec![false; points.len().saturating_sub(1)];
        Self { points, creases }
    }

    /// Returns a curve along which the surface has a crease.
    #[must_use]
    pub fn crease(points: Vec<u32>) -> Self {
        let creases = vec![true; points.len().saturating_sub(1)];
        Self { points, creases }
    }

    /// Returns whether it ends where it starts.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.points.len() > 2 && self.points.first() == self.points.last()
    }
}

/// Why points and curves are no network. Indices count from 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CurvesError {
    /// There is no curve.
    #[error("the network has no curves; give at least those around one patch")]
    NoCurves,
    /// There are more points than 32-bit ids can name.
    #[error("the network has {count} points or segments, more than 32-bit ids can name; split it")]
    TooLarge {
        /// How many there are.
        count: usize,
    },
    /// A coordinate is infinite or no number.
    #[error("point {point} has a coordinate that is no finite number; correct or remove it")]
    NotFinite {
        /// The point.
        point: u32,
    },
    /// A curve has fewer than two points.
    #[error("curve {curve} has {points} points; a curve needs two or more")]
    TooShort {
        /// The curve.
        curve: usize,
        /// How many points it has.
        points: usize,
    },
    /// A curve does not have one crease flag per segment.
    #[error("curve {curve} has {segments} segments but {flags} crease flags; give one per segment")]
    CreaseCount {
        /// The curve.
        curve: usize,
        /// How many segments it has.
        segments: usize,
        /// How many flags it has.
        flags: usize,
    },
    /// A curve names a point that does not exist.
    #[error("curve {curve} names point {point}, but there are {points} points, from 0")]
    NoSuchPoint {
        /// The curve.
        curve: usize,
        /// The point.
        point: u32,
        /// How many there are.
        points: usize,
    },
    /// A segment has no length.
    #[error(
        "curve {curve} goes from point {} to point {}, which is the same place; remove one of them",
        .points[0], .points[1]
    )]
    ZeroLength {
        /// The curve.
        curve: usize,
        /// The ends of the segment.
        points: [u32; 2],
    },
    /// A curve goes back along its last segment.
    #[error(
        "curve {curve} goes from point {} to point {} and straight back; end it there, or split it",
        .points[0], .points[1]
    )]
    TurnsBack {
        /// The curve.
        curve: usize,
        /// The ends of the segment.
        points: [u32; 2],
    },
}

impl CurvesError {
    /// Returns the curve at fault, if it is one.
    #[must_use]
    pub fn curve(&self) -> Option<usize> {
        match self {
            Self::NoCurves | Self::TooLarge { .. } | Self::NotFinite { .. } => None,
            Self::TooShort { curve, .. }
            | Self::CreaseCount { curve, .. }
            | Self::NoSuchPoint { curve, .. }
            | Self::ZeroLength { curve, .. }
            | Self::TurnsBack { curve, .. } => Some(*curve),
        }
    }
}

/// Points and the curves through them, each checked on its own: indices exist, coordinates are
/// finite, segments have length. Whether the curves bound patches is for others to tell.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveNetwork {
    points: Vec<Point3<f64>>,
    curves: Vec<Curve>,
}

impl CurveNetwork {
    /// Builds a network.
    ///
    /// # Errors
    /// The first point or curve that is none.
    pub fn build(points: Vec<Point3<f64>>, curves: Vec<Curve>) -> Result<Self, CurvesError> {
        if curves.is_empty() {
            return Err(CurvesError::NoCurves);
        }
        let segments: usize = curves.iter().map(|c| c.creases.len()).sum();
        let count = points.len().max(segments).max(curves.len());
        if count >= u32::MAX as usize / 4 {
            return Err(CurvesError::TooLarge { count });
        }
        let finite = |p: &Point3<f64>| p.iter().all(|x| x.is_finite());
        if let Some(point) = points.iter().position(|p| !finite(p)) {
            let point = point as u32;
            return Err(CurvesError::NotFinite { point });
        }
        for (index, curve) in curves.iter().enumerate() {
            check(index, curve, &points)?;
        }
        Ok(Self { points, curves })
    }

    /// Returns all points, also those that no curve uses.
    #[must_use]
    pub fn points(&self) -> &[Point3<f64>] {
        &self.points
    }

    /// Returns the curves.
    #[must_use]
    pub fn curves(&self) -> &[Curve] {
        &self.curves
    }

    /// Returns the number of segments of all curves.
    #[must_use]
    pub fn segment_count(&self) -> usize {
        self.curves.iter().map(|curve| curve.creases.len()).sum()
    }

    /// Returns the diagonal of the bounding box of the points that curves use.
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        let used = self.curves.iter().flat_map(|curve| &curve.points);
        let far = [f64::INFINITY, f64::NEG_INFINITY].map(|x| Point3::from([x; 3]));
        let [low, high] = used
            .map(|&p| self.points[p as usize])
            .fold(far, |[low, high], p| [low.inf(&p), high.sup(&p)]);
        (high - low).norm()
    }
}

fn check(index: usize, curve: &Curve, points: &[Point3<f64>]) -> Result<(), CurvesError> {
    if curve.points.len() < 2 {
        return Err(CurvesError::TooShort {
            curve: index,
            points: curve.points.len(),
        });
    }
    let (segments, flags) = (curve.points.len() - 1, curve.creases.len());
    if segments != flags {
        return Err(CurvesError::CreaseCount {
            curve: index,
            segments,
            flags,
        });
    }
    if let Some(&point) = curve.points.iter().find(|&&p| p as usize >= points.len()) {
        return Err(CurvesError::NoSuchPoint {
            curve: index,
            point,
            points: points.len(),
        });
    }
    for ends in curve.points.windows(2) {
        // The same index twice is the same place too.
        if points[ends[0] as usize] == points[ends[1] as usize] {
            return Err(CurvesError::ZeroLength {
                curve: index,
                points: [ends[0], ends[1]],
            });
        }
    }
    let back = |triple: &&[u32]| triple[0] == triple[2];
    if let Some(triple) = curve.points.windows(3).find(back) {
        return Err(CurvesError::TurnsBack {
            curve: index,
            points: [triple[0], triple[1]],
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<Point3<f64>> {
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
            .map(|[x, y]| Point3::new(x, y, 0.0))
            .to_vec()
    }

    #[test]
    fn a_closed_curve_has_as_many_segments_as_points() {
        let curve = Curve::crease(vec![0, 1, 2, 3, 0]);
        assert!(curve.is_closed());
        let network = CurveNetwork::build(square(), vec![curve]).expect("a square");
        assert_eq!(network.segment_count(), 4);
        assert_eq!(network.diagonal(), 2.0_f64.sqrt());
    }

    #[test]
    fn what_is_no_curve_is_refused_with_its_number() {
        let build = |curves: Vec<Vec<u32>>| {
            let curves = curves.into_iter().map(Curve::smooth).collect();
            CurveNetwork::build(square(), curves).expect_err("no network")
        };
        for (curves, at, text) in [
            (vec![], None, "no curves"),
            (vec![vec![0, 1], vec![2]], Some(1), "curve 1 has 1 points"),
            (vec![vec![0, 4]], Some(0), "names point 4, but there are 4"),
            (vec![vec![0, 1, 1]], Some(0), "from point 1 to point 1"),
            (vec![vec![0, 1, 0]], Some(0), "and straight back"),
            (vec![vec![]], Some(0), "0 points"),
        ] {
            let error = build(curves);
            assert_eq!(error.curve(), at);
            assert!(error.to_string().contains(text), "{error}");
        }
        let mut points = square();
        points[2].y = f64::NAN;
        let error = CurveNetwork::build(points, vec![Curve::smooth(vec![0, 1])]);
        let error = error.expect_err("a coordinate is missing");
        assert!(error.to_string().starts_with("point 2 "), "{error}");
        let curve = Curve {
            points: vec![0, 1, 2],
            creases: vec![true],
        };
        let error = CurveNetwork::build(square(), vec![curve]).expect_err("a flag is missing");
        assert!(error.to_string().contains("2 segments but 1 crease flags"));
    }
}
