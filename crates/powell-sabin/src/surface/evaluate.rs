//! Values, derivatives and normals at points of the whole surface.

use msplines_common::Vector3;
use msplines_common::evaluate::{
    Domain, EvaluateError, Evaluator, Order, Samples, SurfaceSpline, check_frames, check_points,
    flat_by_frame,
};
use msplines_common::mesh::SurfacePoint;
use rayon::prelude::*;

use super::PowellSabinSurface;
use super::hole::Cap;
use super::jet::{Jet, scalar_jet, spline_jet};
use crate::spline::POINTS_PER_TASK;
use crate::tangent::unit_normal;

impl PowellSabinSurface {
    /// Returns the exact unit normal at points, as [`PowellSabinSpline::normals`] does.
    ///
    /// # Reference
    /// [He2005] Eq. (8).
    ///
    /// # Errors
    /// A point outside of the mesh, or in an open hole.
    ///
    /// [`PowellSabinSpline::normals`]: crate::PowellSabinSpline::normals
    pub fn normals(&self, points: &[SurfacePoint]) -> Result<Vec<Vector3<f64>>, EvaluateError> {
        self.check(points)?;
        Ok(self.sample_normals(points))
    }

    /// Returns the normals at points that were checked.
    pub(super) fn sample_normals(&self, points: &[SurfacePoint]) -> Vec<Vector3<f64>> {
        let normal = |point: &SurfacePoint| self.normal(point, &self.jet(point, Order::First));
        points.par_iter().map(normal).collect()
    }

    /// Returns the normal of a jet; that of the face where it has none. At vertices it is that of the
    /// control triangle, which maps between charts do not round.
    pub(super) fn normal(&self, point: &SurfacePoint, jet: &Jet) -> Vector3<f64> {
        let facet = || self.mesh.face_normal(point.face);
        let corner = point.at.iter().position(|&weight| weight == 1.0);
        corner
            .and_then(|corner| self.corner_normal(point.face, corner))
            .or_else(|| jet.normal())
            .unwrap_or_else(|| facet().try_normalize(0.0).unwrap_or_default())
    }

    /// Returns the normal at a corner of a face that is not on a minimal cap.
    fn corner_normal(&self, face: u32, corner: usize) -> Option<Vector3<f64>> {
        let vertex = self.mesh.faces()[face as usize][corner];
        let smooth = |number: u32| match self.holes.get(number as usize)?.cap() {
            Cap::Smooth(cap) => cap.vertex_normal(vertex),
            _ => None,
        };
        let Some(regular) = self.plain_face(face) else {
            return smooth(self.hole_of_face[face as usize]);
        };
        smooth(self.rim_of_vertex[vertex as usize]).or_else(|| {
            let place = self.regular.flat_domain().mesh().faces()[regular as usize][corner];
            let [u, v] = self.regular.vertex_gradient(place);
            unit_normal(&u, &v)
        })
    }

    /// Checks that the surface is defined at points.
    pub(super) fn check(&self, points: &[SurfacePoint]) -> Result<(), EvaluateError> {
        check_points(&self.mesh, points)?;
        let in_hole = points.iter().position(|p| self.is_open(p.face));
        in_hole.map_or(Ok(()), |point| {
            let face = points[point].face;
            Err(EvaluateError::InHole { point, face })
        })
    }

    /// Whether a face lies in a hole that nothing fills.
    pub(crate) fn is_open(&self, face: u32) -> bool {
        let hole = self.holes.get(self.hole_of_face[face as usize] as usize);
        hole.is_some_and(|hole| matches!(hole.cap, Cap::Open))
    }

    /// Returns the surface at a point, by the flat coordinates of its face: `u` and `v` of the form
    /// outside of holes, the second and third barycentric coordinate inside.
    pub(super) fn jet(&self, point: &SurfacePoint, order: Order) -> Jet {
        let &SurfacePoint { face, at } = point;
        let Some(regular) = self.plain_face(face) else {
            return match &self.holes[self.hole_of_face[face as usize] as usize].cap {
                Cap::Open => Jet::default(),
                Cap::Smooth(cap) => cap.inside(face, at, order),
                Cap::Minimal(cap) => cap.jet(face, at, order),
            };
        };
        let plain = spline_jet(&self.regular, regular, at, order);
        let mut jet = plain;
        for number in self.blends(face) {
            let Cap::Smooth(cap) = &self.holes[number as usize].cap else {
                continue;
            };
            let triangle = self.regular.macro_triangle(regular);
            let mut corners = [0.0; 9];
            for (i, &vertex) in self.mesh.faces()[face as usize].iter().enumerate() {
                let on_rim = self.rim_of_vertex[vertex as usize] == number;
                corners[3 * i] = f64::from(u8::from(on_rim));
            }
            let weight = scalar_jet(&triangle, &corners, at, order);
            jet.add_blend(&weight, &plain, &cap.beside(face, at, order));
        }
        jet
    }

    /// Returns the derivatives of the coordinates of [`Self::jet`] by those of the frame of the face.
    fn change(&self, face: u32) -> [[f64; 2]; 2] {
        let edges = match self.plain_face(face) {
            Some(regular) => self.regular.macro_triangle(regular).edges(),
            // Barycentric coordinates are flat ones in which the corners are (0, 0), (1, 0), (0, 1).
            None => [[1.0, 0.0], [-1.0, 1.0], [0.0, -1.0]],
        };
        flat_by_frame(&self.mesh, face, edges)
    }

    /// Writes samples at points that were checked.
    fn sample(&self, points: &[SurfacePoint], order: Order, out: &mut Samples) {
        let in_frame = |point: &SurfacePoint| {
            let jet = self.jet(point, order);
            if order > Order::Value {
                jet.changed(self.change(point.face))
            } else {
                jet
            }
        };
        let jets: Vec<Jet> = points
            .par_iter()
            .with_min_len(POINTS_PER_TASK)
            .map(in_frame)
            .collect();
        out.dimension = 3;
        out.values.clear();
        out.first.clear();
        out.second.clear();
        out.values
            .extend(jets.iter().flat_map(|j| <[f64; 3]>::from(j.value)));
        if order >= Order::First {
            let rows = jets.iter().flat_map(|j| j.first);
            out.first.extend(rows.flat_map(<[f64; 3]>::from));
        }
        if order >= Order::Second {
            let rows = jets.iter().flat_map(|j| j.second);
            out.second.extend(rows.flat_map(<[f64; 3]>::from));
        }
    }
}

impl SurfaceSpline for PowellSabinSurface {
    fn domain(&self) -> Domain<'_> {
        Domain::Triangles(&self.mesh)
    }

    fn prepare(
        &self,
        points: &[SurfacePoint],
        order: Order,
    ) -> Result<Box<dyn Evaluator + '_>, EvaluateError> {
        self.check(points)?;
        if order > Order::Value {
            check_frames(&self.mesh, points)?;
        }
        Ok(Box::new(Prepared {
            surface: self,
            points: points.to_vec(),
            order,
        }))
    }
}

struct Prepared<'a> {
    surface: &'a PowellSabinSurface,
    points: Vec<SurfacePoint>,
    order: Order,
}

impl Evaluator for Prepared<'_> {
    fn evaluate(&self, out: &mut Samples) {
        self.surface.sample(&self.points, self.order, out);
    }
}
