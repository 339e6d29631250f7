//! Patches spanned by their curves.

use nalgebra::Vector3;

use super::nodes::Nodes;

/// Returns nodes of bilinearly blended Coons patches; nothing if edges without curves leave out some.
///
/// # Reference
/// [Coons1967].
pub(super) fn coons(nodes: &Nodes) -> Option<Vec<Vector3<f64>>> {
    let n = nodes.cells as usize;
    let side = n + 1;
    let mut shape = nodes.targets.clone();
    for grid in &nodes.grids {
        let at = |i: usize, j: usize| nodes.targets[grid[j * side + i] as usize];
        for (i, j) in (1..n).flat_map(|j| (1..n).map(move |i| (i, j))) {
            let [u, v] = [i, j].map(|step| step as f64 / n as f64);
            let between = at(i, 0)? * (1.0 - v) + at(i, n)? * v;
            let across = at(0, j)? * (1.0 - u) + at(n, j)? * u;
            let bottom = at(0, 0)? * (1.0 - u) + at(n, 0)? * u;
            let top = at(0, n)? * (1.0 - u) + at(n, n)? * u;
            let both = bottom * (1.0 - v) + top * v;
            shape[grid[j * side + i] as usize] = Some(between + across - both);
        }
    }
    shape.into_iter().collect()
}
