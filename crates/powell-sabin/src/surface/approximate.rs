//! Blended faces as Bézier triangles of higher degree.
//!
//! A face starts as the six micro triangles of its split. A cell interpolates the surface at the points
//! of a regular lattice, so that its sides depend on points of theirs alone and are the same from both
//! sides. Where it is not near enough all of its sides are halved; every cell is then cut by
//! those of its sides that were, which leaves no vertex on the side of another cell.

use std::collections::{BTreeMap, BTreeSet};

use msplines_common::evaluate::Order;
use msplines_common::mesh::{NONE, SurfacePoint};
use msplines_common::{Point3, Vector3};
use nalgebra::DMatrix;
use rayon::prelude::*;

use super::PowellSabinSurface;
use crate::element::MacroTriangle;

/// Degree of the cells: happy_buddha_25k takes 313,000 of them where quadratics took 1.3 million. The
/// surface is smooth on pieces whose bounds are not those of the cells, which limits what more would gain.
pub(super) const DEGREE: usize = 4;

/// Control points of a cell.
const POINTS: usize = (DEGREE + 1) * (DEGREE + 2) / 2;

/// How often sides of micro triangles are halved at most.
const DEEPEST: u32 = 6;

/// Points between those that a cell passes through, where its distance is taken: near the ends of all
/// sides, near the corners, and around the middle.
const PROBES: [[f64; 3]; 16] = [
    [0.625, 0.25, 0.125],
    [0.625, 0.125, 0.25],
    [0.25, 0.625, 0.125],
    [0.125, 0.625, 0.25],
    [0.25, 0.125, 0.625],
    [0.125, 0.25, 0.625],
    [0.875, 0.125, 0.0],
    [0.125, 0.875, 0.0],
    [0.0, 0.875, 0.125],
    [0.0, 0.125, 0.875],
    [0.875, 0.0, 0.125],
    [0.125, 0.0, 0.875],
    [0.75, 0.125, 0.125],
    [0.125, 0.75, 0.125],
    [0.125, 0.125, 0.75],
    [1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0],
];

/// How much of the distance that is allowed the points above may find: what is between them is farther by
/// half of it at most on the surfaces tried.
const SEEN: f64 = 0.6;

/// Cells that approximate blended faces.
pub(super) struct Approximation {
    /// Control points, cell after cell, in the order of `BezierCells`.
    pub(super) points: Vec<Point3<f64>>,
    /// Largest distance found.
    pub(super) deviation: f64,
    /// How often sides were halved at most.
    pub(super) halvings: u32,
}

/// A piece of a face.
#[derive(Clone)]
struct Piece {
    face: u32,
    /// Names of the corners, which neighbours share.
    names: [u32; 3],
    /// Where they are on the face.
    at: [[f64; 3]; 3],
}

/// A cell over a piece, and its distance.
struct Fitted {
    piece: Piece,
    points: [Vector3<f64>; POINTS],
    deviation: f64,
}

/// The matrices of interpolation.
struct Interpolation {
    /// Control points from values at the lattice.
    controls: DMatrix<f64>,
    /// Values at the probes from control points.
    probes: DMatrix<f64>,
}

impl PowellSabinSurface {
    /// Returns cells over blended faces within a distance of the surface, if few halvings do.
    pub(super) fn approximate(&self, faces: &[u32], limit: f64) -> Approximation {
        let (cells, halvings) = self.fitted_cells(faces, limit);
        let points = cells.iter().flat_map(|cell| cell.points.map(Point3::from));
        Approximation {
            points: points.collect(),
            deviation: cells.iter().fold(0.0, |max, cell| max.max(cell.deviation)),
            halvings,
        }
    }

    /// Returns the cells, and how often sides were halved.
    fn fitted_cells(&self, faces: &[u32], limit: f64) -> (Vec<Fitted>, u32) {
        let interpolation = Interpolation::new();
        let fit = |piece: Piece| self.interpolate(piece, &interpolation);
        let pieces = self.micro_pieces(faces);
        let mut names = Names::after(&pieces);
        let mut cells: Vec<Fitted> = pieces.into_par_iter().map(fit).collect();
        let mut halvings = 0;
        while halvings < DEEPEST {
            let coarse = cells.iter().filter(|cell| cell.deviation > SEEN * limit);
            let sides = coarse.flat_map(|cell| (0..3).map(|i| cell.piece.side(i)));
            let halved: BTreeSet<[u32; 2]> = sides.collect();
            if halved.is_empty() {
                break;
            }
            halvings += 1;
            let is_cut = |cell: &Fitted| (0..3).any(|i| halved.contains(&cell.piece.side(i)));
            let (cut, kept): (Vec<Fitted>, Vec<Fitted>) = cells.into_iter().partition(is_cut);
            let pieces: Vec<Piece> = cut
                .iter()
                .flat_map(|cell| cell.piece.cut(&halved, &mut names))
                .collect();
            cells = kept;
            cells.par_extend(pieces.into_par_iter().map(fit));
        }
        (cells, halvings)
    }

    /// Returns the micro triangles of faces.
    fn micro_pieces(&self, faces: &[u32]) -> Vec<Piece> {
        let topology = self.mesh().topology();
        let vertices = topology.vertex_count() as u32;
        let centres = vertices + topology.edge_count() as u32;
        let pieces = |&face: &u32| {
            let triangle = self.cell_split(face);
            let corners = self.mesh().faces()[face as usize];
            (0..6).map(move |micro| {
                let side = micro / 2;
                let middle = vertices + topology.edge(3 * face + side as u32);
                let (tail, head) = (corners[side], corners[(side + 1) % 3]);
                let [first, second] = [[tail, middle], [middle, head]][micro % 2];
                Piece {
                    face,
                    names: [first, second, centres + face],
                    at: triangle.micro_corners(micro),
                }
            })
        };
        faces.iter().flat_map(pieces).collect()
    }

    fn interpolate(&self, piece: Piece, with: &Interpolation) -> Fitted {
        let value = |weights: [f64; 3]| {
            let at = mix(&piece.at, weights);
            let face = piece.face;
            self.jet(&SurfacePoint { face, at }, Order::Value).value
        };
        let mut values = lattice().map(value);
        // Relative to a corner: large coordinates cost no digits.
        let first = values.next().unwrap_or_default();
        let rest: Vec<Vector3<f64>> = values.map(|value| value - first).collect();
        let sum = |row: usize, matrix: &DMatrix<f64>, terms: &[Vector3<f64>]| {
            let terms = terms.iter().enumerate();
            terms.fold(first, |sum, (column, term)| {
                sum + matrix[(row, column + 1)] * term
            })
        };
        let points: [Vector3<f64>; POINTS] =
            std::array::from_fn(|row| sum(row, &with.controls, &rest));
        let tail: Vec<Vector3<f64>> = points[1..].iter().map(|p| p - first).collect();
        let deviation = PROBES.iter().enumerate().fold(0.0, |max: f64, (row, &at)| {
            max.max((sum(row, &with.probes, &tail) - value(at)).norm())
        });
        Fitted {
            piece,
            points,
            deviation,
        }
    }

    /// Returns the split of a face that has pieces of the surface as its micro triangles, as far as
    /// there are straight ones.
    fn cell_split(&self, face: u32) -> MacroTriangle {
        if let Some(regular) = self.plain_face(face) {
            return self.regular().macro_triangle(regular);
        }
        let Some(cap) = self.covering(face) else {
            return MacroTriangle::new([[1.0, 0.0], [-1.0, 1.0], [0.0, -1.0]], [0.5; 3]);
        };
        let own = cap.split(face);
        let mut splits = own.splits();
        for (i, split) in splits.iter_mut().enumerate() {
            let twin = self.mesh().topology().twin(3 * face + i as u32);
            // Along the rim the cells beside are cut where the regular part is.
            let beside = if twin == NONE {
                None
            } else {
                self.plain_face(twin / 3)
            };
            if let Some(regular) = beside {
                *split = 1.0 - self.regular().macro_triangle(regular).splits()[(twin % 3) as usize];
            }
        }
        MacroTriangle::new(own.edges(), splits)
    }
}

/// New names for the middles of sides.
struct Names {
    next: u32,
    middles: BTreeMap<[u32; 2], u32>,
}

impl Names {
    /// Returns names that no corner has.
    fn after(pieces: &[Piece]) -> Self {
        let used = pieces.iter().flat_map(|piece| piece.names);
        Self {
            next: used.max().map_or(0, |name| name + 1),
            middles: BTreeMap::new(),
        }
    }

    fn middle(&mut self, side: [u32; 2]) -> u32 {
        *self.middles.entry(side).or_insert_with(|| {
            self.next += 1;
            self.next - 1
        })
    }
}

impl Piece {
    /// Returns the names of the ends of side `i`, from corner `i`, ascending.
    fn side(&self, i: usize) -> [u32; 2] {
        let [a, b] = [self.names[i], self.names[(i + 1) % 3]];
        [a.min(b), a.max(b)]
    }

    /// Returns the pieces that the middles of halved sides cut this one into.
    fn cut(&self, halved: &BTreeSet<[u32; 2]>, names: &mut Names) -> Vec<Self> {
        let is_halved = [0, 1, 2].map(|i| halved.contains(&self.side(i)));
        let corner = |i: usize| (self.names[i], self.at[i]);
        let mut middle = |i: usize| {
            let at = [0, 1, 2].map(|k| 0.5 * (self.at[i][k] + self.at[(i + 1) % 3][k]));
            (names.middle(self.side(i)), at)
        };
        let piece = |corners: [(u32, [f64; 3]); 3]| Self {
            face: self.face,
            names: corners.map(|c| c.0),
            at: corners.map(|c| c.1),
        };
        let count = is_halved.iter().filter(|&&h| h).count();
        // The side from which the templates count: the one that is halved, or after the one that is not.
        let from = match count {
            1 => is_halved.iter().position(|&h| h).unwrap_or(0),
            2 => is_halved
                .iter()
                .position(|&h| !h)
                .map_or(0, |i| (i + 1) % 3),
            _ => 0,
        };
        let [a, b, c] = [0, 1, 2].map(|i| (from + i) % 3);
        let (p, q, r) = (corner(a), corner(b), corner(c));
        let corners = match count {
            0 => vec![[p, q, r]],
            1 => {
                let m = middle(a);
                vec![[p, m, r], [m, q, r]]
            }
            2 => {
                let (m, n) = (middle(a), middle(b));
                vec![[m, q, n], [p, m, n], [p, n, r]]
            }
            _ => {
                let (l, m, n) = (middle(a), middle(b), middle(c));
                vec![[p, l, n], [l, q, m], [n, m, r], [l, m, n]]
            }
        };
        corners.into_iter().map(piece).collect()
    }
}

impl Interpolation {
    /// Returns the matrices for [`DEGREE`], at the lattice and the probes.
    fn new() -> Self {
        let points: Vec<[f64; 3]> = lattice().collect();
        let at = |points: &[[f64; 3]]| {
            DMatrix::from_fn(points.len(), POINTS, |row, column| {
                bernstein(points[row])[column]
            })
        };
        let controls = at(&points).try_inverse();
        Self {
            controls: controls.expect("the lattice determines a polynomial"),
            probes: at(&PROBES),
        }
    }
}

/// The steps of the second and third coordinate, in the order of `BezierCells`.
fn steps() -> impl Iterator<Item = [usize; 2]> {
    (0..=DEGREE).flat_map(|j| (0..=DEGREE - j).map(move |i| [i, j]))
}

/// The points that a cell passes through.
fn lattice() -> impl Iterator<Item = [f64; 3]> {
    let share = |k: usize| k as f64 / DEGREE as f64;
    steps().map(move |[i, j]| [share(DEGREE - i - j), share(i), share(j)])
}

/// Returns the Bernstein polynomials at a point.
fn bernstein([a, b, c]: [f64; 3]) -> [f64; POINTS] {
    let choose = |n: usize, k: usize| (0..k).fold(1.0, |c, i| c * (n - i) as f64 / (i + 1) as f64);
    let mut values = [0.0; POINTS];
    for (value, [i, j]) in values.iter_mut().zip(steps()) {
        let powers = a.powi((DEGREE - i - j) as i32) * b.powi(i as i32) * c.powi(j as i32);
        *value = choose(DEGREE, j) * choose(DEGREE - j, i) * powers;
    }
    values
}

fn mix(corners: &[[f64; 3]; 3], weights: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| (0..3).map(|k| weights[k] * corners[k][i]).sum())
}

#[cfg(test)]
mod tests {
    use msplines_common::mesh::shapes;

    use super::*;
    use crate::Fill;
    use crate::tests::Random;
    use crate::tests::surfaces::fitted;

    #[test]
    fn cells_keep_their_distance_between_the_points_looked_at() {
        let (found, _) = fitted(&shapes::genus(2, 2500), Fill::Smooth);
        let surface = &found.spline;
        let limit = 1e-6 * surface.mesh().diagonal();
        let (cells, halvings) = surface.fitted_cells(&surface.blended_faces(), limit);
        assert!(halvings > 0, "the first ones are too coarse");
        let mut random = Random::new(4);
        let mut worst = 0.0_f64;
        for cell in &cells {
            for _ in 0..8 {
                let weights = random.barycentric();
                let (face, at) = (cell.piece.face, mix(&cell.piece.at, weights));
                let due = surface.jet(&SurfacePoint { face, at }, Order::Value).value;
                let terms = bernstein(weights).into_iter().zip(&cell.points);
                let own: Vector3<f64> = terms.map(|(b, p)| b * p).sum();
                worst = worst.max((own - due).norm());
            }
        }
        assert!(worst < limit, "{:e} of {limit:e}", worst);
    }

    #[test]
    fn pieces_of_all_patterns_cover_a_piece() {
        let at = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let whole = Piece {
            face: 0,
            names: [5, 3, 8],
            at,
        };
        for pattern in 0..8 {
            let sides = (0..3).filter(|i| pattern & (1 << i) != 0);
            let halved: BTreeSet<[u32; 2]> = sides.map(|i| whole.side(i)).collect();
            let mut names = Names::after(std::slice::from_ref(&whole));
            let pieces = whole.cut(&halved, &mut names);
            assert_eq!(pieces.len(), 1 + halved.len());
            let area = |p: &Piece| nalgebra::Matrix3::from(p.at).determinant();
            assert!(pieces.iter().all(|p| area(p) > 0.2), "{pattern}");
            assert!((pieces.iter().map(area).sum::<f64>() - 1.0).abs() < 1e-15);
            // Halved sides are no longer there, all others are.
            for i in 0..3 {
                let count = pieces.iter().flat_map(|p| [0, 1, 2].map(|k| p.side(k)));
                let count = count.filter(|&side| side == whole.side(i)).count();
                assert_eq!(count, usize::from(!halved.contains(&whole.side(i))));
            }
        }
    }
}
