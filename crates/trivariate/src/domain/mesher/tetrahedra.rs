//! All lattice tetrahedra, whole or cut.

use msplines_common::mesh::NONE;
use msplines_common::mesh::tet::{dihedral_angles, signed_volume};
use nalgebra::Point3;

use super::grid::{Grid, direction};
use super::stencils::{Corner, Pieces, pieces};
use super::warp::Warped;

/// What a vertex of the solid comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Origin {
    /// A lattice point inside.
    Inside,
    /// A lattice point that was moved onto the boundary.
    Moved(u32),
    /// A cut of a lattice edge between these points.
    Cut([u32; 2]),
}

/// Tetrahedra inside, in the order of the lattice.
pub(super) struct Tetrahedra {
    pub(super) positions: Vec<Point3<f64>>,
    pub(super) origins: Vec<Origin>,
    pub(super) cells: Vec<[u32; 4]>,
}

/// Returns the inside of all lattice tetrahedra; every cell is positive.
pub(super) fn tetrahedra(grid: &Grid, warped: &Warped) -> Tetrahedra {
    let mut builder = Builder::new(grid, warped);
    let [nx, ny, nz] = grid.size;
    for k in (0..=nz).step_by(2) {
        for j in (0..=ny).step_by(2) {
            for i in (0..=nx).step_by(2) {
                for axis in 0..3 {
                    builder.around_edge([i, j, k], axis);
                }
            }
        }
    }
    builder.out
}

struct Builder<'a> {
    grid: &'a Grid,
    warped: &'a Warped,
    /// First cut of each lattice point as a lower end.
    first_cut: Vec<u32>,
    point_vertex: Vec<u32>,
    cut_vertex: Vec<u32>,
    out: Tetrahedra,
}

impl<'a> Builder<'a> {
    fn new(grid: &'a Grid, warped: &'a Warped) -> Self {
        let mut first_cut = vec![NONE; grid.point_count()];
        for (number, cut) in warped.cuts.iter().enumerate().rev() {
            first_cut[cut.ends[0] as usize] = number as u32;
        }
        Self {
            grid,
            warped,
            first_cut,
            point_vertex: vec![NONE; grid.point_count()],
            cut_vertex: vec![NONE; warped.cuts.len()],
            out: Tetrahedra {
                positions: Vec::new(),
                origins: Vec::new(),
                cells: Vec::new(),
            },
        }
    }

    /// Adds the four tetrahedra around the long edge from an even lattice point along an axis.
    fn around_edge(&mut self, from: [i32; 3], axis: usize) {
        let [b, c] = [(axis + 1) % 3, (axis + 2) % 3];
        let size = self.grid.size;
        // At the end of the lattice everything is outside.
        if from[axis] == size[axis] || [b, c].iter().any(|&x| from[x] == 0 || from[x] == size[x]) {
            return;
        }
        let mut to = from;
        to[axis] += 2;
        let ring = [[1, 1], [-1, 1], [-1, -1], [1, -1]].map(|[x, y]| {
            let mut at = from;
            at[axis] += 1;
            at[b] += x;
            at[c] += y;
            at
        });
        let value = |at: [i32; 3]| self.warped.values[self.grid.id(at) as usize];
        let (ends, around) = ([from, to].map(value), ring.map(value));
        if ends.iter().chain(&around).all(|&value| value <= 0) {
            return;
        }
        for first in 0..4 {
            let second = (first + 1) % 4;
            let values = [ends[0], ends[1], around[first], around[second]];
            if values.iter().any(|&value| value > 0) {
                self.add([from, to, ring[first], ring[second]], values);
            }
        }
    }

    fn add(&mut self, at: [[i32; 3]; 4], values: [i8; 4]) {
        let corners: [Corner; 4] = std::array::from_fn(|i| Corner {
            point: self.grid.id(at[i]),
            odd: at[i][0] % 2 != 0,
            value: values[i],
            vertex: if values[i] < 0 {
                NONE
            } else {
                self.vertex(at[i])
            },
        });
        if values.iter().all(|&value| value >= 0) {
            self.push(corners.map(|corner| corner.vertex));
            return;
        }
        // The vertices of cuts between each corner inside and each outside.
        let mut cuts = [[NONE; 4]; 4];
        for i in 0..4 {
            for j in (0..4).filter(|&j| values[i] > 0 && values[j] < 0) {
                cuts[i][j] = self.cut(at[i], at[j]);
            }
        }
        let place = |corner: &Corner| corners.iter().position(|c| c.point == corner.point);
        let cut = |inside: &Corner, outside: &Corner| match (place(inside), place(outside)) {
            (Some(i), Some(j)) => cuts[i][j],
            _ => NONE,
        };
        let found = pieces(&corners, cut, |one, two| self.worst(one) <= self.worst(two));
        for &cell in found.cells() {
            self.push(cell);
        }
    }

    /// Returns how far the worst angle of some tetrahedra is from a right one.
    fn worst(&self, pieces: &Pieces) -> f64 {
        let cells = pieces.cells().iter();
        let corners = cells.map(|cell| cell.map(|v| self.out.positions[v as usize]));
        let angles = corners.flat_map(|corners| dihedral_angles(&corners));
        angles.fold(0.0, |worst: f64, angle| {
            worst.max((angle - std::f64::consts::FRAC_PI_2).abs())
        })
    }

    /// Appends a cell, positively oriented: none is flat, so that rounding cannot matter.
    fn push(&mut self, mut cell: [u32; 4]) {
        if signed_volume(&cell.map(|v| self.out.positions[v as usize])) < 0.0 {
            cell.swap(2, 3);
        }
        self.out.cells.push(cell);
    }

    fn vertex(&mut self, at: [i32; 3]) -> u32 {
        let point = self.grid.id(at);
        if self.point_vertex[point as usize] == NONE {
            self.point_vertex[point as usize] = self.out.positions.len() as u32;
            let moved = &self.warped.moved;
            let (position, origin) = match moved.binary_search_by_key(&point, |&(p, _)| p) {
                Ok(place) => {
                    let cut = moved[place].1;
                    let lower = self.grid.coordinates(cut.ends[0]);
                    let position = self.grid.position(lower, cut.direction, cut.fraction);
                    (position, Origin::Moved(point))
                }
                Err(_) => (self.grid.point(at), Origin::Inside),
            };
            self.out.positions.push(position);
            self.out.origins.push(origin);
        }
        self.point_vertex[point as usize]
    }

    fn cut(&mut self, inside: [i32; 3], outside: [i32; 3]) -> u32 {
        let (direction, upwards) = direction(inside, outside);
        let lower = if upwards { inside } else { outside };
        let first = self.first_cut[self.grid.id(lower) as usize] as usize;
        // At most one cut per direction has this lower end.
        let number = first
            + self.warped.cuts[first..]
                .iter()
                .take_while(|cut| cut.direction != direction)
                .count();
        if self.cut_vertex[number] == NONE {
            let cut = self.warped.cuts[number];
            self.cut_vertex[number] = self.out.positions.len() as u32;
            let position = self.grid.position(lower, direction, cut.fraction);
            self.out.positions.push(position);
            self.out.origins.push(Origin::Cut(cut.ends));
        }
        self.cut_vertex[number]
    }
}
