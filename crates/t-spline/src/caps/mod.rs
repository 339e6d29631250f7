//! Caps: where a polynomial in a coordinate of its own replaces the T-spline.
//!
//! # Notation
//! `z = x + i y` from a zero of order `m`, in units of the form's 1, has `m + 1` sheets; there
//! `w = (z / r)^(1/(m+1))` is a coordinate. Around a pole it is `w = exp(+-2 pi i (z - z_0) / C)`. A cap is
//! `|w| < 1`; the weight `phi` is 1 in its core and falls to 0 at its border.
//!
//! # Reference
//! [He2006] §3.3 leaves the spline undefined at zeros. Deviation: caps, so that the surface is smooth.

mod error;
mod polynomial;
mod sheets;
#[cfg(test)]
mod tests;
mod weight;

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

pub use error::CapsError;
pub use polynomial::{Jet, monomials};

use crate::complex::{Beyond, Border, CylinderComplex, Point, UNITS};

/// Caps as wide as they may be, and their polynomials.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CapOptions {
    /// Total degree of the polynomial at a zero.
    pub zero_degree: u8,
    /// Total degree of the polynomial at a pole.
    pub pole_degree: u8,
}

impl Default for CapOptions {
    fn default() -> Self {
        Self {
            zero_degree: 4,
            pole_degree: 6,
        }
    }
}

/// Largest radius of a cap, as a share of the shortest connection and the lowest cylinder at its zero:
/// below a half, so that caps are disjoint.
const REACH: f64 = 0.45;
/// Radius of the core over that of the cap, as lengths of `z` at zeros and of `w` at poles.
const CORE: f64 = 0.4;
/// Height of the cap of a pole over the circumference, at first; its cylinder then ends in the core.
const POLE_HEIGHT: f64 = 0.3;

/// What a cap closes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CapKind {
    /// A zero of the form.
    Zero {
        /// Its index in the complex.
        index: u32,
        /// Its order `m`.
        order: u32,
    },
    /// A pole of the form.
    Pole {
        /// Its index in the complex.
        index: u32,
        /// The cylinder that ends there.
        cylinder: u32,
        /// Its border there.
        border: Border,
    },
}

/// One cap.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cap {
    /// What it closes.
    pub kind: CapKind,
    /// Total degree of its polynomial.
    pub degree: u8,
    /// Its radius `r` at a zero, its height above the end of the cylinder at a pole; units of the form's 1.
    pub radius: f64,
    /// The largest radius at which it is disjoint from all others.
    pub limit: f64,
    /// The first of its coefficients among those of all caps.
    pub offset: u32,
}

impl Cap {
    /// Returns the number of its coefficients.
    #[must_use]
    pub fn coefficients(&self) -> usize {
        let d = usize::from(self.degree);
        (d + 1) * (d + 2) / 2
    }
}

/// A half disk around a zero, or the end of a cylinder, in the coordinates of a cylinder.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Patch {
    cap: u32,
    border: Border,
    /// Where the zero lies.
    x: f64,
    /// The angle of `z` at which the half disk begins.
    angle: f64,
}

/// All caps of a complex.
#[derive(Clone, Debug, PartialEq)]
pub struct Caps {
    caps: Vec<Cap>,
    /// Per cylinder its circumference and height, in units, and its patches.
    patches: Vec<([f64; 2], Vec<Patch>)>,
}

/// A point in a cap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CapPoint {
    /// The cap.
    pub cap: u32,
    /// `w`.
    pub w: Complex<f64>,
    /// Its first and second derivative by `z`, in units of the form's 1.
    pub dw: [Complex<f64>; 2],
    /// The weight and its derivatives: exactly 1 in the core.
    pub phi: Jet,
    /// What is left of 1.
    pub rest: Jet,
}

impl Caps {
    /// Returns the largest caps for zeros, and caps for poles.
    ///
    /// # Errors
    /// Zeros whose half disks do not close to one disk, poles on a part of a border.
    pub fn build(complex: &CylinderComplex, options: &CapOptions) -> Result<Self, CapsError> {
        let sizes = complex.cylinders().iter();
        let sizes = sizes.map(|c| [c.circumference as f64, c.height as f64]);
        let mut caps = Self {
            caps: Vec::new(),
            patches: sizes.map(|size| (size, Vec::new())).collect(),
        };
        for zero in 0..complex.zeros() as u32 {
            caps.add_zero(complex, zero, options.zero_degree)?;
        }
        for cylinder in 0..complex.cylinders().len() as u32 {
            for border in [Border::Bottom, Border::Top] {
                caps.add_pole(complex, cylinder, border, options.pole_degree)?;
            }
        }
        Ok(caps)
    }

    fn add_zero(
        &mut self,
        complex: &CylinderComplex,
        zero: u32,
        degree: u8,
    ) -> Result<(), CapsError> {
        let sheets = sheets::around(complex, zero)?;
        let cap = self.caps.len() as u32;
        let turn = std::f64::consts::PI;
        for (place, half) in sheets.halves.iter().enumerate() {
            self.patches[half.cylinder as usize].1.push(Patch {
                cap,
                border: half.border,
                x: half.x as f64,
                angle: turn * place as f64,
            });
        }
        let order = sheets.halves.len() as u32 / 2 - 1;
        let kind = CapKind::Zero { index: zero, order };
        let limit = REACH * sheets.room as f64 / UNITS;
        self.push(kind, degree, limit, limit);
        Ok(())
    }

    fn add_pole(
        &mut self,
        complex: &CylinderComplex,
        cylinder: u32,
        border: Border,
        degree: u8,
    ) -> Result<(), CapsError> {
        let pole = |beyond| match beyond {
            Beyond::Pole { index } => Some(index),
            _ => None,
        };
        let segments = complex.border(cylinder, border);
        let Some(index) = segments.iter().find_map(|s| pole(s.beyond)) else {
            return Ok(());
        };
        let whole = |s: &crate::complex::Segment| pole(s.beyond) == Some(index) && s.zero.is_none();
        if !segments.iter().all(whole) {
            return Err(CapsError::Pole { cylinder, border });
        }
        let ([size, height], patches) = &mut self.patches[cylinder as usize];
        patches.push(Patch {
            cap: self.caps.len() as u32,
            border,
            x: 0.0,
            angle: 0.0,
        });
        let limit = REACH * *height / UNITS;
        let radius = limit.min(POLE_HEIGHT * *size / UNITS);
        let kind = CapKind::Pole {
            index,
            cylinder,
            border,
        };
        self.push(kind, degree, radius, limit);
        Ok(())
    }

    fn push(&mut self, kind: CapKind, degree: u8, radius: f64, limit: f64) {
        let offset = self.coefficients() as u32;
        self.caps.push(Cap {
            kind,
            degree,
            radius,
            limit,
            offset,
        });
    }

    /// Returns the caps, those of zeros in their order first.
    #[must_use]
    pub fn caps(&self) -> &[Cap] {
        &self.caps
    }

    /// Returns the number of coefficients of all caps.
    #[must_use]
    pub fn coefficients(&self) -> usize {
        self.caps.iter().map(Cap::coefficients).sum()
    }

    /// Changes the radius of a cap as far as its limit allows, and returns what it now is.
    ///
    /// # Panics
    /// If there is no such cap, or the radius is not positive.
    pub fn set_radius(&mut self, cap: u32, radius: f64) -> f64 {
        assert!(radius > 0.0, "a positive radius");
        let cap = &mut self.caps[cap as usize];
        cap.radius = radius.min(cap.limit);
        cap.radius
    }
}

impl Caps {
    /// Returns where in a cap a point lies, if it lies in one: there is at most one. Beside a pole `y` may
    /// lie beyond the end of the cylinder, up to infinity. At a zero itself, where `x` and `y` are no
    /// coordinates, derivatives are those at a distance of one unit.
    ///
    /// # Panics
    /// If there is no such cylinder.
    #[must_use]
    #[inline]
    pub fn at(&self, point: Point) -> Option<CapPoint> {
        let (size, patches) = &self.patches[point.cylinder as usize];
        patches.iter().find_map(|patch| {
            let cap = &self.caps[patch.cap as usize];
            match cap.kind {
                CapKind::Zero { order, .. } => at_zero(patch, cap, order, *size, point),
                CapKind::Pole { border, .. } => at_pole(patch, cap, border, *size, point),
            }
        })
    }
}

/// Returns the radius of the core of a cap as `|w|`.
pub(crate) fn core_of(kind: CapKind) -> f64 {
    match kind {
        CapKind::Zero { order, .. } => CORE.powf(1.0 / f64::from(order + 1)),
        CapKind::Pole { .. } => CORE,
    }
}

impl Caps {
    /// Returns whether a box of a cylinder, in units, shares points with a cap.
    pub(crate) fn meet(&self, cylinder: u32, x: [f64; 2], y: [f64; 2]) -> bool {
        self.meeting(cylinder, x, y).next().is_some()
    }

    /// Returns the caps with which a box of a cylinder, in units, shares points.
    pub(crate) fn meeting(
        &self,
        cylinder: u32,
        x: [f64; 2],
        y: [f64; 2],
    ) -> impl Iterator<Item = &Cap> {
        let ([size, height], patches) = &self.patches[cylinder as usize];
        let apart = |at: f64, range: [f64; 2]| (range[0] - at).max(at - range[1]).max(0.0);
        let met = move |patch: &&Patch| {
            let cap = &self.caps[patch.cap as usize];
            let reach = cap.radius * UNITS;
            let edge = match patch.border {
                Border::Bottom => 0.0,
                Border::Top => *height,
            };
            let along = apart(edge, y);
            match cap.kind {
                CapKind::Pole { .. } => along < reach,
                CapKind::Zero { .. } => [-1.0, 0.0, 1.0]
                    .into_iter()
                    .any(|turn| apart(patch.x + turn * size, x).hypot(along) < reach),
            }
        };
        patches
            .iter()
            .filter(met)
            .map(|patch| &self.caps[patch.cap as usize])
    }
}

fn at_zero(
    patch: &Patch,
    cap: &Cap,
    order: u32,
    [size, height]: [f64; 2],
    point: Point,
) -> Option<CapPoint> {
    let y = match patch.border {
        Border::Bottom => point.y.max(0.0),
        Border::Top => (point.y - height).min(0.0),
    } / UNITS;
    if y.abs() >= cap.radius {
        return None;
    }
    let across = point.x - patch.x;
    let x = (across - size * (across / size).round()) / UNITS;
    let length = x.hypot(y);
    if length >= cap.radius {
        return None;
    }
    let least = 1.0 / UNITS;
    let z = if length < least {
        Complex::new(least, 0.0)
    } else {
        Complex::new(x, y)
    };
    // A half disk below runs from the negative real axis on, as if turned by half a turn.
    let local = match patch.border {
        Border::Bottom => z.im.atan2(z.re),
        Border::Top => (0.0 - z.im).atan2(-z.re),
    };
    let share = 1.0 / f64::from(order + 1);
    let (angle, stretch) = ((patch.angle + local) * share, z.norm() / cap.radius);
    let w = Complex::from_polar(stretch.powf(share), angle);
    // L = log w has L' = 1 / ((m + 1) z).
    let slope = share / z;
    let curve = -slope / z;
    let core = core_of(cap.kind);
    let exact = if length < least {
        Complex::new(0.0, 0.0)
    } else {
        w
    };
    Some(weight::cap_point(patch.cap, w, [slope, curve], core).at(exact))
}

fn at_pole(
    patch: &Patch,
    cap: &Cap,
    border: Border,
    [size, height]: [f64; 2],
    point: Point,
) -> Option<CapPoint> {
    let (sign, deep) = match border {
        Border::Bottom => (-1.0, cap.radius - point.y / UNITS),
        Border::Top => (1.0, cap.radius - (height - point.y) / UNITS),
    };
    if deep <= 0.0 {
        return None;
    }
    let rate = std::f64::consts::TAU / (size / UNITS);
    let w = Complex::from_polar((-rate * deep).exp(), sign * rate * (point.x / UNITS));
    let slope = Complex::new(0.0, sign * rate);
    let curve = Complex::new(0.0, 0.0);
    Some(weight::cap_point(patch.cap, w, [slope, curve], CORE))
}
