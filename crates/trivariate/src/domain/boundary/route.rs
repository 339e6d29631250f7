//! Twelve disjoint paths on a surface, one for each edge of the cube.
//!
//! A path that visits all corners comes first: it cannot cut the surface in two. Of the paths that
//! follow, each leaves and reaches a corner in the sector where the cyclic order of the cube puts
//! it, which also decides on which side of the others it runs. Where other paths leave no way
//! between them, edges there are split.

use msplines_common::mesh::TriangleMesh;

use super::error::BoundaryError;
use super::options::RoutingOptions;
use crate::domain::cube::{EDGES, corner_ring, edge_between};
use crate::domain::split::split_surface;

/// The corners in an order in which the first path may visit them; its images under the symmetries
/// of the cube are tried as well.
const FIRST_PATH: [usize; 8] = [0, 1, 3, 2, 6, 7, 5, 4];

/// How often edges are split for one path before it is given up.
const SPLIT_ROUNDS: usize = 4;

/// Paths this much longer than if each were alone are good enough.
const GOOD_ENOUGH: f64 = 1.1;

/// A vertex that no path passes.
pub(super) const FREE: u8 = u8::MAX;

/// A vertex that is a corner.
pub(super) const CORNER: u8 = u8::MAX - 1;

/// Disjoint paths on a surface whose edges may have been split for them.
pub(super) struct Routed {
    /// The surface; its first vertices are those given.
    pub(super) surface: TriangleMesh,
    /// Edges split, in this order; each has got the next vertex.
    pub(super) splits: Vec<[u32; 2]>,
    /// Vertices from the first to the second corner of each edge of the cube.
    pub(super) paths: [Vec<u32>; 12],
}

/// Returns the paths between `corners`, where ground at vertex `v` counts `ground[v]` times.
pub(super) fn route(
    surface: &TriangleMesh,
    corners: &[u32; 8],
    ground: Vec<f64>,
    options: &RoutingOptions,
) -> Result<Routed, BoundaryError> {
    let mut router = Router::new(surface, *corners, ground);
    router.lay_shortest()?;
    for _ in 0..options.sweeps {
        if !router.sweep(options) {
            break;
        }
    }
    Ok(Routed {
        surface: router.surface,
        splits: router.splits,
        paths: router.paths,
    })
}

/// Outgoing half-edges of a corner, of which the first `walls` belong to a path.
struct Sector {
    half_edges: Vec<u32>,
    walls: usize,
}

/// The state of the search for paths.
pub(super) struct Router {
    pub(super) surface: TriangleMesh,
    pub(super) corners: [u32; 8],
    /// How many times the ground at each vertex counts.
    pub(super) ground: Vec<f64>,
    /// The edge of the cube whose path passes each vertex, [`CORNER`] or [`FREE`].
    pub(super) owner: Vec<u8>,
    splits: Vec<[u32; 2]>,
    pub(super) paths: [Vec<u32>; 12],
}

/// An order of the paths, how many of them could be laid, and their length.
struct Attempt {
    order: Vec<usize>,
    laid: usize,
    length: f64,
    paths: [Vec<u32>; 12],
}

impl Attempt {
    fn is_better(&self, other: &Self) -> bool {
        self.laid > other.laid || self.laid == other.laid && self.length < other.length
    }
}

/// Returns orders of the paths, each with one that visits all corners first.
fn orders() -> impl Iterator<Item = Vec<usize>> {
    // Reflections by the bits of a number, then permutations of the axes.
    const AXES: [[usize; 3]; 6] = [
        [0, 1, 2],
        [1, 2, 0],
        [2, 0, 1],
        [1, 0, 2],
        [0, 2, 1],
        [2, 1, 0],
    ];
    let symmetries = (0..8).flat_map(|reflected| AXES.map(|axes| (reflected, axes)));
    symmetries.map(|(reflected, axes)| {
        let image = |corner: usize| {
            let bits = (0..3).map(|axis| (corner >> axis & 1) << axes[axis]);
            bits.sum::<usize>() ^ reflected
        };
        let steps = FIRST_PATH.windows(2);
        let mut order: Vec<usize> = steps
            .filter_map(|ends| edge_between(image(ends[0]), image(ends[1])))
            .collect();
        order.extend(
            (0..12)
                .filter(|edge| !order.contains(edge))
                .collect::<Vec<_>>(),
        );
        order
    })
}

/// Where a path starts and ends, the neighbours that it may pass there, and the faces between them.
pub(super) struct Task {
    pub(super) ends: [u32; 2],
    pub(super) doors: [Vec<u32>; 2],
    pub(super) first_faces: Vec<u32>,
}

impl Router {
    fn new(surface: &TriangleMesh, corners: [u32; 8], ground: Vec<f64>) -> Self {
        let mut owner = vec![FREE; surface.vertex_count()];
        corners.iter().for_each(|&v| owner[v as usize] = CORNER);
        Self {
            surface: surface.clone(),
            corners,
            ground,
            owner,
            splits: Vec::new(),
            paths: Default::default(),
        }
    }

    /// Lays all paths, in the order that makes them shortest.
    ///
    /// Paths laid first may turn the wrong way around corners, and all others with them.
    fn lay_shortest(&mut self) -> Result<(), BoundaryError> {
        let alone = |edge| self.shortest(&self.task(edge), None);
        let alone: f64 = (0..12)
            .filter_map(alone)
            .map(|path| self.path_length(&path))
            .sum();
        let mut best: Option<Attempt> = None;
        for order in orders() {
            let shortest = best
                .as_ref()
                .filter(|best| best.laid == 12)
                .map(|best| best.length);
            let attempt = self.attempt(order, shortest.unwrap_or(f64::INFINITY));
            if best.as_ref().is_none_or(|best| attempt.is_better(best)) {
                best = Some(attempt);
            }
            if best
                .as_ref()
                .is_some_and(|b| b.laid == 12 && b.length <= GOOD_ENOUGH * alone)
            {
                break;
            }
        }
        let Some(Attempt {
            order,
            laid,
            mut paths,
            ..
        }) = best
        else {
            return Ok(());
        };
        for &edge in &order[..laid] {
            self.lay(edge, std::mem::take(&mut paths[edge]));
        }
        order[laid..]
            .iter()
            .try_for_each(|&edge| self.lay_for_sure(edge))
    }

    /// Lays paths and lifts them again, until one finds no way or together they are too long.
    fn attempt(&mut self, order: Vec<usize>, longest: f64) -> Attempt {
        let (mut laid, mut length) = (0, 0.0);
        for &edge in &order {
            let Some(path) = self.shortest(&self.task(edge), None) else {
                break;
            };
            length += self.path_length(&path);
            if length >= longest {
                break;
            }
            self.lay(edge, path);
            laid += 1;
        }
        let paths = self.lift_all();
        Attempt {
            order,
            laid,
            length,
            paths,
        }
    }

    /// Lays a path, splitting edges if others leave no way.
    fn lay_for_sure(&mut self, edge: usize) -> Result<(), BoundaryError> {
        for _ in 0..SPLIT_ROUNDS {
            let task = self.task(edge);
            if let Some(path) = self.shortest(&task, None) {
                self.lay(edge, path);
                return Ok(());
            }
            let blocked = self.blocked_edges(&task);
            if blocked.is_empty() {
                break;
            }
            self.split(&blocked);
        }
        let corners = EDGES[edge].map(usize::from);
        let vertices = corners.map(|corner| self.corners[corner]);
        Err(BoundaryError::NoRoute { corners, vertices })
    }

    fn lay(&mut self, edge: usize, path: Vec<u32>) {
        path[1..path.len() - 1]
            .iter()
            .for_each(|&v| self.owner[v as usize] = edge as u8);
        self.paths[edge] = path;
    }

    fn lift(&mut self, edge: usize) -> Vec<u32> {
        let path = std::mem::take(&mut self.paths[edge]);
        path[1..path.len() - 1]
            .iter()
            .for_each(|&v| self.owner[v as usize] = FREE);
        path
    }

    fn lift_all(&mut self) -> [Vec<u32>; 12] {
        for &vertex in self.paths.iter().flatten() {
            self.owner[vertex as usize] = FREE;
        }
        self.corners
            .iter()
            .for_each(|&v| self.owner[v as usize] = CORNER);
        std::mem::take(&mut self.paths)
    }

    fn path_length(&self, path: &[u32]) -> f64 {
        path.windows(2)
            .map(|step| self.length(step[0], step[1], None))
            .sum()
    }

    fn task(&self, edge: usize) -> Task {
        let [a, b] = EDGES[edge].map(usize::from);
        let ends = [self.corners[a], self.corners[b]];
        let [first, last] = [self.sector(a, b), self.sector(b, a)];
        let target = |half_edges: &[u32]| -> Vec<u32> {
            let topology = self.surface.topology();
            half_edges
                .iter()
                .map(|&half_edge| topology.target(half_edge))
                .collect()
        };
        // The first half-edge of a sector is a path's own, and the sector lies to its left.
        let doors = [
            target(&first.half_edges[first.walls..]),
            target(&last.half_edges[last.walls..]),
        ];
        let first_faces = first
            .half_edges
            .iter()
            .map(|half_edge| half_edge / 3)
            .collect();
        Task {
            ends,
            doors,
            first_faces,
        }
    }

    /// Returns the vertex after corner `from` on its path to corner `to`, if that is laid.
    fn first_step(&self, from: usize, to: usize) -> Option<u32> {
        let path = &self.paths[edge_between(from, to)?];
        let mut vertices: [Option<&u32>; 2] = [path.get(1), path.iter().rev().nth(1)];
        if from > to {
            vertices.reverse();
        }
        vertices[0].copied()
    }

    /// Returns where a path from corner `from` to corner `to` may leave.
    fn sector(&self, from: usize, to: usize) -> Sector {
        let ring = corner_ring(from);
        let at = ring.iter().position(|&other| other == to).unwrap_or(0);
        let topology = self.surface.topology();
        let around: Vec<u32> = topology.outgoing(self.corners[from]).collect();
        let place = |other: usize| {
            let step = self.first_step(from, other)?;
            around
                .iter()
                .position(|&half_edge| topology.target(half_edge) == step)
        };
        match (place(ring[(at + 2) % 3]), place(ring[(at + 1) % 3])) {
            (Some(before), Some(after)) => {
                let width = (after + around.len() - before) % around.len();
                let half_edges = (0..width)
                    .map(|k| around[(before + k) % around.len()])
                    .collect();
                Sector {
                    half_edges,
                    walls: 1,
                }
            }
            _ => Sector {
                half_edges: around,
                walls: 0,
            },
        }
    }

    /// Splits edges; new vertices are as easy to pass as the ends of their edges.
    fn split(&mut self, edges: &[[u32; 2]]) {
        for &[a, b] in edges {
            let [p, q] = [a, b].map(|v| self.ground[v as usize]);
            self.ground.push(0.5 * (p + q));
            self.owner.push(FREE);
        }
        self.splits.extend(edges);
        self.surface = split_surface(&self.surface, edges);
    }

    /// Lays all paths anew, the longest first, away from the others. Returns whether any moved.
    fn sweep(&mut self, options: &RoutingOptions) -> bool {
        let lengths = self.paths.iter().map(|path| self.path_length(path));
        let mut order: Vec<(f64, usize)> = lengths.zip(0..).collect();
        order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let mut moved = false;
        for (_, edge) in order {
            let factors = self.factors(edge, options);
            let old = self.lift(edge);
            let task = self.task(edge);
            let new = self
                .shortest(&task, Some(&factors))
                .unwrap_or_else(|| old.clone());
            moved |= new != old;
            self.lay(edge, new);
        }
        moved
    }
}
