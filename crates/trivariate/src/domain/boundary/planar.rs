//! Harmonic maps of patches to squares, and whether triangles fold there.

use msplines_common::linalg::SymmetricMatrix;
use msplines_common::mesh::TriangleMesh;
use msplines_common::mesh::tet::{Orientation, orientation};
use nalgebra::Point3;

use super::error::BoundaryError;
use super::options::PatchWeights;
use crate::domain::cube::{EDGES, corner_position, face_axes};
use crate::domain::dirichlet::{Dirichlet, DirichletError};

/// Smallest positive weight where all are made positive, against the cotangent of 45 degrees.
const SMALLEST_WEIGHT: f64 = 1e-2;

impl From<DirichletError> for BoundaryError {
    fn from(error: DirichletError) -> Self {
        match error {
            DirichletError::Ordering(error) => Self::Ordering(error),
            DirichletError::Factor(error) => Self::Factor(error),
        }
    }
}

/// Returns the cotangent of the angle opposite to each half-edge.
pub(super) fn cotangents(surface: &TriangleMesh) -> Result<Vec<f64>, BoundaryError> {
    let mut cotangents = Vec::with_capacity(3 * surface.face_count());
    for face in 0..surface.face_count() as u32 {
        let corners = surface.triangle(face);
        let area = surface.face_normal(face).norm();
        for side in 0..3 {
            let top = corners[(side + 2) % 3];
            let cotangent = (corners[side] - top).dot(&(corners[(side + 1) % 3] - top)) / area;
            if !cotangent.is_finite() {
                let vertices = surface.faces()[face as usize];
                return Err(BoundaryError::FlatFace { face, vertices });
            }
            cotangents.push(cotangent);
        }
    }
    Ok(cotangents)
}

/// Places the paths on the edges of the cube by arc length.
pub(super) fn place_paths(
    surface: &TriangleMesh,
    paths: &[Vec<u32>; 12],
    parameters: &mut [[f64; 3]],
) {
    for (edge, path) in paths.iter().enumerate() {
        let [a, b] = EDGES[edge].map(|corner| corner_position(corner.into()));
        let axis = edge / 4;
        let step = |ends: &[u32]| {
            let [p, q] = [ends[0], ends[1]].map(|v| surface.positions()[v as usize]);
            (q - p).norm()
        };
        let total: f64 = path.windows(2).map(step).sum();
        let mut length = 0.0;
        for ends in path.windows(2) {
            parameters[ends[0] as usize] = a;
            parameters[ends[0] as usize][axis] = length / total;
            length += step(ends);
        }
        parameters[path[path.len() - 1] as usize] = b;
    }
}

/// Places the vertices inside of the patches, those of paths being placed already. Returns the
/// patches that got positive weights.
///
/// All patches are solved at once: no edge joins the insides of two of them.
///
/// # Reference
/// [Pinkall1993]; [Floater1997]. Deviation: cotangents first, positive weights where those fold.
pub(super) fn place_patches(
    surface: &TriangleMesh,
    labels: &[u8],
    masks: &[u8],
    weights: PatchWeights,
    parameters: &mut [[f64; 3]],
) -> Result<u8, BoundaryError> {
    let cotangents = cotangents(surface)?;
    let given: Vec<bool> = masks.iter().map(|mask| mask.count_ones() > 1).collect();
    let mut convex: u8 = match weights {
        PatchWeights::Cotangent => 0,
        PatchWeights::Convex => 0b11_1111,
    };
    loop {
        let laplacian = laplacian(surface, &cotangents, labels, convex);
        Dirichlet::factor(&laplacian, &given)?.solve(&mut [&mut *parameters]);
        snap(masks, parameters);
        let folded = folded(surface, labels, parameters);
        let Some(&first) = folded.first() else {
            return Ok(convex);
        };
        let again = folded
            .iter()
            .fold(0, |mask, &face| mask | 1 << labels[face as usize]);
        if again & !convex == 0 {
            return Err(BoundaryError::Squeezed {
                count: folded.len(),
                vertices: surface.faces()[first as usize],
            });
        }
        convex |= again;
    }
}

/// Returns the Laplacian of half cotangents, positive in the patches of a mask.
fn laplacian(
    surface: &TriangleMesh,
    cotangents: &[f64],
    labels: &[u8],
    convex: u8,
) -> SymmetricMatrix {
    let topology = surface.topology();
    let mut entries = Vec::with_capacity(3 * topology.edge_count());
    for edge in 0..topology.edge_count() as u32 {
        let half_edge = topology.edge_half_edge(edge);
        let twin = topology.twin(half_edge);
        let mut weight = 0.5 * (cotangents[half_edge as usize] + cotangents[twin as usize]);
        if convex >> labels[(half_edge / 3) as usize] & 1 == 1 {
            weight = weight.max(SMALLEST_WEIGHT);
        }
        let [a, b] = topology.edge_vertices(edge);
        entries.extend([
            (a, a, weight),
            (b, b, weight),
            (a.max(b), a.min(b), -weight),
        ]);
    }
    SymmetricMatrix::from_lower_triplets(surface.vertex_count(), &entries)
}

/// Takes rounding away from the coordinates that the faces of the cube decide.
fn snap(masks: &[u8], parameters: &mut [[f64; 3]]) {
    for (mask, parameter) in masks.iter().zip(parameters) {
        for (axis, value) in parameter.iter_mut().enumerate() {
            match mask >> (2 * axis) & 3 {
                1 => *value = 0.0,
                2 => *value = 1.0,
                _ => {}
            }
        }
    }
}

/// Returns the triangles that are not positive in the face of their patch, decided exactly.
pub(super) fn folded(surface: &TriangleMesh, labels: &[u8], parameters: &[[f64; 3]]) -> Vec<u32> {
    let positive = |&face: &u32| {
        let corners = surface.faces()[face as usize].map(|v| parameters[v as usize]);
        !is_positive(labels[face as usize].into(), &corners)
    };
    (0..surface.face_count() as u32).filter(positive).collect()
}

/// Returns whether a triangle in the plane of a face of the cube is positive, decided exactly.
pub(crate) fn is_positive(face: usize, corners: &[[f64; 3]; 3]) -> bool {
    let [u, v] = face_axes(face);
    let flat = |p: &[f64; 3]| Point3::new(p[u], p[v], 0.0);
    let [a, b, c] = [0, 1, 2].map(|i| flat(&corners[i]));
    // Over the plane, a fourth corner decides nothing but on which side the triangle is seen.
    orientation(&[a, b, c, Point3::new(0.5, 0.5, 1.0)]) == Orientation::Positive
}
