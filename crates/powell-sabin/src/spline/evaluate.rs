//! Values, derivatives and normals at points.

use msplines_common::Vector3;
use msplines_common::evaluate::{
    Domain, EvaluateError, Evaluator, Order, Samples, SurfaceSpline, check_frames, check_points,
    flat_by_frame,
};
use msplines_common::mesh::SurfacePoint;
use rayon::prelude::*;

use super::PowellSabinSpline;
use crate::element::{gradient, value};
use crate::error::SplineError;
use crate::tangent;

/// Points that one task evaluates.
pub(crate) const POINTS_PER_TASK: usize = 1024;

/// Value, first and second derivatives of one component by the flat coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Jet {
    value: f64,
    first: [f64; 2],
    second: [f64; 3],
}

/// The coordinates that derivatives are taken by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Coordinates {
    /// `u` and `v` of the domain.
    Flat,
    /// The orthonormal frame of the face of the mesh.
    Frame,
}

impl PowellSabinSpline {
    /// Returns value and derivatives at points, by the flat coordinates `u` and `v`.
    ///
    /// Layout as in [`Samples`]. Second derivatives are constant on each micro triangle; on their
    /// edges they are those of one of the two sides.
    ///
    /// # Errors
    /// A point outside of the domain.
    pub fn evaluate_flat(
        &self,
        points: &[SurfacePoint],
        order: Order,
    ) -> Result<Samples, EvaluateError> {
        check_points(self.domain.mesh(), points)?;
        let mut out = Samples::default();
        self.evaluate_into(points, order, Coordinates::Flat, &mut out);
        Ok(out)
    }

    /// Returns the exact unit normal `F_u × F_v / |F_u × F_v|` at points of a surface.
    ///
    /// Where the derivatives are parallel there is none, and the normal is that of the face of the
    /// domain mesh.
    ///
    /// # Reference
    /// [He2005] Eq. (8).
    ///
    /// # Errors
    /// A point outside of the domain, or a spline that is not a surface.
    pub fn normals(&self, points: &[SurfacePoint]) -> Result<Vec<Vector3<f64>>, EvaluateError> {
        if let Err(error @ SplineError::NotASurface { .. }) = self.check_surface() {
            return Err(EvaluateError::Unsolvable {
                reason: error.to_string(),
            });
        }
        let samples = self.evaluate_flat(points, Order::First)?;
        let rows = samples.first.chunks_exact(6).zip(points);
        let normal = |(row, point): (&[f64], &SurfacePoint)| {
            let facet = || self.domain.mesh().face_normal(point.face);
            unit_normal(row).unwrap_or_else(|| facet().try_normalize(0.0).unwrap_or_default())
        };
        Ok(rows.map(normal).collect())
    }

    fn jet(&self, point: &SurfacePoint, component: usize, order: Order) -> Jet {
        let triangle = self.macro_triangle(point.face);
        let corners = self.corner_numbers(point.face, component);
        let at = triangle.locate(point.at);
        let mut jet = Jet {
            value: value(&triangle.ordinates(&corners), &at),
            ..Jet::default()
        };
        if order > Order::Value {
            let gradients = triangle.gradients(&corners);
            jet.first = gradient(&gradients, &at);
            if order > Order::First {
                jet.second = triangle.hessian(&gradients, at.micro);
            }
        }
        jet
    }

    fn evaluate_into(
        &self,
        points: &[SurfacePoint],
        order: Order,
        coordinates: Coordinates,
        out: &mut Samples,
    ) {
        let d = self.dimension;
        out.dimension = d;
        let [firsts, seconds] = [Order::First, Order::Second].map(|o| usize::from(order >= o));
        out.values.resize(points.len() * d, 0.0);
        out.first.resize(points.len() * d * 2 * firsts, 0.0);
        out.second.resize(points.len() * d * 3 * seconds, 0.0);
        let rows: Vec<Vec<Jet>> = points
            .par_chunks(POINTS_PER_TASK)
            .map(|chunk| {
                let mut jets = Vec::with_capacity(chunk.len() * d);
                for point in chunk {
                    let first = jets.len();
                    jets.extend((0..d).map(|c| self.jet(point, c, order)));
                    if coordinates == Coordinates::Frame && order > Order::Value {
                        let edges = self.macro_triangle(point.face).edges();
                        let change = flat_by_frame(self.domain.mesh(), point.face, edges);
                        jets[first..]
                            .iter_mut()
                            .for_each(|jet| *jet = jet.changed(change));
                    }
                }
                jets
            })
            .collect();
        for (at, jet) in rows.iter().flatten().enumerate() {
            let (point, c) = (at / d, at % d);
            out.values[at] = jet.value;
            for direction in 0..2 * firsts {
                out.first[(2 * point + direction) * d + c] = jet.first[direction];
            }
            for entry in 0..3 * seconds {
                out.second[(3 * point + entry) * d + c] = jet.second[entry];
            }
        }
    }
}

/// Returns the unit normal of six derivatives `[u, v][component]`, if they span a plane.
fn unit_normal(first: &[f64]) -> Option<Vector3<f64>> {
    let [u, v] = [0, 3].map(|at| Vector3::from_column_slice(&first[at..at + 3]));
    tangent::unit_normal(&u, &v)
}

impl Jet {
    /// Returns the derivatives by coordinates of which the flat ones are affine functions.
    fn changed(self, change: [[f64; 2]; 2]) -> Self {
        let first = change.map(|row| row[0] * self.first[0] + row[1] * self.first[1]);
        let [uu, uv, vv] = self.second;
        let second = |x: [f64; 2], y: [f64; 2]| {
            x[0] * (uu * y[0] + uv * y[1]) + x[1] * (uv * y[0] + vv * y[1])
        };
        let [a, b] = change;
        Self {
            value: self.value,
            first,
            second: [second(a, a), second(a, b), second(b, b)],
        }
    }
}

impl SurfaceSpline for PowellSabinSpline {
    fn domain(&self) -> Domain<'_> {
        Domain::Triangles(self.domain.mesh())
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
        Ok(Box::new(Prepared {
            spline: self,
            points: points.to_vec(),
            order,
        }))
    }
}

struct Prepared<'a> {
    spline: &'a PowellSabinSpline,
    points: Vec<SurfacePoint>,
    order: Order,
}

impl Evaluator for Prepared<'_> {
    fn evaluate(&self, out: &mut Samples) {
        self.spline
            .evaluate_into(&self.points, self.order, Coordinates::Frame, out);
    }
}
