//! Editing: control vertices that move and edges that become sharp, answered within a frame.

use std::collections::BTreeSet;

use msplines_common::Point3;
use msplines_common::mesh::polygon::{CreaseTag, PolygonMesh, Rules, Sharpness, SharpnessError};
use msplines_common::progress::Observer;
use rayon::prelude::*;

use crate::domain::{Domain, sharp_charts};
use crate::error::FitError;
use crate::fit::frozen::Frozen;
use crate::fit::state::State;
use crate::fit::{Report, check, run};
use crate::observations::{LimitGrid, Observations};
use crate::options::{Gate, Options};
use crate::spline::SparseManifold;
use crate::tessellate::Tessellator;

/// Turns of every chart after an edit.
const SWEEPS: u32 = 1;

/// Steps with the atoms kept after them.
const STEPS: u32 = 10;

/// Faces around an edited edge whose limit can change: those of the vertices of the faces at its
/// ends. This many rings more make a patch whose own boundary is out of their reach.
const MARGIN: usize = 2;

/// A surface that is being edited.
///
/// It keeps matrices, stencils and functions, so that an edit costs what it touches: the charts of
/// which observations move.
#[derive(Clone, Debug)]
pub struct Session {
    mesh: PolygonMesh,
    sharpness: Sharpness,
    rules: Rules,
    options: Options,
    observations: Observations,
    /// Limit of every observation over the control vertices.
    rows: Vec<Vec<(u32, f64)>>,
    state: State,
    tessellator: Tessellator,
    report: Report,
}

/// What an edit has changed.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// Charts whose functions are new.
    pub charts: Vec<u32>,
    /// Faces whose surface is new.
    pub faces: Vec<u32>,
    /// Points of each of these faces, as [`Tessellator::face`] has them.
    pub points: Vec<Vec<[f64; 3]>>,
    /// Sum of squared distances of all observations.
    pub e_fit: f64,
}

/// Why an edit was refused; the surface stays what it was.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EditError {
    /// A vertex to move that does not exist.
    #[error("vertex {vertex} is to be moved, but there are {vertices} vertices, numbered from 0")]
    NoSuchVertex {
        /// The vertex.
        vertex: u32,
        /// How many there are.
        vertices: usize,
    },
    /// A position that is not finite.
    #[error("vertex {vertex} is to be moved to a position that is not finite")]
    NotFinite {
        /// The vertex.
        vertex: u32,
    },
    /// A tag that does not fit the mesh.
    #[error(transparent)]
    Sharpness(#[from] SharpnessError),
}

impl Session {
    /// Fits a surface and keeps all that editing needs; faces will be answered as grids of `cells` by
    /// `cells`.
    ///
    /// # Errors
    /// As [`fit`](crate::fit()).
    ///
    /// # Panics
    /// If `cells` is zero.
    pub fn start(
        mesh: &PolygonMesh,
        sharpness: &Sharpness,
        rules: Rules,
        options: &Options,
        cells: u32,
        observer: &mut Observer<'_>,
    ) -> Result<Self, FitError> {
        check(mesh, options)?;
        let grid = LimitGrid::build(mesh, sharpness, rules, options.levels);
        let observations = grid.observations(mesh.positions());
        if let Some(index) = observations.first_infinite() {
            return Err(FitError::NotFinite { index });
        }
        let domain = Domain::build(mesh.topology());
        let sharp = sharp_charts(mesh.topology(), sharpness);
        let mut state = State::start(mesh.topology(), domain, &sharp, &observations, options);
        let report = run(&mut state, &sharp, options, observer);
        state.renew_parts();
        let spline = state.spline(mesh, options);
        let rows = (0..grid.stencils.len()).map(|row| {
            let (indices, weights) = grid.stencils.row(row);
            indices
                .iter()
                .copied()
                .zip(weights.iter().copied())
                .collect()
        });
        Ok(Self {
            rows: rows.collect(),
            tessellator: Tessellator::build(&spline, cells),
            mesh: mesh.clone(),
            sharpness: sharpness.clone(),
            rules,
            options: options.clone(),
            observations,
            state,
            report,
        })
    }

    /// Returns the control mesh as it is now.
    #[must_use]
    pub fn mesh(&self) -> &PolygonMesh {
        &self.mesh
    }

    /// Returns the sharpness as it is now.
    #[must_use]
    pub fn sharpness(&self) -> &Sharpness {
        &self.sharpness
    }

    /// Returns how the first fit went.
    #[must_use]
    pub fn report(&self) -> &Report {
        &self.report
    }

    /// Returns the surface as it is now.
    #[must_use]
    pub fn spline(&self) -> SparseManifold {
        self.state.spline(&self.mesh, &self.options)
    }

    /// Returns the points that the surface is fitted to, as they are now.
    #[must_use]
    pub fn observed(&self) -> &[Point3<f64>] {
        &self.observations.points
    }

    /// Returns the points of a face as they are now.
    #[must_use]
    pub fn face(&self, face: u32) -> Vec<[f64; 3]> {
        let (topology, domain) = (self.mesh.topology(), &self.state.domain);
        let function = |chart: u32| &self.state.charts[chart as usize].function;
        self.tessellator.grid(topology, domain, function, face)
    }

    /// Moves control vertices.
    ///
    /// # Errors
    /// A vertex that does not exist, or a position that is not finite.
    pub fn move_vertices(&mut self, moves: &[(u32, Point3<f64>)]) -> Result<Change, EditError> {
        let vertices = self.mesh.vertex_count();
        for &(vertex, position) in moves {
            if vertex as usize >= vertices {
                return Err(EditError::NoSuchVertex { vertex, vertices });
            }
            if position.iter().any(|x| !x.is_finite()) {
                return Err(EditError::NotFinite { vertex });
            }
        }
        let mut positions = self.mesh.positions().to_vec();
        for &(vertex, position) in moves {
            positions[vertex as usize] = position;
        }
        self.mesh = self.mesh.with_positions(positions);
        let faces = self.rings(moves.iter().map(|m| m.0), 2);
        Ok(self.refit(&faces))
    }

    /// Changes the sharpness of edges and corners.
    ///
    /// # Errors
    /// A tag that names no vertex or edge, or whose sharpness is negative or NaN.
    pub fn sharpen(&mut self, tags: &[CreaseTag]) -> Result<Change, EditError> {
        self.sharpness.tag(self.mesh.topology(), tags)?;
        let ends: Vec<u32> = tags.iter().flat_map(|tag| tag.vertices).collect();
        let faces = self.rings(ends.iter().copied(), 2);
        self.renew_rows(&faces, &self.rings(ends.iter().copied(), 2 + MARGIN));
        let sharp = sharp_charts(self.mesh.topology(), &self.sharpness);
        for &vertex in &ends {
            let smooth = self.options.smooth_charts.contains(&vertex);
            let gated = self.options.gate == Gate::Sharp && !sharp[vertex as usize];
            self.state.charts[vertex as usize].may_crease = !gated && !smooth;
        }
        Ok(self.refit(&faces))
    }

    /// Returns the faces around vertices, then those around the vertices of these, and so on.
    fn rings(&self, vertices: impl Iterator<Item = u32>, rings: usize) -> BTreeSet<u32> {
        let topology = self.mesh.topology();
        let mut vertices: BTreeSet<u32> = vertices.collect();
        let mut faces = BTreeSet::new();
        for _ in 0..rings {
            let around = vertices.iter().flat_map(|&v| topology.outgoing(v));
            faces = around.map(|h| topology.face(h)).collect();
            let corners = faces.iter().flat_map(|&f| topology.face_vertices(f));
            vertices = corners.copied().collect();
        }
        faces
    }

    /// Computes the limits of the points of some faces anew, on a patch around them.
    fn renew_rows(&mut self, faces: &BTreeSet<u32>, patch: &BTreeSet<u32>) {
        let topology = self.mesh.topology();
        let corners = patch.iter().flat_map(|&f| topology.face_vertices(f));
        let vertices: Vec<u32> = corners
            .copied()
            .collect::<BTreeSet<u32>>()
            .into_iter()
            .collect();
        let local = |v: u32| vertices.binary_search(&v).map_or(0, |i| i as u32);
        let quads: Vec<[u32; 4]> = patch
            .iter()
            .map(|&f| {
                let corners = topology.face_vertices(f);
                [0, 1, 2, 3].map(|i| local(corners[i]))
            })
            .collect();
        let positions = vertices
            .iter()
            .map(|&v| self.mesh.positions()[v as usize])
            .collect();
        // A patch whose rings touch at a vertex only is no manifold: then all is computed.
        let Ok(mesh) = PolygonMesh::from_quads(positions, &quads) else {
            let grid =
                LimitGrid::build(&self.mesh, &self.sharpness, self.rules, self.options.levels);
            for (row, out) in self.rows.iter_mut().enumerate() {
                let (indices, weights) = grid.stencils.row(row);
                *out = indices
                    .iter()
                    .copied()
                    .zip(weights.iter().copied())
                    .collect();
            }
            return;
        };
        let sharpness = self
            .sharpness
            .of_patch(topology, mesh.topology(), &vertices, self.rules);
        let grid = LimitGrid::build(&mesh, &sharpness, self.rules, self.options.levels);
        let size = self.observations.side() * self.observations.side();
        for (index, face) in patch.iter().enumerate() {
            if !faces.contains(face) {
                continue;
            }
            let inner = &grid.grids[index * size..(index + 1) * size];
            for (&row, &o) in inner.iter().zip(self.observations.grid(*face)) {
                let (indices, weights) = grid.stencils.row(row as usize);
                let columns = indices.iter().map(|&i| vertices[i as usize]);
                self.rows[o as usize] = columns.zip(weights.iter().copied()).collect();
            }
        }
    }

    /// Moves the observations of some faces to where they belong; returns which ones moved.
    fn move_observations(&mut self, faces: &BTreeSet<u32>) -> Vec<bool> {
        let positions = self.mesh.positions();
        let mut moved = vec![false; self.observations.points.len()];
        let size = self.observations.side() * self.observations.side();
        for &face in faces {
            for place in face as usize * size..(face as usize + 1) * size {
                let o = self.observations.grids[place] as usize;
                let sum = self.rows[o]
                    .iter()
                    .fold(Point3::origin(), |sum, &(v, weight)| {
                        sum + positions[v as usize].coords * weight
                    });
                let point = &mut self.observations.points[o];
                if sum != *point {
                    let step = sum - *point;
                    (0..3).for_each(|i| self.state.residual[o][i] += step[i]);
                    *point = sum;
                    moved[o] = true;
                }
            }
        }
        moved
    }

    /// Moves the observations of some faces, and fits the charts anew that see them move.
    fn refit(&mut self, faces: &BTreeSet<u32>) -> Change {
        let moved = self.move_observations(faces);
        let topology = self.mesh.topology();
        let corners = faces.iter().flat_map(|&f| topology.face_vertices(f));
        let mut charts: BTreeSet<u32> = corners.copied().collect();
        charts.retain(|&chart| {
            let observations = &self.state.charts[chart as usize].observations;
            observations.iter().any(|&o| moved[o as usize])
        });
        let groups: Vec<Vec<u32>> = self
            .state
            .domain
            .colours()
            .iter()
            .map(|colour| {
                colour
                    .iter()
                    .copied()
                    .filter(|c| charts.contains(c))
                    .collect()
            })
            .filter(|group: &Vec<u32>| !group.is_empty())
            .collect();
        let all: Vec<u32> = charts.iter().copied().collect();
        // From what they were, charts that share a large move find back to each other slowly.
        self.state
            .start_charts(&all, topology, &self.observations, &self.options);
        for _ in 0..SWEEPS {
            self.state.select(&groups, &self.options);
        }
        let mut frozen = Frozen::factor(&self.state, all);
        for _ in 0..STEPS {
            frozen.sweep(&mut self.state);
        }
        for &chart in &charts {
            self.state.charts[chart as usize].renew_part();
        }
        let around = charts.iter().flat_map(|&c| topology.outgoing(c));
        let faces: BTreeSet<u32> = around.map(|h| topology.face(h)).collect();
        let faces: Vec<u32> = faces.into_iter().collect();
        Change {
            points: faces.par_iter().map(|&face| self.face(face)).collect(),
            charts: charts.into_iter().collect(),
            faces,
            e_fit: self.state.e_fit(),
        }
    }
}
