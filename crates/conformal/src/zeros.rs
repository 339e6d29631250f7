//! Zeros of a complex 1-form on a triangulation: where, of which order, and what to cut out.
//!
//! The index of a vertex under the real form `Re(e^{-iθ} ω)` is `1 - s/2` for `s` changes of sign
//! around it. Indices sum to the Euler characteristic for every form whatever; what tells a zero of ω
//! from a fold is that the index of a cluster of vertices is the same for all θ.
//!
//! # Reference
//! [Gortler2006] §3, the index of a vertex.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;

use msplines_common::mesh::NONE;

use crate::flat::FlatComplex;

/// Directions `θ` in [0, π) under which indices are taken.
const DIRECTIONS: u32 = 24;

/// A zero of the form, or its pole.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Zero {
    /// Its order: 1 for a simple zero, -2 for the double pole of a stereographic image.
    pub order: i32,
    /// Vertices that it lies between, ascending; one if it lies at a vertex.
    pub vertices: Vec<u32>,
    /// Faces around these vertices, ascending: the hole of an affine atlas.
    pub faces: Vec<u32>,
}

/// Zeros and what prevents them from being cut out.
#[derive(Clone, Debug, Default)]
pub(crate) struct Findings {
    pub(crate) zeros: Vec<Zero>,
    /// Vertices whose index depends on the direction.
    pub(crate) inconsistent: Vec<u32>,
    /// Folded faces outside of the zeros' faces.
    pub(crate) folded: Vec<u32>,
    /// A vertex of each zero whose faces are no disk or touch those of another.
    pub(crate) not_disks: Vec<u32>,
}

impl Findings {
    pub(crate) fn is_clean(&self) -> bool {
        self.inconsistent.is_empty() && self.folded.is_empty() && self.not_disks.is_empty()
    }

    /// Number of folded faces, and of vertices that are no zero and no regular point.
    pub(crate) fn folds(&self) -> usize {
        self.inconsistent.len() + self.folded.len()
    }

    /// Fewer is better.
    pub(crate) fn badness(&self) -> usize {
        self.folds() + self.not_disks.len()
    }
}

/// Finds the zeros on a flattened mesh of so many vertices; what lies around a pole is left out.
pub(crate) fn find(flat: &FlatComplex, vertices: usize, pole: Option<u32>) -> Findings {
    let outgoing = flat.outgoing(vertices);
    let mut stars: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    let mut indices: BTreeMap<u32, Vec<i32>> = BTreeMap::new();
    for vertex in 0..vertices as u32 {
        let Some(star) = flat.star(outgoing[vertex as usize]) else {
            continue;
        };
        let at_pole = Some(vertex) == pole || star.iter().any(|&h| Some(flat.target(h)) == pole);
        if at_pole || flat.is_regular(&star) {
            continue;
        }
        let directions = (0..DIRECTIONS).map(|i| f64::from(i) * PI / f64::from(DIRECTIONS));
        let found: Vec<i32> = directions.map(|angle| flat.index(&star, angle)).collect();
        if found.iter().any(|&index| index != 0) {
            stars.insert(vertex, star);
            indices.insert(vertex, found);
        }
    }
    let mut findings = Findings::default();
    let mut in_zeros = vec![NONE; flat.faces().len()];
    for cluster in clusters(flat, &stars) {
        let sums = cluster.iter().map(|v| &indices[v]);
        let sums = sums.fold(vec![0; DIRECTIONS as usize], |sums, own| {
            sums.iter().zip(own).map(|(a, b)| a + b).collect()
        });
        if sums.iter().any(|&sum| sum != sums[0]) || sums[0] > 0 {
            findings.inconsistent.extend(&cluster);
            continue;
        }
        if sums[0] == 0 {
            continue;
        }
        let faces: BTreeSet<u32> = cluster
            .iter()
            .flat_map(|v| stars[v].iter().map(|h| h / 3))
            .collect();
        for &face in &faces {
            in_zeros[face as usize] = findings.zeros.len() as u32;
        }
        findings.zeros.push(Zero {
            order: -sums[0],
            vertices: cluster,
            faces: faces.into_iter().collect(),
        });
    }
    if let Some(pole) = pole {
        let zero = double_pole(flat, pole);
        for &face in &zero.faces {
            in_zeros[face as usize] = findings.zeros.len() as u32;
        }
        findings.zeros.push(zero);
    }
    let folded = (0..flat.faces().len() as u32).filter(|&f| flat.doubled_area(f) <= 0.0);
    findings.folded = folded.filter(|&f| in_zeros[f as usize] == NONE).collect();
    findings.not_disks = not_disks(flat, &findings.zeros);
    findings
}

/// The pole at a vertex, with the faces around it.
fn double_pole(flat: &FlatComplex, pole: u32) -> Zero {
    let faces = (0u32..).zip(flat.faces());
    let star = faces.filter(|(_, corners)| corners.contains(&pole));
    Zero {
        order: -2,
        vertices: vec![pole],
        faces: star.map(|(face, _)| face).collect(),
    }
}

/// Connected components of the vertices that have stars.
fn clusters(flat: &FlatComplex, stars: &BTreeMap<u32, Vec<u32>>) -> Vec<Vec<u32>> {
    let mut left: BTreeSet<u32> = stars.keys().copied().collect();
    let mut clusters = Vec::new();
    while let Some(first) = left.pop_first() {
        let mut cluster = vec![first];
        let mut next = 0;
        while next < cluster.len() {
            for &half_edge in &stars[&cluster[next]] {
                let target = flat.target(half_edge);
                if left.remove(&target) {
                    cluster.push(target);
                }
            }
            next += 1;
        }
        cluster.sort_unstable();
        clusters.push(cluster);
    }
    clusters
}

/// A vertex of each zero whose faces are no disk, or share a vertex with those of another zero.
fn not_disks(flat: &FlatComplex, zeros: &[Zero]) -> Vec<u32> {
    let mut owners: BTreeMap<u32, usize> = BTreeMap::new();
    let mut bad = BTreeSet::new();
    for (number, zero) in zeros.iter().enumerate() {
        let corners: BTreeSet<u32> = zero
            .faces
            .iter()
            .flat_map(|&f| flat.faces()[f as usize])
            .collect();
        let inside = zero.faces.iter().flat_map(|&f| {
            let [a, b, c] = flat.faces()[f as usize];
            [[a, b], [b, c], [c, a]]
        });
        let directed: BTreeSet<[u32; 2]> = inside.collect();
        let rim = directed
            .iter()
            .filter(|[a, b]| !directed.contains(&[*b, *a]))
            .count();
        let edges = (directed.len() + rim) / 2;
        let disk = corners.len() + zero.faces.len() == edges + 1;
        // On a simple loop there are as many vertices as edges.
        let on_rim = corners
            .iter()
            .filter(|v| !zero.vertices.contains(v))
            .count();
        if !disk || on_rim != rim {
            bad.insert(zero.vertices[0]);
        }
        for vertex in corners {
            if owners
                .insert(vertex, number)
                .is_some_and(|other| other != number)
            {
                bad.insert(zero.vertices[0]);
            }
        }
    }
    bad.into_iter().collect()
}
