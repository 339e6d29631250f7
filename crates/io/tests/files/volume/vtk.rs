//! VTK's legacy files.

use std::path::Path;

use msplines_io::parse_tets;

use super::{POINTS, expected, refusal, rows, tets};

fn vtk_text(cells: &str) -> String {
    format!(
        "# vtk DataFile Version 5.1\ntitle with OFF and solid\nASCII\nDATASET UNSTRUCTURED_GRID\n\
         FIELD FieldData 1\nTIME 1 1 double\n0.5\nPOINTS 5 double\n{}METADATA\nINFORMATION 0\n\n{cells}\
         POINT_DATA 5\nSCALARS a float 1\n",
        rows(&POINTS)
    )
}

#[test]
fn vtk_text_and_binary_of_old_and_new_versions_are_read() {
    let old = vtk_text("CELLS 3 14\n3 0 1 2\n4 0 1 2 3\n4 0 2 1 4\nCELL_TYPES 3\n5\n10\n10\n");
    assert_eq!(tets("a.vtk", old), expected());
    let new = vtk_text(
        "CELLS 3 8\nOFFSETS vtktypeint64\n0 4 8\nCONNECTIVITY vtktypeint64\n0 1 2 3 0 2 1 4\nCELL_TYPES 2\n10 10\n",
    );
    assert_eq!(tets("any.name", new), expected());
    let mut binary =
        b"# vtk DataFile Version 4.2\nt\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n"
            .to_vec();
    binary.extend(POINTS.iter().flatten().flat_map(|x| x.to_be_bytes()));
    binary.extend(b"\nCELLS 2 10\n");
    binary.extend(
        [4i32, 0, 1, 2, 3, 4, 0, 2, 1, 4]
            .iter()
            .flat_map(|x| x.to_be_bytes()),
    );
    binary.extend(b"\nCELL_TYPES 2\n");
    binary.extend([10i32, 10].iter().flat_map(|x| x.to_be_bytes()));
    assert_eq!(tets("a.vtk", &binary), expected());
    for length in 30..binary.len() {
        assert!(parse_tets(Path::new("a.vtk"), &binary[..length]).is_err());
    }
}

#[test]
fn vtk_faults_name_what_is_wrong() {
    let cases = [
        (
            vtk_text("CELLS 1 5\n8 0 1 2 3\nCELL_TYPES 1\n10\n"),
            "the list of cells ends within cell 0",
        ),
        (
            vtk_text("CELLS 1 9\n8 0 1 2 3 4 0 1 2\nCELL_TYPES 1\n12\n"),
            "cell 0 (line",
        ),
        (
            vtk_text("CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n99\n"),
            "cell 0 is of unknown type 99",
        ),
        (
            vtk_text("CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n10\n"),
            "tetrahedron 0 has 3 vertices",
        ),
        (
            vtk_text("CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 2\n10 10\n"),
            "2 types are given for 1 cells",
        ),
        (vtk_text("CELLS 1 99999999\n"), "is 99999999, there is room"),
        (
            "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\n".to_owned(),
            "the data set `POLYDATA`",
        ),
    ];
    for (text, expected) in cases {
        let told = refusal("a.vtk", text);
        assert!(told.contains(expected), "{expected}: {told}");
    }
}
