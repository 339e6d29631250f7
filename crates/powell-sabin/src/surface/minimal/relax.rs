//! The iteration that decreases the area.

use msplines_common::Vector3;
use msplines_common::linalg::{Cholesky, Mat, Ordering, Symbolic, SymmetricMatrix};
use msplines_common::mesh::{NONE, SurfacePoint};
use nalgebra::{DMatrix, Matrix2};

use super::Layout;

/// Rounds after which an area that still decreases is left as it is.
const ROUNDS: u32 = 100;

/// Relative decrease of the area in a round from which on points move along normals alone.
const EVEN: f64 = 1e-3;

/// Relative decrease of the area in a round of motion along normals below which it has settled. The
/// area is flat there: the surface has moved by some 1e-5 of its size.
const SETTLED: f64 = 1e-9;

/// How often a step is halved that would fold the surface.
const HALVINGS: u32 = 6;

/// Smallest area of a cell at a point of quadrature, relative to the mean, before the surface counts
/// as folding.
const FOLDING: f64 = 1e-4;

/// Points of quadrature, exact for quadratics; weights are a third of the area.
const QUADRATURE: [[f64; 3]; 3] = [
    [2.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0],
    [1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0],
    [1.0 / 6.0, 1.0 / 6.0, 2.0 / 3.0],
];

/// Where on a cell its control points belong.
const PLACES: [[f64; 3]; 6] = [
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.5, 0.5, 0.0],
    [0.0, 0.5, 0.5],
    [0.5, 0.0, 0.5],
];

/// How an area was decreased.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Relaxed {
    /// Area before the first round.
    pub(crate) start: f64,
    /// Area at the end.
    pub(crate) area: f64,
    /// Rounds.
    pub(crate) rounds: u32,
    /// Whether it settled.
    pub(crate) settled: bool,
}

/// Which way control points move in a round.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Motion {
    /// Every way, which makes cells even too.
    Free,
    /// Along the normals. What is left to win by motion within the surface is an error of the
    /// discretisation, and it takes hundreds of rounds.
    AlongNormals,
}

/// Returns the control points of a surface of small area.
///
/// The area decreases in every round: along the way from `F` to the `F'` that minimises the energy in the
/// metric of `F`, among all surfaces or those that normals lead to, the energy falls, and is at
/// least the area.
pub(super) fn relax(layout: &Layout) -> Option<(Vec<Vector3<f64>>, Relaxed)> {
    let mut system = System::new(layout)?;
    let disk = disk(layout)?;
    let mut points = system.step(layout, &disk)?;
    let mut area = area(layout, &points)?;
    let mut relaxed = Relaxed {
        start: area,
        area,
        rounds: 0,
        settled: false,
    };
    let mut motion = Motion::Free;
    while relaxed.rounds < ROUNDS && !relaxed.settled {
        let mut step = |(way, halvings): (Motion, u32)| {
            let next = match way {
                Motion::Free => system.step(layout, &points),
                Motion::AlongNormals => system.normal_step(layout, &points),
            };
            let found = unfolded(layout, &points, &next?, halvings)?;
            Some((way, found))
        };
        // Before a step is made shorter the other one is tried: free motion makes cells even that are
        // about to fold.
        let ways = match motion {
            Motion::Free => [Motion::Free, Motion::AlongNormals],
            Motion::AlongNormals => [Motion::AlongNormals, Motion::Free],
        };
        let tries = [0, HALVINGS]
            .into_iter()
            .flat_map(|n| ways.map(|way| (way, n)));
        let found = tries.into_iter().find_map(&mut step);
        let Some((way, (next, smaller))) = found else {
            break;
        };
        relaxed.rounds += 1;
        let decrease = 1.0 - smaller / area;
        if decrease > 0.0 {
            (points, area) = (next, smaller);
        }
        relaxed.settled = way == Motion::AlongNormals && decrease < SETTLED;
        if decrease < EVEN {
            motion = Motion::AlongNormals;
        }
    }
    relaxed.area = area;
    Some((points, relaxed))
}

/// Returns the surface and its area as far on the way as it does not fold.
fn unfolded(
    layout: &Layout,
    from: &[Vector3<f64>],
    to: &[Vector3<f64>],
    halvings: u32,
) -> Option<(Vec<Vector3<f64>>, f64)> {
    (0..=halvings).find_map(|halvings| {
        let share = 0.5_f64.powi(halvings as i32);
        let pairs = from.iter().zip(to);
        let points: Vec<Vector3<f64>> = pairs.map(|(a, b)| a.lerp(b, share)).collect();
        let area = area(layout, &points)?;
        Some((points, area))
    })
}

/// Returns the unit normals at the control points, means over their cells by area.
fn normals(layout: &Layout, points: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let mut normals = vec![Vector3::zeros(); points.len()];
    for cell in &layout.cells {
        for (&point, at) in cell.iter().zip(PLACES) {
            let [u, v] = tangents(cell, points, &gradients(at));
            normals[point as usize] += u.cross(&v);
        }
    }
    let unit = |normal: &Vector3<f64>| normal.try_normalize(0.0).unwrap_or_default();
    normals.iter().map(unit).collect()
}

/// The gradient of the six basis functions by the second and third coordinate.
fn gradients([a, b, c]: [f64; 3]) -> [[f64; 2]; 6] {
    [
        [-2.0 * a, -2.0 * a],
        [2.0 * b, 0.0],
        [0.0, 2.0 * c],
        [2.0 * (a - b), -2.0 * b],
        [2.0 * c, 2.0 * b],
        [-2.0 * c, 2.0 * (a - c)],
    ]
}

/// The derivatives of a cell at a point with these gradients.
fn tangents(cell: &[u32; 6], points: &[Vector3<f64>], slopes: &[[f64; 2]; 6]) -> [Vector3<f64>; 2] {
    let mut first = [Vector3::zeros(); 2];
    for (&point, slope) in cell.iter().zip(slopes) {
        for k in 0..2 {
            first[k] += slope[k] * points[point as usize];
        }
    }
    first
}

/// The metric of a cell at a point of quadrature.
fn metric(cell: &[u32; 6], points: &[Vector3<f64>], slopes: &[[f64; 2]; 6]) -> Matrix2<f64> {
    let first = tangents(cell, points, slopes);
    Matrix2::from_fn(|i, j| first[i].dot(&first[j]))
}

/// Returns the area; nothing if a cell nearly vanishes.
fn area(layout: &Layout, points: &[Vector3<f64>]) -> Option<f64> {
    let (mut sum, mut least) = (0.0, f64::INFINITY);
    let mut count = 0.0;
    for cell in &layout.cells {
        for at in QUADRATURE {
            let density = metric(cell, points, &gradients(at))
                .determinant()
                .max(0.0)
                .sqrt();
            sum += density / 6.0;
            least = least.min(density);
            count += 1.0 / 6.0;
        }
    }
    (least > FOLDING * sum / count).then_some(sum)
}

/// The system of the points inside.
struct System {
    /// Number of each point inside, or none on the rim.
    unknowns: Vec<u32>,
    count: usize,
    factor: Option<Cholesky>,
}

impl System {
    fn new(layout: &Layout) -> Option<Self> {
        let mut unknowns = vec![0; layout.places.len()];
        for &(point, _) in &layout.rim {
            unknowns[point as usize] = NONE;
        }
        let mut count = 0;
        for unknown in unknowns.iter_mut().filter(|u| **u != NONE) {
            *unknown = count;
            count += 1;
        }
        (count > 0).then_some(Self {
            unknowns,
            count: count as usize,
            factor: None,
        })
    }

    /// Returns the surface of least Dirichlet energy in the metric of these points.
    fn step(&mut self, layout: &Layout, points: &[Vector3<f64>]) -> Option<Vec<Vector3<f64>>> {
        let mut next = vec![Vector3::zeros(); points.len()];
        for &(point, at) in &layout.rim {
            next[point as usize] = at;
        }
        let mut entries = Vec::with_capacity(21 * layout.cells.len());
        let mut right = Mat::<f64>::zeros(self.count, 3);
        for cell in &layout.cells {
            let element = element(cell, points)?;
            for (i, &row) in cell.iter().enumerate() {
                let own = self.unknowns[row as usize];
                if own == NONE {
                    continue;
                }
                for (j, &column) in cell.iter().enumerate() {
                    let other = self.unknowns[column as usize];
                    if other == NONE {
                        let pull = element[i][j] * next[column as usize];
                        (0..3).for_each(|c| right[(own as usize, c)] -= pull[c]);
                    } else if other <= own {
                        entries.push((own, other, element[i][j]));
                    }
                }
            }
        }
        self.solve(&entries, &mut right)?;
        for (point, &unknown) in next.iter_mut().zip(&self.unknowns) {
            if unknown != NONE {
                *point = Vector3::from_fn(|c, _| right[(unknown as usize, c)]);
            }
        }
        let finite = next.iter().all(|p| p.iter().all(|c| c.is_finite()));
        finite.then_some(next)
    }

    /// Returns the surface of least Dirichlet energy in the metric of these points among those that
    /// motion along normals leads to.
    fn normal_step(
        &mut self,
        layout: &Layout,
        points: &[Vector3<f64>],
    ) -> Option<Vec<Vector3<f64>>> {
        let normals = normals(layout, points);
        let mut entries = Vec::with_capacity(21 * layout.cells.len());
        let mut right = Mat::<f64>::zeros(self.count, 1);
        for cell in &layout.cells {
            let element = element(cell, points)?;
            for (i, &row) in cell.iter().enumerate() {
                let own = self.unknowns[row as usize];
                if own == NONE {
                    continue;
                }
                let normal = normals[row as usize];
                for (j, &column) in cell.iter().enumerate() {
                    let here = points[column as usize];
                    right[(own as usize, 0)] -= element[i][j] * normal.dot(&here);
                    let other = self.unknowns[column as usize];
                    if other != NONE && other <= own {
                        let share = normal.dot(&normals[column as usize]);
                        entries.push((own, other, element[i][j] * share));
                    }
                }
            }
        }
        self.solve(&entries, &mut right)?;
        let mut next = points.to_vec();
        for ((point, normal), &unknown) in next.iter_mut().zip(&normals).zip(&self.unknowns) {
            if unknown != NONE {
                *point += right[(unknown as usize, 0)] * normal;
            }
        }
        let finite = next.iter().all(|p| p.iter().all(|c| c.is_finite()));
        finite.then_some(next)
    }

    /// Solves for right-hand sides in place; the pattern of the matrix is always the same.
    fn solve(&mut self, entries: &[(u32, u32, f64)], right: &mut Mat<f64>) -> Option<()> {
        let matrix = SymmetricMatrix::from_lower_triplets(self.count, entries);
        match &mut self.factor {
            Some(factor) => factor.refactor(&matrix).ok()?,
            None => {
                let ordering = Ordering::nested_dissection(&matrix).ok()?;
                let symbolic = Symbolic::analyze(&matrix, &ordering);
                self.factor = Some(Cholesky::factor(symbolic, &matrix).ok()?);
            }
        }
        self.factor.as_ref()?.solve_in_place(right.as_mut());
        Some(())
    }
}

/// Returns the matrix of the Dirichlet energy of a cell in the metric of its points.
fn element(cell: &[u32; 6], points: &[Vector3<f64>]) -> Option<[[f64; 6]; 6]> {
    let mut matrix = [[0.0; 6]; 6];
    for at in QUADRATURE {
        let slopes = gradients(at);
        let metric = metric(cell, points, &slopes);
        let determinant = metric.determinant();
        if determinant <= 0.0 {
            return None;
        }
        let density = determinant.sqrt() / 6.0;
        let [xx, xy, yy] = [metric[(1, 1)], -metric[(0, 1)], metric[(0, 0)]]
            .map(|entry| entry / determinant * density);
        for (row, a) in matrix.iter_mut().zip(&slopes) {
            for (entry, b) in row.iter_mut().zip(&slopes) {
                *entry += a[0] * (xx * b[0] + xy * b[1]) + a[1] * (xy * b[0] + yy * b[1]);
            }
        }
    }
    Some(matrix)
}

/// Returns the control points laid out in a flat disk without folds: the rim on a circle by its lengths,
/// base vertices inside at the mean of their neighbours.
///
/// # Reference
/// [Tutte1963].
fn disk(layout: &Layout) -> Option<Vec<Vector3<f64>>> {
    let base = &layout.base;
    let loops = base.boundary_loops();
    let [rim] = loops.as_slice() else {
        return None;
    };
    let mut known = vec![None; layout.places.len()];
    for &(point, at) in &layout.rim {
        known[point as usize] = Some(at);
    }
    // The vertices of the base come first among the points.
    let vertices: Vec<u32> = rim.iter().map(|&h| base.origin(h)).collect();
    let length = |k: usize| -> Option<f64> {
        let ends = [vertices[k], vertices[(k + 1) % vertices.len()]];
        let [a, b] = ends.map(|v| known[v as usize]);
        Some((b? - a?).norm())
    };
    let lengths: Vec<f64> = (0..vertices.len()).map(length).collect::<Option<_>>()?;
    let total: f64 = lengths.iter().sum();
    let mut flat = vec![None; base.vertex_count()];
    let mut run = 0.0;
    for (&vertex, length) in vertices.iter().zip(lengths) {
        let angle = std::f64::consts::TAU * run / total;
        flat[vertex as usize] = Some([angle.cos(), angle.sin()]);
        run += length;
    }
    let inner: Vec<u32> = (0..base.vertex_count() as u32)
        .filter(|&v| flat[v as usize].is_none())
        .collect();
    let mut matrix = DMatrix::<f64>::zeros(inner.len(), inner.len());
    let mut right = DMatrix::<f64>::zeros(inner.len(), 2);
    for (row, &vertex) in inner.iter().enumerate() {
        for other in base.neighbours(vertex) {
            matrix[(row, row)] += 1.0;
            match flat[other as usize] {
                Some(at) => (0..2).for_each(|c| right[(row, c)] += at[c]),
                None => {
                    let column = inner.iter().position(|&v| v == other)?;
                    matrix[(row, column)] -= 1.0;
                }
            }
        }
    }
    let solved = matrix.lu().solve(&right)?;
    for (row, &vertex) in inner.iter().enumerate() {
        flat[vertex as usize] = Some([solved[(row, 0)], solved[(row, 1)]]);
    }
    let place = |point: &SurfacePoint| {
        let corners = base.faces()[point.face as usize];
        let mut sum = Vector3::zeros();
        for (vertex, weight) in corners.into_iter().zip(point.at) {
            let [x, y] = flat[vertex as usize].unwrap_or_default();
            sum += weight * Vector3::new(x, y, 0.0);
        }
        sum
    };
    Some(layout.places.iter().map(place).collect())
}
