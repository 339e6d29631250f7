//! The B-spline form: control points instead of values and gradients.

use super::PowellSabinSpline;
use crate::domain::FlatDomain;
use crate::element::ORDINATES;
use crate::error::SplineError;
use crate::triangles::{PowellSabinTriangle, powell_sabin_triangles};

/// The normalised basis of a domain: three functions per vertex, one for each corner of its
/// Powell-Sabin triangle; they are non-negative and sum to one.
///
/// # Reference
/// [Dierckx1997]; [He2005] Eq. (2), Eq. (3), Eq. (4).
#[derive(Clone, Debug)]
pub struct Basis {
    domain: FlatDomain,
    triangles: Vec<PowellSabinTriangle>,
}

impl Basis {
    /// Returns the basis of a domain.
    #[must_use]
    pub fn new(domain: &FlatDomain) -> Self {
        Self {
            domain: domain.clone(),
            triangles: powell_sabin_triangles(domain),
        }
    }

    /// Returns the Powell-Sabin triangle of every vertex.
    #[must_use]
    pub fn triangles(&self) -> &[PowellSabinTriangle] {
        &self.triangles
    }

    /// Returns a basis function as a spline of one component.
    ///
    /// # Panics
    /// If there is no such vertex or corner.
    #[must_use]
    pub fn function(&self, vertex: u32, corner: usize) -> PowellSabinSpline {
        let count = self.triangles.len();
        let (mut values, mut gradients) = (vec![0.0; count], vec![0.0; 2 * count]);
        let at = vertex as usize;
        let triplet = self.triangles[at].triplets()[corner];
        values[at] = triplet[0];
        gradients[2 * at..2 * at + 2].copy_from_slice(&triplet[1..]);
        PowellSabinSpline {
            domain: self.domain.clone(),
            dimension: 1,
            values,
            gradients,
        }
    }

    /// Returns the Bézier ordinates, on a face, of the nine basis functions of its corners: those of
    /// corner 0 first. All others vanish there.
    ///
    /// # Panics
    /// If there is no such face.
    #[must_use]
    pub fn ordinates(&self, face: u32) -> [[f64; ORDINATES]; 9] {
        let triangle = self.domain.macro_triangle(face);
        let vertices = self.domain.mesh().faces()[face as usize];
        let mut out = [[0.0; ORDINATES]; 9];
        for (i, vertex) in vertices.into_iter().enumerate() {
            let triplets = self.triangles[vertex as usize].triplets();
            for (j, triplet) in triplets.into_iter().enumerate() {
                let mut corners = [0.0; 9];
                corners[3 * i..3 * i + 3].copy_from_slice(&triplet);
                out[3 * i + j] = triangle.ordinates(&corners);
            }
        }
        out
    }

    /// Returns the values of the nine basis functions of the corners of a face at a point of it.
    ///
    /// # Panics
    /// If there is no such face.
    #[must_use]
    pub fn values(&self, face: u32, at: [f64; 3]) -> [f64; 9] {
        let point = self.domain.macro_triangle(face).locate(at);
        self.ordinates(face)
            .map(|ordinates| crate::element::value(&ordinates, &point))
    }

    /// Returns the control points of a spline over this domain, `[vertex][corner][component]`: the
    /// tangent plane of a vertex over the corners of its triangle.
    ///
    /// # Reference
    /// [He2005] Eq. (5), Eq. (7). Deviation: gradients are stored, and control points follow from them.
    ///
    /// # Panics
    /// If the spline has another number of vertices.
    #[must_use]
    pub fn control_points(&self, spline: &PowellSabinSpline) -> Vec<f64> {
        let d = spline.dimension;
        assert_eq!(
            spline.values.len(),
            d * self.triangles.len(),
            "the domain of the spline"
        );
        let mut out = Vec::with_capacity(9 * spline.values.len());
        for (vertex, triangle) in self.triangles.iter().enumerate() {
            for [u, v] in triangle.corners() {
                let gradient = &spline.gradients[2 * vertex * d..][..2 * d];
                out.extend((0..d).map(|c| {
                    spline.values[vertex * d + c] + u * gradient[c] + v * gradient[d + c]
                }));
            }
        }
        out
    }

    /// Returns the spline of control points `[vertex][corner][component]`.
    ///
    /// # Reference
    /// [He2005] Eq. (2).
    ///
    /// # Errors
    /// Control points that are not finite, or not three per vertex.
    pub fn spline(
        &self,
        dimension: usize,
        control_points: &[f64],
    ) -> Result<PowellSabinSpline, SplineError> {
        let vertices = self.triangles.len();
        if dimension == 0 || control_points.len() != 3 * vertices * dimension {
            return Err(SplineError::WrongLength {
                values: control_points.len() / 3,
                gradients: control_points.len() / 3 * 2,
                vertices,
                dimension,
            });
        }
        let mut values = Vec::with_capacity(vertices * dimension);
        let mut gradients = Vec::with_capacity(2 * vertices * dimension);
        let rows = control_points.chunks_exact(3 * dimension);
        for (triangle, points) in self.triangles.iter().zip(rows) {
            let triplets = triangle.triplets();
            // Derivatives sum to zero over the corners: take one point off before.
            let sum = |kind: usize, c: usize| -> f64 {
                let offsets =
                    (1..3).map(|j| triplets[j][kind] * (points[j * dimension + c] - points[c]));
                offsets.sum()
            };
            values.extend((0..dimension).map(|c| points[c] + sum(0, c)));
            for kind in 1..3 {
                gradients.extend((0..dimension).map(|c| sum(kind, c)));
            }
        }
        PowellSabinSpline::from_parts(self.domain.clone(), dimension, values, gradients)
    }
}

impl PowellSabinSpline {
    /// Returns the control triangle of every vertex, which is tangent to the surface there.
    ///
    /// # Reference
    /// [He2005] Eq. (5), Eq. (8).
    ///
    /// # Errors
    /// A spline that is not a surface.
    pub fn control_triangles(&self) -> Result<Vec<[msplines_common::Point3<f64>; 3]>, SplineError> {
        self.check_surface()?;
        let points = Basis::new(&self.domain).control_points(self);
        let corner =
            |row: &[f64], j: usize| msplines_common::Point3::from_slice(&row[3 * j..][..3]);
        let rows = points.chunks_exact(9);
        Ok(rows.map(|row| [0, 1, 2].map(|j| corner(row, j))).collect())
    }
}
