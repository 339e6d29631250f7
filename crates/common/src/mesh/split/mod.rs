//! Splitting of faces, so that given points of a surface become vertices. The surface stays.

mod spots;
mod triangulate;
mod weights;

#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use self::spots::{Spot, gather};
use self::triangulate::triangulate;
use self::weights::{ONE, Weights, double_area};
use super::topology::{Topology, TopologyError};
use super::triangle::{SurfacePoint, TriangleMesh};

/// Barycentric coordinates below this are zero, and points of a face whose coordinates differ by
/// less are one vertex. Points that come out of a computation (tracing, projection, intersection)
/// miss a side by 1e-16 times the aspect of the face and the number of steps; a face that is
/// thinner than this beside its neighbour would lose more digits than it shows detail.
const ON_SIDE: f64 = 1e-9;

/// Why a mesh cannot be split.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SplitError {
    /// A point lies on a face that does not exist.
    #[error(
        "point {point} lies on face {face}, but there are {faces} faces; give points of this mesh"
    )]
    FaceOutOfRange {
        /// Which of the points.
        point: usize,
        /// The face it names.
        face: u32,
        /// How many faces there are.
        faces: usize,
    },
    /// The barycentric coordinates of a point are negative, not finite, or do not sum to one.
    #[error(
        "point {point} has the barycentric coordinates {at:?}, which are not in face {face}; \
         give three numbers that are not negative and sum to one"
    )]
    Outside {
        /// Which of the points.
        point: usize,
        /// Its face.
        face: u32,
        /// Its coordinates.
        at: [f64; 3],
    },
    /// The split faces are no manifold: two faces share two sides, or there are too many.
    #[error(
        "the split faces are no manifold: {0}; remove one of two faces that share more than one \
         side, or give fewer points"
    )]
    Topology(#[from] TopologyError),
}

/// A mesh some points of which have become vertices, and how it lies on the mesh it came from.
#[derive(Clone, Debug)]
pub struct SplitMesh {
    /// The mesh. Vertices of the original one keep their ids, the new ones follow; faces stand in
    /// the order of the faces they lie in, and one that is not cut keeps its corners.
    pub mesh: TriangleMesh,
    /// Vertex of each given point.
    pub vertices: Vec<u32>,
    /// Face of the original mesh in which each face lies.
    pub parents: Vec<u32>,
    /// Place on the original mesh of each new vertex.
    pub places: Vec<SurfacePoint>,
    /// First face in each face of the original mesh.
    first_faces: Vec<u32>,
    /// Corners of the faces in each face that is cut.
    pieces: BTreeMap<u32, Vec<[Weights; 3]>>,
    /// New vertices on each edge that is cut, from its smaller end to the other.
    chains: BTreeMap<[u32; 2], Vec<u32>>,
}

impl SplitMesh {
    /// Returns the place on the split mesh of a point of the original one: on a border of faces,
    /// in one of them. Takes time linear in the number of points that the face was split at.
    ///
    /// Coordinates outside of the face are first made zero.
    ///
    /// # Panics
    /// If the face does not exist.
    #[must_use]
    pub fn locate(&self, point: SurfacePoint) -> SurfacePoint {
        let first = self.first_faces[point.face as usize];
        let Some(pieces) = self.pieces.get(&point.face) else {
            return SurfacePoint {
                face: first,
                at: point.at,
            };
        };
        let here = Weights::round(point.at);
        let against =
            |&[a, b, c]: &[Weights; 3]| [[here, b, c], [a, here, c], [a, b, here]].map(double_area);
        let (index, areas) = pieces
            .iter()
            .map(against)
            .enumerate()
            .find(|(_, areas)| areas.iter().all(|&area| area >= 0))
            .expect("the pieces cover the face exactly");
        let whole = areas.iter().sum::<i128>() as f64;
        SurfacePoint {
            face: first + index as u32,
            at: areas.map(|area| area as f64 / whole),
        }
    }

    /// Returns edges of the original mesh, as pairs of vertices, on the split one: each is replaced
    /// by its pieces in order, from its first vertex to its second. A pair that is not cut stays.
    #[must_use]
    pub fn edges(&self, edges: &[[u32; 2]]) -> Vec<[u32; 2]> {
        let mut pieces = Vec::with_capacity(edges.len());
        for &[from, to] in edges {
            let mut chain = vec![from];
            if let Some(inner) = self.chains.get(&[from.min(to), from.max(to)]) {
                chain.extend(inner);
                if from > to {
                    chain[1..].reverse();
                }
            }
            chain.push(to);
            pieces.extend(chain.windows(2).map(|pair| [pair[0], pair[1]]));
        }
        pieces
    }
}

/// Returns the mesh with its faces split so that each point is a vertex; the surface stays as it is.
///
/// A point at a vertex is that vertex, a point on an edge cuts the faces on both sides, and equal
/// points are one vertex; all three within 1e-9 in barycentric coordinates. Each face that is
/// cut becomes the constrained Delaunay triangulation of its points in the plane. The same points
/// in any order give the same mesh.
///
/// # Errors
/// A point that is not on the mesh, or two faces with more than one side in common, between whose
/// sides the new edges would run twice.
pub fn split_at(mesh: &TriangleMesh, points: &[SurfacePoint]) -> Result<SplitMesh, SplitError> {
    let topology = mesh.topology();
    let (new, vertices) = gather(topology, points)?;
    let place = |spot: &Spot| spot.place(topology);
    let places: Vec<SurfacePoint> = new.iter().filter_map(place).collect();
    let mut positions = mesh.positions().to_vec();
    positions.extend(places.iter().map(|&place| mesh.position(place)));
    let cuts = Cuts {
        topology,
        new: &new,
    };
    let mut faces = Vec::with_capacity(mesh.face_count() + 2 * new.len());
    let (mut parents, mut first_faces) = (Vec::with_capacity(faces.capacity()), Vec::new());
    let mut pieces = BTreeMap::new();
    for face in 0..mesh.face_count() as u32 {
        first_faces.push(faces.len() as u32);
        let (ids, weights, outline) = cuts.points(face);
        if ids.len() == 3 {
            faces.push(mesh.faces()[face as usize]);
        } else {
            let triangles = triangulate(&weights, outline, &mesh.triangle(face));
            faces.extend(triangles.iter().map(|t| t.map(|i| ids[i])));
            let corners = triangles.iter().map(|t| t.map(|i| weights[i]));
            pieces.insert(face, corners.collect());
        }
        parents.resize(faces.len(), face);
    }
    Ok(SplitMesh {
        mesh: TriangleMesh::build(positions, faces)?,
        vertices,
        parents,
        places,
        first_faces,
        pieces,
        chains: cuts.chains(),
    })
}

/// New vertices in order of edges, then of faces.
struct Cuts<'a> {
    topology: &'a Topology,
    new: &'a [Spot],
}

impl Cuts<'_> {
    /// Returns the ids and weights of the points of a face, and how many of them run around it.
    fn points(&self, face: u32) -> (Vec<u32>, Vec<Weights>, usize) {
        let (mut ids, mut weights) = (Vec::new(), Vec::new());
        for side in 0..3 {
            ids.push(self.topology.faces()[face as usize][side]);
            weights.push(Weights::corner(side));
            let half_edge = 3 * face + side as u32;
            let edge = self.topology.edge(half_edge);
            let first = ids.len();
            let forward = self.topology.edge_half_edge(edge) == half_edge;
            for (id, along) in self.on_edge(edge) {
                let along = if forward { along } else { ONE - along };
                ids.push(id);
                weights.push(Weights::on_side(side, along));
            }
            if !forward {
                ids[first..].reverse();
                weights[first..].reverse();
            }
        }
        let outline = ids.len();
        for (id, inside) in self.in_face(face) {
            ids.push(id);
            weights.push(inside);
        }
        (ids, weights, outline)
    }

    /// Returns the new vertices on an edge, each with its weight of the far end.
    fn on_edge(&self, edge: u32) -> impl Iterator<Item = (u32, i64)> {
        let first = Spot::Edge { edge, along: 0 };
        self.from(first).map_while(move |(id, spot)| match spot {
            Spot::Edge { edge: e, along } if e == edge => Some((id, along)),
            _ => None,
        })
    }

    /// Returns the new vertices inside of a face.
    fn in_face(&self, face: u32) -> impl Iterator<Item = (u32, Weights)> {
        let weights = Weights([0; 3]);
        self.from(Spot::Face { face, weights })
            .map_while(move |(id, spot)| match spot {
                Spot::Face { face: f, weights } if f == face => Some((id, weights)),
                _ => None,
            })
    }

    fn from(&self, first: Spot) -> impl Iterator<Item = (u32, Spot)> {
        let start = self.new.partition_point(|&spot| spot < first);
        let old = self.topology.vertex_count();
        (start..self.new.len()).map(move |i| ((old + i) as u32, self.new[i]))
    }

    fn chains(&self) -> BTreeMap<[u32; 2], Vec<u32>> {
        let mut chains = BTreeMap::new();
        let edge = |spot: &Spot| match *spot {
            Spot::Edge { edge, .. } => Some(edge),
            _ => None,
        };
        let mut edges: Vec<u32> = self.new.iter().filter_map(edge).collect();
        edges.dedup();
        for edge in edges {
            let [a, b] = self.topology.edge_vertices(edge);
            let mut chain: Vec<u32> = self.on_edge(edge).map(|(id, _)| id).collect();
            if a > b {
                chain.reverse();
            }
            chains.insert([a.min(b), a.max(b)], chain);
        }
        chains
    }
}
