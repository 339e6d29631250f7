//! Powell-Sabin splines through all vertices and normals of generated surfaces.

use divan::Bencher;
use msplines_common::evaluate::{Order, Samples, SurfaceSpline};
use msplines_common::mesh::{SurfacePoint, shapes};
use msplines_common::progress::unobserved;
use msplines_conformal::{Atlas, AtlasOptions};
use msplines_powell_sabin::{
    SurfaceFit, SurfaceOptions, VertexCondition, estimate_normals, fit_surface,
};

fn main() {
    divan::main();
}

fn atlas(vertices: usize) -> Atlas {
    let mesh = shapes::genus(2, vertices);
    let found = Atlas::of_surface(&mesh, &AtlasOptions::default(), &mut unobserved());
    found.expect("an atlas").atlas
}

fn fitted(atlas: &Atlas) -> SurfaceFit {
    let normals = estimate_normals(atlas.mesh()).expect("normals");
    let conditions = VertexCondition::of_mesh(atlas.mesh(), &normals);
    let options = SurfaceOptions::default();
    fit_surface(atlas, &conditions, &options, &mut unobserved()).expect("a surface")
}

#[divan::bench(sample_count = 5)]
fn genus_2_25k(bencher: Bencher<'_, '_>) {
    let atlas = atlas(25_000);
    bencher.bench_local(|| fitted(&atlas));
}

#[divan::bench(sample_count = 5)]
fn first_derivatives_at_100k(bencher: Bencher<'_, '_>) {
    let found = fitted(&atlas(25_000));
    let surface = &found.spline;
    let faces = surface.mesh().face_count() as u32;
    let points: Vec<SurfacePoint> = (0..100_000)
        .map(|i| SurfacePoint {
            face: i * 7 % faces,
            at: [0.2, 0.3, 0.5],
        })
        .collect();
    let prepared = surface.prepare(&points, Order::First).expect("points");
    let mut out = Samples::default();
    bencher.bench_local(|| prepared.evaluate(&mut out));
}
