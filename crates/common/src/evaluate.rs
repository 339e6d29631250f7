//! The traits through which every spline is evaluated, whatever its method.
//!
//! A method says how a point set is prepared ([`SurfaceSpline::prepare`] pays for a factorisation
//! or basis rows) and how prepared points are evaluated again and again ([`Evaluator::evaluate`]).

use crate::mesh::polygon::PolygonMesh;
use crate::mesh::{SurfacePoint, TriangleMesh};

/// How far barycentric coordinates may leave their triangle by rounding.
const BARYCENTRIC_TOLERANCE: f64 = 1e-9;

/// Data given at the vertices of a mesh: `values[vertex * dimension + component]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VertexData<'a> {
    /// Components at each vertex: 3 for positions or colours.
    pub dimension: usize,
    /// The components of one vertex after those of another.
    pub values: &'a [f64],
}

/// Highest derivative asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Order {
    /// Values only.
    Value,
    /// Values and first derivatives.
    First,
    /// Values, first and second derivatives.
    Second,
}

/// The mesh that addresses the points of a spline.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum Domain<'a> {
    /// Points are barycentric on the triangles of this mesh.
    Triangles(&'a TriangleMesh),
    /// Points are `[s, t, 0]`, bilinear, on the quads of this mesh.
    Quads(&'a PolygonMesh),
}

/// Why points cannot be evaluated.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EvaluateError {
    /// The method has no derivatives of this order.
    #[error("derivatives of order {asked:?} are not available; ask for at most {available:?}")]
    OrderUnavailable {
        /// Order that was asked for.
        asked: Order,
        /// Highest order the method has.
        available: Order,
    },
    /// A point lies on a face that the domain does not have.
    #[error("point {point} lies on face {face}, but the domain has {faces} faces")]
    NoSuchFace {
        /// Index into the points asked for.
        point: usize,
        /// Face the point names.
        face: u32,
        /// Number of faces of the domain.
        faces: usize,
    },
    /// Coordinates that are not finite or outside of the face.
    #[error("point {point} has coordinates outside of face {face}")]
    OutsideFace {
        /// Index into the points asked for.
        point: usize,
        /// Face the point names.
        face: u32,
    },
    /// A point at which derivatives by the coordinates of its face do not exist.
    #[error(
        "point {point} is the extraordinary vertex {vertex} of face {face}, where derivatives by the coordinates of the face do not exist; ask for values or geometry there, or beside it"
    )]
    NoDerivative {
        /// Index into the points asked for.
        point: usize,
        /// Face the point names.
        face: u32,
        /// The vertex.
        vertex: u32,
    },
    /// A point of a face that lies in a hole of the surface.
    #[error(
        "point {point} lies on face {face}, over which the surface has a hole; fill the holes, or ask for points beside them"
    )]
    InHole {
        /// Index into the points asked for.
        point: usize,
        /// Face the point names.
        face: u32,
    },
    /// A parameter of a solid that is not finite or outside of the unit cube.
    #[error("point {point} is no parameter of the unit cube; give three numbers from 0 to 1")]
    OutsideCube {
        /// Index into the points asked for.
        point: usize,
    },
    /// The system that extends the spline to these points could not be solved.
    #[error("the points cannot be prepared: {reason}")]
    Unsolvable {
        /// What failed.
        reason: String,
    },
}

/// A point of the unit cube over which a solid is defined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumePoint {
    /// The three parameters, each from 0 to 1.
    pub at: [f64; 3],
}

/// Values, and derivatives where asked for, at prepared points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Samples {
    /// Components of a value.
    pub dimension: usize,
    /// Values, point after point: `values[point * dimension + component]`.
    pub values: Vec<f64>,
    /// First derivatives `[point][direction 0..2][component]` in the orthonormal frame of a triangle, or
    /// by the coordinates of a quad; `[point][direction 0..3][component]` by the parameters of a solid;
    /// empty unless asked for.
    pub first: Vec<f64>,
    /// Second derivatives `[point][uu, uv, vv][component]`, of a solid
    /// `[point][uu, uv, uw, vv, vw, ww][component]`; empty unless asked for.
    pub second: Vec<f64>,
}

/// Prepared points of one spline.
pub trait Evaluator {
    /// Writes the samples of all prepared points into `out`, whose buffers are reused.
    fn evaluate(&self, out: &mut Samples);
}

/// A spline over the points of a surface mesh.
pub trait SurfaceSpline {
    /// The mesh whose points address this spline.
    fn domain(&self) -> Domain<'_>;

    /// Pays what `points` cost once, so that they can be evaluated cheaply.
    ///
    /// # Errors
    /// A point outside of the domain, or an order that the method does not have.
    fn prepare(
        &self,
        points: &[SurfacePoint],
        order: Order,
    ) -> Result<Box<dyn Evaluator + '_>, EvaluateError>;
}

/// A spline over the unit cube.
pub trait VolumeSpline {
    /// Pays what `points` cost once, so that they can be evaluated cheaply.
    ///
    /// # Errors
    /// A point outside of the unit cube, or an order that the method does not have.
    fn prepare(
        &self,
        points: &[VolumePoint],
        order: Order,
    ) -> Result<Box<dyn Evaluator + '_>, EvaluateError>;
}

/// Returns the derivatives of `u` and `v` by the two coordinates of the frame of a face, from the flat
/// vectors of its sides: `[[u_a, v_a], [u_b, v_b]]`.
///
/// # Panics
/// If there is no such face.
#[must_use]
pub fn flat_by_frame(mesh: &TriangleMesh, face: u32, edges: [[f64; 2]; 3]) -> [[f64; 2]; 2] {
    let [along, across] = mesh.face_frame(face);
    let [a, b, c] = mesh.triangle(face);
    let first = (b - a).dot(&along);
    let (x, y) = ((c - a).dot(&along), (c - a).dot(&across));
    let by_a = edges[0].map(|e| e / first);
    let by_b = [0, 1].map(|i| (-edges[2][i] - x * by_a[i]) / y);
    [by_a, by_b]
}

/// Checks that points lie on faces of a mesh.
///
/// # Errors
/// The first point on a face that is not there, or outside of its own.
pub fn check_points(mesh: &TriangleMesh, points: &[SurfacePoint]) -> Result<(), EvaluateError> {
    let faces = mesh.face_count();
    for (point, &SurfacePoint { face, at }) in points.iter().enumerate() {
        if face as usize >= faces {
            return Err(EvaluateError::NoSuchFace { point, face, faces });
        }
        let inside = at
            .iter()
            .all(|c| c.is_finite() && *c >= -BARYCENTRIC_TOLERANCE);
        if !inside || (at.iter().sum::<f64>() - 1.0).abs() > BARYCENTRIC_TOLERANCE {
            return Err(EvaluateError::OutsideFace { point, face });
        }
    }
    Ok(())
}

/// Checks that the faces of points, which are there, have a frame.
///
/// # Errors
/// The first point on a face without area.
pub fn check_frames(mesh: &TriangleMesh, points: &[SurfacePoint]) -> Result<(), EvaluateError> {
    let flat = |p: &&SurfacePoint| {
        let [a, b, c] = mesh.triangle(p.face);
        let longest = (b - a).norm_squared().max((c - a).norm_squared());
        mesh.face_normal(p.face).norm() <= f64::EPSILON * longest
    };
    points.iter().find(flat).map_or(Ok(()), |p| {
        Err(EvaluateError::Unsolvable {
            reason: format!(
                "face {} of the mesh has no area, so that it has no frame; ask for derivatives by flat coordinates",
                p.face
            ),
        })
    })
}
