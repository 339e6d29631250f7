//! Fits and evaluations on a generated surface of 50,000 vertices.

use std::sync::LazyLock;

use divan::Bencher;
use msplines_biharmonic::{BiharmonicSpline, Effort, Extension, KnotChoice, Options, fit};
use msplines_common::evaluate::VertexData;
use msplines_common::mesh::{TriangleMesh, shapes};
use msplines_common::progress::unobserved;

static SURFACE: LazyLock<TriangleMesh> = LazyLock::new(|| shapes::bumpy_sphere(50_000));

fn run(knots: KnotChoice, effort: Effort) -> BiharmonicSpline {
    let values: Vec<f64> = SURFACE
        .positions()
        .iter()
        .flat_map(|p| [p.x, p.y, p.z])
        .collect();
    let options = Options {
        knots,
        effort,
        ..Options::default()
    };
    let data = VertexData {
        dimension: 3,
        values: &values,
    };
    fit(&SURFACE, data, &options, &mut unobserved())
        .expect("a fit")
        .spline
}

/// Knots at every twentieth vertex: what the knots cost apart from their choice.
fn given() -> KnotChoice {
    KnotChoice::Given((0..SURFACE.vertex_count() as u32).step_by(20).collect())
}

#[divan::bench(sample_count = 5, sample_size = 1)]
fn given_knots() -> BiharmonicSpline {
    run(given(), Effort::Standard)
}

#[divan::bench(args = [Effort::Fast, Effort::Standard], sample_count = 3, sample_size = 1)]
fn optimised_knots(effort: Effort) -> BiharmonicSpline {
    run(
        KnotChoice::Optimised {
            count: SURFACE.vertex_count() / 20,
        },
        effort,
    )
}

#[divan::bench(sample_count = 5, sample_size = 1)]
fn subdivided_once(bencher: Bencher<'_, '_>) {
    let spline = run(given(), Effort::Standard);
    spline.vertex_values().expect("values");
    bencher.bench(|| spline.subdivision_values(1, Extension::AreaWeighted));
}

fn main() {
    divan::main();
}
