//! What fits promise: errors, gates, monotone sweeps, the same bits, and refusals.

use msplines_common::Point3;
use msplines_common::mesh::polygon::{PolygonMesh, Rules};
use msplines_common::mesh::shapes::box_surface;
use msplines_common::progress::{Outcome, unobserved};
use std::ops::ControlFlow;

use super::{box_24, creased, fitted, meshes, smooth};
use crate::pursuit::Selection;
use crate::{
    Components, DictionaryKind, FitError, Gate, LimitGrid, Local, Options, SparseManifold,
    SweepOrder, dense_error, fit, fit_to,
};

fn sparse(selection: Selection, components: Components) -> Local {
    Local::Sparse {
        dictionary: DictionaryKind::Own,
        sparsity: 25,
        selection,
        components,
    }
}

fn dense(
    mesh: &PolygonMesh,
    sharpness: &msplines_common::mesh::polygon::Sharpness,
    options: &Options,
) -> f64 {
    dense_error(
        &fitted(mesh, sharpness, options).spline,
        sharpness,
        Rules::default(),
    )
    .rms
}

#[test]
fn creases_are_followed_where_polynomials_fail() {
    let mesh = box_24();
    let sharpness = creased(&mesh);
    let ours = dense(&mesh, &sharpness, &Options::default());
    let polynomial = Options {
        local: Local::Polynomial { degree: None },
        ..Options::default()
    };
    let theirs = dense(&mesh, &sharpness, &polynomial);
    assert!(ours < 5e-4, "{ours}");
    assert!(theirs > 8.0 * ours, "{theirs} {ours}");
}

#[test]
fn two_levels_look_better_than_they_are() {
    let mesh = box_24();
    let two = Options {
        levels: 2,
        ..Options::default()
    };
    let fit = fitted(&mesh, &smooth(&mesh), &two);
    let e_fit = fit.report.e_fit.last().expect("an error");
    let seen = (e_fit / fit.report.observations as f64).sqrt();
    let between = dense_error(&fit.spline, &smooth(&mesh), Rules::default()).rms;
    assert!(between > 10.0 * seen, "{between} {seen}");
}

#[test]
fn gates_keep_shape_functions_out_of_smooth_charts() {
    let mesh = box_24();
    let sharpness = creased(&mesh);
    let gated = fitted(&mesh, &sharpness, &Options::default()).report;
    assert!(gated.c0_atoms_smooth == 0.0 && gated.c0_atoms_crease > 1.0);
    let free = Options {
        gate: Gate::Free,
        ..Options::default()
    };
    assert!(fitted(&mesh, &sharpness, &free).report.c0_atoms_smooth > 0.0);
    let all: Vec<u32> = (0..24).collect();
    let dropped = Options {
        gate: Gate::Free,
        smooth_charts: all,
        ..Options::default()
    };
    assert_eq!(
        fitted(&mesh, &sharpness, &dropped).report.c0_atoms_crease,
        0.0
    );
}

#[test]
fn every_sweep_lowers_the_error() {
    for mesh in meshes() {
        for selection in [Selection::Omp, Selection::Ormp, Selection::Plain] {
            let local = sparse(selection, Components::Joint);
            let options = Options {
                local,
                levels: 2,
                ..Options::default()
            };
            let e = fitted(&mesh, &smooth(&mesh), &options).report.e_fit;
            assert!(e.len() > 3);
            assert!(
                e.windows(2).skip(1).all(|w| w[1] <= w[0] * (1.0 + 1e-9)),
                "{e:?}"
            );
        }
    }
}

#[test]
fn charts_that_all_move_at_once_diverge_unless_damped() {
    let mesh = box_24();
    let run = |damping, sweeps| {
        let options = Options {
            order: SweepOrder::Jacobi { damping },
            sweeps,
            frozen_sweeps: 0,
            ..Options::default()
        };
        fitted(&mesh, &smooth(&mesh), &options).report.e_fit
    };
    let plain = run(1.0, 5);
    assert!(plain[5] > 100.0 * plain[0], "{plain:?}");
    let damped = run(0.25, 5);
    assert!(damped[5] < damped[0], "{damped:?}");
}

/// A polynomial in the coordinates of one chart is found exactly if all charts may use it, since
/// planes are polynomials everywhere.
#[test]
fn planes_are_exact() {
    for mesh in meshes() {
        let flat = mesh
            .positions()
            .iter()
            .map(|p| Point3::new(1.0, 2.0, 3.0 + 0.0 * p.x));
        let mesh = mesh.with_positions(flat.collect());
        let fit = fitted(&mesh, &smooth(&mesh), &Options::default());
        let error = fit.report.e_fit.last().expect("an error");
        assert!(*error < 1e-20, "{error}");
    }
}

#[test]
fn the_bits_do_not_depend_on_threads() {
    let mesh = box_24();
    let sharpness = creased(&mesh);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a pool");
        pool.install(|| fitted(&mesh, &sharpness, &Options::default()))
    };
    let (one, four) = (on(1), on(4));
    assert_eq!(one.report, four.report);
    for chart in 0..24 {
        assert_eq!(one.spline.chart(chart), four.spline.chart(chart));
    }
}

#[test]
fn a_surface_is_restored_from_its_charts() {
    let mesh = box_24();
    let spline = fitted(&mesh, &creased(&mesh), &Options::default()).spline;
    let charts: Vec<_> = (0..24)
        .map(|chart| {
            let (atoms, coefficients) = spline.chart(chart);
            (atoms.to_vec(), coefficients.to_vec())
        })
        .collect();
    let restore = |charts| SparseManifold::from_parts(&mesh, DictionaryKind::Own, Some(14), charts);
    let again = restore(charts.clone()).expect("whole charts");
    assert_eq!(
        again.position(3, [0.3, 0.8]),
        spline.position(3, [0.3, 0.8])
    );
    assert_eq!(again.coefficient_count(), spline.coefficient_count());
    let endless =
        SparseManifold::from_parts(&mesh, DictionaryKind::Own, Some(u32::MAX), charts.clone());
    assert!(
        endless
            .expect_err("no such degree")
            .to_string()
            .contains("degree 4294967295")
    );
    let mut damaged = charts.clone();
    damaged[5].0[0] = 999;
    assert!(
        restore(damaged)
            .expect_err("no such atom")
            .to_string()
            .contains("chart 5")
    );
    assert!(
        restore(charts[1..].to_vec())
            .expect_err("too few")
            .to_string()
            .contains("23 charts")
    );
}

#[test]
fn stored_charts_that_no_fit_has_are_refused() {
    let mesh = box_24();
    let charts = |count: usize| vec![(Vec::new(), Vec::new()); count];
    for degree in [15, u32::MAX] {
        let refused =
            SparseManifold::from_parts(&mesh, DictionaryKind::Own, Some(degree), charts(24));
        let text = refused.expect_err("no such degree").to_string();
        assert!(text.contains(&format!("degree {degree}")), "{text}");
    }
    // An open fan is closed by as many sectors again, so that it holds half as many faces.
    for (is_closed, faces, sectors) in [(true, 121, 121), (false, 61, 122)] {
        let fan = fan(faces, is_closed);
        let vertices = fan.vertex_count();
        let refused = SparseManifold::from_parts(&fan, DictionaryKind::Own, None, charts(vertices));
        let text = refused.expect_err("too many").to_string();
        assert!(text.contains(&format!("{sectors} sectors")), "{text}");
        let (sharpness, options) = (smooth(&fan), Options::default());
        let refused = fit(
            &fan,
            &sharpness,
            Rules::default(),
            &options,
            &mut unobserved(),
        );
        let text = refused.expect_err("too many").to_string();
        assert!(text.contains(&format!("{sectors} sectors")), "{text}");
    }
}

/// Returns quads around one vertex.
fn fan(faces: u32, is_closed: bool) -> PolygonMesh {
    let rim = 2 * faces + u32::from(!is_closed);
    let on_rim = |k: u32| 1 + k % rim;
    let quads: Vec<[u32; 4]> = (0..faces)
        .map(|f| [0, on_rim(2 * f), on_rim(2 * f + 1), on_rim(2 * f + 2)])
        .collect();
    let turn = |k: u32| std::f64::consts::TAU * f64::from(k) / f64::from(2 * faces + 2);
    let rim = (0..rim).map(|k| Point3::new(turn(k).cos(), turn(k).sin(), 0.0));
    let positions = std::iter::once(Point3::origin()).chain(rim).collect();
    PolygonMesh::from_quads(positions, &quads).expect("a fan")
}

#[test]
fn all_dictionaries_and_local_fits_give_surfaces() {
    let mesh = box_24();
    let sharpness = creased(&mesh);
    use DictionaryKind::{AllShapes, Own, Polynomials, Rich, Shapes};
    let dictionaries =
        [Own, AllShapes, Polynomials, Shapes, Rich].map(|dictionary| Local::Sparse {
            dictionary,
            sparsity: 25,
            selection: Selection::Plain,
            components: Components::Each,
        });
    let others = [Local::Polynomial { degree: Some(5) }, Local::Spline];
    for local in dictionaries.into_iter().chain(others) {
        let options = Options {
            local,
            gate: Gate::Free,
            ..Options::default()
        };
        let fit = fitted(&mesh, &sharpness, &options);
        let e = &fit.report.e_fit;
        assert!(e.last() <= e.first(), "{local:?}: {e:?}");
        let edge = mesh.mean_edge_length();
        let rms = (e[e.len() - 1] / fit.report.observations as f64).sqrt() / edge;
        assert!(rms < 0.05, "{local:?}: {rms}");
    }
}

#[test]
fn the_settings_of_the_paper_reduce_the_error() {
    let mesh = box_24();
    let report = fitted(&mesh, &creased(&mesh), &Options::PAPER).report;
    assert!(report.sweeps >= 1 && report.frozen_sweeps == 0);
    assert!(report.e_fit.windows(2).all(|w| w[1] < w[0]));
}

#[test]
fn an_observer_stops_a_fit_with_what_it_has() {
    let mesh = box_24();
    let mut calls = 0;
    let fit = fit(
        &mesh,
        &smooth(&mesh),
        Rules::default(),
        &Options::default(),
        &mut |_| {
            calls += 1;
            if calls > 2 {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        },
    )
    .expect("a surface");
    assert_eq!(
        (fit.report.outcome, fit.report.sweeps),
        (Outcome::Stopped, 2)
    );
}

#[test]
fn refusals_name_the_option_and_the_place() {
    let mesh = box_24();
    let sharpness = smooth(&mesh);
    let refusal = |change: &dyn Fn(&mut Options)| {
        let mut options = Options::default();
        change(&mut options);
        let result = fit(
            &mesh,
            &sharpness,
            Rules::default(),
            &options,
            &mut unobserved(),
        );
        result.expect_err("refused").to_string()
    };
    let no_atoms = Local::Sparse {
        dictionary: DictionaryKind::Own,
        sparsity: 0,
        selection: Selection::Omp,
        components: Components::Joint,
    };
    assert!(refusal(&|o| o.local = no_atoms).contains("sparsity of 0"));
    let shapes = Local::Sparse {
        dictionary: DictionaryKind::Shapes,
        sparsity: 9,
        selection: Selection::Omp,
        components: Components::Joint,
    };
    assert!(refusal(&|o| o.local = shapes).contains("smooth charts would be empty"));
    assert!(refusal(&|o| o.levels = 0).contains("0 levels"));
    assert!(refusal(&|o| o.levels = 9).contains("9 levels"));
    // Nine observations around a vertex leave the splines of a chart open.
    let coarse = refusal(&|o| (o.local, o.levels) = (Local::Spline, 1));
    assert!(
        coarse.contains("for 81 splines") && coarse.contains("--levels"),
        "{coarse}"
    );
    assert!(refusal(&|o| o.local = Local::Polynomial { degree: Some(15) }).contains("degree 15"));
    assert!(refusal(&|o| o.smooth_charts = vec![24]).contains("chart 24"));
    assert!(refusal(&|o| o.least_progress = f64::NAN).contains("least_progress"));
    assert!(refusal(&|o| o.order = SweepOrder::Jacobi { damping: 2.0 }).contains("damping"));
}

#[test]
fn meshes_and_observations_that_do_not_fit_are_refused() {
    let mesh = box_24();
    let sharpness = smooth(&mesh);
    let mut broken = mesh.positions().to_vec();
    broken[7].x = f64::NAN;
    let broken = mesh.with_positions(broken);
    let result = fit(
        &broken,
        &sharpness,
        Rules::default(),
        &Options::default(),
        &mut unobserved(),
    );
    assert!(matches!(result, Err(FitError::NotFinite { .. })));
    let other = box_surface([1, 1, 1]);
    let grid = LimitGrid::build(&other, &smooth(&other), Rules::default(), 3);
    let observations = grid.observations(other.positions());
    let result = fit_to(
        &mesh,
        &sharpness,
        &observations,
        &Options::default(),
        &mut unobserved(),
    );
    assert!(matches!(result, Err(FitError::WrongLength { .. })));
}

#[test]
fn poles_beyond_what_a_chart_holds_are_refused_and_twelve_edges_are_not() {
    let pole = msplines_common::mesh::shapes::trapezohedron;
    assert!(dense(&pole(12), &smooth(&pole(12)), &Options::default()) < 0.02);
    let wide = pole(121);
    let result = fit(
        &wide,
        &smooth(&wide),
        Rules::default(),
        &Options::default(),
        &mut unobserved(),
    );
    let error = result.expect_err("refused").to_string();
    assert!(error.contains("vertex 0 has 121 sectors"), "{error}");
}
