//! Loops around an axis, spaced evenly along it.

use msplines_common::mesh::TriangleMesh;
use nalgebra::{Point3, Vector3};

use super::error::CylinderError;
use super::latitude::Latitude;
use super::loops::{Loop, align, trace};
use super::options::{Ends, Options};

/// Steps of diffusion that smooth the axis: enough for weights like those of a Gaussian.
const DIFFUSIONS: u32 = 4;

/// Loops and the axis through their centres.
pub(super) struct Winding {
    /// The harmonic latitude of each loop.
    pub(super) levels: Vec<f64>,
    /// Arc length of the axis up to each loop, from 0 to 1.
    pub(super) latitudes: Vec<f64>,
    /// The point of the axis of each loop.
    pub(super) axis: Vec<Point3<f64>>,
    /// Evenly spaced points of each loop.
    pub(super) loops: Vec<Point3<f64>>,
    ends: Ends,
}

impl Winding {
    /// Returns the loops at these levels, and the poles with them if they are latitudes 0 and 1.
    pub(super) fn build(
        surface: &TriangleMesh,
        latitude: &Latitude,
        mut levels: Vec<f64>,
        options: &Options,
    ) -> Result<Self, CylinderError> {
        let mut traced = trace(surface, &latitude.values, &levels)?;
        if latitude.inward {
            traced = traced.into_iter().map(Loop::reversed).collect();
        }
        let (meridians, ends) = (options.meridians, options.ends);
        let mut loops = align(&traced, meridians);
        if ends == Ends::Collapsed {
            let [first, last] = latitude.poles.map(|v| surface.positions()[v as usize]);
            loops.splice(0..0, vec![first; meridians]);
            loops.extend(vec![last; meridians]);
            levels.insert(0, 0.0);
            levels.push(1.0);
        }
        let axis = smoothed(centres(&loops, meridians), options.axis_smoothing);
        Ok(Self {
            levels,
            latitudes: arc_length(&axis)?,
            axis,
            loops,
            ends,
        })
    }

    /// Returns levels of so many loops that lie evenly spaced between latitudes 0 and 1, as far as
    /// the levels between these loops are known.
    pub(super) fn evenly_spaced(&self, loops: usize) -> Vec<f64> {
        let share = |k: usize| match self.ends {
            Ends::Collapsed => (k + 1) as f64 / (loops + 1) as f64,
            Ends::Stretched => k as f64 / (loops - 1) as f64,
        };
        (0..loops).map(|k| self.level(share(k))).collect()
    }

    /// The level at a latitude.
    fn level(&self, latitude: f64) -> f64 {
        let next = self.latitudes.partition_point(|&l| l <= latitude);
        let next = next.clamp(1, self.latitudes.len() - 1);
        let [from, to] = [self.latitudes[next - 1], self.latitudes[next]];
        let share = if to > from {
            ((latitude - from) / (to - from)).min(1.0)
        } else {
            0.5
        };
        self.levels[next - 1] + (self.levels[next] - self.levels[next - 1]) * share
    }
}

/// The centre of each loop.
fn centres(points: &[Point3<f64>], meridians: usize) -> Vec<Point3<f64>> {
    let centre = |points: &[Point3<f64>]| {
        let sum: Vector3<f64> = points.iter().map(|p| p.coords).sum();
        Point3::from(sum / points.len() as f64)
    };
    points.chunks_exact(meridians).map(centre).collect()
}

/// The same points, diffused between the ends, which stay: averages whose weights have a standard
/// deviation that is this share of their number.
fn smoothed(mut points: Vec<Point3<f64>>, deviation: f64) -> Vec<Point3<f64>> {
    let last = points.len() - 1;
    // An implicit step of length t has the variance 2 t.
    let step = (deviation * last as f64).powi(2) / (2.0 * f64::from(DIFFUSIONS));
    for _ in 0..DIFFUSIONS {
        diffuse(&mut points, step);
    }
    points
}

/// Solves `x_i - t (x_(i-1) - 2 x_i + x_(i+1)) = p_i` between the ends, by elimination.
fn diffuse(points: &mut [Point3<f64>], t: f64) {
    let last = points.len() - 1;
    // Each point is what its next one gives, times a factor, and what stands in its place.
    let mut factors = vec![0.0; points.len()];
    for i in 1..last {
        let pivot = 1.0 + 2.0 * t - t * factors[i - 1];
        factors[i] = t / pivot;
        points[i] = (points[i] + points[i - 1].coords * t) / pivot;
    }
    for i in (1..last).rev() {
        let next = points[i + 1].coords;
        points[i] += next * factors[i];
    }
}

/// Arc length at each point, as a share of the whole.
fn arc_length(axis: &[Point3<f64>]) -> Result<Vec<f64>, CylinderError> {
    let mut lengths = vec![0.0; axis.len()];
    for at in 1..axis.len() {
        lengths[at] = lengths[at - 1] + (axis[at] - axis[at - 1]).norm();
    }
    let total = lengths[axis.len() - 1];
    if !total.is_normal() {
        let centre = axis[0].into();
        return Err(CylinderError::NoAxis { centre });
    }
    Ok(lengths.iter().map(|length| length / total).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smoothing_has_the_deviation_asked_for() {
        let impulse = |i: usize| Point3::new(i as f64, f64::from(u8::from(i == 200)), 2.0);
        let points = smoothed((0..401).map(impulse).collect(), 0.025);
        let weights = points.iter().map(|p| p.y);
        assert!((weights.clone().sum::<f64>() - 1.0).abs() < 1e-6);
        let variance = points.iter().map(|p| p.y * (p.x - 200.0).powi(2));
        assert!((variance.sum::<f64>() - 100.0).abs() < 1e-2);
        // What is evenly spaced along a line stays where it is.
        for (i, p) in points.iter().enumerate() {
            assert!((p.x - i as f64).abs() < 1e-10 && (p.z - 2.0).abs() < 1e-12);
        }
    }
}
