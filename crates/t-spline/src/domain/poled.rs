//! The form of a surface with boundary loops and poles.

use msplines_common::mesh::{Facts, NONE, SurfacePoint, Topology, TriangleMesh, split_at};
use msplines_common::operators::intrinsic::FlipRule;
use msplines_common::progress::Observer;
use msplines_conformal::bounded::{bounded_form, puncture};
use msplines_conformal::poles::PolesError;
use msplines_conformal::{Atlas, ConformalError};

use super::error::DomainError;
use super::form::{End, PeriodicForm};
use super::{Domain, DomainOptions};

impl Domain {
    /// Cuts a surface all of whose boundary loops are ends.
    pub(super) fn of_ends(
        mesh: &TriangleMesh,
        options: &DomainOptions,
        observer: &mut Observer<'_>,
    ) -> Result<Self, DomainError> {
        let facts = Facts::measure(mesh);
        let genus = facts.genus.unwrap_or(0);
        let loops = facts.boundary_loops + options.poles.len();
        match (genus, loops) {
            (1.., 0) => Self::closed(mesh, options, observer),
            (_, 0 | 1) => Err(DomainError::Kind { genus, loops }),
            _ => Self::poled(mesh, facts.boundary_loops, options, observer),
        }
    }

    fn poled(
        mesh: &TriangleMesh,
        boundaries: usize,
        options: &DomainOptions,
        observer: &mut Observer<'_>,
    ) -> Result<Self, DomainError> {
        let found = match Atlas::with_poles(mesh, &options.poles, &options.pole_form, observer) {
            Err(ConformalError::Poles(PolesError::NoForm)) => {
                return Self::levelled(mesh, options, observer);
            }
            found => found?,
        };
        // The loops of the input come first, then those around the poles.
        let end = |loop_of_atlas: &Vec<u32>| {
            let place = found
                .loops
                .iter()
                .position(|hole| hole.contains(&loop_of_atlas[0]));
            let pole = place.and_then(|hole| options.poles.get(hole.checked_sub(boundaries)?));
            pole.map_or(End::Boundary, |&pole| End::Pole(pole))
        };
        let loops = found.atlas.mesh().topology().boundary_loops();
        let given = PeriodicForm {
            ends: loops.iter().map(end).collect(),
            ..PeriodicForm::of_atlas(&found.atlas)
        };
        let mut domain = Self::of_form(&given, &options.snap)?;
        domain.origins = found.origins;
        Ok(domain)
    }

    /// Cuts a surface of genus 0 by the harmonic function that is 0 on its longest loop and 1 on the
    /// others, where no form has fluxes that are alike: small holes beside a large one. It stays on the
    /// mesh as it is, as Delaunay flips make faces between three vertices of one hole; some are folded.
    fn levelled(
        mesh: &TriangleMesh,
        options: &DomainOptions,
        observer: &mut Observer<'_>,
    ) -> Result<Self, DomainError> {
        let (rest, origins) = puncture(mesh, &options.poles).map_err(ConformalError::from)?;
        let rest = without_flat_faces(&rest)?;
        let levels = levels(&rest);
        let found = bounded_form(&rest, &levels, FlipRule::Simplicial, observer);
        let found = found.map_err(ConformalError::from)?;
        let topology = rest.topology();
        let end = |half_edges: &Vec<u32>| {
            let vertex = origins[topology.origin(half_edges[0]) as usize];
            let is_beside = |pole: &&u32| mesh.topology().neighbours(**pole).any(|v| v == vertex);
            let pole = options.poles.iter().find(is_beside);
            pole.map_or(End::Boundary, |&pole| End::Pole(pole))
        };
        let given = PeriodicForm {
            ends: topology.boundary_loops().iter().map(end).collect(),
            // i ω, whose imaginary part is the function.
            form: (found.on_mesh(&rest).iter())
                .map(|[u, v]| [-v, *u])
                .collect(),
            mesh: rest.clone(),
        };
        let mut domain = Self::of_form(&given, &options.snap)?;
        let added = given.mesh.vertex_count() - origins.len();
        let known = origins.into_iter().map(Some);
        domain.origins = known.chain(std::iter::repeat_n(None, added)).collect();
        Ok(domain)
    }
}

/// Splits the inner sides of every face whose corners all lie on the boundary: the function is constant
/// on faces of one loop.
fn without_flat_faces(mesh: &TriangleMesh) -> Result<TriangleMesh, ConformalError> {
    let topology = mesh.topology();
    let on_loop = |&v: &u32| topology.is_boundary_vertex(v);
    let faces = 0..mesh.face_count() as u32;
    let flat = faces.filter(|&f| mesh.faces()[f as usize].iter().all(on_loop));
    let sides = flat.flat_map(|face| 3 * face..3 * face + 3);
    let inner = sides.filter(|&h| topology.twin(h) != NONE);
    let middle = |half_edge: u32| {
        let mut at = [0.5; 3];
        at[Topology::previous(half_edge) as usize % 3] = 0.0;
        let face = half_edge / 3;
        SurfacePoint { face, at }
    };
    let points: Vec<SurfacePoint> = inner.map(middle).collect();
    Ok(split_at(mesh, &points)?.mesh)
}

/// 0 on the longest loop, 1 on the others.
fn levels(mesh: &TriangleMesh) -> Vec<f64> {
    let topology = mesh.topology();
    let side = |&h: &u32| {
        let ends = [topology.origin(h), topology.target(h)];
        let [a, b] = ends.map(|v| mesh.positions()[v as usize]);
        (b - a).norm()
    };
    let loops = topology.boundary_loops();
    let lengths: Vec<f64> = loops.iter().map(|l| l.iter().map(side).sum()).collect();
    let longest = lengths.iter().copied().fold(0.0, f64::max);
    let first = lengths.iter().position(|&length| length == longest);
    (0..lengths.len())
        .map(|k| if Some(k) == first { 0.0 } else { 1.0 })
        .collect()
}
