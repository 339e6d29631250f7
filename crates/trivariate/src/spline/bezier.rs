//! Between the lattice and one Bézier hexahedron for each span.

use msplines_common::Point3;
use msplines_common::bspline::{Axis, BezierCells, CellShape, from_bezier, to_bezier};

use super::{MOST_SPANS, SplineError, TrivariateSpline};

/// How far neighbouring cells may differ in a control point of the lattice, against the largest
/// coordinate: errors of rounding grow by up to 15³.
const AGREEMENT: f64 = 1e-10;

/// By how much errors of Bézier points grow in the four control points of a span: the sums of the
/// absolute coefficients. A control point is taken from the cell where they grow least.
const GROWTH: [f64; 4] = [15.0, 3.0, 3.0, 15.0];

impl TrivariateSpline {
    /// Returns the solid as one cubic Bézier hexahedron for each span, the first index fastest.
    ///
    /// # Panics
    /// Never: the points fill all cells.
    #[must_use]
    pub fn bezier_cells(&self) -> BezierCells {
        let n = self.spans;
        let mut points = Vec::with_capacity(64 * n * n * n);
        for at in 0..n * n * n {
            points.extend(self.bezier_span([at % n, at / n % n, at / (n * n)]));
        }
        let cells = BezierCells::build(CellShape::Hexahedra, [3; 3], points, None);
        cells.expect("64 points for each span")
    }

    /// The Bézier points of one span.
    pub(crate) fn bezier_span(&self, span: [usize; 3]) -> Vec<Point3<f64>> {
        let block = self.block(span);
        let mut values: Vec<f64> = block
            .iter()
            .flatten()
            .flat_map(|p| [p.x, p.y, p.z])
            .collect();
        convert(&mut values, to_bezier);
        let points = values.chunks_exact(3);
        points.map(|c| Point3::new(c[0], c[1], c[2])).collect()
    }

    /// Returns the spline whose spans are these cells, as [`bezier_cells`](Self::bezier_cells) gives
    /// them.
    ///
    /// # Errors
    /// Cells that are not cubic hexahedra, not a cube of them, rational, or do not join with two
    /// continuous derivatives.
    pub fn from_bezier_cells(cells: &BezierCells) -> Result<Self, SplineError> {
        let wrong = |reason: String| SplineError::Cells { reason };
        if cells.shape() != CellShape::Hexahedra || cells.degree() != Some([3; 3]) {
            return Err(wrong("they must be hexahedra of degree 3".into()));
        }
        if cells.weights().is_some() {
            return Err(wrong("they are rational".into()));
        }
        let spans = (1..=MOST_SPANS).find(|n| n.pow(3) == cells.len());
        let Some(spans) = spans else {
            return Err(wrong(format!("{} is not n³ of them", cells.len())));
        };
        let size = spans + 3;
        let largest = cells.points().iter().map(|p| p.coords.amax());
        let allowed = AGREEMENT * largest.fold(0.0, f64::max);
        let mut points = vec![(f64::INFINITY, Point3::origin()); size.pow(3)];
        for (cell, bezier) in cells.points().chunks_exact(64).enumerate() {
            let mut values: Vec<f64> = bezier.iter().flat_map(|p| [p.x, p.y, p.z]).collect();
            convert(&mut values, from_bezier);
            let [i, j, k] = [cell % spans, cell / spans % spans, cell / (spans * spans)];
            for (p, c) in values.chunks_exact(3).enumerate() {
                let [q, r, s] = [p % 4, p / 4 % 4, p / 16];
                let growth = GROWTH[q] * GROWTH[r] * GROWTH[s];
                let at = i + q + size * (j + r + size * (k + s));
                let (new, (least, old)) = (Point3::new(c[0], c[1], c[2]), points[at]);
                if least.is_finite() && (old - new).amax() > allowed {
                    return Err(wrong(format!("cell {cell} does not join its neighbours")));
                }
                if growth < least {
                    points[at] = (growth, new);
                }
            }
        }
        let points = points.into_iter().map(|(_, point)| point);
        Self::build(spans, points.collect())
    }
}

/// Applies a change of basis in all three directions of 4³ points.
fn convert(values: &mut [f64], change: fn([f64; 4]) -> [f64; 4]) {
    for axis in 0..3 {
        let Axis { outer, inner, .. } = Axis::of(&[4; 3], axis, 3);
        for start in (0..outer).flat_map(|o| (0..inner).map(move |i| 4 * o * inner + i)) {
            let line = change(std::array::from_fn(|p| values[start + p * inner]));
            for (p, value) in line.into_iter().enumerate() {
                values[start + p * inner] = value;
            }
        }
    }
}
