//! What can be wrong with a polygon soup.

/// One defect of a polygon soup, named by its place.
///
/// `Display` says what is wrong, [`Self::remedy`] what to do about it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Defect {
    /// There is no face.
    #[error("there is no face among {vertices} vertices")]
    NoFace {
        /// Number of vertices.
        vertices: usize,
    },
    /// A face names a vertex that does not exist.
    #[error("face {face} names vertex {index}, but there are {vertices} vertices")]
    IndexOutOfRange {
        /// The face.
        face: u32,
        /// The index it holds.
        index: i64,
        /// Number of vertices.
        vertices: usize,
    },
    /// A face holds a negative vertex index.
    #[error("face {face} names the negative vertex index {index}")]
    NegativeIndex {
        /// The face.
        face: u32,
        /// The index it holds.
        index: i64,
    },
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is not finite: ({}, {}, {})", .position[0], .position[1], .position[2])]
    NotFinite {
        /// The vertex.
        vertex: u32,
        /// Its coordinates.
        position: [f64; 3],
    },
    /// A face has fewer than three corners.
    #[error("face {face} has {corners} corners; a face needs at least 3")]
    TooFewCorners {
        /// The face.
        face: u32,
        /// Its number of corners.
        corners: usize,
    },
    /// A face names a vertex more than once.
    #[error("face {face} names vertex {vertex} more than once")]
    RepeatedVertex {
        /// The face.
        face: u32,
        /// The repeated vertex.
        vertex: u32,
    },
    /// The corners of a face lie on a line.
    #[error(
        "face {face} has no area, or a triangle of it has none: corners lie on a line or coincide"
    )]
    ZeroArea {
        /// The face.
        face: u32,
    },
    /// Two faces have the same vertices.
    #[error("face {face} has the same vertices as face {of}")]
    DuplicateFace {
        /// The later face.
        face: u32,
        /// The earlier face.
        of: u32,
    },
    /// No face uses a vertex.
    #[error("vertex {vertex} belongs to no face")]
    UnreferencedVertex {
        /// The vertex.
        vertex: u32,
    },
    /// More than two faces share an edge.
    #[error("edge ({}, {}) is shared by {} faces: {}", .edge[0], .edge[1], .faces.len(), listed(.faces))]
    NonManifoldEdge {
        /// End vertices, the smaller first.
        edge: [u32; 2],
        /// Faces along the edge.
        faces: Vec<u32>,
    },
    /// Two faces run along their common edge in the same direction.
    #[error("faces {} and {} are oriented differently along edge ({}, {})", .faces[0], .faces[1], .edge[0], .edge[1])]
    InconsistentOrientation {
        /// End vertices, the smaller first.
        edge: [u32; 2],
        /// The two faces.
        faces: [u32; 2],
    },
    /// The surface has only one side.
    #[error("the surface has only one side: orientation comes back reversed across edge ({}, {}) between faces {} and {}", .edge[0], .edge[1], .faces[0], .faces[1])]
    NotOrientable {
        /// Edge at which a closed path of faces comes back mirrored, the smaller vertex first.
        edge: [u32; 2],
        /// The two faces.
        faces: [u32; 2],
    },
    /// The faces around a vertex form more than one fan.
    #[error("vertex {vertex} is a bow tie: its faces form {fans} separate fans")]
    BowTieVertex {
        /// The vertex.
        vertex: u32,
        /// Number of fans.
        fans: usize,
    },
    /// The faces form more than one component.
    #[error("there are {} components, of {} faces", .faces.len(), listed(.faces))]
    SeveralComponents {
        /// Number of faces of each component, in order of the components' first faces.
        faces: Vec<u32>,
    },
}

/// What can be done about a defect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Remedy {
    /// [`Policy::Repair`](super::Policy::Repair) mends it.
    Repair,
    /// Only whoever made the mesh can mend it.
    Author,
}

impl Defect {
    /// Returns who can mend the defect.
    #[must_use]
    pub fn remedy(&self) -> Remedy {
        match self {
            Self::NoFace { .. } | Self::NotOrientable { .. } => Remedy::Author,
            _ => Remedy::Repair,
        }
    }

    /// Returns what to do about the defect, as an imperative sentence for the user.
    #[must_use]
    pub fn remedy_text(&self) -> &'static str {
        match self {
            Self::NoFace { .. } => "give a file that has faces",
            Self::NotOrientable { .. } => "cut the surface open so that it has two sides",
            Self::IndexOutOfRange { .. }
            | Self::NegativeIndex { .. }
            | Self::TooFewCorners { .. } => "drop the face with --repair",
            Self::NotFinite { .. } => "drop the vertex and its faces with --repair",
            Self::RepeatedVertex { .. } => "drop the repetition with --repair",
            Self::ZeroArea { .. } => "remove the face with --repair",
            Self::DuplicateFace { .. } => "drop the duplicate with --repair",
            Self::UnreferencedVertex { .. } => "drop the vertex with --repair",
            Self::NonManifoldEdge { .. } => "cut the surface along the edge with --repair",
            Self::InconsistentOrientation { .. } => "orient the faces alike with --repair",
            Self::BowTieVertex { .. } => "split the vertex with --repair",
            Self::SeveralComponents { .. } => {
                "keep the largest component, after joining those whose edges coincide, with --repair"
            }
        }
    }
}

/// Numbers shown of a long list.
const SHOWN: usize = 8;

/// Returns the numbers separated by commas, and how many more there are beyond the first few.
pub(super) fn listed(numbers: &[u32]) -> String {
    let shown: Vec<String> = numbers.iter().take(SHOWN).map(u32::to_string).collect();
    let rest = numbers.len().saturating_sub(SHOWN);
    let more = if rest > 0 {
        format!(" and {rest} more")
    } else {
        String::new()
    };
    shown.join(", ") + &more
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_name_the_place() {
        let edge = Defect::NonManifoldEdge {
            edge: [12, 57],
            faces: vec![4, 9, 11],
        };
        assert_eq!(
            edge.to_string(),
            "edge (12, 57) is shared by 3 faces: 4, 9, 11"
        );
        assert!(edge.remedy_text().contains("--repair"));
        let many = Defect::SeveralComponents {
            faces: (1..=10).collect(),
        };
        assert_eq!(
            many.to_string(),
            "there are 10 components, of 1, 2, 3, 4, 5, 6, 7, 8 and 2 more faces"
        );
        let nan = Defect::NotFinite {
            vertex: 3,
            position: [0.0, f64::NAN, 1.0],
        };
        assert_eq!(
            nan.to_string(),
            "vertex 3 has a coordinate that is not finite: (0, NaN, 1)"
        );
    }

    #[test]
    fn only_what_repair_mends_names_the_option() {
        let moebius = Defect::NotOrientable {
            edge: [0, 1],
            faces: [2, 3],
        };
        for defect in [Defect::NoFace { vertices: 1 }, moebius] {
            assert_eq!(defect.remedy(), Remedy::Author);
            assert!(!defect.remedy_text().contains("--repair"));
        }
    }
}
