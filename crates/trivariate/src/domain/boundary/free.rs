//! One map of the surface that is harmonic across the borders of patches.
//!
//! # Notation
//! Every vertex has a face of the cube as its chart, and two coordinates in it, possibly outside of
//! the square. `T(f, l)` unfolds the plane of face `f` about the edge that it shares with face `l`
//! into the plane of `l`. A triangle compares its corners in the chart of its own patch, so that
//! around a corner of the cube the three charts close up.

use msplines_common::linalg::{Cholesky, Mat, Ordering, Symbolic, SymmetricMatrix};
use msplines_common::mesh::TriangleMesh;

use super::error::BoundaryError;
use super::planar::cotangents;
use crate::domain::cube::{corner_position, face_axes};

/// Most edges of the cube that a vertex walks over.
const WALK: usize = 8;

/// Where a coordinate of a chart comes from: `sign * coordinate[source] + shift`.
#[derive(Clone, Copy)]
struct Row {
    source: usize,
    sign: f64,
    shift: f64,
}

/// Returns `T(from, to)` between equal or adjacent faces, in space.
fn unfold(from: usize, to: usize, point: [f64; 3]) -> [f64; 3] {
    if from == to {
        return point;
    }
    let [plane_from, plane_to] = [from, to].map(|face| (face % 2) as f64);
    let inside = (plane_to - point[to / 2]) * (2.0 * plane_to - 1.0);
    let mut unfolded = point;
    unfolded[to / 2] = plane_to;
    unfolded[from / 2] = plane_from + (2.0 * plane_from - 1.0) * inside;
    unfolded
}

/// Returns `T(from, to)` by the two coordinates of each chart.
fn transition(from: usize, to: usize) -> [Row; 2] {
    let at = |coordinates: [f64; 2]| {
        let mut point = [(from % 2) as f64; 3];
        face_axes(from)
            .iter()
            .zip(coordinates)
            .for_each(|(&axis, x)| point[axis] = x);
        let unfolded = unfold(from, to, point);
        face_axes(to).map(|axis| unfolded[axis])
    };
    let [origin, first, second] = [at([0.0; 2]), at([1.0, 0.0]), at([0.0, 1.0])];
    [0, 1].map(|d| {
        let [along_first, along_second] = [first[d] - origin[d], second[d] - origin[d]];
        let source = usize::from(along_first == 0.0);
        Row {
            source,
            sign: along_first + along_second,
            shift: origin[d],
        }
    })
}

/// A map that is harmonic across patches.
pub(super) struct Free {
    /// Parameters on the surface of the cube.
    pub(super) parameters: Vec<[f64; 3]>,
    /// The face of the cube that every vertex has come to lie on.
    pub(super) charts: Vec<u8>,
    /// Triangles that are not positive, unfolded into the chart of their patch.
    pub(super) folded: usize,
}

/// Returns the map that is harmonic across the borders of patches, only the corners being fixed.
///
/// # Reference
/// [Kim2014] §4.1.
pub(super) fn solve(
    surface: &TriangleMesh,
    labels: &[u8],
    masks: &[u8],
    corners: &[u32; 8],
) -> Result<Free, BoundaryError> {
    let charts: Vec<u8> = masks
        .iter()
        .map(|mask| mask.trailing_zeros() as u8)
        .collect();
    let mut coordinates: Vec<[f64; 2]> = vec![[0.0; 2]; charts.len()];
    for (corner, &vertex) in corners.iter().enumerate() {
        let axes = face_axes(charts[vertex as usize].into());
        coordinates[vertex as usize] = axes.map(|axis| corner_position(corner)[axis]);
    }
    let (matrix, mut right) = assemble(surface, labels, &charts)?;
    let fixed = |row: usize| corners.contains(&((row / 2) as u32));
    for &corner in corners {
        for (d, &value) in coordinates[corner as usize].iter().enumerate() {
            let row = 2 * corner as usize + d;
            matrix
                .column(row)
                .for_each(|(other, entry)| right[(other, 0)] -= entry * value);
        }
    }
    let ordering = Ordering::nested_dissection(&matrix)?;
    let symbolic = Symbolic::analyze_kept(&matrix, &ordering, |row| !fixed(row));
    Cholesky::factor(symbolic, &matrix)?.solve_in_place(right.as_mut());
    for vertex in (0..charts.len()).filter(|&vertex| !fixed(2 * vertex)) {
        coordinates[vertex] = [0, 1].map(|d| right[(2 * vertex + d, 0)]);
    }
    let in_space = |vertex: usize| {
        let chart = usize::from(charts[vertex]);
        let mut point = [(chart % 2) as f64; 3];
        face_axes(chart)
            .iter()
            .zip(coordinates[vertex])
            .for_each(|(&axis, x)| point[axis] = x);
        point
    };
    let folded = surface
        .faces()
        .iter()
        .zip(labels)
        .filter(|&(face, &label)| {
            let corners = face.map(|vertex| {
                unfold(
                    charts[vertex as usize].into(),
                    label.into(),
                    in_space(vertex as usize),
                )
            });
            !super::planar::is_positive(label.into(), &corners)
        });
    let folded = folded.count();
    let walked = (0..charts.len()).map(|vertex| walk(charts[vertex].into(), in_space(vertex)));
    let (charts, parameters) = walked.unzip();
    Ok(Free {
        parameters,
        charts,
        folded,
    })
}

/// Returns the normal equations of all differences along edges of triangles.
fn assemble(
    surface: &TriangleMesh,
    labels: &[u8],
    charts: &[u8],
) -> Result<(SymmetricMatrix, Mat<f64>), BoundaryError> {
    let cotangents = cotangents(surface)?;
    let mut entries = Vec::with_capacity(8 * cotangents.len());
    let mut right = Mat::zeros(2 * charts.len(), 1);
    for (half_edge, weight) in cotangents.iter().enumerate() {
        let (face, side) = (half_edge / 3, half_edge % 3);
        let ends = [side, (side + 1) % 3].map(|k| surface.faces()[face][k] as usize);
        let rows = ends.map(|vertex| transition(charts[vertex].into(), labels[face].into()));
        for (a, b) in rows[0].into_iter().zip(rows[1]) {
            let [i, j] = [2 * ends[0] + a.source, 2 * ends[1] + b.source];
            let shift = a.shift - b.shift;
            entries.extend([(i as u32, i as u32, *weight), (j as u32, j as u32, *weight)]);
            entries.push((i.max(j) as u32, i.min(j) as u32, -weight * a.sign * b.sign));
            right[(i, 0)] -= weight * a.sign * shift;
            right[(j, 0)] += weight * b.sign * shift;
        }
    }
    Ok((
        SymmetricMatrix::from_lower_triplets(2 * charts.len(), &entries),
        right,
    ))
}

/// Moves a point outside of its face over the edge that it lies farthest behind, until it is on
/// the cube.
fn walk(mut face: usize, mut point: [f64; 3]) -> (u8, [f64; 3]) {
    for _ in 0..WALK {
        let outside = face_axes(face).map(|axis| {
            let x = point[axis];
            (
                if x > 1.0 { x - 1.0 } else { -x },
                2 * axis + usize::from(x > 1.0),
            )
        });
        let (distance, next) = if outside[0].0 > outside[1].0 {
            outside[0]
        } else {
            outside[1]
        };
        if distance <= 0.0 {
            break;
        }
        let axis = next / 2;
        let inwards = 1.0 - 2.0 * (face % 2) as f64;
        point[face / 2] = (face % 2) as f64 + inwards * distance;
        point[axis] = (next % 2) as f64;
        face = next;
    }
    (face as u8, point.map(|x| x.clamp(0.0, 1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unfolding_goes_back_and_keeps_the_common_edge() {
        for from in 0..6 {
            for to in (0..6).filter(|to| to / 2 != from / 2) {
                let mut point = [0.3, 0.4, 0.6];
                point[from / 2] = (from % 2) as f64;
                let there = unfold(from, to, point);
                assert_eq!(there[to / 2], (to % 2) as f64);
                let back = unfold(to, from, there);
                (0..3).for_each(|d| assert!((back[d] - point[d]).abs() < 1e-15));
                let mut edge = point;
                edge[to / 2] = (to % 2) as f64;
                assert_eq!(unfold(from, to, edge), edge);
                // What lies in one face is outside of the other, where walking brings it back.
                let (face, walked) = walk(to, there);
                assert_eq!(usize::from(face), from);
                (0..3).for_each(|d| assert!((walked[d] - point[d]).abs() < 1e-15));
            }
        }
    }
}
