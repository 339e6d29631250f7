//! Where points lie with respect to vertices and edges, and which of them are one vertex.

use super::weights::{ONE, Weights};
use super::{ON_SIDE, SplitError};
use crate::mesh::topology::Topology;
use crate::mesh::triangle::SurfacePoint;

/// [`ON_SIDE`] in units of the weights.
const NEAR: i64 = (ON_SIDE * ONE as f64) as i64;

/// Where a point lies. In order, what may be one vertex stands together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Spot {
    /// At a vertex.
    Vertex(u32),
    /// On an edge, with this weight of the far end of [`Topology::edge_half_edge`].
    Edge { edge: u32, along: i64 },
    /// Inside of a face.
    Face { face: u32, weights: Weights },
}

impl Spot {
    /// Returns where a point lies.
    fn of(topology: &Topology, point: SurfacePoint) -> Self {
        let face = point.face;
        let weights = Weights::round(point.at.map(|x| if x < ON_SIDE { 0.0 } else { x }));
        let Weights(parts) = weights;
        if let Some(corner) = parts.iter().position(|&part| part == ONE) {
            return Self::Vertex(topology.faces()[face as usize][corner]);
        }
        let Some(opposite) = parts.iter().position(|&part| part == 0) else {
            return Self::Face { face, weights };
        };
        let side = (opposite + 1) % 3;
        let half_edge = 3 * face + side as u32;
        let edge = topology.edge(half_edge);
        let far = if topology.edge_half_edge(edge) == half_edge {
            (side + 1) % 3
        } else {
            side
        };
        Self::Edge {
            edge,
            along: parts[far],
        }
    }

    /// Returns the place of a spot that is no vertex.
    pub(super) fn place(self, topology: &Topology) -> Option<SurfacePoint> {
        match self {
            Self::Vertex(_) => None,
            Self::Edge { edge, along } => {
                let half_edge = topology.edge_half_edge(edge);
                let weights = Weights::on_side((half_edge % 3) as usize, along);
                Some(weights.on_face(half_edge / 3))
            }
            Self::Face { face, weights } => Some(weights.on_face(face)),
        }
    }

    /// Returns whether this and later spots in order may still be one vertex with `later`.
    fn is_in_reach(self, later: Self) -> bool {
        match (self, later) {
            (Self::Edge { edge, along }, Self::Edge { edge: e, along: a }) => {
                edge == e && a - along < NEAR
            }
            (
                Self::Face { face, weights },
                Self::Face {
                    face: f,
                    weights: w,
                },
            ) => face == f && w.0[0] - weights.0[0] < NEAR,
            _ => false,
        }
    }

    /// Returns whether two spots in reach of each other are one vertex.
    fn is_near(self, other: Self) -> bool {
        match (self, other) {
            (Self::Face { weights, .. }, Self::Face { weights: w, .. }) => {
                weights.is_within(NEAR, w)
            }
            _ => true,
        }
    }
}

/// Returns the new vertices in order, and the vertex of each point; new ones are numbered after
/// those of the mesh.
pub(super) fn gather(
    topology: &Topology,
    points: &[SurfacePoint],
) -> Result<(Vec<Spot>, Vec<u32>), SplitError> {
    for (index, point) in points.iter().enumerate() {
        check(topology, index, *point)?;
    }
    let spots: Vec<Spot> = points.iter().map(|&p| Spot::of(topology, p)).collect();
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by_key(|&index| spots[index]);
    let mut new: Vec<Spot> = Vec::new();
    let mut vertices = vec![0; points.len()];
    for index in order {
        let spot = spots[index];
        vertices[index] = if let Spot::Vertex(vertex) = spot {
            vertex
        } else {
            let mut around = (0..new.len())
                .rev()
                .take_while(|&i| new[i].is_in_reach(spot));
            let known = around.find(|&i| new[i].is_near(spot));
            let known = known.unwrap_or_else(|| {
                new.push(spot);
                new.len() - 1
            });
            (topology.vertex_count() + known) as u32
        };
    }
    Ok((new, vertices))
}

fn check(topology: &Topology, point: usize, at: SurfacePoint) -> Result<(), SplitError> {
    let SurfacePoint { face, at } = at;
    if face as usize >= topology.face_count() {
        return Err(SplitError::FaceOutOfRange {
            point,
            face,
            faces: topology.face_count(),
        });
    }
    let inside = at.iter().all(|&x| x >= -ON_SIDE);
    let sum: f64 = at.iter().sum();
    // NaN compares as neither.
    if inside && (sum - 1.0).abs() <= ON_SIDE {
        return Ok(());
    }
    Err(SplitError::Outside { point, face, at })
}
