//! T-splines through files.

use msplines_common::mesh::shapes;
use msplines_common::progress::unobserved;
use msplines_t_spline::domain::{Domain, DomainOptions};
use msplines_t_spline::{FitOptions, Sampling, Stop};
use serde_json::json;

use super::*;
use crate::spline_file::{SplineFile, StoredDomain, StoredMesh, StoredSpline};

fn fitted(mesh: &TriangleMesh, poles: Vec<u32>) -> (TSplineSurface, Vec<Level>) {
    let options = DomainOptions {
        poles,
        ..DomainOptions::default()
    };
    let domain = Domain::of_surface(mesh, &options, &mut unobserved()).expect("a domain");
    let options = FitOptions {
        stop: Stop::ControlPoints(400),
        ..FitOptions::default()
    };
    let sampling = Sampling::default();
    let fitted = TSplineSurface::fit(domain, mesh, &sampling, &options, &mut unobserved());
    let fitted = fitted.expect("a surface");
    (fitted.surface, fitted.levels)
}

fn through_a_file(stored: StoredTSpline, mesh: &TriangleMesh) -> (StoredTSpline, usize) {
    let domain = StoredDomain::Embedded {
        mesh: StoredMesh::of(mesh),
    };
    let file = SplineFile::new(domain, json!({}), StoredSpline::TSpline(Box::new(stored)));
    let mut bytes = Vec::new();
    file.write(&mut bytes).expect("memory takes all bytes");
    match SplineFile::parse(&bytes).expect("it reads back").spline {
        StoredSpline::TSpline(stored) => (*stored, bytes.len()),
        _ => panic!("another method"),
    }
}

#[test]
fn every_level_comes_back_to_the_bit() {
    let caps = CapOptions::default();
    for (mesh, poles) in [
        (shapes::torus(1.0, 0.4, 900), Vec::new()),
        (shapes::genus(2, 2000), Vec::new()),
        (shapes::sphere(900), vec![0, 400]),
    ] {
        let (given, levels) = fitted(&mesh, poles);
        let stored = StoredTSpline::of(&given, &caps, &levels, &mesh);
        let (read, _) = through_a_file(stored.clone(), &mesh);
        assert_eq!(read, stored);
        assert_eq!(read.level_count(), levels.len());
        for (index, level) in levels.iter().enumerate() {
            let one = read.at_level(index, &mesh).expect("a level");
            let surface = one.restore(&mesh).expect("a surface");
            assert_eq!(*surface.spline(), level.spline);
            assert_eq!(surface.vertices(), given.vertices());
        }
        let whole = read.restore(&mesh).expect("a surface");
        assert_eq!(whole.parts(&caps), given.parts(&caps));
        assert_eq!(whole.domain().mesh().faces(), given.domain().mesh().faces());
        let beyond = read
            .at_level(levels.len(), &mesh)
            .expect_err("no such level");
        assert!(beyond.to_string().contains("0, the coarsest"), "{beyond}");
    }
}

#[test]
fn files_of_the_first_schema_are_read() {
    for (mesh, poles) in [
        (shapes::torus(1.0, 0.4, 900), Vec::new()),
        (shapes::sphere(900), vec![0, 400]),
    ] {
        let (given, _) = fitted(&mesh, poles);
        let own = given.domain().mesh();
        let same = own.faces() == mesh.faces() && own.positions() == mesh.positions();
        let mut surface = json!(given.parts(&CapOptions::default()));
        surface.as_object_mut().expect("fields").remove("levels");
        let first = json!({
            "schema": "msplines.spline/1",
            "domain": { "mesh": StoredMesh::of(&mesh) },
            "options": {},
            "method": "t-spline",
            "data": { "mesh": (!same).then(|| StoredMesh::of(own)), "surface": surface },
        });
        let bytes = first.to_string();
        let read = SplineFile::parse(bytes.as_bytes()).expect("an older file");
        assert_eq!(read.schema, "msplines.spline/2");
        let StoredSpline::TSpline(stored) = read.spline else {
            panic!("another method");
        };
        let again = stored.restore(&mesh).expect("a surface");
        assert_eq!(again.spline(), given.spline());
        assert_eq!(again.vertices(), given.vertices());
        // The same in a few bytes.
        let stored = StoredTSpline::of(&given, &CapOptions::default(), &[], &mesh);
        let (_, size) = through_a_file(stored, &mesh);
        assert!(2 * size < bytes.len(), "{size} of {}", bytes.len());
    }
}

#[test]
fn damage_is_refused_by_name() {
    let mesh = shapes::sphere(900);
    let (given, levels) = fitted(&mesh, vec![0, 400]);
    let stored = StoredTSpline::of(&given, &CapOptions::default(), &levels, &mesh);
    let refusal = |change: &dyn Fn(&mut StoredTSpline)| {
        let mut damaged = stored.clone();
        change(&mut damaged);
        damaged.restore(&mesh).expect_err("damaged").to_string()
    };
    let form = refusal(&|s| s.form = StoredForm::Closed(Bytes(vec![1, 2, 3])));
    assert!(form.contains("3 bytes"), "{form}");
    let run = refusal(&|s| s.mesh.vertices.push((Some(5), u32::MAX)));
    assert!(run.contains("vertex"), "{run}");
    let added = refusal(&|s| s.mesh.vertices.push((None, u32::MAX)));
    assert!(added.contains("added vertices"), "{added}");
    let faces = refusal(&|s| s.mesh.faces.push(FaceRun::Input(0, 2)));
    assert!(faces.contains("faces"), "{faces}");
    let pole = refusal(&|s| s.ends[0] = End::Pole(90_000));
    assert!(pole.contains("90000"), "{pole}");
    // The last number there is has no successor.
    let last = StoredLayout::whole(StoredMesh::default(), &[Some(u32::MAX), Some(0)]);
    assert_eq!(last.vertices, [(Some(u32::MAX), 1), (Some(0), 1)]);
    assert!(last.restore(&mesh).is_err());
    let text = json!(stored)
        .to_string()
        .replacen("\"shifts\":\"", "\"shifts\":\"AAAA", 1);
    let odd = serde_json::from_str::<StoredTSpline>(&text).expect_err("odd bytes");
    assert!(odd.to_string().contains("vectors of 2"), "{odd}");
}
