//! The quads of a network, and the piece of curve along each of their edges.
//!
//! # Notation
//! A side is a piece of an arc between two vertices of the polygons. Arcs are pieces of their own
//! unless the polygons would have two edges between the same vertices.

use std::collections::BTreeMap;

use msplines_common::mesh::TopologyError;
use msplines_common::mesh::polygon::PolygonMesh;
use nalgebra::{Point3, Vector3};

use super::cycles::{Cycle, Cycles, repeated};
use super::error::NetworkError;
use super::graph::CurveGraph;

/// What a vertex of the domain is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DomainVertex {
    /// A junction of the network.
    Junction(u32),
    /// A point of an arc.
    OnArc {
        /// The arc.
        arc: u32,
        /// Its arc length from the start of the arc.
        length: f64,
    },
    /// The centre of a patch that is no quad.
    Centre {
        /// The cycle around the patch.
        cycle: u32,
    },
}

/// The piece of curve along an edge of the domain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeCurve {
    /// The arc.
    pub arc: u32,
    /// Arc lengths from the start of the arc, at the first and the second vertex of the edge; they
    /// descend where the edge runs against the arc.
    pub interval: [f64; 2],
    /// Whether the surface has a crease along it.
    pub crease: bool,
}

/// A mesh of quads whose edges follow a network.
#[derive(Clone, Debug)]
pub struct NetworkDomain {
    /// The quads; centres lie at the mean of what is around them.
    pub mesh: PolygonMesh,
    /// The curve along every edge of the mesh, none along spokes to centres.
    pub curves: Vec<Option<EdgeCurve>>,
    /// What every vertex of the mesh is.
    pub vertices: Vec<DomainVertex>,
    /// The cycle that every face of the mesh lies in.
    pub cycles: Vec<u32>,
    /// Whether patches were split, since not all were quads.
    pub split: bool,
    /// Arcs with holes on both sides, which the surface does not follow.
    pub unused_arcs: Vec<u32>,
}

impl NetworkDomain {
    /// Returns the domain of the patches of a network. If all are quads, they are its faces.
    /// Otherwise every arc is cut in the middle of its length, and a patch of `n` arcs becomes `n`
    /// quads around its centre.
    ///
    /// # Reference
    /// [Wang2016] §4.3. Deviation: patches need not be quads, and arcs may join the same junctions.
    ///
    /// # Errors
    /// No patch; a patch that passes a junction twice; patches that do not form one fan at a
    /// junction, or no surface for another reason.
    pub fn build(graph: &CurveGraph, cycles: &Cycles) -> Result<Self, NetworkError> {
        let patch = |pair: &(usize, &Cycle)| !pair.1.hole;
        let patches: Vec<(usize, &Cycle)> = cycles.list.iter().enumerate().filter(patch).collect();
        if patches.is_empty() {
            let holes = cycles.list.len();
            return Err(NetworkError::NoPatch { holes });
        }
        for (_, cycle) in &patches {
            if let Some(v) = repeated(graph, cycle) {
                let junction = &graph.junctions()[v as usize];
                return Err(NetworkError::NoDisc {
                    corners: cycle.half_edges.len(),
                    point: junction.point,
                    position: junction.position,
                });
            }
        }
        let mut builder = Builder::new(graph, &patches);
        let mut polygons = Vec::with_capacity(patches.len());
        for (index, cycle) in &patches {
            polygons.push((*index as u32, builder.polygon(cycle)));
        }
        let split = polygons.iter().any(|(_, corners)| corners.len() != 4);
        let (faces, face_cycles) = if split {
            builder.split(&polygons)
        } else {
            let quad = |c: &[u32]| [c[0], c[1], c[2], c[3]];
            let faces = polygons.iter().map(|(_, corners)| quad(corners)).collect();
            (faces, polygons.iter().map(|pair| pair.0).collect())
        };
        builder.finish(&faces, face_cycles, split)
    }
}

/// Numbers vertices and remembers the curves between them.
struct Builder<'a> {
    graph: &'a CurveGraph,
    vertices: Vec<DomainVertex>,
    positions: Vec<Point3<f64>>,
    junctions: BTreeMap<u32, u32>,
    /// The vertices along every arc, ends included, with their arc lengths.
    along: Vec<Vec<(u32, f64)>>,
    unused_arcs: Vec<u32>,
}

impl<'a> Builder<'a> {
    fn new(graph: &'a CurveGraph, patches: &[(usize, &Cycle)]) -> Self {
        let mut used = vec![false; graph.arcs().len()];
        for h in patches.iter().flat_map(|(_, cycle)| &cycle.half_edges) {
            used[*h as usize / 2] = true;
        }
        let unused = (0..used.len()).filter(|&arc| !used[arc]);
        let mut builder = Self {
            graph,
            vertices: Vec::new(),
            positions: Vec::new(),
            junctions: BTreeMap::new(),
            along: vec![Vec::new(); graph.arcs().len()],
            unused_arcs: unused.map(|arc| arc as u32).collect(),
        };
        for (v, junction) in graph.junctions().iter().enumerate() {
            if junction.half_edges.iter().any(|&h| used[h as usize / 2]) {
                let id = builder.vertex(DomainVertex::Junction(v as u32), junction.position);
                builder.junctions.insert(v as u32, id);
            }
        }
        let mut joined = BTreeMap::new();
        for (arc, _) in used.iter().enumerate().filter(|pair| *pair.1) {
            let [v, w] = graph.arcs()[arc].ends;
            let times: &mut u32 = joined.entry([v.min(w), v.max(w)]).or_default();
            // Edges need two vertices each, and no other edge between them.
            let pieces = match (v == w, *times) {
                (true, _) => 3,
                (false, 0) => 1,
                (false, _) => 2,
            };
            *times += 1;
            builder.cut(arc as u32, pieces);
        }
        builder
    }

    fn vertex(&mut self, vertex: DomainVertex, position: Point3<f64>) -> u32 {
        self.vertices.push(vertex);
        self.positions.push(position);
        self.vertices.len() as u32 - 1
    }

    fn on_arc(&mut self, arc: u32, length: f64) -> (u32, f64) {
        let position = self.graph.arcs()[arc as usize].shape.point(length);
        let vertex = self.vertex(DomainVertex::OnArc { arc, length }, position);
        (vertex, length)
    }

    fn cut(&mut self, arc: u32, pieces: u32) {
        let ends = self.graph.arcs()[arc as usize]
            .ends
            .map(|v| self.junctions[&v]);
        let length = self.graph.arcs()[arc as usize].shape.length();
        let mut along = vec![(ends[0], 0.0)];
        for i in 1..pieces {
            along.push(self.on_arc(arc, length * f64::from(i) / f64::from(pieces)));
        }
        along.push((ends[1], length));
        self.along[arc as usize] = along;
    }

    /// Returns the vertices around a cycle.
    fn polygon(&self, cycle: &Cycle) -> Vec<u32> {
        let mut corners = Vec::with_capacity(cycle.half_edges.len());
        for &h in &cycle.half_edges {
            let along = &self.along[h as usize / 2];
            let to_last = along.len() - 1;
            if h % 2 == 0 {
                corners.extend(along[..to_last].iter().map(|pair| pair.0));
            } else {
                corners.extend(along[1..].iter().rev().map(|pair| pair.0));
            }
        }
        corners
    }

    /// Cuts every side in its middle and every polygon from its centre to there.
    fn split(&mut self, polygons: &[(u32, Vec<u32>)]) -> (Vec<[u32; 4]>, Vec<u32>) {
        let mut middles = BTreeMap::new();
        for arc in 0..self.along.len() as u32 {
            let mut finer = Vec::new();
            for pair in self.along[arc as usize].clone().windows(2) {
                let middle = self.on_arc(arc, 0.5 * (pair[0].1 + pair[1].1));
                middles.insert(key(pair[0].0, pair[1].0), middle.0);
                finer.extend([pair[0], middle]);
            }
            finer.extend(self.along[arc as usize].last().copied());
            self.along[arc as usize] = finer;
        }
        let mut faces = Vec::new();
        let mut cycles = Vec::new();
        for (cycle, corners) in polygons {
            let count = corners.len();
            let middle = |i: usize| middles[&key(corners[i % count], corners[(i + 1) % count])];
            let around = (0..count).flat_map(|i| [corners[i], middle(i)]);
            let sum: Vector3<f64> = around.map(|v| self.positions[v as usize].coords).sum();
            let mean = Point3::from(sum / (2 * count) as f64);
            let centre = self.vertex(DomainVertex::Centre { cycle: *cycle }, mean);
            for (i, &corner) in corners.iter().enumerate() {
                faces.push([corner, middle(i), centre, middle(i + count - 1)]);
                cycles.push(*cycle);
            }
        }
        (faces, cycles)
    }

    fn finish(
        self,
        faces: &[[u32; 4]],
        cycles: Vec<u32>,
        split: bool,
    ) -> Result<NetworkDomain, NetworkError> {
        let mesh = PolygonMesh::from_quads(self.positions, faces);
        let mesh = mesh.map_err(|error| told(error, self.graph, &self.vertices))?;
        let mut between = BTreeMap::new();
        for (arc, along) in self.along.iter().enumerate() {
            for pair in along.windows(2) {
                let ((a, from), (b, to)) = (pair[0], pair[1]);
                between.insert([a, b], (arc as u32, [from, to]));
                between.insert([b, a], (arc as u32, [to, from]));
            }
        }
        let curve = |edge: u32| {
            let (arc, interval) = *between.get(&mesh.topology().edge_vertices(edge))?;
            let crease = self.graph.arcs()[arc as usize].crease;
            Some(EdgeCurve {
                arc,
                interval,
                crease,
            })
        };
        let curves = (0..mesh.topology().edge_count() as u32)
            .map(curve)
            .collect();
        Ok(NetworkDomain {
            mesh,
            curves,
            vertices: self.vertices,
            cycles,
            split,
            unused_arcs: self.unused_arcs,
        })
    }
}

fn key(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// Returns an error of the mesh in terms of the network.
fn told(error: TopologyError, graph: &CurveGraph, vertices: &[DomainVertex]) -> NetworkError {
    if let TopologyError::VertexNotManifold { vertex } = error
        && let Some(DomainVertex::Junction(v)) = vertices.get(vertex as usize)
    {
        let junction = &graph.junctions()[*v as usize];
        return NetworkError::SeveralFans {
            point: junction.point,
            position: junction.position,
        };
    }
    error.into()
}
