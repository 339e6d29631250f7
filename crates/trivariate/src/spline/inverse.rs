//! From positions to parameters.

use msplines_common::{Point3, Vector3};
use nalgebra::Matrix3;
use rayon::prelude::*;

use super::TrivariateSpline;

/// Parameters at which Newton steps of a span begin, in each direction.
const STARTS: [f64; 3] = [1.0 / 6.0, 0.5, 5.0 / 6.0];

/// Most Newton steps from one start.
const STEPS: u32 = 40;

/// A box around a part of a solid.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    low: Point3<f64>,
    high: Point3<f64>,
}

impl Bounds {
    fn around(points: &[Point3<f64>]) -> Self {
        let (mut low, mut high) = (points[0], points[0]);
        for point in points {
            low = low.inf(point);
            high = high.sup(point);
        }
        Self { low, high }
    }

    fn joined(self, other: Self) -> Self {
        Self {
            low: self.low.inf(&other.low),
            high: self.high.sup(&other.high),
        }
    }

    fn distance(&self, point: &Point3<f64>) -> f64 {
        let below = self.low - point;
        let above = point - self.high;
        below.sup(&above).sup(&Vector3::zeros()).norm()
    }
}

/// A node of the hierarchy: spans `low..high` of each direction, and its two halves.
#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Bounds,
    low: [usize; 3],
    high: [usize; 3],
    /// First of two children that stand side by side, or 0 for a single span.
    children: usize,
}

/// A spline, ready to find parameters of positions.
#[derive(Clone, Debug)]
pub struct Inverter<'a> {
    spline: &'a TrivariateSpline,
    nodes: Vec<Node>,
    diagonal: f64,
}

/// A parameter of a position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inverse {
    /// The parameter.
    pub parameter: [f64; 3],
    /// Distance of the spline at this parameter from the position.
    pub distance: f64,
}

/// A position that the solid does not reach.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the position is {distance} away from the solid, at parameter {parameter:?}")]
pub struct Miss {
    /// Distance to the nearest point that was found.
    pub distance: f64,
    /// Its parameter.
    pub parameter: [f64; 3],
}

impl<'a> Inverter<'a> {
    /// Returns the spline with boxes around the Bézier points of its spans, in a hierarchy.
    #[must_use]
    pub fn build(spline: &'a TrivariateSpline) -> Self {
        let n = spline.spans();
        let boxes: Vec<Bounds> = (0..n * n * n)
            .into_par_iter()
            .map(|at| Bounds::around(&spline.bezier_span([at % n, at / n % n, at / (n * n)])))
            .collect();
        let root = Node {
            bounds: boxes[0],
            low: [0; 3],
            high: [n; 3],
            children: 0,
        };
        let mut inverter = Self {
            spline,
            nodes: vec![root],
            diagonal: 0.0,
        };
        inverter.split(0, &boxes);
        let bounds = inverter.nodes[0].bounds;
        inverter.diagonal = (bounds.high - bounds.low).norm();
        inverter
    }

    /// Halves a node along its longest side until it is one span.
    fn split(&mut self, at: usize, boxes: &[Bounds]) {
        let Node { low, high, .. } = self.nodes[at];
        let longest = (0..3)
            .rev()
            .max_by_key(|&axis| high[axis] - low[axis])
            .unwrap_or(0);
        if high[longest] - low[longest] == 1 {
            let n = self.spline.spans();
            self.nodes[at].bounds = boxes[low[0] + n * (low[1] + n * low[2])];
            return;
        }
        let middle = low[longest].midpoint(high[longest]);
        let children = self.nodes.len();
        let (mut first, mut second) = (self.nodes[at], self.nodes[at]);
        first.high[longest] = middle;
        second.low[longest] = middle;
        self.nodes.extend([first, second]);
        self.nodes[at].children = children;
        self.split(children, boxes);
        self.split(children + 1, boxes);
        let joined = self.nodes[children]
            .bounds
            .joined(self.nodes[children + 1].bounds);
        self.nodes[at].bounds = joined;
    }

    /// Returns a parameter at which the spline comes within `tolerance` of a position, a length.
    ///
    /// Spans are tried in the order of the distance of their boxes, until none that is left can be nearer
    /// than the best: so the distance of a miss is a minimum wherever the steps from the starts of a
    /// span lead to its nearest point. Where the solid covers a position more than once, one of its
    /// parameters comes back.
    ///
    /// # Errors
    /// A position that is not reached; its distance is infinite if it is not finite.
    pub fn invert(&self, position: &Point3<f64>, tolerance: f64) -> Result<Inverse, Miss> {
        let mut best = Inverse {
            parameter: [0.5; 3],
            distance: f64::INFINITY,
        };
        if position.iter().all(|x| x.is_finite()) {
            let root = self.nodes[0].bounds.distance(position);
            let mut open = vec![(root, 0)];
            while let Some((distance, at)) = open.pop() {
                if distance >= best.distance || best.distance <= tolerance {
                    continue;
                }
                let node = &self.nodes[at];
                if node.children == 0 {
                    best = self.search(node.low, position, tolerance, best);
                    continue;
                }
                let child = |c: usize| (self.nodes[c].bounds.distance(position), c);
                let (a, b) = (child(node.children), child(node.children + 1));
                // The nearer child goes on top.
                open.extend(if a.0 <= b.0 { [b, a] } else { [a, b] });
            }
        }
        if best.distance <= tolerance {
            return Ok(best);
        }
        Err(Miss {
            distance: best.distance,
            parameter: best.parameter,
        })
    }

    /// Newton steps from the starts of a span, nearest first.
    fn search(
        &self,
        span: [usize; 3],
        position: &Point3<f64>,
        tolerance: f64,
        mut best: Inverse,
    ) -> Inverse {
        let scale = 1.0 / self.spline.spans() as f64;
        let mut starts: Vec<Inverse> = Vec::with_capacity(27);
        for at in 0..27 {
            let local = [STARTS[at % 3], STARTS[at / 3 % 3], STARTS[at / 9]];
            let parameter = std::array::from_fn(|d| (span[d] as f64 + local[d]) * scale);
            let distance = (self.spline.position(parameter) - position).norm();
            starts.push(Inverse {
                parameter,
                distance,
            });
        }
        starts.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        for start in starts.into_iter().take(4) {
            let found = self.descend(start, position);
            if found.distance < best.distance {
                best = found;
            }
            if best.distance <= tolerance {
                break;
            }
        }
        best
    }

    /// Damped Gauss-Newton steps inside of the cube.
    fn descend(&self, start: Inverse, position: &Point3<f64>) -> Inverse {
        let mut now = start;
        let mut damping = 0.0;
        for _ in 0..STEPS {
            let jet = self.spline.jet(now.parameter);
            let residual = position - jet.value;
            let Some(step) = step_inside(&jet.first, &residual, now.parameter, damping) else {
                break;
            };
            let parameter: [f64; 3] =
                std::array::from_fn(|d| (now.parameter[d] + step[d]).clamp(0.0, 1.0));
            let distance = (self.spline.position(parameter) - position).norm();
            if distance < now.distance {
                let gain = now.distance - distance;
                now = Inverse {
                    parameter,
                    distance,
                };
                damping *= 0.1;
                if gain <= 1e-3 * distance && gain <= 1e-15 * self.diagonal {
                    break;
                }
            } else {
                let size = jet
                    .first
                    .iter()
                    .map(Vector3::norm_squared)
                    .fold(0.0, f64::max);
                damping = if damping < 1e-9 * size {
                    1e-3 * size
                } else {
                    10.0 * damping
                };
                if damping > 1e9 * size {
                    break;
                }
            }
        }
        now
    }
}

/// The step of least squares with damping, in the parameters that are free to go where it leads.
fn step_inside(
    first: &[Vector3<f64>; 3],
    residual: &Vector3<f64>,
    at: [f64; 3],
    damping: f64,
) -> Option<Vector3<f64>> {
    let mut jacobian = Matrix3::from_columns(first);
    for _ in 0..3 {
        let gradient = jacobian.transpose() * residual;
        let scale = jacobian.norm_squared();
        let mut normal = jacobian.transpose() * jacobian;
        for d in 0..3 {
            // A fixed parameter keeps a row of its own.
            let fixed = jacobian.column(d).norm_squared() == 0.0;
            normal[(d, d)] += if fixed { 1.0 } else { damping + 1e-14 * scale };
        }
        let step = normal.cholesky()?.solve(&gradient);
        let leaves = |d: usize| (at[d] <= 0.0 && step[d] < 0.0) || (at[d] >= 1.0 && step[d] > 0.0);
        let Some(out) = (0..3).find(|&d| leaves(d)) else {
            return Some(step);
        };
        jacobian.column_mut(out).fill(0.0);
    }
    None
}
