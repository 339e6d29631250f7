//! The stored form of a biharmonic B-spline.

use std::sync::Arc;

use msplines_biharmonic::{BiharmonicSpline, Creases, Form, Laplacian, Space};
use msplines_common::mesh::{SurfacePoint, TriangleMesh};
use serde::{Deserialize, Serialize};

use crate::error::SplineFileError;

/// A biharmonic B-spline: its knots, and either Green's coefficients or, with creases, values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredBiharmonic {
    /// Components of a value.
    pub dimension: usize,
    /// Discrete Laplacian of the domain.
    pub laplacian: Laplacian,
    /// Points of the domain that are vertices as well, numbered after its own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub added_points: Vec<SurfacePoint>,
    /// Edges across which the spline need not be smooth.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub creases: Vec<[u32; 2]>,
    /// Vertices that are knots.
    pub knots: Vec<u32>,
    /// Coefficients of the Green's functions, `[knot][component]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coefficients: Option<Vec<f64>>,
    /// The constant that is added to them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub constant: Option<Vec<f64>>,
    /// Values at the knots, `[knot][component]`, of a spline with creases.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub knot_values: Option<Vec<f64>>,
}

impl StoredBiharmonic {
    /// Returns the stored form of a spline.
    #[must_use]
    pub fn of(spline: &BiharmonicSpline) -> Self {
        let (coefficients, constant, knot_values) = match spline.form().clone() {
            Form::Implicit {
                coefficients,
                constant,
            } => (Some(coefficients), Some(constant), None),
            Form::KnotValues(values) => (None, None, Some(values)),
        };
        Self {
            dimension: spline.dimension(),
            laplacian: spline.space().laplacian(),
            added_points: spline.space().added_points().to_vec(),
            creases: spline.space().creases().edges().to_vec(),
            knots: spline.knots().to_vec(),
            coefficients,
            constant,
            knot_values,
        }
    }

    /// Returns the spline on its mesh.
    ///
    /// # Errors
    /// Numbers that do not fit each other or the mesh.
    pub fn restore(&self, mesh: &TriangleMesh) -> Result<BiharmonicSpline, SplineFileError> {
        self.check(mesh.vertex_count() + self.added_points.len())?;
        self.restore_in(&Arc::new(self.space(mesh)?))
    }

    fn space(&self, mesh: &TriangleMesh) -> Result<Space, SplineFileError> {
        let domain = Arc::new(mesh.clone());
        let (points, laplacian) = (&self.added_points, self.laplacian);
        // Pieces of creases are edges of the split mesh only.
        Ok(if points.is_empty() {
            Space::with_creases(domain, laplacian, Creases::along(mesh, &self.creases)?)?
        } else {
            Space::split_at(domain, points, laplacian, &self.creases)?
        })
    }

    /// Returns the spline in the space that it was fitted in: what that has factored is not factored
    /// again.
    ///
    /// # Errors
    /// Numbers that do not fit each other or the space.
    pub(crate) fn restore_in(
        &self,
        space: &Arc<Space>,
    ) -> Result<BiharmonicSpline, SplineFileError> {
        self.check(space.mesh().vertex_count())?;
        let form = match (&self.coefficients, &self.constant, &self.knot_values) {
            (Some(coefficients), Some(constant), None) => Form::Implicit {
                coefficients: coefficients.clone(),
                constant: constant.clone(),
            },
            (None, None, Some(values)) => Form::KnotValues(values.clone()),
            _ => return Err(SplineFileError::Numbers),
        };
        let knots = self.knots.clone();
        Ok(BiharmonicSpline::from_parts(
            space,
            self.dimension,
            knots,
            form,
        )?)
    }

    fn check(&self, vertices: usize) -> Result<(), SplineFileError> {
        let values = self.coefficients.iter().chain(&self.knot_values);
        for values in values {
            super::stored::check_lengths(&self.knots, self.dimension, values, vertices)?;
        }
        match self.constant.as_ref().map_or(self.dimension, Vec::len) {
            constants if constants == self.dimension => Ok(()),
            constants => Err(SplineFileError::WrongLength {
                knots: self.knots.len(),
                dimension: self.dimension,
                values: constants,
            }),
        }
    }
}
