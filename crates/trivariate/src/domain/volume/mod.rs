//! Maps of a solid to the unit cube, without folds.
//!
//! The boundary is mapped first ([`boundary`](crate::domain::boundary)); inside, each coordinate is harmonic.
//! Cells that every such map would make flat are split beforehand. Where cells are inverted all the
//! same, they are unfolded around where they are, boundary vertices sliding along their faces of
//! the cube; a last pass lowers the distortion and lets no fold appear.
//!
//! If all cells are positive and so are all triangles of the boundary in their faces, the map is
//! one-to-one.
//!
//! # Reference
//! [Kim2014] §4. Deviation: weights that reproduce linear functions, and no folds.

mod error;
mod fair;
mod foldover;
mod lanes;
mod laplacian;
mod lift;
mod measure;
mod options;
mod part;
mod presplit;
mod report;
mod search;
mod smooth;
#[cfg(test)]
mod tests;
mod unfold;

use std::ops::ControlFlow;

use msplines_common::mesh::NONE;
use msplines_common::mesh::tet::TetMesh;
use msplines_common::progress::{Observer, Outcome, Progress};

pub use error::VolumeError;
pub use laplacian::solid_laplacian;
pub use measure::{Quality, measure};
pub use options::{Corners, FoldOptions, Search, Smoothing, VolumeOptions, VolumeWeights};
pub use report::VolumeReport;
pub use search::Trial;

use crate::domain::boundary::{self, Border, BoundaryMap};
use crate::domain::dirichlet::Dirichlet;
use crate::domain::split::split_tets;
use fair::fair;
use lift::lift;
use presplit::presplit;
use smooth::smooth;
use unfold::unfold;

/// A map of a solid to the unit cube.
#[derive(Clone, Debug)]
pub struct CubeMap {
    /// The solid; cells may have been split. Its first vertices are those given, some of them moved along
    /// the surface for fair paths.
    pub mesh: TetMesh,
    /// The parameter of each vertex.
    pub parameters: Vec<[f64; 3]>,
    /// The vertex of each corner of the cube.
    pub corners: [u32; 8],
    /// The faces of the cube that each vertex lies on, as a mask; 0 inside.
    pub masks: Vec<u8>,
    /// The face of the cube of each boundary face, in the order of the boundary's faces.
    pub labels: Vec<u8>,
    /// How it came about.
    pub report: VolumeReport,
}

/// Returns a map of a solid to the unit cube.
///
/// Cost: a sparse Cholesky factorisation of the inner vertices, for found corners a second one, and
/// evaluations of an energy, each O(cells). The same input and options give the same bits on any
/// number of threads.
///
/// # Errors
/// The boundary is not one sphere; cells are inverted or flat; the boundary has no map; an option
/// means nothing; the observer asks to stop before there is a map.
pub fn map(
    mesh: &TetMesh,
    options: &VolumeOptions,
    observer: &mut Observer<'_>,
) -> Result<CubeMap, VolumeError> {
    map_scored(mesh, options, &mut Trial::default_score, observer)
}

/// As [`map`], with a score for the ways to lay corners and paths, such as the error of a coarse
/// spline; less is better, and one that is not finite is never taken.
///
/// # Errors
/// As [`map`].
pub fn map_scored(
    mesh: &TetMesh,
    options: &VolumeOptions,
    score: &mut dyn FnMut(&Trial) -> f64,
    observer: &mut Observer<'_>,
) -> Result<CubeMap, VolumeError> {
    options.check()?;
    check_solid(mesh)?;
    report_progress(observer, 0)?;
    let search = match &options.corners {
        Corners::Given(corners) => {
            let boundary = map_given(mesh, corners, options, observer)?;
            return finish(mesh, &boundary, None, options, observer);
        }
        Corners::Found(search) => search,
    };
    let trials = search::trials(mesh, search, options)?;
    report_progress(observer, 1)?;
    let count = trials.len();
    let mut scored: Vec<(f64, Trial)> = trials
        .into_iter()
        .map(|trial| (score(&trial), trial))
        .collect();
    scored.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best: Option<CubeMap> = None;
    for (_, trial) in scored.into_iter().take(search.tries as usize) {
        let known = Some(trial.parameters);
        let mut map = finish(mesh, &trial.boundary, known, options, observer)?;
        map.report.trials = count;
        map.report.frame = Some(trial.frame);
        map.report.avoid_concave = trial.avoid_concave;
        let flipped = map.report.quality.flipped;
        let unfolds = options.folds != FoldOptions::Counted;
        if best
            .as_ref()
            .is_none_or(|best| flipped < best.report.quality.flipped)
        {
            best = Some(map);
        }
        if flipped == 0 || !unfolds {
            break;
        }
    }
    best.ok_or(VolumeError::Stopped)
}

fn report_progress(observer: &mut Observer<'_>, step: u64) -> Result<(), VolumeError> {
    match observer(&Progress::new("domain", step, 4)) {
        ControlFlow::Break(()) => Err(VolumeError::Stopped),
        ControlFlow::Continue(()) => Ok(()),
    }
}

fn check_solid(mesh: &TetMesh) -> Result<(), VolumeError> {
    let finite = |p: &nalgebra::Point3<f64>| p.iter().all(|x| x.is_finite());
    if let Some(vertex) = mesh.positions().iter().position(|p| !finite(p)) {
        return Err(VolumeError::NotFinite {
            vertex: vertex as u32,
        });
    }
    mesh.require_sphere()?;
    let bad = mesh.not_positive();
    match bad.first() {
        None => Ok(()),
        Some(&first) => Err(VolumeError::NotPositive {
            count: bad.len(),
            first,
        }),
    }
}

fn map_given(
    mesh: &TetMesh,
    corners: &[u32; 8],
    options: &VolumeOptions,
    observer: &mut Observer<'_>,
) -> Result<BoundaryMap, VolumeError> {
    let mut local = [0; 8];
    for (corner, &vertex) in corners.iter().enumerate() {
        let inside = vertex as usize >= mesh.vertex_count()
            || mesh.topology().boundary_vertex(vertex) == NONE;
        if inside {
            return Err(VolumeError::CornerInside { corner, vertex });
        }
        local[corner] = mesh.topology().boundary_vertex(vertex);
    }
    Ok(boundary::map(
        &mesh.boundary(),
        &local,
        &options.boundary,
        observer,
    )?)
}

/// Returns for every vertex whether it is on the boundary.
fn on_boundary(mesh: &TetMesh) -> Vec<bool> {
    let vertices = 0..mesh.vertex_count() as u32;
    vertices
        .map(|vertex| mesh.topology().boundary_vertex(vertex) != NONE)
        .collect()
}

/// Maps the inside of a solid whose boundary is mapped; `known` is its harmonic map if no cells need
/// to be split.
fn finish(
    mesh: &TetMesh,
    boundary: &BoundaryMap,
    known: Option<Vec<[f64; 3]>>,
    options: &VolumeOptions,
    observer: &mut Observer<'_>,
) -> Result<CubeMap, VolumeError> {
    let mut map = spread(mesh, boundary, options)?;
    let known = known.filter(|_| options.fairing == 0);
    match known.filter(|known| known.len() == map.parameters.len()) {
        Some(known) => map.parameters = known,
        None => {
            let laplacian = solid_laplacian(&map.mesh, options.weights);
            let given = on_boundary(&map.mesh);
            Dirichlet::factor(&laplacian, &given)?.solve(&mut [&mut map.parameters]);
        }
    }
    map.report.harmonic = measure(&map.mesh, &map.parameters);
    report_progress(observer, 2)?;
    let stopped = unfolded(&mut map, options, observer);
    map.report.quality = measure(&map.mesh, &map.parameters);
    let smooths = options.smoothing != Smoothing::NONE && options.folds != FoldOptions::Counted;
    if smooths && map.report.unfolded.flipped == 0 && !stopped {
        map.report.smoothing_evaluations = smooth(
            &map.mesh,
            &map.masks,
            &mut map.parameters,
            &options.smoothing,
        )?;
        map.report.quality = measure(&map.mesh, &map.parameters);
    }
    map.report.folded = folded(&map);
    map.report.outcome = match (map.report.quality.flipped + map.report.folded, stopped) {
        (0, _) => Outcome::Converged,
        (_, true) => Outcome::Stopped,
        _ => Outcome::Stalled,
    };
    Ok(map)
}

/// Removes the folds of a map if that is asked for, and returns whether the observer broke it off.
fn unfolded(map: &mut CubeMap, options: &VolumeOptions, observer: &mut Observer<'_>) -> bool {
    map.report.unfolded = map.report.harmonic;
    let mut stopped = false;
    if let FoldOptions::Unfolded {
        rounds,
        evaluations,
        least,
    } = options.folds
    {
        let mut go_on = |round: u32, bad: usize| {
            let progress = Progress::new("domain", round.into(), rounds.into());
            stopped |= observer(&progress.with_objective(bad as f64)).is_break();
            !stopped
        };
        let limits = [rounds, evaluations];
        let done = unfold(
            &map.mesh,
            &map.masks,
            &mut map.parameters,
            least,
            limits,
            &mut go_on,
        );
        map.report.rounds = done.rounds;
        map.report.unfolding_evaluations = done.evaluations;
        map.report.unfolding_equivalent =
            done.cell_evaluations as f64 / map.mesh.cell_count() as f64;
        map.report.unfolded = measure(&map.mesh, &map.parameters);
        if map.report.unfolded.flipped == 0 {
            map.report.lifting_sweeps = lift(&map.mesh, &map.masks, &mut map.parameters);
        }
    }
    stopped
}

/// Takes the map of the boundary over to the solid, whose cells are split where it needs that.
fn spread(
    mesh: &TetMesh,
    boundary: &BoundaryMap,
    options: &VolumeOptions,
) -> Result<CubeMap, VolumeError> {
    let outside = mesh.topology().boundary_vertices();
    let added = mesh.vertex_count() as u32;
    let count = outside.len() as u32;
    // A vertex that the surface has got in a split is the next one of the solid.
    let global = |vertex: u32| {
        if vertex < count {
            outside[vertex as usize]
        } else {
            added + vertex - count
        }
    };
    let splits: Vec<Vec<u32>> = boundary
        .splits
        .iter()
        .map(|edge| edge.map(global).to_vec())
        .collect();
    let mut solid = if splits.is_empty() {
        mesh.clone()
    } else {
        split_tets(mesh, &splits)
    };
    let mut faired = None;
    if options.fairing > 0 && options.boundary.border != Border::Free {
        let paths = boundary.paths.clone();
        solid = fair(
            &solid,
            &paths.map(|path| path.into_iter().map(global).collect()),
            options.fairing,
        );
        let positions = (0..boundary.surface.vertex_count() as u32)
            .map(|vertex| solid.positions()[global(vertex) as usize])
            .collect();
        faired = Some(boundary.moved(positions, &options.boundary)?);
    }
    let boundary = faired.as_ref().unwrap_or(boundary);
    let mut masks = vec![0; solid.vertex_count()];
    for (&mask, vertex) in boundary.masks.iter().zip(0u32..) {
        masks[global(vertex) as usize] = mask;
    }
    let mut report = VolumeReport::of(&boundary.report, options);
    if options.boundary.border != Border::Free {
        let split = presplit(&solid, &mut masks);
        solid = split.mesh;
        report.split_edges = split.edges;
        report.split_faces = split.faces;
    }
    let mut parameters = vec![[0.5; 3]; solid.vertex_count()];
    for (&parameter, vertex) in boundary.parameters.iter().zip(0u32..) {
        parameters[global(vertex) as usize] = parameter;
    }
    let labels = labels(&solid, boundary, &global);
    let corners = boundary.corners.map(global);
    Ok(CubeMap {
        mesh: solid,
        parameters,
        corners,
        masks,
        labels,
        report,
    })
}

/// Returns the labels of the boundary's faces in the order of the solid.
fn labels(solid: &TetMesh, boundary: &BoundaryMap, global: &dyn Fn(u32) -> u32) -> Vec<u8> {
    let sorted = |mut face: [u32; 3]| {
        face.sort_unstable();
        face
    };
    let faces = boundary.surface.faces().iter().zip(&boundary.labels);
    let mut known: Vec<([u32; 3], u8)> = faces
        .map(|(face, &label)| (sorted(face.map(global)), label))
        .collect();
    known.sort_unstable();
    let topology = solid.topology();
    let faces = topology.boundary_faces().iter();
    faces
        .map(|&(cell, corner)| {
            let face = sorted(topology.face(cell, corner.into()));
            let at = known.binary_search_by_key(&face, |known| known.0);
            at.map_or(u8::MAX, |at| known[at].1)
        })
        .collect()
}

/// Returns how many triangles of the boundary are not positive in their face of the cube.
fn folded(map: &CubeMap) -> usize {
    let topology = map.mesh.topology();
    let faces = topology.boundary_faces().iter().zip(&map.labels);
    faces
        .filter(|&(&(cell, corner), &label)| {
            let face = topology.face(cell, corner.into());
            let corners = face.map(|vertex| map.parameters[vertex as usize]);
            !boundary::is_positive(label.into(), &corners)
        })
        .count()
}
