//! Solids: what other programs write, round trips, and refusals by name.

mod gmsh;
mod medit;
mod tetgen;
mod vtk;
mod vtu;
mod write;

use std::path::Path;

use msplines_common::mesh::tet::TetSoup;
use msplines_io::parse_tets;
use nalgebra::Point3;

pub(super) const POINTS: [[f64; 3]; 5] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.1, -2.5e-300, 1.0],
    [0.3, 0.3, -1.0],
];
pub(super) const CELLS: [[u32; 4]; 2] = [[0, 1, 2, 3], [0, 2, 1, 4]];

pub(super) fn expected() -> TetSoup {
    TetSoup::from_cells(POINTS.map(Point3::from).to_vec(), &CELLS)
}

pub(super) fn tets(name: &str, content: impl AsRef<[u8]>) -> TetSoup {
    parse_tets(Path::new(name), content.as_ref()).unwrap()
}

pub(super) fn refusal(name: &str, content: impl AsRef<[u8]>) -> String {
    parse_tets(Path::new(name), content.as_ref())
        .unwrap_err()
        .to_string()
}

pub(super) fn rows(numbers: &[[f64; 3]]) -> String {
    numbers
        .iter()
        .map(|p| format!("{:?} {:?} {:?}\n", p[0], p[1], p[2]))
        .collect()
}

#[test]
fn solids_and_surfaces_are_told_apart() {
    let told =
        msplines_io::parse_soup(Path::new("a.mesh"), b"MeshVersionFormatted 2\n").unwrap_err();
    assert!(
        told.to_string()
            .contains("a solid in place of a surface is not supported"),
        "{told}"
    );
    assert!(refusal("a.off", "OFF\n0 0 0\n").contains("a surface or another kind of file"));
    assert!(refusal("a.xyz", "1 2 3").contains("in no format of solids"));
    assert!(refusal("a.mesh", "").contains("is empty"));
}
