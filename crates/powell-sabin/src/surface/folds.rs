//! Where a surface faces away from its facets.

use msplines_common::Vector3;
use msplines_common::evaluate::Order;
use msplines_common::mesh::SurfacePoint;
use rayon::prelude::*;

use super::PowellSabinSurface;
use crate::element::gradient_places;

/// Steps along the sides of a face at which a fold is looked for, corners included.
const STEPS: u32 = 8;

impl PowellSabinSurface {
    /// Returns the faces over which the normal of the surface opposes that of the face at some point of a
    /// grid, ascending; those of open holes are not looked at.
    ///
    /// Where the surface is a spline, its normal is a quadratic on each micro triangle: if all six
    /// Bernstein coefficients agree with the face, so does all of it, and no point is taken. O(n).
    #[must_use]
    pub fn folded_faces(&self) -> Vec<u32> {
        let folded = |&face: &u32| {
            let is_plain = self.blends(face).next().is_none();
            let passed = self.is_open(face) || is_plain && self.is_upright(face);
            !passed && self.has_fold(face)
        };
        let faces = 0..self.mesh().face_count() as u32;
        faces.into_par_iter().filter(folded).collect()
    }

    /// Whether the surface is the regular spline over a face, all coefficients of whose normal agree with it.
    fn is_upright(&self, face: u32) -> bool {
        let Some(regular) = self.plain_face(face) else {
            return false;
        };
        let due = self.mesh().face_normal(face);
        let triangle = self.regular().macro_triangle(regular);
        let parts =
            [0, 1, 2].map(|c| triangle.gradients(&self.regular().corner_numbers(regular, c)));
        let slope = |at: usize, k: usize| Vector3::from(parts.each_ref().map(|g| g[at][k]));
        (0..6).all(|micro| {
            let at = gradient_places(micro);
            let product = |i: usize, j: usize| slope(at[i], 0).cross(&slope(at[j], 1)).dot(&due);
            (0..3).all(|i| (i..3).all(|j| product(i, j) + product(j, i) > 0.0))
        })
    }

    fn has_fold(&self, face: u32) -> bool {
        let due = self.mesh().face_normal(face);
        let opposes = |[i, j]: [u32; 2]| {
            let at = [STEPS - i - j, i, j].map(|k| f64::from(k) / f64::from(STEPS));
            let jet = self.jet(&SurfacePoint { face, at }, Order::First);
            jet.normal().is_some_and(|normal| normal.dot(&due) < 0.0)
        };
        let mut grid = (0..=STEPS).flat_map(|i| (0..=STEPS - i).map(move |j| [i, j]));
        grid.any(opposes)
    }
}
