//! From a bumpy sphere to its solid: 20,000 vertices on the boundary, or 80,000 tetrahedra.

use divan::Bencher;
use msplines_common::mesh::shapes::bumpy_sphere;
use msplines_common::mesh::tet::TetMesh;
use msplines_common::progress::unobserved;
use msplines_trivariate::domain::boundary::{self, BoundaryOptions, Frame, find_corners};
use msplines_trivariate::domain::mesher::{self, MesherOptions, Spacing};
use msplines_trivariate::domain::volume::{self, Corners, VolumeOptions};
use msplines_trivariate::domain::{Domain, DomainOptions, Sampling, Solid};
use msplines_trivariate::fit::certified;
use msplines_trivariate::{measure, solid};

fn main() {
    divan::main();
}

const FRAME: Frame = Frame {
    turn: 0.0,
    evenness: 0.15,
};

fn cells() -> TetMesh {
    let options = MesherOptions {
        spacing: Spacing::Cells(80_000),
        ..MesherOptions::default()
    };
    let filled = mesher::fill(&bumpy_sphere(20_000), &options, &mut unobserved());
    filled.expect("tetrahedra").mesh
}

#[divan::bench(sample_count = 5)]
fn tetrahedra_80k(bencher: Bencher<'_, '_>) {
    bencher.bench_local(cells);
}

#[divan::bench(sample_count = 5)]
fn boundary_map_20k(bencher: Bencher<'_, '_>) {
    let surface = bumpy_sphere(20_000);
    let corners = find_corners(&surface, FRAME);
    let options = BoundaryOptions::default();
    bencher.bench_local(|| boundary::map(&surface, &corners, &options, &mut unobserved()));
}

#[divan::bench(sample_count = 5)]
fn volume_map_80k(bencher: Bencher<'_, '_>) {
    let mesh = cells();
    let outside = mesh.topology().boundary_vertices().to_vec();
    let corners = find_corners(&mesh.boundary(), FRAME).map(|at| outside[at as usize]);
    let options = VolumeOptions {
        corners: Corners::Given(corners),
        ..VolumeOptions::default()
    };
    bencher.bench_local(|| volume::map(&mesh, &options, &mut unobserved()));
}

#[divan::bench(args = [16, 32], sample_count = 3)]
fn certified_fit(bencher: Bencher<'_, '_>, spans: usize) {
    let surface = bumpy_sphere(20_000);
    let options = DomainOptions::default();
    let domain = Domain::build(Solid::Surface(&surface), &options, &mut unobserved());
    let samples = domain.expect("a map").samples(&Sampling::default());
    let samples = samples.expect("samples");
    let mut options = certified::Options::default();
    options.least_squares.finest = spans;
    bencher.bench_local(|| certified::fit(&samples, &options, &mut unobserved()));
}

#[divan::bench(sample_count = 5)]
fn measures_at_30(bencher: Bencher<'_, '_>) {
    let options = solid::Options::default();
    let surface = bumpy_sphere(5000);
    let fit = solid::fit(Solid::Surface(&surface), &options, &mut unobserved());
    let fit = fit.expect("a fit");
    bencher.bench_local(|| measure::measure(fit.fitted.spline(), 30));
}
