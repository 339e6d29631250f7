//! Fits of a ball over the cube.

use divan::Bencher;
use msplines_common::Point3;
use msplines_common::progress::unobserved;
use msplines_trivariate::VolumeSamples;
use msplines_trivariate::fit::{least_squares, multilevel};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

fn main() {
    divan::main();
}

fn ball(at: [f64; 3]) -> Point3<f64> {
    let [x, y, z] = at.map(|t| 2.0 * t - 1.0);
    let stretch = |a: f64, b: f64, c: f64| {
        a * (1.0 - (b * b + c * c) / 2.0 + b * b * c * c / 3.0)
            .max(0.0)
            .sqrt()
    };
    Point3::new(stretch(x, y, z), stretch(y, z, x), stretch(z, x, y))
}

fn samples(count: usize) -> VolumeSamples {
    let mut random = Pcg64Mcg::seed_from_u64(1);
    let mut parameters = Vec::with_capacity(count);
    for _ in 0..count {
        let mut at: [f64; 3] = std::array::from_fn(|_| random.random());
        if random.random::<f64>() < 0.3 {
            at[random.random_range(0..3)] = f64::from(random.random_range(0..2_u8));
        }
        parameters.push(at);
    }
    let points = parameters.iter().map(|&at| ball(at)).collect();
    VolumeSamples::build(parameters, points).expect("samples")
}

#[divan::bench(args = [100_000, 300_000], sample_count = 10)]
fn multilevel_through_64(bencher: Bencher<'_, '_>, count: usize) {
    let samples = samples(count);
    let options = multilevel::Options::PAPER;
    bencher.bench_local(|| multilevel::fit(&samples, &options, &mut unobserved()));
}

#[divan::bench(args = [(100_000, 16), (100_000, 32), (300_000, 32)], sample_count = 3)]
fn least_squares_through(bencher: Bencher<'_, '_>, (count, finest): (usize, usize)) {
    let samples = samples(count);
    let options = least_squares::Options {
        finest,
        ..Default::default()
    };
    bencher.bench_local(|| least_squares::fit(&samples, &options, &mut unobserved()));
}
