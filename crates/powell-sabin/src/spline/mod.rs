//! A Powell-Sabin spline as a value: a domain, and value and gradient at every vertex.

mod basis;
mod cells;
mod evaluate;
mod tessellate;

pub use basis::Basis;
pub(crate) use evaluate::POINTS_PER_TASK;
pub use tessellate::Tessellation;

use msplines_common::{Point3, Vector3};

use crate::domain::FlatDomain;
use crate::element::{MacroTriangle, ORDINATES};
use crate::error::SplineError;

/// A C1 spline, quadratic on the Powell-Sabin split of its domain.
///
/// # Reference
/// [PowellSabin1977]; [He2005] §3.1, Eq. (1).
#[derive(Clone, Debug)]
pub struct PowellSabinSpline {
    domain: FlatDomain,
    dimension: usize,
    /// `[vertex][component]`.
    values: Vec<f64>,
    /// `[vertex][u, v][component]`.
    gradients: Vec<f64>,
}

impl PowellSabinSpline {
    /// Returns the spline of `values[vertex * dimension + component]` and
    /// `gradients[(2 * vertex + direction) * dimension + component]`, derivatives by the flat `u`
    /// (direction 0) and `v` (direction 1).
    ///
    /// # Reference
    /// [He2005] Eq. (1).
    ///
    /// # Errors
    /// Numbers that do not fit the domain, or are not finite.
    pub fn from_parts(
        domain: FlatDomain,
        dimension: usize,
        values: Vec<f64>,
        gradients: Vec<f64>,
    ) -> Result<Self, SplineError> {
        let vertices = domain.mesh().vertex_count();
        let due = vertices.checked_mul(dimension);
        let fits =
            due == Some(values.len()) && values.len().checked_mul(2) == Some(gradients.len());
        if dimension == 0 || !fits {
            return Err(SplineError::WrongLength {
                values: values.len(),
                gradients: gradients.len(),
                vertices,
                dimension,
            });
        }
        let bad = |row: &[f64]| !row.iter().all(|x| x.is_finite());
        let vertex = values
            .chunks_exact(dimension)
            .position(bad)
            .or_else(|| gradients.chunks_exact(2 * dimension).position(bad));
        match vertex {
            Some(vertex) => Err(SplineError::NotFinite { vertex }),
            None => Ok(Self {
                domain,
                dimension,
                values,
                gradients,
            }),
        }
    }

    /// Returns the domain with its flat structure.
    #[must_use]
    pub fn flat_domain(&self) -> &FlatDomain {
        &self.domain
    }

    /// Returns the number of components of a value.
    #[must_use]
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// Returns the values at the vertices, `[vertex][component]`.
    #[must_use]
    pub fn vertex_values(&self) -> &[f64] {
        &self.values
    }

    /// Returns the flat gradients at the vertices, `[vertex][u, v][component]`.
    #[must_use]
    pub fn vertex_gradients(&self) -> &[f64] {
        &self.gradients
    }

    /// Returns the number of free real coefficients: nine per vertex of a surface.
    #[must_use]
    pub fn dofs(&self) -> usize {
        self.values.len() + self.gradients.len()
    }

    /// Returns the nine numbers of one component at the corners of a face.
    pub(crate) fn corner_numbers(&self, face: u32, component: usize) -> [f64; 9] {
        let mut numbers = [0.0; 9];
        let d = self.dimension;
        for (i, &vertex) in self.domain.mesh().faces()[face as usize].iter().enumerate() {
            let vertex = vertex as usize;
            numbers[3 * i] = self.values[vertex * d + component];
            numbers[3 * i + 1] = self.gradients[2 * vertex * d + component];
            numbers[3 * i + 2] = self.gradients[(2 * vertex + 1) * d + component];
        }
        numbers
    }

    /// Returns the Bézier ordinates of one component on a face, in the order of
    /// [`MacroTriangle::ordinates`].
    ///
    /// # Panics
    /// If there is no such face or component.
    #[must_use]
    pub fn ordinates(&self, face: u32, component: usize) -> [f64; ORDINATES] {
        assert!(component < self.dimension, "a component of the spline");
        let triangle = self.domain.macro_triangle(face);
        triangle.ordinates(&self.corner_numbers(face, component))
    }

    pub(crate) fn macro_triangle(&self, face: u32) -> MacroTriangle {
        self.domain.macro_triangle(face)
    }

    pub(crate) fn check_surface(&self) -> Result<(), SplineError> {
        if self.dimension == 3 {
            Ok(())
        } else {
            Err(SplineError::NotASurface {
                dimension: self.dimension,
            })
        }
    }

    /// Returns the position of a surface at a vertex.
    pub(crate) fn vertex_position(&self, vertex: u32) -> Point3<f64> {
        Point3::from_slice(&self.values[3 * vertex as usize..][..3])
    }

    /// Returns the flat gradient of a surface at a vertex.
    pub(crate) fn vertex_gradient(&self, vertex: u32) -> [Vector3<f64>; 2] {
        let row = &self.gradients[6 * vertex as usize..][..6];
        [
            Vector3::from_column_slice(&row[..3]),
            Vector3::from_column_slice(&row[3..]),
        ]
    }

    /// Returns the domain and the numbers.
    pub(crate) fn into_parts(self) -> (FlatDomain, Vec<f64>, Vec<f64>) {
        (self.domain, self.values, self.gradients)
    }
}
