//! Rows against tensor products, sums over all images, differences, and their laws.

use std::sync::Arc;

use msplines_common::evaluate::Order;

use super::*;
use crate::blend::tests::recursion;
use crate::complex::{Beyond, CylinderComplex, Point};
use crate::samples::{
    Sequence, large_double_torus, large_torus, open_cylinder, random_mesh, surfaces_with_zeros,
};
use crate::tmesh::Grid;
use crate::tmesh::tests::{met, unrolled};

const GRID: Grid = Grid {
    columns: 5,
    rows: 2,
};

pub(crate) fn random_space(
    complex: &Arc<CylinderComplex>,
    splits: usize,
    seed: u64,
) -> TSplineSpace {
    let mesh = random_mesh(complex, GRID, splits, seed);
    TSplineSpace::build(mesh, &CapOptions::default()).expect("caps")
}

pub(crate) fn random_points(complex: &CylinderComplex, count: usize, seed: u64) -> Vec<Point> {
    let mut numbers = Sequence(seed);
    let cylinders = complex.cylinders();
    let point = |i: usize| {
        let cylinder = i % cylinders.len();
        let own = &cylinders[cylinder];
        Point {
            cylinder: cylinder as u32,
            x: numbers.unit() * own.circumference as f64,
            y: numbers.unit() * own.height as f64,
        }
    };
    (0..count).map(point).collect()
}

fn surfaces() -> Vec<Arc<CylinderComplex>> {
    let mut surfaces = surfaces_with_zeros();
    surfaces.extend([
        large_torus(0.37),
        open_cylinder(Beyond::Boundary { index: 1 }),
        open_cylinder(Beyond::Pole { index: 0 }),
    ]);
    surfaces
}

#[test]
fn rows_are_a_partition_of_unity() {
    for (seed, complex) in surfaces().into_iter().enumerate() {
        let space = random_space(&complex, 60, seed as u64);
        let mut points = random_points(&complex, 4000, 1);
        points.extend(space.functions().iter().map(|f| Point::from(f.node)));
        let rows = space.rows(&points, Order::Second);
        let constant = |unknown: u32| {
            let in_cap = (unknown as usize).checked_sub(space.functions().len());
            // Of a polynomial, the coefficient of 1.
            in_cap.is_none_or(|k| {
                let caps = space.caps().caps();
                caps.iter().any(|c| c.offset as usize == k)
            })
        };
        for (i, point) in points.iter().enumerate() {
            let row = rows.row(i);
            let sum = |value: &dyn Fn(usize) -> f64| -> [f64; 2] {
                let ones = (0..row.unknowns.len()).filter(|&k| constant(row.unknowns[k]));
                ones.fold([0.0; 2], |[s, a], k| [s + value(k), a + value(k).abs()])
            };
            let [values, _] = sum(&|k| row.values[k]);
            assert!((values - 1.0).abs() < 1e-13, "{point:?} {values}");
            for d in 0..2 {
                let [first, size] = sum(&|k| row.first[k][d]);
                assert!(first.abs() <= 1e-12 * (1.0 + size), "{first} of {size}");
            }
            for d in 0..3 {
                let [second, size] = sum(&|k| row.second[k][d]);
                assert!(second.abs() <= 1e-11 * (1.0 + size), "{second} of {size}");
            }
        }
    }
}

/// Returns the least sum of functions outside of cores: at random, at anchors, and on lines above and
/// below them, as above zeros nothing but what is anchored there is positive.
fn least_sum(space: &TSplineSpace, seed: u64) -> f64 {
    let complex = space.mesh().complex();
    let mut points = random_points(complex, 3000, seed);
    for f in space.functions() {
        let height = complex.cylinders()[f.node.cylinder as usize].height as f64;
        points.push(Point::from(f.node));
        points.extend((0..20).map(|k| Point {
            y: height * f64::from(k) / 19.0,
            ..Point::from(f.node)
        }));
    }
    points.retain(|&p| space.caps().at(p).is_none_or(|c| c.rest.0[0] > 0.0));
    space
        .sums(&points)
        .into_iter()
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn sums_are_positive_outside_of_cores() {
    for complex in surfaces() {
        for seed in 0..12 {
            let least = least_sum(&random_space(&complex, 8 * seed, seed as u64), seed as u64);
            assert!(least > 1e-3, "{least} after {} splits", 8 * seed);
        }
        // The coarsest grids there are.
        for columns in 1..4 {
            let mesh = random_mesh(&complex, Grid { columns, rows: 1 }, 0, 0);
            let space = TSplineSpace::build(mesh, &CapOptions::default()).expect("caps");
            let least = least_sum(&space, 1);
            assert!(
                least > 1e-4,
                "{least} with {columns} columns, {:?}",
                complex.cylinders()
            );
        }
    }
}

#[test]
fn even_meshes_of_tori_are_periodic_tensor_products() {
    let (columns, rows) = (8_i64, 6_i64);
    for shift in [0, 3] {
        let (w, h) = (1_i64 << 40, 3_i64 << 38);
        let size = [columns * w, rows * h];
        let complex = CylinderComplex::torus(size[0], size[1], shift * w).expect("a torus");
        let grid = Grid {
            columns: columns as usize,
            rows: rows as usize,
        };
        let mesh = TMesh::build(&Arc::new(complex), &[grid]).expect("a mesh");
        let space = TSplineSpace::build(mesh, &CapOptions::default()).expect("no caps");
        assert_eq!(space.unknowns(), (columns * rows) as usize);
        let points = random_points(space.mesh().complex(), 500, 7);
        let found = space.rows(&points, Order::Value);
        for (i, point) in points.iter().enumerate() {
            let mut dense = vec![0.0; space.unknowns()];
            let row = found.row(i);
            for (&unknown, value) in row.unknowns.iter().zip(row.values) {
                dense[unknown as usize] += value;
            }
            let [s, t] = [point.x / w as f64, point.y / h as f64];
            let mut expected = vec![0.0; space.unknowns()];
            for (a, b) in (-3..columns + 3).flat_map(|a| (-3..rows + 3).map(move |b| (a, b))) {
                let knots = |c: i64| [-2, -1, 0, 1, 2].map(|k| (c + k) as f64);
                let value = recursion(&knots(a), 3, s) * recursion(&knots(b), 3, t);
                // Over the top it goes on, shifted.
                let column = (a + shift * b.div_euclid(rows)).rem_euclid(columns);
                let node = [column * w, b.rem_euclid(rows) * h];
                let own = space.functions().iter();
                let mut own = own.map(|f| [f.node.x, f.node.y]);
                expected[own.position(|n| n == node).expect("an anchor")] += value;
            }
            for (a, b) in dense.iter().zip(&expected) {
                assert!((a - b).abs() < 1e-13, "{a} {b}");
            }
        }
    }
}

#[test]
fn meshes_of_any_torus_are_sums_over_all_images_in_the_plane() {
    for (seed, twist) in [0.3717, 0.93].into_iter().enumerate() {
        let complex = large_torus(twist);
        let mesh = random_mesh(&complex, GRID, 8, seed as u64);
        let boxes = unrolled(&mesh);
        let space = TSplineSpace::build(mesh, &CapOptions::default()).expect("no caps");
        let Beyond::Cylinder { start: twist, .. } = complex.cylinders()[0].top[0].beyond else {
            panic!("a torus");
        };
        let [c, h] = [
            complex.cylinders()[0].circumference,
            complex.cylinders()[0].height,
        ];
        let points = random_points(&complex, 200, seed as u64);
        let mut sums = vec![vec![0.0; space.unknowns()]; points.len()];
        for (index, function) in space.functions().iter().enumerate() {
            let from = [function.node.x, function.node.y];
            let knots = [0, 1].map(|axis| {
                let [low, high] = [-1, 1].map(|sign| met(&boxes, from, axis, sign));
                [-low[1], -low[0], 0, high[0], high[1]]
            });
            for (p, q) in (-8..=8_i64).flat_map(|p| (-4..=4_i64).map(move |q| (p, q))) {
                let at = [from[0] + p * c - q * twist, from[1] + q * h];
                for (point, sums) in points.iter().zip(&mut sums) {
                    let value = |axis: usize, t: f64| {
                        let knots = knots[axis].map(|k| (at[axis] + k) as f64);
                        recursion(&knots, 3, t)
                    };
                    sums[index] += value(0, point.x) * value(1, point.y);
                }
            }
        }
        let rows = space.rows(&points, Order::Value);
        for (i, sums) in sums.iter().enumerate() {
            let total: f64 = sums.iter().sum();
            let row = rows.row(i);
            let mut dense = vec![0.0; space.unknowns()];
            for (&unknown, value) in row.unknowns.iter().zip(row.values) {
                dense[unknown as usize] += value;
            }
            for (a, b) in dense.iter().zip(sums) {
                assert!((a - b / total).abs() < 1e-13, "{a} {}", b / total);
            }
        }
    }
}

#[test]
fn rows_are_the_same_bits_on_any_number_of_threads_and_in_used_memory() {
    let complex = large_double_torus();
    let space = random_space(&complex, 100, 3);
    let points = random_points(&complex, 3000, 3);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(|| {
            let space = random_space(&complex, 100, 3);
            let rows = space.rows(&points, Order::Second);
            (space, rows)
        })
    };
    let (one, three) = (on(1), on(3));
    assert_eq!(one, three);
    assert_eq!(one.0, space);
    let mut used = space.rows(&points[..1000], Order::First);
    space.rows_into(&points, Order::Second, &mut used);
    assert_eq!(used, one.1);
    // Lower orders are the same numbers.
    let values = space.rows(&points, Order::Value);
    for i in 0..points.len() {
        assert_eq!(values.row(i).values, used.row(i).values);
        assert!(values.row(i).first.is_empty() && values.row(i).second.is_empty());
    }
}

#[test]
fn refinement_keeps_functions_that_it_does_not_meet() {
    let complex = large_double_torus();
    let coarse = random_space(&complex, 40, 9);
    let mut mesh = coarse.mesh().clone();
    let split = mesh.leaves()[10];
    mesh.split(10, crate::tmesh::Axis::Both);
    let fine = TSplineSpace::with_caps(mesh, coarse.caps().clone());
    let twins = fine.counterparts(&coarse);
    assert_eq!(twins.len(), fine.unknowns());
    let kept: Vec<u32> = twins.iter().flatten().copied().collect();
    // No anchor is lost, and the coefficients of caps stay.
    assert_eq!(kept, (0..coarse.unknowns() as u32).collect::<Vec<_>>());
    assert!(fine.unknowns() > coarse.unknowns());
    let same = |function: usize, twin: u32| {
        fine.functions()[function] == coarse.functions()[twin as usize]
    };
    let functions = fine.functions().len();
    let pairs = || twins[..functions].iter().enumerate();
    let changed = pairs().filter(|(f, t)| t.is_some_and(|t| !same(*f, t)));
    let changed = changed.count();
    assert!(changed > 0 && changed < 40, "{changed}");
    // Where all functions are old ones, so are their values.
    let points = random_points(&complex, 3000, 4);
    let [new, old] = [&fine, &coarse].map(|s| s.rows(&points, Order::First));
    let mut equal = 0;
    for i in 0..points.len() {
        let (new, old) = (new.row(i), old.row(i));
        let all = new.unknowns.iter().all(|&u| {
            let u = u as usize;
            twins[u].is_some_and(|t| u >= functions || same(u, t))
        });
        if all && new.unknowns.len() == old.unknowns.len() {
            assert_eq!((new.values, new.first), (old.values, old.first));
            equal += 1;
        }
    }
    assert!(equal > 1500, "{equal} beside {split:?}");
}
