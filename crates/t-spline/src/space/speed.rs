use super::tests::*;
use super::*;
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
