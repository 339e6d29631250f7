//! The form of a surface of genus 0 with boundary loops, and of the whole surface of either kind.

use msplines_common::mesh::{Facts, TriangleMesh};
use msplines_conformal::{Atlas, AtlasOptions, Structure, SurfaceAtlas};

use super::error::DomainError;
use super::form::{End, PeriodicForm};
use super::{Domain, DomainOptions};

impl Domain {
    /// Cuts a connected surface into cylinders: a closed one of genus >= 1, or one of genus 0 with two or
    /// more boundary loops and poles.
    ///
    /// The longest loop of a surface of genus 0 has level 0, the others have level 1. Cost: the forms of
    /// the surface, and O(n) for each zero.
    ///
    /// # Errors
    /// A surface of another kind; what the forms refuse; and as [`Self::of_form`].
    pub fn of_surface(mesh: &TriangleMesh, options: &DomainOptions) -> Result<Self, DomainError> {
        let facts = Facts::measure(mesh);
        let genus = facts.genus.unwrap_or(0);
        let loops = facts.boundary_loops + options.poles.len();
        match (genus, loops) {
            (1.., 0) => Self::closed(mesh, options),
            (1.., _) => Err(DomainError::Kind {
                genus,
                loops,
                remedy: "fill its loops, or give a form of your own",
            }),
            (0, 0 | 1) => Err(DomainError::Kind {
                genus,
                loops,
                remedy: "name vertices as poles until there are two loops",
            }),
            _ => Self::bounded(mesh, options),
        }
    }

    fn bounded(mesh: &TriangleMesh, options: &DomainOptions) -> Result<Self, DomainError> {
        let atlas_options = AtlasOptions {
            puncture: options.poles.clone(),
            ..AtlasOptions::default()
        };
        let found = Atlas::of_surface(mesh, &atlas_options)?;
        let Structure::Bounded { levels } = &found.structure else {
            return Err(DomainError::Kind {
                genus: 0,
                loops: found.atlas.mesh().topology().boundary_loops().len(),
                remedy: "zeros lie too near to its loops: refine it there, or choose other poles",
            });
        };
        let given = turned(&found, levels, ends(mesh, &found, &options.poles));
        let mut domain = Self::of_form(&given, &options.snap)?;
        domain.origins = found.origins;
        Ok(domain)
    }
}

/// `i ω`, whose imaginary part is the potential, in its own scale.
fn turned(found: &SurfaceAtlas, levels: &[f64], ends: Vec<End>) -> PeriodicForm {
    let mesh = found.atlas.mesh();
    let topology = mesh.topology();
    let loops = topology.boundary_loops();
    // The potential at each vertex, in the scale of the atlas.
    let mut potential = vec![f64::NAN; mesh.vertex_count()];
    let mut queue = std::collections::VecDeque::new();
    if let Some(first) = loops.first() {
        potential[topology.origin(first[0]) as usize] = levels[0];
        queue.push_back(topology.origin(first[0]));
    }
    while let Some(vertex) = queue.pop_front() {
        for half_edge in topology.outgoing(vertex) {
            let target = topology.target(half_edge);
            if potential[target as usize].is_nan() {
                let rise = found.atlas.form()[half_edge as usize][0];
                potential[target as usize] = potential[vertex as usize] + rise;
                queue.push_back(target);
            }
        }
    }
    let other = levels.iter().position(|&level| level != levels[0]).unwrap_or(0);
    let there = loops.get(other).map_or(0, |l| topology.origin(l[0]));
    let scale = (levels[other] - levels[0]) / (potential[there as usize] - levels[0]);
    PeriodicForm {
        mesh: mesh.clone(),
        form: (found.atlas.form().iter()).map(|[u, v]| [-v * scale, u * scale]).collect(),
        ends,
    }
}

/// Which loops of an atlas are around poles: all of their vertices of the surface are beside one.
fn ends(mesh: &TriangleMesh, found: &SurfaceAtlas, poles: &[u32]) -> Vec<End> {
    let topology = found.atlas.mesh().topology();
    let end = |half_edges: &Vec<u32>| {
        let vertices = half_edges.iter().map(|&h| topology.origin(h));
        let known: Vec<u32> = vertices.filter_map(|v| found.origins[v as usize]).collect();
        let is_around = |&&pole: &&u32| {
            let beside: Vec<u32> = mesh.topology().neighbours(pole).collect();
            known.iter().all(|v| beside.contains(v))
        };
        match poles.iter().find(is_around) {
            Some(&pole) if !known.is_empty() => End::Pole(pole),
            _ => End::Boundary,
        }
    };
    topology.boundary_loops().iter().map(end).collect()
}
