//! Solids made from names.

use std::fmt;
use std::str::FromStr;

use msplines_common::mesh::shapes;
use msplines_common::mesh::tet::TetMesh;
use serde::{Deserialize, Serialize};

/// Most unit cubes of a generated box.
const MOST_CUBES: u64 = 200_000;

/// A solid of tetrahedra made from a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub enum SolidShape {
    /// A box of so many unit cubes along each axis, six tetrahedra each: `box-4x3x2`.
    Box([u32; 3]),
}

impl SolidShape {
    /// Returns the tetrahedra.
    #[must_use]
    pub fn mesh(self) -> TetMesh {
        match self {
            Self::Box(counts) => shapes::box_solid(counts),
        }
    }
}

impl fmt::Display for SolidShape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self::Box([x, y, z]) = self;
        write!(f, "box-{x}x{y}x{z}")
    }
}

impl From<SolidShape> for String {
    fn from(shape: SolidShape) -> Self {
        shape.to_string()
    }
}

impl TryFrom<String> for SolidShape {
    type Error = UnknownSolid;

    fn try_from(name: String) -> Result<Self, UnknownSolid> {
        name.parse()
    }
}

impl FromStr for SolidShape {
    type Err = UnknownSolid;

    fn from_str(name: &str) -> Result<Self, UnknownSolid> {
        let counts = name.strip_prefix("box-").map(|counts| {
            let numbers = counts.split('x').map(|n| n.parse().unwrap_or(0));
            numbers.collect::<Vec<u32>>()
        });
        let counts = counts.and_then(|counts| <[u32; 3]>::try_from(counts).ok());
        let cubes = |counts: &[u32; 3]| {
            let sides = counts.iter().map(|&n| u64::from(n));
            sides.fold(1, u64::saturating_mul)
        };
        let sized = counts.filter(|counts| (1..=MOST_CUBES).contains(&cubes(counts)));
        sized.map(Self::Box).ok_or_else(|| UnknownSolid {
            name: name.to_owned(),
        })
    }
}

/// No solid of this name can be generated.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "no solid `{name}`; there are boxes of unit cubes, such as box-4x3x2, of at most {MOST_CUBES} cubes"
)]
pub struct UnknownSolid {
    /// The name.
    pub name: String,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_are_named_by_their_counts() {
        let shape: SolidShape = "box-4x3x2".parse().expect("a box");
        assert_eq!(shape, SolidShape::Box([4, 3, 2]));
        assert_eq!(shape.to_string(), "box-4x3x2");
        assert_eq!(shape.mesh().cell_count(), 6 * 24);
        for bad in [
            "box",
            "box-4x3",
            "box-4x3x0",
            "box-4x3xz",
            "box-9999x9999x9999",
            "ball",
        ] {
            assert!(bad.parse::<SolidShape>().is_err(), "{bad}");
        }
    }
}
