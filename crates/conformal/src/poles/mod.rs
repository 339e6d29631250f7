//! Forms with poles: limbs end in holes that a given flux leaves through.
//!
//! A form of a closed surface fades exponentially along a limb. With a hole at its tip, through which
//! a share of the form leaves, its length is even there too. Holes are boundary loops, and the stars of
//! vertices; the imaginary part is constant along each.
//!
//! # Notation
//! `g` genus, `b` holes. `HD` the `2g + b - 1` harmonic forms that vanish along the holes, `HN` as many
//! that nothing flows out of at the holes; `M` their wedge products, integers with `det M = ±1`,
//! `G = HDᵀ c HD`. `v = HD a`, `u = -HN M⁻¹ G a`, `ω = u + i v`. The first `2g` entries of `a` are the
//! integer class, the others the levels of the holes against the first one.
//!
//! # Reference
//! [He2006] §3.2, cuts at extremities. Deviation: no double cover, and fluxes are chosen.

mod basis;
mod error;
mod holes;
#[cfg(test)]
mod protrusion_tests;
mod protrusions;
mod search;
#[cfg(test)]
mod tests;
mod tips;

use msplines_common::mesh::{SurfacePoint, TriangleMesh};
use msplines_common::progress::{Observer, Stages};
use serde::{Deserialize, Serialize};

use crate::atlas::{Atlas, Ground, failure};
use crate::circle::CircleMap;
use crate::classes::ClassObjective;
use crate::closed::points_around;
use crate::error::ConformalError;
use crate::flat::FlatComplex;
use crate::zeros::Findings;
use basis::PoledBasis;
use holes::{Cut, Holes};
use search::{Candidate, LEAST_FLUX};

pub use error::PolesError;
pub use protrusions::{ProtrusionOptions, Protrusions};

/// Rounds in which faces are split where forms fold them.
const ROUNDS: usize = 6;

/// Sums of fluxes beyond this share of the largest one are no rounding of zero.
const BALANCED: f64 = 1e-9;

/// Class and fluxes of a form with poles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PoleChoice {
    /// The most even and shortest form that a search from seeded starts finds, with no flux below a
    /// quarter of the largest one.
    Optimal {
        /// Seed of the starts.
        seed: u64,
        /// What classes are compared by.
        #[serde(default)]
        objective: ClassObjective,
    },
    /// A class and fluxes.
    Given {
        /// The integer class of the imaginary part, `2g` entries in the basis of the surface with its
        /// holes filled.
        class: Vec<i64>,
        /// The integral of the real part around each hole, the surface on its left; their sum is 0.
        fluxes: Vec<f64>,
    },
}

impl Default for PoleChoice {
    fn default() -> Self {
        Self::optimal(0)
    }
}

impl PoleChoice {
    /// Returns the choice of the form that costs least by the usual objective.
    #[must_use]
    pub fn optimal(seed: u64) -> Self {
        Self::Optimal {
            seed,
            objective: ClassObjective::default(),
        }
    }
}

/// An atlas with poles.
#[derive(Clone, Debug)]
pub struct PoledAtlas {
    /// The atlas of the surface outside of the holes.
    pub atlas: Atlas,
    /// Vertex of the input that each vertex of the atlas is; nothing for added ones.
    pub origins: Vec<Option<u32>>,
    /// The integer class of the imaginary part.
    pub class: Vec<i64>,
    /// The integral of the real part around each hole, before the form was scaled.
    pub fluxes: Vec<f64>,
    /// The imaginary part as a map to the circle, before the form was scaled. It is constant modulo 1 on
    /// each hole.
    pub circle: CircleMap,
    /// The boundary half-edges of the atlas around each hole: first those of the input's loops, then
    /// those of the vertices in their order.
    pub loops: Vec<Vec<u32>>,
    /// Area-weighted variance of `log |ω|`.
    pub log_variance: f64,
}

impl Atlas {
    /// Lays out a surface of any genus with the stars of some vertices removed, by a form with one flux
    /// for each hole.
    ///
    /// Its imaginary part is constant on each hole and has integer periods around handles, so that all
    /// its level lines close; it has `2g - 2 + b` zeros. `observer` sees the phase `domain`. Cost: one
    /// ordering and two factorisations of the Laplacian, and `2g + b - 1` solves with either.
    ///
    /// # Reference
    /// [He2006] §3.2.
    ///
    /// # Errors
    /// Stars that cannot be removed, fewer than two holes, classes and fluxes that mean nothing, a mesh
    /// that stays too coarse; the observer asks to stop.
    pub fn with_poles(
        mesh: &TriangleMesh,
        poles: &[u32],
        choice: &PoleChoice,
        observer: &mut Observer<'_>,
    ) -> Result<PoledAtlas, ConformalError> {
        let mut stages = Stages::new("domain", 0, observer);
        stages.enter()?;
        let mut holes = Holes::of(mesh, poles)?;
        check(&holes, choice)?;
        let first = holes.cut()?;
        let flat_faces = between_loops_only(&first.mesh);
        holes.split(&first, &flat_faces)?;
        let mut kept: Option<Candidate> = None;
        let mut round = 0;
        loop {
            let cut = holes.cut()?;
            let basis = PoledBasis::build(&cut, &mut stages)?;
            stages.enter()?;
            let candidates = match (&kept, choice) {
                (Some(found), _) => search::given(&basis, &found.class, &found.fluxes)
                    .into_iter()
                    .collect(),
                (None, PoleChoice::Given { class, fluxes }) => {
                    search::given(&basis, class, fluxes).into_iter().collect()
                }
                (None, PoleChoice::Optimal { seed, objective }) => {
                    search::best(&basis, *objective, *seed)
                }
            };
            let expected = 2 * holes.genus() as i64 - 2 + holes.count() as i64;
            let tried = best(&cut, &basis, candidates, expected, &mut stages)?;
            if tried.findings.is_clean() {
                return finish(&holes, &cut, &basis, tried, (expected, round));
            }
            let points = points_around(&cut.mesh, &tried.flat, &tried.findings);
            if round == ROUNDS || points.is_empty() {
                return Err(failure(&tried.flat, &tried.findings, round));
            }
            holes.split(&cut, &points)?;
            kept = Some(tried.candidate);
            round += 1;
        }
    }
}

/// A form and how it lays out the surface.
struct Tried {
    candidate: Candidate,
    flat: FlatComplex,
    findings: Findings,
    zeros: i64,
}

/// The first form without folds and with all its zeros, or else the one with least that is wrong.
fn best(
    cut: &Cut,
    basis: &PoledBasis,
    candidates: Vec<Candidate>,
    expected: i64,
    stages: &mut Stages<'_, '_>,
) -> Result<Tried, ConformalError> {
    let ground = Ground::build(&cut.mesh, &basis.triangulation);
    let mut best: Option<(u64, Tried)> = None;
    for candidate in candidates {
        stages.enter()?;
        let (flat, findings) = ground.lay_out(basis.form(&candidate.imaginary), None);
        let zeros: i64 = findings
            .zeros
            .iter()
            .map(|zero| i64::from(zero.order))
            .sum();
        let wrong = findings.badness() as u64 + (zeros - expected).unsigned_abs();
        if best.as_ref().is_none_or(|(least, _)| wrong < *least) {
            let tried = Tried {
                candidate,
                flat,
                findings,
                zeros,
            };
            best = Some((wrong, tried));
        }
        if wrong == 0 {
            break;
        }
    }
    Ok(best.ok_or(PolesError::NoForm)?.1)
}

fn finish(
    holes: &Holes,
    cut: &Cut,
    basis: &PoledBasis,
    tried: Tried,
    (expected, rounds): (i64, usize),
) -> Result<PoledAtlas, ConformalError> {
    if tried.zeros != expected {
        let found = tried.zeros;
        return Err(PolesError::Zeros { found, expected }.into());
    }
    let origins = holes.origins(cut);
    let known = origins.iter().flatten().count();
    let ground = Ground::build(&cut.mesh, &basis.triangulation);
    let atlas = ground.atlas(tried.flat, tried.findings.zeros, known, rounds)?;
    let circle = CircleMap::of(&atlas, basis.function(cut, &tried.candidate.imaginary))?;
    Ok(PoledAtlas {
        loops: loops_of(&atlas, cut),
        circle,
        origins,
        class: tried.candidate.class,
        fluxes: tried.candidate.fluxes,
        log_variance: tried.candidate.log_variance,
        atlas,
    })
}

/// The loops of a surface on another triangulation of it, each from the same vertex.
fn loops_of(atlas: &Atlas, cut: &Cut) -> Vec<Vec<u32>> {
    let there = cut.mesh.topology();
    let here = atlas.mesh().topology();
    let mut leaving = vec![0; cut.mesh.vertex_count()];
    for half_edge in here.boundary_loops().into_iter().flatten() {
        leaving[here.origin(half_edge) as usize] = half_edge;
    }
    let follow = |half_edges: &Vec<u32>| {
        let origins = half_edges.iter().map(|&h| there.origin(h));
        origins.map(|v| leaving[v as usize]).collect()
    };
    cut.loops.iter().map(follow).collect()
}

fn check(holes: &Holes, choice: &PoleChoice) -> Result<(), PolesError> {
    let (count, genus) = (holes.count(), holes.genus());
    if count < 2 {
        return Err(PolesError::TooFew { holes: count });
    }
    let PoleChoice::Given { class, fluxes } = choice else {
        return Ok(());
    };
    if class.len() != 2 * genus {
        return Err(PolesError::ClassCount {
            given: class.len(),
            needed: 2 * genus,
            genus,
        });
    }
    let finite = fluxes.iter().filter(|flux| flux.is_finite()).count();
    if finite != count || fluxes.len() != count {
        return Err(PolesError::FluxCount {
            given: finite,
            holes: count,
        });
    }
    let largest = fluxes
        .iter()
        .fold(0.0_f64, |most, flux| most.max(flux.abs()));
    let sum: f64 = fluxes.iter().sum();
    if sum.abs() > BALANCED * largest {
        return Err(PolesError::Unbalanced { sum });
    }
    let is_weak = |flux: &f64| flux.abs() < LEAST_FLUX * largest || *flux == 0.0;
    match fluxes.iter().position(is_weak) {
        Some(hole) => Err(PolesError::Weak {
            hole,
            flux: fluxes[hole],
            largest,
        }),
        None => Ok(()),
    }
}

/// The middles of the faces whose corners all lie on loops: the form is constant on those of one loop.
fn between_loops_only(mesh: &TriangleMesh) -> Vec<SurfacePoint> {
    let on_loop = |&v: &u32| mesh.topology().is_boundary_vertex(v);
    let faces =
        (0..mesh.face_count() as u32).filter(|&f| mesh.faces()[f as usize].iter().all(on_loop));
    let at = [1.0 / 3.0; 3];
    faces.map(|face| SurfacePoint { face, at }).collect()
}
