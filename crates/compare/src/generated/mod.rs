//! Surfaces and data made from formulas, so that everything runs without a single model file.

mod chart;
mod colours;
mod control;
mod network;
mod planar;
mod solid;

use std::fmt;
use std::str::FromStr;

use msplines_common::mesh::{TriangleMesh, decimate, shapes};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::input::hexadecimal;

pub use chart::{ChartFunction, UnknownFunction};
pub(crate) use chart::{Height, Sampled, grid};
pub use colours::{colour_image, colour_pattern};
pub use control::{ControlShape, UnknownShape};
pub use network::{NetworkShape, UnknownNetwork};
pub use solid::{SolidShape, UnknownSolid};

/// About how many vertices each surface has.
const VERTICES: usize = 20_000;

/// A surface made from a formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GeneratedSurface {
    /// A sphere with bumps, genus 0.
    BumpySphere,
    /// The same with about 5,000 vertices.
    #[serde(rename = "bumpy-sphere-5k")]
    BumpySphere5k,
    /// The same with about 500 vertices.
    #[serde(rename = "bumpy-sphere-500")]
    BumpySphere500,
    /// The same with about 100,000 vertices.
    #[serde(rename = "bumpy-sphere-100k")]
    BumpySphere100k,
    /// The same with about 1,000,000 vertices.
    #[serde(rename = "bumpy-sphere-1m")]
    BumpySphere1m,
    /// The same with 8,000 vertices of an irregular mesh.
    BumpySphereIrregular,
    /// A torus of about 5,000 vertices, its tube two fifths of its ring.
    Torus,
    /// A tube around a torus knot, genus 1.
    TorusKnot,
    /// A surface with two handles.
    Genus2,
    /// A surface with three handles.
    Genus3,
    /// A surface with eight handles.
    Genus8,
    /// A unit sphere of about 5,000 vertices.
    Sphere,
    /// A fluted vase, open at both ends, of about 5,000 vertices.
    Vase,
    /// The lower half of a unit sphere, of about 5,000 vertices.
    Bowl,
    /// A pair of pants over an ellipse, of about 5,000 vertices: three boundary loops.
    Pants,
    /// A torus without a disk, of about 5,000 vertices: genus 1, one boundary loop.
    HoledTorus,
    /// A hexagonal nut with a collar, about 8,000 vertices: sharp edges and corners.
    Nut,
    /// A torus of about 500 vertices.
    #[serde(rename = "torus-500")]
    Torus500,
    /// A surface with two handles of about 2,000 vertices.
    #[serde(rename = "genus-2-2k")]
    Genus2Coarse,
    /// A surface with two handles of about 500 vertices.
    #[serde(rename = "genus-2-500")]
    Genus2Small,
    /// A flat plate of a dozen vertices, triangulated after Delaunay.
    Plate,
    /// A hill over a rectangle, 48 vertices triangulated after Delaunay.
    Hill,
}

impl GeneratedSurface {
    /// All of them.
    pub const ALL: [Self; 22] = [
        Self::BumpySphere,
        Self::BumpySphere5k,
        Self::BumpySphere500,
        Self::BumpySphereIrregular,
        Self::TorusKnot,
        Self::Genus2,
        Self::Genus3,
        Self::Genus8,
        Self::Sphere,
        Self::Vase,
        Self::Nut,
        Self::BumpySphere100k,
        Self::BumpySphere1m,
        Self::Torus,
        Self::Torus500,
        Self::Genus2Coarse,
        Self::Genus2Small,
        Self::Plate,
        Self::Hill,
        Self::Bowl,
        Self::Pants,
        Self::HoledTorus,
    ];

    /// Returns the name in experiments and records.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::BumpySphere => "bumpy-sphere",
            Self::BumpySphere5k => "bumpy-sphere-5k",
            Self::BumpySphere500 => "bumpy-sphere-500",
            Self::BumpySphere100k => "bumpy-sphere-100k",
            Self::BumpySphere1m => "bumpy-sphere-1m",
            Self::BumpySphereIrregular => "bumpy-sphere-irregular",
            Self::Torus => "torus",
            Self::TorusKnot => "torus-knot",
            Self::Genus2 => "genus-2",
            Self::Genus3 => "genus-3",
            Self::Genus8 => "genus-8",
            Self::Sphere => "sphere",
            Self::Vase => "vase",
            Self::Bowl => "bowl",
            Self::Pants => "pants",
            Self::HoledTorus => "holed-torus",
            Self::Nut => "nut",
            Self::Torus500 => "torus-500",
            Self::Genus2Coarse => "genus-2-2k",
            Self::Genus2Small => "genus-2-500",
            Self::Plate => "plate",
            Self::Hill => "hill",
        }
    }

    /// Returns the mesh.
    #[must_use]
    pub fn mesh(self) -> TriangleMesh {
        match self {
            Self::BumpySphere => shapes::bumpy_sphere(VERTICES),
            Self::BumpySphere5k => shapes::bumpy_sphere(5_000),
            Self::BumpySphere500 => shapes::bumpy_sphere(500),
            Self::BumpySphere100k => shapes::bumpy_sphere(100_000),
            Self::BumpySphere1m => shapes::bumpy_sphere(1_000_000),
            Self::BumpySphereIrregular => irregular(&shapes::bumpy_sphere(2 * VERTICES), 8_000),
            Self::Torus => shapes::torus(1.0, 0.4, 5_000),
            Self::TorusKnot => shapes::torus_knot(2, 3, VERTICES),
            Self::Genus2 => shapes::genus(2, VERTICES),
            Self::Genus3 => shapes::genus(3, VERTICES),
            Self::Genus8 => shapes::genus(8, VERTICES),
            Self::Sphere => shapes::sphere(5_000),
            Self::Vase => shapes::vase(5_000),
            Self::Bowl => shapes::bowl(5_000),
            Self::Pants => shapes::pants(5_000),
            Self::HoledTorus => shapes::holed_torus(5_000),
            Self::Nut => shapes::nut(8_000),
            Self::Torus500 => shapes::torus(1.0, 0.4, 500),
            Self::Genus2Coarse => shapes::genus(2, 2_500),
            Self::Genus2Small => shapes::genus(2, 600),
            Self::Plate => planar::plate(),
            Self::Hill => planar::hill(),
        }
    }
}

/// Returns a mesh of fewer vertices that follows curvature instead of a pattern.
fn irregular(mesh: &TriangleMesh, vertices: usize) -> TriangleMesh {
    // A closed surface can always be decimated to so many vertices; the pattern would stay else.
    decimate(mesh, vertices).map_or_else(|_| mesh.clone(), |decimated| decimated.mesh)
}

impl fmt::Display for GeneratedSurface {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for GeneratedSurface {
    type Err = UnknownSurface;

    fn from_str(name: &str) -> Result<Self, UnknownSurface> {
        let found = Self::ALL.into_iter().find(|surface| surface.name() == name);
        found.ok_or_else(|| UnknownSurface {
            name: name.to_owned(),
        })
    }
}

/// No surface of this name can be generated.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "no surface `{name}`; there are bumpy-sphere (also -500, -5k, -100k, -1m, -irregular), torus (also -500), torus-knot, genus-2 (also -2k, -500), genus-3, genus-8, sphere, vase, bowl, pants, holed-torus, nut, plate and hill"
)]
pub struct UnknownSurface {
    /// The name.
    pub name: String,
}

/// Returns the SHA-256 of the positions and faces of a mesh, as little-endian bytes.
#[must_use]
pub fn mesh_digest(mesh: &TriangleMesh) -> String {
    let mut digest = Sha256::new();
    for position in mesh.positions() {
        position.iter().for_each(|x| digest.update(x.to_le_bytes()));
    }
    for face in mesh.faces() {
        face.iter().for_each(|v| digest.update(v.to_le_bytes()));
    }
    hexadecimal(&digest.finalize())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn generated_surfaces_have_the_genus_of_their_names() {
        let genera = [0, 0, 0, 0, 1, 2, 3, 8];
        for (surface, genus) in GeneratedSurface::ALL.into_iter().zip(genera) {
            let mesh = surface.mesh();
            assert!(mesh.topology().boundary_loops().is_empty());
            assert_eq!(
                mesh.topology().euler_characteristic(),
                2 - 2 * genus,
                "{surface}"
            );
            assert_eq!(surface.name().parse(), Ok(surface));
        }
        assert!("genus-9".parse::<GeneratedSurface>().is_err());
    }

    #[test]
    fn generated_surfaces_are_the_same_every_time() {
        let mesh = GeneratedSurface::BumpySphere.mesh();
        assert_eq!(
            mesh_digest(&mesh),
            mesh_digest(&GeneratedSurface::BumpySphere.mesh())
        );
    }
}
