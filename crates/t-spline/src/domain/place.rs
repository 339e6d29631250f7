//! Where points of the surface lie on the cylinders.

use msplines_common::mesh::SurfacePoint;

use crate::complex::Point;

use super::Domain;
use super::collapse::{Row, Snapped};
use super::cylinders::{Cylinders, RealCylinder};
use super::form::ONE;
use super::sheet::{Frame, Sheets};

/// A face laid out along a cylinder: right on the part of it that lies there, continued beyond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// The cylinder.
    pub cylinder: u32,
    /// `[x, y]` of the three corners, in units: `x` is not reduced to one turn, and corners may lie above
    /// the top and below the bottom.
    pub corners: [[f64; 2]; 3],
}

/// What takes the chart of a cylinder as it was traced to the complex.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    /// `u` at `x = 0`.
    origin: f64,
    /// Units of `x` per 1 of `u`.
    scale: f64,
    circumference: f64,
    /// `v` at the bottom, and from there to the top, in units of `v`.
    bottom: i64,
    span: f64,
    /// Its number in the complex, its height there, and how far its top is turned, in units.
    name: u32,
    height: f64,
    shear: f64,
    /// Where its parts lie, if it was collapsed.
    rows: Vec<Row>,
}

/// Returns the layouts of all cylinders, as numbered before any was collapsed.
pub(super) fn layouts(
    sheets: &Sheets,
    real: &Cylinders,
    snapped: &Snapped,
    names: &[Option<u32>],
) -> Vec<Layout> {
    let layout = |(index, own): (usize, &RealCylinder)| {
        let [bottom, top] = own.borders.map(|p| sheets.levels.value(p));
        let circumference = snapped.tables.circumferences[index] as f64;
        Layout {
            origin: own.origin,
            scale: circumference / own.circumference,
            circumference,
            bottom,
            span: (top - bottom) as f64,
            name: names[index].unwrap_or(0),
            height: snapped.tables.heights[index] as f64,
            shear: snapped.shears[index] as f64,
            rows: snapped.collapsed[index].clone().unwrap_or_default(),
        }
    };
    real.cylinders.iter().enumerate().map(layout).collect()
}

impl Domain {
    /// Returns where a point of [`Self::mesh`] lies: on a border, in the cylinder above it. Continuous
    /// over edges up to the rounding of sums along paths of faces. O(1).
    ///
    /// # Panics
    /// If there is no such face.
    #[must_use]
    pub fn place(&self, point: &SurfacePoint) -> Point {
        self.point(&self.patch(point), point.at)
    }

    /// Returns where a vertex of [`Self::mesh`] lies. O(1).
    ///
    /// # Panics
    /// If there is no such vertex.
    #[must_use]
    pub fn vertex(&self, vertex: u32) -> Point {
        let topology = self.sheets.topology();
        let mut best = (0, topology.vertex_half_edge(vertex));
        for half_edge in topology.outgoing(vertex) {
            let (face, frame) = (half_edge / 3, self.sheets.frame(half_edge / 3));
            let position = frame.positions[half_edge as usize % 3];
            // On a level: above it, if the face reaches there.
            let above = self.sheets.fragment(face, &frame, position | 1);
            let below = || self.sheets.fragment(face, &frame, position - 1);
            if let Some(fragment) = above {
                best = (fragment, half_edge);
                break;
            }
            best = below().map_or(best, |fragment| (fragment, half_edge));
        }
        let mut at = [0.0; 3];
        at[best.1 as usize % 3] = 1.0;
        let frame = self.sheets.frame(best.1 / 3);
        self.point(&self.patch_of(&frame, best.0, at), at)
    }

    /// Returns a face laid out along the cylinder that a point of it lies on: there
    /// `(x, y) = Σ at_i corners_i`. O(1).
    ///
    /// # Panics
    /// If there is no such face.
    #[must_use]
    pub fn patch(&self, point: &SurfacePoint) -> Patch {
        let frame = self.sheets.frame(point.face);
        let rise = |v: i64| (v - frame.v[0]) as f64;
        let here: f64 = point.at.iter().zip(frame.v).map(|(w, v)| w * rise(v)).sum();
        let fragments = self.sheets.fragments(point.face);
        let is_below = |number: &u32| {
            let level = frame.lowest() + 2 * (number - fragments.start) as i32 + 1;
            here < rise(self.sheets.levels.value(level))
        };
        let found = fragments.clone().find(is_below);
        self.patch_of(&frame, found.unwrap_or(fragments.end - 1), point.at)
    }

    fn patch_of(&self, frame: &Frame, fragment: u32, at: [f64; 3]) -> Patch {
        let chart = self.charts[fragment as usize];
        let layout = &self.layouts[chart.cylinder as usize];
        let start = ((chart.u - layout.origin) * layout.scale).rem_euclid(layout.circumference);
        let xs = frame.u.map(|u| start + u * layout.scale);
        let bottom = layout.bottom - i64::from(chart.lift) * ONE;
        let shares = frame.v.map(|v| {
            let above = (v - bottom) as f64;
            if layout.span > 0.0 {
                above / layout.span
            } else {
                0.0
            }
        });
        let x: f64 = xs.iter().zip(at).map(|(x, w)| x * w).sum();
        if layout.rows.is_empty() {
            let corner = |i: usize| [xs[i] + layout.shear * shares[i], layout.height * shares[i]];
            return Patch {
                cylinder: layout.name,
                corners: [0, 1, 2].map(corner),
            };
        }
        let (cylinder, there) = self.fall(layout, x);
        Patch {
            cylinder,
            corners: xs.map(|corner| [corner - x + there, 0.0]),
        }
    }

    /// The cylinder on whose bottom a point of a collapsed one lies, and where.
    fn fall<'a>(&'a self, mut layout: &'a Layout, mut x: f64) -> (u32, f64) {
        loop {
            let into = |row: &Row| (x - row.start as f64).rem_euclid(layout.circumference);
            let past = |row: &Row| into(row) - row.length as f64;
            let rows = layout.rows.iter();
            let Some(row) = rows.min_by(|a, b| past(a).total_cmp(&past(b))) else {
                return (layout.name, x);
            };
            x = row.there as f64 + into(row);
            layout = &self.layouts[row.cylinder as usize];
        }
    }

    fn point(&self, patch: &Patch, at: [f64; 3]) -> Point {
        let own = &self.complex.cylinders()[patch.cylinder as usize];
        let sum = |i: usize| -> f64 { patch.corners.iter().zip(at).map(|(c, w)| c[i] * w).sum() };
        let x = sum(0).rem_euclid(own.circumference as f64);
        Point {
            cylinder: patch.cylinder,
            // Rounding may return the modulus itself.
            x: if x < own.circumference as f64 { x } else { 0.0 },
            y: sum(1).clamp(0.0, own.height as f64),
        }
    }

    /// Returns units per length of the model: the root of the area of the complex over that of the mesh.
    #[must_use]
    pub fn units_per_length(&self) -> f64 {
        let mesh = &self.sheets.mesh;
        let doubled = |face: u32| mesh.face_normal(face).norm();
        let area = 0.5 * (0..mesh.face_count() as u32).map(doubled).sum::<f64>();
        (self.complex.area() as f64 / area).sqrt()
    }
}
