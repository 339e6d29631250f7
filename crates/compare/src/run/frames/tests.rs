//! Runs over time: what is shared, what is measured, and what is refused.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;

use msplines_biharmonic::{Laplacian, Space};
use msplines_common::mesh::TriangleMesh;
use msplines_common::progress::unobserved;
use msplines_io::{Array, write_npy};

use super::*;
use crate::animation::FrameChoice;
use crate::case::{Amount, Input, Knots, Method};
use crate::generated::GeneratedSurface;
use crate::run::run;

const SURFACE: GeneratedSurface = GeneratedSurface::BumpySphere500;

fn case(method: Method, chosen: FrameChoice) -> Case {
    let frames = Frames {
        chosen,
        ..Frames::all(Animation::TwistAndWave)
    };
    Case {
        task: Task::Frames(frames),
        ..Case::new(Input::Surface(SURFACE), method)
    }
}

fn biharmonic() -> Method {
    Method::biharmonic(Knots::Optimised(Amount::Count(40)))
}

fn methods() -> [Method; 2] {
    [biharmonic(), Method::ls_mesh(Amount::Count(40))]
}

fn done(case: &Case) -> RunOutput {
    run(case, Instant::now(), &mut unobserved()).expect("a run")
}

fn refused(case: &Case) -> String {
    let error = run(case, Instant::now(), &mut unobserved()).expect_err("refused");
    error.to_string()
}

fn frames(mesh: &TriangleMesh, chosen: &[usize]) -> Vec<Vec<f64>> {
    let loaded = Animation::TwistAndWave.load(mesh).expect("no files");
    chosen.iter().map(|&frame| loaded.frame(frame)).collect()
}

#[test]
fn errors_are_those_over_all_vertices_of_all_frames() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mesh = SURFACE.mesh();
    let data = frames(&mesh, &[10, 60, 35]).concat();
    for method in methods() {
        let path = folder.path().join("frames.npy");
        let output = done(&Case {
            outputs: vec![path.clone()],
            ..case(method, FrameChoice::List(vec![10, 60, 35]))
        });
        let values = read_npy(&path).expect("an array");
        assert_eq!(values.shape, [3, mesh.vertex_count(), 3]);
        let squares = data
            .iter()
            .zip(&values.values)
            .map(|(a, b)| (a - b) * (a - b));
        let mean_square = squares.sum::<f64>() / (3 * mesh.vertex_count()) as f64;
        let psnr = 10.0 * (3.0 * mesh.diagonal().powi(2) / mean_square).log10();
        let error = output.record.error.expect("measured");
        assert!(
            (error.psnr_db.expect("an error") - psnr).abs() < 1e-9,
            "{error:?} {psnr}"
        );
        assert!((error.rms * mesh.diagonal() - mean_square.sqrt()).abs() < 1e-12);
        assert_eq!(error.scale, mesh.diagonal());
        let largest = data.chunks(3).zip(values.values.chunks(3)).map(|(a, b)| {
            let square: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
            square.sqrt() / mesh.diagonal()
        });
        assert!((largest.fold(0.0, f64::max) - error.max).abs() < 1e-14);
        let check = |name: &str| output.record.checks[name].as_f64().expect("a number");
        assert_eq!((check("frames"), check("knots")), (3.0, 40.0));
        assert!(check("psnr_min_db") < psnr && psnr < check("psnr_max_db"));
        assert_eq!(output.record.dofs, 3 * 3 * 40);
        // The last frame is the one that is shown and stored.
        assert_eq!(output.values, values.values[2 * 3 * mesh.vertex_count()..]);
        assert_eq!(output.frames[0].frame, 35);
    }
}

#[test]
fn a_frame_has_the_spline_of_a_fit_of_its_own() {
    let mesh = SURFACE.mesh();
    for method in methods() {
        let output = done(&case(method.clone(), FrameChoice::List(vec![80, 30])));
        let single = SharedSpace::build(&case(method, FrameChoice::Every(1)), &load_surface());
        let data = &frames(&mesh, &[30])[0];
        let values = VertexData {
            dimension: 3,
            values: data,
        };
        let fitted = single
            .expect("a space")
            .fit(values, &mut unobserved())
            .expect("a fit");
        let spline = output.spline.expect("a spline");
        assert_eq!(spline.spline, fitted.stored);
    }
}

fn load_surface() -> LoadedInput {
    let mut clock = PhaseClock::start(Instant::now());
    crate::input::load(&Input::Surface(SURFACE), &mut clock).expect("a formula")
}

#[test]
fn all_frames_are_evaluated_with_one_factor() {
    let mesh = SURFACE.mesh();
    let space =
        Arc::new(Space::build(Arc::new(mesh.clone()), Laplacian::Cotangent).expect("a space"));
    let factor: *const _ = space.poisson().expect("a factor");
    for frame in [20, 70] {
        let output = done(&case(biharmonic(), FrameChoice::List(vec![frame])));
        let crate::spline_file::StoredSpline::Biharmonic(stored) =
            output.spline.expect("a spline").spline
        else {
            panic!("another method");
        };
        let spline = stored.restore_in(&space).expect("the same mesh");
        assert_eq!(spline.vertex_values().expect("values"), output.values);
        assert!(Arc::ptr_eq(spline.space(), &space));
        assert!(std::ptr::eq(
            spline.space().poisson().expect("a factor"),
            factor
        ));
    }
}

#[test]
fn one_and_three_threads_give_the_same_bits() {
    for method in methods() {
        let case = case(method, FrameChoice::Every(40));
        let [one, three] = [1, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("threads").install(|| done(&case))
        });
        assert_eq!(one.record.error, three.record.error);
        assert_eq!(one.values, three.values);
        assert_eq!(one.spline, three.spline);
    }
}

fn saved(folder: &tempfile::TempDir, shape: Vec<usize>) -> PathBuf {
    let path = folder.path().join("data.npy");
    let values = (0..shape.iter().product())
        .map(|i: usize| (i as f64).sin())
        .collect();
    write_npy(&path, &Array { shape, values }).expect("written");
    path
}

#[test]
fn data_in_an_array_of_three_dimensions_are_frames() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let vertices = SURFACE.mesh().vertex_count();
    let with = |shape: Vec<usize>| Case {
        data: Data::Array(saved(&folder, shape)),
        ..Case::new(Input::Surface(SURFACE), biharmonic())
    };
    let over_time = done(&with(vec![2, vertices, 2]));
    assert_eq!(over_time.record.checks["frames"], 2);
    assert_eq!(over_time.names, ["value_0", "value_1"]);
    assert!(over_time.frames.is_empty() && over_time.record.error_unit_cube.is_none());
    let single = done(&with(vec![vertices, 2]));
    assert!(!single.record.checks.contains_key("frames"));
    let text = refused(&with(vec![2, 3, vertices]));
    assert!(
        text.contains(&format!("its shape is [2, 3, {vertices}]")),
        "{text}"
    );
}

#[test]
fn what_is_asked_of_one_surface_is_refused() {
    let base = case(biharmonic(), FrameChoice::Every(50));
    let subdivided = Case {
        subdivide: 1,
        ..base.clone()
    };
    assert!(refused(&subdivided).starts_with("--subdivide is for a single surface"));
    let beyond = case(biharmonic(), FrameChoice::List(vec![100]));
    assert!(refused(&beyond).contains("frame 100 is not among the 100 frames"));
    let Task::Frames(frames) = base.task.clone() else {
        panic!("another task");
    };
    let shown = vec![7];
    let task = Task::Frames(Frames { shown, ..frames });
    assert!(refused(&Case { task, ..base }).contains("frame 7 is to be shown"));
}

#[test]
fn a_run_that_is_broken_off_has_the_frames_so_far() {
    let mut seen = 0;
    let mut observer = |progress: &Progress| {
        seen += u32::from(progress.phase == "frames");
        if seen > 2 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let case = case(biharmonic(), FrameChoice::Every(10));
    let output = run(&case, Instant::now(), &mut observer).expect("what there is");
    let record = output.record;
    assert_eq!(record.outcome, Outcome::Stopped);
    assert_eq!(record.checks["frames"], 3);
    assert_eq!(output.frames[0].frame, 20);
    assert!(
        record
            .warnings
            .contains(&"stopped after 3 of 10 frames".to_owned())
    );
}
