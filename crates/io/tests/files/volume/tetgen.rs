//! TetGen's pair of files.

use std::path::Path;

use msplines_io::{ReadError, parse_tetgen, read_tets};

use super::{CELLS, POINTS, expected, refusal};
use crate::common::scratch;

#[test]
fn tetgen_counts_from_zero_or_one() {
    for first in [0, 1] {
        let node: String = POINTS
            .iter()
            .enumerate()
            .map(|(i, p)| format!("{} {:?} {:?} {:?} 1\n", i + first, p[0], p[1], p[2]))
            .collect();
        let node = format!("# made\n5 3 0 1\n{node}# end\n");
        let ele: String = CELLS
            .iter()
            .enumerate()
            .map(|(i, c)| {
                format!(
                    "{} {} {} {} {} 7\n",
                    i + first,
                    c[0] + first as u32,
                    c[1] + first as u32,
                    c[2] + first as u32,
                    c[3] + first as u32
                )
            })
            .collect();
        let ele = format!("2 4 1\n{ele}");
        let (directory, path) = scratch("a.1.ele");
        std::fs::write(&path, &ele).unwrap();
        assert!(
            matches!(read_tets(&path), Err(ReadError::Open { .. })),
            "the other file is missing"
        );
        std::fs::write(directory.path().join("a.1.node"), &node).unwrap();
        assert_eq!(read_tets(&path).unwrap(), expected());
        assert_eq!(
            read_tets(&directory.path().join("a.1.node")).unwrap(),
            expected()
        );
    }
}

#[test]
fn tetgen_faults_name_the_file_and_line() {
    let told = |node: &str, ele: &str| {
        let (node, ele) = (
            (Path::new("a.node"), node.as_bytes()),
            (Path::new("a.ele"), ele.as_bytes()),
        );
        parse_tetgen(node, ele).unwrap_err().to_string()
    };
    let node = "1 3 0 0\n0 0 0 0\n";
    let cases = [
        (
            told("1 2 0 0\n0 0 0 0\n", ""),
            "a.node (TetGen), line 1: dimension 2",
        ),
        (
            told("2 3 0 0\n0 0 0 0\n2 0 0 0\n", ""),
            "vertex 1 (line 3): the index is 2; indices must count up",
        ),
        (told("9 3 0 0\n0 0 0 0\n", ""), "9 is"),
        (
            told(node, "1 10 0\n0 1 2 3 4 5 6 7 8 9 10\n"),
            "a cell that is a tetrahedron of 10 nodes",
        ),
        (told(node, "1 4 0\n0 0 0 0\n"), "room for at most 0"),
        (
            told(node, "1 4 0\n0 0 0 0 0.5\n"),
            "tetrahedron 0 (line 2): a vertex index is `0.5`",
        ),
        (
            told(node, "0 4 0\n"),
            "a.ele (TetGen) holds 1 vertices but no tetrahedra",
        ),
    ];
    for (told, expected) in cases {
        assert!(
            told.contains(expected) || expected == "9 is" && told.contains("is 9, there is room"),
            "{expected}: {told}"
        );
    }
    assert!(refusal("a.node", node).contains("give the .node and the .ele file together"));
}
