//! Surfaces that cannot be filled, and the texts that say why.

use std::ops::ControlFlow;

use msplines_common::mesh::{shapes, zoo};

use super::*;

fn refusal(surface: &TriangleMesh, options: &MesherOptions) -> String {
    fill(surface, options, &mut unobserved())
        .unwrap_err()
        .to_string()
}

#[test]
fn surfaces_without_an_inside_are_refused() {
    let open = refusal(&zoo::with_boundary(), &options(20.0));
    assert!(
        open.contains("the surface is open: it has 1 boundary loops, the first through vertex"),
        "{open}"
    );
    let ball = shapes::sphere(200);
    let two = both(&ball, &moved(&ball, |p| p + Vector3::new(3.0, 0.0, 0.0)));
    assert_eq!(
        refusal(&two, &options(20.0)),
        "the surface is 2 pieces, the second has vertex 162; give one surface"
    );
    assert!(refusal(&zoo::genus(2), &options(20.0)).contains("the surface has genus 2, not 0"));
    let flat = moved(&ball, |p| Point3::new(p.x, p.y, 0.0));
    assert!(refusal(&flat, &options(20.0)).contains("encloses no volume"));
    let mut positions = ball.positions().to_vec();
    positions[7].y = f64::NAN;
    let broken = ball.with_positions(positions);
    assert!(
        refusal(&broken, &options(20.0)).contains("vertex 7 has a coordinate that is not finite")
    );
}

#[test]
fn lost_parts_are_named_by_their_place() {
    // A needle on a ball.
    let ball = shapes::sphere(2000);
    let top = (0..ball.vertex_count())
        .max_by(|&a, &b| ball.positions()[a].z.total_cmp(&ball.positions()[b].z))
        .unwrap();
    let mut positions = ball.positions().to_vec();
    positions[top] = Point3::new(0.0, 0.0, 2.5);
    let needle = ball.with_positions(positions);
    let error = fill(&needle, &options(20.0), &mut unobserved()).unwrap_err();
    let text = error.to_string();
    assert!(
        text.contains("4 lattices were tried") && text.contains(&format!("by vertex {top}:")),
        "{text}"
    );
    assert!(
        text.contains("a thin part is lost at (0, 0, 2.5)"),
        "{text}"
    );
    let patient = MesherOptions {
        farthest: 50.0,
        ..options(20.0)
    };
    assert!(fill(&needle, &patient, &mut unobserved()).is_ok());
}

#[test]
fn lattices_that_meet_nothing_or_too_much_are_refused() {
    let plate = block([1.0, 1.0, 1e-3]);
    let once = MesherOptions {
        attempts: 1,
        ..options(3.0)
    };
    let text = refusal(&moved(&plate, |p| p + Vector3::new(0.0, 0.0, 0.1)), &once);
    assert!(text.contains("lattice"), "{text}");
    let ball = shapes::sphere(200);
    let fine = MesherOptions {
        spacing: Spacing::Length(1e-4),
        ..options(1.0)
    };
    assert!(refusal(&ball, &fine).contains("choose a larger spacing"));
}

#[test]
fn options_that_mean_nothing_are_named() {
    let ball = shapes::sphere(200);
    for (options, name) in [
        (
            options(0.0),
            "`along_diagonal` is 0.0; give a number above 0",
        ),
        (
            MesherOptions {
                spacing: Spacing::Length(f64::NAN),
                ..options(1.0)
            },
            "`length` is NaN",
        ),
        (
            MesherOptions {
                farthest: -1.0,
                ..options(20.0)
            },
            "`farthest` is -1.0",
        ),
        (
            MesherOptions {
                attempts: 0,
                ..options(20.0)
            },
            "`attempts` is 0.0; give a number from 1 to 7",
        ),
    ] {
        let text = refusal(&ball, &options);
        assert!(text.contains(name), "{text}");
    }
}

#[test]
fn the_observer_stops_it() {
    let mut stop = |_: &_| ControlFlow::Break(());
    let error = fill(&shapes::sphere(200), &options(20.0), &mut stop).unwrap_err();
    assert_eq!(error, MesherError::Stopped);
}
