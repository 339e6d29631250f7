//! Why there is no surface, and what one should be read with.

use serde::{Deserialize, Serialize};

use crate::domain::DomainError;
use crate::error::{FitError, SplineError};
use crate::fit::Warning;

/// Why there is no spline over an atlas. Vertices and faces are those of the mesh of the whole surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceError {
    /// The holes leave nothing.
    #[error("the holes at the zeros leave no face of {faces}; refine the mesh")]
    NothingLeft {
        /// Faces of the whole mesh.
        faces: usize,
    },
    /// A hole touches the boundary, or itself.
    #[error(
        "without the faces at its zeros the surface falls apart at vertex {vertex}; refine the mesh there, so that holes lie away from boundaries and from each other"
    )]
    Pinched {
        /// The vertex.
        vertex: u32,
    },
    /// A prescribed gradient where there are no flat coordinates.
    #[error(
        "vertex {vertex} lies in a hole of the atlas, where no flat coordinates exist to prescribe a gradient in; give a position and a normal"
    )]
    GradientInHole {
        /// The vertex.
        vertex: u32,
    },
    /// A face outside of the holes is not laid out.
    #[error("the atlas is no domain outside of its holes: {0}")]
    Domain(DomainError),
    /// The fit failed.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// Stored numbers are no surface.
    #[error(transparent)]
    Spline(#[from] SplineError),
    /// Stored numbers of a hole do not fit its mesh.
    #[error("the stored hole {hole} does not fit the mesh: {reason}; write the file anew")]
    Stored {
        /// Which hole.
        hole: usize,
        /// What does not fit.
        reason: String,
    },
}

/// Why a hole has no smooth cap.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum NoSmoothCap {
    /// The faces around the hole are not enough, or close up around a handle.
    #[error("two rings of faces around it are no simple disk; refine the mesh there")]
    NoDisk,
    /// No chart around the zero without folds was found.
    #[error("every chart around it folds; refine the mesh there")]
    Folded,
    /// The chart bends so much along the rim that points leave the disk.
    #[error("its chart bends out of the disk; refine the mesh there")]
    Bent,
    /// The fit inside failed.
    #[error("the fit inside failed: {reason}")]
    Fit {
        /// What failed.
        reason: String,
    },
}

/// What a surface should be read with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum SurfaceWarning {
    /// What the fit away from the zeros said.
    #[error(transparent)]
    Regular(Warning),
    /// What the fit inside of a smooth cap said.
    #[error("in the cap around vertex {vertex}: {warning}")]
    Cap {
        /// First vertex of the zero.
        vertex: u32,
        /// What was said.
        warning: Warning,
    },
    /// A hole that could not be filled smoothly.
    #[error(
        "the hole around vertex {vertex} is filled by a minimal surface, which has an edge along its rim: {reason}"
    )]
    MinimalInstead {
        /// First vertex of the zero.
        vertex: u32,
        /// Why.
        reason: NoSmoothCap,
    },
    /// A hole whose faces are no disk, or whose rim has no length.
    #[error(
        "the hole around vertex {vertex} stays open, because no disk spans it; refine the mesh there"
    )]
    LeftOpen {
        /// First vertex of the zero.
        vertex: u32,
    },
    /// Faces over which the surface turns over.
    #[error(
        "the surface folds over {count} faces, first at vertices {first:?}; check the normals there, or refine the mesh",
        count = faces.len(),
        first = &vertices[..vertices.len().min(8)]
    )]
    Folded {
        /// The faces.
        faces: Vec<u32>,
        /// Their vertices, ascending.
        vertices: Vec<u32>,
    },
    /// A minimal surface that stopped early.
    #[error(
        "the minimal surface around vertex {vertex} was stopped before it settled, with the area {area:e}, because its cells began to fold or it went on shrinking"
    )]
    MinimalUnsettled {
        /// First vertex of the zero.
        vertex: u32,
        /// Its area.
        area: f64,
    },
}

impl FitError {
    /// Returns the error with vertices of another mesh.
    pub(super) fn renamed(self, vertices: &[u32]) -> Self {
        let at = |v: u32| vertices[v as usize];
        match self {
            Self::NotFinite { vertex } => Self::NotFinite { vertex: at(vertex) },
            Self::Normal { vertex } => Self::Normal { vertex: at(vertex) },
            Self::ComponentWithoutPosition { vertex } => {
                Self::ComponentWithoutPosition { vertex: at(vertex) }
            }
            Self::Factor { vertex, source } => Self::Factor {
                vertex: at(vertex),
                source,
            },
            other => other,
        }
    }
}

impl Warning {
    /// Returns the warning with vertices of another mesh.
    pub(super) fn renamed(self, names: &[u32]) -> Self {
        let all = |vertices: Vec<u32>| vertices.into_iter().map(|v| names[v as usize]).collect();
        match self {
            Self::OpposedNormals { vertices } => Self::OpposedNormals {
                vertices: all(vertices),
            },
            Self::InsideOut { vertices } => Self::InsideOut {
                vertices: all(vertices),
            },
            other @ Self::NearlySingular { .. } => other,
        }
    }
}

impl DomainError {
    /// Returns the error with vertices and faces of another mesh.
    pub(super) fn renamed(self, names: &[u32], face_names: &[u32]) -> Self {
        let (at, on) = (|v: u32| names[v as usize], |f: u32| face_names[f as usize]);
        match self {
            Self::PositionNotFinite { vertex } => Self::PositionNotFinite {
                vertex: at(vertex as u32) as usize,
            },
            Self::VectorNotFinite { face, side } => Self::VectorNotFinite {
                face: on(face),
                side,
            },
            Self::TwinsDiffer {
                from,
                to,
                faces,
                gap,
            } => Self::TwinsDiffer {
                from: at(from),
                to: at(to),
                faces: faces.map(on),
                gap,
            },
            Self::FaceOpen { face, gap } => Self::FaceOpen {
                face: on(face),
                gap,
            },
            Self::FaceNotPositive {
                face,
                vertices,
                area,
            } => Self::FaceNotPositive {
                face: on(face),
                vertices: vertices.map(at),
                area,
            },
            Self::ConePoint { vertex, turns } => Self::ConePoint {
                vertex: at(vertex),
                turns,
            },
            other => other,
        }
    }
}
