//! Vertices where the surface is inside out, and their repair.
//!
//! # Notation
//! At a vertex with unit normal `n` and tangents `t1, t2`, the derivatives are
//! `[F_u F_v] = [t1 t2] X`. The surface has the normal `n`, and not `-n`, if `det X > 0`, which no
//! linear system can ask for.

use msplines_common::Vector3;
use msplines_common::linalg::{Cholesky, Mat, Ordering, Symbolic, SymmetricMatrix};
use msplines_common::mesh::{NONE, Topology};

use super::data::{Unknowns, VertexCondition, tangents, unit};
use super::system::System;
use crate::domain::FlatDomain;
use crate::error::FitError;
use crate::vector::norm;

/// Rings around a vertex that are solved again: what is farther hardly moves.
const RINGS: usize = 3;

/// First weight of an anchor, relative to the vertex' own part of the energy, and its growth.
const WEIGHT: f64 = 0.25;
const GROWTH: f64 = 4.0;

/// After so many rounds the weight is 1e11: the anchors hold, or there is nothing to be done.
const ROUNDS: u32 = 20;

/// Determinant over half the squared norm below which a facet's `X` is no target: 1 is conformal.
const TARGET: f64 = 0.1;

/// `X` as the unknowns of a vertex hold it: `[t1 F_u, t1 F_v, t2 F_u, t2 F_v]`.
fn determinant(x: &[f64]) -> f64 {
    x[0] * x[3] - x[1] * x[2]
}

/// Returns the vertices with a given normal where `det X <= 0`.
pub(super) fn violations(data: &[VertexCondition], unknowns: &Unknowns, x: &[f64]) -> Vec<u32> {
    let given = |v: u32| matches!(data[v as usize], VertexCondition::Interpolate { .. });
    (0..data.len() as u32)
        .filter(|&v| given(v) && determinant(&x[unknowns.range(v)]) <= 0.0)
        .collect()
}

/// Returns the vertices whose normal points against every facet around.
pub(super) fn opposed(
    domain: &FlatDomain,
    data: &[VertexCondition],
    unknowns: &Unknowns,
) -> Vec<u32> {
    let topology = domain.topology();
    let position = |v: u32| Vector3::from(unknowns.base[v as usize][0]);
    let against = |vertex: u32, normal: &Vector3<f64>| {
        topology.outgoing(vertex).all(|h| {
            let [a, b, c] = domain.mesh().faces()[(h / 3) as usize].map(position);
            (b - a).cross(&(c - a)).dot(normal) < 0.0
        })
    };
    (0..data.len() as u32)
        .filter(|&v| match &data[v as usize] {
            VertexCondition::Interpolate { normal, .. } => against(v, normal),
            _ => false,
        })
        .collect()
}

/// Draws offending vertices towards the facets around, with growing weights, and solves their
/// surroundings again. Returns the number of rounds.
pub(super) fn repair(
    domain: &FlatDomain,
    data: &[VertexCondition],
    unknowns: &Unknowns,
    system: &System,
    x: &mut [f64],
) -> Result<u32, FitError> {
    let mut anchors: Vec<Option<(f64, [f64; 4])>> = vec![None; data.len()];
    let mut touched = Vec::new();
    for round in 0..ROUNDS {
        let offending = violations(data, unknowns, x);
        if offending.is_empty() {
            return Ok(round);
        }
        for vertex in offending {
            if let VertexCondition::Interpolate { normal, .. } = &data[vertex as usize] {
                let (weight, _) = anchors[vertex as usize].get_or_insert_with(|| {
                    touched.push(vertex);
                    (WEIGHT / GROWTH, target(domain, unknowns, vertex, normal, x))
                });
                *weight *= GROWTH;
            }
        }
        let near = rings(domain, &touched);
        solve_near(unknowns, system, &near, &anchors, x)?;
    }
    Ok(ROUNDS)
}

/// Returns an `X` of positive determinant near that of the facets, as unknowns.
fn target(
    domain: &FlatDomain,
    unknowns: &Unknowns,
    vertex: u32,
    normal: &Vector3<f64>,
    x: &[f64],
) -> [f64; 4] {
    let gradient = facet_gradient(domain, vertex, |v| unknowns.numbers(v, x)[0].into());
    let length = unknowns.lengths[vertex as usize];
    let frame = tangents(&unit(normal).unwrap_or_default());
    let [a, b, c, d] =
        [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(t, p)| length * frame[t].dot(&gradient[p]));
    let square = a * a + b * b + c * c + d * d;
    let size = length * (gradient[0].norm_squared() + gradient[1].norm_squared()).sqrt();
    if determinant(&[a, b, c, d]) > TARGET * 0.5 * square {
        return [a, b, c, d];
    }
    // The nearest similarity, of the size of the gradient.
    let (cosine, sine) = (0.5 * (a + d), 0.5 * (c - b));
    let norm = cosine.hypot(sine);
    let scale = size / std::f64::consts::SQRT_2;
    if norm > 1e-3 * scale {
        let [cosine, sine] = [cosine, sine].map(|s| s / norm * scale);
        [cosine, -sine, sine, cosine]
    } else {
        [scale, 0.0, 0.0, scale]
    }
}

/// Returns the least-squares gradient of the edges at a vertex: derivatives by `u` and `v`.
fn facet_gradient(
    domain: &FlatDomain,
    vertex: u32,
    position: impl Fn(u32) -> Vector3<f64>,
) -> [Vector3<f64>; 2] {
    let topology = domain.topology();
    let mut normal = [0.0; 3];
    let mut sides = [Vector3::zeros(); 2];
    let own = position(vertex);
    let mut add = |flat: [f64; 2], other: u32| {
        let weight = 1.0 / norm(flat).powi(2);
        let chord = position(other) - own;
        normal[0] += weight * flat[0] * flat[0];
        normal[1] += weight * flat[0] * flat[1];
        normal[2] += weight * flat[1] * flat[1];
        (0..2).for_each(|k| sides[k] += weight * flat[k] * chord);
    };
    for h in topology.outgoing(vertex) {
        add(domain.edge_vectors()[h as usize], topology.target(h));
        let previous = Topology::previous(h);
        if topology.twin(previous) == NONE {
            let flat = domain.edge_vectors()[previous as usize].map(|c| -c);
            add(flat, topology.origin(previous));
        }
    }
    let [uu, uv, vv] = normal;
    let determinant = uu * vv - uv * uv;
    [
        (vv * sides[0] - uv * sides[1]) / determinant,
        (uu * sides[1] - uv * sides[0]) / determinant,
    ]
}

/// Returns the vertices within some rings of others, ascending.
fn rings(domain: &FlatDomain, vertices: &[u32]) -> Vec<u32> {
    let mut near = vertices.to_vec();
    near.sort_unstable();
    for _ in 0..RINGS {
        let around: Vec<u32> = near
            .iter()
            .flat_map(|&v| domain.topology().neighbours(v))
            .collect();
        near.extend(around);
        near.sort_unstable();
        near.dedup();
    }
    near
}

/// Solves for the unknowns of some vertices, all others fixed.
fn solve_near(
    unknowns: &Unknowns,
    system: &System,
    near: &[u32],
    anchors: &[Option<(f64, [f64; 4])>],
    x: &mut [f64],
) -> Result<(), FitError> {
    let inside: Vec<usize> = near.iter().flat_map(|&v| unknowns.range(v)).collect();
    let mut places = vec![NONE; x.len()];
    for (place, &k) in inside.iter().enumerate() {
        places[k] = place as u32;
    }
    let (mut entries, mut right) = (Vec::new(), Vec::new());
    for (place, &k) in inside.iter().enumerate() {
        let mut sum = system.right[k];
        for (other, value) in system.matrix.column(k) {
            match places[other] {
                NONE => sum -= value * x[other],
                row if row >= place as u32 => entries.push((row, place as u32, value)),
                _ => {}
            }
        }
        right.push(sum);
    }
    let diagonal = system.matrix.diagonal();
    for &vertex in near {
        let range = unknowns.range(vertex);
        if let Some((weight, target)) = anchors[vertex as usize] {
            let own = diagonal[range.clone()].iter().sum::<f64>() / range.len() as f64;
            for (k, target) in range.zip(target) {
                let place = places[k];
                entries.push((place, place, weight * own));
                right[place as usize] += weight * own * target;
            }
        }
    }
    let matrix = SymmetricMatrix::from_lower_triplets(inside.len(), &entries);
    let order = system.order.iter().map(|&k| places[k as usize]);
    let ordering = Ordering::given(order.filter(|&place| place != NONE).collect());
    let factor =
        Cholesky::factor(Symbolic::analyze(&matrix, &ordering), &matrix).map_err(|source| {
            FitError::Factor {
                vertex: near[0],
                source,
            }
        })?;
    let mut solution = Mat::from_fn(inside.len(), 1, |i, _| right[i]);
    factor.solve_in_place(solution.as_mut());
    for (place, &k) in inside.iter().enumerate() {
        x[k] = solution[(place, 0)];
    }
    Ok(())
}
