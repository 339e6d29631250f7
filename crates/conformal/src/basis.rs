//! Harmonic and holomorphic 1-forms of a closed surface of genus g >= 1.
//!
//! Each integer closed form `W_k` is made harmonic by a function: `H_k = W_k + df_k`, where
//! `L f_k = -dᵀ c W_k` for the cotangent weights `c` of the intrinsic Delaunay triangulation. The
//! wedge products `M_ij = ∫ H_i ∧ H_j = ∫ W_i ∧ W_j` are integers and `det M = 1`; with the inner
//! products `G_ij = H_iᵀ c H_j` the conjugate of `Σ a_k H_k` is `Σ (J a)_k H_k` with `J` near
//! `C = M⁻¹ G`, because `∫ H_i ∧ *H_j = G_ij`. No rotation of gradients face by face enters, and no
//! local error with it.
//!
//! `C² = -I` holds up to the discretisation, so that `|C² + I|` estimates its error. `J = C (-C²)^(-1/2)`
//! has `J² = -I` to rounding: with it the periods of a form do not depend on which of its parts was
//! conjugated, and the modulus of a torus is one number.
//!
//! # Notation
//! `W`, `H`, `f`, `M`, `G`, `C`, `J` as above; `ω = Σ (a_k + i (J a)_k) H_k`.
//!
//! # Reference
//! [Gu2003] §4; [Mercat2001] §1. Deviation: conjugates by wedge products on the intrinsic Delaunay
//! triangulation, see docs/papers/he2005.md.

use msplines_common::mesh::{NONE, TriangleMesh};
use msplines_common::operators::intrinsic::{
    DELAUNAY_TOLERANCE, FlipRule, IntrinsicTriangulation, intrinsic_delaunay_by,
};
use msplines_common::operators::{Poisson, assemble, half_cotangents};
use msplines_common::progress::{Observer, Stages};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::error::ConformalError;
use crate::homology::{Cocycle, Homology};
use crate::potentials::Potentials;

/// Weight of an edge that could not be flipped although its cotangents sum to less than zero.
///
/// Such edges surround the tips of needles, where another flip would wind an edge around the tip and
/// leave it with one neighbour, on which it would be laid. The weight is that of two angles of 84
/// degrees.
const NEEDLE_WEIGHT: f64 = 0.1;

/// Least weights of all edges. Weights of zero, as cocircular points have them, may leave a vertex on
/// the segment between two others, and its faces without area.
///
/// The larger one is for meshes on which faces fold. It is not the first choice, because on grids of
/// rectangles, whose diagonals weigh nothing, it shows in the fourth digit of periods.
const LEAST_WEIGHTS: [f64; 2] = [1e-7, 1e-3];

/// Weight of all edges at relaxed vertices: that of equilateral triangles.
const EQUAL_WEIGHT: f64 = 0.577;

/// Determinants of integer matrices further from 1 than this are wrong.
const UNIMODULAR: f64 = 1e-6;

/// Steps of a quadratically convergent iteration from a matrix near the identity.
const ROOT_STEPS: usize = 20;

/// The harmonic forms of a closed surface and what turns them into holomorphic ones.
#[derive(Clone, Debug)]
pub struct HolomorphicBasis {
    homology: Homology,
    triangulation: IntrinsicTriangulation,
    potentials: Potentials,
    gram: DMatrix<f64>,
    conjugation: DMatrix<f64>,
    /// `|C² + I|`, root mean square of the entries: the error of the discretisation.
    pub conjugation_defect: f64,
    /// Largest flux `|dᵀ c H_k|` out of a vertex, relative to the largest one of any form through a
    /// half-edge at that vertex.
    pub co_closedness: f64,
    /// Number of edges whose weight is not that of the cotangents.
    pub changed_edges: usize,
}

impl HolomorphicBasis {
    /// Builds the basis: one factorisation and 2g right-hand sides, solved until fluxes balance.
    ///
    /// # Errors
    /// A boundary, several components, genus 0, or coordinates that are not finite; the observer, which
    /// sees the phase `domain`, asks to stop.
    pub fn build(mesh: &TriangleMesh, observer: &mut Observer<'_>) -> Result<Self, ConformalError> {
        let mut stages = Stages::new("domain", 0, observer);
        stages.enter()?;
        Self::of(mesh, &Homology::build(mesh.topology())?, &[], &mut stages)
    }

    /// Builds the basis over given integer forms, with equal weights on all edges at some vertices,
    /// which are in ascending order.
    ///
    /// # Errors
    /// As [`Self::build`].
    pub(crate) fn of(
        mesh: &TriangleMesh,
        homology: &Homology,
        relaxed: &[u32],
        stages: &mut Stages<'_, '_>,
    ) -> Result<Self, ConformalError> {
        if homology.genus() == 0 {
            return Err(ConformalError::NoForm);
        }
        stages.enter()?;
        let triangulation = intrinsic_delaunay_by(mesh, FlipRule::Simplicial)?;
        let cocycles = homology.cocycles.par_iter();
        let carried: Vec<Cocycle> = cocycles.map(|w| carry(&triangulation, w)).collect();
        let mut operators = assemble(
            mesh.vertex_count(),
            &triangulation.faces,
            &triangulation.lengths,
        );
        let mut weights: Vec<f64> = triangulation
            .lengths
            .par_iter()
            .flat_map_iter(|&sides| half_cotangents(sides))
            .collect();
        let changes = change_weights(&triangulation, relaxed, &mut weights);
        operators.laplacian.add_to_entries(&changes);
        stages.enter()?;
        let poisson = Poisson::factor(&operators)?;
        let mut potentials = Potentials::start(mesh.vertex_count(), &triangulation.faces, &carried);
        let co_closedness = potentials.solve(&poisson, &weights, stages)?;
        stages.enter()?;
        let gram = gram(&potentials, &weights, &carried);
        let conjugation = inverse_wedges(&homology.cocycles)? * &gram;
        let classes = carried.len();
        let defect = &conjugation * &conjugation + DMatrix::identity(classes, classes);
        Ok(Self {
            homology: homology.clone(),
            triangulation,
            potentials,
            gram,
            conjugation_defect: defect.norm() / classes as f64,
            conjugation: complex_structure(&conjugation),
            co_closedness,
            changed_edges: changes.len() / 4,
        })
    }

    /// Returns the number of real classes, 2g.
    #[must_use]
    pub fn classes(&self) -> usize {
        self.homology.cocycles.len()
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

    /// Returns the triangulation that the forms are harmonic on: Delaunay as far as it has the faces of
    /// an ordinary mesh.
    #[must_use]
    pub fn triangulation(&self) -> &IntrinsicTriangulation {
        &self.triangulation
    }

    /// Returns the inner products `G` of the harmonic forms.
    #[must_use]
    pub fn gram(&self) -> &DMatrix<f64> {
        &self.gram
    }

    /// Returns the coefficients `J a` of the conjugate of the harmonic form with coefficients `a`.
    ///
    /// # Panics
    /// If there is not one coefficient per class.
    #[must_use]
    pub fn conjugate(&self, coefficients: &DVector<f64>) -> DVector<f64> {
        &self.conjugation * coefficients
    }

    /// Returns the conjugation `J`, whose square is `-I`.
    #[must_use]
    pub fn conjugation(&self) -> &DMatrix<f64> {
        &self.conjugation
    }

    /// Returns, by half-edge of [`Self::triangulation`], the form whose real and imaginary parts have
    /// these coefficients. O(g n).
    ///
    /// # Panics
    /// If there is not one coefficient per class.
    #[must_use]
    pub fn form(&self, parts: [&DVector<f64>; 2]) -> Vec<[f64; 2]> {
        parts
            .iter()
            .for_each(|a| assert_eq!(a.len(), self.classes(), "one per class"));
        self.potentials.combine(parts.map(DVector::as_slice))
    }

    /// Returns the same form by half-edge of the mesh itself. O(g n).
    ///
    /// # Panics
    /// If there is not one coefficient per class.
    #[must_use]
    pub fn form_on_mesh(&self, mesh: &TriangleMesh, parts: [&DVector<f64>; 2]) -> Vec<[f64; 2]> {
        parts
            .iter()
            .for_each(|a| assert_eq!(a.len(), self.classes(), "one per class"));
        let potentials = self.potentials.on(mesh.faces(), &self.homology.cocycles);
        potentials.combine(parts.map(DVector::as_slice))
    }

    /// Returns the forms `W_k` and the functions `f_k`.
    pub(crate) fn potentials(&self) -> &Potentials {
        &self.potentials
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

/// Raises weights that are too small, makes those at the relaxed vertices equal, and returns what that
/// adds to `L`: four entries for each edge.
fn change_weights(
    triangulation: &IntrinsicTriangulation,
    relaxed: &[u32],
    weights: &mut [f64],
) -> Vec<(u32, u32, f64)> {
    let is_relaxed = |v: u32| relaxed.binary_search(&v).is_ok();
    let least = LEAST_WEIGHTS[usize::from(!relaxed.is_empty())];
    let mut entries = Vec::new();
    for (one, &other) in triangulation.twins.iter().enumerate() {
        let other = other as usize;
        if other < one {
            continue;
        }
        let halves = [weights[one], weights[other]];
        let weight = halves[0] + halves[1];
        let rounding = DELAUNAY_TOLERANCE * (1.0 + halves[0].abs() + halves[1].abs());
        let [a, b] = [one, other].map(|h| triangulation.faces[h / 3][h % 3]);
        let wanted = if is_relaxed(a) || is_relaxed(b) {
            EQUAL_WEIGHT
        } else {
            inner_weight(weight, rounding, least)
        };
        if wanted != weight {
            weights[one] = 0.5 * wanted;
            weights[other] = 0.5 * wanted;
            let added = wanted - weight;
            entries.extend([(a, a, added), (b, b, added), (a, b, -added), (b, a, -added)]);
        }
    }
    entries
}

/// Returns weights of edges, the same at both half-edges, with those that are less than zero and not on
/// a boundary raised.
pub(crate) fn raised(triangulation: &IntrinsicTriangulation, mut weights: Vec<f64>) -> Vec<f64> {
    for (weight, &twin) in weights.iter_mut().zip(&triangulation.twins) {
        if twin != NONE {
            *weight = inner_weight(
                *weight,
                DELAUNAY_TOLERANCE * (1.0 + weight.abs()),
                LEAST_WEIGHTS[0],
            );
        }
    }
    weights
}

/// What an edge inside weighs instead of `weight`, which may be less than zero by `rounding`.
fn inner_weight(weight: f64, rounding: f64, least: f64) -> f64 {
    if weight < -rounding {
        NEEDLE_WEIGHT
    } else {
        weight.max(least)
    }
}

/// Inner products `G_ij = W_iᵀ c H_j`: what `H_i` adds to `W_i` is orthogonal to harmonic forms.
fn gram(potentials: &Potentials, weights: &[f64], carried: &[Cocycle]) -> DMatrix<f64> {
    let classes = carried.len();
    let rows: Vec<Vec<f64>> = carried
        .par_iter()
        .map(|cocycle| {
            let mut row = vec![0.0; classes];
            let mut sides = vec![[0.0; 3]; classes];
            for &(half_edge, value) in cocycle {
                let through = weights[half_edge as usize] * f64::from(value);
                potentials.sides((half_edge / 3) as usize, &mut sides);
                for (sum, side) in row.iter_mut().zip(&sides) {
                    *sum += through * side[(half_edge % 3) as usize];
                }
            }
            row
        })
        .collect();
    let gram = DMatrix::from_fn(classes, classes, |i, j| rows[i][j]);
    0.5 * (&gram + gram.transpose())
}

/// Returns `C (-C²)^(-1/2)`, by Newton's iteration for the square root and its inverse.
///
/// # Reference
/// [Higham2008] Eq. (6.15).
fn complex_structure(conjugation: &DMatrix<f64>) -> DMatrix<f64> {
    let classes = conjugation.nrows();
    let mut root = -(conjugation * conjugation);
    let mut inverse = DMatrix::identity(classes, classes);
    for _ in 0..ROOT_STEPS {
        let (Some(of_root), Some(of_inverse)) =
            (root.clone().try_inverse(), inverse.clone().try_inverse())
        else {
            break;
        };
        let change = (&of_root - &inverse).norm();
        root = 0.5 * (root + of_inverse);
        inverse = 0.5 * (inverse + of_root);
        if change <= f64::EPSILON * classes as f64 {
            break;
        }
    }
    conjugation * inverse
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
