//! Patches, edges and vertices as a shell.

use msplines_common::Point3;
use msplines_common::bspline::{BezierCurve, BezierEdge, BezierFace, BezierShell, EdgeUse};
use rayon::prelude::*;

use super::mesh::QuadMesh;
use super::patch::Patch;

/// Rounding of ends of curves over the size of the coordinates.
const ROUNDING: f64 = 1e-12;
/// Where on an edge the patches beside it are compared.
const PROBES: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// A patch beside an edge: which, on which side, and which part of that.
#[derive(Clone, Copy, Debug)]
struct Beside {
    patch: u32,
    side: usize,
    range: [i64; 2],
}

/// Returns for every edge the patches beside it, one or two.
fn beside(mesh: &QuadMesh) -> Vec<Vec<Beside>> {
    let mut found = vec![Vec::with_capacity(2); mesh.edges().len()];
    for (patch, face) in mesh.faces().iter().enumerate() {
        for (side, parts) in face.sides.iter().enumerate() {
            for part in parts {
                found[part.edge.edge as usize].push(Beside {
                    patch: patch as u32,
                    side,
                    range: part.range,
                });
            }
        }
    }
    found
}

impl Patch {
    /// Returns the point on a side at a share of a part of it.
    fn on_side(&self, beside: &Beside, share: f64) -> Point3<f64> {
        // Parameters are not linear on sides at zeros, but the same for both patches if the parts are whole
        // sides; for others the points are compared at the same coordinates.
        let [low, high] = beside.range;
        let at = low + ((high - low) as f64 * share) as i64;
        let t = self.cell.parameter(self.chart, beside.side, at);
        let across = if beside.side == 1 || beside.side == 2 {
            1.0
        } else {
            0.0
        };
        self.position(if beside.side.is_multiple_of(2) {
            [t, across]
        } else {
            [across, t]
        })
    }
}

/// Returns the largest distance between patches at the same points of the edges between them.
pub(super) fn gap(mesh: &QuadMesh, patches: &[Patch]) -> f64 {
    let edges = beside(mesh);
    let gaps = edges.par_iter().map(|sides| {
        let [one, other] = sides[..] else { return 0.0 };
        let at = |beside: &Beside, t| patches[beside.patch as usize].on_side(beside, t);
        let distances = PROBES.map(|t| (at(&one, t) - at(&other, t)).norm());
        distances.into_iter().fold(0.0, f64::max)
    });
    gaps.reduce(|| 0.0, f64::max)
}

/// Returns the shell, with the largest distance between ends of curves and vertices as its tolerance.
pub(super) fn shell(
    mesh: &QuadMesh,
    patches: &[Patch],
    gap: f64,
) -> Result<BezierShell, super::CellError> {
    let mut faces: Vec<BezierFace> = patches.iter().map(face).collect();
    let vertices: Vec<Point3<f64>> = mesh
        .vertices()
        .iter()
        .map(|vertex| {
            let (patch, corner) = vertex.corner;
            let patch = &patches[patch as usize];
            let d = patch.degree;
            patch.points[[0, d, d + (d + 1) * d, (d + 1) * d][usize::from(corner)]]
        })
        .collect();
    let sides = beside(mesh);
    let edges: Vec<BezierEdge> = mesh
        .edges()
        .iter()
        .zip(&sides)
        .map(|(edge, sides)| BezierEdge {
            ends: edge.ends,
            curve: curve(sides, patches, &faces),
        })
        .collect();
    for (face, own) in faces.iter_mut().zip(mesh.faces()) {
        let parts = own.sides.iter().flatten();
        face.boundary = parts.map(|part| -> EdgeUse { part.edge }).collect();
    }
    let size = vertices.iter().map(|p| p.coords.amax()).fold(0.0, f64::max);
    let off = edges.iter().flat_map(|edge| {
        let ends = [edge.curve.points.first(), edge.curve.points.last()];
        let pairs = ends.into_iter().flatten().zip(edge.ends);
        let far = |(end, vertex): (&Point3<f64>, u32)| (end - vertices[vertex as usize]).norm();
        pairs.map(far).collect::<Vec<f64>>()
    });
    let off = off.fold(gap, f64::max).max(ROUNDING * size);
    Ok(BezierShell::build(vertices, edges, faces, 2.0 * off)?)
}

fn face(patch: &Patch) -> BezierFace {
    BezierFace {
        degree: [patch.degree; 2],
        points: patch.points.clone(),
        weights: patch.weights.clone(),
        boundary: Vec::new(),
    }
}

/// Returns the curve of an edge: that of an exact patch where one is beside it, and of a whole side rather
/// than of a part.
fn curve(sides: &[Beside], patches: &[Patch], faces: &[BezierFace]) -> BezierCurve {
    let whole = |b: &Beside| {
        let tile = &patches[b.patch as usize].cell;
        b.range == [tile.x, tile.y][b.side % 2]
    };
    let rank = |b: &&Beside| (patches[b.patch as usize].is_exact(), whole(b));
    let best = sides.iter().max_by_key(rank).expect("an edge has a patch");
    let patch = &patches[best.patch as usize];
    let mut curve = faces[best.patch as usize].side(best.side);
    if best.side >= 2 {
        curve.points.reverse();
        if let Some(weights) = &mut curve.weights {
            weights.reverse();
        }
    }
    if whole(best) {
        return curve;
    }
    let range = best
        .range
        .map(|c| patch.cell.parameter(patch.chart, best.side, c));
    curve.piece(range)
}
