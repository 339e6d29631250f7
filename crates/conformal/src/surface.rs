//! The affine atlas of a surface, whatever its topology.

use std::collections::BTreeSet;

use msplines_common::mesh::{Facts, NONE, SurfacePoint, TopologyError, TriangleMesh, split_at};
use msplines_common::operators::intrinsic::{FlipRule, IntrinsicTriangulation};
use msplines_common::progress::Observer;
use nalgebra::{Point3, Vector3};
use serde::{Deserialize, Serialize};

use crate::atlas::{Atlas, Ground, failure};
use crate::basis::HolomorphicBasis;
use crate::bounded::{bounded_form, puncture};
use crate::choice::{FormChoice, HolomorphicForm};
use crate::circle::CircleMap;
use crate::closed::split_around;
use crate::disk::flatten_disk;
use crate::error::ConformalError;
use crate::measure::{Distortion, area, planar_edges, stretch};
use crate::sphere::spherical_map;

/// Rounds in which faces of a surface with boundary are split where the form folds them.
const BOUNDED_ROUNDS: usize = 6;

/// How a surface is laid out.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AtlasOptions {
    /// The form of a closed surface of genus >= 1; surfaces of genus 0 leave no choice.
    pub form: FormChoice,
    /// Vertices whose stars are removed first.
    pub puncture: Vec<u32>,
}

/// What a surface is laid out by.
#[derive(Clone, Debug)]
pub enum Structure {
    /// A holomorphic form of a closed surface, and the harmonic forms it was chosen from.
    Closed {
        /// The harmonic forms of the mesh, refined where that was needed.
        basis: Box<HolomorphicBasis>,
        /// The form taken, before it was scaled.
        form: HolomorphicForm,
    },
    /// The stereographic image of a closed surface of genus 0, from a vertex that lies at infinity.
    Sphere {
        /// That vertex.
        pole: u32,
    },
    /// A flattened disk.
    Disk,
    /// A harmonic function with constant levels on the boundary loops, and its conjugate.
    Bounded {
        /// The level of each loop, in the order of the topology's loops.
        levels: Vec<f64>,
    },
    /// The structure of the surface with cones over its holes: over all where it has handles, over all
    /// but the longest where it has none.
    Filled {
        /// Number of cones.
        cones: usize,
    },
}

/// An atlas and how it was made.
#[derive(Clone, Debug)]
pub struct SurfaceAtlas {
    /// The atlas.
    pub atlas: Atlas,
    /// What the surface is laid out by.
    pub structure: Structure,
    /// Vertex of the input that each vertex of the atlas is; nothing for added ones.
    pub origins: Vec<Option<u32>>,
    /// Figures about it.
    pub report: AtlasReport,
}

impl SurfaceAtlas {
    /// Returns the imaginary part of the form, before that was scaled, as a map to the circle. O(g n).
    ///
    /// Its integral over any closed path of edges is an integer, exactly, as jumps are integers and
    /// differences of the function cancel.
    ///
    /// # Errors
    /// The imaginary part has other periods than integers, or the surface is not laid out by a form of a
    /// closed surface.
    pub fn circle_map(&self) -> Result<CircleMap, ConformalError> {
        let Structure::Closed { basis, form } = &self.structure else {
            return Err(ConformalError::NoForm);
        };
        let imaginary = form.imaginary.as_slice();
        CircleMap::of(&self.atlas, basis.potentials().function(imaginary))
    }
}

/// Figures about an atlas.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AtlasReport {
    /// Number of handles.
    pub genus: u32,
    /// Number of zeros, with their orders.
    pub zeros: u32,
    /// Folded faces outside of the holes: always 0.
    pub flips: usize,
    /// Vertices added by local refinement.
    pub added_vertices: usize,
    /// Rounds in which the mesh was refined or weights were relaxed.
    pub rounds: usize,
    /// Angle distortion and spread of the conformal factor, folded faces at zeros left out.
    pub distortion: Distortion,
    /// Largest sum of the form around a face, relative to its longest side in the plane.
    pub closedness: f64,
    /// Largest flux out of a vertex relative to the largest one beside it; of closed surfaces.
    pub co_closedness: Option<f64>,
    /// `|C² + I|`, the error of the discretisation; of closed surfaces of genus >= 1.
    pub conjugation_defect: Option<f64>,
    /// Area-weighted variance of `log |ω|`; of closed surfaces of genus >= 1.
    pub log_variance: Option<f64>,
}

impl Atlas {
    /// Lays out a connected surface, after removing the stars of the vertices to be punctured.
    ///
    /// # Errors
    /// Several components, stars that cannot be removed, and what the map of each kind of surface
    /// refuses; the observer, which sees the phase `domain`, asks to stop.
    pub fn of_surface(
        mesh: &TriangleMesh,
        options: &AtlasOptions,
        observer: &mut Observer<'_>,
    ) -> Result<SurfaceAtlas, ConformalError> {
        if options.puncture.is_empty() {
            let all = (0..mesh.vertex_count() as u32).collect();
            return lay_out(mesh, all, &options.form, observer);
        }
        let (rest, origins) = puncture(mesh, &options.puncture)?;
        lay_out(&rest, origins, &options.form, observer)
    }
}

fn lay_out(
    mesh: &TriangleMesh,
    origins: Vec<u32>,
    choice: &FormChoice,
    observer: &mut Observer<'_>,
) -> Result<SurfaceAtlas, ConformalError> {
    let facts = Facts::measure(mesh);
    let Some(genus) = facts.genus else {
        return Err(ConformalError::NotConnected {
            components: facts.components,
        });
    };
    match (genus, facts.boundary_loops) {
        (0, 0) => sphere(mesh, origins, observer),
        (0, 1) => disk(mesh, origins, observer),
        (0, _) => match bounded(mesh, origins.clone(), observer) {
            Err(error) if !error.is_stopped() => filled_disk(mesh, origins, observer),
            other => other,
        },
        (_, 0) => closed(mesh, origins, choice, observer),
        (..) => filled_closed(mesh, origins, choice, observer),
    }
}

fn closed(
    mesh: &TriangleMesh,
    origins: Vec<u32>,
    choice: &FormChoice,
    observer: &mut Observer<'_>,
) -> Result<SurfaceAtlas, ConformalError> {
    let found = Atlas::closed(mesh, choice, observer)?;
    let triangulation = found.basis.triangulation();
    let form = found.basis.form([&found.form.real, &found.form.imaginary]);
    let distortion = distortion_outside(&found.atlas, triangulation, &form);
    let mut atlas = finish(found.atlas, origins, found.basis.genus() as u32, distortion);
    atlas.report.co_closedness = Some(found.basis.co_closedness);
    atlas.report.conjugation_defect = Some(found.basis.conjugation_defect);
    atlas.report.log_variance = Some(found.form.log_variance);
    atlas.structure = Structure::Closed {
        basis: Box::new(found.basis),
        form: found.form,
    };
    Ok(atlas)
}

fn disk(
    mesh: &TriangleMesh,
    origins: Vec<u32>,
    observer: &mut Observer<'_>,
) -> Result<SurfaceAtlas, ConformalError> {
    let map = flatten_disk(mesh, observer)?;
    let form = planar_edges(&map.triangulation.faces, &map.points);
    let atlas = Atlas::on_triangulation(mesh, &map.triangulation, form, None)?;
    Ok(finish(atlas, origins, 0, map.distortion))
}

fn bounded(
    mesh: &TriangleMesh,
    mut origins: Vec<u32>,
    observer: &mut Observer<'_>,
) -> Result<SurfaceAtlas, ConformalError> {
    let mut refined = mesh.clone();
    let mut round = 0;
    loop {
        refined = without_flat_faces(&refined)?;
        let levels = levels(&refined);
        let found = bounded_form(&refined, &levels, FlipRule::Simplicial, observer)?;
        let ground = Ground::build(&refined, &found.triangulation);
        let (flat, findings) = ground.lay_out(found.form.clone(), None);
        if !findings.is_clean() {
            let split = split_around(&refined, &flat, &findings).filter(|_| round < BOUNDED_ROUNDS);
            refined = split.ok_or_else(|| failure(&flat, &findings, round))?.mesh;
            round += 1;
            continue;
        }
        let atlas = ground.atlas(flat, findings.zeros, mesh.vertex_count(), round)?;
        let distortion = distortion_outside(&atlas, &found.triangulation, &found.form);
        origins.truncate(mesh.vertex_count());
        let mut atlas = finish(atlas, origins, 0, distortion);
        atlas.structure = Structure::Bounded { levels };
        return Ok(atlas);
    }
}

/// A sphere with holes as a disk: where its harmonic function has zeros too near to a hole.
fn filled_disk(
    mesh: &TriangleMesh,
    origins: Vec<u32>,
    observer: &mut Observer<'_>,
) -> Result<SurfaceAtlas, ConformalError> {
    let open = levels(mesh).iter().position(|&level| level == 0.0);
    let (filled, cones) = with_cones(mesh, open)?;
    let map = flatten_disk(&filled, observer)?;
    let form = planar_edges(mesh.faces(), &map.points);
    let mut atlas = finish(Atlas::of_form(mesh, &form)?, origins, 0, map.distortion);
    atlas.structure = Structure::Filled { cones };
    Ok(atlas)
}

/// A surface with handles and holes, by the forms of the closed surface with cones over the holes.
fn filled_closed(
    mesh: &TriangleMesh,
    origins: Vec<u32>,
    choice: &FormChoice,
    observer: &mut Observer<'_>,
) -> Result<SurfaceAtlas, ConformalError> {
    let (filled, cones) = with_cones(mesh, None)?;
    let found = Atlas::closed(&filled, choice, observer)?;
    let form = found
        .basis
        .form_on_mesh(&found.mesh, [&found.form.real, &found.form.imaginary]);
    let kept: Vec<usize> = (0..found.parents.len())
        .filter(|&face| (found.parents[face] as usize) < mesh.face_count())
        .collect();
    let mut names = vec![NONE; found.mesh.vertex_count()];
    kept.iter()
        .flat_map(|&f| found.mesh.faces()[f])
        .for_each(|v| names[v as usize] = v);
    let mut positions = Vec::new();
    for (vertex, name) in names
        .iter_mut()
        .enumerate()
        .filter(|(_, name)| **name != NONE)
    {
        *name = positions.len() as u32;
        positions.push(found.mesh.positions()[vertex]);
    }
    let faces = kept
        .iter()
        .map(|&f| found.mesh.faces()[f].map(|v| names[v as usize]));
    let rest = TriangleMesh::build(positions, faces.collect())?;
    let form: Vec<[f64; 2]> = kept
        .iter()
        .flat_map(|&f| [0, 1, 2].map(|i| form[3 * f + i]))
        .collect();
    let triangulation = found.basis.triangulation();
    let on_triangulation = found.basis.form([&found.form.real, &found.form.imaginary]);
    let distortion = distortion_outside(&found.atlas, triangulation, &on_triangulation);
    let genus = found.basis.genus() as u32;
    let mut atlas = finish(Atlas::of_form(&rest, &form)?, origins, genus, distortion);
    atlas.report.rounds = found.atlas.refinements();
    atlas.structure = Structure::Filled { cones };
    Ok(atlas)
}

/// Closes boundary loops, all but one where one is named, by cones over their centres.
pub(crate) fn with_cones(
    mesh: &TriangleMesh,
    open: Option<usize>,
) -> Result<(TriangleMesh, usize), TopologyError> {
    let topology = mesh.topology();
    let mut positions = mesh.positions().to_vec();
    let mut faces = mesh.faces().to_vec();
    let loops = topology.boundary_loops();
    let closed = loops.iter().enumerate().filter(|(k, _)| Some(*k) != open);
    for (_, half_edges) in closed {
        let apex = positions.len() as u32;
        let ends = half_edges
            .iter()
            .map(|&h| [topology.origin(h), topology.target(h)]);
        let sum = ends.clone().fold(Vector3::zeros(), |sum, [from, _]| {
            sum + mesh.positions()[from as usize].coords
        });
        positions.push(Point3::from(sum / half_edges.len() as f64));
        faces.extend(ends.map(|[from, to]| [to, from, apex]));
    }
    let cones = positions.len() - mesh.vertex_count();
    Ok((TriangleMesh::build(positions, faces)?, cones))
}

/// Gives every face whose corners all lie on the boundary a vertex inside: the function is constant
/// on faces of one loop.
fn without_flat_faces(mesh: &TriangleMesh) -> Result<TriangleMesh, ConformalError> {
    let topology = mesh.topology();
    let centre = [1.0 / 3.0; 3];
    let flat = (0..mesh.face_count() as u32).filter(|&f| {
        let corners = mesh.faces()[f as usize];
        corners.iter().all(|&v| topology.is_boundary_vertex(v))
    });
    let points: Vec<SurfacePoint> = flat.map(|face| SurfacePoint { face, at: centre }).collect();
    Ok(split_at(mesh, &points)?.mesh)
}

/// The longest boundary loop is the source, the others are sinks.
fn levels(mesh: &TriangleMesh) -> Vec<f64> {
    let topology = mesh.topology();
    let length = |half_edges: &Vec<u32>| -> f64 {
        let ends = half_edges
            .iter()
            .map(|&h| [topology.origin(h), topology.target(h)]);
        let at = |v: u32| mesh.positions()[v as usize];
        ends.map(|[a, b]| (at(b) - at(a)).norm()).sum()
    };
    let lengths: Vec<f64> = topology.boundary_loops().iter().map(length).collect();
    let longest =
        (0..lengths.len()).max_by(|&a, &b| lengths[a].total_cmp(&lengths[b]).then(b.cmp(&a)));
    let level = |k: usize| if Some(k) == longest { 0.0 } else { 1.0 };
    (0..lengths.len()).map(level).collect()
}

/// The distortion of a form on its triangulation, away from the zeros of the atlas.
fn distortion_outside(
    atlas: &Atlas,
    triangulation: &IntrinsicTriangulation,
    form: &[[f64; 2]],
) -> Distortion {
    let zeros: BTreeSet<u32> = atlas
        .zeros()
        .iter()
        .flat_map(|z| z.vertices.clone())
        .collect();
    let faces = triangulation.faces.iter().zip(&triangulation.lengths);
    let (stretches, areas): (Vec<_>, Vec<_>) = faces
        .zip(form.as_chunks::<3>().0)
        .filter(|((corners, _), _)| !corners.iter().any(|v| zeros.contains(v)))
        .map(|((_, &sides), &edges)| (stretch(sides, edges), area(sides)))
        .unzip();
    Distortion::of(&stretches, &areas)
}

/// The stereographic image from the vertex where the surface is flattest.
fn sphere(
    mesh: &TriangleMesh,
    origins: Vec<u32>,
    observer: &mut Observer<'_>,
) -> Result<SurfaceAtlas, ConformalError> {
    let map = spherical_map(mesh, FlipRule::Simplicial, observer)?;
    let pole = flattest_vertex(mesh);
    let points = map.stereographic(map.points[pole as usize]);
    let mut form = planar_edges(&map.triangulation.faces, &points);
    for (h, vector) in form.iter_mut().enumerate() {
        let corners = map.triangulation.faces[h / 3];
        if corners[h % 3] == pole || corners[(h + 1) % 3] == pole {
            *vector = [0.0; 2];
        }
    }
    let atlas = Atlas::on_triangulation(mesh, &map.triangulation, form, Some(pole))?;
    let mut atlas = finish(atlas, origins, 0, map.distortion);
    atlas.structure = Structure::Sphere { pole };
    Ok(atlas)
}

/// The vertex whose faces have the least spread of normals.
fn flattest_vertex(mesh: &TriangleMesh) -> u32 {
    let spread = |v: u32| {
        let faces = mesh.topology().outgoing(v).map(|h| mesh.face_normal(h / 3));
        let (mut sum, mut lengths) = (Vector3::zeros(), 0.0);
        for normal in faces {
            sum += normal;
            lengths += normal.norm();
        }
        1.0 - sum.norm() / lengths
    };
    let spreads = (0..mesh.vertex_count() as u32).map(|v| (v, spread(v)));
    spreads
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map_or(0, |found| found.0)
}

fn finish(atlas: Atlas, origins: Vec<u32>, genus: u32, distortion: Distortion) -> SurfaceAtlas {
    let added = atlas.mesh().vertex_count() - origins.len();
    let orders = atlas.zeros().iter().map(|zero| zero.order.max(0) as u32);
    let report = AtlasReport {
        genus,
        zeros: orders.sum(),
        flips: atlas.folded_faces(),
        added_vertices: added,
        rounds: atlas.refinements(),
        distortion,
        closedness: atlas.closedness(),
        co_closedness: None,
        conjugation_defect: None,
        log_variance: None,
    };
    let known = origins.into_iter().map(Some);
    SurfaceAtlas {
        origins: known.chain(std::iter::repeat_n(None, added)).collect(),
        atlas,
        structure: Structure::Disk,
        report,
    }
}
