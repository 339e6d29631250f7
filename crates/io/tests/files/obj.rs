//! OBJ dialects.

use crate::common::{faces, refusal, soup, values};

#[test]
fn every_form_of_a_corner_and_every_arity_is_read() {
    let text = "# by hand\nmtllib none.mtl\no thing\nv 0 0 0\nv 1 0 0\nv 1 1 0 \nv 0 1 0\nv 9 9 9\n\
                vt 0 0\nvn 0 0 1\ng one\nusemtl x\ns off\nf 1 2 3\nf 1/1 2/1 3/1\nf 1//1 3//1 4//1\n\
                g two\nf 1/1/1 2/1/1 3/1/1 4/1/1 # quad\nl 1 2\np 1\n";
    let soup = soup("a.obj", text);
    assert_eq!(soup.positions.len(), 5, "the unused vertex stays");
    assert_eq!(
        faces(&soup),
        [
            vec![0, 1, 2],
            vec![0, 1, 2],
            vec![0, 2, 3],
            vec![0, 1, 2, 3]
        ]
    );
}

#[test]
fn indices_count_from_the_first_vertex_or_back_from_the_latest() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 2 2 2\nf -1 1 2\nf 1 2 9\nf 1 -9 0\n";
    let expected = [[0, 1, 2], [3, 0, 1], [0, 1, 8], [0, -5, -1]];
    assert_eq!(faces(&soup("a.obj", text)), expected);
}

#[test]
fn coordinates_are_doubles() {
    let soup = soup("a.obj", "v 1000000001.25052 1e300 4.9e-324\r\nf 1 1 1\r\n");
    assert_eq!(
        soup.positions[0].coords.as_slice(),
        [1_000_000_001.250_52, 1e300, 4.9e-324]
    );
}

#[test]
fn a_statement_continues_after_a_backslash() {
    let text = "v 0 0 \\\n 0\nv 1 \\\r\n 0 0\nv 0 1 0\nf 1 \\\n2 \\\n3\n";
    assert_eq!(faces(&soup("a.obj", text)), [[0, 1, 2]]);
    // Many of them take no more than linear time.
    let long = format!("v 0 0 0\nf 1 1 1 {}", "\\\n".repeat(1_000_000));
    assert_eq!(soup("a.obj", long).face_count(), 1);
}

#[test]
fn colours_after_the_coordinates_are_attributes() {
    let text = "v 0 0 0 1 0.5 0\nv 1 0 0 0 0 1\nf 1 2 1\n";
    assert_eq!(values(&soup("a.obj", text), "green"), [0.5, 0.0]);
    // A weight is no colour, and a colour for some vertices only is none for the surface.
    let text = "v 0 0 0 1.0\nv 1 0 0 0 0 1\nf 1 2 1\n";
    assert!(soup("a.obj", text).attributes.is_empty());
}

#[test]
fn faults_name_the_line() {
    let cases = [
        (
            "v 0 0\nf 1 1 1\n",
            "line 1: the line ends where the z coordinate is expected",
        ),
        (
            "v 0 0 0\nv 0 zero 0\n",
            "line 2: the y coordinate is `zero`, which is no number",
        ),
        (
            "v 0 0 0\nf 1 1 a/1\n",
            "line 2: a vertex index is `a`, which is no whole number",
        ),
        (
            "v 0 0 0\nf 1 1 99999999999999999999\n",
            "line 2: a vertex index is `9999",
        ),
        (
            "v 0 0 0\nvx 1\nf 1 1 1\n",
            "line 2: `vx` is no OBJ statement",
        ),
        ("# nothing\n", "holds no vertices"),
        ("v 0 0 0\nv 1 1 1\n", "holds 2 vertices but no faces"),
    ];
    for (text, expected) in cases {
        let text = refusal("a.obj", text).to_string();
        assert!(text.contains(expected), "{text}");
    }
}
