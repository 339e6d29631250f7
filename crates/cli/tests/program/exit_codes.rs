//! How the program ends, and what it says.

use crate::workbench::{VERTICES, Workbench};

#[test]
fn a_fit_ends_with_zero_and_says_how_good_it_is() {
    let ran = Workbench::new().expect(0, "fit biharmonic mesh.ply --knots 5%");
    assert!(
        ran.err.contains("mean error") && ran.err.contains("select"),
        "{}",
        ran.err
    );
    let ran = Workbench::new().expect(0, "fit ls-mesh mesh.ply --controls 30");
    assert!(ran.err.contains("mean error"), "{}", ran.err);
}

#[test]
fn quiet_says_nothing_but_errors() {
    let workbench = Workbench::new();
    let ran = workbench.expect(0, "fit biharmonic mesh.ply --knots 20 -o out.ply --quiet");
    assert_eq!((ran.out.as_str(), ran.err.as_str()), ("", ""));
    let ran = workbench.expect(3, "fit biharmonic none.ply --knots 20 --quiet");
    assert!(ran.err.starts_with("error: none.ply"), "{}", ran.err);
}

#[test]
fn impossible_amounts_are_usage_errors_that_name_option_and_remedy() {
    let workbench = Workbench::new();
    let more = VERTICES + 1;
    for (amount, remedy) in [
        ("0%", "at least one"),
        ("0", "at least one"),
        ("101%", "at most 642 or 100%"),
        (&more.to_string(), "at most 642 or 100%"),
        ("many", "neither a count such as 1500 nor a percentage"),
        ("-5", "unexpected argument"),
    ] {
        for (method, option) in [("biharmonic", "--knots"), ("ls-mesh", "--controls")] {
            let ran = workbench.expect(2, &format!("fit {method} mesh.ply {option} {amount}"));
            assert!(ran.err.contains(remedy), "{amount}: {}", ran.err);
        }
    }
}

#[test]
fn outputs_are_refused_before_any_work() {
    let workbench = Workbench::new();
    for (output, said) in [
        ("out.stl", "give one of them"),
        ("out", "give one of them"),
        ("no/out.ply", "folder"),
    ] {
        let ran = workbench.expect(2, &format!("fit biharmonic mesh.ply --knots 9 -o {output}"));
        assert!(
            ran.err.contains(output) && ran.err.contains(said),
            "{}",
            ran.err
        );
    }
    workbench.expect(2, "fit biharmonic mesh.ply --knots 9 --report no/run.json");
    workbench.expect(2, "fit biharmonic mesh.ply --knots 9 --threads 0");
    workbench.expect(2, "fit biharmonic mesh.ply --knots 9 --time-limit soon");
}

#[test]
fn unreadable_input_is_refused_with_its_name() {
    let workbench = Workbench::new();
    workbench.write("empty.ply", "");
    workbench.write("text.obj", "this is no mesh");
    for file in ["none.ply", ".", "empty.ply", "text.obj"] {
        for command in [
            "info",
            "fit biharmonic --knots 5%",
            "fit ls-mesh --controls 5%",
        ] {
            let ran = workbench.expect(3, &format!("{command} {file}"));
            assert!(
                ran.err.lines().any(|line| line.starts_with("error: ")),
                "{file}: {}",
                ran.err
            );
        }
    }
}

/// A tetrahedron with one face turned round, a loose vertex and a face of no area.
const BROKEN: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 9 9 9\n\
                      f 1 3 2\nf 1 4 2\nf 2 3 4\nf 1 4 3\nf 1 1 2\n";

#[test]
fn defects_are_refused_with_place_and_option_and_mended_with_it() {
    let workbench = Workbench::new();
    workbench.write("broken.obj", BROKEN);
    let ran = workbench.expect(3, "fit biharmonic broken.obj --knots 4");
    assert!(
        ran.err.contains("--repair") && ran.err.contains("vertex 4"),
        "{}",
        ran.err
    );
    let ran = workbench.expect(
        0,
        "fit biharmonic broken.obj --knots 4 --repair --report r.json",
    );
    assert!(ran.err.contains("repaired"), "{}", ran.err);
    let record = workbench.json("r.json");
    assert!(!record["warnings"].as_array().expect("a list").is_empty());
    assert_eq!(record["options"]["repair"], true);
}

#[test]
fn info_lists_every_defect_and_ends_with_zero() {
    let workbench = Workbench::new();
    workbench.write("broken.obj", BROKEN);
    let ran = workbench.expect(0, "info broken.obj");
    assert!(ran.out.contains("vertex 4"), "{}", ran.out);
    let json = workbench.expect(0, "info broken.obj --json");
    let findings: serde_json::Value = serde_json::from_str(&json.out).expect("JSON");
    let defects = findings["defects"].as_array().expect("a list").len();
    assert!(
        defects >= 3 && ran.out.contains(&format!("{defects} defects")),
        "{findings}"
    );
    assert!(findings["mesh"].is_null());
    let mended = workbench.expect(0, "info broken.obj --repair");
    assert!(
        mended.out.contains("repaired: ") && mended.out.contains("genus 0"),
        "{}",
        mended.out
    );
}

#[test]
fn info_tells_the_facts_of_a_mesh() {
    let ran = Workbench::new().expect(0, "info mesh.ply");
    for fact in ["642 vertices", "1280 faces", "genus 0", "no defects"] {
        assert!(ran.out.contains(fact), "{}", ran.out);
    }
}

#[test]
fn a_time_limit_writes_and_marks_the_result_so_far() {
    let workbench = Workbench::new();
    let ran = workbench.expect(
        5,
        "fit biharmonic mesh.ply --knots 5% --time-limit 0 -o o.ply --report r.json",
    );
    assert!(ran.err.contains("stopped early"), "{}", ran.err);
    assert_eq!(workbench.json("r.json")["outcome"], "stopped");
    let soup = workbench.soup("o.ply");
    assert_eq!(soup.positions.len(), VERTICES);
    assert!(
        soup.positions
            .iter()
            .all(|p| p.iter().all(|x| x.is_finite()))
    );
}
