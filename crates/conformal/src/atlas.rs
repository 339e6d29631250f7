//! The affine atlas of a surface: a mesh whose faces a closed complex 1-form lays out in the plane.
//!
//! Every face away from the zeros is positively oriented in the plane; where two charts meet they
//! differ by a translation. Faces are those that Delaunay flips on the surface lead to, as far as they
//! leave an ordinary mesh, because on them fewer triangles fold.
//!
//! # Reference
//! [He2005] Theorem 3, §3.3. Deviation: one flat mesh stands for all charts, as they differ by
//! translations; the mesh is refined where faces fold away from the zeros.

use std::collections::BTreeSet;

use msplines_common::mesh::{FlipComplex, SurfacePoint, TriangleMesh, split_at};
use msplines_common::operators::intrinsic::{
    FlipRule, IntrinsicTriangulation, intrinsic_delaunay_by,
};

use crate::basis::HolomorphicBasis;
use crate::choice::{FormChoice, HolomorphicForm};
use crate::error::ConformalError;
use crate::flat::{FlatComplex, cross, remeshed};
use crate::zeros::{Findings, Zero, find};

/// Local refinements before a mesh is given up.
const ROUNDS: usize = 8;

/// Rounds in which weights are relaxed where faces fold, before faces are split there too.
const RELAXATIONS: usize = 4;

/// A mesh laid out in the plane by a closed complex 1-form, apart from holes at its zeros.
#[derive(Clone, Debug)]
pub struct Atlas {
    mesh: TriangleMesh,
    form: Vec<[f64; 2]>,
    zeros: Vec<Zero>,
    input_vertices: usize,
    refinements: usize,
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

    /// Says that the vertices after these were added to the input.
    pub(crate) fn set_input_vertices(&mut self, count: usize) {
        self.input_vertices = count;
    }

    /// Builds the atlas of a closed surface of genus >= 1.
    ///
    /// Forms are tried in the order of the choice. Where all of them fold the mesh away from their
    /// zeros, or have zeros too close together, faces there are split into four and the forms
    /// computed anew, eight times at most; [`Self::added_vertices`] tells how many vertices that added.
    ///
    /// # Errors
    /// As [`HolomorphicBasis::build`] and [`FormChoice::candidates`]; a mesh that stays too coarse.
    pub fn closed(mesh: &TriangleMesh, choice: &FormChoice) -> Result<ClosedAtlas, ConformalError> {
        let mut refined = mesh.clone();
        let mut relaxed: Vec<u32> = Vec::new();
        let mut round = 0;
        loop {
            let basis = HolomorphicBasis::relaxed_at(&refined, &relaxed)?;
            let ground = Ground::build(&refined, basis.triangulation());
            let mut worst: Option<(FlatComplex, Findings)> = None;
            for candidate in choice.candidates(&basis)? {
                let form = basis.form([&candidate.real, &candidate.imaginary]);
                let (flat, findings) = ground.lay_out(form, None);
                if findings.is_clean() {
                    let count = mesh.vertex_count();
                    let atlas = ground.atlas(flat, findings.zeros, count, round)?;
                    return Ok(ClosedAtlas {
                        atlas,
                        mesh: refined,
                        basis,
                        form: candidate,
                    });
                }
                if worst
                    .as_ref()
                    .is_none_or(|(_, w)| findings.badness() < w.badness())
                {
                    worst = Some((flat, findings));
                }
            }
            let Some((flat, findings)) = worst else {
                return Err(ConformalError::ZeroForm);
            };
            if round == ROUNDS {
                return Err(failure(&flat, &findings, round));
            }
            relax(&mut relaxed, round + 1, &flat, &findings);
            if round >= RELAXATIONS || !findings.not_disks.is_empty() {
                let next = refine(&refined, &flat, &findings);
                refined = next.ok_or_else(|| failure(&flat, &findings, round))?;
            }
            round += 1;
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

    /// Returns the largest `|Σ ω|` around a face, relative to its longest side in the plane; faces at
    /// a pole, which have no image, are left out.
    #[must_use]
    pub fn closedness(&self) -> f64 {
        let mut at_pole = vec![false; self.mesh.face_count()];
        let poles = self.zeros.iter().filter(|zero| zero.order < 0);
        for &face in poles.flat_map(|pole| &pole.faces) {
            at_pole[face as usize] = true;
        }
        let faces = self.form.as_chunks::<3>().0.iter().zip(at_pole);
        let norm = |v: [f64; 2]| v[0].hypot(v[1]);
        let defect = |[a, b, c]: &[[f64; 2]; 3]| {
            let sum = [0, 1].map(|i| a[i] + b[i] + c[i]);
            let longest = norm(*a).max(norm(*b)).max(norm(*c));
            if longest > 0.0 {
                norm(sum) / longest
            } else {
                0.0
            }
        };
        let measured = faces.filter(|(_, at_pole)| !at_pole);
        measured.map(|(sides, _)| defect(sides)).fold(0.0, f64::max)
    }

    /// Returns the number of folded faces outside of the zeros: none, or there is no atlas.
    #[must_use]
    pub fn folded_faces(&self) -> usize {
        let mut outside = vec![true; self.mesh.face_count()];
        for &face in self.zeros.iter().flat_map(|zero| &zero.faces) {
            outside[face as usize] = false;
        }
        let faces = self.form.as_chunks::<3>().0.iter().zip(outside);
        faces
            .filter(|([a, b, _], outside)| *outside && cross(*a, *b) <= 0.0)
            .count()
    }
}

/// The atlas of a closed surface with the forms it was chosen from.
#[derive(Clone, Debug)]
pub struct ClosedAtlas {
    /// The atlas.
    pub atlas: Atlas,
    /// The input, refined where that was needed.
    pub mesh: TriangleMesh,
    /// The harmonic forms of that mesh.
    pub basis: HolomorphicBasis,
    /// The form taken, before it was scaled.
    pub form: HolomorphicForm,
}

/// The triangulation that forms are laid out on.
struct Ground<'a> {
    mesh: &'a TriangleMesh,
    glued: FlipComplex,
}

impl<'a> Ground<'a> {
    fn build(mesh: &'a TriangleMesh, triangulation: &IntrinsicTriangulation) -> Self {
        let mut glued = FlipComplex::of(mesh.topology());
        for &[half_edge, _] in &triangulation.flips {
            glued.flip(half_edge);
        }
        Self { mesh, glued }
    }

    fn lay_out(&self, form: Vec<[f64; 2]>, pole: Option<u32>) -> (FlatComplex, Findings) {
        let mut flat = FlatComplex::of(&self.glued, form);
        flat.unfold();
        let findings = find(&flat, self.mesh.vertex_count(), pole);
        (flat, findings)
    }

    fn atlas(
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
        };
        atlas.scale();
        Ok(atlas)
    }
}

impl Atlas {
    fn scale(&mut self) {
        let mut outside = vec![true; self.mesh.face_count()];
        for &face in self.zeros.iter().flat_map(|zero| &zero.faces) {
            outside[face as usize] = false;
        }
        let (mut flat, mut surface) = (0.0, 0.0);
        for face in (0..self.mesh.face_count() as u32).filter(|&f| outside[f as usize]) {
            let h = 3 * face as usize;
            flat += cross(self.form[h], self.form[h + 1]);
            surface += self.mesh.face_normal(face).norm();
        }
        let factor = (surface / flat).sqrt();
        self.form
            .iter_mut()
            .for_each(|v| *v = v.map(|x| x * factor));
    }
}

/// Adds the corners of faces that are wrong, and so many rings around them, to the relaxed vertices.
fn relax(relaxed: &mut Vec<u32>, rings: usize, flat: &FlatComplex, findings: &Findings) {
    let folded = findings
        .folded
        .iter()
        .flat_map(|&f| flat.faces()[f as usize]);
    let mut wrong: BTreeSet<u32> = folded
        .chain(findings.inconsistent.iter().copied())
        .collect();
    for _ in 0..rings {
        let beside = flat
            .faces()
            .iter()
            .filter(|f| f.iter().any(|v| wrong.contains(v)));
        let beside: Vec<u32> = beside.flatten().copied().collect();
        wrong.extend(beside);
    }
    relaxed.extend(wrong);
    relaxed.sort_unstable();
    relaxed.dedup();
}

/// Splits the faces of the mesh around what is wrong into four; nothing if nothing is there.
fn refine(mesh: &TriangleMesh, flat: &FlatComplex, findings: &Findings) -> Option<TriangleMesh> {
    let mut marked = vec![false; mesh.vertex_count()];
    let folded = findings
        .folded
        .iter()
        .flat_map(|&f| flat.faces()[f as usize]);
    let others = findings
        .inconsistent
        .iter()
        .chain(&findings.not_disks)
        .copied();
    let zeros = findings
        .zeros
        .iter()
        .filter(|z| findings.not_disks.contains(&z.vertices[0]));
    let crowded = zeros.flat_map(|z| z.faces.iter().flat_map(|&f| flat.faces()[f as usize]));
    for vertex in folded.chain(others).chain(crowded) {
        marked[vertex as usize] = true;
    }
    let near = |face: &u32| {
        mesh.faces()[*face as usize]
            .iter()
            .any(|&v| marked[v as usize])
    };
    let faces = (0..mesh.face_count() as u32).filter(near);
    let middles = [[0.5, 0.5, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5]];
    let points: Vec<SurfacePoint> = faces
        .flat_map(|face| middles.map(|at| SurfacePoint { face, at }))
        .collect();
    if points.is_empty() {
        return None;
    }
    split_at(mesh, &points).ok().map(|split| split.mesh)
}

fn failure(flat: &FlatComplex, findings: &Findings, rounds: usize) -> ConformalError {
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
