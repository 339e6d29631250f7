//! The search for an atlas of a closed surface: choose a form, and mend the mesh where it folds.

use std::collections::BTreeSet;

use msplines_common::mesh::{SplitMesh, SurfacePoint, TriangleMesh, split_at};
use msplines_common::progress::{Observer, Stages};

use crate::atlas::{Atlas, Ground, failure};
use crate::basis::HolomorphicBasis;
use crate::choice::{FormChoice, HolomorphicForm};
use crate::error::ConformalError;
use crate::flat::FlatComplex;
use crate::homology::Homology;
use crate::measure::{measure_flat, stretch};
use crate::zeros::Findings;

/// What a search may do to a mesh.
#[derive(Clone, Copy, Debug)]
struct Effort {
    /// Rounds of mending before a mesh is given up.
    rounds: usize,
    /// Share of the faces that may be folded, beyond a few.
    folded: f64,
}

/// The effort for forms that are chosen.
const CHOSEN: Effort = Effort {
    rounds: 12,
    folded: 1.0,
};

/// The effort for a form that was asked for. A form that fades over a handle folds most faces there, and
/// splitting them all helps no more than waiting.
const GIVEN: Effort = Effort {
    rounds: 4,
    folded: 1e-3,
};

/// Folded faces that are mended on any mesh.
const FEW: f64 = 64.0;

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
    /// [`Self::added_vertices`] tells how many vertices that added. A form that was asked for is mended
    /// four times at most, and only where few faces are wrong. `observer` sees the phase `domain`.
    ///
    /// # Errors
    /// As [`HolomorphicBasis::build`] and [`FormChoice::candidates`]; a mesh that stays too coarse; a
    /// form asked for that cannot be laid out.
    pub fn closed(
        mesh: &TriangleMesh,
        choice: &FormChoice,
        observer: &mut Observer<'_>,
    ) -> Result<ClosedAtlas, ConformalError> {
        let effort = if choice.is_given() { GIVEN } else { CHOSEN };
        search(mesh, choice, effort, observer)
    }
}

/// Searches for an atlas, mending needles in the first rounds.
fn search(
    mesh: &TriangleMesh,
    choice: &FormChoice,
    effort: Effort,
    observer: &mut Observer<'_>,
) -> Result<ClosedAtlas, ConformalError> {
    let mut stages = Stages::new("domain", 0, observer);
    stages.enter()?;
    let mut search = Search::start(mesh)?;
    let mut with_needles = None;
    let mut round = 0;
    loop {
        let basis =
            HolomorphicBasis::of(&search.mesh, &search.homology, &search.relaxed, &mut stages)?;
        let ground = Ground::build(&search.mesh, basis.triangulation());
        let (form, flat, mut findings) = search.lay_out(choice, &basis, &ground, &mut stages)?;
        let mut error = failure(&flat, &findings, round);
        if findings.is_clean() {
            let needles = needles(&flat, &search.mesh, &findings);
            let zeros = std::mem::take(&mut findings.zeros);
            let atlas = match ground.atlas(flat.clone(), zeros, mesh.vertex_count(), round) {
                Ok(atlas) => atlas,
                Err(error) => return with_needles.ok_or(error),
            };
            let found = search.found(atlas, basis, form.clone());
            if needles.is_empty() || round >= NEEDLE_ROUNDS {
                return Ok(found);
            }
            findings.folded = needles;
            with_needles = with_needles.or(Some(found));
        } else if choice.is_given() && findings.folds() > 0 {
            error = unsuited(&flat, &findings, round, length_spread(&basis, &form));
        }
        let most = (effort.folded * flat.faces().len() as f64).max(FEW);
        let is_hopeless = round == effort.rounds || findings.folds() as f64 > most;
        if is_hopeless || !search.mend(round, form, &flat, &findings) {
            return with_needles.ok_or(error);
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

/// Says why a form that was asked for is none to lay a surface out by.
fn unsuited(flat: &FlatComplex, findings: &Findings, rounds: usize, spread: f64) -> ConformalError {
    let first = folded_corners(flat, findings).next();
    ConformalError::Unsuited {
        flips: findings.folds(),
        faces: flat.faces().len(),
        vertex: first.unwrap_or(0),
        rounds,
        spread,
    }
}

/// 99th over 1st percentile of the lengths of a form, over the area of the surface.
fn length_spread(basis: &HolomorphicBasis, form: &HolomorphicForm) -> f64 {
    let edges = basis.form([&form.real, &form.imaginary]);
    measure_flat(&basis.triangulation().lengths, &edges).scale_spread
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
    fn start(mesh: &TriangleMesh) -> Result<Self, ConformalError> {
        Ok(Self {
            mesh: mesh.clone(),
            homology: Homology::build(mesh.topology())?,
            relaxed: Vec::new(),
            kept: None,
            parents: (0..mesh.face_count() as u32).collect(),
        })
    }

    /// Lays out the form that is kept, or those of the choice until one is clean.
    fn lay_out(
        &self,
        choice: &FormChoice,
        basis: &HolomorphicBasis,
        ground: &Ground<'_>,
        stages: &mut Stages<'_, '_>,
    ) -> Result<(HolomorphicForm, FlatComplex, Findings), ConformalError> {
        stages.enter()?;
        let candidates = match &self.kept {
            Some(form) => vec![choice.carried(form, basis)],
            None => choice.candidates(basis)?,
        };
        let mut best: Option<(HolomorphicForm, FlatComplex, Findings)> = None;
        for form in candidates {
            stages.enter()?;
            let (flat, findings) = ground.lay_out(basis.form([&form.real, &form.imaginary]), None);
            let badness = best.as_ref().map(|best| best.2.badness());
            if badness.is_none_or(|least| findings.badness() < least) {
                best = Some((form, flat, findings));
            }
            if best.as_ref().is_some_and(|best| best.2.is_clean()) {
                break;
            }
        }
        best.ok_or(ConformalError::ZeroForm)
    }

    /// Returns an atlas with what it was made from.
    fn found(&self, atlas: Atlas, basis: HolomorphicBasis, form: HolomorphicForm) -> ClosedAtlas {
        ClosedAtlas {
            atlas,
            mesh: self.mesh.clone(),
            basis,
            form,
            parents: self.parents.clone(),
        }
    }

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
        let is_relaxed = self.relaxed.len() > before;
        if round < RELAXATIONS && is_relaxed && findings.not_disks.len() <= findings.folds() {
            return true;
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
    let points = points_around(mesh, flat, findings);
    (!points.is_empty())
        .then(|| split_at(mesh, &points).ok())
        .flatten()
}

/// Returns the middles of the sides of the faces around what is wrong.
pub(crate) fn points_around(
    mesh: &TriangleMesh,
    flat: &FlatComplex,
    findings: &Findings,
) -> Vec<SurfacePoint> {
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
    faces
        .flat_map(|face| middles.map(|at| SurfacePoint { face, at }))
        .collect()
}

#[cfg(test)]
mod tests {
    use msplines_common::mesh::FlipComplex;
    use msplines_common::progress::unobserved;

    use super::*;
    use crate::tests::with_spike;

    #[test]
    fn an_atlas_with_needles_is_better_than_none() {
        let mesh = with_spike(32, 0.9);
        let of = |rounds: usize| {
            let effort = Effort {
                rounds,
                folded: 1.0,
            };
            let found = search(&mesh, &FormChoice::default(), effort, &mut unobserved());
            let atlas = found.expect("an atlas").atlas;
            let glued = FlipComplex::of(atlas.mesh().topology());
            let flat = FlatComplex::of(&glued, atlas.form().to_vec());
            let count = needles(&flat, atlas.mesh(), &Findings::default()).len();
            (count, atlas.folded_faces(), atlas.refinements())
        };
        // Where nothing may be mended, the atlas with needles is what there is.
        let (count, folded, rounds) = of(0);
        assert!(count > 10, "{count} needles");
        assert_eq!((folded, rounds), (0, 0));
        // One round mends them all.
        assert_eq!(of(CHOSEN.rounds), (0, 0, 1));
    }
}
