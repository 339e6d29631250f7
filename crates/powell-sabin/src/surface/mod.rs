//! The manifold spline: a Powell-Sabin spline over an affine atlas, with its holes filled.
//!
//! A holomorphic form `dz` lays out all faces but those at its zeros. There [`fit()`](crate::fit())
//! finds the fairest spline `F_z`. A zero of order `m` is a regular point of the chart
//!
//! ```text
//! w = (z - z0)^(1 / (m + 1)),        for the double pole of a stereographic image w = 1 / (z - z0)
//! ```
//!
//! in which a second spline `F_w` spans the hole and the rings of faces around it. At their vertices it
//! has the value and the gradient of the first one, `F_w' = F_z' dz/dw`. With the Powell-Sabin function
//! `φ` that is 1 at the rim of the hole and 0 at all other vertices, both without slope, the surface is
//!
//! ```text
//! F = (1 - φ) F_z + φ F_w(w(z))      away from the hole, where φ is 0 except on one ring of faces
//! F = F_w                            inside of it
//! ```
//!
//! which is C1 everywhere, through all vertices, with all normals.
//!
//! # Reference
//! [He2005] §3.2, §3.3. Deviation: the paper fills holes by minimal surfaces, which are C0 at the rim
//! and pass through no vertex inside; these are [`Fill::Minimal`].

mod approximate;
mod cells;
mod chart;
mod error;
mod evaluate;
mod fit;
mod folds;
mod hole;
mod jet;
mod measure;
mod minimal;
mod options;
mod part;
mod parts;
mod smooth;
mod tessellate;

use msplines_common::mesh::{NONE, TriangleMesh};

pub use cells::SurfaceCells;
pub use chart::Reach;
pub use error::{NoSmoothCap, SurfaceError, SurfaceWarning};
pub use fit::{Filled, HoleReport, SurfaceFit, SurfaceReport, fit_surface};
pub use hole::{Cap, Hole};
pub use measure::SurfaceChecks;
pub use minimal::MinimalCap;
pub use options::{Fill, SurfaceOptions};
pub use parts::{CapParts, HoleParts, SurfaceParts};
pub use smooth::SmoothCap;

use crate::domain::FlatDomain;
use crate::spline::PowellSabinSpline;
use part::Part;

/// A C1 spline surface over a mesh with an affine atlas.
///
/// # Reference
/// [He2005] §3.2, §3.3.
#[derive(Clone, Debug)]
pub struct PowellSabinSurface {
    mesh: TriangleMesh,
    /// By half-edge of the mesh; those inside of holes belong to no flat domain.
    edge_vectors: Vec<[f64; 2]>,
    /// The spline away from the zeros.
    regular: PowellSabinSpline,
    /// Its faces and vertices.
    part: Part,
    /// Face of the regular part by face of the mesh, or none.
    places: Vec<u32>,
    holes: Vec<Hole>,
    /// The hole whose cap a face belongs to, or none.
    hole_of_face: Vec<u32>,
    /// The smoothly filled hole on whose rim a vertex lies, or none.
    rim_of_vertex: Vec<u32>,
}

impl PowellSabinSurface {
    /// Returns a surface of its parts.
    fn assemble(
        mesh: TriangleMesh,
        edge_vectors: Vec<[f64; 2]>,
        regular: PowellSabinSpline,
        part: Part,
        holes: Vec<Hole>,
    ) -> Self {
        let places = Part::places(&part.faces, mesh.face_count());
        let mut hole_of_face = vec![NONE; mesh.face_count()];
        let mut rim_of_vertex = vec![NONE; mesh.vertex_count()];
        for (number, hole) in holes.iter().enumerate() {
            for &face in hole.faces() {
                hole_of_face[face as usize] = number as u32;
            }
            if let Cap::Smooth(cap) = hole.cap() {
                for face in cap.covered_faces() {
                    hole_of_face[face as usize] = number as u32;
                }
                for vertex in cap.rim() {
                    rim_of_vertex[vertex as usize] = number as u32;
                }
            }
        }
        Self {
            mesh,
            edge_vectors,
            regular,
            part,
            places,
            holes,
            hole_of_face,
            rim_of_vertex,
        }
    }

    /// Returns the mesh of the whole surface, whose faces address its points.
    #[must_use]
    pub fn mesh(&self) -> &TriangleMesh {
        &self.mesh
    }

    /// Returns the form by half-edge of [`Self::mesh`].
    #[must_use]
    pub fn edge_vectors(&self) -> &[[f64; 2]] {
        &self.edge_vectors
    }

    /// Returns the spline away from the zeros.
    #[must_use]
    pub fn regular(&self) -> &PowellSabinSpline {
        &self.regular
    }

    /// Returns the face of [`Self::mesh`] that each face of the regular part is, ascending.
    #[must_use]
    pub fn regular_faces(&self) -> &[u32] {
        &self.part.faces
    }

    /// Returns the vertex of [`Self::mesh`] that each vertex of the regular part is, ascending.
    #[must_use]
    pub fn regular_vertices(&self) -> &[u32] {
        &self.part.vertices
    }

    /// Returns the face of the regular part that a face of [`Self::mesh`] is; nothing in holes.
    ///
    /// # Panics
    /// If there is no such face.
    #[must_use]
    pub fn regular_face(&self, face: u32) -> Option<u32> {
        Some(self.places[face as usize]).filter(|&place| place != NONE)
    }

    /// Returns the holes at the zeros and what fills them.
    #[must_use]
    pub fn caps(&self) -> &[Hole] {
        &self.holes
    }

    /// Returns the number of free real coefficients: nine per vertex of the spline and of what is
    /// inside of smooth caps, three per control point inside of minimal ones.
    #[must_use]
    pub fn dofs(&self) -> usize {
        let caps = self.holes.iter().map(|hole| match hole.cap() {
            Cap::Open => 0,
            Cap::Smooth(cap) => 9 * cap.inner_vertices(),
            Cap::Minimal(cap) => 3 * cap.free_points(),
        });
        self.regular.dofs() + caps.sum::<usize>()
    }

    /// Returns the control triangle of every vertex of the regular part, which is tangent to the
    /// surface there.
    ///
    /// # Reference
    /// [He2005] Eq. (5), Eq. (8).
    ///
    /// # Panics
    /// Never: this is a surface.
    #[must_use]
    pub fn control_triangles(&self) -> Vec<[msplines_common::Point3<f64>; 3]> {
        let triangles = self.regular.control_triangles();
        triangles.expect("a spline of three components")
    }

    /// Returns the flat domain of the regular part.
    #[must_use]
    pub fn flat_domain(&self) -> &FlatDomain {
        self.regular.flat_domain()
    }

    /// Returns the face of the regular part that a face is, unless a cap covers it.
    fn plain_face(&self, face: u32) -> Option<u32> {
        let free = self.hole_of_face[face as usize] == NONE;
        self.regular_face(face).filter(|_| free)
    }

    /// The filled holes on whose rims the corners of a regular face lie, each once.
    fn blends(&self, face: u32) -> impl Iterator<Item = u32> + '_ {
        let rims = self.mesh.faces()[face as usize].map(|v| self.rim_of_vertex[v as usize]);
        let first = move |&i: &usize| rims[i] != NONE && !rims[..i].contains(&rims[i]);
        (0..3).filter(first).map(move |i| rims[i])
    }
}
