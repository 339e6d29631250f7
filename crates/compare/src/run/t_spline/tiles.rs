//! A T-spline as triangles along the lines of a T-mesh, for pictures.

use std::collections::BTreeSet;

use msplines_common::evaluate::Order;
use msplines_common::mesh::{TriangleMesh, VertexAttribute};
use msplines_common::{Point3, Vector3};
use msplines_t_spline::complex::{Beyond, Border, CylinderComplex, Point};
use msplines_t_spline::tmesh::Leaf;
use msplines_t_spline::{TMesh, TSpline};

use crate::output::NORMALS;
use crate::run::Companion;

/// Fewest and most segments along a side of a face.
const SEGMENTS: [f64; 2] = [4.0, 100.0];
/// Points along a side by which its length is found.
const MEASURED: usize = 7;
/// Points of a face lie so far inside of it, as a share of its size: at zeros there are no derivatives.
const INSIDE: f64 = 1e-7;
/// Radius at which what closes a pole ends, over that of its border.
const CENTRE: f64 = 1e-6;

/// What a side of a tile is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Line {
    /// Nothing, or drawn by the tile on its other side.
    None,
    /// A curve of the T-mesh.
    Curve,
    /// A part of the critical graph.
    Critical,
}

/// Which lines of a T-mesh are drawn.
#[derive(Clone, Copy)]
pub(super) enum Lines<'a> {
    /// All.
    All,
    /// Those that were there before faces were split: in every cylinder a grid.
    Grid(&'a TMesh),
}

impl Lines<'_> {
    /// Returns the columns and rows that are drawn, by cylinder; nothing if all are.
    fn drawn(self) -> [Option<BTreeSet<(u32, i64)>>; 2] {
        let Self::Grid(grid) = self else {
            return [None, None];
        };
        let ends = |low: fn(&Leaf) -> i64| {
            let leaves = grid.leaves().iter();
            Some(leaves.map(|leaf| (leaf.cylinder, low(leaf))).collect())
        };
        [ends(|leaf| leaf.x[0]), ends(|leaf| leaf.y[0])]
    }
}

/// A grid of points on a cylinder.
struct Tile {
    cylinder: u32,
    columns: Vec<f64>,
    rows: Vec<f64>,
    bottom: Line,
    left: Line,
    top: Line,
}

/// Triangles along the lines of a T-mesh.
pub(super) struct Tiled {
    positions: Vec<Point3<f64>>,
    normals: Vec<Vector3<f64>>,
    /// The cylinder of every point.
    pub(super) cylinders: Vec<u32>,
    faces: Vec<[u32; 3]>,
    curves: Vec<[u32; 2]>,
    critical: Vec<[u32; 2]>,
}

impl Tiled {
    /// Returns a surface along the lines of its T-mesh, in triangles with sides of about `reach`.
    pub(super) fn on_surface(spline: &TSpline, lines: Lines<'_>, reach: f64) -> Self {
        let mesh = spline.space().mesh();
        let mut tiles = leaves(mesh, lines, &sides(spline, mesh), reach);
        tiles.extend(around_poles(spline, mesh.complex(), reach));
        Self::of(&tiles, |points| {
            let found = spline.evaluate(points, Order::First);
            let normal = |[a, b]: &[Vector3<f64>; 2]| a.cross(b).normalize();
            let normals = found.first.iter().map(normal).collect();
            (found.positions, normals)
        })
    }

    /// Returns how far the surface reaches out of a box.
    pub(super) fn beyond(&self, [low, high]: [Point3<f64>; 2]) -> f64 {
        let out = |p: &Point3<f64>| (low - p).max().max((p - high).max());
        self.positions.iter().map(out).fold(0.0, f64::max)
    }

    /// Returns the cylinders cut open and laid into a plane, side by side in rows, in units of the form.
    pub(super) fn flat(mesh: &TMesh) -> Self {
        let complex = mesh.complex();
        let unit = (complex.area() as f64).sqrt();
        let origins = origins(complex, unit);
        let one = vec![[1.0; 2]; mesh.leaves().len()];
        let tiles = leaves(mesh, Lines::All, &one, 1.0);
        Self::of(&tiles, |points| {
            let place = |point: &Point| {
                let [x, y] = origins[point.cylinder as usize];
                Point3::new(x + point.x / unit, y + point.y / unit, 0.0)
            };
            let positions: Vec<Point3<f64>> = points.iter().map(place).collect();
            let normals = vec![Vector3::z(); positions.len()];
            (positions, normals)
        })
    }

    fn of(
        tiles: &[Tile],
        place: impl Fn(&[Point]) -> (Vec<Point3<f64>>, Vec<Vector3<f64>>),
    ) -> Self {
        let mut points = Vec::new();
        let mut tiled = Self {
            positions: Vec::new(),
            normals: Vec::new(),
            cylinders: Vec::new(),
            faces: Vec::new(),
            curves: Vec::new(),
            critical: Vec::new(),
        };
        for tile in tiles {
            tiled.add(tile, points.len() as u32);
            let cylinder = tile.cylinder;
            let row = |&y: &f64| tile.columns.iter().map(move |&x| Point { cylinder, x, y });
            points.extend(tile.rows.iter().flat_map(row));
        }
        tiled.cylinders = points.iter().map(|point| point.cylinder).collect();
        (tiled.positions, tiled.normals) = place(&points);
        tiled
    }

    /// Adds the triangles and lines of a tile whose points begin at `first`.
    fn add(&mut self, tile: &Tile, first: u32) {
        let [columns, rows] = [tile.columns.len() as u32, tile.rows.len() as u32];
        let at = |i: u32, j: u32| first + j * columns + i;
        for (i, j) in (1..rows).flat_map(|j| (1..columns).map(move |i| (i, j))) {
            let [a, b, c, d] = [at(i - 1, j - 1), at(i, j - 1), at(i, j), at(i - 1, j)];
            self.faces.extend([[a, b, c], [a, c, d]]);
        }
        let along_x = |j: u32| (1..columns).map(move |i| [at(i - 1, j), at(i, j)]);
        let along_y = (1..rows).map(|j| [at(0, j - 1), at(0, j)]);
        self.line(tile.bottom, along_x(0));
        self.line(tile.top, along_x(rows - 1));
        self.line(tile.left, along_y);
    }

    fn line(&mut self, line: Line, pieces: impl Iterator<Item = [u32; 2]>) {
        match line {
            Line::None => {}
            Line::Curve => self.curves.extend(pieces),
            Line::Critical => self.critical.extend(pieces),
        }
    }

    /// Returns what pictures are drawn from: with exact normals, and what else it carries.
    pub(super) fn companion(self, name: &'static str, fields: Vec<VertexAttribute>) -> Companion {
        let component = |(name, axis): (&str, usize)| VertexAttribute {
            name: name.to_owned(),
            values: self.normals.iter().map(|n| n[axis]).collect(),
        };
        let normals = NORMALS.into_iter().zip(0..).map(component);
        Companion {
            name,
            fields: normals.chain(fields).collect(),
            mesh: TriangleMesh::build(self.positions, self.faces).ok(),
            edges: self.curves,
            creases: self.critical,
        }
    }
}

/// Returns the leaves of a mesh with `sizes` along `x` and `y` in pieces of about `reach`.
fn leaves(mesh: &TMesh, lines: Lines<'_>, sizes: &[[f64; 2]], reach: f64) -> Vec<Tile> {
    let complex = mesh.complex();
    let [columns, rows] = lines.drawn();
    let line = |known: &Option<BTreeSet<(u32, i64)>>, key: (u32, i64)| {
        let is_drawn = known.as_ref().is_none_or(|known| known.contains(&key));
        if is_drawn { Line::Curve } else { Line::None }
    };
    let tile = |(leaf, size): (&Leaf, &[f64; 2])| {
        let own = &complex.cylinders()[leaf.cylinder as usize];
        let spaced = |range: [i64; 2], size: f64| {
            let count = (size / reach).ceil().clamp(SEGMENTS[0], SEGMENTS[1]) as u32;
            spread(range.map(|end| end as f64), count)
        };
        let beyond = |border, x| complex.segment(leaf.cylinder, border, x).beyond;
        let is_open = |border| !matches!(beyond(border, leaf.x[0]), Beyond::Cylinder { .. });
        let is_critical = |border| {
            let mut segments = complex.border(leaf.cylinder, border).iter();
            segments.any(|segment| segment.zero.is_some())
        };
        Tile {
            cylinder: leaf.cylinder,
            columns: spaced(leaf.x, size[0]),
            rows: spaced(leaf.y, size[1]),
            bottom: if leaf.y[0] == 0 && is_critical(Border::Bottom) {
                Line::Critical
            } else {
                line(&rows, (leaf.cylinder, leaf.y[0]))
            },
            left: line(&columns, (leaf.cylinder, leaf.x[0])),
            // Below another tile it is that one's lower side.
            top: if leaf.y[1] == own.height && is_open(Border::Top) {
                Line::Curve
            } else {
                Line::None
            },
        }
    };
    mesh.leaves().iter().zip(sizes).map(tile).collect()
}

/// Returns `count + 1` numbers from one end of a range to the other, all of them inside.
fn spread([low, high]: [f64; 2], count: u32) -> Vec<f64> {
    let share = |i| (f64::from(i) / f64::from(count)).clamp(INSIDE, 1.0 - INSIDE);
    (0..=count).map(|i| low + (high - low) * share(i)).collect()
}

/// Returns the lengths of every leaf on the surface along `x` and `y`.
fn sides(spline: &TSpline, mesh: &TMesh) -> Vec<[f64; 2]> {
    let grid = |leaf: &Leaf| {
        let ranges = [leaf.x, leaf.y].map(|range| range.map(|end| end as f64));
        let [columns, rows] = ranges.map(|range| spread(range, MEASURED as u32 - 1));
        let cylinder = leaf.cylinder;
        let row = |y: f64| {
            columns
                .clone()
                .into_iter()
                .map(move |x| Point { cylinder, x, y })
        };
        rows.into_iter().flat_map(row).collect::<Vec<Point>>()
    };
    let points: Vec<Point> = mesh.leaves().iter().flat_map(grid).collect();
    let positions = spline.evaluate(&points, Order::Value).positions;
    let longest = |own: &[Point3<f64>]| {
        let length = |from: usize, step: usize| {
            let way =
                (1..MEASURED).map(|i| (own[from + i * step] - own[from + (i - 1) * step]).norm());
            way.sum::<f64>()
        };
        let most = |step: usize, across: usize| {
            let lines = (0..MEASURED).map(|line| length(line * across, step));
            lines.fold(0.0, f64::max)
        };
        [most(1, MEASURED), most(MEASURED, 1)]
    };
    positions.chunks(MEASURED * MEASURED).map(longest).collect()
}

/// Returns disks that close the ends of cylinders at poles.
///
/// With `r` the distance from the pole over that of the border, `y` lies `-ln r` radii beyond.
fn around_poles(spline: &TSpline, complex: &CylinderComplex, reach: f64) -> Vec<Tile> {
    let mut tiles = Vec::new();
    for (cylinder, own) in (0..).zip(complex.cylinders()) {
        let [size, height] = [own.circumference, own.height].map(|n| n as f64);
        for (border, end, away) in [(&own.bottom, 0.0, -1.0), (&own.top, height, 1.0)] {
            if !matches!(border[0].beyond, Beyond::Pole { .. }) {
                continue;
            }
            let turn = spread([0.0, size], SEGMENTS[1] as u32);
            let rim: Vec<Point> = turn
                .iter()
                .map(|&x| Point {
                    cylinder,
                    x,
                    y: end,
                })
                .collect();
            let rim = spline.evaluate(&rim, Order::Value).positions;
            let length: f64 = rim.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
            let count = |length: f64| (length / reach).ceil().clamp(4.0, 2.0 * SEGMENTS[1]) as u32;
            let beyond = |r: &f64| end - away * r.max(CENTRE).ln() * size / std::f64::consts::TAU;
            let radii = spread([0.0, 1.0], count(length / std::f64::consts::TAU));
            let mut rows: Vec<f64> = radii.iter().map(beyond).collect();
            if away > 0.0 {
                rows.reverse();
            }
            tiles.push(Tile {
                cylinder,
                columns: spread([0.0, size], count(length)),
                rows,
                bottom: Line::None,
                left: Line::None,
                top: Line::None,
            });
        }
    }
    tiles
}

/// Gap between cylinders in the plane, and the width of a row of them, in roots of their area.
const GAP: f64 = 0.06;
const WIDTH: f64 = 1.3;

/// Returns where each cylinder begins in the plane.
fn origins(complex: &CylinderComplex, unit: f64) -> Vec<[f64; 2]> {
    let mut origins = Vec::new();
    let (mut x, mut y, mut highest) = (0.0, 0.0, 0.0_f64);
    for own in complex.cylinders() {
        let [width, height] = [own.circumference, own.height].map(|n| n as f64 / unit);
        if x > 0.0 && x + width > WIDTH {
            (x, y) = (0.0, y - highest - GAP);
            highest = 0.0;
        }
        origins.push([x, y - height]);
        x += width + GAP;
        highest = highest.max(height);
    }
    origins
}
