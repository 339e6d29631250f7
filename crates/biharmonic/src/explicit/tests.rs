//! The small solvers against what defines their results.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::quadratic::{Block, minimise};
use super::small::invert;

fn random_definite(size: usize, rank: usize, random: &mut Pcg64Mcg) -> Vec<f64> {
    let factor: Vec<f64> = (0..size * rank)
        .map(|_| random.random::<f64>() - 0.5)
        .collect();
    let entry = |a: usize, b: usize| -> f64 {
        (0..rank)
            .map(|k| factor[a * rank + k] * factor[b * rank + k])
            .sum()
    };
    (0..size * size)
        .map(|at| entry(at / size, at % size))
        .collect()
}

#[test]
fn the_inverse_of_a_small_matrix_gives_the_identity() {
    const TOLERANCE: f64 = 1e-10; // condition about 1e4
    let mut random = Pcg64Mcg::seed_from_u64(1);
    for size in [1, 2, 7, 19] {
        let matrix = random_definite(size, size + 3, &mut random);
        let mut inverse = matrix.clone();
        invert(&mut inverse, size);
        for a in 0..size {
            for b in 0..size {
                let product: f64 = (0..size)
                    .map(|k| matrix[a * size + k] * inverse[k * size + b])
                    .sum();
                assert!((product - f64::from(u8::from(a == b))).abs() < TOLERANCE);
            }
        }
    }
}

/// Blocks on a ring of rows, each with five unknowns, semidefinite, with bounds that some meet.
fn ring_of_blocks(rows: u32) -> Vec<Block> {
    let mut random = Pcg64Mcg::seed_from_u64(2);
    (0..rows)
        .map(|j| {
            let mut places: Vec<u32> = (0..5).map(|k| (j + rows + k - 2) % rows).collect();
            places.sort_unstable();
            let bound = |own: f64, other: f64| {
                let pick = |&row: &u32| if row == j { own } else { other };
                places.iter().map(pick).collect::<Vec<f64>>()
            };
            Block {
                hessian: random_definite(5, 3, &mut random),
                lower: bound(0.5, -0.1),
                upper: bound(1.5, 0.6),
                start: bound(0.6, 0.1),
                rows: places,
            }
        })
        .collect()
}

/// For a convex programme the conditions of Karush, Kuhn and Tucker are sufficient.
#[test]
fn a_minimum_meets_the_optimality_conditions() {
    const TOLERANCE: f64 = 1e-7;
    let rows = 40;
    let blocks = ring_of_blocks(rows);
    let minimum = minimise(rows as usize, &blocks).unwrap();
    assert!(minimum.converged && minimum.iterations < 25);
    let (y, bounds) = &minimum.multipliers;
    let mut sums = vec![0.0; rows as usize];
    let mut active = 0;
    for ((block, x), [z, v]) in blocks.iter().zip(&minimum.unknowns).zip(bounds) {
        for a in 0..5 {
            let row = block.rows[a] as usize;
            sums[row] += x[a];
            let gradient: f64 = (0..5).map(|b| block.hessian[a * 5 + b] * x[b]).sum();
            assert!((gradient - y[row] - z[a] + v[a]).abs() < TOLERANCE);
            let (below, above) = (x[a] - block.lower[a], block.upper[a] - x[a]);
            assert!(below > 0.0 && above > 0.0 && z[a] > 0.0 && v[a] > 0.0);
            assert!(below * z[a] < TOLERANCE && above * v[a] < TOLERANCE);
            active += usize::from(below < 1e-5) + usize::from(above < 1e-5);
        }
    }
    assert!(sums.iter().all(|sum| (sum - 1.0).abs() < 1e-12), "{sums:?}");
    assert!(active > 10, "{active}: bounds that do nothing test nothing");
}

#[test]
fn without_energy_the_start_is_the_minimum() {
    let mut blocks = ring_of_blocks(12);
    blocks.iter_mut().for_each(|block| block.hessian.fill(0.0));
    let minimum = minimise(12, &blocks).unwrap();
    assert!(minimum.converged);
    for (block, x) in blocks.iter().zip(&minimum.unknowns) {
        assert_eq!(&block.start, x);
    }
}
