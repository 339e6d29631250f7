//! What can be wrong with a soup of tetrahedra.

use crate::mesh::defect::{Remedy, listed};

/// One defect of a soup of tetrahedra, named by its place.
///
/// `Display` says what is wrong, [`Self::remedy`] who can mend it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TetDefect {
    /// There is no cell.
    #[error("there is no tetrahedron among {vertices} vertices")]
    NoCell {
        /// Number of vertices.
        vertices: usize,
    },
    /// A cell names a vertex that does not exist.
    #[error("tetrahedron {cell} names vertex {index}, but there are {vertices} vertices")]
    IndexOutOfRange {
        /// The cell.
        cell: u32,
        /// The index it holds.
        index: i64,
        /// Number of vertices.
        vertices: usize,
    },
    /// A cell names a vertex more than once.
    #[error("tetrahedron {cell} names vertex {vertex} more than once")]
    RepeatedVertex {
        /// The cell.
        cell: u32,
        /// The repeated vertex.
        vertex: u32,
    },
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is not finite: ({}, {}, {})", .position[0], .position[1], .position[2])]
    NotFinite {
        /// The vertex.
        vertex: u32,
        /// Its coordinates.
        position: [f64; 3],
    },
    /// The corners of a cell lie in one plane.
    #[error("tetrahedron {cell} is flat: its corners {corners:?} lie in one plane")]
    Flat {
        /// The cell.
        cell: u32,
        /// Its corners.
        corners: [u32; 4],
    },
    /// Some cells have their corners in the other order than most.
    #[error("{} tetrahedra are inverted: {}", .cells.len(), listed(.cells))]
    Inverted {
        /// The cells.
        cells: Vec<u32>,
    },
    /// Two neighbours lie on the same side of their common face.
    #[error("tetrahedra {} and {} lie on the same side of their face {face:?}: the mesh is folded", .cells[0], .cells[1])]
    Folded {
        /// Vertices of the face, ascending.
        face: [u32; 3],
        /// The two cells.
        cells: [u32; 2],
    },
    /// Two cells have the same vertices.
    #[error("tetrahedron {cell} has the same vertices as tetrahedron {of}")]
    DuplicateCell {
        /// The later cell.
        cell: u32,
        /// The earlier cell.
        of: u32,
    },
    /// More than two cells share a face.
    #[error("face {face:?} is shared by {} tetrahedra: {}", .cells.len(), listed(.cells))]
    NonManifoldFace {
        /// Vertices of the face, ascending.
        face: [u32; 3],
        /// Cells at the face.
        cells: Vec<u32>,
    },
    /// The boundary passes through an edge more than once.
    #[error("edge ({}, {}) has {faces} boundary faces instead of two", .edge[0], .edge[1])]
    NonManifoldEdge {
        /// End vertices, the smaller first.
        edge: [u32; 2],
        /// Number of boundary faces along it.
        faces: usize,
    },
    /// The solid, or the air around it, meets itself in a vertex only.
    #[error("the solid or its boundary is pinched at vertex {vertex}, where {parts} parts meet")]
    NonManifoldVertex {
        /// The vertex.
        vertex: u32,
        /// Parts of the solid or of its boundary, whichever are more.
        parts: usize,
    },
    /// No cell uses a vertex.
    #[error("vertex {vertex} belongs to no tetrahedron")]
    UnreferencedVertex {
        /// The vertex.
        vertex: u32,
    },
    /// The cells form more than one component.
    #[error("there are {} components, of {} tetrahedra", .cells.len(), listed(.cells))]
    SeveralComponents {
        /// Number of cells of each component, in order of the components' first cells.
        cells: Vec<u32>,
    },
}

impl TetDefect {
    /// Returns who can mend the defect.
    #[must_use]
    pub fn remedy(&self) -> Remedy {
        match self {
            Self::NoCell { .. }
            | Self::Flat { .. }
            | Self::Folded { .. }
            | Self::NonManifoldFace { .. }
            | Self::NonManifoldEdge { .. }
            | Self::NonManifoldVertex { .. } => Remedy::Author,
            _ => Remedy::Repair,
        }
    }

    /// Returns what to do about the defect, as an imperative sentence for the user.
    #[must_use]
    pub fn remedy_text(&self) -> &'static str {
        match self {
            Self::NoCell { .. } => "give a file that has tetrahedra",
            Self::IndexOutOfRange { .. } | Self::RepeatedVertex { .. } => {
                "drop the tetrahedron with --repair"
            }
            Self::NotFinite { .. } => "drop the vertex and its tetrahedra with --repair",
            Self::Flat { .. } => "mesh the solid again, or give its surface alone",
            Self::Inverted { .. } => "put their corners in order with --repair",
            Self::Folded { .. } | Self::NonManifoldFace { .. } => {
                "mesh the solid again without overlaps, or give its surface alone"
            }
            Self::DuplicateCell { .. } => "drop the duplicate with --repair",
            Self::NonManifoldEdge { .. } | Self::NonManifoldVertex { .. } => {
                "thicken the solid there, or cut it apart"
            }
            Self::UnreferencedVertex { .. } => "drop the vertex with --repair",
            Self::SeveralComponents { .. } => "keep the largest component with --repair",
        }
    }
}
