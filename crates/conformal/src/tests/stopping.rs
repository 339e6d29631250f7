//! Observers, and forms that are asked for and cannot be.

use std::ops::ControlFlow;

use msplines_common::mesh::{TriangleMesh, shapes, zoo};
use msplines_common::progress::{Progress, unobserved};

use crate::poles::PoleChoice;
use crate::{Atlas, AtlasOptions, ConformalError, FormChoice};

/// Stages until the end of `run`, which is given an observer that stops after so many of them.
fn stages(run: impl Fn(usize) -> (usize, Result<(), ConformalError>)) {
    let (all, result) = run(usize::MAX);
    assert!(result.is_ok() && all >= 3, "{all} stages, {result:?}");
    for stop in 0..all {
        let (seen, result) = run(stop);
        let stopped = result.is_err_and(|error| error.is_stopped());
        assert!(
            stopped && seen == stop + 1,
            "stopped after {seen} of {all} at {stop}"
        );
    }
}

fn counted(
    stop: usize,
    run: impl Fn(&mut dyn FnMut(&Progress) -> ControlFlow<()>) -> Result<(), ConformalError>,
) -> (usize, Result<(), ConformalError>) {
    let mut seen = 0;
    let result = run(&mut |progress| {
        assert_eq!(progress.phase, "domain");
        seen += 1;
        if seen > stop {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    });
    (seen, result)
}

#[test]
fn every_kind_of_atlas_stops_at_each_of_its_stages() {
    let torus = shapes::torus(1.0, 0.4, 400);
    let lay_out = |mesh: &TriangleMesh, puncture: &[u32]| {
        stages(|stop| {
            counted(stop, |observer| {
                let options = AtlasOptions {
                    puncture: puncture.to_vec(),
                    ..AtlasOptions::default()
                };
                Atlas::of_surface(mesh, &options, observer).map(drop)
            })
        });
    };
    lay_out(&torus, &[]);
    lay_out(&torus, &[17]);
    lay_out(&zoo::closed(), &[]);
    lay_out(&zoo::with_boundary(), &[]);
    lay_out(&zoo::with_two_boundaries(), &[]);
    stages(|stop| {
        counted(stop, |observer| {
            let choice = PoleChoice::default();
            Atlas::with_poles(&torus, &[3, 250], &choice, observer).map(drop)
        })
    });
}

#[test]
fn a_form_that_is_asked_for_and_fades_is_refused_with_what_it_folds() {
    // The last class of a surface of many handles lives on one of them.
    let mesh = shapes::genus(24, 150 * 24);
    let mut only = vec![0.0; 48];
    only[47] = 1.0;
    let options = AtlasOptions {
        form: FormChoice::Coefficients(only),
        puncture: Vec::new(),
    };
    let mut seen = 0;
    let error = Atlas::of_surface(&mesh, &options, &mut |_| {
        seen += 1;
        ControlFlow::Continue(())
    })
    .expect_err("a form on one handle");
    let ConformalError::Unsuited {
        flips,
        faces,
        rounds,
        spread,
        ..
    } = error
    else {
        panic!("{error}")
    };
    assert!(flips > 0 && faces >= mesh.face_count() && rounds <= 4);
    assert!(spread > 1e3, "{spread}");
    assert!(seen < 60, "{seen} stages");
    let text = error.to_string();
    assert!(
        text.contains("leave out --form") && text.contains(&format!("folds {flips} of")),
        "{text}"
    );
}

#[test]
fn integer_forms_are_maps_to_the_circle() {
    for genus in 1..=3 {
        let mesh = shapes::genus(genus, 700 * genus as usize);
        let options = AtlasOptions {
            form: FormChoice::integer(0),
            puncture: Vec::new(),
        };
        let found = Atlas::of_surface(&mesh, &options, &mut unobserved()).expect("an atlas");
        let circle = found.circle_map().expect("integer periods");
        let topology = found.atlas.mesh().topology();
        for (h, form) in (0u32..).zip(found.atlas.form()) {
            let along = form[1] / found.atlas.scale_factor();
            assert!((circle.along(topology, h) - along).abs() < 1e-12);
            assert_eq!(
                circle.jumps[h as usize],
                -circle.jumps[topology.twin(h) as usize]
            );
        }
        let sums = circle
            .jumps
            .as_chunks::<3>()
            .0
            .iter()
            .map(|[a, b, c]| a + b + c);
        assert!(sums.into_iter().all(|sum| sum == 0));
        assert!(
            circle.jumps.iter().any(|&jump| jump != 0),
            "no period at all"
        );
        let free = Atlas::of_surface(&mesh, &AtlasOptions::default(), &mut unobserved());
        let refused = free.expect("an atlas").circle_map();
        assert!(matches!(refused, Err(ConformalError::NotIntegral { .. })));
    }
}
