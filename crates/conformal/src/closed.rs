//! The search for an atlas of a closed surface: choose a form, and mend the mesh where it folds.

use std::collections::BTreeSet;

use msplines_common::mesh::{SplitMesh, SurfacePoint, TriangleMesh, split_at};

use crate::atlas::{Atlas, Ground, failure};
use crate::basis::HolomorphicBasis;
use crate::choice::{FormChoice, HolomorphicForm};
use crate::error::ConformalError;
use crate::flat::FlatComplex;
use crate::homology::Homology;
use crate::measure::stretch;
use crate::zeros::Findings;

/// Rounds of mending before a mesh is given up.
const ROUNDS: usize = 12;

/// Rounds in which faces that are laid out as needles are mended as if they were folded.
///
/// They are the rings of three vertices of hair-thin spikes: along these the two parts of a form decay
/// at rates that differ, and splines over such faces lose all their digits.
const NEEDLE_ROUNDS: usize = 2;

/// Ratio of singular values from a face to the plane above which it is a needle.
const NEEDLE: f64 = 1e3;

/// Rounds in which weights are relaxed where faces fold, before faces are split there too.
const RELAXATIONS: usize = 1;

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
    /// Face of the input that each face of that mesh lies in.
    pub parents: Vec<u32>,
}

impl Atlas {
    /// Builds the atlas of a closed surface of genus >= 1.
    ///
    /// Forms are tried in the order of the choice. Where all of them fold the mesh away from their
    /// zeros, or have zeros too close together, the best of them is kept: weights are made equal where
    /// it folds, and faces there and at crowded zeros are split into four, twelve times at most;
    /// [`Self::added_vertices`] tells how many vertices that added.
    ///
    /// # Errors
    /// As [`HolomorphicBasis::build`] and [`FormChoice::candidates`]; a mesh that stays too coarse.
    pub fn closed(mesh: &TriangleMesh, choice: &FormChoice) -> Result<ClosedAtlas, ConformalError> {
        // An atlas with needles is better than none.
        search(mesh, choice, NEEDLE_ROUNDS).or_else(|error| match error {
            ConformalError::Folded { .. } | ConformalError::TooCoarse { .. } => {
                search(mesh, choice, 0)
            }
            other => Err(other),
        })
    }
}

/// Searches for an atlas, mending needles in the first rounds.
fn search(
    mesh: &TriangleMesh,
    choice: &FormChoice,
    needle_rounds: usize,
) -> Result<ClosedAtlas, ConformalError> {
    let mut search = Search {
        mesh: mesh.clone(),
        homology: Homology::build(mesh.topology())?,
        relaxed: Vec::new(),
        kept: None,
        parents: (0..mesh.face_count() as u32).collect(),
    };
    let mut round = 0;
    loop {
        let basis = HolomorphicBasis::of(&search.mesh, &search.homology, &search.relaxed)?;
        let ground = Ground::build(&search.mesh, basis.triangulation());
        let candidates = match &search.kept {
            Some(form) => vec![choice.carried(form, &basis)],
            None => choice.candidates(&basis)?,
        };
        let tried = candidates.into_iter().map(|form| {
            let (flat, findings) = ground.lay_out(basis.form([&form.real, &form.imaginary]), None);
            (form, flat, findings)
        });
        let Some((form, flat, mut findings)) = best(tried) else {
            return Err(ConformalError::ZeroForm);
        };
        let clean = findings.is_clean();
        if clean && round < needle_rounds {
            findings.folded = needles(&flat, &search.mesh, &findings);
        }
        if findings.is_clean() {
            let atlas = ground.atlas(flat, findings.zeros, mesh.vertex_count(), round)?;
            return Ok(ClosedAtlas {
                atlas,
                mesh: search.mesh,
                basis,
                form,
                parents: search.parents,
            });
        }
        if round == ROUNDS || !search.mend(round, form, &flat, &findings) {
            return Err(failure(&flat, &findings, round));
        }
        round += 1;
    }
}

/// Faces outside of the zeros that are laid out as needles although they are none.
fn needles(flat: &FlatComplex, mesh: &TriangleMesh, findings: &Findings) -> Vec<u32> {
    let at_zeros: BTreeSet<u32> = findings
        .zeros
        .iter()
        .flat_map(|z| z.faces.clone())
        .collect();
    let faces = (0..flat.faces().len() as u32).filter(|face| !at_zeros.contains(face));
    let is_needle = |face: u32| {
        let [a, b, c] = flat.faces()[face as usize].map(|v| mesh.positions()[v as usize]);
        let sides = [(b - a).norm(), (c - b).norm(), (a - c).norm()];
        stretch(sides, flat.sides(face)).anisotropy > NEEDLE
    };
    faces.filter(|&face| is_needle(face)).collect()
}

/// The first clean one, or else the one with least that is wrong.
fn best(
    tried: impl Iterator<Item = (HolomorphicForm, FlatComplex, Findings)>,
) -> Option<(HolomorphicForm, FlatComplex, Findings)> {
    let mut best: Option<(HolomorphicForm, FlatComplex, Findings)> = None;
    for one in tried {
        if one.2.is_clean() {
            return Some(one);
        }
        if best
            .as_ref()
            .is_none_or(|best| one.2.badness() < best.2.badness())
        {
            best = Some(one);
        }
    }
    best
}

/// A surface that is mended until a form lies flat on it.
struct Search {
    mesh: TriangleMesh,
    homology: Homology,
    /// Vertices whose edges have equal weights, ascending.
    relaxed: Vec<u32>,
    /// The form that is mended for.
    kept: Option<HolomorphicForm>,
    /// Face of the input that each face lies in.
    parents: Vec<u32>,
}

impl Search {
    /// Relaxes weights and splits faces where a form is wrong; returns whether anything changed.
    fn mend(
        &mut self,
        round: usize,
        form: HolomorphicForm,
        flat: &FlatComplex,
        findings: &Findings,
    ) -> bool {
        self.kept = Some(form);
        let before = self.relaxed.len();
        self.relax(round + 1, flat, findings);
        let folds = findings.folded.len() + findings.inconsistent.len();
        if round < RELAXATIONS && findings.not_disks.len() <= folds {
            return self.relaxed.len() > before;
        }
        let Some(split) = split_around(&self.mesh, flat, findings) else {
            return false;
        };
        self.homology = self.homology.on_split(self.mesh.topology(), &split);
        let parents = split.parents.iter().map(|&p| self.parents[p as usize]);
        self.parents = parents.collect();
        self.mesh = split.mesh;
        true
    }

    /// Adds the corners of folded faces, and so many rings around them, to the relaxed vertices.
    fn relax(&mut self, rings: usize, flat: &FlatComplex, findings: &Findings) {
        let mut wrong: BTreeSet<u32> = folded_corners(flat, findings).collect();
        for _ in 0..rings {
            let faces = flat.faces().iter();
            let beside = faces.filter(|f| f.iter().any(|v| wrong.contains(v)));
            let beside: Vec<u32> = beside.flatten().copied().collect();
            wrong.extend(beside);
        }
        self.relaxed.extend(wrong);
        self.relaxed.sort_unstable();
        self.relaxed.dedup();
    }
}

fn folded_corners(flat: &FlatComplex, findings: &Findings) -> impl Iterator<Item = u32> {
    let folded = findings
        .folded
        .iter()
        .flat_map(|&f| flat.faces()[f as usize]);
    folded.chain(findings.inconsistent.iter().copied())
}

/// Splits the faces of the mesh around what is wrong into four; nothing if nothing is there.
pub(crate) fn split_around(
    mesh: &TriangleMesh,
    flat: &FlatComplex,
    findings: &Findings,
) -> Option<SplitMesh> {
    let is_crowded = |vertices: &[u32]| findings.not_disks.contains(&vertices[0]);
    let zeros = findings
        .zeros
        .iter()
        .filter(|zero| is_crowded(&zero.vertices));
    let crowded = zeros.flat_map(|z| z.faces.iter().flat_map(|&f| flat.faces()[f as usize]));
    let mut marked = vec![false; mesh.vertex_count()];
    for vertex in folded_corners(flat, findings).chain(crowded) {
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
    (!points.is_empty())
        .then(|| split_at(mesh, &points).ok())
        .flatten()
}
