//! Conformal atlases as JSON files that hold exactly what is needed to use them again.
//!
//! Numbers are written with the shortest digits that read back to the same bits.

use std::io::Write;

use msplines_conformal::{AtlasReport, Structure, SurfaceAtlas};
use serde::{Deserialize, Serialize};

use crate::generated::mesh_digest;
use crate::spline_file::StoredMesh;

/// The schema of [`AtlasFile`].
pub const ATLAS_SCHEMA: &str = "msplines.atlas/1";

/// An atlas file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AtlasFile {
    /// Always [`ATLAS_SCHEMA`].
    pub schema: String,
    /// SHA-256 of the input file, or of the generated mesh.
    pub input_sha256: String,
    /// All options.
    pub options: serde_json::Value,
    /// The mesh of the atlas: edges may be flipped against the input, vertices added and stars removed.
    pub mesh: StoredMesh,
    /// SHA-256 of its positions and faces, as little-endian bytes.
    pub mesh_sha256: String,
    /// Vertex of the input that each of its vertices is; null for added ones.
    pub origins: Vec<Option<u32>>,
    /// The vector along half-edge `3 f + i`, from corner `i` of face `f` to the next, in the plane.
    pub form: Vec<[f64; 2]>,
    /// Zeros, and the pole of a sphere.
    pub zeros: Vec<StoredZero>,
    /// What the surface is laid out by.
    pub structure: StoredStructure,
    /// Figures about it.
    pub report: AtlasReport,
}

/// A zero of the form, or its pole.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredZero {
    /// Its order: 1 for a simple zero, -2 for the double pole of a sphere.
    pub order: i32,
    /// Vertices that it lies between.
    pub vertices: Vec<u32>,
    /// Faces around these: the hole of the affine atlas.
    pub faces: Vec<u32>,
}

/// What a surface is laid out by.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum StoredStructure {
    /// A holomorphic form.
    Closed,
    /// The stereographic image of a sphere.
    Sphere {
        /// The vertex at infinity.
        pole: u32,
    },
    /// A flattened disk.
    Disk,
    /// A harmonic function with constant levels on the boundary loops, and its conjugate.
    Bounded {
        /// The level of each loop.
        levels: Vec<f64>,
    },
    /// The structure of the surface with cones over its holes.
    Filled {
        /// Number of cones.
        cones: usize,
    },
}

impl AtlasFile {
    /// Returns the file of the atlas of an input with this digest.
    #[must_use]
    pub fn new(input_sha256: String, options: serde_json::Value, found: &SurfaceAtlas) -> Self {
        let atlas = &found.atlas;
        let zeros = atlas.zeros().iter().map(|zero| StoredZero {
            order: zero.order,
            vertices: zero.vertices.clone(),
            faces: zero.faces.clone(),
        });
        Self {
            schema: ATLAS_SCHEMA.to_owned(),
            input_sha256,
            options,
            mesh: StoredMesh::of(atlas.mesh()),
            mesh_sha256: mesh_digest(atlas.mesh()),
            origins: found.origins.clone(),
            form: atlas.form().to_vec(),
            zeros: zeros.collect(),
            structure: match &found.structure {
                Structure::Closed { .. } => StoredStructure::Closed,
                Structure::Sphere { pole } => StoredStructure::Sphere { pole: *pole },
                Structure::Disk => StoredStructure::Disk,
                Structure::Bounded { levels } => StoredStructure::Bounded {
                    levels: levels.clone(),
                },
                Structure::Filled { cones } => StoredStructure::Filled { cones: *cones },
            },
            report: found.report.clone(),
        }
    }

    /// Writes the atlas as JSON.
    ///
    /// # Errors
    /// What the writer reports.
    pub fn write(&self, out: &mut dyn Write) -> std::io::Result<()> {
        serde_json::to_writer(&mut *out, self)?;
        out.write_all(b"\n")
    }
}

#[cfg(test)]
mod tests {
    use msplines_common::mesh::shapes;
    use msplines_common::progress::unobserved;
    use msplines_conformal::{Atlas, AtlasOptions};

    use super::*;

    #[test]
    fn an_atlas_round_trips_to_the_same_bits() {
        for mesh in [
            shapes::torus(1.0, 0.4, 300),
            shapes::sphere(300),
            shapes::vase(300),
        ] {
            let found = Atlas::of_surface(&mesh, &AtlasOptions::default(), &mut unobserved())
                .expect("an atlas");
            let file = AtlasFile::new("ab".repeat(32), serde_json::json!({}), &found);
            let mut bytes = Vec::new();
            file.write(&mut bytes).expect("memory takes all bytes");
            let read: AtlasFile = serde_json::from_slice(&bytes).expect("it reads back");
            assert_eq!(read, file);
            assert_eq!(read.form.len(), 3 * read.mesh.faces.len());
            let bits = |file: &AtlasFile| -> Vec<u64> {
                file.form
                    .as_flattened()
                    .iter()
                    .map(|x| x.to_bits())
                    .collect()
            };
            assert_eq!(bits(&read), bits(&file));
            let restored = read.mesh.restore().expect("a mesh");
            assert_eq!(mesh_digest(&restored), read.mesh_sha256);
        }
    }
}
