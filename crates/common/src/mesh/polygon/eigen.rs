//! Left eigenvectors of rings without a closed form: those of darts.

use nalgebra::{DMatrix, DVector};

use super::ring::Ring;

/// Steps of a power iteration; the ratio of the eigenvalues met is below 0.9 up to a valence of 60,
/// and its fifth power below 0.6.
const POWER_STEPS: usize = 512;

/// Returns the left eigenvector of eigenvalue one, with sum one: the limit of a subdivision matrix.
pub(super) fn left_fixed_vector(matrix: &DMatrix<f64>) -> Vec<f64> {
    let size = matrix.nrows();
    // The rows of (Mᵀ - I) w = 0 sum to zero, so that one of them makes room for 1ᵀ w = 1.
    let mut system = matrix.transpose() - DMatrix::identity(size, size);
    system.row_mut(0).fill(1.0);
    let mut right = DVector::zeros(size);
    right[0] = 1.0;
    let solved = system.lu().solve(&right);
    let vector = solved.expect("a subdivision matrix has one fixed vector");
    vector.iter().copied().collect()
}

/// Returns the tangents at a dart: along its sharp edge, and to the left of it.
///
/// The ring is symmetric about that edge. Of the left eigenvectors beyond the constant one, the
/// dominant symmetric and the dominant antisymmetric one are the tangents.
pub(super) fn dart_tangents(ring: &Ring) -> [Vec<f64>; 2] {
    let n = ring.edges.len();
    let sharp = ring.edges.iter().position(|&s| s > 0.0);
    let sharp = sharp.expect("a dart has a sharp edge");
    let mirror = |i: usize| match i {
        0 => 0,
        i if i <= n => 1 + (2 * sharp + n - (i - 1)) % n,
        // Face j lies between edges j and j + 1.
        i => 1 + n + (2 * sharp + 2 * n - (i - 1 - n) - 1) % n,
    };
    let turn = std::f64::consts::TAU / n as f64;
    let angle = |i: usize| match i {
        i if i <= n => turn * (i as f64 - 1.0 - sharp as f64),
        i => turn * ((i - n) as f64 - 0.5 - sharp as f64),
    };
    let matrix = ring.matrix(ring);
    let along = dominant(&matrix, mirror, 1.0, |i| {
        if i == 0 { 0.0 } else { angle(i).cos() }
    });
    let across = dominant(&matrix, mirror, -1.0, |i| {
        if i == 0 { 0.0 } else { angle(i).sin() }
    });
    [along, across]
}

/// Returns the tangent into a sector of two or more faces between two edges of a crease, over the
/// vertex, the edges and the opposite corners of the sector.
///
/// The masks of OpenSubdiv belong to edge rules of [Biermann2000], which depend on the sector; with
/// the plain rules they are eigenvectors for two faces only.
pub(super) fn sector_tangent(faces: usize) -> Vec<f64> {
    let mut edges = vec![0.0; faces + 1];
    edges[0] = f64::INFINITY;
    edges[faces] = f64::INFINITY;
    let ring = Ring {
        closed: false,
        far: vec![0.0; edges.len()],
        edges,
        vertex: 0.0,
    };
    let mirror = |i: usize| match i {
        0 => 0,
        i if i <= faces + 1 => faces + 2 - i,
        i => 3 * faces + 3 - i,
    };
    let theta = std::f64::consts::PI / faces as f64;
    let start = |i: usize| match i {
        0 => 0.0,
        i if i <= faces + 1 => (theta * (i - 1) as f64).sin(),
        i => (theta * ((i - faces - 2) as f64 + 0.5)).sin(),
    };
    dominant(&ring.matrix(&ring), mirror, 1.0, start)
}

/// Returns the dominant left eigenvector without sum among those that a reflection multiplies by
/// `sign`.
fn dominant(
    matrix: &DMatrix<f64>,
    mirror: impl Fn(usize) -> usize,
    sign: f64,
    start: impl Fn(usize) -> f64,
) -> Vec<f64> {
    let transposed = matrix.transpose();
    let mut vector = DVector::from_fn(matrix.nrows(), |i, _| start(i));
    for _ in 0..POWER_STEPS {
        // Rounding would bring back what dominates but has another symmetry or a sum.
        let next = &transposed * &vector;
        let mut folded =
            DVector::from_fn(next.len(), |i, _| 0.5 * (next[i] + sign * next[mirror(i)]));
        let mean = folded.sum() / folded.len() as f64;
        folded.add_scalar_mut(-mean);
        vector = &folded / folded.norm();
    }
    vector.iter().copied().collect()
}
