//! What is refused, and in which words.

use msplines_common::mesh::shapes;
use msplines_common::progress::unobserved;
use msplines_conformal::FormChoice;

use crate::domain::{Domain, DomainError, DomainOptions, End, PeriodicForm, SnapOptions};

fn refused(given: &PeriodicForm) -> DomainError {
    Domain::of_form(given, &SnapOptions::default()).expect_err("refused")
}

/// A torus with the differences of a function as its form.
fn exact(function: impl Fn([f64; 3]) -> [f64; 2]) -> PeriodicForm {
    let mesh = shapes::torus(1.0, 0.4, 300);
    let at = |v: u32| {
        let p = mesh.positions()[v as usize];
        function([p.x, p.y, p.z])
    };
    let topology = mesh.topology();
    let along = |h: u32| {
        let [a, b] = [topology.origin(h), topology.target(h)].map(at);
        [b[0] - a[0], b[1] - a[1]]
    };
    PeriodicForm {
        form: (0..3 * mesh.face_count() as u32).map(along).collect(),
        mesh,
        ends: Vec::new(),
    }
}

#[test]
fn forms_without_levels_are_refused_by_name() {
    let error = refused(&exact(|p| [p[0], p[2]]));
    assert!(matches!(error, DomainError::Extremum { .. }));
    assert!(error.to_string().contains("put a pole there"));
    let mut broken = exact(|p| [p[0], p[2]]);
    broken.form[7][1] = f64::NAN;
    assert!(matches!(refused(&broken), DomainError::Periods { .. }));
    let mut short = exact(|p| [p[0], p[2]]);
    short.form.pop();
    assert!(matches!(refused(&short), DomainError::Count { .. }));
    let mut ends = exact(|p| [p[0], p[2]]);
    ends.ends.push(End::Boundary);
    let error = refused(&ends).to_string();
    assert!(
        error.contains("1 ends of boundary loops are given where the mesh has 0"),
        "{error}"
    );
}

#[test]
fn surfaces_and_choices_without_closed_trajectories_are_refused() {
    let real = DomainOptions {
        form: FormChoice::default(),
        ..DomainOptions::default()
    };
    let error = Domain::of_surface(&shapes::torus(1.0, 0.4, 300), &real, &mut unobserved())
        .expect_err("real");
    assert_eq!(error, DomainError::RealPeriods);
    assert!(error.to_string().contains("integer"));
    let error = Domain::of_surface(
        &shapes::sphere(300),
        &DomainOptions::default(),
        &mut unobserved(),
    );
    let error = error.expect_err("no pole");
    assert!(
        error.to_string().contains("name vertices as poles"),
        "{error}"
    );
}

#[test]
fn a_loop_must_lie_on_one_level() {
    let mesh = shapes::cylinder(300);
    let topology = mesh.topology();
    let along = |h: u32| {
        let [a, b] = [topology.origin(h), topology.target(h)].map(|v| mesh.positions()[v as usize]);
        [b.y - a.y, (b.z - a.z) + 0.1 * (b.x - a.x)]
    };
    let given = PeriodicForm {
        form: (0..3 * mesh.face_count() as u32).map(along).collect(),
        ends: vec![End::Boundary; 2],
        mesh: mesh.clone(),
    };
    let error = refused(&given);
    assert!(
        matches!(error, DomainError::LoopNotLevel { boundary: 0, .. }),
        "{error}"
    );
}
