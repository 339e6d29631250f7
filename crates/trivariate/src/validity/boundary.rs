//! Whether two points of the boundary coincide.
//!
//! # What is proved
//! Pairs of pieces of the six faces are settled in one of two ways. Pieces whose Bézier points a plane
//! separates do not meet: planes across the axes, across the line between their middles, along
//! tangents of either or both, and between them are tried. Pieces that touch in the cube lie in a box `Ω` of parameters on
//! which, for some matrix `G` and all derivatives `J` in the hull of their Bézier points, `|G J - 1| < 1`:
//! then `G (f(b) - f(a)) = (1 + E) (b - a)` with `|E| < 1` for all `a`, `b` in `Ω`, so that `f` is one-to-one
//! there. What neither settles is halved. If all pairs are settled, no two points of the
//! boundary coincide. Rounding is covered by [`MARGIN`] and [`ROUNDING`], far above the errors of the few sums behind a
//! box or a derivative.

use msplines_common::bspline::{Axis, span_restriction};
use msplines_common::{Point3, Vector3};
use nalgebra::{DMatrix, Matrix3};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::spline::End;
use crate::spline::{Face, TrivariateSpline};

/// By how much boxes are widened, against the largest coordinate, and by how much deviations of
/// derivatives must stay below 1.
const MARGIN: f64 = 1e-11;

/// Rounding of a Bézier point around a centre, against the largest coordinate: fewer than 50 roundings of
/// weighted means. Differences of such points over boxes of 10⁻⁶ spans are still known to some digits, which
/// [`MARGIN`] would not leave.
const ROUNDING: f64 = 1e-14;

/// Contacts after which the search ends.
const CONTACTS: usize = 16;

/// Options of [`boundary`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BoundaryOptions {
    /// How often the faces of spans are halved before a pair of neighbours stays open.
    pub depth: u32,
    /// How often before a pair of pieces that are apart in the cube counts as a contact.
    pub contact_depth: u32,
    /// Most pairs at a time; with more the answer is `Undecided`.
    pub most_pairs: usize,
}

impl Default for BoundaryOptions {
    fn default() -> Self {
        Self {
            depth: 16,
            contact_depth: 14,
            most_pairs: 4_000_000,
        }
    }
}

/// What is known about the boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BoundaryVerdict {
    /// No two points coincide: proved.
    Injective,
    /// Points that are apart in the cube come closer than their smallest pieces are large.
    Contact,
    /// Neighbouring pieces remain for which nothing is shown.
    Undecided,
}

/// Result of [`boundary`].
#[derive(Clone, Debug, PartialEq)]
pub struct BoundaryReport {
    /// The verdict.
    pub verdict: BoundaryVerdict,
    /// Pairs of pieces that were looked at.
    pub pairs: usize,
    /// Pairs of neighbours for which nothing is shown.
    pub open: usize,
    /// Pairs that may meet, at most 16 or those of one round.
    pub contacts: Vec<Contact>,
}

/// Two points of the boundary that are apart in the cube and nearly meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Parameter of one.
    pub first: [f64; 3],
    /// Parameter of the other.
    pub second: [f64; 3],
    /// Their distance.
    pub distance: f64,
}

/// A rectangle of a face, in units of spans, inside of one span.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Piece {
    face: Face,
    low: [f64; 2],
    width: f64,
}

/// What a look at a pair comes to.
enum Look {
    Settled,
    Halved,
    Open,
    Contact(Contact),
}

/// Returns whether two points of the boundary of a solid coincide.
///
/// Along edges of the cube where two faces of the solid nearly join smoothly the pieces become as small
/// as the crease is flat; the determinant must be positive there, see [`certify`](super::certify).
#[must_use]
pub fn boundary(spline: &TrivariateSpline, options: &BoundaryOptions) -> BoundaryReport {
    let tester = Tester::build(spline);
    let mut pairs = tester.first_pairs();
    let mut report = BoundaryReport {
        verdict: BoundaryVerdict::Injective,
        pairs: 0,
        open: 0,
        contacts: Vec::new(),
    };
    for depth in 0..=options.depth {
        report.pairs += pairs.len();
        let last = depth == options.depth;
        let ends = [last, last || depth >= options.contact_depth];
        let looks: Vec<Look> = pairs.par_iter().map(|p| tester.look(p, ends)).collect();
        let mut next = Vec::new();
        for (pair, look) in pairs.iter().zip(looks) {
            match look {
                Look::Settled => {}
                Look::Halved => halve(pair, &mut next),
                Look::Open => report.open += 1,
                Look::Contact(contact) => report.contacts.push(contact),
            }
        }
        if report.contacts.len() >= CONTACTS {
            break;
        }
        if next.len() > options.most_pairs {
            report.open += next.len();
            break;
        }
        pairs = next;
    }
    if report.open > 0 {
        report.verdict = BoundaryVerdict::Undecided;
    }
    if !report.contacts.is_empty() {
        report.verdict = BoundaryVerdict::Contact;
    }
    report
}

/// All pairs of quarters of two pieces, or of one.
fn halve(pair: &[Piece; 2], out: &mut Vec<[Piece; 2]>) {
    let quarters = pair.map(|piece| {
        let width = 0.5 * piece.width;
        [[0.0, 0.0], [width, 0.0], [0.0, width], [width, width]].map(|[a, b]| Piece {
            low: [piece.low[0] + a, piece.low[1] + b],
            width,
            ..piece
        })
    });
    let same = pair[0] == pair[1];
    for (i, first) in quarters[0].iter().enumerate() {
        let from = if same { i } else { 0 };
        out.extend(quarters[1][from..].iter().map(|second| [*first, *second]));
    }
}

struct Tester<'a> {
    spline: &'a TrivariateSpline,
    /// Absolute widening of boxes.
    slack: f64,
    /// Absolute rounding of a Bézier point around a centre.
    rounding: f64,
}

impl<'a> Tester<'a> {
    fn build(spline: &'a TrivariateSpline) -> Self {
        let sizes = spline.points().iter().map(|p| p.coords.amax());
        let size = sizes.fold(0.0, f64::max);
        Self {
            spline,
            slack: MARGIN * size,
            rounding: ROUNDING * size,
        }
    }

    /// Parameters of a piece: low and high corners, in units of spans.
    fn range(&self, piece: &Piece) -> [[f64; 3]; 2] {
        let n = self.spline.spans() as f64;
        let fixed = if piece.face.end == End::High { n } else { 0.0 };
        let (mut low, mut high) = ([fixed; 3], [fixed; 3]);
        for (d, axis) in piece.face.free().into_iter().enumerate() {
            low[axis] = piece.low[d];
            high[axis] = piece.low[d] + piece.width;
        }
        [low, high]
    }

    /// Bézier points of the solid over a box of parameters inside of one span, around a centre.
    fn points(&self, [low, high]: [[f64; 3]; 2], centre: &Point3<f64>) -> Vec<f64> {
        let last = self.spline.spans() - 1;
        let span = low.map(|x| (x as usize).min(last));
        let block = self.spline.block(span);
        let lines = block.iter().flatten().map(|p| p - centre);
        let mut values: Vec<f64> = lines.flat_map(|p| [p.x, p.y, p.z]).collect();
        let mut sizes = [4; 3];
        for axis in (0..3).rev() {
            let start = span[axis] as f64;
            let rows = span_restriction(low[axis] - start, high[axis] - start);
            // One row is enough where the box is flat.
            let count = if low[axis] < high[axis] { 4 } else { 1 };
            values = Axis::of(&sizes, axis, 3).apply(&[0; 4][..count], &rows[..count], &values);
            sizes[axis] = count;
        }
        values
    }

    /// The box around a piece.
    fn bounds(&self, piece: &Piece) -> [Vector3<f64>; 2] {
        let values = self.points(self.range(piece), &Point3::origin());
        let points = values.chunks_exact(3).map(Vector3::from_column_slice);
        let start = [
            Vector3::repeat(f64::INFINITY),
            Vector3::repeat(f64::NEG_INFINITY),
        ];
        let [low, high] = points.fold(start, |[l, h], p| [l.inf(&p), h.sup(&p)]);
        [low.add_scalar(-self.slack), high.add_scalar(self.slack)]
    }

    /// Pairs of faces of spans whose boxes overlap, swept along x.
    fn first_pairs(&self) -> Vec<[Piece; 2]> {
        let n = self.spline.spans();
        let pieces: Vec<Piece> = Face::ALL
            .iter()
            .flat_map(|&face| (0..n * n).map(move |at| (face, at)))
            .map(|(face, at)| Piece {
                face,
                low: [(at % n) as f64, (at / n) as f64],
                width: 1.0,
            })
            .collect();
        let boxes: Vec<[Vector3<f64>; 2]> = pieces.par_iter().map(|p| self.bounds(p)).collect();
        let mut order: Vec<usize> = (0..pieces.len()).collect();
        order.sort_by(|&a, &b| boxes[a][0].x.total_cmp(&boxes[b][0].x).then(a.cmp(&b)));
        let mut pairs = Vec::new();
        for (rank, &a) in order.iter().enumerate() {
            let starts = order[rank..].iter();
            for &b in starts.take_while(|&&b| boxes[b][0].x <= boxes[a][1].x) {
                if overlap(&boxes[a], &boxes[b]) {
                    pairs.push([pieces[a.min(b)], pieces[a.max(b)]]);
                }
            }
        }
        pairs
    }

    /// Looks at a pair, with the last word on neighbours and on others if it is so.
    fn look(&self, pair: &[Piece; 2], [last, last_apart]: [bool; 2]) -> Look {
        let same = pair[0] == pair[1];
        if !same && self.separated(pair) {
            return Look::Settled;
        }
        let [a, b] = pair.map(|piece| self.range(&piece));
        let touching = (0..3).all(|d| a[0][d] <= b[1][d] && b[0][d] <= a[1][d]);
        if touching {
            let low = std::array::from_fn(|d| a[0][d].min(b[0][d]));
            let high = std::array::from_fn(|d| a[1][d].max(b[1][d]));
            if self.one_to_one([low, high]) {
                return Look::Settled;
            }
        }
        match touching {
            true if last => Look::Open,
            false if last_apart => {
                let n = self.spline.spans() as f64;
                let middle = |[low, high]: [[f64; 3]; 2]| {
                    std::array::from_fn(|d| 0.5 * (low[d] + high[d]) / n)
                };
                let [first, second] = [middle(a), middle(b)];
                let apart = self.spline.position(first) - self.spline.position(second);
                Look::Contact(Contact {
                    first,
                    second,
                    distance: apart.norm(),
                })
            }
            _ => Look::Halved,
        }
    }

    /// Whether a plane is found between two pieces.
    fn separated(&self, pair: &[Piece; 2]) -> bool {
        let points = pair.map(|piece| {
            let values = self.points(self.range(&piece), &Point3::origin());
            let points = values.chunks_exact(3).map(Vector3::from_column_slice);
            points.collect::<Vec<_>>()
        });
        let middles = [0, 1].map(|i| points[i].iter().sum::<Vector3<f64>>() / 16.0);
        let tangents = [0, 1].map(|i| {
            // Corners of 4 by 4 points.
            let [a, b, c, d] = [0, 3, 12, 15].map(|at| points[i][at]);
            [(b - a) + (d - c), (c - a) + (d - b)]
        });
        let across = tangents.map(|[u, v]| u.cross(&v));
        let units = across.map(|n| n.normalize());
        let directions = [
            Vector3::x(),
            Vector3::y(),
            Vector3::z(),
            middles[1] - middles[0],
            across[0].cross(&tangents[0][0]),
            across[0].cross(&tangents[0][1]),
            across[1].cross(&tangents[1][0]),
            across[1].cross(&tangents[1][1]),
            across[0],
            across[1],
            // Planes that halve the angle of a narrow ridge or valley.
            units[0] + units[1],
            units[0] - units[1],
        ];
        // Planes along a tangent of each, between pieces around an edge that is short.
        let mixed = (0..4).map(|at| tangents[0][at % 2].cross(&tangents[1][at / 2]));
        directions.into_iter().chain(mixed).any(|direction| {
            let slack = self.slack * direction.lp_norm(1);
            let [a, b] = [0, 1].map(|i| {
                let along = points[i].iter().map(|p| p.dot(&direction));
                let start = (f64::INFINITY, f64::NEG_INFINITY);
                along.fold(start, |(l, h), x| (l.min(x), h.max(x)))
            });
            a.1 + 2.0 * slack < b.0 || b.1 + 2.0 * slack < a.0
        })
    }

    /// Whether the solid is shown to be one-to-one on a box of parameters.
    fn one_to_one(&self, [low, high]: [[f64; 3]; 2]) -> bool {
        let n = self.spline.spans() as f64;
        let extent: [f64; 3] = std::array::from_fn(|d| high[d] - low[d]);
        let axes: Vec<usize> = (0..3).filter(|&d| extent[d] > 0.0).collect();
        let middle: [f64; 3] = std::array::from_fn(|d| 0.5 * (low[d] + high[d]));
        let jet = self.spline.jet(middle.map(|x| x / n));
        // Columns are derivatives by coordinates that go from 0 to 1 over the box.
        let columns: Vec<Vector3<f64>> = axes
            .iter()
            .map(|&d| jet.first[d] * (extent[d] / n))
            .collect();
        let Some(inverse) = left_inverse(&columns) else {
            return false;
        };
        let mut worst = [0.0_f64; 3];
        for part in spans_of([low, high]) {
            let values = self.points(part, &jet.value);
            let sizes: [usize; 3] =
                std::array::from_fn(|d| if part[0][d] < part[1][d] { 4 } else { 1 });
            for (column, &axis) in axes.iter().enumerate() {
                let scale = 3.0 * extent[axis] / (part[1][axis] - part[0][axis]);
                let stride = 3 * sizes[..axis].iter().product::<usize>();
                for at in (0..values.len()).step_by(3) {
                    if at / stride % 4 == 3 {
                        continue;
                    }
                    let difference: [f64; 3] =
                        std::array::from_fn(|d| scale * (values[at + stride + d] - values[at + d]));
                    let mut deviation = &inverse * Vector3::from(difference);
                    deviation[column] -= 1.0;
                    worst[column] = worst[column].max(deviation.norm_squared());
                }
            }
        }
        let rounding = inverse.norm() * 64.0 * self.rounding;
        worst.iter().sum::<f64>().sqrt() + rounding < 1.0 - MARGIN
    }
}

/// The matrix that takes independent columns to unit vectors.
fn left_inverse(columns: &[Vector3<f64>]) -> Option<DMatrix<f64>> {
    let normal = Vector3::x();
    let full = match columns {
        [a, b, c] => Matrix3::from_columns(&[*a, *b, *c]),
        [a, b] => Matrix3::from_columns(&[*a, *b, a.cross(b)]),
        _ => Matrix3::from_columns(&[normal; 3]),
    };
    let inverse = full.try_inverse()?;
    let count = columns.len();
    Some(DMatrix::from_fn(count, 3, |row, column| {
        inverse[(row, column)]
    }))
}

/// The parts of a box of parameters inside of single spans.
fn spans_of([low, high]: [[f64; 3]; 2]) -> Vec<[[f64; 3]; 2]> {
    let mut parts = vec![[low, high]];
    for axis in 0..3 {
        let mut cut = Vec::with_capacity(parts.len());
        for part in parts {
            let (mut start, end) = (part[0][axis], part[1][axis]);
            while end - start.floor() > 1.0 {
                let (mut first, wall) = (part, start.floor() + 1.0);
                first[0][axis] = start;
                first[1][axis] = wall;
                cut.push(first);
                start = wall;
            }
            let mut rest = part;
            rest[0][axis] = start;
            cut.push(rest);
        }
        parts = cut;
    }
    parts
}

fn overlap(a: &[Vector3<f64>; 2], b: &[Vector3<f64>; 2]) -> bool {
    (0..3).all(|d| a[0][d] <= b[1][d] && b[0][d] <= a[1][d])
}
