//! The cotangent Laplacian and the mixed Voronoi areas.
//!
//! # Notation
//! `L` is positive semidefinite: `L_ij = -(cot α + cot β) / 2` for the angles opposite to edge ij, and
//! rows sum to zero. `A` is the diagonal of vertex areas.
//!
//! Boundaries have natural (Neumann) conditions: an edge with one face has one cotangent.

use crate::linalg::SymmetricMatrix;
use crate::mesh::TriangleMesh;

/// The Laplacian and the vertex areas of a triangulation.
#[derive(Clone, Debug)]
pub struct Operators {
    /// The integrated cotangent Laplacian `L`, positive semidefinite with zero row sums.
    pub laplacian: SymmetricMatrix,
    /// The mixed Voronoi area of each vertex, the diagonal of `A`.
    pub mass: Vec<f64>,
}

impl Operators {
    /// Returns the integrated bi-Laplacian `L A⁻¹ L`.
    #[must_use]
    pub fn bilaplacian(&self) -> SymmetricMatrix {
        let inverse: Vec<f64> = self.mass.iter().map(|area| 1.0 / area).collect();
        self.laplacian.congruence(&inverse)
    }
}

/// Assembles the operators of a mesh from its positions.
///
/// # Reference
/// [Meyer2003] §3.3, §3.5.
#[must_use]
pub fn mesh_operators(mesh: &TriangleMesh) -> Operators {
    let lengths: Vec<[f64; 3]> = (0..mesh.face_count() as u32)
        .map(|face| {
            let [a, b, c] = mesh.triangle(face);
            [(b - a).norm(), (c - b).norm(), (a - c).norm()]
        })
        .collect();
    assemble(mesh.vertex_count(), mesh.faces(), &lengths)
}

/// Assembles the operators of a triangulation from its edge lengths alone.
///
/// `lengths[f][i]` is the length of the edge of face `f` from corner `i` to corner `i + 1`. An edge
/// may join a vertex to itself, as in intrinsic triangulations; it then adds nothing to `L`.
///
/// # Reference
/// [Meyer2003] §3.3, §3.5.
///
/// # Panics
/// If there is not one triple of lengths per face.
#[must_use]
pub fn assemble(vertex_count: usize, faces: &[[u32; 3]], lengths: &[[f64; 3]]) -> Operators {
    assert_eq!(faces.len(), lengths.len(), "lengths of every face");
    let mut mass = vec![0.0; vertex_count];
    let mut entries: Vec<(u32, u32, f64)> = Vec::with_capacity(9 * faces.len());
    entries.extend((0..vertex_count as u32).map(|v| (v, v, 0.0)));
    for (corners, sides) in faces.iter().zip(lengths) {
        let area = triangle_area(*sides);
        let cotangents = corner_cotangents(*sides, area);
        for i in 0..3 {
            // Corner i + 2 lies opposite to the edge from corner i to corner i + 1.
            let weight = 0.5 * cotangents[(i + 2) % 3];
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            if a != b {
                entries.extend([
                    (a, a, weight),
                    (b, b, weight),
                    (a.max(b), a.min(b), -weight),
                ]);
            }
            mass[a as usize] += mixed_area(*sides, area, cotangents, i);
        }
    }
    Operators {
        laplacian: SymmetricMatrix::from_lower_triplets(vertex_count, &entries),
        mass,
    }
}

/// Returns the area of a triangle with these sides by Kahan's form of Heron's formula, which is stable
/// for needles.
#[must_use]
pub fn triangle_area(sides: [f64; 3]) -> f64 {
    let mut sorted = sides;
    sorted.sort_by(f64::total_cmp);
    let [c, b, a] = sorted;
    let product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
    0.25 * product.max(0.0).sqrt()
}

/// Returns, for each side of a triangle with these lengths, half the cotangent of the angle opposite
/// to it: its part of the weight of that edge. Side `i` runs from corner `i` to corner `i + 1`.
#[must_use]
pub fn half_cotangents(sides: [f64; 3]) -> [f64; 3] {
    let cotangents = corner_cotangents(sides, triangle_area(sides));
    std::array::from_fn(|i| 0.5 * cotangents[(i + 2) % 3])
}

/// Returns the cotangent of the angle at each corner.
fn corner_cotangents(sides: [f64; 3], area: f64) -> [f64; 3] {
    std::array::from_fn(|i| {
        let (before, after, opposite) = (sides[(i + 2) % 3], sides[i], sides[(i + 1) % 3]);
        (before * before + after * after - opposite * opposite) / (4.0 * area)
    })
}

/// Returns the part of the area that belongs to corner `i`: its Voronoi region in an acute triangle,
/// half the area at an obtuse corner, a quarter beside one.
fn mixed_area(sides: [f64; 3], area: f64, cotangents: [f64; 3], i: usize) -> f64 {
    let (next, previous) = ((i + 1) % 3, (i + 2) % 3);
    if cotangents[i] < 0.0 {
        area / 2.0
    } else if cotangents[next] < 0.0 || cotangents[previous] < 0.0 {
        area / 4.0
    } else {
        let (after, before) = (sides[i], sides[previous]);
        (after * after * cotangents[previous] + before * before * cotangents[next]) / 8.0
    }
}
