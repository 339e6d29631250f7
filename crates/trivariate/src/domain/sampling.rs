//! Points of a solid with their parameters, spread evenly.
//!
//! # Notation
//! Points are drawn by two measures, half of them each: volume or area of the solid, and of the cube.
//! Squeezed parts of the cube would else have no sample, and nothing would hold the spline there.
//! Sample `i` of `N` lies in the cell that holds the share `(i + ½) / N` of the measure, at the
//! `i`-th point of a sequence of low discrepancy: no seed, and the same points on any machine.

use msplines_common::Point3;
use msplines_common::mesh::TriangleMesh;
use msplines_common::mesh::tet::TetMesh;
use msplines_common::metrics::SurfaceTree;
use rayon::prelude::*;

/// Steps of the sequence in three directions: inverse powers of the root of `x⁴ = x + 1`.
const STEPS: [f64; 3] = [
    0.819_172_513_396_164_4,
    0.671_043_606_703_789_2,
    0.549_700_477_901_970_2,
];

/// A place of the solid and its parameter.
pub(crate) type Sample = ([f64; 3], Point3<f64>);

/// Which points are drawn: two sets that have no point in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Draw {
    /// Those that a fit sees.
    Fitted,
    /// Those that it does not see.
    HeldOut,
}

impl Draw {
    fn shift(self) -> f64 {
        match self {
            Self::Fitted => 0.5,
            Self::HeldOut => 0.25,
        }
    }
}

/// What points are drawn from: a solid with parameters, and the surface that it shall have.
pub(crate) struct Sampler<'a> {
    mesh: &'a TetMesh,
    parameters: &'a [[f64; 3]],
    surface: &'a TriangleMesh,
    boundary: TriangleMesh,
    to_surface: &'a SurfaceTree,
    to_boundary: SurfaceTree,
}

impl<'a> Sampler<'a> {
    pub(crate) fn new(
        mesh: &'a TetMesh,
        parameters: &'a [[f64; 3]],
        (surface, to_surface): (&'a TriangleMesh, &'a SurfaceTree),
    ) -> Self {
        let boundary = mesh.boundary();
        Self {
            to_boundary: SurfaceTree::build(&boundary),
            mesh,
            parameters,
            surface,
            boundary,
            to_surface,
        }
    }

    /// Points inside, about half by each measure.
    pub(crate) fn interior(&self, count: usize, draw: Draw) -> Vec<Sample> {
        let cells = self.mesh.cells();
        let volume = |points: [Point3<f64>; 4]| {
            let [a, b, c, d] = points;
            (b - a).dot(&(c - a).cross(&(d - a))).max(0.0)
        };
        let object: Vec<f64> = (0..cells.len() as u32)
            .map(|cell| volume(self.mesh.tetrahedron(cell)))
            .collect();
        let image = |cell: &[u32; 4]| cell.map(|v| Point3::from(self.parameters[v as usize]));
        let cube: Vec<f64> = cells.iter().map(|cell| volume(image(cell))).collect();
        let half = count / 2;
        let mut drawn = spread(&object, count - half, draw);
        drawn.extend(spread(&cube, half, draw));
        drawn
            .into_par_iter()
            .map(|(cell, at)| {
                let weights = in_tetrahedron(at);
                let image = image(&cells[cell as usize]).map(|p| p.coords.into());
                let points = self.mesh.tetrahedron(cell).map(|p| p.coords.into());
                let parameter = blend(&image, &weights).map(|t| t.clamp(0.0, 1.0));
                (parameter, Point3::from(blend(&points, &weights)))
            })
            .collect()
    }

    /// Points of the surface, about half by each measure.
    pub(crate) fn surface(&self, count: usize, draw: Draw) -> Vec<Sample> {
        let half = count / 2;
        let mut samples = self.by_area(count - half, draw);
        samples.extend(self.by_cube(half, draw));
        samples
    }

    /// Points of the surface evenly by its area.
    pub(crate) fn by_area(&self, count: usize, draw: Draw) -> Vec<Sample> {
        let areas: Vec<f64> = (0..self.surface.face_count() as u32)
            .map(|face| self.surface.face_normal(face).norm())
            .collect();
        let drawn = spread(&areas, count, draw);
        let points = drawn.into_par_iter().map(|(face, at)| {
            let triangle = self.surface.triangle(face).map(|p| p.coords.into());
            Point3::from(blend(&triangle, &in_triangle(at)))
        });
        points
            .filter_map(|point| self.parameter(&point).map(|parameter| (parameter, point)))
            .collect()
    }

    /// The parameter of the boundary's point that is closest.
    pub(crate) fn parameter(&self, point: &Point3<f64>) -> Option<[f64; 3]> {
        let closest = self.to_boundary.closest(point)?.point;
        Some(blend(&self.face_image(closest.face), &closest.at).map(|t| t.clamp(0.0, 1.0)))
    }

    /// Points of the surface evenly by the area of the cube.
    fn by_cube(&self, count: usize, draw: Draw) -> Vec<Sample> {
        let area = |face: u32| {
            let [a, b, c] = self.face_image(face).map(Point3::from);
            (b - a).cross(&(c - a)).norm()
        };
        let areas: Vec<f64> = (0..self.boundary.face_count() as u32).map(area).collect();
        let drawn = spread(&areas, count, draw);
        let samples = drawn.into_par_iter().filter_map(|(face, at)| {
            let weights = in_triangle(at);
            let triangle = self.boundary.triangle(face).map(|p| p.coords.into());
            let point = Point3::from(blend(&triangle, &weights));
            let closest = self.to_surface.closest(&point)?.point;
            let parameter = blend(&self.face_image(face), &weights).map(|t| t.clamp(0.0, 1.0));
            Some((parameter, self.surface.position(closest)))
        });
        samples.collect()
    }

    fn face_image(&self, face: u32) -> [[f64; 3]; 3] {
        let vertices = self.mesh.topology().boundary_vertices();
        let corners = self.boundary.faces()[face as usize];
        corners.map(|v| self.parameters[vertices[v as usize] as usize])
    }
}

/// A weighted mean of points; a coordinate that all have in common stays what it is.
fn blend<const N: usize>(points: &[[f64; 3]; N], weights: &[f64; N]) -> [f64; 3] {
    std::array::from_fn(|d| {
        let rest = points[1..].iter().zip(&weights[1..]);
        points[0][d] + rest.map(|(p, w)| w * (p[d] - points[0][d])).sum::<f64>()
    })
}

/// Cells that hold equal shares of a measure, each with a point of the unit cube.
fn spread(measure: &[f64], count: usize, draw: Draw) -> Vec<(u32, [f64; 3])> {
    let total: f64 = measure.iter().sum();
    if !(total > 0.0 && total.is_finite()) {
        return Vec::new();
    }
    let shift = draw.shift();
    let (mut cell, mut until) = (0, measure[0]);
    (0..count)
        .map(|i| {
            let share = (i as f64 + shift) / count as f64 * total;
            while until < share && cell + 1 < measure.len() {
                cell += 1;
                until += measure[cell];
            }
            let at = STEPS.map(|step| (shift + (i as f64 + 1.0) * step).fract());
            (cell as u32, at)
        })
        .collect()
}

/// Barycentric coordinates, from a square folded to a triangle.
fn in_triangle([s, t, _]: [f64; 3]) -> [f64; 3] {
    let [s, t] = if s + t > 1.0 {
        [1.0 - s, 1.0 - t]
    } else {
        [s, t]
    };
    [1.0 - s - t, s, t]
}

/// Barycentric coordinates, from a cube folded to a tetrahedron.
fn in_tetrahedron([s, t, u]: [f64; 3]) -> [f64; 4] {
    let [s, t] = if s + t > 1.0 {
        [1.0 - s, 1.0 - t]
    } else {
        [s, t]
    };
    let [s, t, u] = if t + u > 1.0 {
        [s, 1.0 - u, 1.0 - s - t]
    } else if s + t + u > 1.0 {
        [1.0 - t - u, t, s + t + u - 1.0]
    } else {
        [s, t, u]
    };
    [1.0 - s - t - u, s, t, u]
}
