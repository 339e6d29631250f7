//! One tile as a Bézier patch: exact, or interpolated.

use msplines_common::bspline::bernstein;
use msplines_common::evaluate::Order;
use msplines_common::{Point3, Vector3};
use nalgebra::{DMatrix, Vector4};

use super::tile::{Chart, Tile};
use crate::complex::{Point, UNITS};
use crate::spline::TSpline;

/// The least weight of an exact patch over its largest: what divides by less is interpolated.
const LEAST_WEIGHT: f64 = 1e-12;

/// A patch over a tile.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Patch {
    pub(super) tile: Tile,
    /// The tile in the mesh of all, with lines that may be shifted by a few units.
    pub(super) cell: Tile,
    pub(super) chart: Chart,
    /// In both directions.
    pub(super) degree: usize,
    pub(super) points: Vec<Point3<f64>>,
    /// Of exact patches; interpolated ones are polynomials.
    pub(super) weights: Option<Vec<f64>>,
    /// The largest distance from the surface at points between the nodes.
    pub(super) deviation: f64,
    /// The same on the sides.
    pub(super) aside: f64,
}

impl Patch {
    /// Returns the surface over a tile that no knot divides and no cap meets; nothing where the functions
    /// all but vanish.
    pub(super) fn exact(spline: &TSpline, tile: Tile, leaf: u32) -> Option<Self> {
        let space = spline.space();
        let mut sums = [Vector4::zeros(); 16];
        for (function, origin) in space.images_on(leaf) {
            let ends =
                |axis: usize, range: [i64; 2]| range.map(|end| (end as f64 - origin[axis]) / UNITS);
            let [along_x, along_y] = space.blends(function);
            let f = along_x.bernstein(ends(0, tile.x));
            let g = along_y.bernstein(ends(1, tile.y));
            let point = spline.control()[function as usize].push(1.0);
            for (place, sum) in sums.iter_mut().enumerate() {
                *sum += point * (f[place % 4] * g[place / 4]);
            }
        }
        let largest = sums.iter().map(|s| s.w).fold(0.0, f64::max);
        let whole = sums.iter().all(|s| s.w > LEAST_WEIGHT * largest);
        whole.then(|| Self {
            tile,
            cell: tile,
            chart: Chart::Plain,
            degree: 3,
            points: sums.iter().map(|s| Point3::from(s.xyz() / s.w)).collect(),
            weights: Some(sums.iter().map(|s| s.w).collect()),
            deviation: 0.0,
            aside: 0.0,
        })
    }

    /// Returns the polynomial patch that interpolates the surface over a tile, with a zero at one corner
    /// at most.
    ///
    /// Sides depend on nothing but the surface on them, so that those of neighbours over the same edge are
    /// the same curve.
    pub(super) fn interpolated(spline: &TSpline, tile: Tile, scheme: &Scheme) -> Self {
        let space = spline.space();
        let complex = space.mesh().complex();
        let chart = tile.chart(complex, space.caps());
        let over = |ts: &[f64]| -> Vec<Point> {
            let pairs = ts.iter().flat_map(|&t| ts.iter().map(move |&s| [s, t]));
            pairs.map(|at| tile.point(complex, chart, at)).collect()
        };
        let values = spline
            .evaluate(&over(&scheme.nodes), Order::Value)
            .positions;
        let degree = scheme.nodes.len() - 1;
        let patch = Self {
            tile,
            cell: tile,
            chart,
            degree,
            points: scheme.coefficients(&values),
            weights: None,
            deviation: 0.0,
            aside: 0.0,
        };
        let truth = spline
            .evaluate(&over(&scheme.checks), Order::Value)
            .positions;
        let checks = &scheme.checks;
        let at = checks
            .iter()
            .flat_map(|&t| checks.iter().map(move |&s| [s, t]));
        let distances = at.zip(truth).map(|(at, point)| {
            let is_aside = at.iter().any(|&t| t == 0.0 || t == 1.0);
            (is_aside, (patch.position(at) - point).norm())
        });
        let (mut deviation, mut aside) = (0.0_f64, 0.0_f64);
        for (is_aside, distance) in distances {
            deviation = deviation.max(distance);
            if is_aside {
                aside = aside.max(distance);
            }
        }
        Self {
            deviation,
            aside,
            ..patch
        }
    }

    pub(super) fn is_exact(&self) -> bool {
        self.weights.is_some()
    }

    /// Returns the axis along which a polynomial patch has the larger term of highest degree, and so an
    /// interpolation the larger error.
    pub(super) fn rough_axis(&self) -> usize {
        let count = self.degree + 1;
        let leading = |stride: [usize; 2]| {
            let lines = (0..count).map(|line| {
                let term = |k: usize| {
                    let sign = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
                    let factor = sign * bernstein::binomial(self.degree, k);
                    self.points[line * stride[1] + k * stride[0]].coords * factor
                };
                (0..count).map(term).sum::<Vector3<f64>>().norm()
            });
            lines.fold(0.0, f64::max)
        };
        usize::from(leading([count, 1]) > leading([1, count]))
    }

    /// Returns the point at parameters.
    pub(super) fn position(&self, at: [f64; 2]) -> Point3<f64> {
        let count = self.degree + 1;
        let [mut row, mut column] = [vec![0.0; count], vec![0.0; count]];
        bernstein::values(at[0], &mut row);
        bernstein::values(at[1], &mut column);
        let mut sum = Vector4::zeros();
        for (place, point) in self.points.iter().enumerate() {
            let weight = self.weights.as_ref().map_or(1.0, |w| w[place]);
            let factor = weight * row[place % count] * column[place / count];
            sum += point.coords.push(1.0) * factor;
        }
        Point3::from(sum.xyz() / sum.w)
    }
}

/// Nodes of interpolation of one degree, and what makes Bernstein coefficients of values at them.
pub(super) struct Scheme {
    nodes: Vec<f64>,
    /// Where deviations are measured: between the nodes, and at the sides.
    checks: Vec<f64>,
    inverse: DMatrix<f64>,
}

impl Scheme {
    /// Returns the scheme on the extrema of Chebyshev's polynomial.
    pub(super) fn new(degree: usize) -> Self {
        let angle = |k: f64| std::f64::consts::PI * k / degree as f64;
        let node = |k: f64| 0.5 - 0.5 * angle(k).cos();
        let nodes: Vec<f64> = (0..=degree).map(|k| node(k as f64)).collect();
        let mut checks = vec![0.0];
        checks.extend((0..degree).map(|k| node(k as f64 + 0.5)));
        checks.push(1.0);
        let mut collocation = DMatrix::zeros(degree + 1, degree + 1);
        let mut row = vec![0.0; degree + 1];
        for (i, &t) in nodes.iter().enumerate() {
            bernstein::values(t, &mut row);
            collocation.row_mut(i).copy_from_slice(&row);
        }
        let inverse = collocation.try_inverse();
        Self {
            nodes,
            checks,
            inverse: inverse.unwrap_or_else(|| DMatrix::identity(degree + 1, degree + 1)),
        }
    }

    fn coefficients(&self, values: &[Point3<f64>]) -> Vec<Point3<f64>> {
        let count = self.nodes.len();
        let along = |values: &[Vector3<f64>], stride: [usize; 2]| {
            let mut out = vec![Vector3::zeros(); values.len()];
            for line in 0..count {
                for i in 0..count {
                    let place = |k: usize| line * stride[1] + k * stride[0];
                    let terms = (0..count).map(|k| values[place(k)] * self.inverse[(i, k)]);
                    out[place(i)] = terms.sum();
                }
            }
            out
        };
        let values: Vec<_> = values.iter().map(|p| p.coords).collect();
        let both = along(&along(&values, [1, count]), [count, 1]);
        both.into_iter().map(Point3::from).collect()
    }
}
