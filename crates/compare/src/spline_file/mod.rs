//! Splines as JSON files that hold exactly what is needed to evaluate them again.
//!
//! Numbers are written with the shortest digits that read back to the same bits, so a spline
//! loses nothing in a file. Knots and control vertices are listed, so that anyone can count them.

mod biharmonic;
mod chart;
mod manifold;
mod mesh;
mod stored;
mod t_spline;
mod trivariate;

use std::io::Write;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::error::SplineFileError;

pub use biharmonic::StoredBiharmonic;
pub use chart::StoredLocal;
pub use manifold::{StoredChart, StoredManifold, StoredPolygons};
pub use mesh::StoredMesh;
pub use stored::StoredSpline;
pub use t_spline::{Bytes, FaceRun, StoredForm, StoredLayout, StoredLevel, StoredTSpline, Vectors};
pub use trivariate::{StoredCube, StoredTrivariate};

/// The schema of [`SplineFile`].
pub const SPLINE_SCHEMA: &str = "msplines.spline/2";
/// The one before, in which only T-splines were other: it is read too.
const FIRST_SCHEMA: &str = "msplines.spline/1";

/// Largest number in a file: errors are squared, and a million squares add up to a finite sum.
pub(crate) const LARGEST: f64 = 1e150;

/// A spline file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SplineFile {
    /// Always [`SPLINE_SCHEMA`].
    pub schema: String,
    /// The mesh under the spline.
    pub domain: StoredDomain,
    /// All options of the fit.
    pub options: serde_json::Value,
    /// The method and its numbers.
    #[serde(flatten)]
    pub spline: StoredSpline,
}

/// The domain of a stored spline.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "the domain has neither `sha256` with `repair`, nor a whole `mesh`, `polygons` or `cube` of finite numbers"
)]
pub enum StoredDomain {
    /// The mesh file with this digest.
    Digest {
        /// SHA-256 of the mesh file.
        sha256: String,
        /// Whether its defects are mended when it is read.
        repair: bool,
    },
    /// The mesh itself.
    Embedded {
        /// Positions and faces.
        mesh: StoredMesh,
    },
    /// A mesh of polygons itself.
    Polygons {
        /// Positions and faces.
        polygons: StoredPolygons,
    },
    /// The unit cube.
    Cube {
        /// What was mapped to it.
        cube: StoredCube,
    },
}

impl SplineFile {
    /// Returns the file of a spline.
    #[must_use]
    pub fn new(domain: StoredDomain, options: serde_json::Value, spline: StoredSpline) -> Self {
        Self {
            schema: SPLINE_SCHEMA.to_owned(),
            domain,
            options,
            spline,
        }
    }

    /// Reads a spline file.
    ///
    /// # Errors
    /// A file that cannot be read or is not a spline of this schema.
    pub fn read(path: &Path) -> Result<Self, SplineFileError> {
        let bytes = std::fs::read(path).map_err(|source| SplineFileError::Unreadable {
            path: path.to_owned(),
            source,
        })?;
        Self::parse(&bytes)
    }

    /// Reads a spline from the bytes of its file.
    ///
    /// # Errors
    /// Bytes that are not a spline of this schema.
    pub fn parse(bytes: &[u8]) -> Result<Self, SplineFileError> {
        #[derive(Deserialize)]
        struct Header {
            schema: String,
            method: Option<String>,
        }
        // The header first: "another schema" says more than the first field that differs.
        let header: Header = serde_json::from_slice(bytes)?;
        let first = header.schema == FIRST_SCHEMA;
        if header.schema != SPLINE_SCHEMA && !first {
            return Err(SplineFileError::WrongSchema {
                found: header.schema,
            });
        }
        if first && header.method.as_deref() == Some("t-spline") {
            let file: t_spline::FirstTSpline = serde_json::from_slice(bytes)?;
            let (domain, options, spline) = file.upgraded();
            return Ok(Self::new(domain, options, spline));
        }
        let read: Self = serde_json::from_slice(bytes)?;
        Ok(Self {
            schema: SPLINE_SCHEMA.to_owned(),
            ..read
        })
    }

    /// Writes the spline as JSON.
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
    use msplines_biharmonic::Laplacian;
    use proptest::prelude::*;

    use super::*;

    fn tetrahedron() -> StoredMesh {
        StoredMesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            faces: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
        }
    }

    fn file(coefficients: Vec<f64>) -> SplineFile {
        let spline = StoredSpline::Biharmonic(StoredBiharmonic {
            dimension: 1,
            laplacian: Laplacian::Cotangent,
            added_points: Vec::new(),
            creases: Vec::new(),
            knots: vec![0, 2],
            coefficients: Some(coefficients),
            constant: Some(vec![0.1]),
            knot_values: None,
        });
        let domain = StoredDomain::Embedded {
            mesh: tetrahedron(),
        };
        SplineFile::new(domain, serde_json::json!({}), spline)
    }

    fn bytes(file: &SplineFile) -> Vec<u8> {
        let mut bytes = Vec::new();
        file.write(&mut bytes).expect("memory takes all bytes");
        bytes
    }

    proptest! {
        #[test]
        fn numbers_round_trip_to_the_same_bits(
            a in any::<f64>().prop_filter("finite", |x| x.is_finite()),
            b in any::<f64>().prop_filter("finite", |x| x.is_finite()),
        ) {
            let read = SplineFile::parse(&bytes(&file(vec![a, b]))).expect("it reads back");
            let StoredSpline::Biharmonic(stored) = read.spline else {
                panic!("another method");
            };
            let coefficients = stored.coefficients.expect("a smooth spline");
            prop_assert_eq!(coefficients[0].to_bits(), a.to_bits());
            prop_assert_eq!(coefficients[1].to_bits(), b.to_bits());
        }
    }

    #[test]
    fn both_kinds_of_domain_are_told_apart() {
        let mut file = file(vec![1.0, -1.0]);
        assert_eq!(SplineFile::parse(&bytes(&file)).expect("embedded"), file);
        file.domain = StoredDomain::Digest {
            sha256: "ab".repeat(32),
            repair: true,
        };
        assert_eq!(SplineFile::parse(&bytes(&file)).expect("digest"), file);
    }

    #[test]
    fn method_and_data_stand_beside_the_schema() {
        let value: serde_json::Value =
            serde_json::from_slice(&bytes(&file(vec![1.0, -1.0]))).expect("json");
        assert_eq!(value["schema"], SPLINE_SCHEMA);
        assert_eq!(value["method"], "biharmonic");
        assert_eq!(value["data"]["knots"], serde_json::json!([0, 2]));
        assert_eq!(
            value["domain"]["mesh"]["faces"][0],
            serde_json::json!([0, 2, 1])
        );
    }

    #[test]
    fn what_does_not_fit_is_refused_with_its_place() {
        let mesh = tetrahedron().restore().expect("a tetrahedron");
        let message = |spline: &StoredSpline| match spline.evaluate(&mesh, 0) {
            Ok(_) => panic!("must be refused"),
            Err(error) => error.to_string(),
        };
        let mut stored = file(vec![1.0]).spline;
        assert_eq!(
            message(&stored),
            "the spline file lists 2 knots of 1 components but 1 values; it is damaged, fit again"
        );
        if let StoredSpline::Biharmonic(spline) = &mut stored {
            spline.coefficients = Some(vec![1.0, 2.0]);
            spline.knots[1] = 4;
        }
        assert_eq!(
            message(&stored),
            "the spline file names vertex 4, but its domain has 4 vertices; give the mesh that \
             was fitted"
        );
        let mut mesh = tetrahedron();
        mesh.positions[2][1] = f64::NAN;
        assert!(mesh.restore().is_err());
        // Back to back they are a closed manifold, which subdivision would not take.
        let pillow = StoredMesh {
            positions: tetrahedron().positions[..3].to_vec(),
            faces: vec![[0, 1, 2], [2, 1, 0]],
        };
        let message = pillow.restore().expect_err("refused").to_string();
        assert!(message.contains("faces 0 and 1 of the mesh"), "{message}");
    }

    #[test]
    fn another_schema_is_named() {
        let error = SplineFile::parse(b"{\"schema\": \"msplines.run/1\"}").expect_err("refused");
        assert_eq!(
            error.to_string(),
            "this is `msplines.run/1`, not `msplines.spline/2`; give a file that `msplines fit -o \
             FILE.json` wrote"
        );
        assert!(SplineFile::parse(b"not json").is_err());
    }

    #[test]
    fn files_of_the_first_schema_are_read() {
        let given = file(vec![1.0, -1.0]);
        let text = String::from_utf8(bytes(&given)).expect("text");
        let first = text.replacen(SPLINE_SCHEMA, FIRST_SCHEMA, 1);
        assert_eq!(
            SplineFile::parse(first.as_bytes()).expect("it reads"),
            given
        );
    }
}
