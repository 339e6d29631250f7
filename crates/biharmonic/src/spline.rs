//! A biharmonic B-spline in its implicit representation.

use std::sync::{Arc, OnceLock};

use msplines_common::evaluate::{Domain, EvaluateError, Evaluator, Order, Samples, SurfaceSpline};
use msplines_common::linalg::Mat;
use msplines_common::mesh::{SurfacePoint, TriangleMesh};

use crate::subdivision::{Extension, extend};
use crate::{FitError, Laplacian, Space};

/// Rounds of planar subdivision on whose vertices points inside of faces are evaluated.
const POINT_ROUNDS: u32 = 1;

/// Barycentric coordinates may differ from a partition of one by so much.
const BARYCENTRIC_TOLERANCE: f64 = 1e-9;

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
    #[error("number {index} of {what} is not finite")]
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
    /// The mesh carries no spline.
    #[error(transparent)]
    Space(#[from] FitError),
}

/// A biharmonic B-spline `f = a + Σ wᵢ φᵢ` over the vertices of a mesh, in any dimension.
///
/// # Reference
/// [Hou2017] Eq. (7), Theorem 1.
#[derive(Debug)]
pub struct BiharmonicSpline {
    space: Space,
    dimension: usize,
    knots: Vec<u32>,
    /// K × d, knot after knot, summing to zero in each component.
    coefficients: Vec<f64>,
    constant: Vec<f64>,
    vertex_values: OnceLock<Mat<f64>>,
}

impl BiharmonicSpline {
    pub(crate) fn new(
        space: Space,
        dimension: usize,
        knots: Vec<u32>,
        coefficients: Vec<f64>,
        constant: Vec<f64>,
    ) -> Self {
        Self {
            space,
            dimension,
            knots,
            coefficients,
            constant,
            vertex_values: OnceLock::new(),
        }
    }

    /// Builds a spline from its stored parts: knots ascending, coefficients knot after knot, and the
    /// mean over all vertices.
    ///
    /// # Errors
    /// Parts that do not belong together or to the mesh.
    pub fn from_parts(
        mesh: Arc<TriangleMesh>,
        laplacian: Laplacian,
        dimension: usize,
        knots: Vec<u32>,
        coefficients: Vec<f64>,
        constant: Vec<f64>,
    ) -> Result<Self, PartsError> {
        let vertices = mesh.vertex_count();
        for (what, list, expected) in [
            ("coefficients", &coefficients, knots.len() * dimension),
            ("constant", &constant, dimension.max(1)),
        ] {
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
        let space = Space::build(mesh, laplacian)?;
        Ok(Self::new(space, dimension, knots, coefficients, constant))
    }

    /// Returns the space the spline lives in.
    #[must_use]
    pub fn space(&self) -> &Space {
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

    /// Returns the Green's coefficients `w`, K × d, knot after knot.
    #[must_use]
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// Returns `a`, the mean over all vertices.
    #[must_use]
    pub fn constant(&self) -> &[f64] {
        &self.constant
    }

    /// Returns the spline at all vertices, n × d, vertex after vertex.
    ///
    /// Two solves with the Laplacian, which is factored on first use.
    ///
    /// # Reference
    /// [Hou2017] Alg. 1, lines 1-3.
    ///
    /// # Errors
    /// A Laplacian that cannot be factored.
    pub fn vertex_values(&self) -> Result<Vec<f64>, EvaluateError> {
        let f = self.at_vertices()?;
        Ok(row_major(f, &self.constant))
    }

    /// Returns the planar subdivision of the domain after some rounds, and the spline at its
    /// vertices (n' × d).
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
        let (mesh, f) = extend(&self.space, f, rounds, extension).map_err(unsolvable)?;
        Ok((mesh, row_major(&f, &self.constant)))
    }

    /// Returns the spline less its mean at all vertices.
    pub(crate) fn at_vertices(&self) -> Result<&Mat<f64>, EvaluateError> {
        if let Some(ready) = self.vertex_values.get() {
            return Ok(ready);
        }
        let poisson = self.space.poisson().map_err(unsolvable)?;
        let mut w = Mat::zeros(self.space.mesh().vertex_count(), self.dimension);
        for (k, &knot) in self.knots.iter().enumerate() {
            for c in 0..self.dimension {
                w[(knot as usize, c)] = self.coefficients[k * self.dimension + c];
            }
        }
        let f = poisson.solve_biharmonic(w);
        Ok(self.vertex_values.get_or_init(|| f))
    }
}

fn unsolvable(error: impl std::fmt::Display) -> EvaluateError {
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

/// Values at prepared points: combinations of three values of a vertex list.
struct Points {
    dimension: usize,
    values: Vec<f64>,
    stencils: Vec<([u32; 3], [f64; 3])>,
}

impl Evaluator for Points {
    fn evaluate(&self, out: &mut Samples) {
        out.dimension = self.dimension;
        out.first.clear();
        out.second.clear();
        out.values.clear();
        for (corners, weights) in &self.stencils {
            for c in 0..self.dimension {
                let at =
                    |i: usize| weights[i] * self.values[corners[i] as usize * self.dimension + c];
                out.values.push(at(0) + at(1) + at(2));
            }
        }
    }
}

impl SurfaceSpline for BiharmonicSpline {
    fn domain(&self) -> Domain<'_> {
        Domain::Triangles(self.space.mesh())
    }

    /// Prepares points: exact at vertices and edge midpoints, linear between them elsewhere.
    fn prepare(
        &self,
        points: &[SurfacePoint],
        order: Order,
    ) -> Result<Box<dyn Evaluator + '_>, EvaluateError> {
        if order != Order::Value {
            return Err(EvaluateError::OrderUnavailable {
                asked: order,
                available: Order::Value,
            });
        }
        let faces = self.space.mesh().faces();
        let mut all_vertices = true;
        for (index, point) in points.iter().enumerate() {
            let face = point.face;
            if face as usize >= faces.len() {
                return Err(EvaluateError::NoSuchFace {
                    point: index,
                    face,
                    faces: faces.len(),
                });
            }
            let sum: f64 = point.at.iter().sum();
            let inside = point.at.iter().all(|&b| b >= -BARYCENTRIC_TOLERANCE);
            if !(inside && (sum - 1.0).abs() <= BARYCENTRIC_TOLERANCE) {
                return Err(EvaluateError::OutsideFace { point: index, face });
            }
            all_vertices &= point.at.contains(&1.0);
        }
        let dimension = self.dimension;
        if all_vertices {
            let values = self.vertex_values()?;
            let stencils = points
                .iter()
                .map(|p| (faces[p.face as usize], p.at))
                .collect();
            return Ok(Box::new(Points {
                dimension,
                values,
                stencils,
            }));
        }
        let (mesh, values) = self.subdivision_values(POINT_ROUNDS, Extension::AreaWeighted)?;
        let stencils = points
            .iter()
            .map(|point| {
                let (child, at) = child_point(*point);
                (mesh.faces()[child as usize], at)
            })
            .collect();
        Ok(Box::new(Points {
            dimension,
            values,
            stencils,
        }))
    }
}

/// Returns the point in the faces of one midpoint subdivision, of which face `4 f + i` keeps corner
/// `i` of face `f` first and `4 f + 3` is the middle one, `(m01, m12, m20)`.
fn child_point(point: SurfacePoint) -> (u32, [f64; 3]) {
    let [a, b, c] = point.at;
    let first = 4 * point.face;
    if a >= 0.5 {
        (first, [2.0 * a - 1.0, 2.0 * b, 2.0 * c])
    } else if b >= 0.5 {
        (first + 1, [2.0 * b - 1.0, 2.0 * c, 2.0 * a])
    } else if c >= 0.5 {
        (first + 2, [2.0 * c - 1.0, 2.0 * a, 2.0 * b])
    } else {
        (first + 3, [1.0 - 2.0 * c, 1.0 - 2.0 * a, 1.0 - 2.0 * b])
    }
}
