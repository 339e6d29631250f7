//! T-splines of generated surfaces: domain, fit, rows.

use std::sync::Arc;

use divan::Bencher;
use msplines_common::evaluate::Order;
use msplines_common::mesh::shapes;
use msplines_common::progress::unobserved;
use msplines_t_spline::complex::Point;
use msplines_t_spline::{Domain, DomainOptions, Fit, FitOptions, Stop, TSplineSurface, fit};

fn main() {
    divan::main();
}

fn domain() -> Domain {
    let mesh = shapes::genus(2, 30_000);
    let found = Domain::of_surface(&mesh, &DomainOptions::default(), &mut unobserved());
    found.expect("a domain")
}

fn fitted(domain: &Domain, most: usize) -> Fit {
    let options = FitOptions {
        stop: Stop::ControlPoints(most),
        ..FitOptions::default()
    };
    let samples = TSplineSurface::samples(domain);
    let complex = Arc::new(domain.complex().clone());
    fit(&complex, &samples, &options, &mut unobserved()).expect("a fit")
}

#[divan::bench(sample_count = 3)]
fn genus_2_domain_30k(bencher: Bencher<'_, '_>) {
    bencher.bench_local(domain);
}

#[divan::bench(args = [1000, 2000], sample_count = 3)]
fn genus_2_fit_30k(bencher: Bencher<'_, '_>, most: usize) {
    let domain = domain();
    bencher.bench_local(|| fitted(&domain, most));
}

#[divan::bench(sample_count = 10)]
fn rows_with_first_derivatives_at_30k(bencher: Bencher<'_, '_>) {
    let found = fitted(&domain(), 2000);
    let points: Vec<Point> = found.samples.iter().map(|s| s.at).collect();
    let space = found.spline.space();
    bencher.bench_local(|| space.rows(&points, Order::First));
}
