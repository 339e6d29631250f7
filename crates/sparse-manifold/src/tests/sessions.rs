//! Edits: what they touch, and that they end where a fit from nothing does.

use msplines_common::Point3;
use msplines_common::mesh::polygon::{CreaseTag, PolygonMesh, Rules, Sharpness};
use msplines_common::mesh::shapes::{box_surface, jittered};
use msplines_common::progress::unobserved;

use super::smooth;
use crate::{Change, LimitGrid, Options, Session, dense_error, fit};

/// Edits may leave this much more error than a fit from nothing.
const SLACK: f64 = 1.3;

fn start(mesh: &PolygonMesh) -> Session {
    let options = Options::default();
    Session::start(
        mesh,
        &smooth(mesh),
        Rules::default(),
        &options,
        8,
        &mut unobserved(),
    )
    .expect("a session")
}

fn large() -> PolygonMesh {
    jittered(&box_surface([5, 5, 5]), 0.1, 7)
}

fn dense(session: &Session) -> f64 {
    dense_error(&session.spline(), session.sharpness(), Rules::default()).rms
}

fn afresh(mesh: &PolygonMesh, sharpness: &Sharpness) -> f64 {
    let fit = fit(
        mesh,
        sharpness,
        Rules::default(),
        &Options::default(),
        &mut unobserved(),
    );
    dense_error(&fit.expect("a fit").spline, sharpness, Rules::default()).rms
}

/// The points an edit returns are those of the surface, and all others stay.
fn check_change(session: &Session, before: &[Vec<[f64; 3]>], change: &Change) {
    for (face, old) in before.iter().enumerate() {
        let now = session.face(face as u32);
        match change.faces.binary_search(&(face as u32)) {
            Ok(place) => assert_eq!(now, change.points[place]),
            Err(_) => assert_eq!(&now, old, "face {face} was not touched"),
        }
    }
}

#[test]
fn moved_vertices_change_what_is_near_and_end_near_a_fit_from_nothing() {
    let mesh = large();
    let mut session = start(&mesh);
    let faces = mesh.face_count() as u32;
    let before: Vec<_> = (0..faces).map(|face| session.face(face)).collect();
    let target = mesh.positions()[40] + nalgebra::Vector3::new(0.1, -0.2, 0.3);
    let change = session.move_vertices(&[(40, target)]).expect("an edit");
    assert!(
        change.charts.len() <= 25 && change.faces.len() <= 36,
        "{}",
        change.faces.len()
    );
    check_change(&session, &before, &change);
    let whole = afresh(session.mesh(), session.sharpness());
    assert!(
        dense(&session) < SLACK * whole,
        "{} {whole}",
        dense(&session)
    );
}

#[test]
fn the_residual_of_many_edits_is_that_of_the_surface() {
    let mesh = large();
    let mut session = start(&mesh);
    let mut last = 0.0;
    for step in 0..20u32 {
        let vertex = (step * 37) % 150;
        let position = session.mesh().positions()[vertex as usize];
        let shift = nalgebra::Vector3::new(0.05, 0.03, -0.04) * f64::from(step % 3);
        last = session
            .move_vertices(&[(vertex, position + shift)])
            .expect("an edit")
            .e_fit;
    }
    let grid = LimitGrid::build(session.mesh(), session.sharpness(), Rules::default(), 3);
    let points = grid.observations(session.mesh().positions());
    let spline = session.spline();
    let tessellator = crate::Tessellator::build(&spline, 8);
    let mut seen = vec![false; points.points.len()];
    let mut sum = 0.0;
    for face in 0..session.mesh().face_count() as u32 {
        for (p, &o) in tessellator
            .face(&spline, face)
            .iter()
            .zip(points.grid(face))
        {
            if !std::mem::replace(&mut seen[o as usize], true) {
                sum += (Point3::from(*p) - points.points[o as usize]).norm_squared();
            }
        }
    }
    assert!((sum - last).abs() < 1e-9 * sum, "{sum} {last}");
}

#[test]
fn sharpened_edges_become_creases() {
    let mesh = large();
    let mut session = start(&mesh);
    let faces = mesh.face_count() as u32;
    let before: Vec<_> = (0..faces).map(|face| session.face(face)).collect();
    let topology = mesh.topology();
    let h = topology.outgoing(40).next().expect("an edge");
    let second = topology.next(topology.twin(topology.next(h)));
    let tags = [h, second].map(|h| CreaseTag {
        vertices: [topology.origin(h), topology.target(h)],
        sharpness: 10.0,
    });
    let change = session.sharpen(&tags).expect("an edit");
    check_change(&session, &before, &change);
    let whole = afresh(session.mesh(), session.sharpness());
    assert!(
        dense(&session) < SLACK * whole,
        "{} {whole}",
        dense(&session)
    );
    // The patch around an edit has the limits of the whole mesh.
    let grid = LimitGrid::build(&mesh, session.sharpness(), Rules::default(), 3);
    let points = grid.observations(mesh.positions()).points;
    for (o, (kept, fresh)) in session.observed().iter().zip(&points).enumerate() {
        assert!((kept - fresh).norm() < 1e-13, "observation {o}");
    }
}

#[test]
fn refused_edits_change_nothing() {
    let mesh = large();
    let mut session = start(&mesh);
    let before = session.face(3);
    let error = session.move_vertices(&[(0, Point3::origin()), (999, Point3::origin())]);
    assert!(
        error
            .expect_err("refused")
            .to_string()
            .contains("vertex 999")
    );
    let error = session.move_vertices(&[(0, Point3::new(f64::NAN, 0.0, 0.0))]);
    assert!(
        error
            .expect_err("refused")
            .to_string()
            .contains("not finite")
    );
    let tag = |vertices, sharpness| CreaseTag {
        vertices,
        sharpness,
    };
    let h = mesh.topology().vertex_half_edge(0);
    let good = tag([0, mesh.topology().target(h)], 10.0);
    assert!(session.sharpen(&[good, tag([0, 0], -1.0)]).is_err());
    assert_eq!(session.face(3), before);
    assert_eq!(session.sharpness(), &smooth(&mesh));
    assert_eq!(session.mesh().positions(), mesh.positions());
}
