//! Solids with cylindrical parameters: the method that maps to the cube are compared with.
//!
//! A harmonic function between two poles of the surface has loops as level sets. Their centres are
//! the axis of the solid, and straight lines join it to the surface. Longitude, latitude and radius
//! are the three parameters of a spline, which is periodic in longitude and degenerate on the
//! axis, where radius is 0.
//!
//! ```
//! use msplines_common::mesh::shapes;
//! use msplines_common::progress::unobserved;
//! use msplines_trivariate::cylinder::{self, Options};
//!
//! let options = Options { loops: 40, meridians: 48, radii: 9, ..Options::default() };
//! let map = cylinder::map(&shapes::sphere(600), &options, &mut unobserved())?;
//! let fit = cylinder::fit(&map, &options, &mut unobserved())?;
//! // Halfway between the poles, on the surface.
//! assert!((fit.spline.position([0.3, 0.5, 1.0]).coords.norm() - 1.0).abs() < 0.02);
//! assert!(cylinder::degenerate_places(&fit.spline, 10, 1).axis > 0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Reference
//! [Martin2008]; [Kim2014] §2.2, Fig. 11. Deviation: longitude is arc length along the loops, the
//! axis is the line of their centres and radii are straight, where the original traces gradients
//! of harmonic functions of the solid.

mod axis;
mod error;
mod latitude;
mod lattice;
mod loops;
mod options;
mod places;
mod poles;
#[cfg(test)]
mod tests;

use std::ops::ControlFlow;

use msplines_common::mesh::TriangleMesh;
use msplines_common::progress::{Observer, Outcome, Progress};
use nalgebra::Point3;
use serde::{Deserialize, Serialize};

pub use error::CylinderError;
pub use options::{Approximation, Ends, MOST_SAMPLES, Options, Poles};
pub use places::{DegeneratePlaces, degenerate_places};

use crate::error::FitError;
use crate::fit::multilevel::Level;
use crate::samples::VolumeSamples;
use crate::spline::TrivariateSpline;
use axis::Winding;
use lattice::{Fitting, Grid, cylinder_values};

/// How often loops are spaced anew along the axis of those before.
const RESPACINGS: u32 = 2;

/// A solid in cylindrical parameters, as an axis and loops around it.
#[derive(Clone, Debug, PartialEq)]
pub struct CylinderMap {
    /// The vertices that latitude 0 and 1 belong to.
    pub poles: [u32; 2],
    /// The harmonic function at each vertex, from 0 to 1.
    pub harmonic: Vec<f64>,
    /// The value of it on each loop.
    pub levels: Vec<f64>,
    /// The latitude of each loop: arc length along the axis, from 0 to 1.
    pub latitudes: Vec<f64>,
    /// The point of the axis of each loop.
    pub axis: Vec<Point3<f64>>,
    /// Points of a loop.
    pub meridians: usize,
    /// The points of all loops, one loop after another; point `j` has the longitude
    /// `j / meridians`. With collapsed ends the first and the last loop are the poles, repeated.
    pub loops: Vec<Point3<f64>>,
    /// Diagonal of the bounding box of the surface.
    pub diagonal: f64,
}

/// A spline over cylindrical parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct CylinderFit {
    /// The solid over (longitude, latitude, radius); its last three layers of control points along
    /// the first parameter are its first three, so that it is C² periodic.
    pub spline: TrivariateSpline,
    /// Residuals of the samples after each level.
    pub levels: Vec<Level>,
    /// How far the surface of the spline is from that of the solid.
    pub surface: SurfaceError,
    /// `MaxIterations` where a residual was asked for and not reached.
    pub outcome: Outcome,
}

/// Distances between points of the surface and the spline at the same parameters, as fractions of
/// the diagonal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SurfaceError {
    /// Root mean square.
    pub rms: f64,
    /// Largest.
    pub max: f64,
}

/// Returns cylindrical parameters of the solid inside of a surface.
///
/// They are right-handed: volume is positive where the lines from the axis to a loop do not cross
/// others. Cost: a sparse factorisation, then a few operations for each edge that a loop crosses.
///
/// # Reference
/// [Martin2008]. Deviation: longitude is arc length along the loops, the axis is the smoothed line
/// of their centres, radii are straight.
///
/// # Errors
/// The surface is not closed, connected and of genus 0, or has a flat face; poles that are no
/// vertices or coincide; a part of the surface so long and thin that latitude is constant there up
/// to rounding; an option that means nothing; stopped.
pub fn map(
    surface: &TriangleMesh,
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<CylinderMap, CylinderError> {
    options.check()?;
    let mut step = |done| match observer(&Progress::new("domain", done, 2)) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(CylinderError::Stopped),
    };
    step(0)?;
    let latitude = latitude::solve(surface, options.poles)?;
    step(1)?;
    let wind = |levels| Winding::build(surface, &latitude, levels, options);
    let mut winding = wind(latitude.levels(options.loops))?;
    for _ in 0..RESPACINGS {
        winding = wind(winding.evenly_spaced(options.loops))?;
    }
    Ok(CylinderMap {
        poles: latitude.poles,
        harmonic: latitude.values,
        levels: winding.levels,
        latitudes: winding.latitudes,
        axis: winding.axis,
        meridians: options.meridians,
        loops: winding.loops,
        diagonal: surface.diagonal(),
    })
}

impl CylinderMap {
    /// Returns samples at all longitudes and latitudes of the loops and at `radii` radii from 0 to
    /// 1, longitude varying fastest, then latitude.
    ///
    /// # Errors
    /// Less than two radii.
    pub fn samples(&self, radii: usize) -> Result<VolumeSamples, CylinderError> {
        let (name, value, least) = ("radii", radii, 2);
        if radii < least {
            return Err(CylinderError::Count { name, value, least });
        }
        let radii = steps(radii);
        let longitudes = self.longitudes();
        let mut parameters = Vec::with_capacity(self.loops.len() * radii.len());
        for &radius in &radii {
            for &latitude in &self.latitudes {
                parameters.extend(longitudes.iter().map(|&t| [t, latitude, radius]));
            }
        }
        let values = cylinder_values(&self.axis, &self.loops, self.meridians, &radii);
        let points = values.chunks_exact(3);
        let points = points.map(|c| Point3::new(c[0], c[1], c[2])).collect();
        Ok(VolumeSamples::build(parameters, points)?)
    }

    fn longitudes(&self) -> Vec<f64> {
        let share = |j| j as f64 / self.meridians as f64;
        (0..self.meridians).map(share).collect()
    }
}

/// Evenly spaced numbers from 0 to 1.
fn steps(count: usize) -> Vec<f64> {
    (0..count).map(|k| k as f64 / (count - 1) as f64).collect()
}

/// Returns a spline over cylindrical parameters, periodic in longitude.
///
/// Samples lie on a grid, so that a fit costs a few operations for each of them. When stopped, the
/// levels made so far are the result. The spline is periodic to the last bit.
///
/// # Reference
/// [Kim2014] §5; [LeeWolbergShin1997] §3, §4. Deviation: the lattice wraps around in longitude.
///
/// # Errors
/// Options that mean nothing.
pub fn fit(
    map: &CylinderMap,
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<CylinderFit, CylinderError> {
    options.check()?;
    options.approximation.check()?;
    let (longitudes, radii) = (map.longitudes(), steps(options.radii));
    let mut fitting = Fitting::begin(Grid {
        parameters: [&longitudes, &map.latitudes, &radii],
        values: cylinder_values(&map.axis, &map.loops, map.meridians, &radii),
    });
    let (levels, outcome) = approximate(&mut fitting, options.approximation, observer)?;
    let (spline, residuals) = fitting.finish();
    let outer = &residuals[residuals.len() - 3 * map.loops.len()..];
    let squares = outer
        .chunks_exact(3)
        .map(|r| r.iter().map(|x| x * x).sum::<f64>());
    let mean = squares.clone().sum::<f64>() / map.loops.len() as f64;
    Ok(CylinderFit {
        spline,
        levels,
        surface: SurfaceError {
            rms: mean.sqrt() / map.diagonal,
            max: squares.fold(0.0, f64::max).sqrt() / map.diagonal,
        },
        outcome,
    })
}

/// Fits level by level.
fn approximate(
    fitting: &mut Fitting<'_>,
    approximation: Approximation,
    observer: &mut Observer<'_>,
) -> Result<(Vec<Level>, Outcome), FitError> {
    let options = match approximation {
        Approximation::Multilevel(options) => options,
        Approximation::LeastSquares { spans, smoothing } => {
            return Ok((
                vec![fitting.least_squares(spans, smoothing)?],
                Outcome::Converged,
            ));
        }
    };
    let total = u64::from((options.finest / options.coarsest).ilog2()) + 1;
    let mut levels = Vec::new();
    let mut spans = options.coarsest;
    loop {
        let level = fitting.add_level(spans);
        levels.push(level);
        if level.rms <= options.stop_rms {
            return Ok((levels, Outcome::Converged));
        }
        let progress = Progress::new("fit", levels.len() as u64, total).with_objective(level.rms);
        let stopped = observer(&progress) == ControlFlow::Break(());
        if spans == options.finest {
            break;
        }
        if stopped {
            return Ok((levels, Outcome::Stopped));
        }
        spans *= 2;
    }
    let outcome = if options.stop_rms > 0.0 {
        Outcome::MaxIterations
    } else {
        Outcome::Converged
    };
    Ok((levels, outcome))
}
