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

/// Checks which variant of the error a surface and its poles meet, and that it says where and what to do.
fn refuses(mesh: &TriangleMesh, poles: &[u32], variant: &str, [place, remedy]: [&str; 2]) {
    let options = DomainOptions {
        poles: poles.to_vec(),
        ..DomainOptions::default()
    };
    let error = Domain::of_surface(mesh, &options, &mut unobserved()).expect_err("refused");
    assert!(format!("{error:?}").contains(variant), "{error:?}");
    let text = error.to_string();
    assert!(text.contains(place) && text.contains(remedy), "{text}");
}

/// The first of four corners of a cube, and faces between them.
fn few(count: usize, faces: &[[u32; 3]]) -> TriangleMesh {
    let corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]];
    let corners = corners.map(|c| c.map(f64::from).into());
    TriangleMesh::build(corners[..count].to_vec(), faces.to_vec()).expect("a mesh")
}

/// A surface twice, side by side.
fn twice(mesh: &TriangleMesh) -> TriangleMesh {
    let count = mesh.vertex_count() as u32;
    let moved = mesh.positions().iter().map(|p| p + Vector3::x() * 3.0);
    let others = mesh.faces().iter().map(|c| c.map(|v| v + count));
    let positions = mesh.positions().iter().copied().chain(moved);
    let faces = mesh.faces().iter().copied().chain(others);
    TriangleMesh::build(positions.collect(), faces.collect()).expect("two")
}

#[test]
fn bad_surfaces_are_refused_by_name() {
    let [sphere, disk] = [shapes::sphere(300), shapes::height_field(100)];
    let mut positions = disk.positions().to_vec();
    positions[37].y = f64::NAN;
    let broken = disk.with_positions(positions);
    let triangle = few(3, &[[0, 1, 2]]);
    let square = few(4, &[[0, 1, 2], [0, 2, 3]]);
    let pyramid = few(4, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
    refuses(
        &twice(&sphere),
        &[],
        "NotConnected",
        ["2 components", "keep one"],
    );
    refuses(
        &twice(&disk),
        &[44],
        "NotConnected",
        ["2 components", "keep one"],
    );
    refuses(&broken, &[], "NotFinite", ["vertex 37", "repair"]);
    refuses(&triangle, &[], "NoRoom", ["3 vertices", "refine the mesh"]);
    refuses(&square, &[], "NoRoom", ["4 vertices", "refine the mesh"]);
    refuses(&pyramid, &[], "Kind", ["genus 0", "name vertices"]);
    refuses(
        &pyramid,
        &[0, 1],
        "StarsTouch",
        ["vertices 0 and 1", "three edges apart"],
    );
    refuses(&sphere, &[], "Kind", ["0 boundary loops", "name vertices"]);
    refuses(
        &sphere,
        &[9],
        "Kind",
        ["1 boundary loops", "until there are two"],
    );
}

#[test]
fn bad_poles_are_refused_by_name() {
    let [sphere, disk] = [shapes::sphere(300), shapes::height_field(100)];
    let beside = disk.topology().neighbours(44).next().expect("a neighbour");
    refuses(
        &disk,
        &[3],
        "OnBoundary",
        ["star of vertex 3", "farther inside"],
    );
    refuses(
        &disk,
        &[11],
        "OnBoundary",
        ["star of vertex 11", "farther inside"],
    );
    refuses(
        &disk,
        &[44, beside],
        "StarsTouch",
        ["share vertex", "three edges apart"],
    );
    refuses(
        &disk,
        &[44, 5000],
        "NoSuchVertex",
        ["vertex 5000", "numbered from 0"],
    );
    refuses(
        &sphere,
        &[7, 90, 7],
        "SamePole",
        ["vertex 7 is named twice", "once"],
    );
    let holed = shapes::holed_torus(400);
    let rim = holed.topology().boundary_loops()[0][0];
    let rim = holed.topology().origin(rim);
    // Its hole is closed, which does not hide that the pole lies on its rim.
    refuses(
        &holed,
        &[rim],
        "OnBoundary",
        ["touches the boundary", "farther inside"],
    );
    refuses(
        &holed,
        &[9999],
        "NoSuchVertex",
        ["vertex 9999", "numbered from 0"],
    );
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
