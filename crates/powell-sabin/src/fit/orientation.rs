//! Vertices where the surface is inside out, and their repair.
//!
//! # Notation
//! At a vertex with unit normal `n` and tangents `t1, t2`, the derivatives are
//! `[F_u F_v] = [t1 t2] X`. The surface has the normal `n`, and not `-n`, if `det X > 0`, which no
//! linear system can ask for.

use std::f64::consts::PI;

use msplines_common::Vector3;
use msplines_common::linalg::{Cholesky, Mat, Ordering, Symbolic, SymmetricMatrix};
use msplines_common::mesh::{NONE, Topology};
use nalgebra::{Rotation3, Unit};

use super::data::{Unknowns, VertexCondition, tangents, unit};
use super::system::System;
use crate::domain::FlatDomain;
use crate::error::FitError;

/// Rings around a vertex that are solved again: what is farther hardly moves.
const RINGS: usize = 3;

/// First weight of an anchor, relative to the vertex' own part of the energy, and its growth.
const WEIGHT: f64 = 0.25;
const GROWTH: f64 = 4.0;

/// After so many rounds the weight is 1e11: the anchors hold, or there is nothing to be done.
const ROUNDS: u32 = 20;

/// Cosine of the angle between the normal and that of the facets below which their gradient is turned
/// into the tangent plane, not projected.
const TARGET: f64 = 0.1;

/// How many times longer than the longest edge at a vertex the tangent along one of them may be.
///
/// Where the domain is needles, the gradient across them is long, and what of it leaks along an edge
/// throws the surface far away.
const LONGEST: f64 = 4.0;

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

/// Returns the vertices whose tangents along edges are far longer than the edges.
fn overshooting(domain: &FlatDomain, unknowns: &Unknowns, x: &[f64]) -> Vec<u32> {
    let vertices = 0..domain.mesh().vertex_count() as u32;
    let position = |v: u32| Vector3::from(unknowns.numbers(v, x)[0]);
    let is_long = |vertex: u32| {
        let [own, by_u, by_v] = unknowns.numbers(vertex, x).map(Vector3::from);
        let (mut tangent, mut edge) = (0.0f64, 0.0f64);
        for h in domain.topology().outgoing(vertex) {
            let [u, v] = domain.edge_vectors()[h as usize];
            tangent = tangent.max((by_u * u + by_v * v).norm());
            edge = edge.max((position(domain.topology().target(h)) - own).norm());
        }
        !unknowns.range(vertex).is_empty() && tangent > LONGEST * edge
    };
    vertices.filter(|&vertex| is_long(vertex)).collect()
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
    let mut anchors: Vec<Option<(f64, Vec<f64>)>> = vec![None; data.len()];
    let mut touched = Vec::new();
    for round in 0..ROUNDS {
        let mut offending = violations(data, unknowns, x);
        offending.extend(overshooting(domain, unknowns, x));
        offending.sort_unstable();
        offending.dedup();
        if offending.is_empty() {
            return Ok(round);
        }
        for vertex in offending {
            let (weight, _) = anchors[vertex as usize].get_or_insert_with(|| {
                touched.push(vertex);
                let target = target(domain, unknowns, vertex, &data[vertex as usize], x);
                (WEIGHT / GROWTH, target)
            });
            *weight *= GROWTH;
        }
        let near = rings(domain, &touched);
        solve_near(unknowns, system, &near, &anchors, x)?;
    }
    Ok(ROUNDS)
}

/// Returns unknowns of a vertex whose gradient is that of the facets, in the tangent plane and oriented
/// as the normal where there is one.
fn target(
    domain: &FlatDomain,
    unknowns: &Unknowns,
    vertex: u32,
    condition: &VertexCondition,
    x: &[f64],
) -> Vec<f64> {
    let gradient = facet_gradient(domain, vertex, |v| unknowns.numbers(v, x)[0].into());
    let length = unknowns.lengths[vertex as usize];
    match condition {
        VertexCondition::Interpolate { normal, .. } => {
            let normal = unit(normal).unwrap_or_default();
            let gradient = turned(gradient, &normal);
            let along = |t: Vector3<f64>| [0, 1].map(|p| length * t.dot(&gradient[p]));
            tangents(&normal).map(along).concat()
        }
        // The last unknowns are the components of both derivatives, after those of a free position.
        _ => {
            let count = unknowns.range(vertex).len();
            let held = &x[unknowns.range(vertex)][..count.saturating_sub(6)];
            let derivatives = gradient.iter().flat_map(|g| g.iter().map(|c| length * c));
            held.iter().copied().chain(derivatives).collect()
        }
    }
}

/// Returns a gradient in the plane across `normal`, oriented by it: projected, or turned with its own
/// normal where that leaves too little.
fn turned(gradient: [Vector3<f64>; 2], normal: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let own = gradient[0].cross(&gradient[1]);
    if own.dot(normal) > TARGET * own.norm() {
        return gradient;
    }
    let half_turn = || Rotation3::from_axis_angle(&Unit::new_unchecked(tangents(normal)[0]), PI);
    let rotation = Rotation3::rotation_between(&own, normal).unwrap_or_else(half_turn);
    gradient.map(|g| rotation * g)
}

/// Returns the gradient that best tells the edges at a vertex, each relative to its length: derivatives
/// by `u` and `v`.
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
        let chord = position(other) - own;
        // The misses count in lengths of space: flat ones say nothing where the domain is needles.
        let weight = 1.0 / chord.norm_squared();
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
    anchors: &[Option<(f64, Vec<f64>)>],
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
        if let Some((weight, target)) = &anchors[vertex as usize] {
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
