//! What the program does with biharmonic splines beyond a fit of positions.

use std::fmt::Write;

use msplines_common::mesh::shapes;

use crate::workbench::{VERTICES, Workbench, mesh};

/// Rounding of positions of size one.
const ROUNDING: f64 = 1e-12;

fn largest_difference(a: &Workbench, one: &str, other: &str) -> f64 {
    let (one, other) = (a.soup(one).positions, a.soup(other).positions);
    let pairs = one.iter().zip(&other);
    pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

#[test]
fn layers_with_factors_of_one_give_the_input_back() {
    let workbench = Workbench::new();
    workbench.expect(
        0,
        "decompose mesh.ply --layers 20,80 -o same.ply --report r.json",
    );
    assert!(largest_difference(&workbench, "same.ply", "mesh.ply") < ROUNDING);
    let checks = &workbench.json("r.json")["checks"];
    assert_eq!(checks["layer_2_knots"], 80);
    let quiet = "decompose mesh.ply --layers 20,80 --factors 1,0,0 -o first.ply -o first.json";
    workbench.expect(0, quiet);
    workbench.expect(0, "evaluate first.json -o again.ply");
    assert!(largest_difference(&workbench, "first.ply", "again.ply") < 1e-9);
    let ran = workbench.expect(
        2,
        "decompose mesh.ply --layers 20,80 --factors 1,2 -o no.ply",
    );
    assert!(
        ran.err.contains("2 factors were given for 3 parts"),
        "{}",
        ran.err
    );
    assert!(!workbench.path("no.ply").exists());
}

#[test]
fn a_moved_control_point_moves_its_surroundings_only() {
    let workbench = Workbench::new();
    workbench.expect(
        0,
        "fit biharmonic mesh.ply --knots 60 -o s.json -o before.ply",
    );
    let place = mesh().positions()[7];
    let arguments = format!(
        "edit s.json --move {},{},{}:0,0,0.2 -o after.ply -o t.json",
        place.x, place.y, place.z
    );
    workbench.expect(0, &arguments);
    let (before, after) = (
        workbench.soup("before.ply").positions,
        workbench.soup("after.ply").positions,
    );
    let moved = before
        .iter()
        .zip(&after)
        .filter(|(a, b)| (*a - *b).norm() > 2e-3);
    let moved = moved.count();
    assert!(moved > 0 && moved < VERTICES / 2, "{moved}");
    workbench.expect(0, "evaluate t.json -o again.ply");
    assert!(largest_difference(&workbench, "after.ply", "again.ply") < 1e-9);
    workbench.expect(2, "edit s.json --move 1,2,3 -o no.ply");
}

#[test]
fn splines_on_different_knots_are_combined_and_those_of_other_meshes_refused() {
    let workbench = Workbench::new();
    workbench.expect(0, "fit biharmonic mesh.ply --knots 40 -o a.json -o a.ply");
    workbench.expect(0, "fit biharmonic mesh.ply --knots 60 -o b.json -o b.ply");
    workbench.expect(
        0,
        "combine a.json --factor 0.25 --with b.json:0.75 -o sum.ply",
    );
    let [a, b, sum] = ["a.ply", "b.ply", "sum.ply"].map(|name| workbench.soup(name).positions);
    for ((a, b), sum) in a.iter().zip(&b).zip(&sum) {
        let expected = a.coords * 0.25 + b.coords * 0.75;
        assert!((sum.coords - expected).norm() < 1e-10);
    }
    workbench.put("other.ply", &shapes::sphere(VERTICES));
    workbench.expect(0, "fit biharmonic other.ply --knots 40 -o other.json");
    let ran = workbench.expect(3, "combine a.json --with other.json -o no.ply");
    assert!(
        ran.err.contains("give the mesh that was fitted"),
        "{}",
        ran.err
    );
    assert!(!workbench.path("no.ply").exists());
}

#[test]
fn data_weights_and_features_in_files_are_checked() {
    let workbench = Workbench::new();
    let mut heights = String::new();
    for position in mesh().positions() {
        writeln!(heights, "{} {}", position.z, position.x * position.y).expect("text");
    }
    workbench.write("data.txt", &heights);
    let fit = "fit biharmonic mesh.ply --knots 60 --data data.txt -o s.json --report r.json";
    workbench.expect(0, fit);
    assert_eq!(workbench.json("s.json")["data"]["dimension"], 2);
    assert_eq!(workbench.json("r.json")["dofs"], 120);
    workbench.write("short.txt", "1\n2\n3\n");
    workbench.write("nan.txt", &"nan\n".repeat(VERTICES));
    workbench.write("no-edge.txt", "0 0\n");
    let refused = [
        ("--data short.txt", "3 rows for"),
        ("--data nan.txt", "row 0 is not finite"),
        ("--data none.npy", "--data none.npy"),
        ("--weights short.txt", "3 weights were given"),
        ("--weights nan.txt", "the weight of vertex 0 is NaN"),
        (
            "--features no-edge.txt",
            "crease 0 goes from vertex 0 to vertex 0",
        ),
        ("--features 200", "between 0 and 180"),
    ];
    for (option, reason) in refused {
        let ran = workbench.run(&format!(
            "fit biharmonic mesh.ply --knots 60 {option} -o no.ply"
        ));
        assert!([2, 3].contains(&ran.code), "{option}: {ran:?}");
        assert!(ran.err.contains(reason), "{option}: {}", ran.err);
        assert!(!workbench.path("no.ply").exists());
    }
}

#[test]
fn a_cube_with_its_features_is_a_cube_again() {
    let workbench = Workbench::new();
    workbench.put("cube.ply", &shapes::cube(8));
    let fit = "fit biharmonic cube.ply --knots 12 --features 40 -o s.json -o o.ply";
    workbench.expect(0, fit);
    assert!(largest_difference(&workbench, "o.ply", "cube.ply") < 0.01);
    workbench.expect(0, "evaluate s.json -o again.ply");
    assert_eq!(workbench.bytes("again.ply"), workbench.bytes("o.ply"));
}

#[test]
fn knots_inside_faces_are_stored_with_their_places() {
    let workbench = Workbench::new();
    workbench.put("coarse.ply", &shapes::bumpy_sphere(252));
    let fit = "fit biharmonic mesh.ply --knots-from coarse.ply --inside-faces -o s.json -o o.ply";
    workbench.expect(0, fit);
    let spline = workbench.json("s.json");
    let added = spline["data"]["added_points"].as_array().expect("points");
    assert!(!added.is_empty());
    assert_eq!(workbench.soup("o.ply").positions.len(), VERTICES);
    workbench.expect(0, "evaluate s.json -o again.ply");
    assert_eq!(workbench.bytes("again.ply"), workbench.bytes("o.ply"));
}

/// A knot that is named twice counts once.
#[test]
fn duplicated_places_of_knots_change_nothing() {
    let workbench = Workbench::new();
    let mesh = mesh();
    let places = mesh.positions().iter().step_by(16);
    let mut lines: Vec<String> = places
        .map(|p| format!("v {} {} {}\n", p.x, p.y, p.z))
        .collect();
    workbench.write("once.obj", &lines.concat());
    lines.push(lines[0].clone());
    workbench.write("twice.obj", &lines.concat());
    for name in ["once", "twice"] {
        let fit = format!("fit biharmonic mesh.ply --knots-from {name}.obj -o {name}.ply");
        workbench.expect(0, &fit);
    }
    assert_eq!(workbench.bytes("once.ply"), workbench.bytes("twice.ply"));
}
