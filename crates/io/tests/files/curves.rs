//! Curve networks and lists of creases: what is read, and what is refused.

use std::path::Path;

use msplines_common::mesh::curves::{Curve, CurveNetwork};
use msplines_common::mesh::polygon::CreaseTag;
use msplines_io::{parse_creases, parse_curves, parse_soup, read_creases, read_curves};
use nalgebra::Point3;

use crate::common::scratch;

fn network(name: &str, content: &str) -> CurveNetwork {
    match parse_curves(Path::new(name), content.as_bytes()) {
        Ok(network) => network,
        Err(error) => panic!("{error}"),
    }
}

fn refusal(name: &str, content: &str) -> String {
    let error = parse_curves(Path::new(name), content.as_bytes()).unwrap_err();
    error.to_string()
}

#[test]
fn curves_have_points_polylines_and_creases() {
    let text = "# a triangle and a stroke\nv 0 0 0\nv 1 0 0\nv 0 1 0 # the top\nc 1 2 3 1\n\
                k 0 1 0\nc 3 4\nv 0 0 1\n";
    let read = network("a.curves", text);
    assert_eq!(read.points()[3], Point3::new(0.0, 0.0, 1.0));
    let triangle = Curve {
        points: vec![0, 1, 2, 0],
        creases: vec![false, true, false],
    };
    assert_eq!(read.curves(), [triangle, Curve::smooth(vec![2, 3])]);
    let (_directory, path) = scratch("a.curves");
    std::fs::write(&path, text).unwrap();
    assert_eq!(read_curves(&path).unwrap(), read);
}

/// Checks that a triangle's points with these rows are refused with these texts.
fn check_refusals(cases: &[(&str, &str)]) {
    for (rows, text) in cases {
        let refused = refusal("a.curves", &format!("{POINTS}{rows}\n"));
        assert!(
            refused.starts_with("a.curves (curve network), line "),
            "{refused}"
        );
        assert!(refused.contains(text), "{refused}");
        assert!(refused.contains("correct it there"), "{refused}");
    }
}

const POINTS: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

#[test]
fn broken_curves_are_refused_with_their_line() {
    check_refusals(&[
        (
            "c 1 4",
            "line 4: the curve names point 4, but there are 3, from 1",
        ),
        ("c 0 1", "line 4: the curve names point 0, but"),
        ("c -1 1", "line 4: the curve names point -1, but"),
        ("c 1 9223372036854775807", "names point 9223372036854775807"),
        ("c 1 9223372036854775808", "which is no whole number"),
        (
            "c 1 2.5",
            "a point index is `2.5`, which is no whole number",
        ),
        (
            "c 1 2\nc 3",
            "line 5: the curve has 1 points, and needs two",
        ),
        ("c", "line 4: the curve has 0 points"),
        (
            "c 1 2 2",
            "line 4: the curve goes from point 2 to point 2, which is the same place",
        ),
        ("c 1 2 1", "goes from point 1 to point 2 and straight back"),
    ]);
}

#[test]
fn broken_rows_are_refused_with_their_line() {
    check_refusals(&[
        (
            "c 1 2\nk 0 1",
            "line 5: there are 2 crease flags for 1 segments",
        ),
        ("c 1 2\nk 2", "a crease flag is `2`, neither 0 nor 1"),
        (
            "c 1 2\nk 1\nk 1",
            "line 6: this row of crease flags does not follow a curve",
        ),
        (
            "k 1",
            "line 4: this row of crease flags does not follow a curve",
        ),
        (
            "v 1 2\nc 1 2",
            "line 4: the line ends where the z coordinate is expected",
        ),
        (
            "v 1 2 3 4\nc 1 2",
            "line 4: `4` follows the three coordinates",
        ),
        (
            "v 1 nan 3\nc 1 2",
            "line 4: a coordinate is no finite number",
        ),
        (
            "v 1 1e999 3\nc 1 2",
            "line 4: a coordinate is no finite number",
        ),
        (
            "curve 1 2",
            "line 4: `curve` starts no row of a curve network",
        ),
    ]);
}

#[test]
fn files_without_curves_are_refused() {
    assert!(refusal("a.curves", POINTS).contains("holds no curves; give `c` rows"));
    assert_eq!(
        refusal("a.curves", ""),
        "a.curves is empty; export it again"
    );
    let refused = refusal("a.step", POINTS);
    assert!(
        refused.contains("give a .curves, OBJ or SVG file"),
        "{refused}"
    );
}

#[test]
fn lines_of_obj_files_are_curves() {
    let text = "v 0 0 0\nv 1 0 0 1\nv 0 1 0\nvt 0 0\nf 1 2 3\nl 1/1 2/1 3\ng rim_Crease\n\
                l -1 \\\n-3\n";
    let read = network("a.obj", text);
    let expected = [Curve::smooth(vec![0, 1, 2]), Curve::crease(vec![2, 0])];
    assert_eq!(read.curves(), expected);
    let refused = refusal("a.obj", "v 0 0 0\nv 1 0 0\nl 1 -3\n");
    assert!(
        refused.contains("a.obj (OBJ), line 3: the curve names point 0"),
        "{refused}"
    );
    assert!(refusal("a.obj", "v 0 0 0\nf 1 1 1\n").contains("`l` lines in an OBJ file"));
}

/// Returns a drawing with this content.
fn svg(content: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\">\n{content}\n</svg>\n"
    )
}

#[test]
fn paths_share_the_points_where_their_nodes_coincide() {
    let text = svg(
        "<g transform=\"translate(10 20)\"><path d=\"M0 0 h10 v10 h-10 z\"/>\n\
         <g transform=\"scale(2)\" class=\"crease\"><line x2=\"5\" y2=\"5\"/></g></g>\n\
         <defs><path d=\"M 99 99 h 1\"/></defs>",
    );
    let read = network("a.svg", &text);
    let expected = [
        Curve::smooth(vec![0, 1, 2, 3, 0]),
        Curve::crease(vec![0, 2]),
    ];
    assert_eq!(read.curves(), expected);
    let at = |x: f64, y: f64| Point3::new(x, y, 0.0);
    let square = [
        at(10.0, -20.0),
        at(20.0, -20.0),
        at(20.0, -30.0),
        at(10.0, -30.0),
    ];
    assert_eq!(read.points(), square);
}

#[test]
fn transforms_apply_from_the_inside_out() {
    let text = svg("<g transform=\"rotate(90) translate(1 0)\"><path d=\"M0 0 L 0 2\"/></g>");
    let read = network("a.svg", &text);
    // With y downwards, (1, 0) goes to (0, 1) and (1, 2) to (-2, 1).
    let expected = [Point3::new(0.0, -1.0, 0.0), Point3::new(-2.0, -1.0, 0.0)];
    for (p, q) in read.points().iter().zip(expected) {
        assert!((p - q).norm() < 1e-12, "{p} {q}");
    }
}

#[test]
fn curves_of_a_drawing_are_flattened_closely() {
    let text = svg("<path d=\"M 1 0 A 1 1 0 0 1 -1 0 A 1 1 0 0 1 1 0 Z\"/>");
    let read = network("a.svg", &text);
    assert!(read.curves()[0].is_closed());
    for p in read.points() {
        assert!((p.coords.norm() - 1.0).abs() < 1e-3, "{p}");
    }
    let curve = &read.curves()[0];
    for ends in curve.points.windows(2) {
        let [p, q] = [ends[0], ends[1]].map(|i| read.points()[i as usize]);
        let middle = nalgebra::center(&p, &q);
        assert!((middle.coords.norm() - 1.0).abs() < 1e-3, "{middle}");
    }
}

#[test]
fn an_arc_of_any_size_is_cut_into_few_pieces() {
    for size in [1e-30, 1e-9, 1.0, 1e12, 1e30, 1e150] {
        // Half a circle, whose radius is too small and grows, and a quarter of one.
        let text = svg(&format!(
            "<path d=\"M 0 0 A {r} {r} 0 0 1 {size} 0 a {h} {h} 0 0 0 {h} {h}\"/>",
            r = size / 8.0,
            h = size / 2.0,
        ));
        let read = network("a.svg", &text);
        assert!(read.points().len() < 200, "{}", read.points().len());
        let (centers, radius) = ([[0.5, 0.0], [1.5, 0.0]], 0.5);
        for p in read.points() {
            let p = p / size;
            let deviation = |[x, y]: [f64; 2]| ((p.x - x).hypot(p.y - y) - radius).abs();
            let least = centers.map(deviation).into_iter().fold(1.0, f64::min);
            assert!(least < 1e-4, "{size}: {p}");
        }
        let end = read.points().iter().map(|p| p.x / size).fold(0.0, f64::max);
        assert!((end - 1.5).abs() < 1e-12, "{end}");
    }
}

#[test]
fn shorthands_of_paths_reflect_what_came_before() {
    let points = |data: &str| {
        let read = network("a.svg", &svg(&format!("<path d=\"{data}\"/>")));
        let curves: Vec<_> = read.curves().iter().map(|c| c.points.clone()).collect();
        (read.points().to_vec(), curves)
    };
    for (short, long) in [
        (
            "m 1 2 3 4 h 2 v -1 H 9 V 9",
            "M 1 2 L 4 6 L 6 6 L 6 5 L 9 5 L 9 9",
        ),
        (
            "M 0 0 c 0 1 1 2 2 2 s 2 1 2 3",
            "M 0 0 C 0 1 1 2 2 2 C 3 2 4 3 4 5",
        ),
        ("M 0 0 S 1 2 2 2", "M 0 0 C 0 0 1 2 2 2"),
        (
            "M 0 0 q 1 2 2 0 t 2 0 t 2 0",
            "M 0 0 Q 1 2 2 0 Q 3 -2 4 0 Q 5 2 6 0",
        ),
        ("M 0 0 L 1 0 T 2 1", "M 0 0 L 1 0 Q 1 0 2 1"),
        (
            "M 1 1 h 2 v 2 z l 0 5",
            "M 1 1 L 3 1 L 3 3 L 1 1 M 1 1 L 1 6",
        ),
        ("M 0 0 A 0 3 0 0 1 2 1", "M 0 0 L 2 1"),
    ] {
        assert_eq!(points(short), points(long), "{short}");
    }
}

#[test]
fn what_a_drawing_cannot_say_is_refused_with_its_line() {
    for (content, text) in [
        (
            "\n<circle r=\"1\"/>",
            "a.svg (SVG), line 4: the SVG element `circle` is not supported; convert it to a path",
        ),
        (
            "<path d=\"M 0 0 L 1 x\"/>",
            "line 3: the path data cannot be read",
        ),
        ("<path d=\"L 1 1\"/>", "line 3: the path data"),
        (
            "<g transform=\"turn(3)\"><path d=\"M 0 0 h 1\"/></g>",
            "line 3: the transform cannot be read",
        ),
        ("<path d=\"M 0 0 h 0\"/>", "line 3: the curve has 1 points"),
        (
            "<path d=\"M 0 0 L 1e308 0 l 1e308 0\"/>",
            "line 3: a coordinate is no finite number",
        ),
        ("<g>", "this is no XML"),
        ("", "holds no curves"),
    ] {
        let refused = refusal("a.svg", &svg(content));
        assert!(refused.contains(text), "{refused}");
    }
    let refused = refusal("a.svg", "<svg>");
    assert!(refused.contains("an element is not closed"), "{refused}");
}

#[test]
fn creases_keep_their_lines() {
    let text =
        "# i j sharpness\n\n1 2 7.9\n# source tag: creasemethod 0/1/0 chaikin\n3 3 10 # corner\n";
    let (_directory, path) = scratch("a.creases");
    std::fs::write(&path, text).unwrap();
    let creases = read_creases(&path).unwrap();
    let tag = |vertices, sharpness| CreaseTag {
        vertices,
        sharpness,
    };
    assert_eq!(creases.tags, [tag([0, 1], 7.9), tag([2, 2], 10.0)]);
    assert_eq!(creases.lines, [3, 5]);
    let none = parse_creases(Path::new("a.creases"), b"# nothing\n").unwrap();
    assert!(none.tags.is_empty());
}

#[test]
fn rows_that_are_no_crease_are_refused_with_their_line() {
    for (row, text) in [
        (
            "0 1 2",
            "line 2: the first vertex is 0; vertices count from 1",
        ),
        (
            "1 -2 2",
            "line 2: the second vertex is -2; vertices count from 1",
        ),
        (
            "1 4294967296 2",
            "the second vertex is 4294967296; vertices",
        ),
        ("1 99999999999999999999 2", "which is no whole number"),
        (
            "1 2 nan",
            "line 2: the sharpness is NaN, neither 0 nor more",
        ),
        ("1 2 -1", "line 2: the sharpness is -1, neither 0 nor more"),
        (
            "1 2",
            "line 2: the line ends where the sharpness is expected",
        ),
        ("1 2 3 4", "line 2: `4` follows the sharpness"),
        ("a 2 3", "the first vertex is `a`, which is no whole number"),
    ] {
        let content = format!("# rows\n{row}\n");
        let error = parse_creases(Path::new("a.creases"), content.as_bytes()).unwrap_err();
        let refused = error.to_string();
        assert!(
            refused.starts_with("a.creases (creases), line 2: "),
            "{refused}"
        );
        assert!(refused.contains(text), "{refused}");
    }
    let error = parse_creases(Path::new("a.creases"), b"").unwrap_err();
    assert_eq!(error.to_string(), "a.creases is empty; export it again");
}

#[test]
fn no_list_of_curves_or_creases_is_a_mesh() {
    for (name, text) in [
        (
            "a.curves",
            "a curve network as a mesh is not supported; give an OBJ",
        ),
        ("a.svg", "a curve network as a mesh is not supported"),
        ("a.creases", "give the control mesh it belongs to"),
    ] {
        let error = parse_soup(Path::new(name), b"1 2 3\n").unwrap_err();
        assert!(error.to_string().contains(text), "{error}");
    }
}
