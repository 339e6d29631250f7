//! A biharmonic B-spline in its implicit representation.

use std::sync::{Arc, OnceLock};

use msplines_common::evaluate::EvaluateError;
use msplines_common::linalg::Mat;
use msplines_common::mesh::TriangleMesh;

use crate::Space;
use crate::knot_values::KnotValues;
use crate::subdivision::{Extension, Scheme, extend};

/// Why parts do not make a spline.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PartsError {
    /// A list has the wrong length.
    #[error("{what} has {found} numbers instead of {expected}")]
    Length {
        /// Which list.
        what: &'static str,
        /// Numbers found.
        found: usize,
        /// Numbers expected.
        expected: usize,
    },
    /// A number is NaN or infinite.
    #[error(
        "number {index} of {what} is not finite; give finite numbers, and factors and moves that do not overflow"
    )]
    NotFinite {
        /// Which list.
        what: &'static str,
        /// Index into the list.
        index: usize,
    },
    /// Knots must be distinct vertices in ascending order.
    #[error("knot {index} is vertex {vertex}; knots must be ascending vertices below {vertices}")]
    Knots {
        /// Index into the knots.
        index: usize,
        /// The vertex.
        vertex: u32,
        /// Vertices of the mesh.
        vertices: usize,
    },
    /// A spline with creases is given by its values.
    #[error("a spline with creases has no Green's coefficients; give its values at the knots")]
    Creases,
}

/// The numbers of a spline.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// The implicit form `f = a + Σ wᵢ φᵢ` of a smooth spline.
    Implicit {
        /// The Green's coefficients `w`, K × d, knot after knot, summing to zero in each component.
        coefficients: Vec<f64>,
        /// `a`, the mean over all vertices.
        constant: Vec<f64>,
    },
    /// The values at the knots, K × d, of a spline with creases: its energy has no factor that would
    /// serve all splines as that of the Laplacian does.
    KnotValues(Vec<f64>),
}

/// A biharmonic B-spline `f = a + Σ wᵢ φᵢ` over the vertices of a mesh, in any dimension.
///
/// # Reference
/// [Hou2017] Eq. (7), Theorem 1.
#[derive(Debug)]
pub struct BiharmonicSpline {
    space: Arc<Space>,
    dimension: usize,
    knots: Vec<u32>,
    form: Form,
    vertex_values: OnceLock<Mat<f64>>,
}

impl BiharmonicSpline {
    /// Returns the spline with these knots whose values at all vertices, less `mean`, are known.
    pub(crate) fn of_vertex_values(
        space: &Arc<Space>,
        knots: Vec<u32>,
        f: &Mat<f64>,
        mean: &[f64],
    ) -> Self {
        let dimension = f.ncols();
        let form = if space.creases().is_empty() {
            implicit_form(space, &knots, f, mean)
        } else {
            let value = |knot: u32, c: usize| f[(knot as usize, c)] + mean[c];
            let at = |&knot: &u32| (0..dimension).map(move |c| value(knot, c));
            Form::KnotValues(knots.iter().flat_map(at).collect())
        };
        Self::of_form(Arc::clone(space), dimension, knots, form)
    }

    /// Returns the spline of parts that are known to belong together.
    pub(crate) fn of_form(
        space: Arc<Space>,
        dimension: usize,
        knots: Vec<u32>,
        form: Form,
    ) -> Self {
        Self {
            space,
            dimension,
            knots,
            form,
            vertex_values: OnceLock::new(),
        }
    }

    /// Builds a spline from its stored parts: knots ascending, numbers knot after knot.
    ///
    /// # Errors
    /// Parts that do not belong together or to the space.
    pub fn from_parts(
        space: &Arc<Space>,
        dimension: usize,
        knots: Vec<u32>,
        form: Form,
    ) -> Result<Self, PartsError> {
        let vertices = space.mesh().vertex_count();
        let lists = match &form {
            Form::Implicit { .. } if !space.creases().is_empty() => {
                return Err(PartsError::Creases);
            }
            Form::Implicit {
                coefficients,
                constant,
            } => vec![
                ("coefficients", coefficients, knots.len() * dimension),
                ("constant", constant, dimension.max(1)),
            ],
            Form::KnotValues(values) => vec![("knot values", values, knots.len() * dimension)],
        };
        for (what, list, expected) in lists {
            if list.len() != expected {
                return Err(PartsError::Length {
                    what,
                    found: list.len(),
                    expected,
                });
            }
            if let Some(index) = list.iter().position(|value| !value.is_finite()) {
                return Err(PartsError::NotFinite { what, index });
            }
        }
        for (index, &vertex) in knots.iter().enumerate() {
            if vertex as usize >= vertices || index > 0 && knots[index - 1] >= vertex {
                return Err(PartsError::Knots {
                    index,
                    vertex,
                    vertices,
                });
            }
        }
        Ok(Self {
            space: Arc::clone(space),
            dimension,
            knots,
            form,
            vertex_values: OnceLock::new(),
        })
    }

    /// Returns the space the spline lives in.
    #[must_use]
    pub fn space(&self) -> &Arc<Space> {
        &self.space
    }

    /// Returns the knots, ascending vertex ids.
    #[must_use]
    pub fn knots(&self) -> &[u32] {
        &self.knots
    }

    /// Returns the number of components of a value.
    #[must_use]
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// Returns the numbers that make the spline.
    #[must_use]
    pub fn form(&self) -> &Form {
        &self.form
    }

    /// Returns the spline at all vertices of its domain, n × d, vertex after vertex.
    ///
    /// Two solves with the Laplacian, which is factored on first use; with creases a factorisation.
    ///
    /// # Reference
    /// [Hou2017] Alg. 1, lines 1-3.
    ///
    /// # Errors
    /// A Laplacian that cannot be factored.
    pub fn vertex_values(&self) -> Result<Vec<f64>, EvaluateError> {
        let f = self.at_vertices()?;
        let mut values = row_major(f, &self.offset());
        values.truncate(self.space.domain().vertex_count() * self.dimension);
        Ok(values)
    }

    /// Returns the planar subdivision of the mesh after some rounds, and the spline at its vertices
    /// (n' × d). With knots inside faces the mesh is that of [`Space::mesh`], where they are vertices.
    ///
    /// Each round splits every edge at its midpoint. One factorisation and one solve for all new
    /// vertices.
    ///
    /// # Errors
    /// A subdivision whose system cannot be factored.
    pub fn subdivision_values(
        &self,
        rounds: u32,
        extension: Extension,
    ) -> Result<(TriangleMesh, Vec<f64>), EvaluateError> {
        let f = self.at_vertices()?;
        let (mesh, f) =
            extend(&self.space, f, rounds, extension, Scheme::Planar).map_err(unsolvable)?;
        Ok((mesh, row_major(&f, &self.offset())))
    }

    /// Returns a subdivision of the mesh by any scheme, and what comes out when the values of its new
    /// vertices are solved for as if it were the domain: the spline for the planar one only.
    ///
    /// # Reference
    /// [Hou2017] §5, Remark 2.
    ///
    /// # Errors
    /// A subdivision whose system cannot be factored.
    pub fn extension_by(
        &self,
        scheme: Scheme,
        rounds: u32,
    ) -> Result<(TriangleMesh, Vec<f64>), EvaluateError> {
        let (f, weighted) = (self.at_vertices()?, Extension::AreaWeighted);
        let (mesh, f) = extend(&self.space, f, rounds, weighted, scheme).map_err(unsolvable)?;
        Ok((mesh, row_major(&f, &self.offset())))
    }

    /// Returns the spline less [`Self::offset`] at all vertices.
    pub(crate) fn at_vertices(&self) -> Result<&Mat<f64>, EvaluateError> {
        if let Some(ready) = self.vertex_values.get() {
            return Ok(ready);
        }
        let f = match &self.form {
            Form::Implicit { .. } => {
                let poisson = self.space.poisson().map_err(unsolvable)?;
                poisson.solve_biharmonic(self.spread_coefficients())
            }
            Form::KnotValues(values) => {
                let system =
                    KnotValues::factor(&self.space, self.knots.clone()).map_err(unsolvable)?;
                let offset = self.offset();
                let centred = Mat::from_fn(self.knots.len(), self.dimension, |k, c| {
                    values[k * self.dimension + c] - offset[c]
                });
                system.extend(centred.as_ref())
            }
        };
        Ok(self.vertex_values.get_or_init(|| f))
    }

    /// Returns the Green's coefficients at all vertices, zero where there is no knot, and everywhere
    /// with creases.
    pub(crate) fn spread_coefficients(&self) -> Mat<f64> {
        let mut w = Mat::zeros(self.space.mesh().vertex_count(), self.dimension);
        if let Form::Implicit { coefficients, .. } = &self.form {
            for (k, &knot) in self.knots.iter().enumerate() {
                for c in 0..self.dimension {
                    w[(knot as usize, c)] = coefficients[k * self.dimension + c];
                }
            }
        }
        w
    }

    /// Returns what [`Self::at_vertices`] leaves out: the mean over the vertices, or over the knots.
    pub(crate) fn offset(&self) -> Vec<f64> {
        match &self.form {
            Form::Implicit { constant, .. } => constant.clone(),
            Form::KnotValues(values) => (0..self.dimension)
                .map(|c| {
                    let component = values.iter().skip(c).step_by(self.dimension);
                    component.sum::<f64>() / self.knots.len() as f64
                })
                .collect(),
        }
    }
}

/// Returns the implicit form, its coefficients corrected to zero sum.
fn implicit_form(space: &Space, knots: &[u32], f: &Mat<f64>, mean: &[f64]) -> Form {
    let dimension = f.ncols();
    let all = space.coefficients(f);
    let mut constant = Vec::with_capacity(dimension);
    let mut coefficients = vec![0.0; knots.len() * dimension];
    for (c, mean) in mean.iter().enumerate() {
        let at = |k: usize| all[(knots[k] as usize, c)];
        let shift = (0..knots.len()).map(at).sum::<f64>() / knots.len() as f64;
        for k in 0..knots.len() {
            coefficients[k * dimension + c] = at(k) - shift;
        }
        let remaining = (0..f.nrows()).map(|v| f[(v, c)]).sum::<f64>() / f.nrows() as f64;
        constant.push(mean + remaining);
    }
    Form::Implicit {
        coefficients,
        constant,
    }
}

pub(crate) fn unsolvable(error: impl std::fmt::Display) -> EvaluateError {
    EvaluateError::Unsolvable {
        reason: error.to_string(),
    }
}

fn row_major(f: &Mat<f64>, constant: &[f64]) -> Vec<f64> {
    let mut values = Vec::with_capacity(f.nrows() * f.ncols());
    for row in 0..f.nrows() {
        values.extend(constant.iter().enumerate().map(|(c, a)| a + f[(row, c)]));
    }
    values
}
