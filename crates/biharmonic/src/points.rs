//! Values and derivatives at any point of the surface.
//!
//! # Notation
//! On a face the spline is the quadratic function through its values at the corners `λᵢ = 1` and at
//! the midpoints of the sides, which are vertices of the first planar subdivision:
//! `f = Σᵢ fᵢ λᵢ (2 λᵢ - 1) + 4 Σ f_ij λᵢ λⱼ`. It is continuous, and its gradient is that of the
//! function that is evaluated.
//!
//! The Laplacian of a smooth spline is itself a combination of Green's functions: `y = A⁻¹ L f`
//! solves `L y = w`, so that `Δf = -y` takes one solve and no differences.

use msplines_common::evaluate::{
    Domain, EvaluateError, Evaluator, Order, Samples, SurfaceSpline, check_points,
};
use msplines_common::mesh::{SurfacePoint, TriangleMesh};
use nalgebra::Vector3;

use crate::spline::unsolvable;
use crate::subdivision::Extension;
use crate::{BiharmonicSpline, Form};

/// What one point takes from the values of a vertex list: three corners and three midpoints.
struct Stencil {
    vertices: [u32; 6],
    values: [f64; 6],
    /// Derivatives along both directions of the frame of the face.
    gradients: [[f64; 6]; 2],
}

/// Values and gradients at prepared points.
struct Points {
    dimension: usize,
    order: Order,
    /// Values at the vertices of a subdivision, n' × d.
    values: Vec<f64>,
    stencils: Vec<Stencil>,
}

impl Evaluator for Points {
    fn evaluate(&self, out: &mut Samples) {
        out.dimension = self.dimension;
        out.first.clear();
        out.second.clear();
        out.values.clear();
        for stencil in &self.stencils {
            let combine = |weights: &[f64; 6], c: usize| {
                let parts = stencil.vertices.iter().zip(weights);
                parts
                    .map(|(&v, w)| w * self.values[v as usize * self.dimension + c])
                    .sum::<f64>()
            };
            out.values
                .extend((0..self.dimension).map(|c| combine(&stencil.values, c)));
            if self.order >= Order::First {
                for gradient in &stencil.gradients {
                    out.first
                        .extend((0..self.dimension).map(|c| combine(gradient, c)));
                }
            }
        }
    }
}

impl SurfaceSpline for BiharmonicSpline {
    fn domain(&self) -> Domain<'_> {
        Domain::Triangles(self.space().domain())
    }

    /// Prepares points: exact at vertices and edge midpoints, quadratic between them.
    ///
    /// Costs the factorisation of one planar subdivision, unless all points are vertices and no
    /// derivatives are asked for. Second derivatives are not available; [`Self::laplacian_at`] gives
    /// their trace.
    fn prepare(
        &self,
        points: &[SurfacePoint],
        order: Order,
    ) -> Result<Box<dyn Evaluator + '_>, EvaluateError> {
        if order > Order::First {
            return Err(EvaluateError::OrderUnavailable {
                asked: order,
                available: Order::First,
            });
        }
        let domain = self.space().domain();
        check_points(domain, points)?;
        let all_vertices = points.iter().all(|point| point.at.contains(&1.0));
        let mesh = self.space().mesh();
        let vertices_only = all_vertices && order == Order::Value;
        let (fine, values) = if vertices_only {
            (None, self.vertex_values()?)
        } else {
            let (fine, values) = self.subdivision_values(1, Extension::AreaWeighted)?;
            (Some(fine), values)
        };
        let stencil = |&point: &SurfacePoint| {
            if vertices_only {
                return at_corner(domain, point);
            }
            let place = self.space().locate(point);
            // Face 4 f + 3 of a subdivision is the middle one, (m01, m12, m20).
            let middle = fine
                .as_ref()
                .map_or([0; 3], |fine| fine.faces()[4 * place.face as usize + 3]);
            quadratic(mesh, place, middle, domain.face_frame(point.face))
        };
        Ok(Box::new(Points {
            dimension: self.dimension(),
            order,
            stencils: points.iter().map(stencil).collect(),
            values,
        }))
    }
}

impl BiharmonicSpline {
    /// Returns the Laplacian `Δf` at points of the domain, point after point, d numbers each: linear
    /// between its values at the vertices.
    ///
    /// It has a logarithmic pole at every knot, which the mesh cuts off. With creases it is the
    /// difference operator applied to the values, and means nothing at the creases themselves.
    ///
    /// # Errors
    /// A point outside of the domain, or a Laplacian that cannot be factored.
    pub fn laplacian_at(&self, points: &[SurfacePoint]) -> Result<Vec<f64>, EvaluateError> {
        check_points(self.space().domain(), points)?;
        let values = self.vertex_laplacian()?;
        let mesh = self.space().mesh();
        let dimension = self.dimension();
        let mut found = Vec::with_capacity(points.len() * dimension);
        for &point in points {
            let place = self.space().locate(point);
            let corners = mesh.faces()[place.face as usize];
            found.extend((0..dimension).map(|c| {
                let parts = corners.iter().zip(place.at);
                parts
                    .map(|(&v, b)| b * values[v as usize * dimension + c])
                    .sum::<f64>()
            }));
        }
        Ok(found)
    }

    /// Returns `-A⁻¹ L f` at the vertices of the mesh.
    fn vertex_laplacian(&self) -> Result<Vec<f64>, EvaluateError> {
        let space = self.space();
        let mass = &space.operators().mass;
        let flux = match self.form() {
            Form::Implicit { .. } => {
                let mut y = self.spread_coefficients();
                space
                    .poisson()
                    .map_err(unsolvable)?
                    .solve_in_place(y.as_mut());
                let total: f64 = mass.iter().sum();
                for side in 0..y.ncols() {
                    let weighted = (0..mass.len()).map(|v| mass[v] * y[(v, side)]).sum::<f64>();
                    (0..mass.len()).for_each(|v| y[(v, side)] -= weighted / total);
                }
                y
            }
            Form::KnotValues(_) => {
                let mut flux = space
                    .operators()
                    .laplacian
                    .multiply(self.at_vertices()?.as_ref());
                for side in 0..flux.ncols() {
                    (0..mass.len()).for_each(|v| flux[(v, side)] /= mass[v]);
                }
                flux
            }
        };
        let row = |v: usize| (0..flux.ncols()).map(move |c| (v, c));
        Ok((0..flux.nrows())
            .flat_map(row)
            .map(|at| -flux[at])
            .collect())
    }
}

fn at_corner(domain: &TriangleMesh, point: SurfacePoint) -> Stencil {
    let [a, b, c] = domain.faces()[point.face as usize];
    let [x, y, z] = point.at;
    Stencil {
        vertices: [a, b, c, a, b, c],
        values: [x, y, z, 0.0, 0.0, 0.0],
        gradients: [[0.0; 6]; 2],
    }
}

/// Returns what a point takes from the corners and the midpoints of its face.
fn quadratic(
    mesh: &TriangleMesh,
    place: SurfacePoint,
    middle: [u32; 3],
    frame: [Vector3<f64>; 2],
) -> Stencil {
    let corners = mesh.faces()[place.face as usize];
    let [a, b, c] = place.at;
    let [p, q, r] = mesh.triangle(place.face);
    let normal = mesh.face_normal(place.face);
    let squared = normal.norm_squared();
    // The gradient of a barycentric coordinate: across the opposite side, by the inverse height.
    let steep = [r - q, p - r, q - p].map(|side| normal.cross(&side) / squared);
    let sides = [(0, 1), (1, 2), (2, 0)];
    let at = place.at;
    let along = |direction: Vector3<f64>| {
        let d = steep.map(|gradient| gradient.dot(&direction));
        let corner = [0, 1, 2].map(|i| (4.0 * at[i] - 1.0) * d[i]);
        let side = sides.map(|(i, j)| 4.0 * (at[i] * d[j] + at[j] * d[i]));
        [corner[0], corner[1], corner[2], side[0], side[1], side[2]]
    };
    Stencil {
        vertices: [
            corners[0], corners[1], corners[2], middle[0], middle[1], middle[2],
        ],
        values: [
            a * (2.0 * a - 1.0),
            b * (2.0 * b - 1.0),
            c * (2.0 * c - 1.0),
            4.0 * a * b,
            4.0 * b * c,
            4.0 * c * a,
        ],
        gradients: frame.map(along),
    }
}
