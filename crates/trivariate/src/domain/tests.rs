//! Domains of solids: samples, fair paths, corners.

use msplines_common::mesh::shapes::{self, box_solid};
use msplines_common::mesh::tet::TetMesh;
use msplines_common::progress::unobserved;

use super::volume::{Corners, VolumeOptions};
use super::*;
use crate::fit::least_squares;

/// Vertices of a generated box at its corners, corner `c` by the bits of `c`.
fn box_corners(mesh: &TetMesh, counts: [u32; 3]) -> [u32; 8] {
    std::array::from_fn(|corner| {
        let at = |d: usize| f64::from(counts[d]) * f64::from((corner >> d & 1) as u8);
        let place = Point3::new(at(0), at(1), at(2));
        let found = mesh.positions().iter().position(|p| *p == place);
        found.expect("a vertex at each corner") as u32
    })
}

fn options(corners: Corners) -> DomainOptions {
    DomainOptions {
        volume: VolumeOptions {
            corners,
            ..VolumeOptions::default()
        },
        ..DomainOptions::default()
    }
}

fn build(solid: Solid<'_>, corners: Corners) -> Result<Domain, DomainError> {
    Domain::build(solid, &options(corners), &mut unobserved())
}

#[test]
fn more_samples_than_memory_holds_are_refused() {
    let domain = box_domain();
    for (interior, surface) in [(usize::MAX, 1), (1, usize::MAX), (15_000_000, 15_000_000)] {
        let sampling = Sampling::Even {
            interior,
            surface,
            surface_weight: 1.0,
        };
        let refused = domain.samples(&sampling);
        assert!(matches!(refused, Err(FitError::TooManySamples { .. })));
    }
}

/// A box of which every sample must be where its parameter says.
fn box_domain() -> Domain {
    let mesh = box_solid([4, 3, 2]);
    let corners = Corners::Given(box_corners(&mesh, [4, 3, 2]));
    build(Solid::Cells(&mesh), corners).expect("a domain")
}

#[test]
fn samples_of_a_box_are_where_their_parameters_say() {
    let domain = box_domain();
    let sampling = Sampling::Even {
        interior: 3000,
        surface: 1001,
        surface_weight: 2.0,
    };
    let samples = domain.samples(&sampling).expect("samples");
    assert_eq!(samples.len(), 4001);
    let pairs = samples.parameters().iter().zip(samples.points());
    for (at, point) in pairs {
        let expected = Point3::new(4.0 * at[0], 3.0 * at[1], 2.0 * at[2]);
        assert!((expected - point).norm() < 1e-9, "{at:?} {point}");
    }
    let inside: f64 = samples.weights()[..3000].iter().sum();
    let outside: f64 = samples.weights()[3000..].iter().sum();
    assert!((inside - 1.0).abs() < 1e-12 && (outside - 2.0).abs() < 1e-12);
    // Those of the surface lie on faces of the cube, exactly.
    let on_face = |at: &[f64; 3]| at.iter().any(|&t| t == 0.0 || t == 1.0);
    assert!(samples.parameters()[3000..].iter().all(on_face));
}

#[test]
fn samples_are_even() {
    let domain = box_domain();
    let sampling = Sampling::Even {
        interior: 8000,
        surface: 0,
        surface_weight: 1.0,
    };
    let samples = domain.samples(&sampling).expect("samples");
    let mut counts = [0u32; 64];
    for at in samples.parameters() {
        let [i, j, k] = at.map(|t| ((4.0 * t) as usize).min(3));
        counts[i + 4 * (j + 4 * k)] += 1;
    }
    // 125 in each; random ones would stray by 34 (three standard deviations).
    let stray = counts.iter().map(|&n| n.abs_diff(125)).max();
    assert!(stray < Some(34), "{counts:?}");
}

#[test]
fn a_linear_solid_has_no_deviation() {
    let domain = box_domain();
    let exact = TrivariateSpline::from_map(3, |[u, v, w]| Point3::new(4.0 * u, 3.0 * v, 2.0 * w));
    let deviation = domain.deviation(&exact.expect("a spline"));
    assert!(deviation.surface_max < 1e-9 && deviation.interior_max < 1e-9);
}

#[test]
fn fair_paths_bring_splines_nearer() {
    let sphere = shapes::sphere(800);
    let rms = |fairing: u32| {
        let mut options = options(Corners::default());
        options.volume.fairing = fairing;
        options.mesher.spacing = mesher::Spacing::Cells(8000);
        let solid = Solid::Surface(&sphere);
        let domain = Domain::build(solid, &options, &mut unobserved()).expect("a domain");
        assert_eq!(domain.map().report.quality.flipped, 0);
        assert!(domain.map().mesh.not_positive().is_empty());
        let sampling = Sampling::Even {
            interior: 20_000,
            surface: 10_000,
            surface_weight: 3.0,
        };
        let samples = domain.samples(&sampling).expect("samples");
        let options = least_squares::Options {
            finest: 8,
            ..least_squares::Options::default()
        };
        let fit = least_squares::fit(&samples, &options, &mut unobserved()).expect("a fit");
        domain.deviation(&fit.spline).surface_rms
    };
    let (zigzag, fair) = (rms(0), rms(12));
    assert!(fair < 0.7 * zigzag, "{fair} {zigzag}");
}

#[test]
fn corners_that_cannot_be_are_refused() {
    let sphere = shapes::sphere(400);
    let refused = |corners: [u32; 8]| {
        build(Solid::Surface(&sphere), Corners::Given(corners)).expect_err("an error")
    };
    let beyond = refused([0, 1, 2, 3, 4, 5, 6, 4000]);
    assert!(
        matches!(
            beyond,
            DomainError::NoVertex {
                corner: 7,
                vertex: 4000,
                ..
            }
        ),
        "{beyond}"
    );
    let same = refused([0, 0, 2, 3, 4, 5, 6, 7]);
    assert!(
        matches!(
            same,
            DomainError::CloseCorners {
                first: 0,
                second: 1,
                ..
            }
        ),
        "{same}"
    );
}

#[test]
fn the_same_bits_on_any_number_of_threads() {
    let sphere = shapes::bumpy_sphere(600);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(|| {
            let mut options = options(Corners::default());
            options.mesher.spacing = mesher::Spacing::Cells(4000);
            let solid = Solid::Surface(&sphere);
            let domain = Domain::build(solid, &options, &mut unobserved()).expect("a domain");
            let sampling = Sampling::Even {
                interior: 5000,
                surface: 3000,
                surface_weight: 3.0,
            };
            domain.samples(&sampling).expect("samples")
        })
    };
    assert_eq!(run(1), run(3));
}
