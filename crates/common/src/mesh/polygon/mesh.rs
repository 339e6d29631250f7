//! A polygon mesh: shared topology and positions.

use std::sync::Arc;

use nalgebra::{Point3, Vector3};

use super::topology::PolygonTopology;
use crate::mesh::defect::Defect;
use crate::mesh::preflight::preflight;
use crate::mesh::soup::PolygonSoup;
use crate::mesh::topology::TopologyError;
use crate::mesh::triangle::SurfacePoint;

/// How many defects an error lists.
const LISTED: usize = 5;

/// Why a soup is no control mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ControlMeshError {
    /// The soup has defects; control meshes are not repaired, since tags name their vertices.
    #[error("the control mesh is broken: {}; correct it where it was made", listed(.first, *.count))]
    Defects {
        /// The first defects.
        first: Vec<Defect>,
        /// How many there are.
        count: usize,
    },
    /// The faces do not form a surface.
    #[error("the control mesh is broken: {0}; correct it where it was made")]
    Topology(#[from] TopologyError),
    /// A face is not a quad.
    #[error(
        "face {face} of the control mesh has {corners} corners, and {others} others are not quads either; refine them into quads first"
    )]
    NotQuads {
        /// The first face that is no quad.
        face: u32,
        /// Its number of corners.
        corners: u32,
        /// How many others are not quads.
        others: usize,
    },
}

fn listed(first: &[Defect], count: usize) -> String {
    let places: Vec<String> = first.iter().map(Defect::to_string).collect();
    let more = match count - first.len() {
        0 => String::new(),
        more => format!("; and {more} more defects"),
    };
    places.join("; ") + &more
}

/// An oriented 2-manifold mesh of polygons, with or without boundary, of one or several components.
#[derive(Clone, Debug)]
pub struct PolygonMesh {
    topology: Arc<PolygonTopology>,
    positions: Vec<Point3<f64>>,
}

impl PolygonMesh {
    /// Builds a mesh; face `f` has the corners `corners[offsets[f]..offsets[f + 1]]`.
    ///
    /// # Errors
    /// The first way in which the faces are not an oriented manifold.
    ///
    /// # Panics
    /// If the offsets do not ascend from zero to the number of corners.
    pub fn build(
        positions: Vec<Point3<f64>>,
        corners: Vec<u32>,
        offsets: Vec<u32>,
    ) -> Result<Self, TopologyError> {
        let topology = Arc::new(PolygonTopology::build(positions.len(), corners, offsets)?);
        Ok(Self {
            topology,
            positions,
        })
    }

    /// Builds a mesh of quads.
    ///
    /// # Errors
    /// The first way in which the faces are not an oriented manifold.
    pub fn from_quads(
        positions: Vec<Point3<f64>>,
        faces: &[[u32; 4]],
    ) -> Result<Self, TopologyError> {
        let offsets = (0..=faces.len() as u32).map(|f| 4 * f).collect();
        Self::build(positions, faces.as_flattened().to_vec(), offsets)
    }

    /// Returns the mesh of a topology that is there already.
    ///
    /// # Panics
    /// If there is not one position per vertex.
    #[must_use]
    pub fn new(topology: Arc<PolygonTopology>, positions: Vec<Point3<f64>>) -> Self {
        assert_eq!(
            positions.len(),
            topology.vertex_count(),
            "one position per vertex"
        );
        Self {
            topology,
            positions,
        }
    }

    /// Returns the control mesh of a soup, with its vertex and face ids.
    ///
    /// Faces may be of any size, twisted or without area, and form several components: only what
    /// makes them no oriented manifold of finite points is refused.
    ///
    /// # Errors
    /// The defects of the soup.
    ///
    /// # Panics
    /// If the face offsets of the soup do not ascend within its corners.
    pub fn accept(soup: &PolygonSoup) -> Result<Self, ControlMeshError> {
        let mut defects = preflight(soup).defects;
        defects.retain(|defect| {
            !matches!(
                defect,
                Defect::ZeroArea { .. } | Defect::SeveralComponents { .. }
            )
        });
        if !defects.is_empty() {
            let count = defects.len();
            defects.truncate(LISTED);
            let first = defects;
            return Err(ControlMeshError::Defects { first, count });
        }
        let corners = soup.face_vertices.iter().map(|&v| v as u32).collect();
        let offsets = soup.face_offsets.iter().map(|&o| o as u32).collect();
        Ok(Self::build(soup.positions.clone(), corners, offsets)?)
    }

    /// Returns nothing if all faces are quads.
    ///
    /// # Errors
    /// The first face that is not.
    pub fn check_quads(&self) -> Result<(), ControlMeshError> {
        let topology = &self.topology;
        let odd = |face: &u32| topology.face_size(*face) != 4;
        let mut faces = (0..topology.face_count() as u32).filter(odd);
        match faces.next() {
            None => Ok(()),
            Some(face) => Err(ControlMeshError::NotQuads {
                face,
                corners: topology.face_size(face),
                others: faces.count(),
            }),
        }
    }

    /// Returns the mesh of the same connectivity with other positions.
    ///
    /// # Panics
    /// If there is not one position per vertex.
    #[must_use]
    pub fn with_positions(&self, positions: Vec<Point3<f64>>) -> Self {
        Self::new(Arc::clone(&self.topology), positions)
    }

    /// Returns the connectivity.
    #[must_use]
    pub fn topology(&self) -> &Arc<PolygonTopology> {
        &self.topology
    }

    /// Returns the position of every vertex.
    #[must_use]
    pub fn positions(&self) -> &[Point3<f64>] {
        &self.positions
    }

    /// Returns the number of vertices.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// Returns the number of faces.
    #[must_use]
    pub fn face_count(&self) -> usize {
        self.topology.face_count()
    }

    /// Returns the mean length of its edges.
    #[must_use]
    pub fn mean_edge_length(&self) -> f64 {
        let edges = self.topology.edge_count();
        let length = |edge: u32| {
            let [a, b] = self.topology.edge_vertices(edge);
            (self.positions[b as usize] - self.positions[a as usize]).norm()
        };
        (0..edges as u32).map(length).sum::<f64>() / edges as f64
    }

    /// Returns the smallest and largest corner of the axis-parallel bounding box.
    #[must_use]
    pub fn bounding_box(&self) -> [Point3<f64>; 2] {
        let far = [f64::INFINITY, f64::NEG_INFINITY].map(|x| Point3::from([x; 3]));
        self.positions
            .iter()
            .fold(far, |[low, high], p| [low.inf(p), high.sup(p)])
    }

    /// Returns the diagonal of the bounding box.
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        let [low, high] = self.bounding_box();
        (high - low).norm()
    }

    /// Returns the position of a point of a quad face, bilinear in its first two coordinates.
    ///
    /// # Panics
    /// If the face is no quad.
    #[must_use]
    pub fn position(&self, point: SurfacePoint) -> Point3<f64> {
        let [a, b, c, d] = self.topology.face_vertices(point.face) else {
            panic!("face {} is no quad", point.face)
        };
        let [s, t, _] = point.at;
        let p = |v: &u32| self.positions[*v as usize].coords;
        let low: Vector3<f64> = p(a) * (1.0 - s) + p(b) * s;
        let high: Vector3<f64> = p(d) * (1.0 - s) + p(c) * s;
        Point3::from(low * (1.0 - t) + high * t)
    }
}
