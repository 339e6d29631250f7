//! A least-squares mesh as a value: controls, and the surface they imply.

use msplines_common::evaluate::{
    Domain, EvaluateError, Evaluator, Order, Samples, SurfaceSpline, VertexData, check_points,
};
use msplines_common::mesh::{SurfacePoint, TriangleMesh};

use crate::error::{FitError, check_constraints, check_controls, check_data};
use crate::fit::solve_controls;
use crate::options::Constraints;
use crate::space::Space;

/// A least-squares mesh: values at the vertices of a mesh, implied by those at its controls.
///
/// It has values at vertices only. As a [`SurfaceSpline`] it is linear on every face, and has no
/// derivatives.
#[derive(Clone, Debug)]
pub struct LsMesh {
    mesh: TriangleMesh,
    constraints: Constraints,
    dimension: usize,
    controls: Vec<u32>,
    control_values: Vec<f64>,
    values: Vec<f64>,
}

impl LsMesh {
    /// Returns the surface of stored controls, for the price of one factorisation.
    ///
    /// `control_values` has `dimension` components for each of `controls`, in their order. Equal
    /// controls and values give equal bits, whether they come from a file or from a selection.
    ///
    /// # Errors
    /// Controls, values or a weight that do not fit the mesh.
    pub fn from_parts(
        mesh: &TriangleMesh,
        constraints: Constraints,
        dimension: usize,
        controls: Vec<u32>,
        control_values: Vec<f64>,
    ) -> Result<Self, FitError> {
        let space = Space::assemble(mesh)?;
        Self::from_parts_in(&space, constraints, dimension, controls, control_values)
    }

    /// Returns the surface of stored controls in a space that is there already, for the price of one
    /// factorisation: controls are in the matrix, so that no two sets of them share one.
    ///
    /// # Reference
    /// [Hou2017] Eq. (15), §8.1.
    ///
    /// # Errors
    /// As [`Self::from_parts`].
    pub fn from_parts_in(
        space: &Space,
        constraints: Constraints,
        dimension: usize,
        controls: Vec<u32>,
        control_values: Vec<f64>,
    ) -> Result<Self, FitError> {
        let mesh = space.mesh();
        check_controls(mesh.topology(), &controls)?;
        check_constraints(constraints)?;
        let values = &control_values;
        check_data(controls.len(), VertexData { dimension, values })?;
        let values = solve_controls(space, constraints, dimension, &controls, &control_values)?.0;
        Ok(Self {
            mesh: mesh.clone(),
            constraints,
            dimension,
            controls,
            control_values,
            values,
        })
    }

    pub(crate) fn from_solved(
        mesh: TriangleMesh,
        constraints: Constraints,
        dimension: usize,
        controls: Vec<u32>,
        control_values: Vec<f64>,
        values: Vec<f64>,
    ) -> Self {
        Self {
            mesh,
            constraints,
            dimension,
            controls,
            control_values,
            values,
        }
    }

    /// Returns the control vertices in the order of their selection.
    #[must_use]
    pub fn controls(&self) -> &[u32] {
        &self.controls
    }

    /// Returns the data at the controls, [`Self::dimension`] components each.
    #[must_use]
    pub fn control_values(&self) -> &[f64] {
        &self.control_values
    }

    /// Returns how strictly the surface passes through its controls.
    #[must_use]
    pub fn constraints(&self) -> Constraints {
        self.constraints
    }

    /// Returns the number of components of a value.
    #[must_use]
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// Returns the values at all vertices, [`Self::dimension`] components each.
    #[must_use]
    pub fn vertex_values(&self) -> &[f64] {
        &self.values
    }
}

impl SurfaceSpline for LsMesh {
    fn domain(&self) -> Domain<'_> {
        Domain::Triangles(&self.mesh)
    }

    fn prepare(
        &self,
        points: &[SurfacePoint],
        order: Order,
    ) -> Result<Box<dyn Evaluator + '_>, EvaluateError> {
        if order > Order::Value {
            return Err(EvaluateError::OrderUnavailable {
                asked: order,
                available: Order::Value,
            });
        }
        check_points(&self.mesh, points)?;
        Ok(Box::new(Prepared {
            spline: self,
            points: points.to_vec(),
        }))
    }
}

struct Prepared<'a> {
    spline: &'a LsMesh,
    points: Vec<SurfacePoint>,
}

impl Evaluator for Prepared<'_> {
    fn evaluate(&self, out: &mut Samples) {
        let (dimension, values) = (self.spline.dimension, &self.spline.values);
        out.dimension = dimension;
        out.values.clear();
        out.first.clear();
        out.second.clear();
        for point in &self.points {
            let corners = self.spline.mesh.faces()[point.face as usize].map(|v| v as usize);
            for component in 0..dimension {
                let terms = corners.iter().zip(point.at);
                out.values.push(
                    terms
                        .map(|(v, at)| at * values[v * dimension + component])
                        .sum(),
                );
            }
        }
    }
}
