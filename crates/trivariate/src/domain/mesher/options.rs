//! What can be chosen about a mesh of a solid.

use msplines_common::mesh::TriangleMesh;
use serde::{Deserialize, Serialize};

use super::error::MesherError;

/// Options of [`fill`](super::fill).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MesherOptions {
    /// Distance of lattice points in the first attempt.
    pub spacing: Spacing,
    /// Most lattices tried, each finer than the one before: by 1.5, 2, 3, 4, 6, 8 times in all.
    pub attempts: u32,
    /// What the boundary must be.
    pub wanted: Wanted,
    /// What happens where the surface passes through itself.
    pub crossings: Crossings,
    /// What happens if the solid falls apart.
    pub parts: Parts,
    /// Farthest that a point of the surface may lie from the boundary, in lattice spacings: what is
    /// farther is a part that was lost.
    pub farthest: f64,
}

/// How long lattice edges are.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Spacing {
    /// So many along the diagonal of the surface's box.
    AlongDiagonal(f64),
    /// This long, in the units of the surface.
    Length(f64),
    /// So that the solid takes about so many tetrahedra: thin solids get a finer lattice than compact
    /// ones.
    Cells(u32),
}

/// What the boundary of the solid must be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Wanted {
    /// One sphere, as a map to a cube needs; so must be the surface.
    #[default]
    Sphere,
    /// Of the same Euler characteristic as the surface.
    LikeInput,
    /// Any surface.
    Anything,
}

/// What happens where the surface passes through itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Crossings {
    /// It is refused.
    #[default]
    Refused,
    /// What it winds around at least once is inside.
    United,
}

/// What happens if the solid is in several parts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Parts {
    /// A finer lattice is tried, unless the boundary may be anything.
    #[default]
    All,
    /// The one of most tetrahedra is kept.
    Largest,
}

/// How much finer each attempt is than the first.
const LADDER: [f64; 7] = [1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0];

impl Default for MesherOptions {
    fn default() -> Self {
        Self {
            spacing: Spacing::Cells(60_000),
            attempts: 4,
            wanted: Wanted::default(),
            crossings: Crossings::default(),
            parts: Parts::default(),
            farthest: 1.5,
        }
    }
}

impl MesherOptions {
    pub(super) fn check(&self) -> Result<(), MesherError> {
        let (name, value) = match self.spacing {
            Spacing::AlongDiagonal(count) => ("along_diagonal", count),
            Spacing::Length(length) => ("length", length),
            Spacing::Cells(cells) => ("cells", cells.into()),
        };
        for (name, value) in [(name, value), ("farthest", self.farthest)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(MesherError::Number {
                    name,
                    value,
                    range: "above 0",
                });
            }
        }
        if !(1..=LADDER.len() as u32).contains(&self.attempts) {
            return Err(MesherError::Number {
                name: "attempts",
                value: self.attempts.into(),
                range: "from 1 to 7",
            });
        }
        Ok(())
    }

    /// Returns the lattice spacing of each attempt.
    pub(super) fn spacings(&self, surface: &TriangleMesh) -> Vec<f64> {
        let first = match self.spacing {
            Spacing::AlongDiagonal(count) => surface.diagonal() / count,
            Spacing::Length(length) => length,
            // A cube of the lattice holds as much as twelve tetrahedra.
            Spacing::Cells(cells) => (12.0 * volume(surface) / f64::from(cells)).cbrt(),
        };
        let finer = LADDER.iter().take(self.attempts as usize);
        finer.map(|factor| first / factor).collect()
    }
}

/// Returns the volume that a closed surface encloses, without its sign.
#[must_use]
pub fn volume(surface: &TriangleMesh) -> f64 {
    let [low, high] = surface.bounding_box();
    let centre = nalgebra::center(&low, &high);
    let sixth = |face: u32| {
        let [a, b, c] = surface.triangle(face).map(|p| p - centre);
        a.dot(&b.cross(&c))
    };
    let sum: f64 = (0..surface.face_count() as u32).map(sixth).sum();
    sum.abs() / 6.0
}
