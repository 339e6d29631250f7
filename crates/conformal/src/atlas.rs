//! The affine atlas of a surface: a mesh whose faces a closed complex 1-form lays out in the plane.
//!
//! Every face away from the zeros is positively oriented in the plane; where two charts meet they
//! differ by a translation. Faces are those that Delaunay flips on the surface lead to, as far as they
//! leave an ordinary mesh, because on them fewer triangles fold.
//!
//! # Reference
//! [He2005] Theorem 3, §3.3. Deviation: one flat mesh stands for all charts, as they differ by
//! translations.

use msplines_common::mesh::{FlipComplex, TriangleMesh};
use msplines_common::operators::intrinsic::{
    FlipRule, IntrinsicTriangulation, intrinsic_delaunay_by,
};

use crate::error::ConformalError;
use crate::flat::{FlatComplex, cross, remeshed};
use crate::zeros::{Findings, Zero, find};

/// A mesh laid out in the plane by a closed complex 1-form, apart from holes at its zeros.
#[derive(Clone, Debug)]
pub struct Atlas {
    mesh: TriangleMesh,
    form: Vec<[f64; 2]>,
    zeros: Vec<Zero>,
    input_vertices: usize,
    refinements: usize,
    scale_factor: f64,
}

impl Atlas {
    /// Lays out a surface by a closed form on the half-edges of the mesh. O(n).
    ///
    /// # Errors
    /// Faces that stay folded, or zeros that cannot be cut out; nothing is refined.
    ///
    /// # Panics
    /// If there is not one vector per half-edge.
    pub fn of_form(mesh: &TriangleMesh, form: &[[f64; 2]]) -> Result<Self, ConformalError> {
        let triangulation = intrinsic_delaunay_by(mesh, FlipRule::Simplicial)?;
        let carried = [0, 1].map(|part| {
            let mut values: Vec<f64> = form.iter().map(|v| v[part]).collect();
            triangulation.carry(&mut values);
            values
        });
        let form = (0..form.len())
            .map(|h| [carried[0][h], carried[1][h]])
            .collect();
        Self::on_triangulation(mesh, &triangulation, form, None)
    }

    /// Lays out a surface by a closed form on the half-edges of a triangulation of it.
    pub(crate) fn on_triangulation(
        mesh: &TriangleMesh,
        triangulation: &IntrinsicTriangulation,
        form: Vec<[f64; 2]>,
        pole: Option<u32>,
    ) -> Result<Self, ConformalError> {
        let ground = Ground::build(mesh, triangulation);
        let (flat, findings) = ground.lay_out(form, pole);
        if findings.is_clean() {
            ground.atlas(flat, findings.zeros, mesh.vertex_count(), 0)
        } else {
            Err(failure(&flat, &findings, 0))
        }
    }

    /// Returns the mesh of the whole surface, faces at the zeros included. Vertices of the input keep
    /// their ids; added ones follow.
    #[must_use]
    pub fn mesh(&self) -> &TriangleMesh {
        &self.mesh
    }

    /// Returns the form by half-edge of [`Self::mesh`]: the vector along each edge in the plane. Its
    /// scale makes the area in the plane that of the surface, faces at the zeros left out.
    #[must_use]
    pub fn form(&self) -> &[[f64; 2]] {
        &self.form
    }

    /// Returns what the form that was asked for was multiplied by.
    #[must_use]
    pub fn scale_factor(&self) -> f64 {
        self.scale_factor
    }

    /// Returns the zeros, in the order of their first vertices.
    #[must_use]
    pub fn zeros(&self) -> &[Zero] {
        &self.zeros
    }

    /// Returns how many vertices local refinement added to those of the input.
    #[must_use]
    pub fn added_vertices(&self) -> usize {
        self.mesh.vertex_count() - self.input_vertices
    }

    /// Returns how often the mesh was refined locally.
    #[must_use]
    pub fn refinements(&self) -> usize {
        self.refinements
    }

    /// Returns the largest `|Σ ω|` around a face, relative to its longest side in the plane,
    /// outside of the zeros.
    #[must_use]
    pub fn closedness(&self) -> f64 {
        let norm = |v: [f64; 2]| v[0].hypot(v[1]);
        let defect = |[a, b, c]: &[[f64; 2]; 3]| {
            let sum = [0, 1].map(|i| a[i] + b[i] + c[i]);
            norm(sum) / norm(*a).max(norm(*b)).max(norm(*c))
        };
        let outside = self.faces_outside();
        let faces = self.form.as_chunks::<3>().0.iter().zip(outside);
        let defects = faces
            .filter(|(_, outside)| *outside)
            .map(|(face, _)| defect(face));
        defects.fold(0.0, f64::max)
    }

    /// Returns the number of folded faces outside of the zeros: none, or there is no atlas.
    #[must_use]
    pub fn folded_faces(&self) -> usize {
        let outside = self.faces_outside();
        let faces = self.form.as_chunks::<3>().0.iter().zip(outside);
        faces
            .filter(|([a, b, _], outside)| *outside && cross(*a, *b) <= 0.0)
            .count()
    }
}

/// The triangulation that forms are laid out on.
pub(crate) struct Ground<'a> {
    mesh: &'a TriangleMesh,
    glued: FlipComplex,
}

impl<'a> Ground<'a> {
    pub(crate) fn build(mesh: &'a TriangleMesh, triangulation: &IntrinsicTriangulation) -> Self {
        let mut glued = FlipComplex::of(mesh.topology());
        for &[half_edge, _] in &triangulation.flips {
            glued.flip(half_edge);
        }
        Self { mesh, glued }
    }

    pub(crate) fn lay_out(
        &self,
        form: Vec<[f64; 2]>,
        pole: Option<u32>,
    ) -> (FlatComplex, Findings) {
        let mut flat = FlatComplex::of(&self.glued, form);
        flat.unfold();
        let findings = find(&flat, self.mesh.vertex_count(), pole);
        (flat, findings)
    }

    pub(crate) fn atlas(
        &self,
        flat: FlatComplex,
        zeros: Vec<Zero>,
        input_vertices: usize,
        refinements: usize,
    ) -> Result<Atlas, ConformalError> {
        let mesh = remeshed(self.mesh, flat.faces()).ok_or_else(|| ConformalError::TooCoarse {
            vertex: zeros.first().map_or(0, |zero| zero.vertices[0]),
            rounds: refinements,
        })?;
        let mut atlas = Atlas {
            mesh,
            form: flat.into_vectors(),
            zeros,
            input_vertices,
            refinements,
            scale_factor: 1.0,
        };
        atlas.scale();
        Ok(atlas)
    }
}

impl Atlas {
    /// For each face whether it lies outside of the zeros' faces.
    fn faces_outside(&self) -> Vec<bool> {
        let mut outside = vec![true; self.mesh.face_count()];
        for &face in self.zeros.iter().flat_map(|zero| &zero.faces) {
            outside[face as usize] = false;
        }
        outside
    }

    fn scale(&mut self) {
        let outside = self.faces_outside();
        let (mut flat, mut surface) = (0.0, 0.0);
        for face in (0..self.mesh.face_count() as u32).filter(|&f| outside[f as usize]) {
            let h = 3 * face as usize;
            flat += cross(self.form[h], self.form[h + 1]);
            surface += self.mesh.face_normal(face).norm();
        }
        let factor = (surface / flat).sqrt();
        self.scale_factor = factor;
        self.form
            .iter_mut()
            .for_each(|v| *v = v.map(|x| x * factor));
    }
}

/// Says what prevents an atlas.
pub(crate) fn failure(flat: &FlatComplex, findings: &Findings, rounds: usize) -> ConformalError {
    match (findings.folded.first(), findings.not_disks.first()) {
        (Some(&face), _) => ConformalError::Folded {
            flips: findings.folded.len(),
            vertex: flat.faces()[face as usize][0],
            rounds,
        },
        (None, vertex) => ConformalError::TooCoarse {
            vertex: vertex
                .or(findings.inconsistent.first())
                .copied()
                .unwrap_or(0),
            rounds,
        },
    }
}
