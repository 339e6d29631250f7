//! OFF dialects.

use crate::common::{faces, refusal, soup, values};

#[test]
fn comments_and_counts_on_any_line_are_read() {
    let expected = [vec![0, 1, 2], vec![0, 1, 2, 3], vec![0, 1, 7]];
    let body = "0 0 0\n1 0 0\n\n1 1 0\n# last\n0 1 0.1\n3 0 1 2\n4 0 1 2 3 255 0 0\n3 0 1 7\n";
    for head in ["OFF\n4 3 0\n", "OFF 4 3 0\n", "# note\nOFF # form\n\n4 3\n"] {
        let soup = soup("a.off", format!("{head}{body}"));
        assert_eq!(faces(&soup), expected);
        assert_eq!(soup.positions[3].z, 0.1);
        let crlf = format!("{head}{body}").replace('\n', "\r\n");
        assert_eq!(faces(&crate::common::soup("a.off", crlf)), expected);
    }
}

#[test]
fn normals_colours_and_texture_are_attributes_in_that_order() {
    let read = soup(
        "a.off",
        "STCNOFF 1 1 0\n0 0 0 0 0 1 10 20 30 40 .5 .6\n3 0 0 0\n",
    );
    let names: Vec<_> = read.attributes.iter().map(|a| a.name.as_str()).collect();
    assert_eq!(
        names,
        ["nx", "ny", "nz", "red", "green", "blue", "alpha", "s", "t"]
    );
    assert_eq!(values(&read, "blue"), [30.0]);
    assert_eq!(values(&read, "t"), [0.6]);
    let read = soup("a.off", "COFF 1 1 0\n0 0 0 .1 .2 .3\n3 0 0 0\n");
    assert_eq!(read.attributes.len(), 3);
    let read = soup("a.off", "NOFF\n1 1 0\n0 0 0 0 1 0\n3 0 0 0\n");
    assert_eq!(values(&read, "ny"), [1.0]);
}

#[test]
fn faults_name_the_line_and_the_element() {
    let cases = [
        (
            "OFF BINARY\n\0\0\0",
            "line 1: binary OFF is not supported; save it as text",
        ),
        (
            "4OFF\n1 1 0\n0 0 0 1\n3 0 0 0\n",
            "the form `4OFF` is not supported",
        ),
        ("OFF\n", "the file ends early: the counts are missing"),
        ("OFF\n-1 1 0\n", "line 2: the number of vertices is -1"),
        (
            "OFF\n1000000000000 1 0\n0 0 0\n",
            "1000000000000 vertices are announced, there is room",
        ),
        (
            "OFF\n1 4000000000 0\n0 0 0\n3 0 0 0",
            "4000000000 faces are announced, there is room",
        ),
        (
            "OFF\n3 1 0\n0 0 0\n1 0 0\n\n\n\n\n\n",
            "3 vertices are announced, 2 are there",
        ),
        (
            "OFF\n1 2 0\n0 0 0\n3 0 0 0\n",
            "2 faces are announced, 1 are there",
        ),
        (
            "OFF\n2 1 0\n0 0 0\n1 0\n3 0 0 0\n",
            "vertex 1 (line 4): the line ends where the z",
        ),
        (
            "OFF\n1 1 0\n0 0 0\n9000000000 0 0 0\n",
            "face 0 (line 4): 9000000000 corners are",
        ),
        (
            "OFF\n1 1 0\n0 0 0\n3 0 0 x\n",
            "face 0 (line 4): a vertex index is `x`",
        ),
        (
            "COFF\n2 1 0\n0 0 0 1 1 1\n0 0 0\n3 0 0 0\n",
            "vertex 1 (line 4): the line ends where red",
        ),
    ];
    for (text, expected) in cases {
        let text = refusal("a.off", text).to_string();
        assert!(text.contains(expected), "{text}");
    }
}
