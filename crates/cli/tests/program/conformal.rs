//! What the program does with conformal atlases.

use msplines_common::mesh::shapes;
use msplines_io::read_npy;

use crate::workbench::{VERTICES, Workbench};

/// Returns a folder with a sphere (`mesh.ply`), a torus, a double torus and an annulus.
fn workbench() -> Workbench {
    let workbench = Workbench::new();
    workbench.put("ring.ply", &shapes::torus(1.0, 0.4, 400));
    workbench.put("two.ply", &shapes::genus(2, 1_500));
    workbench.put("open.ply", &shapes::vase(400));
    workbench
}

/// Length of a side of every face in texture over its length on the surface.
fn scales(workbench: &Workbench, texture: &str, mesh: &str) -> Vec<f64> {
    let texture = read_npy(&workbench.path(texture)).expect("an array");
    let soup = workbench.soup(mesh);
    assert_eq!(texture.shape, [soup.face_count(), 6]);
    let scale = |(face, row): (usize, &[f64])| {
        let [a, b] = [0, 1].map(|i| soup.positions[soup.face(face)[i] as usize]);
        (row[2] - row[0]).hypot(row[3] - row[1]) / (b - a).norm()
    };
    texture.values.chunks(6).enumerate().map(scale).collect()
}

#[test]
fn a_torus_is_laid_out_and_every_file_holds_the_same_atlas() {
    let workbench = workbench();
    let outputs = "-o a.json -o a.obj -o a.ply -o a.glb -o a.npy";
    let ran = workbench.expect(0, &format!("conformal ring.ply {outputs} --report r.json"));
    assert!(ran.err.contains("genus 1, 0 zeros"), "{}", ran.err);
    let record = workbench.json("r.json");
    assert_eq!(
        (&record["method"], &record["error"]),
        (&"conformal".into(), &serde_json::Value::Null)
    );
    assert_eq!(record["options"]["form"], "optimal");
    let checks = &record["checks"];
    for (name, count) in [
        ("genus", 1),
        ("zeros", 0),
        ("flips", 0),
        ("added_vertices", 0),
    ] {
        assert_eq!(checks[name], count, "{name}");
    }
    let number = |name: &str| checks[name].as_f64().expect(name);
    // A torus of revolution by quads cut in two: faces are a tenth of its tube.
    assert!((1.0..1.1).contains(&number("conformal_k_mean")), "{checks}");
    assert!(number("conformal_k_mean") <= number("conformal_k_p99"));
    assert!(
        number("closedness") < 1e-10 && number("co_closedness") < 1e-8,
        "{checks}"
    );
    assert!(number("scale_spread") >= 1.0 && number("log_variance") > 0.0);
    assert!(number("conjugation_defect") < 0.1, "{checks}");
    let (atlas, ring) = (workbench.json("a.json"), shapes::torus(1.0, 0.4, 400));
    let (vertices, faces) = (ring.vertex_count(), ring.face_count());
    assert_eq!(
        (&atlas["schema"], &atlas["structure"]["kind"]),
        (&"msplines.atlas/1".into(), &"closed".into())
    );
    assert_eq!(atlas["input_sha256"], record["input"]["sha256"]);
    assert_eq!(atlas["form"].as_array().map(Vec::len), Some(3 * faces));
    assert_eq!(atlas["mesh"]["faces"].as_array().map(Vec::len), Some(faces));
    assert_eq!(atlas["mesh_sha256"].as_str().map(str::len), Some(64));
    // Where lengths have the median of the atlas, 40 squares of an eighth lie along the diagonal.
    let mut scales = scales(&workbench, "a.npy", "a.ply");
    scales.sort_by(f64::total_cmp);
    let diagonal = ring.diagonal();
    let squares = 8.0 * scales[scales.len() / 2] * diagonal;
    assert!((30.0..53.0).contains(&squares), "{squares}");
    let obj = String::from_utf8(workbench.bytes("a.obj")).expect("text");
    let starting = |with: &str| obj.lines().filter(|line| line.starts_with(with)).count();
    assert!(
        starting("vt ") > vertices && starting("vt ") < 3 * faces,
        "{}",
        starting("vt ")
    );
    assert!(
        obj.lines()
            .any(|line| line.starts_with("f ") && line.contains('/'))
    );
}

#[test]
fn zeros_are_counted_and_forms_can_be_chosen() {
    let workbench = workbench();
    let atlas = |form: &str| {
        let ran = workbench.expect(
            0,
            &format!("conformal two.ply {form} -o a.json --report r.json"),
        );
        assert!(ran.err.contains("genus 2, 2 zeros"), "{}", ran.err);
        let (atlas, record) = (workbench.json("a.json"), workbench.json("r.json"));
        let zeros = atlas["zeros"].as_array().expect("a list").clone();
        let orders = zeros
            .iter()
            .map(|zero| zero["order"].as_i64().expect("an order"));
        assert_eq!(orders.sum::<i64>(), 2);
        assert_eq!(record["checks"]["zeros"], 2);
        (
            atlas["form"].clone(),
            record["checks"]["log_variance"].as_f64().expect("a number"),
        )
    };
    let (optimal, least) = atlas("");
    let (again, _) = atlas("--form optimal");
    assert_eq!(optimal, again);
    let (integer, variance) = atlas("--form integer");
    assert!(
        variance >= least && integer != optimal,
        "{variance} {least}"
    );
    let (periods, variance) = atlas("--form periods:1,0.2,-0.3,0.9");
    assert!(
        variance >= least && periods != optimal,
        "{variance} {least}"
    );
    // A form and its opposite are one map but for a half turn.
    let (one, _) = atlas("--form coefficients:1,0.2,-0.3,0.9");
    let (other, _) = atlas("--form coefficients:-1,-0.2,0.3,-0.9");
    let first = |form: &serde_json::Value| form[0][0].as_f64().expect("a number");
    assert!((first(&one) + first(&other)).abs() < 1e-9 * first(&one).abs().max(1e-3));
}

#[test]
fn spheres_disks_and_annuli_have_atlases_too() {
    let workbench = workbench();
    for (arguments, kind, faces) in [
        ("mesh.ply", "sphere", 2 * VERTICES - 4),
        ("mesh.ply --puncture 5", "disk", 0),
        ("mesh.ply --puncture 5,600", "bounded", 0),
        ("open.ply", "bounded", 0),
    ] {
        workbench.expect(
            0,
            &format!("conformal {arguments} -o a.json -o a.npy --report r.json"),
        );
        let (atlas, record) = (workbench.json("a.json"), workbench.json("r.json"));
        assert_eq!(atlas["structure"]["kind"], kind, "{arguments}");
        let found = atlas["mesh"]["faces"].as_array().expect("faces").len();
        assert!(faces == 0 || found == faces, "{arguments}: {found}");
        let checks = &record["checks"];
        assert_eq!((&checks["genus"], &checks["flips"]), (&0.into(), &0.into()));
        assert!(
            checks["closedness"].as_f64().is_some_and(|x| x < 1e-8),
            "{checks}"
        );
        assert!(checks["log_variance"].is_null(), "{checks}");
        let texture = read_npy(&workbench.path("a.npy")).expect("an array");
        assert!(texture.values.iter().all(|x| x.is_finite()));
    }
}

#[test]
fn handles_with_holes_have_an_atlas_and_a_choice_of_forms() {
    let workbench = workbench();
    let line =
        "conformal ring.ply --puncture 7 --form periods:1,0.3 -o a.json -o a.obj --report r.json";
    workbench.expect(0, line);
    let (atlas, record) = (workbench.json("a.json"), workbench.json("r.json"));
    assert_eq!(
        atlas["structure"],
        serde_json::json!({ "kind": "filled", "cones": 1 })
    );
    assert_eq!(
        (&record["checks"]["genus"], &record["checks"]["flips"]),
        (&1.into(), &0.into())
    );
    assert_eq!(record["options"]["form"], "periods:1.0,0.3");
}

/// Every refusal names what is wrong, leaves nothing behind and says what to do.
#[test]
fn what_has_no_atlas_is_refused_with_a_remedy() {
    let workbench = workbench();
    let mut positions = shapes::sphere(100).positions().to_vec();
    let mut faces = shapes::sphere(100).faces().to_vec();
    let count = positions.len() as u32;
    positions.extend(
        shapes::sphere(100)
            .positions()
            .iter()
            .map(|p| p + msplines_common::Vector3::x() * 5.0),
    );
    faces.extend(
        shapes::sphere(100)
            .faces()
            .iter()
            .map(|f| f.map(|v| v + count)),
    );
    let apart = msplines_common::mesh::TriangleMesh::build(positions, faces).expect("two spheres");
    workbench.put("apart.ply", &apart);
    workbench.write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n");
    let cases = [
        ("mesh.ply --form optimal", 4, "leave out --form"),
        ("open.ply --form periods:1,0", 4, "leave out --form"),
        ("apart.ply", 3, "keep the largest component"),
        ("ring.ply --form periods:1", 2, "2 classes"),
        ("ring.ply --form coefficients:0,0", 2, "at least one"),
        ("ring.ply --form best", 2, "periods:X"),
        ("ring.ply --form periods:1,nan", 2, "periods:X"),
        ("mesh.ply --puncture 9999", 2, "9999"),
        ("mesh.ply --puncture 5,5", 2, "three edges apart"),
        ("open.ply --puncture 0", 2, "farther inside"),
        ("mesh.ply -o no.vtu", 2, ".json"),
        ("mesh.ply -o none/no.ply", 2, "folder"),
        ("none.ply", 3, "none.ply"),
        ("points.obj", 3, "Poisson reconstruction"),
    ];
    for (arguments, code, message) in cases {
        let ran = workbench.expect(code, &format!("conformal {arguments} -o no.ply"));
        assert!(ran.err.contains(message), "{arguments}: {}", ran.err);
        assert!(!workbench.path("no.ply").exists(), "{arguments}");
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let workbench = workbench();
    for threads in [1, 2] {
        let outputs = format!("-o {threads}.json -o {threads}.obj -o {threads}.glb");
        workbench.expect(
            0,
            &format!("conformal two.ply {outputs} --threads {threads} --seed 3"),
        );
    }
    for extension in ["json", "obj", "glb"] {
        let bytes = |threads: u32| workbench.bytes(&format!("{threads}.{extension}"));
        assert_eq!(bytes(1), bytes(2), "{extension}");
    }
}
