//! Holes that are closed for the sake of the cylinders.
//!
//! A boundary loop that is short beside the surface would be the end of a thin cylinder, with a zero of its
//! own near by. A cone over its centre closes it: trajectories run across, and so does the spline; the faces
//! of the cone are remembered, and are no part of the surface. Where loops that were left leave thin cylinders
//! all the same, the shortest of them is closed too, and so on.
//!
//! # Reference
//! [He2006] §3.2. Deviation: the paper makes every boundary loop an end of cylinders.

use std::collections::BTreeSet;

use msplines_common::Vector3;
use msplines_common::mesh::{Facts, NONE, Topology, TriangleMesh};
use msplines_common::progress::Observer;
use msplines_conformal::ConformalError;
use msplines_conformal::bounded::puncture;
use msplines_conformal::poles::PoleChoice;

use super::apart::farthest_vertex;
use super::error::DomainError;
use super::{Domain, DomainOptions};

impl Domain {
    /// Cuts a connected surface into cylinders: one of genus >= 1, or one of any genus with two or more ends,
    /// which are boundary loops and poles. A surface of genus 0 with a boundary and fewer ends gets poles far
    /// from these.
    ///
    /// Holes whose loops are shorter than [`SnapOptions::hole`](super::SnapOptions::hole) are closed, and so are
    /// others where that leaves fewer thin cylinders, and the only one of a surface with handles; not where
    /// fluxes of all ends are given. Cost: the forms of the surface, and O(n) for each zero, for each time that
    /// a hole more is closed. `observer` sees the phase `domain`.
    ///
    /// # Errors
    /// A surface of another kind; poles at a boundary or beside each other; what the forms refuse, a stop
    /// among it; and as [`Self::of_form`].
    pub fn of_surface(
        mesh: &TriangleMesh,
        options: &DomainOptions,
        observer: &mut Observer<'_>,
    ) -> Result<Self, DomainError> {
        check(mesh, &options.poles)?;
        let Some(holes) = Holes::of(mesh, options) else {
            return Self::of_ends(mesh, options, observer);
        };
        let mut best: Option<Result<Self, DomainError>> = None;
        for open in (holes.open.min(1)..=holes.open).rev() {
            let found = holes.cut(open, options, observer);
            let thin = |tried: &Result<Self, DomainError>| match tried {
                Ok(domain) => domain.report.thin,
                Err(_) => usize::MAX,
            };
            let is_over = match &found {
                Err(DomainError::Conformal(error)) => error.is_stopped(),
                Err(_) => false,
                Ok(_) => thin(&found) == 0,
            };
            if is_over {
                return found;
            }
            let before = best.take().filter(|before| thin(before) <= thin(&found));
            best = before.or(Some(found));
        }
        best.unwrap_or_else(|| Self::of_ends(mesh, options, observer))
    }
}

/// Checks what the forms would not name, or after much work only.
fn check(mesh: &TriangleMesh, poles: &[u32]) -> Result<(), DomainError> {
    let (_, components) = mesh.topology().components();
    if components != 1 {
        return Err(ConformalError::NotConnected { components }.into());
    }
    let is_finite = |p: &msplines_common::Point3<f64>| p.iter().all(|x| x.is_finite());
    if let Some(vertex) = mesh.positions().iter().position(|p| !is_finite(p)) {
        let vertex = vertex as u32;
        return Err(DomainError::NotFinite { vertex });
    }
    let twice = |i: &usize| poles[..*i].contains(&poles[*i]);
    if let Some(i) = (0..poles.len()).find(twice) {
        return Err(DomainError::SamePole { vertex: poles[i] });
    }
    // A closed hole would hide that a pole lies on its rim.
    puncture(mesh, poles).map_err(ConformalError::from)?;
    Ok(())
}

/// The boundary loops of a surface, longest first.
struct Holes<'a> {
    surface: &'a TriangleMesh,
    genus: u32,
    /// Vertices around each, in the order of its half-edges.
    rims: Vec<Vec<u32>>,
    /// How many of them are long.
    open: usize,
}

impl<'a> Holes<'a> {
    /// Sorts boundary loops; nothing if there are none, or all fluxes are given.
    fn of(surface: &'a TriangleMesh, options: &DomainOptions) -> Option<Self> {
        let topology = surface.topology();
        let facts = Facts::measure(surface);
        let given = matches!(options.pole_form, PoleChoice::Given { .. });
        if facts.boundary_loops == 0 || given {
            return None;
        }
        let loops = topology.boundary_loops().into_iter();
        let rims = loops.map(|l| l.iter().map(|&h| topology.origin(h)).collect());
        let length = |rim: &Vec<u32>| -> f64 {
            let next = rim.iter().cycle().skip(1);
            let sides = rim.iter().zip(next).map(|(&a, &b)| [a, b]);
            let sides = sides.map(|ends| ends.map(|v| surface.positions()[v as usize]));
            sides.map(|[a, b]| (b - a).norm()).sum()
        };
        let mut measured: Vec<(f64, Vec<u32>)> = rims.map(|rim| (length(&rim), rim)).collect();
        measured.sort_by(|a, b| b.0.total_cmp(&a.0));
        let least = options.snap.hole * facts.area.sqrt();
        Some(Self {
            surface,
            genus: facts.genus.unwrap_or(0),
            open: measured
                .iter()
                .filter(|(length, _)| *length >= least)
                .count(),
            rims: measured.into_iter().map(|(_, rim)| rim).collect(),
        })
    }

    /// Cuts the surface with all holes but the first ones closed.
    fn cut(
        &self,
        open: usize,
        options: &DomainOptions,
        observer: &mut Observer<'_>,
    ) -> Result<Domain, DomainError> {
        let given = &options.poles;
        // One end alone has no flux, and the forms of the handles need none.
        let is_alone = self.genus > 0 && open == 1 && given.is_empty();
        let closed = self.closed(if is_alone { 0 } else { open })?;
        let options = DomainOptions {
            poles: closed.poles(self.surface, given)?,
            ..options.clone()
        };
        let domain = Domain::of_ends(&closed.mesh, &options, observer)?;
        Ok(closed.marked(domain))
    }

    fn closed(&self, open: usize) -> Result<Closed<'_>, DomainError> {
        let at = |v: u32| self.surface.positions()[v as usize];
        let mut positions = self.surface.positions().to_vec();
        let mut faces = self.surface.faces().to_vec();
        for rim in &self.rims[open..] {
            let apex = positions.len() as u32;
            let from: Vector3<f64> = rim.iter().map(|&v| at(v) - at(rim[0])).sum();
            positions.push(at(rim[0]) + from / rim.len() as f64);
            let next = rim.iter().cycle().skip(1);
            faces.extend(rim.iter().zip(next).map(|(&from, &to)| [to, from, apex]));
        }
        Ok(Closed {
            mesh: TriangleMesh::build(positions, faces).map_err(ConformalError::from)?,
            rims: &self.rims[open..],
            own: self.surface.vertex_count() as u32,
            genus: self.genus,
            ends: open,
        })
    }
}

/// A surface some of whose holes are closed.
struct Closed<'a> {
    mesh: TriangleMesh,
    rims: &'a [Vec<u32>],
    /// Vertices of the surface; the centres of closed holes follow.
    own: u32,
    genus: u32,
    /// Number of loops that are ends.
    ends: usize,
}

impl Closed<'_> {
    /// Returns the poles given; on a surface of genus 0 with fewer than two ends others too, far from these
    /// along edges.
    fn poles(&self, surface: &TriangleMesh, given: &[u32]) -> Result<Vec<u32>, DomainError> {
        let mut poles = given.to_vec();
        while self.genus == 0 && self.ends + poles.len() < 2 {
            let found = farthest_vertex(&self.mesh, surface, &poles);
            let vertices = surface.vertex_count();
            poles.push(found.ok_or(DomainError::NoRoom { vertices })?);
        }
        Ok(poles)
    }

    /// Names the faces of the cones, and takes their centres from the vertices of the surface.
    fn marked(&self, domain: Domain) -> Domain {
        let outside = self.outside(domain.mesh().topology(), domain.origins());
        let own = |origin: &Option<u32>| origin.filter(|&v| v < self.own);
        let origins = domain.origins().iter().map(own).collect();
        let mut domain = domain.with_origins(origins).with_outside(outside);
        domain.report.closed_holes = self.rims.len();
        domain
    }

    /// The faces that the rims keep apart from the surface, in order; vertices have other names there. Flips
    /// may have taken edges of a rim away: faces across it count as the surface.
    fn outside(&self, topology: &Topology, names: &[Option<u32>]) -> Vec<u32> {
        let (mut sides, mut on_rims) = (BTreeSet::new(), BTreeSet::new());
        for rim in self.rims {
            let next = rim.iter().cycle().skip(1);
            sides.extend(rim.iter().zip(next).map(|(&a, &b)| [a.min(b), a.max(b)]));
            on_rims.extend(rim.iter().copied());
        }
        let name = |v: u32| names[v as usize];
        let is_own = |v: u32| name(v).is_some_and(|v| v < self.own && !on_rims.contains(&v));
        let is_rim = |half_edge: u32| {
            let [a, b] = [topology.origin(half_edge), topology.target(half_edge)].map(name);
            a.zip(b)
                .is_some_and(|(a, b)| sides.contains(&[a.min(b), a.max(b)]))
        };
        let centres = (0..names.len() as u32).filter(|&v| name(v).is_some_and(|v| v >= self.own));
        let mut stack: Vec<u32> = centres
            .flat_map(|v| topology.outgoing(v).map(|h| h / 3))
            .collect();
        let mut found = BTreeSet::new();
        while let Some(face) = stack.pop() {
            let across = topology.faces()[face as usize].into_iter().any(is_own);
            if across || !found.insert(face) {
                continue;
            }
            let beyond = (3 * face..3 * face + 3)
                .filter(|&h| !is_rim(h))
                .map(|h| topology.twin(h));
            stack.extend(beyond.filter(|&twin| twin != NONE).map(|twin| twin / 3));
        }
        found.into_iter().collect()
    }
}
