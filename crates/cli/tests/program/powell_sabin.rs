//! What the program does with Powell-Sabin splines.

use msplines_common::mesh::shapes;

use crate::workbench::Workbench;

/// Returns a folder with a torus, a double torus, a sphere and a disk.
fn workbench() -> Workbench {
    let workbench = Workbench::new();
    workbench.put("ring.ply", &shapes::torus(1.0, 0.4, 400));
    workbench.put("two.ply", &shapes::genus(2, 900));
    workbench.put("ball.ply", &shapes::sphere(400));
    workbench.put("sheet.ply", &shapes::height_field(225));
    workbench
}

#[test]
fn surfaces_of_every_kind_pass_through_their_vertices() {
    let workbench = workbench();
    for (name, zeros, holes) in [
        ("ring", 0, 0),
        ("two", 2, 2),
        ("ball", 0, 1),
        ("sheet", 0, 0),
    ] {
        let arguments = format!("fit powell-sabin {name}.ply -o out.ply --report r.json");
        workbench.expect(0, &arguments);
        let record = workbench.json("r.json");
        let checks = &record["checks"];
        let number = |name: &str| checks[name].as_f64().expect(name);
        assert_eq!(
            (&checks["zeros"], &checks["holes"]),
            (&zeros.into(), &holes.into()),
            "{name}"
        );
        assert!(
            number("position_max") <= 1e-14 && number("normal_max") <= 1e-13,
            "{checks}"
        );
        assert!(
            number("c1_jump_max") <= 1e-10 && number("unity_max") <= 1e-12,
            "{checks}"
        );
        assert!(
            number("basis_min") >= 0.0 && number("seam_max") <= 1e-6,
            "{checks}"
        );
        assert_eq!(checks["orientation_violations"], 0, "{name}");
        assert_eq!(checks["flips"], 0, "{name}");
        // The file has the vertices and the faces of the input.
        let (given, written) = (
            workbench.soup(&format!("{name}.ply")),
            workbench.soup("out.ply"),
        );
        assert_eq!(written.face_count(), given.face_count());
        let pairs = written.positions.iter().zip(&given.positions);
        assert!(
            pairs.into_iter().all(|(a, b)| (a - b).norm() < 1e-12),
            "{name}"
        );
    }
}

#[test]
fn a_stored_surface_is_evaluated_to_the_same_bytes() {
    let workbench = workbench();
    let outputs = "-o s.json -o fitted.ply -o fitted.vtu";
    workbench.expect(
        0,
        &format!("fit powell-sabin two.ply --tessellate 3 {outputs}"),
    );
    let again = "evaluate s.json --tessellate 3 -o again.ply -o again.vtu";
    workbench.expect(0, again);
    assert_eq!(workbench.bytes("fitted.ply"), workbench.bytes("again.ply"));
    assert_eq!(workbench.bytes("fitted.vtu"), workbench.bytes("again.vtu"));
    let threads = "fit powell-sabin two.ply --tessellate 3 -o one.ply --threads 1";
    workbench.expect(0, threads);
    assert_eq!(workbench.bytes("fitted.ply"), workbench.bytes("one.ply"));
}

#[test]
fn a_stored_spline_is_reshaped_near_a_vertex_only() {
    let workbench = workbench();
    workbench.expect(0, "fit powell-sabin ring.ply -o s.json -o before.ply");
    let changes = "--insert 0,1,0.4:0,0,0.02 --turn 1.4,0,0:1,0,0.3 --scale -1.4,0,0:2";
    workbench.expect(
        0,
        &format!("reshape s.json {changes} -o t.json -o after.ply --report r.json"),
    );
    let checks = &workbench.json("r.json")["checks"];
    let number = |name: &str| checks[name].as_f64().expect(name);
    assert_eq!(number("edits"), 3.0);
    assert!(number("largest_movement") > 1e-3, "{checks}");
    assert!(number("movement_beyond") < 1e-14, "{checks}");
    assert!(10.0 * number("changed_faces") < number("faces"), "{checks}");
    // Old vertices stay, and the new one is the last.
    let (before, after) = (workbench.soup("before.ply"), workbench.soup("after.ply"));
    assert_eq!(after.positions.len(), before.positions.len() + 1);
    let pairs = before.positions.iter().zip(&after.positions);
    assert!(pairs.into_iter().all(|(a, b)| (a - b).norm() < 1e-12));
    workbench.expect(0, "evaluate t.json -o again.ply");
    assert_eq!(workbench.bytes("after.ply"), workbench.bytes("again.ply"));
}

#[test]
fn what_cannot_be_reshaped_says_so() {
    let workbench = workbench();
    workbench.expect(0, "fit powell-sabin two.ply -o two.json");
    let zeros = workbench.expect(2, "reshape two.json --scale 0,0,0:2 -o x.ply");
    assert!(zeros.err.contains("zeros"), "{}", zeros.err);
    workbench.expect(0, "fit powell-sabin ring.ply -o ring.json");
    let nothing = workbench.expect(2, "reshape ring.json -o x.ply");
    assert!(
        nothing.err.contains("--insert, --turn or --scale"),
        "{}",
        nothing.err
    );
    workbench.expect(2, "reshape ring.json --scale 0,0,0:0 -o x.ply");
    workbench.expect(2, "reshape ring.json --turn 0,0,0 -o x.ply");
    workbench.expect(0, "fit ls-mesh ring.ply --controls 50 -o ls.json");
    let other = workbench.expect(2, "reshape ls.json --scale 0,0,0:2 -o x.ply");
    assert!(other.err.contains("fit powell-sabin"), "{}", other.err);
}

#[test]
fn holes_are_filled_as_asked() {
    let workbench = workbench();
    for (fill, caps) in [("open", [0, 0]), ("minimal", [0, 2]), ("smooth", [2, 0])] {
        let arguments = format!("fit powell-sabin two.ply --fill {fill} --report r.json");
        workbench.expect(0, &arguments);
        let checks = &workbench.json("r.json")["checks"];
        let found = (&checks["smooth_caps"], &checks["minimal_caps"]);
        assert_eq!(found, (&caps[0].into(), &caps[1].into()), "{fill}");
    }
}

#[test]
fn what_cannot_be_meant_is_refused_with_a_remedy() {
    let workbench = workbench();
    let many = workbench.expect(2, "fit powell-sabin ring.ply --tessellate 0 -o x.ply");
    assert!(many.err.contains("from 1 to 64"), "{}", many.err);
    let form = workbench.expect(4, "fit powell-sabin ball.ply --form optimal -o x.ply");
    assert!(form.err.contains("genus 0"), "{}", form.err);
    let weight = workbench.expect(2, "fit powell-sabin ring.ply --fairness=-1,1 -o x.ply");
    assert!(weight.err.contains("-1"), "{}", weight.err);
    workbench.expect(0, "fit powell-sabin ring.ply --fairness 1,0.5 -o x.ply");
    workbench.write("points.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float nz\nend_header\n0 0 0 0 0 1\n");
    let points = workbench.expect(3, "fit powell-sabin points.ply -o x.ply");
    assert!(points.err.contains("reconstruct"), "{}", points.err);
}
