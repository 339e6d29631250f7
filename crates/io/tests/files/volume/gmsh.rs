//! Gmsh, both versions, text and binary.

use std::path::Path;

use msplines_io::parse_tets;

use super::{POINTS, expected, refusal, rows, tets};

#[test]
fn gmsh_text_has_tags_with_gaps_and_other_sections() {
    let tag = [3, 7, 100, 2, 5];
    let names = "$PhysicalNames\n1\n3 1 \"a # b\"\n$EndPhysicalNames\n";
    let nodes: String = tag
        .iter()
        .zip(POINTS)
        .map(|(t, p)| format!("{t} {:?} {:?} {:?}\n", p[0], p[1], p[2]))
        .collect();
    let two = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n{names}$Nodes\n5\n{nodes}$EndNodes\n$Elements\n4\n\
         1 15 2 0 1 3\n2 2 2 0 1 3 7 100\n3 4 2 0 1 3 7 100 2\n9 4 0 3 100 7 5\n$EndElements\n\
         $NodeData\n1\n\"x\"\n$EndNodeData\n"
    );
    assert_eq!(tets("a.msh", two), expected());
    let four = format!(
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n{names}$Entities\n0 0 0 1\n1 0 0 0 1 1 1 0 0\n$EndEntities\n\
         $Nodes\n2 5 2 100\n2 1 1 2\n3\n7\n0 0 0 .5 .5\n1 0 0 .5 .5\n3 1 0 3\n100\n2\n5\n{}$EndNodes\n\
         $Elements\n2 3 1 3\n2 1 2 1\n1 3 7 100\n3 1 4 2\n2 3 7 100 2\n3 3 100 7 5\n$EndElements\n",
        rows(&POINTS[2..])
    );
    assert_eq!(tets("a.msh", four), expected());
}

/// The bytes of a binary Gmsh file of either version.
fn binary_gmsh(
    version: &str,
    int: fn(i32) -> [u8; 4],
    long: fn(i64) -> [u8; 8],
    double: fn(f64) -> [u8; 8],
) -> Vec<u8> {
    let mut file = format!("$MeshFormat\n{version} 1 8\n").into_bytes();
    file.extend(int(1));
    file.extend(b"\n$EndMeshFormat\n$Nodes\n");
    let points = || POINTS.iter().flatten().flat_map(|&x| double(x));
    if version == "2.2" {
        file.extend(b"5\n");
        for (tag, p) in (1..).zip(POINTS) {
            file.extend(int(tag));
            file.extend(p.iter().flat_map(|&x| double(x)));
        }
        file.extend(b"\n$EndNodes\n$Elements\n3\n");
        file.extend([2, 1, 2, 1, 0, 1, 1, 2, 3].iter().flat_map(|&x| int(x)));
        file.extend(
            [4, 2, 2, 2, 0, 1, 1, 2, 3, 4, 3, 0, 1, 1, 3, 2, 5]
                .iter()
                .flat_map(|&x| int(x)),
        );
    } else {
        file.extend([1, 5, 1, 5].iter().flat_map(|&x| long(x)));
        file.extend([3, 1, 0].iter().flat_map(|&x| int(x)));
        file.extend([5, 1, 2, 3, 4, 5].iter().flat_map(|&x| long(x)));
        file.extend(points());
        file.extend(b"\n$EndNodes\n$Elements\n");
        file.extend([1, 2, 1, 2].iter().flat_map(|&x| long(x)));
        file.extend([3, 1, 4].iter().flat_map(|&x| int(x)));
        file.extend(
            [2, 1, 1, 2, 3, 4, 2, 1, 3, 2, 5]
                .iter()
                .flat_map(|&x| long(x)),
        );
    }
    file.extend(b"\n$EndElements\n");
    file
}

#[test]
fn binary_gmsh_is_read_in_either_order() {
    for version in ["2.2", "4.1"] {
        let little = binary_gmsh(
            version,
            i32::to_le_bytes,
            i64::to_le_bytes,
            f64::to_le_bytes,
        );
        assert_eq!(tets("a.msh", &little), expected());
        let big = binary_gmsh(
            version,
            i32::to_be_bytes,
            i64::to_be_bytes,
            f64::to_be_bytes,
        );
        assert_eq!(tets("a.msh", &big), expected());
        for length in 30..little.len() - 30 {
            assert!(
                parse_tets(Path::new("a.msh"), &little[..length]).is_err(),
                "{version} {length}"
            );
        }
    }
}

#[test]
fn gmsh_faults_name_what_is_wrong() {
    let head = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
    let nodes = "$Nodes\n1 1 1 1\n3 1 0 1\n1\n0 0 0\n$EndNodes\n";
    let cases = [
        (
            "$MeshFormat\n4 0 8\n$EndMeshFormat\n".to_owned(),
            "line 2: version `4` is not supported; save it in version 4.1",
        ),
        (
            format!("{head}$Nodes\n1 9 1 9\n3 1 0 999999\n"),
            "the number of nodes is 999999, there is room",
        ),
        (
            format!("{head}{nodes}$Elements\n1 1 1 1\n3 1 4 1\n1 1 1 1 2\n$EndElements\n"),
            "tetrahedron 0 names node 2, which is not there",
        ),
        (
            format!("{head}{nodes}$Elements\n1 1 1 1\n3 1 11 1\n"),
            "line 12: a cell that is a tetrahedron of 10 nodes",
        ),
        (
            format!("{head}$Nodes\n1 2 1 1\n3 1 0 2\n1\n1\n0 0 0\n1 1 1\n$EndNodes\n"),
            "two nodes have the tag 1",
        ),
        (format!("{head}$Blob\n"), "$EndBlob is missing"),
        (
            format!("{head}{nodes}"),
            "holds 1 vertices but no tetrahedra",
        ),
    ];
    for (text, expected) in cases {
        let told = refusal("a.msh", text);
        assert!(told.contains(expected), "{expected}: {told}");
    }
}
