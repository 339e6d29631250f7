//! A surface with holes as a part of a closed one, so that both can be refined together.

use msplines_common::mesh::{NONE, SplitMesh, SurfacePoint, TriangleMesh, split_at};

use crate::bounded::puncture;
use crate::error::ConformalError;
use crate::homology::{Cocycle, Homology};
use crate::surface::with_cones;

/// A closed surface some of whose faces are holes.
pub(super) struct Holes {
    closed: TriangleMesh,
    homology: Homology,
    /// The hole that each face of the closed surface lies in; `NONE` outside.
    of_face: Vec<u32>,
    count: usize,
    input_vertices: usize,
}

/// The surface outside of the holes.
pub(super) struct Cut {
    pub(super) mesh: TriangleMesh,
    /// The boundary half-edges around each hole.
    pub(super) loops: Vec<Vec<u32>>,
    /// The integer forms of the handles.
    pub(super) handles: Vec<Cocycle>,
    /// The vertex of the closed surface that each vertex is.
    vertices: Vec<u32>,
    /// The face of the closed surface that each face is.
    faces: Vec<u32>,
}

impl Holes {
    /// Returns a surface whose holes are its boundary loops, in the order of its topology, and the stars
    /// of some vertices, in the order given.
    pub(super) fn of(mesh: &TriangleMesh, poles: &[u32]) -> Result<Self, ConformalError> {
        // Names what is wrong with the stars, if anything is.
        puncture(mesh, poles)?;
        let (closed, cones) = with_cones(mesh, None)?;
        let mut of_face = vec![NONE; closed.face_count()];
        let apexes = (0..cones as u32).map(|cone| mesh.vertex_count() as u32 + cone);
        for (hole, vertex) in (0u32..).zip(apexes.chain(poles.iter().copied())) {
            for half_edge in closed.topology().outgoing(vertex) {
                of_face[half_edge as usize / 3] = hole;
            }
        }
        Ok(Self {
            homology: Homology::build(closed.topology())?,
            closed,
            of_face,
            count: cones + poles.len(),
            input_vertices: mesh.vertex_count(),
        })
    }

    pub(super) fn count(&self) -> usize {
        self.count
    }

    pub(super) fn genus(&self) -> usize {
        self.homology.genus()
    }

    /// Returns the vertex of the input that each vertex of the cut surface is; nothing for added ones.
    pub(super) fn origins(&self, cut: &Cut) -> Vec<Option<u32>> {
        let known = |&v: &u32| ((v as usize) < self.input_vertices).then_some(v);
        cut.vertices.iter().map(known).collect()
    }

    /// Returns the surface outside of the holes, vertices and faces in their order.
    pub(super) fn cut(&self) -> Result<Cut, ConformalError> {
        let faces: Vec<u32> = (0..self.closed.face_count() as u32)
            .filter(|&f| self.of_face[f as usize] == NONE)
            .collect();
        let mut names = vec![NONE; self.closed.vertex_count()];
        let corners = faces.iter().flat_map(|&f| self.closed.faces()[f as usize]);
        corners.for_each(|v| names[v as usize] = v);
        let vertices: Vec<u32> = names.iter().copied().filter(|&v| v != NONE).collect();
        for (name, &vertex) in (0u32..).zip(&vertices) {
            names[vertex as usize] = name;
        }
        let positions = vertices
            .iter()
            .map(|&v| self.closed.positions()[v as usize]);
        let named = faces
            .iter()
            .map(|&f| self.closed.faces()[f as usize].map(|v| names[v as usize]));
        let mesh = TriangleMesh::build(positions.collect(), named.collect())?;
        let mut loops = vec![Vec::new(); self.count];
        for half_edges in mesh.topology().boundary_loops() {
            let first = half_edges[0];
            let outside = 3 * faces[first as usize / 3] + first % 3;
            let beyond = self.closed.topology().twin(outside) / 3;
            loops[self.of_face[beyond as usize] as usize] = half_edges;
        }
        let place = |&(half_edge, value): &(u32, i32)| {
            let face = faces.binary_search(&(half_edge / 3)).ok()? as u32;
            Some((3 * face + half_edge % 3, value))
        };
        let handles = self.homology.cocycles.iter();
        Ok(Cut {
            mesh,
            loops,
            handles: handles
                .map(|w| w.iter().filter_map(place).collect())
                .collect(),
            vertices,
            faces,
        })
    }

    /// Splits faces of the cut surface.
    pub(super) fn split(
        &mut self,
        cut: &Cut,
        points: &[SurfacePoint],
    ) -> Result<(), ConformalError> {
        let there = points.iter().map(|point| SurfacePoint {
            face: cut.faces[point.face as usize],
            at: point.at,
        });
        let split: SplitMesh = split_at(&self.closed, &there.collect::<Vec<_>>())?;
        self.homology = self.homology.on_split(self.closed.topology(), &split);
        let holes = split.parents.iter().map(|&p| self.of_face[p as usize]);
        self.of_face = holes.collect();
        self.closed = split.mesh;
        Ok(())
    }
}
