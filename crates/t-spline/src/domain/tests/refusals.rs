//! What is refused, and in which words.

use msplines_common::Vector3;
use msplines_common::mesh::{TriangleMesh, shapes};
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

/// What is refused of a surface and its poles.
fn refusal(mesh: &TriangleMesh, poles: &[u32]) -> DomainError {
    let options = DomainOptions {
        poles: poles.to_vec(),
        ..DomainOptions::default()
    };
    Domain::of_surface(mesh, &options, &mut unobserved()).expect_err("refused")
}

fn mesh(positions: &[[f64; 3]], faces: &[[u32; 3]]) -> TriangleMesh {
    let positions = positions.iter().map(|&p| p.into()).collect();
    TriangleMesh::build(positions, faces.to_vec()).expect("a mesh")
}

/// Case, surface, poles, the variant of the error, and words of it: where, and what to do.
type Case<'a> = (
    &'a str,
    &'a TriangleMesh,
    &'a [u32],
    &'a str,
    &'a str,
    &'a str,
);

#[test]
fn bad_surfaces_and_poles_are_refused_by_name() {
    let corners = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
    ];
    let triangle = mesh(&corners[..3], &[[0, 1, 2]]);
    let square = mesh(&corners, &[[0, 1, 2], [0, 2, 3]]);
    let pyramid = mesh(&corners, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
    let disk = shapes::height_field(100);
    let sphere = shapes::sphere(300);
    let two = {
        let (positions, faces) = (sphere.positions(), sphere.faces());
        let count = positions.len() as u32;
        let moved = positions.iter().map(|p| p + Vector3::new(3.0, 0.0, 0.0));
        let others = faces.iter().map(|c| c.map(|v| v + count));
        let all = positions.iter().copied().chain(moved).collect();
        TriangleMesh::build(all, faces.iter().copied().chain(others).collect()).expect("two")
    };
    let broken = {
        let mut positions = disk.positions().to_vec();
        positions[37].y = f64::NAN;
        disk.with_positions(positions)
    };
    let inner = 44;
    let neighbour = disk
        .topology()
        .neighbours(inner)
        .next()
        .expect("a neighbour");
    let holed = shapes::holed_torus(400);
    let cases: [Case<'_>; 14] = [
        (
            "two components",
            &two,
            &[],
            "NotConnected",
            "2 components",
            "keep one",
        ),
        (
            "no coordinate",
            &broken,
            &[],
            "NotFinite",
            "vertex 37",
            "repair",
        ),
        (
            "a triangle",
            &triangle,
            &[],
            "NoRoom",
            "3 vertices",
            "refine the mesh",
        ),
        (
            "4 vertices, open",
            &square,
            &[],
            "NoRoom",
            "4 vertices",
            "refine the mesh",
        ),
        (
            "4 vertices, closed",
            &pyramid,
            &[],
            "Kind",
            "genus 0",
            "name vertices",
        ),
        (
            "4 vertices, two poles",
            &pyramid,
            &[0, 1],
            "StarsTouch",
            "vertices 0 and 1",
            "three edges apart",
        ),
        (
            "a sphere without poles",
            &sphere,
            &[],
            "Kind",
            "0 boundary loops",
            "name vertices",
        ),
        (
            "a sphere with one pole",
            &sphere,
            &[9],
            "Kind",
            "1 boundary loops",
            "until there are two",
        ),
        (
            "a pole at the boundary",
            &disk,
            &[3],
            "OnBoundary",
            "star of vertex 3",
            "farther inside",
        ),
        (
            "a pole beside the boundary",
            &disk,
            &[11],
            "OnBoundary",
            "star of vertex 11",
            "farther inside",
        ),
        (
            "the same pole twice",
            &sphere,
            &[7, 90, 7],
            "SamePole",
            "vertex 7 is named twice",
            "once",
        ),
        (
            "poles beside each other",
            &disk,
            &[inner, neighbour],
            "StarsTouch",
            "share vertex",
            "three edges",
        ),
        (
            "no such vertex",
            &disk,
            &[inner, 5000],
            "NoSuchVertex",
            "vertex 5000",
            "numbered from 0",
        ),
        (
            "a hole and no such vertex",
            &holed,
            &[9999],
            "NoSuchVertex",
            "vertex 9999",
            "numbered from 0",
        ),
    ];
    for (case, mesh, poles, variant, place, remedy) in cases {
        let error = refusal(mesh, poles);
        assert!(format!("{error:?}").contains(variant), "{case}: {error:?}");
        let text = error.to_string();
        assert!(
            text.contains(place) && text.contains(remedy),
            "{case}: {text}"
        );
    }
}

#[test]
fn meshes_that_are_no_manifold_are_refused_before() {
    let corners = [[0.0; 3]; 5].map(Into::into).to_vec();
    let three_on_an_edge = vec![[0, 1, 2], [1, 0, 3], [0, 1, 4]];
    assert!(TriangleMesh::build(corners, three_on_an_edge).is_err());
}

#[test]
fn a_hole_of_one_face_is_closed_or_an_end() {
    let whole = shapes::sphere(600);
    let faces = whole.faces()[1..].to_vec();
    let mesh = TriangleMesh::build(whole.positions().to_vec(), faces).expect("a mesh");
    let mut options = DomainOptions::default();
    let closed = Domain::of_surface(&mesh, &options, &mut unobserved()).expect("a domain");
    assert_eq!((closed.report().closed_holes, closed.poles().len()), (1, 2));
    // Asked for, it carries a trajectory.
    options.snap.hole = 0.0;
    let open = Domain::of_surface(&mesh, &options, &mut unobserved()).expect("a domain");
    assert_eq!((open.report().closed_holes, open.poles().len()), (0, 1));
}
