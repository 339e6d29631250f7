//! Which vertices become controls next.

use crate::space::Space;
use crate::system::System;

/// Returns up to `count` vertices that are no controls yet, at the largest local maxima of the
/// error over the neighbourhoods of the mesh.
///
/// Of equal errors that of the lower id counts as larger. Where only controls are maxima, the
/// vertex of largest error is returned; nothing only if all vertices are controls.
///
/// # Reference
/// [Sorkine2004] §4, [Hou2017] §8.1. Deviation: all controls of a step are maxima of one error
/// field, taken largest first.
pub(crate) fn local_maxima(system: &System<'_>, errors: &[f64], count: usize) -> Vec<u32> {
    let larger = |&a: &usize, &b: &usize| errors[b].total_cmp(&errors[a]).then(a.cmp(&b));
    let free = || (0..errors.len()).filter(|&vertex| !system.is_control(vertex));
    let mut maxima: Vec<usize> = free()
        .filter(|&vertex| is_local_maximum(system.space(), errors, vertex))
        .collect();
    if maxima.is_empty() {
        maxima.extend(free().min_by(larger));
    }
    maxima.sort_by(larger);
    maxima.truncate(count);
    maxima.into_iter().map(|vertex| vertex as u32).collect()
}

fn is_local_maximum(space: &Space, errors: &[f64], vertex: usize) -> bool {
    space
        .neighbours(vertex)
        .iter()
        .map(|&other| other as usize)
        .all(|other| {
            errors[vertex] > errors[other] || (errors[vertex] == errors[other] && vertex < other)
        })
}

/// Returns the vertex of largest error of each component, of equal ones the first.
pub(crate) fn component_maxima(labels: &[u32], components: u32, errors: &[f64]) -> Vec<u32> {
    let mut best: Vec<Option<usize>> = vec![None; components as usize];
    for (vertex, &label) in labels.iter().enumerate() {
        let best = &mut best[label as usize];
        if best.is_none_or(|other| errors[vertex] > errors[other]) {
            *best = Some(vertex);
        }
    }
    best.into_iter()
        .flatten()
        .map(|vertex| vertex as u32)
        .collect()
}
