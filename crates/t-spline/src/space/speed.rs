use super::tests::*;
use super::*;
use crate::tmesh::Grid;
use crate::tmesh::tests::*;
use msplines_common::evaluate::Order;
use std::time::Instant;

#[test]
#[ignore = "a measurement"]
fn speed() {
    let complex = large_double_torus();
    for splits in [100, 700] {
        let t = Instant::now();
        let space = random_space(&complex, splits, 3);
        println!(
            "mesh+space {:?} functions {} leaves {} entries {}",
            t.elapsed(),
            space.functions().len(),
            space.mesh().leaves().len(),
            space.entries.len()
        );
        let points = random_points(&complex, 50_000, 3);
        let mut rows = Rows::default();
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| {
                let mut best = f64::MAX;
                for _ in 0..5 {
                    let t = Instant::now();
                    let s = TSplineSpace::with_caps(space.mesh().clone(), space.caps().clone());
                    best = best.min(t.elapsed().as_secs_f64());
                    assert!(s.unknowns() > 0);
                }
                println!("{threads} threads: rebuild {:.2} ms", best * 1e3);
                for order in [Order::Value, Order::First, Order::Second] {
                    let mut best = f64::MAX;
                    for _ in 0..8 {
                        let t = Instant::now();
                        space.rows_into(&points, order, &mut rows);
                        best = best.min(t.elapsed().as_secs_f64());
                    }
                    let n: usize = (0..points.len()).map(|i| rows.row(i).unknowns.len()).sum();
                    println!(
                        "{threads} threads {order:?}: {:.2} ms, {:.2} per point",
                        best * 1e3,
                        n as f64 / 5e4
                    );
                }
                let t = Instant::now();
                for &p in &points {
                    std::hint::black_box(space.mesh.leaf_of(p));
                }
                println!("leaf_of {:?}", t.elapsed());
                let t = Instant::now();
                for &p in &points {
                    std::hint::black_box(space.caps.at(p));
                }
                println!("caps.at {:?}", t.elapsed());
                let scan: usize = points
                    .iter()
                    .map(|&p| space.entries(space.mesh.leaf_of(p)).len())
                    .sum();
                println!("entries per point {}", scan as f64 / 5e4);
            });
        }
    }
}

#[test]
#[ignore = "a measurement"]
fn coverage() {
    use crate::complex::Point;
    let mut numbers = Sequence(77);
    for caps in [1.0, 0.5, 0.25] {
        let mut all = Vec::new();
        for case in 0..300_u64 {
            let complex = match case % 3 {
                0 => surfaces_with_zeros().swap_remove((case / 3 % 4) as usize),
                1 => double_zero(numbers.unit()),
                _ => twisted_double_torus([numbers.unit(), numbers.unit(), numbers.unit()]),
            };
            let grid = Grid {
                columns: 1 + (numbers.next() % 5) as usize,
                rows: 1 + (numbers.next() % 3) as usize,
            };
            let splits = (numbers.next() % 60) as usize;
            let mesh = random_mesh(&complex, grid, splits, case);
            let mut space = TSplineSpace::build(mesh, &CapOptions::default()).unwrap();
            for cap in 0..space.caps().caps().len() as u32 {
                let limit = space.caps().caps()[cap as usize].limit;
                space.caps_mut().set_radius(cap, caps * limit);
            }
            let mut points = random_points(&complex, 2000, case);
            for f in space.functions() {
                let own = &complex.cylinders()[f.node.cylinder as usize];
                for y in 0..20 {
                    points.push(Point {
                        y: own.height as f64 * f64::from(y) / 19.0,
                        ..Point::from(f.node)
                    });
                    points.push(Point {
                        x: own.circumference as f64 * f64::from(y) / 20.0,
                        ..Point::from(f.node)
                    });
                }
            }
            points.retain(|&p| space.caps().at(p).is_none_or(|c| c.rest.0[0] > 0.0));
            let least = space
                .sums(&points)
                .into_iter()
                .fold(f64::INFINITY, f64::min);
            all.push((least, case, grid, splits));
        }
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        println!("caps {caps}: {:?} median {}", &all[..6], all[150].0);
    }
}
