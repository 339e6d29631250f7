//! Domains of Powell-Sabin splines: triangle meshes with a flat vector along every edge.
//!
//! Charts are glued by translations, so that a vector along every half-edge says all: those of twins
//! are opposite, those around a face sum to zero. Nothing here needs the domain to lie in the plane
//! as a whole; a torus does not.

mod delaunay;
mod error;
mod planar;
mod refine;
mod split;

use msplines_common::Point3;
use msplines_common::mesh::{NONE, Topology, TriangleMesh};

pub use error::DomainError;

use crate::element::MacroTriangle;
use crate::vector::{add, cross, dot, norm, scale};

/// How far vectors that must agree may differ, relative to their length: a 1-form that is closed to
/// rounding stays far below, a wrong one far above.
const CLOSURE: f64 = 1e-9;

/// Smallest flat area that counts as positive, relative to the product of two sides: a few times the
/// rounding error of their cross product.
const POSITIVE: f64 = 1e-14;

/// Squares of coordinates and vectors must neither overflow nor lose digits to underflow.
const MAGNITUDES: std::ops::Range<f64> = 1e-140..1e140;

/// A triangle mesh with a flat structure: the domain of a Powell-Sabin spline.
///
/// # Reference
/// [He2005] §3.2, §3.3.
#[derive(Clone, Debug)]
pub struct FlatDomain {
    mesh: TriangleMesh,
    /// By half-edge `3 f + i`: from corner `i` to corner `i + 1` of face `f`.
    edge_vectors: Vec<[f64; 2]>,
    /// By half-edge: where the point of the split stands, as a share of the way to its head.
    splits: Vec<f64>,
}

impl FlatDomain {
    /// Returns the domain of a mesh and the flat vector `edge_vectors[3 f + i]` from corner `i` to
    /// corner `i + 1` of every face `f`, in any unit of length.
    ///
    /// Positions of the mesh are used for the frames of faces only. The cost is O(n).
    ///
    /// # Reference
    /// [He2005] §3.3.
    ///
    /// # Errors
    /// Vectors that do not fit together, a face that is not positively oriented, or an inner vertex
    /// whose angles do not sum to one full turn.
    pub fn build(mesh: TriangleMesh, mut edge_vectors: Vec<[f64; 2]>) -> Result<Self, DomainError> {
        check_numbers(&mesh, &edge_vectors)?;
        close_twins(mesh.topology(), &mut edge_vectors)?;
        check_faces(mesh.faces(), &edge_vectors)?;
        check_cones(mesh.topology(), &edge_vectors)?;
        let splits = split::splits(mesh.topology(), &edge_vectors);
        Ok(Self {
            mesh,
            edge_vectors,
            splits,
        })
    }

    /// Returns the mesh.
    #[must_use]
    pub fn mesh(&self) -> &TriangleMesh {
        &self.mesh
    }

    /// Returns the connectivity.
    #[must_use]
    pub fn topology(&self) -> &Topology {
        self.mesh.topology()
    }

    /// Returns the flat vector along every half-edge.
    #[must_use]
    pub fn edge_vectors(&self) -> &[[f64; 2]] {
        &self.edge_vectors
    }

    /// Returns where every edge is split, as a share of the way along each half-edge.
    #[must_use]
    pub fn edge_splits(&self) -> &[f64] {
        &self.splits
    }

    /// Returns a face with its split into six, in coordinates relative to its corners.
    ///
    /// # Panics
    /// If there is no such face.
    #[must_use]
    pub fn macro_triangle(&self, face: u32) -> MacroTriangle {
        let sides = [0, 1, 2].map(|i| 3 * face as usize + i);
        let edges = sides.map(|h| self.edge_vectors[h]);
        MacroTriangle::new(edges, sides.map(|h| self.splits[h]))
    }

    /// Returns the flat area of a face.
    ///
    /// # Panics
    /// If there is no such face.
    #[must_use]
    pub fn flat_area(&self, face: u32) -> f64 {
        let h = 3 * face as usize;
        0.5 * cross(self.edge_vectors[h], self.edge_vectors[h + 1])
    }

    /// Returns the median flat length of all half-edges.
    #[must_use]
    pub fn median_edge_length(&self) -> f64 {
        median(self.edge_vectors.iter().map(|&e| norm(e)).collect())
    }

    /// Returns the mean flat length of the edges at a vertex.
    ///
    /// # Panics
    /// If there is no such vertex.
    #[must_use]
    pub fn mean_edge_length(&self, vertex: u32) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for h in self.topology().outgoing(vertex) {
            let previous = Topology::previous(h);
            sum += norm(self.edge_vectors[h as usize]);
            count += 1.0;
            if self.topology().twin(previous) == NONE {
                sum += norm(self.edge_vectors[previous as usize]);
                count += 1.0;
            }
        }
        sum / count
    }
}

/// Returns the median of positive numbers; of an even count the upper one.
pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

fn check_numbers(mesh: &TriangleMesh, vectors: &[[f64; 2]]) -> Result<(), DomainError> {
    let half_edges = 3 * mesh.face_count();
    if half_edges == 0 {
        return Err(DomainError::NoFaces);
    }
    let far = |p: &Point3<f64>| !p.iter().all(|c| c.abs() < MAGNITUDES.end);
    if let Some(vertex) = mesh.positions().iter().position(far) {
        return Err(DomainError::PositionNotFinite { vertex });
    }
    if vectors.len() != half_edges {
        return Err(DomainError::VectorCount {
            found: vectors.len(),
            half_edges,
        });
    }
    let bad = |&e: &[f64; 2]| !MAGNITUDES.contains(&norm(e));
    vectors.iter().position(bad).map_or(Ok(()), |h| {
        Err(DomainError::VectorNotFinite {
            face: (h / 3) as u32,
            side: (h % 3) as u32,
        })
    })
}

/// Checks that vectors of twins are opposite, and makes them so to the last bit.
fn close_twins(topology: &Topology, vectors: &mut [[f64; 2]]) -> Result<(), DomainError> {
    for edge in 0..topology.edge_count() as u32 {
        let h = topology.edge_half_edge(edge);
        let twin = topology.twin(h);
        if twin == NONE {
            continue;
        }
        let (own, other) = (vectors[h as usize], vectors[twin as usize]);
        let gap = norm(add(own, other)) / norm(own);
        if gap > CLOSURE {
            return Err(DomainError::TwinsDiffer {
                from: topology.origin(h),
                to: topology.target(h),
                faces: [h / 3, twin / 3],
                gap,
            });
        }
        vectors[twin as usize] = scale(-1.0, own);
    }
    Ok(())
}

fn check_faces(faces: &[[u32; 3]], vectors: &[[f64; 2]]) -> Result<(), DomainError> {
    for (face, (&vertices, e)) in faces.iter().zip(vectors.chunks_exact(3)).enumerate() {
        let face = face as u32;
        let longest = e.iter().fold(0.0_f64, |max, &e| max.max(norm(e)));
        let gap = norm(add(add(e[0], e[1]), e[2])) / longest;
        if gap > CLOSURE {
            return Err(DomainError::FaceOpen { face, gap });
        }
        let positive = (0..3).all(|i| {
            let (a, b) = (e[i], e[(i + 1) % 3]);
            cross(a, b) > POSITIVE * norm(a) * norm(b)
        });
        if !positive {
            let area = 0.5 * cross(e[0], e[1]);
            return Err(DomainError::FaceNotPositive {
                face,
                vertices,
                area,
            });
        }
    }
    Ok(())
}

/// Checks that the angles around inner vertices sum to one full turn.
///
/// Faces that are positive and glued by translations make a whole number of turns, so that the
/// check needs no tolerance.
fn check_cones(topology: &Topology, vectors: &[[f64; 2]]) -> Result<(), DomainError> {
    let angle = |h: u32| {
        let (out, back) = (
            vectors[h as usize],
            scale(-1.0, vectors[Topology::previous(h) as usize]),
        );
        cross(out, back).atan2(dot(out, back))
    };
    for vertex in (0..topology.vertex_count() as u32).filter(|&v| !topology.is_boundary_vertex(v)) {
        let turns = topology.outgoing(vertex).map(angle).sum::<f64>() / std::f64::consts::TAU;
        if turns > 1.5 {
            return Err(DomainError::ConePoint { vertex, turns });
        }
    }
    Ok(())
}
