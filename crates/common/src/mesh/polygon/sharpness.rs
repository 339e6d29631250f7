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
    /// By one, after averaging with the other semi-sharp edges at either end, three to one; edges that
    /// are sharp for ever do not count.
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
        sharpness.tag(topology, tags)?;
        Ok(sharpness)
    }

    /// Sets what tags say, all or, on an error, nothing. Boundary edges stay sharp, and so do corners of
    /// the boundary that the rules made sharp.
    ///
    /// # Errors
    /// A tag that names no vertex or edge, or whose sharpness is negative or NaN.
    pub fn tag(
        &mut self,
        topology: &PolygonTopology,
        tags: &[CreaseTag],
    ) -> Result<(), SharpnessError> {
        let places: Result<Vec<Option<u32>>, SharpnessError> = tags
            .iter()
            .enumerate()
            .map(|(index, tag)| tagged_edge(topology, index, tag))
            .collect();
        for (tag, edge) in tags.iter().zip(places?) {
            match edge {
                None if self.is_boundary_corner(topology, tag.vertices[0]) => {}
                None => self.set_vertex(tag.vertices[0], tag.sharpness),
                Some(edge) if topology.is_boundary_edge(edge) => {}
                Some(edge) => self.set_edge(edge, tag.sharpness),
            }
        }
        Ok(())
    }

    /// Returns whether a vertex is sharp for ever and has a single face.
    fn is_boundary_corner(&self, topology: &PolygonTopology, vertex: u32) -> bool {
        self.vertex(vertex).is_infinite()
            && topology.is_boundary_vertex(vertex)
            && topology.outgoing(vertex).count() == 1
    }

    /// Returns the sharpness of a patch of a mesh, whose vertices are these of the mesh. What has
    /// become a boundary is sharp.
    ///
    /// # Panics
    /// If an edge of the patch is none of the mesh.
    #[must_use]
    pub fn of_patch(
        &self,
        topology: &PolygonTopology,
        patch: &PolygonTopology,
        vertices: &[u32],
        rules: Rules,
    ) -> Self {
        let mut sharpness = Self::smooth(patch, rules);
        for edge in 0..patch.edge_count() as u32 {
            let [a, b] = patch.edge_vertices(edge).map(|v| vertices[v as usize]);
            let whole = topology.edge_between(a, b).expect("an edge of the mesh");
            let own = &mut sharpness.edges[edge as usize];
            *own = own.max(self.edge(whole));
        }
        for (own, &vertex) in sharpness.vertices.iter_mut().zip(vertices) {
            *own = own.max(self.vertex(vertex));
        }
        sharpness
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

/// Returns the edge that a tag names, or nothing for a corner.
fn tagged_edge(
    topology: &PolygonTopology,
    index: usize,
    tag: &CreaseTag,
) -> Result<Option<u32>, SharpnessError> {
    let sharpness = tag.sharpness;
    if sharpness.is_nan() || sharpness < 0.0 {
        let tag = index;
        return Err(SharpnessError::NotASharpness { tag, sharpness });
    }
    let ends = tag.vertices;
    let vertices = topology.vertex_count();
    if let Some(&vertex) = ends.iter().find(|&&v| v as usize >= vertices) {
        let tag = index;
        return Err(SharpnessError::NoSuchVertex {
            tag,
            vertex,
            vertices,
        });
    }
    if ends[0] == ends[1] {
        return Ok(None);
    }
    let edge = topology.edge_between(ends[0], ends[1]);
    let tag = index;
    edge.map(Some)
        .ok_or(SharpnessError::NoSuchEdge { tag, ends })
}

fn settled(sharpness: f64) -> f64 {
    if sharpness >= INFINITELY_SHARP {
        f64::INFINITY
    } else {
        sharpness
    }
}
