//! A T-spline as a surface over the mesh that it was fitted to.
//!
//! # Notation
//! A point of the mesh lies at `z` on the cylinders. Vertices have moved from there by `d_i` during the
//! fit; on a face with barycentric coordinates `b_i` all points move by `Σ b_i d_i`, so that the map from
//! the mesh to the surface is continuous, and exactly that of the fit at the vertices. Around a pole `d_i`
//! are taken up to whole turns.
//!
//! # Reference
//! [He2006] Eq. (1).

use msplines_common::evaluate::{
    Domain as Points, EvaluateError, Evaluator, Order, Samples, SurfaceSpline, check_frames,
    check_points, flat_by_frame,
};
use msplines_common::mesh::SurfacePoint;
use rayon::prelude::*;

use crate::complex::{Point, UNITS};
use crate::domain::Domain;
use crate::space::Rows;
use crate::spline::{SurfaceSamples, TSpline};

/// A T-spline, the mesh that it approximates, and how the one lies over the other.
#[derive(Clone, Debug)]
pub struct TSplineSurface {
    domain: Domain,
    shifts: Vec<[f64; 2]>,
    spline: TSpline,
}

impl TSplineSurface {
    /// Lays a spline over the mesh of a domain, whose vertices have moved by `shifts`, in units.
    ///
    /// # Panics
    /// If there is not one shift per vertex of the mesh.
    #[must_use]
    pub fn new(domain: Domain, shifts: Vec<[f64; 2]>, spline: TSpline) -> Self {
        let vertices = domain.mesh().vertex_count();
        assert_eq!(shifts.len(), vertices, "one shift per vertex");
        Self {
            domain,
            shifts,
            spline,
        }
    }

    /// Returns the domain.
    #[must_use]
    pub fn domain(&self) -> &Domain {
        &self.domain
    }

    /// Returns where each vertex of the mesh lies on the cylinders. O(n).
    #[must_use]
    pub fn vertices(&self) -> Vec<Point> {
        let complex = self.domain.complex();
        let place = |v: usize| {
            let (at, _) = complex.walk(self.domain.vertex(v as u32), self.shifts[v]);
            at
        };
        (0..self.shifts.len()).into_par_iter().map(place).collect()
    }

    /// Returns how far each vertex has moved, in units.
    #[must_use]
    pub fn shifts(&self) -> &[[f64; 2]] {
        &self.shifts
    }

    /// Returns the spline on the cylinders.
    #[must_use]
    pub fn spline(&self) -> &TSpline {
        &self.spline
    }

    /// Returns where a point of the mesh lies on the cylinders. O(1).
    ///
    /// # Panics
    /// If there is no such face.
    #[must_use]
    pub fn place(&self, point: &SurfacePoint) -> Point {
        let from = self.domain.place(point);
        let mut shift = [0.0; 2];
        for ([x, y], weight) in self
            .shifts_on(point.face, from.cylinder)
            .into_iter()
            .zip(point.at)
        {
            shift = [shift[0] + weight * x, shift[1] + weight * y];
        }
        self.domain.complex().walk(from, shift).0
    }

    /// Returns how far the corners of a face have moved, none by whole turns of a cylinder more than the
    /// first: around a pole a short way may be a turn in `x`.
    fn shifts_on(&self, face: u32, cylinder: u32) -> [[f64; 2]; 3] {
        let size = self.domain.complex().cylinders()[cylinder as usize].circumference as f64;
        let corners = self.domain.mesh().faces()[face as usize];
        let [first, ..] = corners.map(|v| self.shifts[v as usize]);
        corners.map(|v| {
            let [x, y] = self.shifts[v as usize];
            [x - size * ((x - first[0]) / size).round(), y]
        })
    }

    /// Returns the derivatives of `x` and `y`, in units of the form's 1, by the coordinates of the frame of
    /// the face that a point lies on: `[[x_a, y_a], [x_b, y_b]]`.
    fn change(&self, point: &SurfacePoint) -> [[f64; 2]; 2] {
        let mesh = self.domain.mesh();
        let patch = self.domain.patch(point);
        let shifts = self.shifts_on(point.face, patch.cylinder);
        let at = |i: usize, k: usize| (patch.corners[i][k] + shifts[i][k]) / UNITS;
        let side = |i: usize| [0, 1].map(|k| at((i + 1) % 3, k) - at(i, k));
        flat_by_frame(mesh, point.face, [0, 1, 2].map(side))
    }
}

impl SurfaceSpline for TSplineSurface {
    fn domain(&self) -> Points<'_> {
        Points::Triangles(self.domain.mesh())
    }

    fn prepare(
        &self,
        points: &[SurfacePoint],
        order: Order,
    ) -> Result<Box<dyn Evaluator + '_>, EvaluateError> {
        check_points(self.domain.mesh(), points)?;
        if order > Order::Value {
            check_frames(self.domain.mesh(), points)?;
        }
        let places: Vec<Point> = points.par_iter().map(|p| self.place(p)).collect();
        let changes = match order {
            Order::Value => Vec::new(),
            _ => points.par_iter().map(|p| self.change(p)).collect(),
        };
        Ok(Box::new(Prepared {
            rows: self.spline.space().rows(&places, order),
            surface: self,
            changes,
            order,
        }))
    }
}

struct Prepared<'a> {
    surface: &'a TSplineSurface,
    rows: Rows,
    changes: Vec<[[f64; 2]; 2]>,
    order: Order,
}

impl Evaluator for Prepared<'_> {
    fn evaluate(&self, out: &mut Samples) {
        let mut found = SurfaceSamples::default();
        self.surface
            .spline
            .apply(&self.rows, self.order, &mut found);
        out.dimension = 3;
        out.values.clear();
        out.first.clear();
        out.second.clear();
        let positions = found.positions.iter();
        out.values.extend(positions.flat_map(|p| [p.x, p.y, p.z]));
        for ([x, y], change) in found.first.iter().zip(&self.changes) {
            let by_frame = change.map(|[a, b]| a * x + b * y);
            out.first
                .extend(by_frame.iter().flat_map(|v| [v.x, v.y, v.z]));
        }
        for ([xx, xy, yy], [a, b]) in found.second.iter().zip(&self.changes) {
            // The map is linear on a face, so that its own second derivatives vanish.
            let product = |p: &[f64; 2], q: &[f64; 2]| {
                p[0] * q[0] * xx + (p[0] * q[1] + p[1] * q[0]) * xy + p[1] * q[1] * yy
            };
            let entries = [product(a, a), product(a, b), product(b, b)];
            out.second
                .extend(entries.iter().flat_map(|v| [v.x, v.y, v.z]));
        }
    }
}
