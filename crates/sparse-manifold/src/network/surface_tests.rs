//! Surfaces over networks whose true surface is known.
//!
//! The network is made of curves on a Catmull-Clark surface; points of the fit are compared with the
//! nearest points of that surface, lengths in mean arc lengths.

use msplines_common::mesh::TriangleMesh;
use msplines_common::mesh::polygon::{
    PolygonMesh, Refined, Rules, Sharpness, limit_stencils, limit_tangent_stencils,
};
use msplines_common::mesh::shapes::{
    box_surface, dome_network, jittered, limit_network, slab_with_holes,
};
use msplines_common::mesh::{
    SurfacePoint,
    curves::{Curve, CurveNetwork},
};
use msplines_common::metrics::SurfaceTree;
use msplines_common::progress::{Outcome, unobserved};
use nalgebra::{Point3, Vector3};

use super::*;

/// Catmull-Clark steps of the true surface: its triangles are then about 1e-4 away from it.
const LEVELS: u32 = 5;

/// Cells along an edge of a face whose centres are compared.
const CELLS: u32 = 8;

/// A Catmull-Clark surface.
struct Truth {
    tree: SurfaceTree,
    /// Normals at the corners of the triangles.
    normals: Vec<[Vector3<f64>; 3]>,
}

/// How far a surface is from the truth.
#[derive(Debug)]
struct Error {
    /// Root of the mean squared distance.
    rms: f64,
    /// Mean angle between the normals, in degrees.
    normals: f64,
}

impl Truth {
    fn of(mesh: &PolygonMesh, sharpness: &Sharpness) -> Self {
        let rules = Rules::default();
        let start = Refined::none(mesh.topology(), sharpness);
        let refined = (0..LEVELS).fold(start, |r, _| r.again(rules));
        let points = limit_stencils(&refined, rules).apply(mesh.positions());
        let half_edges: Vec<u32> = (0..refined.topology.half_edge_count() as u32).collect();
        let tangents = limit_tangent_stencils(&refined, &half_edges, rules);
        let tangents = tangents.apply(mesh.positions());
        let normal = |h: usize| {
            let [u, v] = [2 * h, 2 * h + 1].map(|i| tangents[i].coords);
            u.cross(&v).normalize()
        };
        let (mut triangles, mut normals) = (Vec::new(), Vec::new());
        for (face, corners) in refined.topology.faces().enumerate() {
            for half in [[0, 1, 2], [0, 2, 3]] {
                triangles.push(half.map(|c| corners[c]));
                normals.push(half.map(|c| normal(4 * face + c)));
            }
        }
        let mesh = TriangleMesh::build(points, triangles).expect("a surface");
        Self {
            tree: SurfaceTree::build(&mesh),
            normals,
        }
    }

    fn error(&self, fit: &NetworkFit) -> Error {
        let step = |i: u32| (f64::from(i) + 0.5) / f64::from(CELLS);
        let faces = 0..fit.domain.mesh.face_count() as u32;
        let at = |face: u32, i: u32| SurfacePoint {
            face,
            at: [step(i % CELLS), step(i / CELLS), 0.0],
        };
        let points: Vec<SurfacePoint> = faces
            .flat_map(|face| (0..CELLS * CELLS).map(move |i| at(face, i)))
            .collect();
        let found = fit.spline.geometry(&points).expect("points of faces");
        let (mut squares, mut angles) = (0.0, 0.0);
        for geometry in &found {
            let foot = self
                .tree
                .closest(&geometry.position)
                .expect("finite points");
            let corners = self.normals[foot.point.face as usize].iter();
            let normal: Vector3<f64> = corners.zip(foot.point.at).map(|(n, b)| n * b).sum();
            squares += foot.distance.powi(2);
            angles += normal.angle(&geometry.normal).to_degrees();
        }
        let count = found.len() as f64;
        Error {
            rms: (squares / count).sqrt() / fit.report.unit,
            normals: angles / count,
        }
    }
}

fn smooth(mesh: &PolygonMesh) -> Sharpness {
    Sharpness::smooth(mesh.topology(), Rules::default())
}

pub(super) fn fitted(network: &CurveNetwork, options: &NetworkOptions) -> NetworkFit {
    surface_network(network, options, &mut unobserved()).expect("a surface")
}

fn two_step(fill: FillEnergy) -> NetworkOptions {
    NetworkOptions {
        method: SurfaceMethod::TwoStep,
        fill,
        ..NetworkOptions::default()
    }
}

#[test]
fn quads_of_genus_two_are_followed_smoothly_and_filled_like_the_true_surface() {
    let mesh = slab_with_holes(2);
    let sharpness = smooth(&mesh);
    let truth = Truth::of(&mesh, &sharpness);
    let network = limit_network(&mesh, &sharpness, 3, 0.0, 1).network;
    // Found: 1.5e-4, 1.9e-3, 0.54 degrees in one step.
    for (options, surface, normals) in [
        (NetworkOptions::default(), 2.5e-3, 1.0),
        (two_step(FillEnergy::Uniform), 3.5e-3, 1.3),
        (two_step(FillEnergy::Cotangent), 7e-3, 2.0),
    ] {
        let fit = fitted(&network, &options);
        let (report, error) = (&fit.report, truth.error(&fit));
        assert!(report.curve_rms <= 3e-4, "{report:?}");
        assert!(report.curve_max <= 1.5e-3, "{report:?}");
        assert!(report.kink_max_degrees < 1e-3, "{report:?}");
        assert!(
            error.rms <= surface && error.normals <= normals,
            "{error:?}"
        );
        assert_eq!(report.outcome, Outcome::Converged);
        assert_eq!((report.charts, report.unknowns), (48, 48 * 28 + 16 * 5));
    }
    // The pursuit on the curves alone says nothing about what lies between.
    let best = truth.error(&fitted(&network, &NetworkOptions::default()));
    let paper = truth.error(&fitted(&network, &NetworkOptions::PAPER));
    assert!(paper.rms > 10.0 * best.rms, "{paper:?} {best:?}");
    assert!(paper.normals > 10.0 * best.normals, "{paper:?} {best:?}");
    // A curve that runs evenly into charts of valence three and five fits worse.
    let even = NetworkOptions {
        speed: CurveSpeed::Constant,
        ..NetworkOptions::default()
    };
    let even = fitted(&network, &even);
    assert!(even.report.curve_rms > 1.2e-3, "{:?}", even.report);
    assert!(truth.error(&even).normals > 1.5 * best.normals);
}

#[test]
fn creases_need_shape_functions_in_the_charts_that_they_touch_only() {
    let mesh = box_surface([1, 2, 3]);
    let sharpness = crate::tests::creased(&mesh);
    let truth = Truth::of(&mesh, &sharpness);
    let network = limit_network(&mesh, &sharpness, 3, 0.0, 1).network;
    let with = |c0_atoms| {
        let options = NetworkOptions {
            c0_atoms,
            ..NetworkOptions::default()
        };
        let fit = fitted(&network, &options);
        (truth.error(&fit), fit.report)
    };
    // Found: 0.63 degrees, and no kink along smooth curves above 1e-4 degrees.
    let (gated, report) = with(C0Atoms::Gated);
    assert!(gated.normals <= 1.0 && gated.rms <= 3e-3, "{gated:?}");
    assert!(report.kink_max_degrees < 1e-2, "{report:?}");
    assert!(
        report.c0_atoms_crease > 5.0 && report.c0_atoms_smooth == 0.0,
        "{report:?}"
    );
    let (without, report) = with(C0Atoms::Without);
    assert!(
        without.normals >= 2.0 * gated.normals,
        "{without:?} {gated:?}"
    );
    assert_eq!(
        (report.c0_atoms_crease, report.kink_max_degrees < 1e-3),
        (0.0, true)
    );
    // Everywhere they follow the curves better, and break smooth ones.
    let (_, everywhere) = with(C0Atoms::With);
    assert!(everywhere.c0_atoms_smooth > 5.0 && everywhere.kink_mean_degrees > 0.5);
}

/// Returns the edges of the unit cube, each a curve of its own.
pub(super) fn cube() -> CurveNetwork {
    let corner = |i: u32| Point3::from([i & 1, i >> 1 & 1, i >> 2].map(f64::from));
    let edges = (0..8).flat_map(|i| [1, 2, 4].map(|bit| [i, i | bit]));
    let edges = edges.filter(|[a, b]| a != b);
    let curves = edges.map(|edge| Curve::crease(edge.to_vec())).collect();
    CurveNetwork::build((0..8).map(corner).collect(), curves).expect("curves")
}

#[test]
fn a_cube_of_creases_is_exact() {
    for options in [NetworkOptions::default(), two_step(FillEnergy::Cotangent)] {
        let fit = fitted(&cube(), &options);
        assert!(fit.report.curve_max < 1e-5, "{:?}", fit.report);
        let points = crate::grid_points(6, 10);
        for geometry in fit.spline.geometry(&points).expect("points of faces") {
            let off = geometry
                .position
                .iter()
                .map(|x| x.abs().min((x - 1.0).abs()));
            assert!(off.fold(1.0, f64::min) < 1e-5, "{geometry:?}");
            let axis = geometry.normal.amax();
            assert!(axis > 1.0 - 1e-8, "{geometry:?}");
        }
    }
}

#[test]
fn patches_with_other_numbers_of_corners_are_split_and_filled() {
    let mesh = slab_with_holes(2);
    let sharpness = smooth(&mesh);
    let truth = Truth::of(&mesh, &sharpness);
    let network = limit_network(&mesh, &sharpness, 3, 0.3, 1).network;
    // Found: 6.8e-5, 1.5e-2, 3.8 degrees.
    let fit = fitted(&network, &NetworkOptions::default());
    let error = truth.error(&fit);
    assert!(fit.domain.split && fit.report.method == SurfaceMethod::TwoStep);
    assert!(fit.report.curve_rms <= 2e-4, "{:?}", fit.report);
    assert!(error.rms <= 2e-2 && error.normals <= 5.0, "{error:?}");
    // The uniform energy sags in uneven patches.
    let uniform = truth.error(&fitted(&network, &two_step(FillEnergy::Uniform)));
    assert!(uniform.rms > 2.0 * error.rms, "{uniform:?} {error:?}");
}

#[test]
fn open_networks_have_open_surfaces() {
    let known = dome_network(4);
    let fit = fitted(&known.network, &NetworkOptions::default());
    let report = &fit.report;
    assert_eq!(fit.spline.mesh().topology().boundary_loops().len(), 1);
    // The curves have corners where sides of the dome meet.
    assert!(
        report.curve_rms < 2.5e-3 && report.turn_max_degrees < 10.0,
        "{report:?}"
    );
    assert!(report.warnings.iter().any(|w| w.contains("are open")));
    for geometry in fit
        .spline
        .geometry(&crate::grid_points(48, 8))
        .expect("points")
    {
        let p = geometry.position;
        let radius = Vector3::new(p.x, p.y / 1.3, p.z / 0.9).norm();
        assert!((radius - 1.0).abs() < 1e-2, "{p}");
    }
}

#[test]
fn moving_and_scaling_the_network_moves_and_scales_the_surface() {
    let mesh = jittered(&box_surface([1, 1, 2]), 0.1, 1);
    let network = limit_network(&mesh, &smooth(&mesh), 3, 0.2, 1).network;
    let place = |p: &Point3<f64>| p * 1e-3 + Vector3::new(7.0, -3.0, 1.0);
    let points = network.points().iter().map(place).collect();
    let moved = CurveNetwork::build(points, network.curves().to_vec()).expect("curves");
    let [one, two] = [&network, &moved].map(|n| fitted(n, &NetworkOptions::default()));
    let faces = one.domain.mesh.face_count();
    let points = crate::grid_points(faces, 5);
    let [a, b] = [&one, &two].map(|fit| fit.spline.geometry(&points).expect("points"));
    for (a, b) in a.iter().zip(&b) {
        assert!((place(&a.position) - b.position).norm() < 1e-9);
    }
}

#[test]
fn the_bits_do_not_depend_on_threads() {
    let mesh = slab_with_holes(1);
    let network = limit_network(&mesh, &smooth(&mesh), 3, 0.2, 1).network;
    for options in [NetworkOptions::default(), NetworkOptions::PAPER] {
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("threads")
                .install(|| fitted(&network, &options))
        };
        let (one, four) = (with(1), with(4));
        assert_eq!(one.report, four.report);
        for chart in 0..one.report.charts as u32 {
            assert_eq!(one.spline.chart(chart), four.spline.chart(chart));
        }
    }
}

#[test]
fn an_observer_can_end_the_rounds() {
    let mesh = slab_with_holes(1);
    let network = limit_network(&mesh, &smooth(&mesh), 3, 0.2, 1).network;
    let mut phases = Vec::new();
    let mut observer = |progress: &msplines_common::progress::Progress| {
        phases.push(progress.phase);
        if progress.phase == "fill" && progress.done == 2 {
            std::ops::ControlFlow::Break(())
        } else {
            std::ops::ControlFlow::Continue(())
        }
    };
    let fit = surface_network(&network, &NetworkOptions::default(), &mut observer);
    let report = fit.expect("a surface").report;
    assert_eq!((report.outcome, report.fill_rounds), (Outcome::Stopped, 2));
    assert_eq!(phases, ["cycles", "fill", "fill", "fill", "fit"]);
}

#[test]
fn what_cannot_be_is_refused() {
    let refused = |options: NetworkOptions| {
        let error = surface_network(&cube(), &options, &mut unobserved());
        error.expect_err("no surface").to_string()
    };
    let default = NetworkOptions::default;
    let pursuit = |dictionary, sparsity| SurfaceMethod::Pursuit {
        dictionary,
        sparsity,
        selection: crate::pursuit::Selection::Omp,
        components: crate::Components::Each,
    };
    let shapes = crate::DictionaryKind::Shapes;
    for (options, text) in [
        (
            NetworkOptions {
                degree: 15,
                ..default()
            },
            "polynomials of degree 15; ask for 1 to 14",
        ),
        (
            NetworkOptions {
                cells: 2,
                ..default()
            },
            "2 cells along an edge; ask for 4 to 32",
        ),
        (
            NetworkOptions {
                curve_weight: 0.0,
                ..default()
            },
            "`curve_weight` is 0; give a number above 0",
        ),
        (
            NetworkOptions {
                bending: f64::NAN,
                ..default()
            },
            "`bending` is NaN",
        ),
        (
            NetworkOptions {
                method: pursuit(shapes, 0),
                ..NetworkOptions::PAPER
            },
            "may choose no atoms",
        ),
        (
            NetworkOptions {
                method: pursuit(shapes, 5),
                ..default()
            },
            "may choose no atoms",
        ),
    ] {
        let found = refused(options);
        assert!(found.contains(text), "{found}");
    }
}

#[test]
fn a_vertex_with_too_many_patches_is_named_by_its_place() {
    let error = NetworkError::Valence {
        position: Point3::new(1.0, 2.0, 3.0),
        valence: 130,
        most: 120,
    };
    assert_eq!(
        error.to_string(),
        "the patches at (1.000000, 2.000000, 3.000000) make a chart of valence 130; one takes at \
         most 120: let some curves end before"
    );
}
