//! Evaluation on planar subdivisions of the domain, in one solve.
//!
//! # Notation
//! `L'` is the Laplacian of the subdivided mesh, its columns split into those of new vertices `L_l`
//! and of old ones `L_r`. The new values are `-(L_lᵀ L_l)⁻¹ L_lᵀ L_r f`: the extension of least
//! squared Laplacian. The area-weighted variant minimises the integral instead of the sum.

use msplines_common::linalg::{Cholesky, Mat, Ordering, Symbolic};
use msplines_common::mesh::{
    TriangleMesh, subdivide_butterfly, subdivide_loop, subdivide_midpoint,
};
use serde::{Deserialize, Serialize};

use crate::space::{energy, operators};
use crate::{FitError, Space};

/// What the extension to a planar subdivision minimises.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extension {
    /// The integral of the squared Laplacian: the biharmonic extension of the finer mesh, with the
    /// creases of the spline.
    AreaWeighted,
    /// The plain sum of squares, as the paper has it, without creases.
    Literal,
}

/// The vertices of the subdivided mesh on which a spline is extended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scheme {
    /// On the edges of the mesh: the surface stays, and the extension is the spline.
    #[default]
    Planar,
    /// Where Loop subdivision puts them: another surface, on which the values mean nothing.
    Loop,
    /// Where modified butterfly subdivision puts them: another surface as well.
    Butterfly,
}

/// Returns the subdivision of the domain after some rounds and the extension of `f` to its vertices.
///
/// # Reference
/// [Hou2017] Alg. 1, lines 5-13. Deviation: the solve is linear in the right-hand side, so the loop
/// over knots collapses to one solve for the whole spline; area weights unless `Literal`.
pub(crate) fn extend(
    space: &Space,
    f: &Mat<f64>,
    rounds: u32,
    extension: Extension,
    scheme: Scheme,
) -> Result<(TriangleMesh, Mat<f64>), FitError> {
    let coarse = space.mesh();
    let mut mesh = TriangleMesh::clone(coarse);
    if rounds == 0 {
        return Ok((mesh, f.clone()));
    }
    let ordering = Ordering::nested_dissection(&space.operators().laplacian)?;
    let mut rank = vec![0u64; coarse.vertex_count()];
    for (k, &vertex) in ordering.as_slice().iter().enumerate() {
        rank[vertex as usize] = k as u64;
    }
    for _ in 0..rounds {
        rank = refined_rank(&mesh, &rank);
        mesh = subdivide_midpoint(&mesh, 1).0;
    }
    // All schemes number their vertices and faces alike.
    let mesh = match scheme {
        Scheme::Planar => mesh,
        Scheme::Loop => subdivide_loop(coarse, rounds),
        Scheme::Butterfly => subdivide_butterfly(coarse, rounds),
    };
    let fine = operators(&mesh, space.laplacian())?;
    let matrix = match extension {
        Extension::AreaWeighted => {
            let creases = space.creases().subdivided(coarse, &mesh, rounds);
            energy(&mesh, &fine, &creases)
        }
        Extension::Literal => fine.laplacian.congruence(&vec![1.0; fine.mass.len()]),
    };
    let mut order: Vec<u32> = (0..mesh.vertex_count() as u32).collect();
    order.sort_by_key(|&vertex| rank[vertex as usize]);
    let known = f.nrows();
    let symbolic = Symbolic::analyze_kept(&matrix, &Ordering::given(order), |row| row >= known);
    let factor = Cholesky::factor(symbolic, &matrix)?;
    let mut values = Mat::zeros(mesh.vertex_count(), f.ncols());
    values.as_mut().subrows_mut(0, known).copy_from(f);
    let mut extended = matrix.multiply(values.as_ref());
    extended *= -1.0;
    factor.solve_in_place(extended.as_mut());
    extended.as_mut().subrows_mut(0, known).copy_from(f);
    Ok((mesh, extended))
}

/// Returns the elimination ranks of the vertices of a midpoint subdivision from those of the mesh.
///
/// A midpoint goes right after the later of its end vertices. Separators of the mesh then separate
/// its midpoints too, even in the pattern of `L'ᵀ L'`, so that the fine mesh needs no dissection.
fn refined_rank(mesh: &TriangleMesh, rank: &[u64]) -> Vec<u64> {
    let edges = mesh.topology().edge_count() as u32;
    let midpoint = |edge: u32| {
        let [a, b] = mesh
            .topology()
            .edge_vertices(edge)
            .map(|v| rank[v as usize]);
        4 * a.max(b) + 1
    };
    rank.iter()
        .map(|r| 4 * r)
        .chain((0..edges).map(midpoint))
        .collect()
}
