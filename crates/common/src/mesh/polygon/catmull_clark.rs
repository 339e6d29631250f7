//! Catmull-Clark refinement of connectivity, sharpness and stencils.
//!
//! # Reference
//! [CatmullClark1978]; [DeRose1998] §3.

use rayon::prelude::*;

use super::ring::{Ring, sharp_fraction};
use super::sharpness::{Rules, Sharpness};
use super::stencils::Stencils;
use super::topology::PolygonTopology;

/// A mesh after one or several Catmull-Clark steps.
#[derive(Clone, Debug)]
pub struct Refined {
    /// Its connectivity: quads only.
    pub topology: PolygonTopology,
    /// What is left of the sharpness.
    pub sharpness: Sharpness,
    /// Its vertices, as weighted sums of those before.
    pub stencils: Stencils,
}

/// Returns one Catmull-Clark refinement, in O(n).
///
/// Vertices keep their ids; after them come the points of edges, then those of faces. Face `c` of
/// the result lies at corner `c` of the mesh, and has as its corners the vertex there, the point of
/// the edge that leaves it, the point of its face, and the point of the edge that enters it.
///
/// # Panics
/// If the result has more corners than 32-bit ids can name.
#[must_use]
pub fn catmull_clark(topology: &PolygonTopology, sharpness: &Sharpness, rules: Rules) -> Refined {
    let vertices = topology.vertex_count();
    let child = topology.cut_into_quads();
    let rings: Vec<Option<[Ring; 2]>> = (0..vertices as u32)
        .into_par_iter()
        .map(|v| {
            (!Ring::is_smooth(topology, sharpness, v)).then(|| {
                let ring = Ring::of(topology, sharpness, v, rules.creases);
                let next = ring.refined(rules.creases);
                [ring, next]
            })
        })
        .collect();
    let next = refined_sharpness(topology, &rings, &child);
    let sharp = |edge: u32| {
        let h = topology.edge_half_edge(edge);
        let pieces = [4 * h, 4 * topology.next(h) + 3].map(|piece| next.edge(child.edge(piece)));
        sharp_fraction(sharpness.edge(edge), pieces)
    };
    let stencils = stencils(topology, &rings, sharp);
    Refined {
        topology: child,
        sharpness: next,
        stencils,
    }
}

fn refined_sharpness(
    topology: &PolygonTopology,
    rings: &[Option<[Ring; 2]>],
    child: &PolygonTopology,
) -> Sharpness {
    let mut sharpness = Sharpness {
        edges: vec![0.0; child.edge_count()],
        vertices: vec![0.0; child.vertex_count()],
    };
    for (v, ring) in rings.iter().enumerate() {
        let Some([_, ring]) = ring else { continue };
        sharpness.vertices[v] = ring.vertex;
        for (spoke, &s) in topology.spokes(v as u32).zip(&ring.edges) {
            // The piece of the edge at this vertex: first side of the child face at an outgoing
            // half-edge, last side of the one after an incoming half-edge.
            let outgoing = topology.origin(spoke) == v as u32;
            let piece = if outgoing {
                4 * spoke
            } else {
                4 * topology.next(spoke) + 3
            };
            sharpness.edges[child.edge(piece) as usize] = s;
        }
    }
    sharpness
}

/// Returns the points of vertices, edges and faces, in this order; `sharp` says how much the midpoint
/// of an edge counts.
fn stencils(
    topology: &PolygonTopology,
    rings: &[Option<[Ring; 2]>],
    sharp: impl Fn(u32) -> f64 + Sync,
) -> Stencils {
    let (vertices, edges) = (topology.vertex_count(), topology.edge_count());
    let count = vertices + edges + topology.face_count();
    Stencils::build(vertices, count, |row, out| match row {
        v if v < vertices => match &rings[v] {
            None => smooth_vertex(topology, v as u32, out),
            Some(rings) => vertex(topology, v as u32, rings, out),
        },
        e if e < vertices + edges => {
            let edge = (e - vertices) as u32;
            edge_point(topology, topology.edge_half_edge(edge), sharp(edge), out);
        }
        f => face_point(topology, (f - vertices - edges) as u32, 1.0, out),
    })
}

fn smooth_vertex(topology: &PolygonTopology, v: u32, out: &mut Vec<(u32, f64)>) {
    let n = topology.outgoing(v).count() as f64;
    out.push((v, (n - 2.0) / n));
    let share = 1.0 / (n * n);
    for h in topology.outgoing(v) {
        out.push((topology.target(h), share));
        face_point(topology, topology.face(h), share, out);
    }
}

fn vertex(topology: &PolygonTopology, v: u32, [ring, next]: &[Ring; 2], out: &mut Vec<(u32, f64)>) {
    let mask = ring.vertex_mask(next);
    out.push((v, mask.vertex));
    for (other, &weight) in topology.neighbours(v).zip(&mask.edges) {
        if weight != 0.0 {
            out.push((other, weight));
        }
    }
    for (h, &weight) in topology.outgoing(v).zip(&mask.faces) {
        if weight != 0.0 {
            face_point(topology, topology.face(h), weight, out);
        }
    }
}

fn edge_point(topology: &PolygonTopology, h: u32, sharp: f64, out: &mut Vec<(u32, f64)>) {
    let end = 0.5 * sharp + 0.25 * (1.0 - sharp);
    out.extend([(topology.origin(h), end), (topology.target(h), end)]);
    if sharp < 1.0 {
        for side in [h, topology.twin(h)] {
            face_point(topology, topology.face(side), 0.25 * (1.0 - sharp), out);
        }
    }
}

fn face_point(topology: &PolygonTopology, face: u32, weight: f64, out: &mut Vec<(u32, f64)>) {
    let corners = topology.face_vertices(face);
    let share = weight / corners.len() as f64;
    out.extend(corners.iter().map(|&corner| (corner, share)));
}

impl Refined {
    /// Returns the mesh as it is, before any step.
    #[must_use]
    pub fn none(topology: &PolygonTopology, sharpness: &Sharpness) -> Self {
        Self {
            topology: topology.clone(),
            sharpness: sharpness.clone(),
            stencils: Stencils::identity(topology.vertex_count()),
        }
    }

    /// Returns the result of one more step, with stencils over the same control points.
    #[must_use]
    pub fn again(&self, rules: Rules) -> Self {
        let next = catmull_clark(&self.topology, &self.sharpness, rules);
        Self {
            stencils: next.stencils.after(&self.stencils),
            ..next
        }
    }
}

/// Returns, for every quad of a mesh, the vertices of its refinement after `levels` steps as a grid of
/// `(2^levels + 1)²`: first from corner 0 to corner 1, then from there to corners 3 and 2.
///
/// # Panics
/// If a face is no quad.
#[must_use]
pub fn face_grids(
    topology: &PolygonTopology,
    refined: &PolygonTopology,
    levels: u32,
) -> Vec<Vec<u32>> {
    assert!(topology.is_quad(), "grids need quads");
    let side = (1usize << levels) + 1;
    (0..topology.face_count() as u32)
        .map(|face| {
            let mut grid = vec![0; side * side];
            fill(refined, face, levels, Square::whole(side), &mut grid, side);
            grid
        })
        .collect()
}

/// A square of a grid: its first corner, and the ways to its second and its fourth.
#[derive(Clone, Copy)]
struct Square {
    origin: [isize; 2],
    along: [isize; 2],
    up: [isize; 2],
}

impl Square {
    fn whole(side: usize) -> Self {
        let n = side as isize - 1;
        Self {
            origin: [0, 0],
            along: [n, 0],
            up: [0, n],
        }
    }

    fn corners(&self) -> [[isize; 2]; 4] {
        let add = |a: [isize; 2], b: [isize; 2]| [a[0] + b[0], a[1] + b[1]];
        let second = add(self.origin, self.along);
        [
            self.origin,
            second,
            add(second, self.up),
            add(self.origin, self.up),
        ]
    }

    /// Returns the quarter at a corner, whose first corner that is.
    fn quarter(&self, corner: usize) -> Self {
        let corners = self.corners();
        let half =
            |to: [isize; 2], from: [isize; 2]| [(to[0] - from[0]) / 2, (to[1] - from[1]) / 2];
        let here = corners[corner];
        Self {
            origin: here,
            along: half(corners[(corner + 1) % 4], here),
            up: half(corners[(corner + 3) % 4], here),
        }
    }
}

fn fill(
    refined: &PolygonTopology,
    face: u32,
    levels: u32,
    square: Square,
    grid: &mut [u32],
    side: usize,
) {
    if levels == 0 {
        for (corner, &vertex) in square.corners().iter().zip(refined.face_vertices(face)) {
            grid[corner[1] as usize * side + corner[0] as usize] = vertex;
        }
        return;
    }
    // Of every mesh of quads, the face at corner i of face f is 4 f + i of the next.
    for corner in 0..4 {
        let child = 4 * face + corner as u32;
        fill(
            refined,
            child,
            levels - 1,
            square.quarter(corner),
            grid,
            side,
        );
    }
}
