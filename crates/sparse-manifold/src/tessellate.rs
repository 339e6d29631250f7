//! Surfaces as fine grids of points.

use std::collections::BTreeMap;
use std::sync::Arc;

use msplines_common::Point3;
use msplines_common::mesh::SurfacePoint;
use msplines_common::mesh::polygon::PolygonTopology;
use rayon::prelude::*;

use crate::dictionary::Dictionary;
use crate::domain::{Domain, Star, corner_coordinates};
use crate::fit::charts::{COMPONENTS, Function};
use crate::fit::design::{Blending, samples};
use crate::numbers::Numbers;
use crate::spline::SparseManifold;
use crate::weight::weight;

/// Weighted atoms of charts of every shape on a grid of `cells` by `cells` in each face.
///
/// Building costs one evaluation of all atoms for every shape of a chart; points then are short sums.
#[derive(Clone, Debug)]
pub struct Tessellator {
    cells: u32,
    tables: BTreeMap<Star, Arc<Table>>,
}

#[derive(Clone, Debug)]
struct Table {
    /// Largest grid coordinate with a weight.
    reach: u32,
    atoms: usize,
    rows: Vec<f64>,
}

/// A surface cut into triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct Tessellation {
    /// Positions; those of the control mesh's vertices first, then on edges, then inside of faces.
    pub positions: Vec<Point3<f64>>,
    /// A place of each position on the control mesh.
    pub places: Vec<SurfacePoint>,
    /// Corners of the triangles, `2 cells²` for each face.
    pub triangles: Vec<[u32; 3]>,
}

impl Tessellator {
    /// Builds the tables for the charts of a surface.
    ///
    /// # Panics
    /// If `cells` is zero.
    #[must_use]
    pub fn build(spline: &SparseManifold, cells: u32) -> Self {
        assert!(cells > 0, "a grid has cells");
        let mut tables = BTreeMap::new();
        for (star, dictionary) in spline.manifold().stars().iter().zip(spline.dictionaries()) {
            let table = || Arc::new(Table::build(*star, dictionary, cells));
            tables.entry(*star).or_insert_with(table);
        }
        Self { cells, tables }
    }

    /// Returns the points of a face, `(cells + 1)²` of them: along its first edge first, then up.
    #[must_use]
    pub fn face(&self, spline: &SparseManifold, face: u32) -> Vec<[f64; 3]> {
        let topology = spline.mesh().topology();
        let function = |chart: u32| &spline.functions()[chart as usize];
        self.grid(topology, spline.manifold(), function, face)
    }

    pub(crate) fn grid<'a>(
        &self,
        topology: &PolygonTopology,
        domain: &Domain,
        function: impl Fn(u32) -> &'a Function,
        face: u32,
    ) -> Vec<[f64; 3]> {
        let side = self.cells as usize + 1;
        let mut points = vec![[0.0; COMPONENTS]; side * side];
        for corner in 0..4 {
            let h = 4 * face + corner;
            let chart = topology.origin(h);
            let star = domain.stars()[chart as usize];
            let table = &self.tables[&star];
            let function = function(chart);
            let sector = domain.sector(h);
            for a in 0..=table.reach {
                for b in 0..=table.reach {
                    let row = table.row(star, sector, [a, b]);
                    let mut sum = [0.0; COMPONENTS];
                    let terms = function.support.iter();
                    for (&atom, c) in terms.zip(function.coefficients.chunks_exact(COMPONENTS)) {
                        let value = row[usize::from(atom)];
                        for component in 0..COMPONENTS {
                            sum[component] += value * c[component];
                        }
                    }
                    let [column, row] = self.place(corner, [a, b]);
                    let point = &mut points[row as usize * side + column as usize];
                    for component in 0..COMPONENTS {
                        point[component] += sum[component];
                    }
                }
            }
        }
        points
    }

    /// Returns the grid point of a face that a corner sees at these steps.
    fn place(&self, corner: u32, [a, b]: [u32; 2]) -> [u32; 2] {
        let n = self.cells;
        match corner {
            0 => [a, b],
            1 => [n - b, a],
            2 => [n - a, n - b],
            _ => [b, n - a],
        }
    }

    /// Returns the whole surface, watertight.
    #[must_use]
    pub fn surface(&self, spline: &SparseManifold) -> Tessellation {
        let topology = spline.mesh().topology();
        let numbers = Numbers {
            topology,
            cells: self.cells,
        };
        let faces: Vec<Vec<[f64; 3]>> = (0..topology.face_count() as u32)
            .into_par_iter()
            .map(|face| self.face(spline, face))
            .collect();
        let count = numbers.count();
        let mut positions = vec![Point3::origin(); count];
        let mut places = vec![
            SurfacePoint {
                face: 0,
                at: [0.0; 3]
            };
            count
        ];
        let mut triangles =
            Vec::with_capacity(2 * faces.len() * (self.cells * self.cells) as usize);
        for (face, points) in faces.iter().enumerate() {
            let ids = numbers.grid(face as u32);
            let side = self.cells as usize + 1;
            for (i, (&id, &point)) in ids.iter().zip(points).enumerate() {
                let at = [i % side, i / side].map(|c| c as f64 / f64::from(self.cells));
                positions[id as usize] = Point3::from(point);
                places[id as usize] = SurfacePoint {
                    face: face as u32,
                    at: [at[0], at[1], 0.0],
                };
            }
            cut(&ids, points, side, &mut triangles);
        }
        Tessellation {
            positions,
            places,
            triangles,
        }
    }
}

/// Cuts the cells of a grid along their shorter diagonals.
fn cut(ids: &[u32], points: &[[f64; 3]], side: usize, triangles: &mut Vec<[u32; 3]>) {
    let distance =
        |a: usize, b: usize| (Point3::from(points[a]) - Point3::from(points[b])).norm_squared();
    for row in 0..side - 1 {
        for column in 0..side - 1 {
            let a = row * side + column;
            let [a, b, c, d] = [a, a + 1, a + side + 1, a + side];
            let halves = if distance(a, c) <= distance(b, d) {
                [[a, b, c], [a, c, d]]
            } else {
                [[a, b, d], [b, c, d]]
            };
            triangles.extend(halves.map(|t| t.map(|i| ids[i])));
        }
    }
}

impl Table {
    fn build(star: Star, dictionary: &Dictionary, cells: u32) -> Self {
        let samples = samples(star, cells + 1, Blending::Weighted);
        let reach = samples
            .iter()
            .map(|s| s.grid[0].max(s.grid[1]))
            .max()
            .unwrap_or(0);
        let rows = samples.par_iter().map(|sample| {
            let at = sample.grid.map(|i| f64::from(i) / f64::from(cells));
            let scale = weight(at[0])[0] * weight(at[1])[0];
            let values = dictionary.values(sample.sector, at);
            values
                .into_iter()
                .map(move |value| value * scale)
                .collect::<Vec<f64>>()
        });
        Self {
            reach,
            atoms: dictionary.atoms().len(),
            rows: rows.flatten().collect(),
        }
    }

    /// Returns the row of a sample, in the order of [`samples`].
    fn row(&self, star: Star, sector: u32, [a, b]: [u32; 2]) -> &[f64] {
        let of_sector = |sector: u32, [a, b]: [u32; 2]| {
            1 + (sector * self.reach + a - 1) * (self.reach + 1) + b
        };
        let index = match (a, b) {
            (0, 0) => 0,
            (0, b) if sector + 1 < star.sectors => of_sector(sector + 1, [b, 0]),
            (0, b) if star.is_closed() => of_sector(0, [b, 0]),
            (0, b) => of_sector(star.sectors, [1, 0]) + b - 1,
            _ => of_sector(sector, [a, b]),
        };
        &self.rows[index as usize * self.atoms..(index as usize + 1) * self.atoms]
    }
}

/// Returns the points of a grid of `cells` by `cells` on every face.
#[must_use]
pub fn grid_points(faces: usize, cells: u32) -> Vec<SurfacePoint> {
    let side = cells + 1;
    let step = |i: u32| f64::from(i) / f64::from(cells);
    let point = |face: u32, i: u32| SurfacePoint {
        face,
        at: {
            let [s, t] = corner_coordinates(0, [step(i % side), step(i / side)]);
            [s, t, 0.0]
        },
    };
    (0..faces as u32)
        .flat_map(|face| (0..side * side).map(move |i| point(face, i)))
        .collect()
}
