//! Conformal forms of surfaces with boundary, and holes cut into surfaces.
//!
//! # Notation
//! `u` is harmonic and constant on every boundary loop, `dv = *du` its conjugate. `W_k` is an
//! integer form: how often a half-edge crosses a path of faces from loop 0 to loop `k`, from left to
//! right of the half-edge. `L` is the positive Laplacian.

mod cocycle;
mod error;
mod puncture;
#[cfg(test)]
mod tests;

pub(crate) use cocycle::between_loops;
pub use error::BoundedError;
pub use puncture::{PunctureError, puncture};

use msplines_common::linalg::{FactorError, Mat, Ordering, SymmetricMatrix, column};
use msplines_common::mesh::TriangleMesh;
use msplines_common::operators::intrinsic::{
    FlipRule, IntrinsicTriangulation, intrinsic_delaunay_by,
};
use msplines_common::progress::{Observer, Stages};

use crate::extension::{Extension, cotangent_weights, ends, laplacian};
use crate::measure::{Distortion, measure_flat};

/// Stages that the observer sees: triangulation, ordering, function and conjugate.
const STAGES: u64 = 4;

/// A closed complex form `du + i dv` on a surface with boundary.
#[derive(Clone, Debug)]
pub struct BoundedForm {
    /// The intrinsic Delaunay triangulation on which the form was computed.
    pub triangulation: IntrinsicTriangulation,
    /// `[du, dv]` along each half-edge of the triangulation.
    pub form: Vec<[f64; 2]>,
    /// `u` at each vertex.
    pub potential: Vec<f64>,
    /// The part of `v` that is a function, at each vertex: `dv` is its difference plus `periods[k]`
    /// times each of the `cocycles`.
    pub conjugate: Vec<f64>,
    /// `W_1, W_2, ...` along each half-edge of the mesh, one for each boundary loop but the first.
    pub cocycles: Vec<Vec<i32>>,
    /// The integral of `dv` around each boundary loop but the first, the surface on its left: the
    /// flux of `u` out of it.
    pub periods: Vec<f64>,
    /// How far the form is from conformal. Flips lie around its zeros, and a triangle with all
    /// corners on one boundary loop counts as one, because `u` is constant on it.
    pub distortion: Distortion,
}

impl BoundedForm {
    /// Returns `[du, dv]` along each half-edge of the mesh itself.
    ///
    /// # Panics
    /// If it is not the mesh of this form.
    #[must_use]
    pub fn on_mesh(&self, mesh: &TriangleMesh) -> Vec<[f64; 2]> {
        let jumps = combine(&self.cocycles, &self.periods);
        assemble(mesh.faces(), [&self.potential, &self.conjugate], &jumps)
    }

    /// Returns `[du, dv]` along each half-edge of another triangulation of the same mesh.
    ///
    /// # Panics
    /// If it is not one of the mesh of this form.
    #[must_use]
    pub fn on_triangulation(&self, triangulation: &IntrinsicTriangulation) -> Vec<[f64; 2]> {
        let jumps = combine(&carry_all(&self.cocycles, triangulation), &self.periods);
        assemble(
            &triangulation.faces,
            [&self.potential, &self.conjugate],
            &jumps,
        )
    }
}

/// Returns the form `du + i dv` whose real part is the harmonic function with a constant level on
/// each boundary loop.
///
/// Loops are in the order of [`Topology::boundary_loops`](msplines_common::mesh::Topology). With
/// levels 0 and 1 only, every loop is a pure source or sink and the form has `b - 2` zeros, all
/// inside; levels between may move zeros to a boundary. `e^(u + iv)`, with `v` scaled to a period
/// of 2π, maps a surface with two loops to an annulus. Cost: one ordering and two factorisations of
/// the Laplacian. Equal input gives equal bits on any number of threads.
/// `observer` sees the phase `domain`.
///
/// # Reference
/// [He2006]. Deviation: there is no double cover. Forms that the mirror turns round satisfy
/// Dirichlet conditions, forms that it keeps Neumann conditions, so that the equations are those of
/// the surface itself.
///
/// # Errors
/// A mesh that is not one surface of genus 0 with two or more boundary loops; levels that are not
/// finite, equal, or not one per loop; the observer asks to stop.
pub fn bounded_form(
    mesh: &TriangleMesh,
    levels: &[f64],
    rule: FlipRule,
    observer: &mut Observer<'_>,
) -> Result<BoundedForm, BoundedError> {
    error::check(mesh, levels)?;
    let mut stages = Stages::new("domain", STAGES, observer);
    stages.enter()?;
    let triangulation = intrinsic_delaunay_by(mesh, rule)?;
    let weights = cotangent_weights(&triangulation);
    let laplacian = laplacian(mesh.vertex_count(), &triangulation, &weights);
    stages.enter()?;
    let ordering = Ordering::minimum_degree(&laplacian, |_| true)?;
    let loops: Vec<Vec<u32>> = mesh.topology().boundary_loops();
    stages.enter()?;
    let potential = harmonic(mesh, &loops, levels, (&laplacian, &ordering))?;
    stages.enter()?;
    let flux = |half_edges: &Vec<u32>| -> f64 {
        let vertices = half_edges.iter().map(|&h| mesh.topology().origin(h));
        vertices
            .map(|v| pull(&laplacian, &potential, v as usize))
            .sum()
    };
    let periods: Vec<f64> = loops[1..].iter().map(flux).collect();
    let cocycles = between_loops(mesh.topology(), &loops);
    let jumps = combine(&carry_all(&cocycles, &triangulation), &periods);
    // Constants are free: the vertex eliminated last stays at zero.
    let grounded = ordering.as_slice().last().map_or(0, |&row| row as usize);
    let free = (0..laplacian.size()).map(|v| v != grounded).collect();
    let closed = [jumps];
    let with = (&laplacian, &ordering);
    let conjugate = coclosing(&triangulation, &weights, &closed, with, free)?;
    let conjugate = column(conjugate.as_ref(), 0).to_vec();
    let [jumps] = closed;
    let form = assemble(&triangulation.faces, [&potential, &conjugate], &jumps);
    Ok(BoundedForm {
        distortion: measure_flat(&triangulation.lengths, &form),
        triangulation,
        form,
        potential,
        conjugate,
        cocycles,
        periods,
    })
}

/// Returns the differences of two functions along each half-edge, the second one plus `jumps`.
fn assemble(faces: &[[u32; 3]], functions: [&[f64]; 2], jumps: &[f64]) -> Vec<[f64; 2]> {
    assert_eq!(
        3 * faces.len(),
        jumps.len(),
        "the triangles of another mesh"
    );
    let sides = faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let both = sides.zip(jumps);
    both.map(|([a, b], jump)| {
        let [du, dv] = functions.map(|values| values[b as usize] - values[a as usize]);
        [du, dv + jump]
    })
    .collect()
}

/// Returns the harmonic function with the given level on each boundary loop.
fn harmonic(
    mesh: &TriangleMesh,
    loops: &[Vec<u32>],
    levels: &[f64],
    (laplacian, ordering): (&SymmetricMatrix, &Ordering),
) -> Result<Vec<f64>, FactorError> {
    let mut free = vec![true; mesh.vertex_count()];
    let mut values = Mat::zeros(mesh.vertex_count(), 1);
    for (half_edges, &level) in loops.iter().zip(levels) {
        for &half_edge in half_edges {
            let vertex = mesh.topology().origin(half_edge) as usize;
            free[vertex] = false;
            values[(vertex, 0)] = level;
        }
    }
    Extension::factor(laplacian, ordering, free)?.extend(&mut values);
    Ok((0..mesh.vertex_count()).map(|v| values[(v, 0)]).collect())
}

/// Returns the functions, one column each, that are zero except at free vertices and whose differences
/// make closed forms co-closed there: with natural boundary conditions if all but one are free.
pub(crate) fn coclosing(
    triangulation: &IntrinsicTriangulation,
    weights: &[f64],
    closed: &[Vec<f64>],
    (laplacian, ordering): (&SymmetricMatrix, &Ordering),
    free: Vec<bool>,
) -> Result<Mat<f64>, FactorError> {
    let mut divergence = Mat::zeros(laplacian.size(), closed.len());
    for (k, form) in closed.iter().enumerate() {
        for (h, (&value, &weight)) in (0u32..).zip(form.iter().zip(weights)) {
            if h < triangulation.twins[h as usize] {
                let [a, b] = ends(triangulation, h).map(|v| v as usize);
                divergence[(a, k)] += weight * value;
                divergence[(b, k)] -= weight * value;
            }
        }
    }
    let mut values = Mat::zeros(laplacian.size(), closed.len());
    Extension::factor(laplacian, ordering, free)?
        .solve(&mut values, &|row, k| divergence[(row, k)]);
    Ok(values)
}

/// Returns the Laplacian of a function at a vertex, summed from differences.
fn pull(laplacian: &SymmetricMatrix, values: &[f64], vertex: usize) -> f64 {
    let others = laplacian.column(vertex).filter(|entry| entry.0 != vertex);
    others
        .map(|(other, entry)| entry * (values[other] - values[vertex]))
        .sum()
}

fn carry_all(cocycles: &[Vec<i32>], triangulation: &IntrinsicTriangulation) -> Vec<Vec<i32>> {
    let mut carried = cocycles.to_vec();
    carried
        .iter_mut()
        .for_each(|form| triangulation.carry(form));
    carried
}

/// Returns the linear combination of integer forms.
fn combine(cocycles: &[Vec<i32>], coefficients: &[f64]) -> Vec<f64> {
    let mut sum = vec![0.0; cocycles.first().map_or(0, Vec::len)];
    for (cocycle, coefficient) in cocycles.iter().zip(coefficients) {
        for (sum, &value) in sum.iter_mut().zip(cocycle) {
            *sum += coefficient * f64::from(value);
        }
    }
    sum
}
