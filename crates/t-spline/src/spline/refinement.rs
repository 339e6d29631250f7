//! What refinement without a new fit leaves of a surface: all of it where whole lines are added to an even
//! mesh, and everywhere else what lies outside of the supports that are new or change.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use msplines_common::Vector3;
use msplines_common::evaluate::Order;
use nalgebra::DMatrix;

use super::TSpline;
use super::tests::jets;
use crate::caps::CapOptions;
use crate::complex::{CylinderComplex, Node, Point};
use crate::samples::{Sequence, large_torus, open_cylinder, random_mesh, surfaces_with_zeros};
use crate::space::TSplineSpace;
use crate::space::tests::random_points;
use crate::tmesh::{Axis, Grid, TMesh};

type Vectors = BTreeMap<(i64, i64), Vector3<f64>>;

/// Columns and rows, of whole lengths.
const COUNTS: [i64; 2] = [8, 6];
const SIZES: [i64; 2] = [1 << 40, 3 << 38];
/// Rounding of values, first and second derivatives, relative to sums of what is added: a few terms more
/// than there are functions at a point.
const ROUNDING: [f64; 6] = [2e-15, 1e-14, 1e-14, 1e-13, 1e-13, 1e-13];

/// The even mesh of a torus whose top is turned by so many columns.
fn even(shift: i64) -> TMesh {
    let [w, h] = SIZES;
    let complex = CylinderComplex::torus(COUNTS[0] * w, COUNTS[1] * h, shift * w).expect("a torus");
    let [columns, rows] = COUNTS.map(|n| n as usize);
    TMesh::build(&Arc::new(complex), &[Grid { columns, rows }]).expect("a mesh")
}

fn space(mesh: TMesh) -> Arc<TSplineSpace> {
    Arc::new(TSplineSpace::build(mesh, &CapOptions::default()).expect("caps"))
}

fn random_control(count: usize, seed: u64) -> Vec<Vector3<f64>> {
    let mut numbers = Sequence(seed);
    let vector = |_| Vector3::from_fn(|_, _| numbers.unit() - 0.5);
    (0..count).map(vector).collect()
}

/// Returns the control points of a space by the place of their anchors, in halves of columns and rows.
fn by_halves(space: &TSplineSpace, control: &[Vector3<f64>]) -> Vectors {
    let key = |node: Node| (2 * node.x / SIZES[0], 2 * node.y / SIZES[1]);
    let pairs = space.functions().iter().zip(control);
    pairs.map(|(f, &point)| (key(f.node), point)).collect()
}

/// Returns the point of an even mesh at a place in halves, which may be beyond its borders.
fn wrapped(points: &Vectors, shift: i64, [a, b]: [i64; 2]) -> Vector3<f64> {
    let [columns, rows] = COUNTS.map(|n| 2 * n);
    let turned = a + 2 * shift * b.div_euclid(rows);
    points[&(turned.rem_euclid(columns), b.rem_euclid(rows))]
}

/// Returns the points that knots in the middle of every interval along an axis give: at knots of before
/// (1, 6, 1) / 8 of those there and beside, at new ones the middle of two.
fn inserted(points: &Vectors, shift: i64, axis: usize) -> Vectors {
    let mut found = points.clone();
    for &(a, b) in points.keys() {
        let [before, here, after] = [-2, 0, 2].map(|by| {
            let there = if axis == 0 { [a + by, b] } else { [a, b + by] };
            wrapped(points, shift, there)
        });
        let between = if axis == 0 { (a + 1, b) } else { (a, b + 1) };
        found.insert((a, b), (before + here * 6.0 + after) / 8.0);
        found.insert(between, (here + after) / 2.0);
    }
    found
}

/// Returns the largest differences of values and derivatives, relative to the sums of the sizes of what is
/// added to find them.
fn differences(one: &TSpline, other: &TSpline, points: &[Point]) -> [f64; 6] {
    let rows = one.space().rows(points, Order::Second);
    let mut largest = [0.0_f64; 6];
    let pairs = jets(one, points).into_iter().zip(jets(other, points));
    for (i, (a, b)) in pairs.enumerate() {
        let row = rows.row(i);
        for d in 0..6 {
            let factor = |k: usize| match d {
                0 => row.values[k],
                1 | 2 => row.first[k][d - 1],
                _ => row.second[k][d - 3],
            };
            let sizes = row.unknowns.iter().enumerate();
            let sizes = sizes.map(|(k, &u)| factor(k).abs() * one.control()[u as usize].norm());
            largest[d] = largest[d].max((a[d] - b[d]).norm() / sizes.sum::<f64>());
        }
    }
    largest
}

/// [He2006] has no law of refinement; on even meshes T-splines are tensor products, whose is that of
/// Boehm.
#[test]
fn refining_all_of_an_even_mesh_is_knot_insertion() {
    for shift in [0, 3] {
        let coarse = space(even(shift));
        let control = random_control(coarse.unknowns(), 4);
        for (axis, axes) in [(Axis::X, &[0][..]), (Axis::Y, &[1]), (Axis::Both, &[0, 1])] {
            let mut mesh = even(shift);
            for leaf in 0..mesh.leaves().len() as u32 {
                assert!(mesh.split(leaf, axis));
            }
            let fine = space(mesh);
            let points = axes
                .iter()
                .fold(by_halves(&coarse, &control), |points, &axis| {
                    inserted(&points, shift, axis)
                });
            assert_eq!(fine.unknowns(), coarse.unknowns() << axes.len());
            let refined = fine
                .functions()
                .iter()
                .map(|f| points[&(2 * f.node.x / SIZES[0], 2 * f.node.y / SIZES[1])]);
            let refined = TSpline::new(Arc::clone(&fine), refined.collect());
            let before = TSpline::new(Arc::clone(&coarse), control.clone());
            let places = random_points(fine.mesh().complex(), 3000, 5);
            let found = differences(&refined, &before, &places);
            let is_same = found.iter().zip(ROUNDING).all(|(a, b)| *a < b);
            assert!(is_same, "{axis:?}, top turned by {shift}: {found:?}");
        }
    }
}

/// One line around the torus in the middle of a column: knots are no longer even, the surface is the same.
#[test]
fn a_whole_line_is_a_knot() {
    let coarse = space(even(0));
    let control = random_control(coarse.unknowns(), 6);
    let column = 3;
    let mut mesh = even(0);
    for leaf in 0..mesh.leaves().len() as u32 {
        if mesh.leaves()[leaf as usize].x[0] == column * SIZES[0] {
            mesh.split(leaf, Axis::X);
        }
    }
    let fine = space(mesh);
    let old = by_halves(&coarse, &control);
    let refined = fine.functions().iter().map(|f| {
        let (a, b) = (2 * f.node.x / SIZES[0], 2 * f.node.y / SIZES[1]);
        let at = |column: i64| wrapped(&old, 0, [2 * column, b]);
        // Shares of the next point: how far along its three intervals the new knot lies.
        match a - 2 * column {
            0 => at(column - 1) / 6.0 + at(column) * (5.0 / 6.0),
            1 => (at(column) + at(column + 1)) / 2.0,
            2 => at(column + 1) * (5.0 / 6.0) + at(column + 2) / 6.0,
            _ => old[&(a, b)],
        }
    });
    let refined = TSpline::new(Arc::clone(&fine), refined.collect());
    let before = TSpline::new(coarse, control);
    let places = random_points(fine.mesh().complex(), 3000, 7);
    let found = differences(&refined, &before, &places);
    assert!(found.iter().zip(ROUNDING).all(|(a, b)| *a < b), "{found:?}");
}

/// Returns the unknowns of a finer space that are new or whose knots changed, and those of the coarser
/// one whose knots changed.
fn touched(fine: &TSplineSpace, coarse: &TSplineSpace) -> [BTreeSet<u32>; 2] {
    let twins = fine.counterparts(coarse);
    let mut found = [BTreeSet::new(), BTreeSet::new()];
    for (own, twin) in fine.functions().iter().zip(0_u32..) {
        match twins[twin as usize] {
            Some(old) if coarse.functions()[old as usize] == *own => {}
            Some(old) => {
                found[0].insert(twin);
                found[1].insert(old);
            }
            None => {
                found[0].insert(twin);
            }
        }
    }
    found
}

/// Whatever new control points are, and wherever a leaf is split, over zeros too.
#[test]
fn a_local_refinement_changes_the_surface_only_in_supports_that_it_touches() {
    let mut surfaces = surfaces_with_zeros();
    surfaces.extend([
        large_torus(0.37),
        open_cylinder(crate::complex::Beyond::Boundary { index: 1 }),
        open_cylinder(crate::complex::Beyond::Pole { index: 0 }),
    ]);
    let grid = Grid {
        columns: 9,
        rows: 6,
    };
    for (seed, complex) in (0_u64..).zip(surfaces) {
        let mesh = random_mesh(&complex, grid, 30, seed);
        let coarse = space(mesh.clone());
        let before = TSpline::new(Arc::clone(&coarse), random_control(coarse.unknowns(), seed));
        let points = random_points(&complex, 4000, seed);
        let old = jets(&before, &points);
        let mut moved = 0.0_f64;
        for (leaf, axis) in [(5, Axis::X), (17, Axis::Y), (40, Axis::Both)] {
            let mut mesh = mesh.clone();
            assert!(mesh.split(leaf, axis));
            let fine = Arc::new(TSplineSpace::with_caps(mesh, coarse.caps().clone()));
            let twins = fine.counterparts(&coarse);
            let mut control = random_control(fine.unknowns(), seed + 100);
            for (own, twin) in control.iter_mut().zip(&twins) {
                if let Some(twin) = twin {
                    *own = before.control()[*twin as usize];
                }
            }
            let after = TSpline::new(Arc::clone(&fine), control);
            let new = jets(&after, &points);
            let [fresh, stale] = touched(&fine, &coarse);
            let rows = [&fine, &coarse].map(|space| space.rows(&points, Order::Value));
            let (mut inside, mut largest) = (0, 0.0_f64);
            for i in 0..points.len() {
                let meets = |which: usize, set: &BTreeSet<u32>| {
                    rows[which].row(i).unknowns.iter().any(|u| set.contains(u))
                };
                if meets(0, &fresh) || meets(1, &stale) {
                    inside += 1;
                    largest = largest.max((new[i][0] - old[i][0]).norm());
                } else {
                    assert_eq!(new[i], old[i], "{:?}", points[i]);
                }
            }
            assert!(inside < points.len() * 3 / 4, "{inside}");
            moved = moved.max(largest);
        }
        // The law is sharp: the surface does move where it may.
        assert!(moved > 1e-3, "{moved:e}");
    }
}

/// Returns how far a surface is from the nearest one of another space, by root mean squares at points.
fn least_squares(of: &TSpline, within: &TSplineSpace, points: &[Point]) -> f64 {
    let rows = within.rows(points, Order::Value);
    let mut matrix = DMatrix::zeros(points.len(), within.unknowns());
    for i in 0..points.len() {
        let row = rows.row(i);
        for (&unknown, value) in row.unknowns.iter().zip(row.values) {
            matrix[(i, unknown as usize)] += value;
        }
    }
    let values = of.evaluate(points, Order::Value).positions;
    let values = DMatrix::from_fn(points.len(), 3, |i, d| values[i][d]);
    let found = matrix
        .clone()
        .svd(true, true)
        .solve(&values, 1e-13)
        .expect("both bases");
    (matrix * found - values).norm() / (points.len() as f64).sqrt()
}

/// A T-mesh with one split face has functions that no refinement of the even ones are.
#[test]
fn spaces_are_nested_where_lines_are_whole_and_else_not_always() {
    let coarse = space(even(0));
    let surface = TSpline::new(Arc::clone(&coarse), random_control(coarse.unknowns(), 8));
    let points = random_points(coarse.mesh().complex(), 2000, 9);
    let split = |leaves: &dyn Fn(&[i64; 2]) -> bool, axis: Axis| {
        let mut mesh = even(0);
        for leaf in 0..mesh.leaves().len() as u32 {
            let own = mesh.leaves()[leaf as usize];
            if leaves(&[own.x[0] / SIZES[0], own.y[0] / SIZES[1]]) {
                mesh.split(leaf, axis);
            }
        }
        space(mesh)
    };
    let line = least_squares(&surface, &split(&|at| at[0] == 3, Axis::X), &points);
    let face = least_squares(&surface, &split(&|at| *at == [3, 2], Axis::Both), &points);
    assert!(line < 1e-13, "{line:e}");
    assert!(face > 1e-4, "{face:e}");
}
