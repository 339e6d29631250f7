//! The quad mesh that boxes imply: vertices, edges, and faces whose sides break where others end.

mod ends;

use msplines_common::bspline::EdgeUse;

use ends::{Ends, Part, Spot, spot};

use super::tile::Tile;
use crate::complex::{Beyond, CylinderComplex, Node, Point};
use crate::tmesh::TMesh;

/// A vertex of the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// Where it lies.
    pub point: Point,
    /// The zero of the form that it is.
    pub zero: Option<u32>,
    /// How many edges end here.
    pub valence: u32,
    /// Whether an edge ends here on the side of a face.
    pub is_t_junction: bool,
    /// A face with a corner here, and which of its four.
    pub(super) corner: (u32, u8),
}

/// An edge of the mesh, straight in its cylinder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// Vertices at its lower and at its upper end.
    pub ends: [u32; 2],
    /// Its lower end, in the cylinder in which it lies.
    pub start: Node,
    /// 0 if it runs along `x`, 1 along `y`.
    pub axis: u8,
    /// Its length, in units.
    pub length: i64,
}

/// A part of a side of a face, one edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SidePart {
    /// The edge, and whether the face runs along it from its upper to its lower end.
    pub edge: EdgeUse,
    /// Its ends along the side, in the coordinates of the face, ascending.
    pub range: [i64; 2],
}

/// A face of the mesh.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Face {
    /// Its sides, counterclockwise from the lower one, each in the direction of the way around.
    pub sides: [Vec<SidePart>; 4],
}

/// An explicit mesh of boxes. Faces are in the order of the leaves.
#[derive(Clone, Debug, PartialEq)]
pub struct QuadMesh {
    vertices: Vec<Vertex>,
    edges: Vec<Edge>,
    faces: Vec<Face>,
    ends: usize,
}

impl QuadMesh {
    /// Returns the mesh whose faces are the leaves of a T-mesh, with sides broken at T-junctions.
    ///
    /// Cost: `O(n log n)` for `n` leaves.
    #[must_use]
    pub fn of_leaves(mesh: &TMesh) -> Self {
        let leaves = mesh.leaves().iter().enumerate();
        let tiles: Vec<Tile> = leaves
            .map(|(leaf, own)| Tile {
                cylinder: own.cylinder,
                x: own.x,
                y: own.y,
                leaf: Some(leaf as u32),
            })
            .collect();
        Self::of_tiles(mesh.complex(), &tiles)
    }

    pub(super) fn of_tiles(complex: &CylinderComplex, tiles: &[Tile]) -> Self {
        let lines = Ends::of(complex, tiles);
        let sides: Vec<[Vec<Part>; 4]> = tiles
            .iter()
            .map(|tile| [0, 1, 2, 3].map(|side| lines.parts(complex, tile, side)))
            .collect();
        let parts = || sides.iter().flatten().flatten();
        let mut spots: Vec<Spot> = parts().flat_map(|part| part.ends).collect();
        spots.sort_unstable();
        spots.dedup();
        let number = |spot: &Spot| spots.binary_search(spot).expect("listed") as u32;
        let mut keys: Vec<(Node, u8)> = parts().map(|part| part.edge).collect();
        keys.sort_unstable();
        keys.dedup();
        let edge = |key: &(Node, u8)| keys.binary_search(key).expect("listed") as u32;
        let mut edges: Vec<Option<Edge>> = vec![None; keys.len()];
        for part in parts() {
            edges[edge(&part.edge) as usize].get_or_insert(Edge {
                ends: [number(&part.ends[0]), number(&part.ends[1])],
                start: part.edge.0,
                axis: part.edge.1,
                length: part.range[1] - part.range[0],
            });
        }
        let edges: Vec<Edge> = edges.into_iter().flatten().collect();
        let faces: Vec<Face> = sides
            .iter()
            .map(|sides| Face {
                sides: [0, 1, 2, 3].map(|side| face_side(&sides[side], side, edge)),
            })
            .collect();
        let corners = corners(complex, tiles, &number, spots.len());
        let vertices = vertices(&spots, &corners, tiles, &edges, &faces);
        let leaves = tiles.iter().all(|tile| tile.leaf.is_some());
        Self {
            vertices,
            edges,
            faces,
            ends: if leaves { pole_ends(complex) } else { 0 },
        }
    }

    /// Returns the vertices.
    #[must_use]
    pub fn vertices(&self) -> &[Vertex] {
        &self.vertices
    }

    /// Returns the edges.
    #[must_use]
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// Returns the faces.
    #[must_use]
    pub fn faces(&self) -> &[Face] {
        &self.faces
    }

    /// Returns the vertices around a face, counterclockwise, those in the middle of sides too.
    ///
    /// # Panics
    /// If there is no such face.
    #[must_use]
    pub fn around(&self, face: u32) -> Vec<u32> {
        let parts = self.faces[face as usize].sides.iter().flatten();
        let start = |part: &SidePart| {
            let ends = self.edges[part.edge.edge as usize].ends;
            ends[usize::from(part.edge.reversed)]
        };
        parts.map(start).collect()
    }

    /// Returns the number of T-junctions.
    #[must_use]
    pub fn t_junctions(&self) -> usize {
        self.vertices.iter().filter(|v| v.is_t_junction).count()
    }

    /// Returns the vertices at zeros of the form.
    pub fn extraordinary(&self) -> impl Iterator<Item = &Vertex> {
        self.vertices.iter().filter(|v| v.zero.is_some())
    }

    /// Returns Euler's characteristic, `2 - 2 g` less the number of boundaries; the end of a cylinder that
    /// closes around a pole counts as a face.
    #[must_use]
    pub fn characteristic(&self) -> i64 {
        let [v, e, f] = [self.vertices.len(), self.edges.len(), self.faces.len()];
        v as i64 - e as i64 + (f + self.ends) as i64
    }

    /// Returns an edge as a polyline of `segments` segments, at least one, for drawing.
    ///
    /// # Panics
    /// If there is no such edge.
    #[must_use]
    pub fn polyline(&self, edge: u32, segments: usize) -> Vec<Point> {
        let edge = &self.edges[edge as usize];
        let ends = [edge.ends[0], edge.ends[1]];
        let start = Point::from(edge.start);
        let count = segments.max(1);
        (0..=count)
            .map(|k| {
                if k == count {
                    return self.vertices[ends[1] as usize].point;
                }
                let way = edge.length as f64 * (k as f64 / count as f64);
                match edge.axis {
                    0 => Point {
                        x: start.x + way,
                        ..start
                    },
                    _ => Point {
                        y: start.y + way,
                        ..start
                    },
                }
            })
            .collect()
    }
}

fn face_side(parts: &[Part], side: usize, edge: impl Fn(&(Node, u8)) -> u32) -> Vec<SidePart> {
    let reversed = side >= 2;
    let mut found: Vec<SidePart> = parts
        .iter()
        .map(|part| SidePart {
            edge: EdgeUse {
                edge: edge(&part.edge),
                reversed,
            },
            range: part.range,
        })
        .collect();
    if reversed {
        found.reverse();
    }
    found
}

/// Returns for every vertex the first tile with a corner there, which of them, and its coordinates.
fn corners(
    complex: &CylinderComplex,
    tiles: &[Tile],
    number: &impl Fn(&Spot) -> u32,
    vertices: usize,
) -> Vec<(u32, u8)> {
    let mut corners = vec![(u32::MAX, 0); vertices];
    for (face, tile) in tiles.iter().enumerate() {
        let around = [[0, 0], [1, 0], [1, 1], [0, 1]];
        for (corner, [i, j]) in around.into_iter().enumerate() {
            let vertex = number(&spot(complex, tile.cylinder, [tile.x[i], tile.y[j]]));
            let first = &mut corners[vertex as usize];
            if first.0 == u32::MAX {
                *first = (face as u32, corner as u8);
            }
        }
    }
    corners
}

fn vertices(
    spots: &[Spot],
    corners: &[(u32, u8)],
    tiles: &[Tile],
    edges: &[Edge],
    faces: &[Face],
) -> Vec<Vertex> {
    let vertex = |(spot, &corner): (&Spot, &(u32, u8))| {
        let tile = &tiles[corner.0 as usize];
        let [i, j] = [[0, 0], [1, 0], [1, 1], [0, 1]][usize::from(corner.1)];
        let own = Node {
            cylinder: tile.cylinder,
            x: tile.x[i],
            y: tile.y[j],
        };
        let (node, zero) = match *spot {
            Spot::Node(node) => (node, None),
            Spot::Zero(zero) => (own, Some(zero)),
            Spot::Pole(_) => (own, None),
        };
        Vertex {
            point: Point::from(node),
            zero,
            valence: 0,
            is_t_junction: false,
            corner,
        }
    };
    let mut vertices: Vec<Vertex> = spots.iter().zip(corners).map(vertex).collect();
    for end in edges.iter().flat_map(|edge| edge.ends) {
        vertices[end as usize].valence += 1;
    }
    for side in faces.iter().flat_map(|face| &face.sides) {
        for part in side.iter().skip(1) {
            let ends = edges[part.edge.edge as usize].ends;
            let start = ends[usize::from(part.edge.reversed)];
            vertices[start as usize].is_t_junction = true;
        }
    }
    vertices
}

/// Returns how many borders close around poles.
fn pole_ends(complex: &CylinderComplex) -> usize {
    let borders = complex.cylinders().iter().flat_map(|c| [&c.bottom, &c.top]);
    let pole = |border: &&Vec<crate::complex::Segment>| {
        matches!(border.first().map(|s| s.beyond), Some(Beyond::Pole { .. }))
    };
    borders.filter(pole).count()
}
