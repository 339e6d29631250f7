//! Medit.

use super::{POINTS, expected, refusal, tets};

#[test]
fn medit_keywords_stand_in_any_layout_and_lower_cells_are_left_out() {
    let head = "MeshVersionFormatted 1\n# note\nDimension\n3\n";
    let vertices: String = POINTS
        .iter()
        .map(|p| format!("{:?} {:?} {:?} 7\n", p[0], p[1], p[2]))
        .collect();
    let body = format!(
        "{head}Vertices 5 {vertices}Corners\n1\n1\nEdges 1\n1 2 0\nTriangles 1 1 2 3 0\nHexahedra 0\n\
         Tetrahedra\n2\n1 2 3 4 0 1 3 2 5\n9\nEnd\nleft 1 2\n"
    );
    assert_eq!(tets("a.mesh", &body), expected());
    assert_eq!(tets("any.name", body.replace('\n', "\r\n")), expected());
}

#[test]
fn medit_faults_name_the_line() {
    let cases = [
        (
            "MeshVersionFormatted 2\nDimension 2\n",
            "line 2: dimension 2 is not supported",
        ),
        (
            "MeshVersionFormatted 2\nVertices\n99999\n0 0 0 0\n",
            "line 3: the file ends early: the number of vertices is 99999",
        ),
        (
            "MeshVersionFormatted 2\nVertices\n1\n0 0 x 0\n",
            "vertex 0 (line 4): the z coordinate is `x`",
        ),
        (
            "MeshVersionFormatted 2\nVertices\n1\n0 0 0 0\nTetrahedra 1\n1 1 1",
            "room for at most 0",
        ),
        (
            "MeshVersionFormatted 2\nVertices\n-1\n",
            "line 3: the number of vertices is -1",
        ),
        (
            "MeshVersionFormatted 2\nPrisms\n1\n1 2 3 4 5 6 0\n",
            "line 3: a cell that is a prism",
        ),
        (
            "MeshVersionFormatted 2\nBlobs 1\n",
            "line 2: `Blobs` is no keyword",
        ),
        (
            "MeshVersionFormatted 2\nVertices\n1\n0 0 0 0\nEnd\n",
            "holds 1 vertices but no tetrahedra",
        ),
    ];
    for (text, expected) in cases {
        let told = refusal("a.mesh", text);
        assert!(told.contains(expected), "{expected}: {told}");
    }
    let told = refusal("a.meshb", b"\x01\0\0\0\x02\0\0\0\x03\0\0\0");
    assert!(
        told.contains("binary Medit is not supported; save it as text .mesh"),
        "{told}"
    );
}
