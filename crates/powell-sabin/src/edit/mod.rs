//! Edits, each of them local: another normal, another size of a control triangle, new vertices.
//!
//! Every edit returns a new spline that passes through all vertices, old and new, with the normals
//! they had or were given. [`PowellSabinSpline::faired`] then finds the fairest gradients there.
//!
//! # Reference
//! [He2005] §3.4, Figure 6.

mod insert;

use msplines_common::progress::unobserved;
use msplines_common::{Point3, Vector3};
use nalgebra::{Rotation3, Unit};

pub use insert::{NewVertex, Target};

use crate::error::EditError;
use crate::fit::{Fit, VertexCondition, fit, tangents, unit};
use crate::options::Options;
use crate::spline::PowellSabinSpline;
use crate::tangent::{kept_across, unit_normal};

impl PowellSabinSpline {
    /// Returns the surface with another normal at a vertex: its derivatives are turned by the smallest
    /// rotation from the old normal to the new one.
    ///
    /// # Reference
    /// [He2005] Eq. (6), Figure 6.
    ///
    /// # Errors
    /// No such vertex, a normal that is no direction, or a vertex without tangent plane.
    pub fn with_normal(&self, vertex: u32, normal: Vector3<f64>) -> Result<Self, EditError> {
        self.check_vertex(vertex)?;
        let gradient = turned(self.vertex_gradient(vertex), &normal, vertex)?;
        self.with_gradient(vertex, gradient)
    }

    /// Returns the surface with the control triangle of a vertex scaled about the vertex; position and
    /// normal stay.
    ///
    /// # Reference
    /// [He2005] §3.4, Figure 6.
    ///
    /// # Errors
    /// No such vertex, or a factor that is not positive and finite.
    pub fn with_scaled_control_triangle(
        &self,
        vertex: u32,
        factor: f64,
    ) -> Result<Self, EditError> {
        self.check_vertex(vertex)?;
        if !(factor > 0.0 && factor.is_finite()) {
            return Err(EditError::Value { vertex });
        }
        let gradient = self.vertex_gradient(vertex).map(|g| factor * g);
        // What is derived from gradients is of their squares.
        if gradient.iter().any(|g| !g.norm_squared().is_finite()) {
            return Err(EditError::Value { vertex });
        }
        self.with_gradient(vertex, gradient)
    }

    /// Returns the surface whose derivatives at some vertices are the fairest for the normals that it
    /// has there; all other vertices stay as they are.
    ///
    /// # Reference
    /// [He2005] Eq. (9).
    ///
    /// # Errors
    /// No such vertex, one without tangent plane, or options that make no task.
    pub fn faired(&self, vertices: &[u32], options: &Options) -> Result<Fit, EditError> {
        let count = self.flat_domain().mesh().vertex_count() as u32;
        self.check_surface()?;
        let mut data: Vec<VertexCondition> = (0..count)
            .map(|vertex| VertexCondition::Fixed {
                position: self.vertex_position(vertex),
                gradient: self.vertex_gradient(vertex),
            })
            .collect();
        for &vertex in vertices {
            self.check_vertex(vertex)?;
            let normal = tangent_normal(self.vertex_gradient(vertex))
                .ok_or(EditError::NoTangentPlane { vertex })?;
            data[vertex as usize] = VertexCondition::Interpolate {
                position: self.vertex_position(vertex),
                normal,
            };
        }
        Ok(fit(self.flat_domain(), &data, options, &mut unobserved())?)
    }

    fn check_vertex(&self, vertex: u32) -> Result<(), EditError> {
        self.check_surface()?;
        let vertices = self.flat_domain().mesh().vertex_count();
        if (vertex as usize) < vertices {
            Ok(())
        } else {
            Err(EditError::NoSuchVertex { vertex, vertices })
        }
    }

    fn with_gradient(&self, vertex: u32, gradient: [Vector3<f64>; 2]) -> Result<Self, EditError> {
        let (domain, values, mut gradients) = self.clone().into_parts();
        let row = &mut gradients[6 * vertex as usize..][..6];
        row.copy_from_slice(&flat(gradient));
        Ok(Self::from_parts(domain, 3, values, gradients)?)
    }
}

fn flat([u, v]: [Vector3<f64>; 2]) -> [f64; 6] {
    [u.x, u.y, u.z, v.x, v.y, v.z]
}

fn tangent_normal(gradient: [Vector3<f64>; 2]) -> Option<Vector3<f64>> {
    let [u, v] = gradient;
    unit_normal(&u, &v)
}

/// Returns derivatives turned into the plane of a normal.
fn turned(
    gradient: [Vector3<f64>; 2],
    normal: &Vector3<f64>,
    vertex: u32,
) -> Result<[Vector3<f64>; 2], EditError> {
    let new = unit(normal).ok_or(EditError::Value { vertex })?;
    let old = tangent_normal(gradient).ok_or(EditError::NoTangentPlane { vertex })?;
    let rotation = Rotation3::rotation_between(&old, &new).unwrap_or_else(|| {
        // Opposite normals: half a turn about any tangent.
        let axis = Unit::new_normalize(tangents(&old)[0]);
        Rotation3::from_axis_angle(&axis, std::f64::consts::PI)
    });
    let turned = gradient.map(|g| {
        let turned = rotation * g;
        turned - new * new.dot(&turned)
    });
    Ok(kept_across(turned, &new))
}

/// Whether a point can be computed with.
fn is_finite(point: &Point3<f64>) -> bool {
    point.iter().all(|c| c.is_finite())
}
