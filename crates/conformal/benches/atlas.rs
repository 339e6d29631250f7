//! Conformal atlases of generated surfaces of 50,000 vertices.

use divan::Bencher;
use msplines_common::mesh::TriangleMesh;
use msplines_common::mesh::shapes::{bumpy_sphere, genus, torus};
use msplines_common::progress::unobserved;
use msplines_conformal::{Atlas, AtlasOptions};

fn main() {
    divan::main();
}

const VERTICES: usize = 50_000;

fn lay_out(bencher: Bencher<'_, '_>, mesh: &TriangleMesh) {
    let options = AtlasOptions::default();
    bencher.bench_local(|| Atlas::of_surface(mesh, &options, &mut unobserved()));
}

#[divan::bench(sample_count = 5)]
fn torus_50k(bencher: Bencher<'_, '_>) {
    lay_out(bencher, &torus(1.0, 0.4, VERTICES));
}

#[divan::bench(args = [2, 6], sample_count = 5)]
fn genus_50k(bencher: Bencher<'_, '_>, handles: u32) {
    lay_out(bencher, &genus(handles, VERTICES));
}

#[divan::bench(sample_count = 5)]
fn sphere_50k(bencher: Bencher<'_, '_>) {
    lay_out(bencher, &bumpy_sphere(VERTICES));
}
