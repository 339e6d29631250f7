//! What the program does with T-splines.

use msplines_common::Point3;
use msplines_common::mesh::shapes;

use crate::workbench::Workbench;

/// Returns a folder with a torus, a double torus, a sphere and a disk.
fn workbench() -> Workbench {
    let workbench = Workbench::new();
    workbench.put("ring.ply", &shapes::torus(1.0, 0.4, 900));
    workbench.put("two.ply", &shapes::genus(2, 2000));
    workbench.put("ball.ply", &shapes::sphere(900));
    workbench.put("sheet.ply", &shapes::height_field(625));
    workbench
}

#[test]
fn surfaces_of_every_kind_are_approximated_within_a_budget() {
    let workbench = workbench();
    for (name, points, zeros, poles, worst) in [
        ("ring", 150, 0, 0, 0.02),
        ("two", 500, 2, 0, 0.05),
        ("ball", 200, 0, 2, 0.02),
        ("sheet", 250, 0, 1, 0.05),
    ] {
        let arguments =
            format!("fit t-spline {name}.ply --control-points {points} -o out.ply --report r.json");
        workbench.expect(0, &arguments);
        let record = workbench.json("r.json");
        let checks = &record["checks"];
        let number = |name: &str| checks[name].as_f64().expect(name);
        assert!(number("control_points") <= f64::from(points), "{checks}");
        assert_eq!(
            record["dofs"].as_f64(),
            Some(3.0 * number("control_points"))
        );
        assert_eq!(checks["zeros"], zeros, "{name}");
        assert_eq!(checks["poles"], poles, "{name}");
        assert_eq!(checks["extraordinary_points"], zeros + poles, "{name}");
        assert_eq!(checks["unmeasured_vertices"], 0, "{name}");
        assert!(
            number("unity_max") < 1e-12 && number("basis_sum_min") > 1e-3,
            "{checks}"
        );
        assert!(number("max_unit_cube") < worst, "{name}: {checks}");
        // What is written is what is measured.
        let (given, written) = (
            workbench.soup(&format!("{name}.ply")),
            workbench.soup("out.ply"),
        );
        assert_eq!(written.face_count(), given.face_count());
        let pairs = written.positions.iter().zip(&given.positions);
        let squares: f64 = pairs.map(|(a, b)| (a - b).norm_squared()).sum();
        let rms = (squares / given.positions.len() as f64).sqrt();
        let error = &record["error"];
        let scaled = |name: &str| error[name].as_f64().expect("a number");
        assert!(
            (rms / scaled("scale") - scaled("rms")).abs() < 1e-9,
            "{error}"
        );
    }
}

#[test]
fn a_stored_surface_is_evaluated_to_the_same_bytes() {
    let workbench = workbench();
    for (name, points) in [("two", 400), ("ball", 150)] {
        let fit = format!("fit t-spline {name}.ply --control-points {points}");
        workbench.expect(0, &format!("{fit} -o s.json -o fitted.ply"));
        workbench.expect(0, "evaluate s.json -o again.ply -o t.json");
        assert_eq!(workbench.bytes("fitted.ply"), workbench.bytes("again.ply"));
        assert_eq!(workbench.bytes("s.json"), workbench.bytes("t.json"));
        let options = "--tessellate 3 --threads 1";
        workbench.expect(0, &format!("{fit} {options} -o one.ply -o u.json"));
        workbench.expect(0, "evaluate s.json --tessellate 3 -o again.ply");
        assert_eq!(workbench.bytes("one.ply"), workbench.bytes("again.ply"));
        // Closed, also at the poles.
        workbench.expect(0, "info one.ply --json");
        let faces = workbench.soup("one.ply").face_count();
        assert_eq!(faces % 9, 0);
    }
}

#[test]
fn patches_are_written_for_viewers_and_for_kernels() {
    let workbench = workbench();
    for (name, points) in [("ring", 150), ("two", 400), ("ball", 150)] {
        let fit = format!("fit t-spline {name}.ply --control-points {points}");
        workbench.expect(0, &format!("{fit} -o s.json -o x.vtu -o x.step"));
        let text = |file: &str| String::from_utf8(workbench.bytes(file)).expect("text");
        let step = text("x.step");
        assert!(step.starts_with("ISO-10303-21;") && step.contains("MANIFOLD_SOLID_BREP"));
        // What a ring has is exact: bicubics, with weights as functions are divided by their sum.
        let curves = step.contains("RATIONAL_B_SPLINE_SURFACE");
        assert!(curves, "{name}");
        assert!(text("x.vtu").contains("RationalWeights"), "{name}");
        workbench.expect(0, "evaluate s.json -o y.vtu -o y.step");
        assert_eq!(workbench.bytes("x.vtu"), workbench.bytes("y.vtu"), "{name}");
        assert_eq!(text("y.step"), step, "{name}");
    }
}

#[test]
fn a_tolerance_is_met() {
    let workbench = workbench();
    workbench.expect(0, "fit t-spline ring.ply --tolerance 1% --report r.json");
    let record = workbench.json("r.json");
    assert_eq!(record["outcome"], "converged");
    assert!(
        record["checks"]["max_unit_cube"]
            .as_f64()
            .expect("a number")
            <= 0.01
    );
    let fixed = "fit t-spline ring.ply --tolerance 0.01 --correction off --report f.json";
    workbench.expect(0, fixed);
    let points = |file: &str| workbench.json(file)["checks"]["control_points"].as_u64();
    assert!(points("r.json") <= points("f.json"));
}

#[test]
fn poles_are_chosen_where_they_are_needed_and_said() {
    let workbench = workbench();
    let chosen = workbench.expect(0, "fit t-spline ball.ply --control-points 150");
    assert!(chosen.err.contains("--puncture"), "{}", chosen.err);
    let given = "fit t-spline ball.ply --control-points 150 --puncture 0,400";
    let given = workbench.expect(0, given);
    assert!(!given.err.contains("were chosen"), "{}", given.err);
}

#[test]
fn what_cannot_be_meant_is_refused_with_a_remedy() {
    let workbench = workbench();
    let few = workbench.expect(2, "fit t-spline ring.ply --control-points 5 -o x.ply");
    assert!(few.err.contains("allow at least"), "{}", few.err);
    let least = few
        .err
        .trim()
        .rsplit(' ')
        .next()
        .expect("a number")
        .to_owned();
    workbench.expect(
        0,
        &format!("fit t-spline ring.ply --control-points {least}"),
    );
    let none = workbench.expect(2, "fit t-spline ring.ply --tolerance 0 -o x.ply");
    assert!(none.err.contains("positive"), "{}", none.err);
    workbench.expect(2, "fit t-spline ring.ply -o x.stl");
    let many = workbench.expect(2, "fit t-spline ring.ply --tessellate 0 -o x.ply");
    assert!(many.err.contains("from 1 to 64"), "{}", many.err);
    workbench.expect(2, "fit t-spline ring.ply --fairness=-1 -o x.ply");
    workbench.expect(2, "fit t-spline ring.ply --puncture 90000,1 -o x.ply");
    let one = workbench.expect(4, "fit t-spline ball.ply --puncture 3 -o x.ply");
    assert!(one.err.contains("poles"), "{}", one.err);
    workbench.expect(0, "fit t-spline ring.ply --control-points 100 -o s.json");
    workbench.expect(2, "evaluate s.json --subdivide 1 -o x.ply");
}

#[test]
fn records_say_how_smooth_and_how_independent_a_surface_is() {
    let workbench = workbench();
    for (name, points, capped) in [
        ("ring", 150, false),
        ("two", 400, true),
        ("ball", 150, true),
    ] {
        let fit = format!("fit t-spline {name}.ply --control-points {points} --distance");
        workbench.expect(0, &format!("{fit} --report r.json"));
        let record = workbench.json("r.json");
        let checks = &record["checks"];
        let number = |name: &str| checks[name].as_f64().expect(name);
        assert!(number("c2_jump_max") < 1e-8, "{name}: {checks}");
        if capped {
            assert!(number("c1_jump_cap_max") < 1e-8, "{name}: {checks}");
            assert!(number("c2_jump_cap_max") < 1e-8, "{name}: {checks}");
        } else {
            assert!(checks["c1_jump_cap_max"].is_null(), "{name}: {checks}");
        }
        assert_eq!(checks["gram_independent"], true, "{name}: {checks}");
        assert!(number("gram_condition") > 1.0, "{name}: {checks}");
        assert!(number("levels") > 1.0 && number("refinement_depth") > 0.0);
        assert_eq!(checks["error_unit_cube"], record["error_unit_cube"]["max"]);
        assert_eq!(checks["max_unit_cube"], record["error_unit_cube"]["max"]);
        assert_eq!(checks["hausdorff"], record["distance"]["max"], "{name}");
        assert!(number("hausdorff") > 0.0);
    }
}

#[test]
fn levels_are_taken_from_a_file() {
    let workbench = workbench();
    let fit = "fit t-spline two.ply --control-points 400 -o s.json -o fitted.ply --report r.json";
    workbench.expect(0, fit);
    let levels = workbench.json("r.json")["checks"]["levels"]
        .as_u64()
        .expect("a number");
    assert!(levels > 2);
    let mut points = Vec::new();
    for level in [0, levels - 2] {
        let outputs = "-o l.json -o l.ply -o l.step -o l.vtu --report l-r.json";
        workbench.expect(0, &format!("evaluate s.json --level {level} {outputs}"));
        let record = workbench.json("l-r.json");
        points.push(record["dofs"].as_u64().expect("a number"));
        assert_eq!(record["checks"]["levels"], level + 1);
        // Its own file is that level to the byte.
        workbench.expect(0, "evaluate l.json -o again.ply -o again.step");
        assert_eq!(workbench.bytes("l.ply"), workbench.bytes("again.ply"));
        assert_eq!(workbench.bytes("l.step"), workbench.bytes("again.step"));
    }
    points.push(workbench.json("r.json")["dofs"].as_u64().expect("a number"));
    assert!(points.is_sorted_by(|a, b| a < b), "{points:?}");
    let last = levels - 1;
    workbench.expect(0, &format!("evaluate s.json --level {last} -o last.ply"));
    assert_eq!(workbench.bytes("last.ply"), workbench.bytes("fitted.ply"));
    let beyond = workbench.expect(2, &format!("evaluate s.json --level {levels} -o x.ply"));
    assert!(beyond.err.contains("--level"), "{}", beyond.err);
    workbench.expect(0, "fit ls-mesh ring.ply --controls 50 -o ls.json");
    let other = workbench.expect(2, "evaluate ls.json --level 0 -o x.ply");
    assert!(other.err.contains("fit t-spline"), "{}", other.err);
}

#[test]
fn control_points_are_listed_and_moved() {
    let workbench = workbench();
    workbench.expect(
        0,
        "fit t-spline two.ply --control-points 400 -o s.json -o before.ply",
    );
    workbench.expect(0, "reshape s.json --list points.csv");
    let text = String::from_utf8(workbench.bytes("points.csv")).expect("text");
    let rows: Vec<&str> = text.lines().collect();
    let stored = workbench.json("s.json");
    let control = stored["data"]["control"].as_array().expect("a list");
    assert_eq!(rows.len(), control.len() + 1);
    let position: Vec<f64> = rows[8]
        .split(',')
        .skip(5)
        .map(|n| n.parse().expect("a number"))
        .collect();
    assert_eq!(control[7], serde_json::json!(position));
    let moves = "--control 7:0,0,0.1 --move 1,0,0:0,0.05,0 --within 0.3 --pull 0:3,0.5,-1";
    workbench.expect(
        0,
        &format!("reshape s.json {moves} -o t.json -o after.ply --report r.json"),
    );
    let checks = &workbench.json("r.json")["checks"];
    let number = |name: &str| checks[name].as_f64().expect(name);
    assert!(number("moved_control_points") > 3.0, "{checks}");
    assert!(
        number("largest_movement") > 1e-2 && number("moved_share") < 0.9,
        "{checks}"
    );
    assert_eq!(checks["levels"], 1);
    let (before, after) = (workbench.soup("before.ply"), workbench.soup("after.ply"));
    let pulled = after.positions[0] - Point3::new(3.0, 0.5, -1.0);
    assert!(pulled.norm() < 1e-12, "{pulled}");
    let pairs = before.positions.iter().zip(&after.positions);
    let still = pairs.filter(|(a, b)| a == b).count();
    assert!(still > 100, "{still}");
    workbench.expect(0, "evaluate t.json -o again.ply");
    assert_eq!(workbench.bytes("after.ply"), workbench.bytes("again.ply"));
}

#[test]
fn movements_that_are_none_are_refused() {
    let workbench = workbench();
    workbench.expect(0, "fit t-spline ring.ply --control-points 100 -o s.json");
    let nothing = workbench.expect(2, "reshape s.json -o x.ply");
    assert!(nothing.err.contains("--pull"), "{}", nothing.err);
    let beyond = workbench.expect(2, "reshape s.json --control 900:0,0,1 -o x.ply");
    assert!(beyond.err.contains("control point 900"), "{}", beyond.err);
    let vertex = workbench.expect(2, "reshape s.json --pull 90000:0,0,1 -o x.ply");
    assert!(vertex.err.contains("--pull 90000"), "{}", vertex.err);
    workbench.expect(2, "reshape s.json --control 3 -o x.ply");
    workbench.expect(2, "reshape s.json --pull 3:0,0 -o x.ply");
    let turned = workbench.expect(2, "reshape s.json --turn 0,0,0:0,0,1 -o x.ply");
    assert!(turned.err.contains("T-spline"), "{}", turned.err);
    workbench.expect(0, "fit powell-sabin ring.ply -o p.json");
    let other = workbench.expect(2, "reshape p.json --control 1:0,0,1 -o x.ply");
    assert!(other.err.contains("fit t-spline"), "{}", other.err);
}
