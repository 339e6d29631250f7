//! T-splines of generated surfaces: domain, fit, rows.

use divan::Bencher;
use msplines_common::evaluate::Order;
use msplines_common::mesh::{TriangleMesh, shapes};
use msplines_common::progress::unobserved;
use msplines_t_spline::{Domain, DomainOptions, FitOptions, Sampling, Stop, TSplineSurface};

fn main() {
    divan::main();
}

fn mesh() -> TriangleMesh {
    shapes::genus(2, 30_000)
}

fn domain(mesh: &TriangleMesh) -> Domain {
    let found = Domain::of_surface(mesh, &DomainOptions::default(), &mut unobserved());
    found.expect("a domain")
}

fn fitted(domain: Domain, mesh: &TriangleMesh, most: usize) -> TSplineSurface {
    let options = FitOptions {
        stop: Stop::ControlPoints(most),
        ..FitOptions::default()
    };
    let sampling = Sampling::default();
    let fitted = TSplineSurface::fit(domain, mesh, &sampling, &options, &mut unobserved());
    fitted.expect("a fit").surface
}

#[divan::bench(sample_count = 3)]
fn genus_2_domain_30k(bencher: Bencher<'_, '_>) {
    let mesh = mesh();
    bencher.bench_local(|| domain(&mesh));
}

#[divan::bench(args = [1000, 2000], sample_count = 3)]
fn genus_2_fit_30k(bencher: Bencher<'_, '_>, most: usize) {
    let mesh = mesh();
    let domain = domain(&mesh);
    bencher
        .with_inputs(|| domain.clone())
        .bench_local_values(|domain| fitted(domain, &mesh, most));
}

#[divan::bench(sample_count = 10)]
fn rows_with_first_derivatives_at_30k(bencher: Bencher<'_, '_>) {
    let mesh = mesh();
    let found = fitted(domain(&mesh), &mesh, 2000);
    let points = found.vertices();
    let space = found.spline().space();
    bencher.bench_local(|| space.rows(&points, Order::First));
}
