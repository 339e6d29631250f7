//! Closed surfaces of any genus as zero sets, cut out of a grid of tetrahedra.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

use super::build;
use crate::mesh::decimate::decimate_evenly;
use crate::mesh::triangle::TriangleMesh;

/// Vertices of the cut grid for each vertex asked for: enough for decimation to choose from.
const SURPLUS: f64 = 2.5;

/// Rounds of smoothing after decimation; more change the angles hardly any more.
const SMOOTHING_ROUNDS: usize = 12;

/// Returns a closed surface with `handles` holes and exactly `vertices` vertices: a round plate with
/// a ring of holes, slightly bent so that it has no plane of symmetry.
///
/// # Panics
/// If `handles` is 0 or above 64, or there are fewer than 150 vertices for each hole.
#[must_use]
pub fn genus(handles: u32, vertices: usize) -> TriangleMesh {
    assert!((1..=64).contains(&handles), "a plate has 1 to 64 holes");
    assert!(
        vertices >= 150 * handles as usize,
        "each hole needs 150 vertices"
    );
    let plate = Plate::new(handles);
    // The number of vertices grows with the inverse square of the step.
    let mut step = 0.1;
    for _ in 0..3 {
        let found = plate.cut_grid(step).vertex_count() as f64;
        if found >= SURPLUS * vertices as f64 && found <= 2.0 * SURPLUS * vertices as f64 {
            break;
        }
        step *= (found / (1.4 * SURPLUS * vertices as f64)).sqrt();
    }
    let fine = plate.smoothed(&plate.cut_grid(step), 3);
    // Equal lengths rather than small errors: demonstrations want round triangles everywhere.
    let coarse = decimate_evenly(&fine, vertices, 1.0)
        .expect("150 vertices for each hole are far above where decimation stops");
    let smooth = plate.smoothed(&coarse.mesh, SMOOTHING_ROUNDS);
    smooth.with_positions(smooth.positions().iter().map(bend).collect())
}

fn bend(p: &Point3<f64>) -> Point3<f64> {
    Point3::new(
        p.x,
        p.y,
        p.z + 0.15 * (1.3 * p.x + 0.4).sin() + 0.1 * (1.7 * p.y).cos(),
    )
}

/// The solid `z² < T² σ(d₀) σ(d₁) …` over a disk without round holes, where `d` are the distances
/// inwards from its circles and σ is a smooth step.
struct Plate {
    holes: Vec<[f64; 2]>,
    hole_radius: f64,
}

const OUTER_RADIUS: f64 = 1.0;
const HALF_THICKNESS: f64 = 0.24;

impl Plate {
    fn new(handles: u32) -> Self {
        if handles == 1 {
            return Self {
                holes: vec![[0.0, 0.0]],
                hole_radius: 0.4,
            };
        }
        let half_turn = TAU / 2.0 / f64::from(handles);
        // Holes are as wide as the walls between them, and stay clear of the rim.
        let ring = 0.58;
        let hole_radius = (0.5 * ring * half_turn.sin()).min(0.24);
        let place = |i: u32| {
            let (sine, cosine) = (2.0 * half_turn * f64::from(i)).sin_cos();
            [ring * cosine, ring * sine]
        };
        Self {
            holes: (0..handles).map(place).collect(),
            hole_radius,
        }
    }

    /// Returns a number that is negative inside.
    fn value(&self, p: &Point3<f64>) -> f64 {
        let radius = self.hole_radius;
        let step = |distance: f64| distance / (distance * distance + radius * radius).sqrt();
        let length = |x: f64, y: f64| (x * x + y * y).sqrt();
        let inside: f64 = self
            .holes
            .iter()
            .map(|hole| step(length(p.x - hole[0], p.y - hole[1]) - radius))
            .product();
        let thickness = HALF_THICKNESS.min(1.2 * radius);
        p.z * p.z - thickness * thickness * step(OUTER_RADIUS - length(p.x, p.y)) * inside
    }

    fn gradient(&self, p: &Point3<f64>) -> Vector3<f64> {
        const STEP: f64 = 1e-5;
        Vector3::from_fn(|axis, _| {
            let mut offset = Vector3::zeros();
            offset[axis] = STEP;
            (self.value(&(p + offset)) - self.value(&(p - offset))) / (2.0 * STEP)
        })
    }

    /// Moves a point near the surface onto it, by steps of at most `reach`.
    fn project(&self, mut p: Point3<f64>, reach: f64) -> Point3<f64> {
        const CLOSE: f64 = 1e-6;
        for _ in 0..6 {
            let gradient = self.gradient(&p);
            let step = gradient * (-self.value(&p) / gradient.norm_squared().max(1e-12));
            p += step * (reach / step.norm().max(reach));
            // The error squares from step to step.
            if step.norm() < CLOSE {
                break;
            }
        }
        p
    }

    /// Returns the mesh with vertices moved towards the middle of their neighbours, and back onto
    /// the surface.
    fn smoothed(&self, mesh: &TriangleMesh, rounds: usize) -> TriangleMesh {
        let mut mesh = mesh.clone();
        for _ in 0..rounds {
            let old = mesh.positions();
            let moved = (0..old.len() as u32).into_par_iter().map(|v| {
                let here = old[v as usize];
                let offsets = mesh
                    .topology()
                    .neighbours(v)
                    .map(|u| old[u as usize] - here);
                let (count, sum, reach) = offsets.fold(
                    (0.0, Vector3::zeros(), 0.0f64),
                    |(count, sum, reach), offset| {
                        (count + 1.0, sum + offset, reach.max(offset.norm()))
                    },
                );
                let normal = self.gradient(&here).normalize();
                let offset: Vector3<f64> = sum / count;
                self.project(
                    here + (offset - normal * offset.dot(&normal)) * 0.6,
                    0.3 * reach,
                )
            });
            mesh = mesh.with_positions(moved.collect());
        }
        mesh
    }

    /// Returns the zero set cut out of a grid of cubes of side `step`, each cut into six tetrahedra
    /// around its diagonal.
    fn cut_grid(&self, step: f64) -> TriangleMesh {
        let grid = Grid::around(self, step);
        let mut ids = BTreeMap::new();
        let (mut positions, mut faces) = (Vec::new(), Vec::new());
        let [nx, ny, nz] = grid.counts;
        for cube in 0..(nx - 1) * (ny - 1) * (nz - 1) {
            let i = cube % (nx - 1);
            let j = cube / (nx - 1) % (ny - 1);
            let k = cube / ((nx - 1) * (ny - 1));
            let corners: [usize; 8] =
                std::array::from_fn(|c| grid.index(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)));
            let inside = corners.iter().filter(|&&c| grid.values[c] < 0.0).count();
            if inside == 0 || inside == 8 {
                continue;
            }
            for tetrahedron in TETRAHEDRA {
                let mut cut = |a: usize, b: usize| {
                    *ids.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                        positions.push(grid.crossing(a, b));
                        positions.len() as u32 - 1
                    })
                };
                let corners = tetrahedron.map(|c| corners[c]);
                faces.extend(cut_tetrahedron(corners, &grid.values, &mut cut));
            }
        }
        build(positions, faces)
    }
}

struct Grid {
    low: Point3<f64>,
    step: f64,
    counts: [usize; 3],
    values: Vec<f64>,
}

impl Grid {
    fn around(plate: &Plate, step: f64) -> Self {
        // Off the planes of symmetry, so that no value is exactly zero.
        let shift = Vector3::new(0.137, 0.291, 0.413) * step;
        let margin =
            Vector3::new(OUTER_RADIUS, OUTER_RADIUS, HALF_THICKNESS).add_scalar(2.0 * step);
        let low = Point3::from(shift - margin);
        let counts = [0, 1, 2].map(|i| (2.0 * margin[i] / step).ceil() as usize + 1);
        let mut grid = Self {
            low,
            step,
            counts,
            values: Vec::new(),
        };
        grid.values = (0..counts.iter().product())
            .map(|g| plate.value(&grid.point(g)))
            .collect();
        grid
    }

    fn index(&self, i: usize, j: usize, k: usize) -> usize {
        (k * self.counts[1] + j) * self.counts[0] + i
    }

    fn point(&self, index: usize) -> Point3<f64> {
        let [nx, ny, _] = self.counts;
        let place = Vector3::new(index % nx, index / nx % ny, index / (nx * ny));
        self.low + place.map(|i| i as f64) * self.step
    }

    /// Returns the zero between two grid points, away from both so that no triangle is a sliver.
    fn crossing(&self, a: usize, b: usize) -> Point3<f64> {
        let (a, b) = (a.min(b), a.max(b));
        let (from, to) = (self.values[a], self.values[b]);
        let t = (from / (from - to)).clamp(0.1, 0.9);
        self.point(a) + (self.point(b) - self.point(a)) * t
    }
}

/// Tetrahedra of a cube around its diagonal from corner 0 to corner 7, positively oriented; bit i of
/// a corner's number is its coordinate i.
const TETRAHEDRA: [[usize; 4]; 6] = [
    [0, 1, 3, 7],
    [0, 3, 2, 7],
    [0, 2, 6, 7],
    [0, 6, 4, 7],
    [0, 4, 5, 7],
    [0, 5, 1, 7],
];

/// Returns the triangles between the inner and the outer corners, facing outwards.
fn cut_tetrahedron(
    corners: [usize; 4],
    values: &[f64],
    cut: &mut impl FnMut(usize, usize) -> u32,
) -> Vec<[u32; 3]> {
    // By the inner corners as bits: even permutations that bring the inner corners to the front,
    // or the outer one if there are three inner ones.
    const ORDER: [[usize; 4]; 16] = [
        [0, 1, 2, 3],
        [0, 1, 2, 3],
        [1, 0, 3, 2],
        [0, 1, 2, 3],
        [2, 0, 1, 3],
        [0, 2, 3, 1],
        [1, 2, 0, 3],
        [3, 0, 2, 1],
        [3, 0, 2, 1],
        [0, 3, 1, 2],
        [1, 3, 2, 0],
        [2, 0, 1, 3],
        [2, 3, 0, 1],
        [1, 0, 3, 2],
        [0, 1, 2, 3],
        [0, 1, 2, 3],
    ];
    let inside = (0..4).filter(|&i| values[corners[i]] < 0.0);
    let (mask, count) = inside.fold((0, 0), |(mask, count), i| (mask | 1 << i, count + 1));
    let [a, b, c, d] = ORDER[mask].map(|i| corners[i]);
    match count {
        1 => vec![[cut(a, b), cut(a, c), cut(a, d)]],
        2 => {
            let [ac, ad, bc, bd] = [cut(a, c), cut(a, d), cut(b, c), cut(b, d)];
            vec![[ac, ad, bd], [ac, bd, bc]]
        }
        3 => vec![[cut(a, b), cut(a, d), cut(a, c)]],
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Facts;

    #[test]
    fn plates_have_the_genus_and_count_asked_for_and_round_triangles() {
        for (handles, vertices) in [(1, 400), (2, 1_000), (3, 1_500), (8, 6_000)] {
            let mesh = genus(handles, vertices);
            mesh.topology().sanity_check();
            let facts = Facts::measure(&mesh);
            assert_eq!((facts.genus, facts.boundary_loops), (Some(handles), 0));
            assert_eq!(facts.vertices, vertices);
            assert!(facts.volume.unwrap() > 0.0);
            // Five degrees: smoothing leaves no needles.
            assert!(facts.angle.min > 0.0873, "{handles}: {facts:?}");
        }
    }
}
