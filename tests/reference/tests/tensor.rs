//! T-splines over meshes without T-junctions against SciPy's tensor product of B-splines: tori, straight
//! and with their tops turned, and a cylinder with boundaries.

use std::collections::BTreeMap;
use std::sync::Arc;

use msplines_common::evaluate::Order;
use msplines_reference::Library;
use msplines_reference::python::Python;
use msplines_reference::record::Comparison;
use msplines_t_spline::caps::CapOptions;
use msplines_t_spline::complex::{Beyond, Cylinder, CylinderComplex, Point, Segment, UNITS};
use msplines_t_spline::support::Support;
use msplines_t_spline::tmesh::{Axis, Grid, TMesh};
use msplines_t_spline::{TSpline, TSplineSpace};
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde_json::json;

type Failure = Box<dyn std::error::Error>;

/// Rounding: the same sums in another order, relative to the largest value or derivative.
const ROUNDING: f64 = 1e-12;
/// Points of each surface.
const POINTS: usize = 2_000;
/// Orders of derivatives by `x` and `y`, as a T-spline has them.
const ORDERS: [[usize; 2]; 6] = [[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2]];
/// Columns and rows.
const COUNTS: [i64; 2] = [9, 7];
/// Their sizes, in units.
const SIZES: [i64; 2] = [(1 << 41) + 6, (3 << 39) + 10];

/// A surface without T-junctions, and by how many units its top is turned; none if it is open there.
struct Case {
    name: &'static str,
    spline: TSpline,
    turn: Option<i64>,
}

fn complex(turn: Option<i64>) -> CylinderComplex {
    let [circumference, height] = [0, 1].map(|d| COUNTS[d] * SIZES[d]);
    if let Some(turn) = turn {
        return CylinderComplex::torus(circumference, height, turn).expect("a torus");
    }
    let border = |index| {
        vec![Segment {
            start: 0,
            length: circumference,
            beyond: Beyond::Boundary { index },
            zero: None,
        }]
    };
    let cylinder = Cylinder {
        circumference,
        height,
        bottom: border(0),
        top: border(1),
    };
    CylinderComplex::build(vec![cylinder]).expect("a cylinder")
}

/// Returns the surface of random control points, with whole lines in the middle of a column and of a row
/// where it is not even.
fn case(name: &'static str, turn: Option<i64>, is_even: bool) -> Case {
    let grid = Grid {
        columns: COUNTS[0] as usize,
        rows: COUNTS[1] as usize,
    };
    let mut mesh = TMesh::build(&Arc::new(complex(turn)), &[grid]).expect("a mesh");
    if !is_even {
        for (axis, line) in [(Axis::X, 4), (Axis::Y, 0)] {
            for leaf in 0..mesh.leaves().len() as u32 {
                let own = mesh.leaves()[leaf as usize];
                let start = if axis == Axis::X {
                    own.x[0] / SIZES[0]
                } else {
                    own.y[0] / SIZES[1]
                };
                if start == line {
                    assert!(mesh.split(leaf, axis), "{name}");
                }
            }
        }
    }
    let space = TSplineSpace::build(mesh, &CapOptions::default()).expect("no caps");
    let mut random = Pcg64Mcg::seed_from_u64(21);
    let control = (0..space.unknowns())
        .map(|_| Vector3::from_fn(|_, _| random.random_range(-1.0..1.0)))
        .collect();
    Case {
        name,
        spline: TSpline::new(Arc::new(space), control),
        turn,
    }
}

/// Knots along both axes, in units of the form's 1, and control points `[x][y]` of a tensor product that is
/// the surface over its cylinder.
struct Tensor {
    knots: [Vec<f64>; 2],
    lattice: Vec<Vec<[f64; 3]>>,
}

/// Returns a coordinate that goes on beyond the ends of lines that repeat after `size`.
fn line(lines: &[i64], size: i64, index: i64) -> i64 {
    let count = lines.len() as i64;
    lines[index.rem_euclid(count) as usize] + size * index.div_euclid(count)
}

impl Case {
    fn tensor(&self) -> Tensor {
        let space = self.spline.space();
        let own = &space.mesh().complex().cylinders()[0];
        let [circumference, height] = [own.circumference, own.height];
        // Functions by the place of their anchors and by their outer knots, which tell those on borders
        // apart, in the order of their knots.
        let functions = || space.functions().iter();
        let key = |f: &Support| [f.node.x, f.node.y, f.y[0] + f.y[4]];
        let pairs = functions().zip(self.spline.control());
        let points: BTreeMap<[i64; 3], Vector3<f64>> =
            pairs.map(|(f, &point)| (key(f), point)).collect();
        assert_eq!(points.len(), functions().count(), "{}", self.name);
        let distinct = |axis: usize| {
            let mut found: Vec<i64> = points.keys().map(|key| key[axis]).collect();
            found.sort_unstable();
            found.dedup();
            found
        };
        let (xs, ys) = (distinct(0), distinct(1));
        let across = xs.len() as i64;
        let knots_x = (-3..=across + 3)
            .map(|i| line(&xs, circumference, i))
            .collect();
        // The rows of control points, each with the row of functions and how far that is turned.
        let (knots_y, rows): (Vec<i64>, Vec<([i64; 2], i64)>) = match self.turn {
            Some(turn) => {
                let along = ys.len() as i64;
                let knots = (-3..=along + 3).map(|j| line(&ys, height, j)).collect();
                let row = |j: i64| {
                    let y = ys[j.rem_euclid(along) as usize];
                    let keys = points.keys().find(|key| key[1] == y).expect("a row");
                    ([keys[1], keys[2]], turn * j.div_euclid(along))
                };
                (knots, (-1..=along + 1).map(row).collect())
            }
            None => {
                let column = functions().filter(|f| f.node.x == xs[0]);
                let rows: BTreeMap<[i64; 2], i64> = column
                    .map(|f| ([f.node.y, f.y[0] + f.y[4]], f.node.y + f.y[4]))
                    .collect();
                let knots = [0; 4].into_iter().chain(rows.values().copied()).collect();
                (knots, rows.into_keys().map(|key| (key, 0)).collect())
            }
        };
        let column = |i: i64| {
            let x = line(&xs, circumference, i);
            let point = |&([y, outer], turn): &([i64; 2], i64)| {
                points[&[(x + turn).rem_euclid(circumference), y, outer]].into()
            };
            rows.iter().map(point).collect()
        };
        Tensor {
            knots: [knots_x, knots_y]
                .map(|k: Vec<i64>| k.into_iter().map(|knot| knot as f64 / UNITS).collect()),
            lattice: (-1..=across + 1).map(column).collect(),
        }
    }

    /// Random points, a third of them on lines of the mesh, others on the lower border.
    fn points(&self) -> Vec<Point> {
        let mut random = Pcg64Mcg::seed_from_u64(22);
        let point = |place: usize| {
            let mut at = [0, 1].map(|d| random.random::<f64>() * (COUNTS[d] * SIZES[d]) as f64);
            if place.is_multiple_of(3) {
                let axis = place / 3 % 2;
                at[axis] = (random.random_range(0..COUNTS[axis]) * SIZES[axis]) as f64;
            }
            Point {
                cylinder: 0,
                x: at[0],
                y: at[1],
            }
        };
        (0..POINTS).map(point).collect()
    }
}

#[test]
fn meshes_without_t_junctions_are_tensor_products() -> Result<(), Failure> {
    let mut python = Python::start()?;
    let why = "relative to the largest value or derivative";
    let names = ["values", "first derivatives", "second derivatives"];
    let mut comparisons = names.map(|name| {
        Comparison::new(
            &format!("{name} of T-splines"),
            Library::Scipy,
            ROUNDING,
            why,
        )
    });
    let cases = [
        case("torus", Some(0), true),
        case("torus turned by four columns", Some(4 * SIZES[0]), true),
        case("torus with two whole lines more", Some(0), false),
        case("cylinder", None, true),
        case("cylinder with two whole lines more", None, false),
    ];
    for case in cases {
        let Tensor { knots, lattice } = case.tensor();
        let points = case.points();
        let at: Vec<[f64; 2]> = points.iter().map(|p| [p.x / UNITS, p.y / UNITS]).collect();
        let question =
            json!({"knots": knots, "lattice": lattice, "parameters": at, "orders": ORDERS});
        let theirs: Vec<Vec<[f64; 3]>> = python.ask("tensor_points", &question)?;
        let ours = case.spline.evaluate(&points, Order::Second);
        for (entry, theirs) in theirs.iter().enumerate() {
            let ours = |i: usize| match entry {
                0 => ours.positions[i].coords,
                1 | 2 => ours.first[i][entry - 1],
                _ => ours.second[i][entry - 3],
            };
            assert_eq!(theirs.len(), POINTS, "{}", case.name);
            let theirs = theirs.iter().map(|&v| Vector3::from(v));
            let scale = theirs.clone().map(|v| v.norm()).fold(0.0, f64::max);
            let order: usize = ORDERS[entry].iter().sum();
            let apart = theirs
                .enumerate()
                .map(|(i, v)| (ours(i) - v).norm() / scale);
            comparisons[order].add(case.name, apart);
        }
    }
    comparisons.into_iter().for_each(Comparison::finish);
    Ok(())
}
