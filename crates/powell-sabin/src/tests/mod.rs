//! Domains and splines that the tests share.

mod basis;
mod domains;
mod editing;
mod evaluation;
mod fitting;
mod planar;
pub(crate) mod surfaces;

use msplines_common::Point3;
use msplines_common::evaluate::Order;
use msplines_common::mesh::{SurfacePoint, TriangleMesh};

use crate::{FlatDomain, PowellSabinSpline};

/// Ring and tube radius of the torus.
pub(crate) const TORUS: [f64; 2] = [1.0, 0.4];

/// Numbers in [0, 1) from a seed, by the splitmix generator.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(crate) fn barycentric(&mut self) -> [f64; 3] {
        let (a, b) = (self.next(), self.next());
        let (a, b) = if a + b > 1.0 {
            (1.0 - a, 1.0 - b)
        } else {
            (a, b)
        };
        [1.0 - a - b, a, b]
    }
}

/// Returns a grid over the unit square whose inner points are moved by up to `amount` cells.
pub(crate) fn jittered_grid(cells: usize, amount: f64, seed: u64) -> FlatDomain {
    let mut random = Random::new(seed);
    let mut points = Vec::new();
    for j in 0..=cells {
        for i in 0..=cells {
            let inner = (1..cells).contains(&i) && (1..cells).contains(&j);
            let mut coordinate = |k: usize| {
                let shift = (random.next() - 0.5) * 2.0 * amount;
                (k as f64 + if inner { shift } else { 0.0 }) / cells as f64
            };
            points.push([coordinate(i), coordinate(j)]);
        }
    }
    FlatDomain::planar(&points).expect("a planar domain")
}

/// Position, derivatives by both angles, of the embedded torus.
pub(crate) fn torus_point([u, v]: [f64; 2]) -> [[f64; 3]; 3] {
    let [ring, tube] = TORUS;
    let r = ring + tube * v.cos();
    [
        [r * u.cos(), r * u.sin(), tube * v.sin()],
        [-r * u.sin(), r * u.cos(), 0.0],
        [
            -tube * v.sin() * u.cos(),
            -tube * v.sin() * u.sin(),
            tube * v.cos(),
        ],
    ]
}

/// Returns a torus of `2 n × n` cells with its angles as flat coordinates, and the angles of its
/// vertices. Vertices are moved by up to a quarter of a cell.
pub(crate) fn torus(n: usize, amount: f64) -> (FlatDomain, Vec<[f64; 2]>) {
    let mut random = Random::new(5);
    let (columns, rows) = (2 * n, n);
    let size = [columns, rows].map(|count| std::f64::consts::TAU / count as f64);
    let shifts: Vec<[f64; 2]> = (0..columns * rows)
        .map(|_| [0, 1].map(|k| (random.next() - 0.5) * 2.0 * amount * size[k]))
        .collect();
    let vertex = |i: usize, j: usize| (j % rows) * columns + i % columns;
    // Not wrapped around: neighbours differ by little.
    let angles = |[i, j]: [usize; 2]| {
        let shift = shifts[vertex(i, j)];
        [i as f64 * size[0] + shift[0], j as f64 * size[1] + shift[1]]
    };
    let (mut faces, mut vectors) = (Vec::new(), Vec::new());
    for j in 0..rows {
        for i in 0..columns {
            for corners in [
                [[i, j], [i + 1, j], [i + 1, j + 1]],
                [[i, j], [i + 1, j + 1], [i, j + 1]],
            ] {
                faces.push(corners.map(|[i, j]| vertex(i, j) as u32));
                for k in 0..3 {
                    let (a, b) = (angles(corners[k]), angles(corners[(k + 1) % 3]));
                    vectors.push([b[0] - a[0], b[1] - a[1]]);
                }
            }
        }
    }
    let all: Vec<[f64; 2]> = (0..rows)
        .flat_map(|j| (0..columns).map(move |i| [i, j]))
        .map(angles)
        .collect();
    let positions = all
        .iter()
        .map(|&a| Point3::from(torus_point(a)[0]))
        .collect();
    let mesh = TriangleMesh::build(positions, faces).expect("a torus");
    (FlatDomain::build(mesh, vectors).expect("a flat torus"), all)
}

/// A planar function with its derivatives: value, by u and by v.
pub(crate) type Function = fn([f64; 2]) -> [f64; 3];

/// Returns the spline that takes value and gradient of a function at the vertices.
pub(crate) fn interpolant(
    domain: &FlatDomain,
    function: impl Fn([f64; 2]) -> [f64; 3],
) -> PowellSabinSpline {
    let jets: Vec<[f64; 3]> = domain
        .mesh()
        .positions()
        .iter()
        .map(|p| function([p.x, p.y]))
        .collect();
    let values = jets.iter().map(|j| j[0]).collect();
    let gradients = jets.iter().flat_map(|j| [j[1], j[2]]).collect();
    PowellSabinSpline::from_parts(domain.clone(), 1, values, gradients).expect("a spline")
}

/// Returns a spline of random values and gradients.
pub(crate) fn random_spline(domain: &FlatDomain, dimension: usize, seed: u64) -> PowellSabinSpline {
    let mut random = Random::new(seed);
    let count = domain.mesh().vertex_count() * dimension;
    let mut draw = |n: usize| (0..n).map(|_| 2.0 * random.next() - 1.0).collect();
    let (values, gradients) = (draw(count), draw(2 * count));
    PowellSabinSpline::from_parts(domain.clone(), dimension, values, gradients).expect("a spline")
}

/// Returns `per_face` random points of every face.
pub(crate) fn points(domain: &FlatDomain, per_face: usize, seed: u64) -> Vec<SurfacePoint> {
    let mut random = Random::new(seed);
    let faces = domain.mesh().face_count() as u32;
    (0..faces)
        .flat_map(|face| std::iter::repeat_n(face, per_face))
        .map(|face| SurfacePoint {
            face,
            at: random.barycentric(),
        })
        .collect()
}

/// Returns value, gradient and second derivatives of a function at a point.
pub(crate) fn jet(spline: &PowellSabinSpline, point: SurfacePoint) -> [f64; 6] {
    let s = spline
        .evaluate_flat(&[point], Order::Second)
        .expect("a point");
    [
        s.values[0],
        s.first[0],
        s.first[1],
        s.second[0],
        s.second[1],
        s.second[2],
    ]
}
