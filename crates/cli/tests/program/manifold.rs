//! What the program does with control meshes and curve networks.

use std::fmt::Write;

use msplines_common::mesh::curves::CurveNetwork;
use msplines_common::mesh::polygon::PolygonMesh;
use msplines_common::mesh::shapes::{self, Opening};

use crate::workbench::Workbench;

fn obj(mesh: &PolygonMesh) -> String {
    let mut text = String::new();
    for p in mesh.positions() {
        let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
    }
    for face in mesh.topology().faces() {
        let corners: Vec<String> = face.iter().map(|v| (v + 1).to_string()).collect();
        let _ = writeln!(text, "f {}", corners.join(" "));
    }
    text
}

fn curves(network: &CurveNetwork) -> String {
    let mut text = String::new();
    for p in network.points() {
        let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
    }
    for curve in network.curves() {
        let points: Vec<String> = curve.points.iter().map(|p| (p + 1).to_string()).collect();
        let _ = writeln!(text, "l {}", points.join(" "));
    }
    text
}

fn workbench() -> Workbench {
    let workbench = Workbench::new();
    let mesh = shapes::box_surface([1, 2, 3]);
    workbench.write("box.obj", &obj(&mesh));
    let edge = |e: u32| mesh.topology().edge_vertices(e).map(|v| v + 1);
    let row = |[a, b]: [u32; 2]| format!("{a} {b} 10\n");
    let tags = row(edge(0)) + &row(edge(1));
    workbench.write("tags.creases", &tags);
    workbench
}

/// A fit, what it says about itself, and its spline read back.
#[test]
fn a_control_mesh_becomes_a_surface_that_its_file_gives_again() {
    let workbench = workbench();
    workbench.expect(
        0,
        "fit sparse-manifold box.obj -o s.ply -o s.json --report r.json",
    );
    let record = workbench.json("r.json");
    let checks = &record["checks"];
    assert_eq!(record["method"], "sparse-manifold");
    assert_eq!(checks["charts"], 24);
    assert_eq!(checks["c0_atoms_smooth"], 0.0);
    for name in ["e_fit", "dense_rms", "dense_max"] {
        let value = checks[name].as_f64();
        assert!(value.is_some_and(|x| (0.0..1e-2).contains(&x)), "{name}");
    }
    workbench.expect(0, "evaluate s.json --subdivide 3 -o again.ply");
    let (one, two) = (workbench.soup("s.ply"), workbench.soup("again.ply"));
    let pairs = one.positions.iter().zip(&two.positions);
    let apart = pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    assert_eq!(one.positions.len(), two.positions.len());
    assert!(apart < 1e-6, "{apart}");
}

#[test]
fn sharp_edges_come_from_the_file_that_says_so() {
    let workbench = workbench();
    let crease_edges = |arguments: &str| {
        workbench.expect(0, arguments);
        workbench.json("r.json")["checks"]["crease_edges"].clone()
    };
    let fit = "fit sparse-manifold box.obj -o s.ply --report r.json";
    assert_eq!(crease_edges(fit), 0);
    let tagged = format!("{fit} --creases tags.creases");
    assert_eq!(crease_edges(&tagged), 2);
    std::fs::rename(
        workbench.path("tags.creases"),
        workbench.path("box.creases"),
    )
    .expect("same folder");
    assert_eq!(crease_edges(fit), 2);
    assert_eq!(crease_edges(&format!("{fit} --creases none")), 0);
}

/// Every refusal names what is wrong, leaves nothing behind and says what to do.
#[test]
fn bad_control_meshes_and_options_are_refused_with_their_place() {
    let workbench = workbench();
    let cases: [(&str, &str, &str, i32, &str); 9] = [
        (
            "nan.creases",
            "1 2 nan\n",
            "--creases nan.creases",
            3,
            "line 1",
        ),
        (
            "minus.creases",
            "1 2 3\n3 4 -1\n",
            "--creases minus.creases",
            3,
            "line 2",
        ),
        (
            "far.creases",
            "1 99 10\n",
            "--creases far.creases",
            3,
            "line 1",
        ),
        (
            "across.creases",
            "1 24 10\n",
            "--creases across.creases",
            3,
            "line 1",
        ),
        (
            "words.creases",
            "one two three\n",
            "--creases words.creases",
            3,
            "line 1",
        ),
        ("none", "", "--levels 9", 2, "1..=6"),
        ("none", "", "--sparsity 0", 2, "1..=1000"),
        ("none", "", "--smooth-charts 24", 2, "24 charts"),
        (
            "none",
            "",
            "--creases missing.creases",
            3,
            "missing.creases",
        ),
    ];
    for (file, text, arguments, code, message) in cases {
        workbench.write(file, text);
        let line = format!("fit sparse-manifold box.obj {arguments} -o no.ply");
        let ran = workbench.expect(code, &line);
        assert!(ran.err.contains(message), "{arguments}: {}", ran.err);
        assert!(!workbench.path("no.ply").exists(), "{arguments}");
    }
}

#[test]
fn faces_that_are_no_manifold_of_quads_are_refused_with_their_place() {
    let workbench = Workbench::new();
    let faces = [
        (
            "triangle.obj",
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
            "--refine-polygons",
        ),
        (
            "lonely.obj",
            "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 5 5\nf 1 2 3 4\n",
            "vertex 4",
        ),
        (
            "fan.obj",
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 1 1 0\nv 1 -1 0\nv 0 0 1\nv 1 0 1\n\
             f 1 2 5 3\nf 2 1 4 6\nf 1 2 8 7\n",
            "edge",
        ),
    ];
    for (file, text, message) in faces {
        workbench.write(file, text);
        let ran = workbench.expect(3, &format!("fit sparse-manifold {file} -o no.ply"));
        assert!(
            ran.err.contains(message),
            "{file}, `{message}`: {}",
            ran.err
        );
        assert!(!workbench.path("no.ply").exists(), "{file}");
    }
    workbench.expect(
        0,
        "fit sparse-manifold triangle.obj --refine-polygons -o yes.ply",
    );
}

#[test]
fn curves_become_a_surface_and_openings_obey() {
    let workbench = Workbench::new();
    let network = shapes::mushroom_network(6, Opening::Closed).network;
    workbench.write("m.obj", &curves(&network));
    workbench.expect(
        0,
        "fit curve-network m.obj -o m.ply -o m.json --report r.json",
    );
    let checks = workbench.json("r.json")["checks"].clone();
    assert_eq!(
        (&checks["openings"], &checks["euler_characteristic"]),
        (&0.into(), &2.into())
    );
    assert!(checks["curve_rms"].as_f64().is_some_and(|rms| rms < 5e-3));
    workbench.expect(0, "evaluate m.json --subdivide 2 -o again.ply");
    assert!(!workbench.soup("again.ply").positions.is_empty());
}

#[test]
fn bad_networks_are_refused_with_their_place() {
    let workbench = Workbench::new();
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    let cases = [
        (
            "dangling.obj",
            format!("{square}v 2 2 0\nl 1 2 3 4 1\nl 3 5\n"),
            "ends",
        ),
        ("open.obj", format!("{square}l 1 2 3 4\n"), "curve 0 ends"),
        ("empty.obj", "v 0 0 0\n".to_owned(), "curve"),
        ("far.obj", format!("{square}l 1 9\n"), "9"),
        (
            "nan.obj",
            "v 0 0 nan\nv 1 0 0\nl 1 2\n".to_owned(),
            "finite",
        ),
    ];
    for (file, text, message) in cases {
        workbench.write(file, &text);
        let ran = workbench.run_on(["fit", "curve-network", file, "-o", "no.ply"]);
        assert!([3, 4].contains(&ran.code), "{file}: {ran:?}");
        assert!(
            ran.err.contains(message),
            "{file}, `{message}`: {}",
            ran.err
        );
        assert!(!workbench.path("no.ply").exists(), "{file}");
    }
}
