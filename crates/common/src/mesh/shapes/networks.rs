//! Curve networks whose patches are known.

use std::collections::BTreeMap;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::mesh::curves::{Curve, CurveNetwork};
use crate::mesh::polygon::{
    PolygonMesh, PolygonTopology, Refined, Rules, Sharpness, face_grids, limit_stencils,
};

/// A network with the patches it was made from.
#[derive(Clone, Debug)]
pub struct KnownNetwork {
    /// The curves.
    pub network: CurveNetwork,
    /// The junctions around every patch, as points of the network, counter-clockwise seen from
    /// outside.
    pub patches: Vec<Vec<u32>>,
    /// The junctions around every opening, likewise with the opening on the left.
    pub openings: Vec<Vec<u32>>,
}

/// Patches grow to this many corners at most when arcs are removed.
const MOST_CORNERS: usize = 8;

/// Returns the edges of a mesh of quads as curves on its Catmull-Clark surface, with `2^levels`
/// segments per edge. Curves run straight on through vertices of valence four, and along the boundary.
///
/// Up to the fraction `removed` of the edges is left out at random, so that patches become larger;
/// each stays a disc of at most eight corners, and three arcs or more meet everywhere inside, so that
/// on closed meshes about a fifth can go.
///
/// # Panics
/// If a face is no quad.
#[must_use]
pub fn limit_network(
    mesh: &PolygonMesh,
    sharpness: &Sharpness,
    levels: u32,
    removed: f64,
    seed: u64,
) -> KnownNetwork {
    let topology = mesh.topology();
    let rules = Rules::default();
    let refined =
        (0..levels.max(1)).fold(Refined::none(topology, sharpness), |r, _| r.again(rules));
    let limits = limit_stencils(&refined, rules).apply(mesh.positions());
    let grids = face_grids(topology, &refined.topology, levels.max(1));
    let patches = Patches::of(topology).without(topology, removed, seed);
    let mut numbering = Numbering::default();
    let mut curves = Vec::new();
    for path in paths(topology, &patches.kept) {
        let mut points = Vec::new();
        let mut creases = Vec::new();
        for (edge, from) in path {
            let h = topology.edge_half_edge(edge);
            let mut along = side(&grids, h);
            if topology.origin(h) != from {
                along.reverse();
            }
            if levels == 0 {
                along = vec![along[0], along[along.len() - 1]];
            }
            let skipped = usize::from(!points.is_empty());
            points.extend(along[skipped..].iter().map(|&v| numbering.id(v)));
            let crease = sharpness.edge(edge) > 0.0 && !topology.is_boundary_edge(edge);
            creases.resize(points.len() - 1, crease);
        }
        curves.push(Curve { points, creases });
    }
    let mut named = |corners: &mut dyn Iterator<Item = u32>| -> Vec<u32> {
        let junctions = corners.filter(|&v| patches.valence(topology, v) > 2);
        junctions.map(|v| numbering.id(v)).collect()
    };
    let around = patches.around.iter().filter(|around| !around.is_empty());
    let known = around.map(|around| named(&mut around.iter().map(|&h| topology.origin(h))));
    let known = known.collect();
    let openings = topology.boundary_loops().into_iter();
    let openings = openings.map(|h| named(&mut h.iter().rev().map(|&h| topology.target(h))));
    let openings = openings.collect();
    let position = |&v: &u32| limits[v as usize];
    let points = numbering.vertices.iter().map(position).collect();
    KnownNetwork {
        network: CurveNetwork::build(points, curves).expect("edges are curves"),
        patches: known,
        openings,
    }
}

/// Numbers vertices in the order in which they are met.
#[derive(Default)]
struct Numbering {
    ids: BTreeMap<u32, u32>,
    vertices: Vec<u32>,
}

impl Numbering {
    fn id(&mut self, vertex: u32) -> u32 {
        let vertices = &mut self.vertices;
        *self.ids.entry(vertex).or_insert_with(|| {
            vertices.push(vertex);
            vertices.len() as u32 - 1
        })
    }
}

/// Returns the refined vertices along a half-edge of a quad.
fn side(grids: &[Vec<u32>], h: u32) -> Vec<u32> {
    let grid = &grids[h as usize / 4];
    let row = grid.len().isqrt();
    let last = row - 1;
    let at = |i: usize| match h % 4 {
        0 => i,
        1 => i * row + last,
        2 => last * row + last - i,
        _ => (last - i) * row,
    };
    (0..row).map(|i| grid[at(i)]).collect()
}

/// Returns the kept edges as paths, each as its edges with the vertex where each starts.
fn paths(topology: &PolygonTopology, kept: &[bool]) -> Vec<Vec<(u32, u32)>> {
    let mut left = kept.to_vec();
    let other_end = |edge: u32, v: u32| {
        let [a, b] = topology.edge_vertices(edge);
        a ^ b ^ v
    };
    let follow = |edge: u32, from: u32, left: &mut [bool]| {
        let mut path = vec![(edge, from)];
        let mut at = other_end(edge, from);
        let mut last = edge;
        while let Some(next) = beyond(topology, last, at).filter(|&e| left[e as usize]) {
            left[next as usize] = false;
            path.push((next, at));
            at = other_end(next, at);
            last = next;
        }
        path
    };
    let mut paths = Vec::new();
    for edge in 0..kept.len() as u32 {
        if !std::mem::take(&mut left[edge as usize]) {
            continue;
        }
        let [from, to] = topology.edge_vertices(edge);
        let ahead = follow(edge, from, &mut left);
        let behind = follow(edge, to, &mut left);
        let turned = behind[1..].iter().rev();
        let turned = turned.map(|&(e, v)| (e, other_end(e, v)));
        paths.push(turned.chain(ahead).collect());
    }
    paths
}

/// Returns the edge in which a curve goes on beyond a vertex.
fn beyond(topology: &PolygonTopology, edge: u32, v: u32) -> Option<u32> {
    let spokes: Vec<u32> = topology.spokes(v).map(|h| topology.edge(h)).collect();
    let place = spokes.iter().position(|&e| e == edge)?;
    if topology.is_boundary_vertex(v) {
        let last = spokes.len() - 1;
        let along = last > 1 && (place == 0 || place == last);
        along.then(|| spokes[last - place])
    } else {
        (spokes.len() == 4).then(|| spokes[(place + 2) % 4])
    }
}

/// Which edges are kept, and the patches between them.
struct Patches {
    kept: Vec<bool>,
    /// The half-edges around every patch, none if it went into another.
    around: Vec<Vec<u32>>,
    /// The patch of every face.
    of_face: Vec<u32>,
}

impl Patches {
    fn of(topology: &PolygonTopology) -> Self {
        let faces = 0..topology.face_count() as u32;
        let half_edges = |f: u32| {
            let first = topology.face_half_edge(f);
            (first..first + topology.face_size(f)).collect()
        };
        Self {
            kept: vec![true; topology.edge_count()],
            around: faces.clone().map(half_edges).collect(),
            of_face: faces.collect(),
        }
    }

    fn valence(&self, topology: &PolygonTopology, v: u32) -> usize {
        let kept = |h: &u32| self.kept[topology.edge(*h) as usize];
        topology.spokes(v).filter(kept).count()
    }

    /// Removes a fraction of the edges, fewer where too few may go.
    fn without(mut self, topology: &PolygonTopology, fraction: f64, seed: u64) -> Self {
        const TRIES: usize = 20;
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let edges = self.kept.len();
        let mut left = (fraction * edges as f64) as usize;
        for _ in 0..TRIES * edges {
            if left == 0 {
                break;
            }
            let edge = random.random_range(0..edges as u32);
            left -= usize::from(self.remove(topology, edge));
        }
        self
    }

    /// Joins the patches on both sides of an edge, if what remains is a network of discs.
    fn remove(&mut self, topology: &PolygonTopology, edge: u32) -> bool {
        let ends = topology.edge_vertices(edge);
        let lonely = ends.iter().any(|&v| self.valence(topology, v) < 4);
        if !self.kept[edge as usize] || topology.is_boundary_edge(edge) || lonely {
            return false;
        }
        let h = topology.edge_half_edge(edge);
        let sides = [h, topology.twin(h)];
        let patches = sides.map(|h| self.of_face[topology.face(h) as usize] as usize);
        let beside = |i: usize| {
            let mut around = self.around[patches[i]].clone();
            let place = around.iter().position(|&other| other == sides[i]);
            around.rotate_left(place.expect("a patch has its half-edges"));
            around.remove(0);
            around
        };
        let merged = [beside(0), beside(1)].concat();
        let mut corners: Vec<u32> = merged.iter().map(|&h| topology.origin(h)).collect();
        corners.sort_unstable();
        let disc = corners.windows(2).all(|pair| pair[0] != pair[1]);
        if patches[0] == patches[1] || !disc || corners.len() > MOST_CORNERS {
            return false;
        }
        self.kept[edge as usize] = false;
        for patch in &mut self.of_face {
            if *patch as usize == patches[1] {
                *patch = patches[0] as u32;
            }
        }
        self.around[patches[1]].clear();
        self.around[patches[0]] = merged;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes::{box_surface, quad_patch, slab_with_holes};

    fn smooth(mesh: &PolygonMesh, levels: u32, removed: f64) -> KnownNetwork {
        let sharpness = Sharpness::smooth(mesh.topology(), Rules::default());
        limit_network(mesh, &sharpness, levels, removed, 1)
    }

    #[test]
    fn all_edges_become_curves_with_the_segments_asked_for() {
        let mesh = slab_with_holes(1);
        for levels in [0, 1, 3] {
            let known = smooth(&mesh, levels, 0.0);
            let edges = mesh.topology().edge_count();
            assert_eq!(known.network.segment_count(), edges << levels);
            assert_eq!(known.patches.len(), mesh.face_count());
            let points = mesh.vertex_count() + edges * ((1 << levels) - 1);
            assert_eq!(known.network.points().len(), points);
        }
    }

    #[test]
    fn removed_edges_leave_discs_and_junctions() {
        let mesh = box_surface([3, 3, 3]);
        let edges = mesh.topology().edge_count();
        let patches = |removed| smooth(&mesh, 2, removed).patches.len();
        assert_eq!(patches(0.1), mesh.face_count() - edges / 10);
        // Three arcs stay at every junction, so that no more than a quarter of them can go.
        let known = smooth(&mesh, 2, 0.5);
        assert!((edges / 6..edges / 4).contains(&(mesh.face_count() - known.patches.len())));
        for patch in &known.patches {
            let mut corners = patch.clone();
            corners.sort_unstable();
            corners.dedup();
            assert_eq!(corners.len(), patch.len());
            assert!((3..=MOST_CORNERS).contains(&patch.len()));
        }
    }

    #[test]
    fn a_patch_has_one_opening_without_its_corners() {
        let known = smooth(&quad_patch(4), 2, 0.0);
        assert_eq!(
            known.openings.iter().map(Vec::len).collect::<Vec<_>>(),
            [12]
        );
    }
}
