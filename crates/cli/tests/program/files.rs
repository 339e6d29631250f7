//! What the program writes: complete, exact, and the same every time.

use msplines_common::Point3;

use crate::workbench::{VERTICES, Workbench, mesh};

/// Sums over a thousand vertices in another order differ by a few units in the last place.
const ROUNDING: f64 = 1e-12;

#[test]
fn anyone_can_recompute_the_error_from_the_surface_file() {
    for method in ["biharmonic --knots", "ls-mesh --controls"] {
        let workbench = Workbench::new();
        workbench.expect(
            0,
            &format!("fit {method} 40 mesh.ply -o o.ply --report r.json"),
        );
        let (fitted, original) = (workbench.soup("o.ply"), mesh());
        assert_eq!(
            fitted.face_vertices,
            workbench.soup("mesh.ply").face_vertices
        );
        assert_eq!(fitted.positions.len(), VERTICES);
        let distance = |(a, b): (&Point3<f64>, &Point3<f64>)| (a - b).norm();
        let pairs = fitted.positions.iter().zip(original.positions());
        let mean = pairs.map(distance).sum::<f64>() / VERTICES as f64 / original.diagonal();
        let recorded = workbench.json("r.json")["error"]["mean"]
            .as_f64()
            .expect("a number");
        assert!(
            (mean - recorded).abs() <= ROUNDING * mean,
            "{method}: {mean} {recorded}"
        );
    }
}

#[test]
fn a_spline_file_evaluates_to_the_surface_that_was_written_with_it() {
    for method in ["biharmonic --knots", "ls-mesh --controls"] {
        let workbench = Workbench::new();
        workbench.expect(0, &format!("fit {method} 40 mesh.ply -o o.ply -o s.json"));
        workbench.expect(0, "evaluate s.json -o again.ply");
        assert_eq!(
            workbench.bytes("again.ply"),
            workbench.bytes("o.ply"),
            "{method}"
        );
    }
}

#[test]
fn a_spline_file_can_hold_the_digest_of_its_mesh_only() {
    let workbench = Workbench::new();
    let fit = "fit biharmonic --knots 40 mesh.ply --domain-by-digest -o o.ply -o s.json";
    workbench.expect(0, fit);
    assert!(workbench.json("s.json")["domain"]["mesh"].is_null());
    let ran = workbench.expect(2, "evaluate s.json -o again.ply");
    assert!(ran.err.contains("--mesh"), "{}", ran.err);
    workbench.expect(0, "evaluate s.json --mesh mesh.ply -o again.ply");
    assert_eq!(workbench.bytes("again.ply"), workbench.bytes("o.ply"));
    workbench.put(
        "other.ply",
        &mesh().with_positions(vec![Point3::origin(); VERTICES]),
    );
    workbench.expect(3, "evaluate s.json --mesh other.ply -o again.ply");
}

#[test]
fn subdivision_keeps_the_vertices_and_adds_one_per_edge() {
    let workbench = Workbench::new();
    workbench.expect(0, "fit biharmonic --knots 40 mesh.ply -o o.ply -o s.json");
    workbench.expect(
        0,
        "evaluate s.json --subdivide 1 -o fine.ply --report r.json",
    );
    let (coarse, fine) = (workbench.soup("o.ply"), workbench.soup("fine.ply"));
    assert_eq!(
        fine.positions.len(),
        VERTICES + mesh().topology().edge_count()
    );
    assert_eq!(fine.positions[..VERTICES], coarse.positions[..]);
    assert!(workbench.json("r.json")["seconds"]["phases"]["evaluate"].is_number());
    workbench.expect(0, "fit ls-mesh --controls 40 mesh.ply -o l.json");
    let ran = workbench.expect(2, "evaluate l.json --subdivide 1 -o fine.ply");
    assert!(ran.err.contains("leave out --subdivide"), "{}", ran.err);
}

#[test]
fn a_damaged_spline_file_is_refused() {
    let workbench = Workbench::new();
    workbench.expect(0, "fit biharmonic --knots 40 mesh.ply -o s.json");
    let good = String::from_utf8(workbench.bytes("s.json")).expect("text");
    let mut wrong = workbench.json("s.json");
    wrong["data"]["knots"][0] = serde_json::json!(VERTICES);
    for bad in [&good[..good.len() / 2], "{}", "", &wrong.to_string()] {
        workbench.write("bad.json", bad);
        let ran = workbench.expect(3, "evaluate bad.json -o o.ply");
        assert!(!ran.err.contains("panicked"), "{}", ran.err);
        assert!(ran.err.contains("error: bad.json: "), "{}", ran.err);
    }
    workbench.expect(3, "evaluate none.json -o o.ply");
}

#[test]
fn files_are_the_same_for_any_number_of_threads() {
    for method in ["biharmonic --knots", "ls-mesh --controls"] {
        let workbench = Workbench::new();
        for threads in ["1", "2"] {
            let out = |extension: &str| format!("-o t{threads}.{extension}");
            let outputs = ["ply", "obj", "vtu", "glb", "json"].map(out).join(" ");
            workbench.expect(
                0,
                &format!("fit {method} 10% mesh.ply --threads {threads} --seed 7 {outputs}"),
            );
        }
        for extension in ["ply", "obj", "vtu", "glb", "json"] {
            let [one, two] = ["1", "2"].map(|t| workbench.bytes(&format!("t{t}.{extension}")));
            assert!(one == two, "{method} .{extension} differs");
        }
    }
}

#[test]
fn a_record_holds_what_a_reader_needs() {
    let workbench = Workbench::new();
    workbench.expect(
        0,
        "fit biharmonic --knots 40 mesh.ply -o o.ply --report r.json --seed 3",
    );
    let record: msplines_compare::record::Record =
        serde_json::from_slice(&workbench.bytes("r.json")).expect("a record");
    assert_eq!(
        (record.input.file.as_str(), record.input.vertices),
        ("mesh.ply", 642)
    );
    assert_eq!((record.dofs, record.seed), (120, 3));
    assert_eq!(record.checks["knots"], 40);
    assert!(record.error.expect("an error").mean > 0.0);
    let total: f64 = record.seconds.phases.values().sum();
    assert!(record.seconds.total >= total && total > 0.0);
    for phase in ["read", "preflight", "fit", "evaluate", "measure", "write"] {
        assert!(record.seconds.phases.contains_key(phase), "{phase}");
    }
}

#[test]
fn the_distance_between_the_surfaces_is_measured_when_asked_for() {
    let workbench = Workbench::new();
    for method in ["biharmonic --knots", "ls-mesh --controls"] {
        let fit = format!("fit {method} 20% mesh.ply --report r.json");
        workbench.expect(0, &fit);
        assert!(workbench.json("r.json")["distance"].is_null());
        workbench.expect(0, &format!("{fit} --distance"));
        let record = workbench.json("r.json");
        let [mean, rms, max] =
            ["mean", "rms", "max"].map(|m| record["distance"][m].as_f64().expect("a number"));
        // The nearest point of the other surface is no farther than the vertex's own image.
        let vertex_max = record["error"]["max"].as_f64().expect("a number");
        assert!(
            0.0 < mean && mean <= rms && rms <= max && mean < vertex_max,
            "{record}"
        );
    }
}
