//! STL dialects.

use crate::common::{faces, refusal, soup};

const TEXT: &str = "solid two triangles
  facet normal 0 0 1
    outer loop
      vertex 0 0 0
      vertex 1 0 0
      vertex 1e9 1 0.1
    endloop
  endfacet
  FACET NORMAL 0 0 1
    OUTER LOOP
      VERTEX 1e9 1 0.1
      VERTEX 1 -0.0 0
      VERTEX nan 0 0
    ENDLOOP
  ENDFACET
endsolid two triangles
";

/// Returns a binary file of two triangles that share an edge, behind this header text.
fn binary(header: &str) -> Vec<u8> {
    let mut file = header.as_bytes().to_vec();
    file.resize(80, b' ');
    file.extend(2u32.to_le_bytes());
    for triangle in [
        [[0, 0, 0], [1, 0, 0], [1, 1, 0]],
        [[1, 1, 0], [0, 1, 0], [0, 0, 0]],
    ] {
        file.extend([0; 12]);
        for number in triangle.iter().flatten() {
            file.extend((*number as f32).to_le_bytes());
        }
        file.extend([0, 0]);
    }
    file
}

#[test]
fn equal_positions_become_one_vertex_in_order_of_first_use() {
    let read = soup("a.stl", TEXT);
    assert_eq!(faces(&read), [[0, 1, 2], [2, 1, 3]]);
    assert_eq!(read.positions[2].coords.as_slice(), [1e9, 1.0, 0.1]);
    assert!(read.positions[3].x.is_nan());
    assert_eq!(
        faces(&soup("a.stl", binary("made by hand"))),
        [[0, 1, 2], [2, 3, 0]]
    );
}

#[test]
fn a_binary_file_may_begin_like_a_text_one_and_have_any_name() {
    for name in ["a.stl", "a.bin", "noextension"] {
        assert_eq!(soup(name, binary("solid but not text")).face_count(), 2);
    }
    assert_eq!(soup("noextension", TEXT).face_count(), 2);
}

#[test]
fn faults_name_the_place() {
    let whole = binary("x");
    for length in 1..whole.len() {
        let text = refusal("cut.stl", &whole[..length]).to_string();
        assert!(text.contains("cut.stl (STL), byte"), "{text}");
    }
    let mut longer = whole.clone();
    longer.push(0);
    let text = refusal("a.stl", longer).to_string();
    assert!(
        text.contains("2 triangles are announced, 2 are there and 1 further bytes"),
        "{text}"
    );
    let mut huge = whole;
    huge[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    let text = refusal("a.stl", huge).to_string();
    assert!(
        text.contains("4294967295 triangles are announced, 2 are there"),
        "{text}"
    );
}

#[test]
fn faults_of_text_name_the_line() {
    let cases = [
        (
            "endsolid two triangles\n",
            "",
            "line 15: the file ends early: `endsolid` is missing",
        ),
        (
            "vertex 1 0 0\n",
            "",
            "triangle 0 (line 7): a facet has not three vertices",
        ),
        (
            "vertex 1 0 0",
            "vertex 1 0 o",
            "triangle 0 (line 5): the z coordinate is `o`",
        ),
        ("outer", "inner", "line 3: `inner` is no STL statement"),
    ];
    for (from, to, expected) in cases {
        let text = refusal("a.stl", TEXT.replacen(from, to, 1)).to_string();
        assert!(text.contains(expected), "{text}");
    }
}
