//! Harmonic and holomorphic 1-forms of a closed surface of genus g >= 1.
//!
//! Each integer closed form `W_k` is made harmonic by a function: `H_k = W_k + df_k`, where
//! `L f_k = -dᵀ c W_k` for the cotangent weights `c` of the intrinsic Delaunay triangulation. The
//! wedge products `M_ij = ∫ H_i ∧ H_j = ∫ W_i ∧ W_j` are integers and `det M = 1`; with the inner
//! products `G_ij = H_iᵀ c H_j` the conjugate of `Σ a_k H_k` is `Σ (C a)_k H_k`, `C = M⁻¹ G`, because
//! `∫ H_i ∧ *H_j = G_ij`. No rotation of gradients face by face enters, and no local error with it.
//!
//! `C² = -I` holds up to the discretisation, so that `|C² + I|` estimates its error.
//!
//! # Notation
//! `W`, `H`, `f`, `M`, `G`, `C` as above; `ω = Σ (a_k + i (C a)_k) H_k`.
//!
//! # Reference
//! [Gu2003] §4; [Mercat2001] §1. Deviation: conjugates by wedge products on the intrinsic Delaunay
//! triangulation, see docs/papers/he2005.md.

use msplines_common::linalg::{Mat, column_mut};
use msplines_common::mesh::TriangleMesh;
use msplines_common::operators::intrinsic::{IntrinsicTriangulation, intrinsic_delaunay};
use msplines_common::operators::{Poisson, assemble, half_cotangents};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::error::ConformalError;
use crate::homology::{Cocycle, Homology};

/// Determinants of integer matrices further from 1 than this are wrong.
const UNIMODULAR: f64 = 1e-6;

/// The harmonic forms of a closed surface and what turns them into holomorphic ones.
#[derive(Clone, Debug)]
pub struct HolomorphicBasis {
    homology: Homology,
    triangulation: IntrinsicTriangulation,
    /// The forms `W_k` on the half-edges of the triangulation.
    carried: Vec<Cocycle>,
    /// The functions `f_k`, one column each.
    potentials: Mat<f64>,
    gram: DMatrix<f64>,
    conjugation: DMatrix<f64>,
    /// `|C² + I|`, root mean square of the entries: the error of the discretisation.
    pub conjugation_defect: f64,
    /// Largest flux `|dᵀ c H_k|` out of a vertex, relative to the largest flux through an edge.
    pub co_closedness: f64,
}

impl HolomorphicBasis {
    /// Builds the basis: one factorisation and 2g right-hand sides.
    ///
    /// # Errors
    /// A boundary, several components, genus 0, or coordinates that are not finite.
    pub fn build(mesh: &TriangleMesh) -> Result<Self, ConformalError> {
        let homology = Homology::build(mesh.topology())?;
        if homology.genus() == 0 {
            return Err(ConformalError::NoForm);
        }
        let triangulation = intrinsic_delaunay(mesh)?;
        let carried: Vec<Cocycle> = homology
            .cocycles
            .par_iter()
            .map(|cocycle| carry(&triangulation, cocycle))
            .collect();
        let weights: Vec<f64> = triangulation
            .lengths
            .par_iter()
            .flat_map_iter(|&sides| half_cotangents(sides))
            .collect();
        let (potentials, co_closedness) =
            potentials(mesh.vertex_count(), &triangulation, &weights, &carried)?;
        let mut basis = Self {
            gram: gram(&triangulation, &weights, &carried, &potentials),
            conjugation: DMatrix::zeros(0, 0),
            conjugation_defect: 0.0,
            co_closedness,
            homology,
            triangulation,
            carried,
            potentials,
        };
        basis.conjugation = inverse_wedges(&basis.homology.cocycles)? * &basis.gram;
        let classes = basis.classes();
        let square = &basis.conjugation * &basis.conjugation;
        let defect = square + DMatrix::identity(classes, classes);
        basis.conjugation_defect = defect.norm() / classes as f64;
        Ok(basis)
    }

    /// Returns the number of real classes, 2g.
    #[must_use]
    pub fn classes(&self) -> usize {
        self.carried.len()
    }

    /// Returns the number of handles.
    #[must_use]
    pub fn genus(&self) -> usize {
        self.homology.genus()
    }

    /// Returns the integer forms and loops below the basis.
    #[must_use]
    pub fn homology(&self) -> &Homology {
        &self.homology
    }

    /// Returns the intrinsic Delaunay triangulation that the forms are harmonic on.
    #[must_use]
    pub fn triangulation(&self) -> &IntrinsicTriangulation {
        &self.triangulation
    }

    /// Returns the inner products `G` of the harmonic forms.
    #[must_use]
    pub fn gram(&self) -> &DMatrix<f64> {
        &self.gram
    }

    /// Returns the coefficients `C a` of the conjugate of the harmonic form with coefficients `a`.
    ///
    /// # Panics
    /// If there is not one coefficient per class.
    #[must_use]
    pub fn conjugate(&self, coefficients: &DVector<f64>) -> DVector<f64> {
        &self.conjugation * coefficients
    }

    /// Returns the conjugation `C`.
    #[must_use]
    pub fn conjugation(&self) -> &DMatrix<f64> {
        &self.conjugation
    }

    /// Returns, by half-edge of the mesh, the holomorphic form whose real and imaginary parts have
    /// these coefficients.
    ///
    /// # Panics
    /// If there is not one coefficient per class.
    #[must_use]
    pub fn form_on_mesh(&self, mesh: &TriangleMesh, parts: [&DVector<f64>; 2]) -> Vec<[f64; 2]> {
        self.form_on(mesh.faces(), &self.homology.cocycles, parts)
    }

    /// Returns the same form by half-edge of the intrinsic triangulation.
    ///
    /// # Panics
    /// If there is not one coefficient per class.
    #[must_use]
    pub fn form_on_triangulation(&self, parts: [&DVector<f64>; 2]) -> Vec<[f64; 2]> {
        self.form_on(&self.triangulation.faces, &self.carried, parts)
    }

    fn form_on(
        &self,
        faces: &[[u32; 3]],
        cocycles: &[Cocycle],
        parts: [&DVector<f64>; 2],
    ) -> Vec<[f64; 2]> {
        let functions: Vec<[f64; 2]> = (0..self.potentials.nrows())
            .into_par_iter()
            .map(|vertex| {
                parts.map(|a| {
                    let row = (0..a.len()).map(|k| a[k] * self.potentials[(vertex, k)]);
                    row.sum::<f64>()
                })
            })
            .collect();
        let differences = faces.par_iter().flat_map_iter(|corners| {
            let at = corners.map(|v| functions[v as usize]);
            (0..3).map(move |i| [0, 1].map(|part| at[(i + 1) % 3][part] - at[i][part]))
        });
        let mut form: Vec<[f64; 2]> = differences.collect();
        for (k, cocycle) in cocycles.iter().enumerate() {
            for &(half_edge, value) in cocycle {
                let place = &mut form[half_edge as usize];
                place[0] += parts[0][k] * f64::from(value);
                place[1] += parts[1][k] * f64::from(value);
            }
        }
        form
    }

    /// Returns the functions `f_k`, one column each.
    pub(crate) fn potentials(&self) -> &Mat<f64> {
        &self.potentials
    }

    /// Returns the forms `W_k` by half-edge of the intrinsic triangulation.
    pub(crate) fn carried(&self) -> &[Cocycle] {
        &self.carried
    }
}

/// Carries an integer form from the mesh to its intrinsic triangulation.
fn carry(triangulation: &IntrinsicTriangulation, cocycle: &Cocycle) -> Cocycle {
    let mut values = vec![0i32; triangulation.twins.len()];
    for &(half_edge, value) in cocycle {
        values[half_edge as usize] = value;
    }
    triangulation.carry(&mut values);
    let entries = (0u32..).zip(values);
    entries.filter(|entry| entry.1 != 0).collect()
}

/// Returns the functions that make the forms co-closed, and the relative flux that remains.
fn potentials(
    vertices: usize,
    triangulation: &IntrinsicTriangulation,
    weights: &[f64],
    carried: &[Cocycle],
) -> Result<(Mat<f64>, f64), ConformalError> {
    let faces = &triangulation.faces;
    let operators = assemble(vertices, faces, &triangulation.lengths);
    let poisson = Poisson::factor(&operators)?;
    let mut flux: Mat<f64> = Mat::zeros(vertices, carried.len());
    let mut scale = 0.0f64;
    for (k, cocycle) in carried.iter().enumerate() {
        let column = column_mut(flux.as_mut(), k);
        for &(half_edge, value) in cocycle {
            let [from, to] = ends(faces, half_edge);
            let through = weights[half_edge as usize] * f64::from(value);
            scale = scale.max(through.abs());
            column[to] -= through;
            column[from] += through;
        }
    }
    let mut found = flux.clone();
    poisson.solve_in_place(found.as_mut());
    // One step of refinement takes the fluxes down to rounding on slivers too.
    let mut rest = &flux - operators.laplacian.multiply(found.as_ref());
    poisson.solve_in_place(rest.as_mut());
    found += &rest;
    let remaining = &flux - operators.laplacian.multiply(found.as_ref());
    let largest = remaining.col_iter().flat_map(|c| c.iter().copied());
    let largest = largest.fold(0.0f64, |a, b| a.max(b.abs()));
    Ok((found, largest / scale))
}

/// Inner products `G_ij = W_iᵀ c H_j`: what `H_i` adds to `W_i` is orthogonal to harmonic forms.
fn gram(
    triangulation: &IntrinsicTriangulation,
    weights: &[f64],
    carried: &[Cocycle],
    potentials: &Mat<f64>,
) -> DMatrix<f64> {
    let classes = carried.len();
    let rows: Vec<Vec<f64>> = carried
        .par_iter()
        .map(|cocycle| {
            let mut row = vec![0.0; classes];
            for &(half_edge, value) in cocycle {
                let through = weights[half_edge as usize] * f64::from(value);
                let [from, to] = ends(&triangulation.faces, half_edge);
                for (j, sum) in row.iter_mut().enumerate() {
                    *sum += through * (potentials[(to, j)] - potentials[(from, j)]);
                }
            }
            row
        })
        .collect();
    // The part of W_j on the support of W_i.
    let mut gram = DMatrix::from_fn(classes, classes, |i, j| rows[i][j]);
    for i in 0..classes {
        for j in 0..classes {
            let shared = common_entries(&carried[i], &carried[j]);
            let products = shared.map(|(h, a, b)| weights[h as usize] * f64::from(a * b));
            gram[(i, j)] += products.sum::<f64>();
        }
    }
    0.5 * (&gram + gram.transpose())
}

/// Returns the inverse of the integer matrix `M` of wedge products, exactly.
fn inverse_wedges(cocycles: &[Cocycle]) -> Result<DMatrix<f64>, ConformalError> {
    let classes = cocycles.len();
    let faces: Vec<Vec<(u32, [i32; 3])>> = cocycles.iter().map(by_face).collect();
    let wedge = |i: usize, j: usize| {
        let shared = common_entries(&faces[i], &faces[j]);
        let doubled: i64 = shared
            .map(|(_, a, b)| i64::from(a[0] * b[1] - a[1] * b[0]))
            .sum();
        doubled as f64 / 2.0
    };
    let wedges = DMatrix::from_fn(classes, classes, wedge);
    let factors = wedges.clone().lu();
    let determinant = factors.determinant();
    let inverse = factors.try_inverse().map(|inverse| inverse.map(f64::round));
    let exact = |m: &DMatrix<f64>| &wedges * m == DMatrix::identity(classes, classes);
    inverse
        .filter(|inverse| (determinant - 1.0).abs() < UNIMODULAR && exact(inverse))
        .ok_or(ConformalError::Intersections {
            classes,
            determinant,
        })
}

fn by_face(cocycle: &Cocycle) -> Vec<(u32, [i32; 3])> {
    let mut faces: Vec<(u32, [i32; 3])> = Vec::new();
    for &(half_edge, value) in cocycle {
        let face = half_edge / 3;
        if faces.last().is_none_or(|last| last.0 != face) {
            faces.push((face, [0; 3]));
        }
        if let Some(last) = faces.last_mut() {
            last.1[(half_edge % 3) as usize] = value;
        }
    }
    faces
}

/// The entries of two ascending lists that have the same key.
fn common_entries<'a, T: Copy>(
    one: &'a [(u32, T)],
    other: &'a [(u32, T)],
) -> impl Iterator<Item = (u32, T, T)> + 'a {
    let mut rest = other;
    one.iter().filter_map(move |&(key, a)| {
        let skipped = rest.partition_point(|entry| entry.0 < key);
        rest = &rest[skipped..];
        let found = rest.first().filter(|entry| entry.0 == key)?;
        Some((key, a, found.1))
    })
}

fn ends(faces: &[[u32; 3]], half_edge: u32) -> [usize; 2] {
    let corners = faces[(half_edge / 3) as usize];
    let i = (half_edge % 3) as usize;
    [corners[i] as usize, corners[(i + 1) % 3] as usize]
}
