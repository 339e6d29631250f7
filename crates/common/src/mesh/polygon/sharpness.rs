//! Where a Catmull-Clark surface is not smooth.

use super::topology::PolygonTopology;

/// A sharpness from which on edges and vertices stay sharp for ever, as files have it.
pub const INFINITELY_SHARP: f64 = 10.0;

/// The sharpness of an edge (between two vertices) or of a corner (the same vertex twice).
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CreaseTag {
    /// End vertices of the edge, or the corner twice.
    pub vertices: [u32; 2],
    /// Number of refinements for which it stays sharp; [`INFINITELY_SHARP`] and more for ever.
    pub sharpness: f64,
}

/// Why tags do not fit a mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SharpnessError {
    /// A tag names a vertex that does not exist.
    #[error("the tag names vertex {vertex}, but the mesh has {vertices} vertices, from 0")]
    NoSuchVertex {
        /// Index of the tag.
        tag: usize,
        /// The vertex.
        vertex: u32,
        /// How many there are.
        vertices: usize,
    },
    /// A tag names two vertices that no edge joins.
    #[error("no edge joins vertices {} and {}; tag edges of the control mesh", .ends[0], .ends[1])]
    NoSuchEdge {
        /// Index of the tag.
        tag: usize,
        /// The two vertices.
        ends: [u32; 2],
    },
    /// A sharpness is negative or no number.
    #[error("a sharpness of {sharpness} means nothing; give 0 or more, 10 and more for always")]
    NotASharpness {
        /// Index of the tag.
        tag: usize,
        /// The sharpness.
        sharpness: f64,
    },
}

impl SharpnessError {
    /// Returns the index of the tag at fault.
    #[must_use]
    pub fn tag(&self) -> usize {
        match self {
            Self::NoSuchVertex { tag, .. }
            | Self::NoSuchEdge { tag, .. }
            | Self::NotASharpness { tag, .. } => *tag,
        }
    }
}

/// How the sharpness of an edge falls with refinement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CreaseRule {
    /// By one each time.
    #[default]
    Uniform,
    /// By one, after averaging with the other semi-sharp edges at either end, three to one.
    Chaikin,
}

/// What happens where the boundary turns in a single face.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BoundaryCorners {
    /// The corner stays.
    #[default]
    Sharp,
    /// The boundary is rounded, as elsewhere.
    Smooth,
}

/// The variants of the scheme.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Rules {
    /// How sharpness falls.
    pub creases: CreaseRule,
    /// Whether corners of the boundary are sharp.
    pub corners: BoundaryCorners,
}

/// The sharpness of every edge and vertex; infinite where they stay sharp for ever.
///
/// Boundary edges are always infinitely sharp.
#[derive(Clone, Debug, PartialEq)]
pub struct Sharpness {
    pub(super) edges: Vec<f64>,
    pub(super) vertices: Vec<f64>,
}

impl Sharpness {
    /// Returns the sharpness of a mesh without tags: its boundary is sharp, all else smooth.
    #[must_use]
    pub fn smooth(topology: &PolygonTopology, rules: Rules) -> Self {
        let edge = |e: u32| {
            if topology.is_boundary_edge(e) {
                f64::INFINITY
            } else {
                0.0
            }
        };
        let corner = |v: u32| {
            let single = topology.is_boundary_vertex(v) && topology.outgoing(v).count() == 1;
            if single && rules.corners == BoundaryCorners::Sharp {
                f64::INFINITY
            } else {
                0.0
            }
        };
        Self {
            edges: (0..topology.edge_count() as u32).map(edge).collect(),
            vertices: (0..topology.vertex_count() as u32).map(corner).collect(),
        }
    }

    /// Returns the sharpness that tags say, on top of what the boundary has. Of several tags of an
    /// edge the last one counts.
    ///
    /// # Errors
    /// A tag that names no vertex or edge, or whose sharpness is negative or NaN.
    pub fn build(
        topology: &PolygonTopology,
        rules: Rules,
        tags: &[CreaseTag],
    ) -> Result<Self, SharpnessError> {
        let mut sharpness = Self::smooth(topology, rules);
        for (tag, crease) in tags.iter().enumerate() {
            if crease.sharpness.is_nan() || crease.sharpness < 0.0 {
                return Err(SharpnessError::NotASharpness {
                    tag,
                    sharpness: crease.sharpness,
                });
            }
            let ends = crease.vertices;
            let vertices = topology.vertex_count();
            if let Some(&vertex) = ends.iter().find(|&&v| v as usize >= vertices) {
                return Err(SharpnessError::NoSuchVertex {
                    tag,
                    vertex,
                    vertices,
                });
            }
            if ends[0] == ends[1] {
                sharpness.set_vertex(ends[0], crease.sharpness);
                continue;
            }
            match topology.edge_between(ends[0], ends[1]) {
                None => return Err(SharpnessError::NoSuchEdge { tag, ends }),
                Some(edge) if topology.is_boundary_edge(edge) => {}
                Some(edge) => sharpness.set_edge(edge, crease.sharpness),
            }
        }
        Ok(sharpness)
    }

    /// Sets the sharpness of an edge.
    pub fn set_edge(&mut self, edge: u32, sharpness: f64) {
        self.edges[edge as usize] = settled(sharpness);
    }

    /// Sets the sharpness of a vertex.
    pub fn set_vertex(&mut self, vertex: u32, sharpness: f64) {
        self.vertices[vertex as usize] = settled(sharpness);
    }

    /// Returns the sharpness of an edge.
    #[must_use]
    pub fn edge(&self, edge: u32) -> f64 {
        self.edges[edge as usize]
    }

    /// Returns the sharpness of a vertex.
    #[must_use]
    pub fn vertex(&self, vertex: u32) -> f64 {
        self.vertices[vertex as usize]
    }
}

fn settled(sharpness: f64) -> f64 {
    if sharpness >= INFINITELY_SHARP {
        f64::INFINITY
    } else {
        sharpness
    }
}
