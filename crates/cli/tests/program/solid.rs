//! What the program does with solids.

use std::process::Command;

use msplines_common::mesh::shapes;
use msplines_common::mesh::tet::TetMesh;
use msplines_io::{Volume, VolumeCells, read_npy, write_volume};

use crate::workbench::Workbench;

/// Few spans, a coarse lattice and a few judged cells: fits of a second.
const FAST: &str = "--spans 4 --spacing 12 --samples 6000,4000 --validate-at 4 --tessellate 2";

/// Returns a folder with a ball, and the beginning of a command that fits a solid to it at its corners.
fn workbench() -> (Workbench, String) {
    let workbench = Workbench::new();
    let ball = shapes::sphere(300);
    workbench.put("ball.ply", &ball);
    let sign = |corner: usize, axis: usize| if corner >> axis & 1 == 1 { 1.0 } else { -1.0 };
    let nearest = |corner: usize| {
        let along = |v: &usize| -> f64 {
            let p = ball.positions()[*v];
            (0..3).map(|axis| sign(corner, axis) * p[axis]).sum()
        };
        let vertices = 0..ball.vertex_count();
        let best = vertices.max_by(|a, b| along(a).total_cmp(&along(b)));
        best.expect("a vertex").to_string()
    };
    let corners: Vec<String> = (0..8).map(nearest).collect();
    let corners = corners.join(",");
    (
        workbench,
        format!("fit trivariate ball.ply {FAST} --corners {corners}"),
    )
}

fn put_solid(workbench: &Workbench, name: &str, mesh: &TetMesh) {
    let volume = Volume {
        positions: mesh.positions(),
        cells: VolumeCells::Tetrahedra(mesh.cells()),
        point_data: &[],
        cell_data: &[],
    };
    write_volume(&workbench.path(name), &volume).expect("written");
}

/// A fit, what it says about itself, and everything that can be written of it.
#[test]
fn a_ball_becomes_a_solid_that_its_file_gives_again() {
    let (workbench, fit) = workbench();
    let outputs = "-o s.json -o s.ply -o s.vtu -o s.hex.vtu -o s.xml -o s.msh";
    workbench.expect(0, &format!("{fit} {outputs} --distance --report r.json"));
    let record = workbench.json("r.json");
    let checks = &record["checks"];
    assert_eq!(record["method"], "trivariate");
    assert_eq!(record["dofs"], 3 * 343);
    assert_eq!(
        (&checks["flipped_tets"], &checks["spans"]),
        (&0.into(), &64.into())
    );
    assert_eq!(checks["spans_certified"], 64);
    assert_eq!(
        (&checks["degenerate_4"], &checks["boundary_injective"]),
        (&0.into(), &true.into())
    );
    assert!(
        checks["min_det_jacobian_bound"]
            .as_f64()
            .is_some_and(|bound| bound > 0.0)
    );
    assert_eq!(record["error"]["kind"], "samples");
    for value in [
        &record["error"]["rms"],
        &record["distance"]["rms"],
        &checks["surface_rms"],
    ] {
        assert!(
            value.as_f64().is_some_and(|x| (0.0..2e-2).contains(&x)),
            "{value}"
        );
    }
    let spline = workbench.json("s.json");
    assert_eq!(
        spline["domain"]["cube"]["sha256"],
        record["input"]["sha256"]
    );
    // Six faces of 8 by 8 squares.
    let surface = workbench.soup("s.ply");
    assert_eq!((surface.positions.len(), surface.face_count()), (386, 768));
    let text = |name: &str| String::from_utf8(workbench.bytes(name)).expect("text");
    assert!(text("s.xml").contains("TensorBSpline3"));
    assert!(text("s.msh").contains("scaled_jacobian"));
    assert!(text("s.vtu").contains("NumberOfPoints=\"2197\" NumberOfCells=\"64\""));
    assert!(text("s.hex.vtu").contains("NumberOfPoints=\"729\" NumberOfCells=\"512\""));
    workbench.expect(0, "evaluate s.json -o again.ply -o again.vtu -o again.json");
    for (one, two) in [("s.vtu", "again.vtu"), ("s.json", "again.json")] {
        assert_eq!(workbench.bytes(one), workbench.bytes(two), "{one}");
    }
    assert_eq!(workbench.soup("again.ply").positions, surface.positions);
}

#[test]
fn points_and_derivatives_are_written_at_parameters() {
    let (workbench, fit) = workbench();
    workbench.expect(0, &format!("{fit} --fit least-squares -o s.json -o s.npy"));
    workbench.write("at.txt", "0 0 0\n0.5 0.5 0.5\n0.501 0.5 0.5\n");
    workbench.expect(0, "evaluate s.json --at at.txt -o p.npy -o p.csv");
    let points = read_npy(&workbench.path("p.npy")).expect("an array");
    assert_eq!(points.shape, [3, 12]);
    let row = |i: usize| &points.values[12 * i..12 * (i + 1)];
    let surface = read_npy(&workbench.path("s.npy")).expect("an array");
    assert_eq!(row(0)[..3], surface.values[..3]);
    for d in 0..3 {
        let slope = (row(2)[d] - row(1)[d]) / 1e-3;
        // Second derivatives of a ball over the cube are of the size of the ball.
        assert!((slope - row(1)[3 + d]).abs() < 1e-2, "{slope} {:?}", row(1));
    }
    let text = String::from_utf8(workbench.bytes("p.csv")).expect("text");
    assert_eq!(
        (text.lines().count(), text.starts_with("x,y,z,x_u")),
        (4, true)
    );
    workbench.write("far.txt", "0 0 0\n0 1.5 0\n");
    let ran = workbench.expect(3, "evaluate s.json --at far.txt -o no.npy");
    assert!(ran.err.contains("row 1"), "{}", ran.err);
    let ran = workbench.expect(2, "evaluate s.json --at at.txt -o no.ply");
    assert!(ran.err.contains(".csv"), "{}", ran.err);
}

#[test]
fn a_control_point_that_goes_too_far_breaks_the_certificate_and_says_so() {
    let (workbench, fit) = workbench();
    workbench.expect(0, &format!("{fit} -o s.json"));
    let checks = |arguments: &str| {
        let line = format!("deform s.json {arguments} -o d.json -o d.ply --report r.json");
        let ran = workbench.expect(0, &line);
        (workbench.json("r.json")["checks"].clone(), ran.err)
    };
    let spline = workbench.json("s.json");
    let middle: Vec<f64> = spline["data"]["points"][3 + 7 * (3 + 7 * 3)]
        .as_array()
        .expect("a point")
        .iter()
        .map(|x| x.as_f64().expect("a number"))
        .collect();
    let [x, y, z] = [middle[0], middle[1], middle[2]];
    let (little, _) = checks(&format!("--move 3,3,3={},{y},{z}", x + 0.01));
    assert_eq!(
        (&little["certified"], &little["moved_points"]),
        (&true.into(), &1.into())
    );
    let (far, said) = checks(&format!("--move 3,3,3={},{y},{z}", x + 9.0));
    assert_eq!(far["certified"], false);
    assert!(said.contains("may fold"), "{said}");
    let moved = workbench.json("d.json");
    let at = 3 + 7 * (3 + 7 * 3);
    assert_eq!(moved["data"]["points"][at][0], x + 9.0);
    assert_eq!(
        moved["data"]["points"][at - 1],
        spline["data"]["points"][at - 1]
    );
    for (arguments, message) in [
        ("--move 7,0,0=0,0,0", "[7, 0, 0]"),
        ("--move 1,0,2=0,nan,0", "[1, 0, 2]"),
        ("--move 1,0=0,0,0", "I,J,K=X,Y,Z"),
    ] {
        let ran = workbench.expect(2, &format!("deform s.json {arguments} -o no.ply"));
        assert!(ran.err.contains(message), "{arguments}: {}", ran.err);
        assert!(!workbench.path("no.ply").exists());
    }
}

#[test]
fn tetrahedra_are_read_described_and_fitted() {
    let workbench = Workbench::new();
    put_solid(&workbench, "box.mesh", &shapes::box_solid([3, 2, 2]));
    let ran = workbench.expect(0, "info box.mesh");
    assert!(
        ran.out.contains("72 tetrahedra") && ran.out.contains("no defects"),
        "{}",
        ran.out
    );
    let info = workbench.expect(0, "info box.mesh --json");
    let info: serde_json::Value = serde_json::from_str(&info.out).expect("JSON");
    assert_eq!(info["solid"]["boundary_genus"], 0);
    let fit = "fit trivariate box.mesh --corners 0,3,8,11,24,27,32,35";
    workbench.expect(
        0,
        &format!("{fit} {FAST} --fit least-squares -o s.json --report r.json"),
    );
    let record = workbench.json("r.json");
    assert_eq!(
        (&record["input"]["kind"], &record["input"]["cells"]),
        (&"tets".into(), &72.into())
    );
    assert_eq!(record["checks"]["corner_7"], 35);
    // Its map is linear, and so is what is fitted.
    assert!(
        record["error"]["max"]
            .as_f64()
            .is_some_and(|max| max < 1e-3),
        "{}",
        record["error"]
    );
    let paper = format!("{fit} --paper --levels 2..4 --validate-at 4 -o s.json --report r.json");
    workbench.expect(0, &paper);
    assert_eq!(workbench.json("r.json")["checks"]["levels"], 2);
}

#[test]
fn inverted_tetrahedra_are_refused_or_repaired() {
    let workbench = Workbench::new();
    let mut text = String::from("MeshVersionFormatted 2\nDimension 3\nVertices\n");
    let mesh = shapes::box_solid([2, 2, 2]);
    text += &format!("{}\n", mesh.vertex_count());
    for p in mesh.positions() {
        text += &format!("{} {} {} 0\n", p.x, p.y, p.z);
    }
    text += &format!("Tetrahedra\n{}\n", mesh.cell_count());
    for (cell, corners) in mesh.cells().iter().enumerate() {
        let mut corners = corners.map(|v| v + 1);
        if cell == 5 {
            corners.swap(0, 1);
        }
        text += &format!(
            "{} {} {} {} 0\n",
            corners[0], corners[1], corners[2], corners[3]
        );
    }
    workbench.write("turned.mesh", &format!("{text}End\n"));
    let fit = format!("fit trivariate turned.mesh {FAST} --fit least-squares -o s.json");
    let ran = workbench.expect(3, &fit);
    assert!(ran.err.contains("--repair"), "{}", ran.err);
    assert!(!workbench.path("s.json").exists());
    let ran = workbench.expect(0, "info turned.mesh");
    assert!(ran.out.contains("1 defects"), "{}", ran.out);
    let ran = workbench.expect(0, &format!("{fit} --repair"));
    assert!(ran.err.contains("repaired"), "{}", ran.err);
}

/// Every refusal names what is wrong, leaves nothing behind and says what to do.
#[test]
fn what_is_no_ball_and_what_means_nothing_is_refused() {
    let (workbench, _) = workbench();
    workbench.put("open.ply", &shapes::vase(300));
    workbench.put("ring.ply", &shapes::torus(1.0, 0.4, 300));
    let cases = [
        ("open.ply", "", 4, "is open"),
        ("ring.ply", "", 4, "genus 1"),
        (
            "ball.ply",
            "--corners 0,0,1,2,3,4,5,6",
            2,
            "corners 0 and 1",
        ),
        ("ball.ply", "--corners 0,1,2,3,4,5,6,999", 2, "999"),
        ("ball.ply", "--corners 0,1,2", 2, "eight vertices"),
        ("ball.ply", "--levels 4..64..2", 2, "such as 2..64"),
        ("ball.ply", "--levels 3..16", 2, "power of two"),
        ("ball.ply", "--levels 0..0", 2, "levels from 0"),
        ("ball.ply", "--levels 4..4096", 2, "at most"),
        ("ball.ply", "--spans 0", 2, "1..=512"),
        ("ball.ply", "--stop 0.1", 2, "--fit multilevel"),
        ("ball.ply", "--validate-at 0", 2, "1..=200"),
        ("ball.ply", "--spacing 0", 2, "positive"),
        ("ball.ply", "--samples 9", 2, "150000,60000"),
        ("ball.ply", "--map ball", 2, "cylinder"),
        ("ball.ply", "-o no.step", 2, ".hex.vtu"),
        ("none.ply", "", 3, "none.ply"),
    ];
    for (file, arguments, code, message) in cases {
        let line = format!("fit trivariate {file} {arguments} -o no.ply");
        let ran = workbench.expect(code, &line);
        assert!(ran.err.contains(message), "{line}: {}", ran.err);
        assert!(!workbench.path("no.ply").exists(), "{line}");
    }
}

#[test]
fn surfaces_and_solids_are_told_apart() {
    let (workbench, fit) = workbench();
    workbench.expect(0, "fit ls-mesh mesh.ply --controls 20 -o surface.json");
    workbench.expect(0, &format!("{fit} --fit least-squares -o solid.json"));
    let cases = [
        ("deform surface.json --move 1,1,1=0,0,0", "ls-mesh"),
        ("evaluate surface.json --at at.txt", "ls-mesh"),
        ("edit solid.json --move 0,0,0:1,1,1", "msplines deform"),
        ("evaluate solid.json --subdivide 1", "--tessellate"),
    ];
    for (arguments, message) in cases {
        let ran = workbench.expect(2, &format!("{arguments} -o no.ply"));
        assert!(ran.err.contains(message), "{arguments}: {}", ran.err);
        assert!(!workbench.path("no.ply").exists(), "{arguments}");
    }
    put_solid(&workbench, "box.msh", &shapes::box_solid([2, 2, 2]));
    workbench.expect(3, "fit ls-mesh box.msh --controls 20 -o no.ply");
}

#[test]
fn tetgen_is_run_where_it_is_installed_and_named_where_not() {
    let (workbench, fit) = workbench();
    let arguments = format!("{fit} --tetgen -o s.json");
    let ran = Command::new(env!("CARGO_BIN_EXE_msplines"))
        .args(arguments.split_whitespace())
        .current_dir(workbench.path(""))
        .env("PATH", "")
        .output()
        .expect("the program starts");
    let text = String::from_utf8_lossy(&ran.stderr);
    assert_eq!(ran.status.code(), Some(2), "{text}");
    assert!(text.contains("apt install tetgen"), "{text}");
    if Command::new("tetgen").arg("-h").output().is_err() {
        println!("not run: tetgen");
        return;
    }
    workbench.expect(0, &format!("{arguments} --report r.json"));
    assert_eq!(workbench.json("r.json")["checks"]["filler"], "tetgen");
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let (workbench, fit) = workbench();
    for threads in [1, 2] {
        let outputs = format!("-o {threads}.json -o {threads}.vtu -o {threads}.msh");
        let line = format!("{fit} {outputs} --threads {threads} --seed 7");
        workbench.expect(0, &line);
    }
    for extension in ["json", "vtu", "msh"] {
        let bytes = |threads: u32| workbench.bytes(&format!("{threads}.{extension}"));
        assert_eq!(bytes(1), bytes(2), "{extension}");
    }
}
