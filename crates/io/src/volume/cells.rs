//! Which cells are tetrahedra, which may be left out, and which are refused.

use crate::error::{Fault, Place};

/// What to do with a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A tetrahedron of four corners.
    Tetrahedron,
    /// A point, curve or surface: left out.
    Lower,
    /// Another solid cell, by name.
    Other(&'static str),
}

/// Returns the refusal of a solid cell that is no tetrahedron.
pub(super) fn refuse(place: Place, name: &str) -> Fault {
    Fault::Unsupported {
        place,
        feature: format!("a cell that is a {name}"),
        remedy: "split all cells into tetrahedra of four corners first",
    }
}

/// Returns what to do with a cell of one of VTK's types; `None` if there is no such type.
pub(super) fn vtk_kind(number: u64) -> Option<Kind> {
    Some(match number {
        10 => Kind::Tetrahedron,
        0..=9 | 21..=23 | 28 | 30 | 34..=36 | 51 | 52 | 54..=56 | 60..=63 | 68..=70 | 75..=77 => {
            Kind::Lower
        }
        11 => Kind::Other("voxel"),
        12 => Kind::Other("hexahedron"),
        13 => Kind::Other("wedge"),
        14 => Kind::Other("pyramid"),
        15 => Kind::Other("pentagonal prism"),
        16 => Kind::Other("hexagonal prism"),
        24 | 64 | 71 | 78 => Kind::Other("tetrahedron of higher order"),
        25 | 29 | 33 | 67 | 72 | 79 => Kind::Other("hexahedron of higher order"),
        26 | 31 | 32 | 65 | 73 | 80 => Kind::Other("wedge of higher order"),
        27 | 37 | 66 | 74 | 81 => Kind::Other("pyramid of higher order"),
        42 => Kind::Other("polyhedron"),
        _ => return None,
    })
}

/// Returns what to do with a cell of one of Gmsh's types and its number of nodes; `None` if there is
/// no such type, or it is not known here.
pub(super) fn gmsh_kind(number: u64) -> Option<(Kind, usize)> {
    Some(match number {
        4 => (Kind::Tetrahedron, 4),
        1 => (Kind::Lower, 2),
        2 => (Kind::Lower, 3),
        3 => (Kind::Lower, 4),
        8 => (Kind::Lower, 3),
        9 => (Kind::Lower, 6),
        10 => (Kind::Lower, 9),
        15 => (Kind::Lower, 1),
        16 => (Kind::Lower, 8),
        20 => (Kind::Lower, 9),
        21 => (Kind::Lower, 10),
        22 => (Kind::Lower, 12),
        23 | 24 => (Kind::Lower, 15),
        25 => (Kind::Lower, 21),
        26 => (Kind::Lower, 4),
        27 => (Kind::Lower, 5),
        28 => (Kind::Lower, 6),
        5 => (Kind::Other("hexahedron"), 8),
        6 => (Kind::Other("prism"), 6),
        7 => (Kind::Other("pyramid"), 5),
        11 => (Kind::Other("tetrahedron of 10 nodes"), 10),
        12 => (Kind::Other("hexahedron of 27 nodes"), 27),
        13 => (Kind::Other("prism of 18 nodes"), 18),
        14 => (Kind::Other("pyramid of 14 nodes"), 14),
        17 => (Kind::Other("hexahedron of 20 nodes"), 20),
        18 => (Kind::Other("prism of 15 nodes"), 15),
        19 => (Kind::Other("pyramid of 13 nodes"), 13),
        29 => (Kind::Other("tetrahedron of 20 nodes"), 20),
        30 => (Kind::Other("tetrahedron of 35 nodes"), 35),
        31 => (Kind::Other("tetrahedron of 56 nodes"), 56),
        _ => return None,
    })
}
