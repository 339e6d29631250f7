//! The quad mesh that boxes imply: vertices, edges, and faces whose sides break where others end.

use std::collections::BTreeMap;

use msplines_common::bspline::EdgeUse;

use super::tile::{Tile, pole_at, pole_depth, zero_at};
use crate::complex::{Beyond, Border, CylinderComplex, Node, Point};
use crate::tmesh::TMesh;

/// What a vertex is: zeros and poles have several coordinates or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Spot {
    Node(Node),
    Zero(u32),
    Pole(u32),
}

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

/// Ends of boxes on lines: by cylinder and the coordinate across.
type Lines = BTreeMap<(u32, i64), Vec<i64>>;

/// A part of a side before vertices and edges have numbers.
struct Part {
    edge: (Node, u8),
    ends: [Spot; 2],
    range: [i64; 2],
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

/// Ends of boxes on the lines of a complex.
struct Ends {
    horizontal: Lines,
    vertical: Lines,
}

impl Ends {
    fn of(complex: &CylinderComplex, tiles: &[Tile]) -> Self {
        let mut ends = Self {
            horizontal: Lines::new(),
            vertical: Lines::new(),
        };
        for tile in tiles {
            let own = &complex.cylinders()[tile.cylinder as usize];
            for (x, y) in tile.x.into_iter().flat_map(|x| tile.y.map(|y| (x, y))) {
                let x = x.rem_euclid(own.circumference);
                let k = tile.cylinder;
                ends.vertical.entry((k, x)).or_default().push(y);
                ends.horizontal.entry((k, y)).or_default().push(x);
                // Both sides of a border break where either does.
                let borders = [(0, Border::Bottom), (own.height, Border::Top)];
                for (_, border) in borders.into_iter().filter(|b| b.0 == y) {
                    if let Ok(there) = complex.across(k, border, x) {
                        let key = (there.cylinder, there.y);
                        ends.horizontal.entry(key).or_default().push(there.x);
                    }
                }
            }
        }
        for line in ends
            .horizontal
            .values_mut()
            .chain(ends.vertical.values_mut())
        {
            line.sort_unstable();
            line.dedup();
        }
        ends
    }

    /// Returns the parts of a side, ascending; none if it is a pole.
    fn parts(&self, complex: &CylinderComplex, tile: &Tile, side: usize) -> Vec<Part> {
        let own = &complex.cylinders()[tile.cylinder as usize];
        let high = usize::from(side == 1 || side == 2);
        let axis = side % 2;
        let (range, line) = if axis == 0 {
            let y = tile.y[high];
            let depth = pole_depth(complex, tile.cylinder);
            if tile.leaf.is_none() && (y == -depth || y == own.height + depth) {
                return Vec::new();
            }
            (tile.x, self.horizontal.get(&(tile.cylinder, y)))
        } else {
            let x = tile.x[high].rem_euclid(own.circumference);
            (tile.y, self.vertical.get(&(tile.cylinder, x)))
        };
        let line = line.map_or(&[][..], Vec::as_slice);
        let inside =
            line.partition_point(|&c| c <= range[0])..line.partition_point(|&c| c < range[1]);
        let mut breaks = vec![range[0]];
        breaks.extend(line.get(inside).unwrap_or(&[]));
        breaks.push(range[1]);
        let at = |c: i64| {
            if axis == 0 {
                [c, tile.y[high]]
            } else {
                [tile.x[high], c]
            }
        };
        breaks
            .windows(2)
            .map(|pair| Part {
                edge: (
                    canonical(complex, tile.cylinder, at(pair[0]), axis),
                    axis as u8,
                ),
                ends: [pair[0], pair[1]].map(|c| spot(complex, tile.cylinder, at(c))),
                range: [pair[0], pair[1]],
            })
            .collect()
    }
}

/// Returns the lower end of an edge in the cylinder that it belongs to: the one above it, if it lies on a
/// border between two.
fn canonical(complex: &CylinderComplex, cylinder: u32, [x, y]: [i64; 2], axis: usize) -> Node {
    let own = &complex.cylinders()[cylinder as usize];
    if axis == 0 && y == own.height {
        return complex.node(cylinder, x, y);
    }
    let x = x.rem_euclid(own.circumference);
    Node { cylinder, x, y }
}

fn spot(complex: &CylinderComplex, cylinder: u32, at: [i64; 2]) -> Spot {
    let own = &complex.cylinders()[cylinder as usize];
    let depth = pole_depth(complex, cylinder);
    if let Some(zero) = zero_at(complex, cylinder, at) {
        return Spot::Zero(zero);
    }
    for (y, border) in [(-depth, Border::Bottom), (own.height + depth, Border::Top)] {
        if at[1] == y
            && let Some(pole) = pole_at(complex, cylinder, border)
        {
            return Spot::Pole(pole);
        }
    }
    if (0..=own.height).contains(&at[1]) {
        return Spot::Node(complex.node(cylinder, at[0], at[1]));
    }
    Spot::Node(Node {
        cylinder,
        x: at[0].rem_euclid(own.circumference),
        y: at[1],
    })
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
