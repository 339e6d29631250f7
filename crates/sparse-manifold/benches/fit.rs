//! Fits and edits of jittered boxes of 24 and 802 vertices.

use divan::Bencher;
use msplines_common::Point3;
use msplines_common::mesh::polygon::{PolygonMesh, Rules, Sharpness};
use msplines_common::mesh::shapes::{box_surface, jittered};
use msplines_common::progress::unobserved;
use msplines_sparse_manifold::{Options, Session, fit};

fn main() {
    divan::main();
}

const BOXES: [[u32; 3]; 2] = [[1, 2, 3], [10, 10, 15]];

fn mesh(charts: usize) -> PolygonMesh {
    let size = BOXES[usize::from(charts > 24)];
    jittered(&box_surface(size), 0.12, 3)
}

fn run(bencher: Bencher<'_, '_>, charts: usize, options: &Options) {
    let mesh = mesh(charts);
    let sharpness = Sharpness::smooth(mesh.topology(), Rules::default());
    bencher.bench_local(|| {
        fit(
            &mesh,
            &sharpness,
            Rules::default(),
            options,
            &mut unobserved(),
        )
    });
}

#[divan::bench(args = [24, 802], sample_count = 20)]
fn default_options(bencher: Bencher<'_, '_>, charts: usize) {
    run(bencher, charts, &Options::default());
}

/// Ten sweeps in which atoms are chosen, none with them kept.
#[divan::bench(args = [(24, 2), (24, 3), (802, 2), (802, 3)], sample_count = 20)]
fn ten_sweeps(bencher: Bencher<'_, '_>, (charts, levels): (usize, u32)) {
    let options = Options {
        levels,
        sweeps: 10,
        frozen_sweeps: 0,
        least_progress: 0.0,
        ..Options::default()
    };
    run(bencher, charts, &options);
}

#[divan::bench(args = [24, 802], sample_count = 20)]
fn settings_of_the_paper(bencher: Bencher<'_, '_>, charts: usize) {
    run(bencher, charts, &Options::PAPER);
}

/// One control vertex moved, and the changed faces as grids of 8 by 8.
#[divan::bench(args = [24, 802], sample_count = 40)]
fn moved_vertex(bencher: Bencher<'_, '_>, charts: usize) {
    let mesh = mesh(charts);
    let sharpness = Sharpness::smooth(mesh.topology(), Rules::default());
    let options = Options::default();
    let mut session = Session::start(
        &mesh,
        &sharpness,
        Rules::default(),
        &options,
        8,
        &mut unobserved(),
    )
    .expect("a box is a control mesh");
    let mut vertex = 0;
    bencher.bench_local(move || {
        vertex = (vertex + 97) % charts as u32;
        let old: Point3<f64> = session.mesh().positions()[vertex as usize];
        let shift = nalgebra::Vector3::new(0.12, -0.1, 0.05) * if old.x > 1.0 { -1.0 } else { 1.0 };
        session.move_vertices(&[(vertex, old + shift)])
    });
}
