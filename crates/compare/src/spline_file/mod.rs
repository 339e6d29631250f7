//! Splines as JSON files that hold exactly what is needed to evaluate them again.
//!
//! Numbers are written with the shortest digits that read back to the same bits, so a spline
//! loses nothing in a file. Knots and control vertices are listed, so that anyone can count them.

mod biharmonic;
mod chart;
mod manifold;
mod mesh;
mod t_spline;
mod trivariate;

use std::io::Write;
use std::path::Path;
use std::sync::Arc;

use msplines_biharmonic::{Scheme, Space};
use msplines_common::Point3;
use msplines_common::mesh::TriangleMesh;
use msplines_ls_mesh::{Constraints, LsMesh};
use msplines_powell_sabin::PowellSabinSurface;
use msplines_powell_sabin::surface::SurfaceParts;
use msplines_t_spline::TSplineSurface;
use serde::{Deserialize, Serialize};

use crate::error::{RunError, SplineFileError};

pub use biharmonic::StoredBiharmonic;
pub use chart::StoredLocal;
pub use manifold::{StoredChart, StoredManifold, StoredPolygons};
pub use mesh::StoredMesh;
pub use t_spline::{Bytes, FaceRun, StoredForm, StoredLayout, StoredLevel, StoredTSpline, Vectors};
pub use trivariate::{StoredCube, StoredTrivariate};

/// The schema of [`SplineFile`].
pub const SPLINE_SCHEMA: &str = "msplines.spline/2";
/// The one before, in which only T-splines were other: it is read too.
const FIRST_SCHEMA: &str = "msplines.spline/1";

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
#[serde(untagged)]
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

/// The numbers of a spline, from which it is evaluated again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "method", content = "data", rename_all = "kebab-case")]
pub enum StoredSpline {
    /// A biharmonic B-spline.
    Biharmonic(StoredBiharmonic),
    /// Control vertices of a least-squares mesh.
    LsMesh {
        /// Components of a value.
        dimension: usize,
        /// Control vertices.
        controls: Vec<u32>,
        /// Value of each control vertex, `[control][component]`.
        control_values: Vec<f64>,
        /// How the control values bind.
        constraints: Constraints,
    },
    /// A sparse manifold.
    SparseManifold(StoredManifold),
    /// The function of a single chart.
    Chart(StoredLocal),
    /// A trivariate spline.
    Trivariate(StoredTrivariate),
    /// A Powell-Sabin spline over a surface.
    PowellSabin(Box<SurfaceParts>),
    /// A T-spline over a surface.
    TSpline(Box<StoredTSpline>),
}

impl StoredSpline {
    /// Returns the stored form of a least-squares mesh.
    #[must_use]
    pub fn of_ls_mesh(spline: &LsMesh, constraints: Constraints) -> Self {
        Self::LsMesh {
            dimension: spline.dimension(),
            controls: spline.controls().to_vec(),
            control_values: spline.control_values().to_vec(),
            constraints,
        }
    }

    /// Returns the biharmonic B-spline that this is.
    ///
    /// # Errors
    /// A spline of another method, which does not have the `task`.
    pub(crate) fn biharmonic(&self, task: &'static str) -> Result<&StoredBiharmonic, RunError> {
        match self {
            Self::Biharmonic(stored) => Ok(stored),
            _ => Err(self.without(task)),
        }
    }

    /// Returns the sparse manifold that this is.
    ///
    /// # Errors
    /// A spline of another method, which does not have the `task`.
    pub(crate) fn manifold(&self, task: &'static str) -> Result<&StoredManifold, RunError> {
        match self {
            Self::SparseManifold(stored) => Ok(stored),
            _ => Err(self.without(task)),
        }
    }

    /// Returns the trivariate spline that this is.
    ///
    /// # Errors
    /// A spline of another method, which does not have the `task`.
    pub(crate) fn trivariate(&self, task: &'static str) -> Result<&StoredTrivariate, RunError> {
        match self {
            Self::Trivariate(stored) => Ok(stored),
            _ => Err(self.without(task)),
        }
    }

    /// Returns the Powell-Sabin spline that this is, over its mesh.
    ///
    /// # Errors
    /// A spline of another method, or numbers that do not fit the mesh.
    pub(crate) fn powell_sabin(&self, mesh: &TriangleMesh) -> Result<PowellSabinSurface, RunError> {
        match self {
            Self::PowellSabin(parts) => {
                let surface = PowellSabinSurface::from_parts(mesh.clone(), parts);
                Ok(surface.map_err(SplineFileError::from)?)
            }
            _ => Err(self.without("Powell-Sabin surface")),
        }
    }

    /// Returns the T-spline that this is, over the mesh it was fitted to.
    ///
    /// # Errors
    /// A spline of another method, or numbers that do not fit the mesh.
    pub(crate) fn t_spline(&self, mesh: &TriangleMesh) -> Result<TSplineSurface, RunError> {
        match self {
            Self::TSpline(stored) => Ok(stored.restore(mesh)?),
            _ => Err(self.without("T-spline surface")),
        }
    }

    fn without(&self, task: &'static str) -> RunError {
        RunError::Task {
            task,
            method: self.method(),
        }
    }

    /// Returns the name of the method.
    #[must_use]
    pub fn method(&self) -> &'static str {
        match self {
            Self::Biharmonic(_) => "biharmonic",
            Self::LsMesh { .. } => "ls-mesh",
            Self::SparseManifold(_) => "sparse-manifold",
            Self::Chart(_) => "chart",
            Self::Trivariate(_) => "trivariate",
            Self::PowellSabin(_) => "powell-sabin",
            Self::TSpline(_) => "t-spline",
        }
    }

    /// Returns the number of components of a value.
    #[must_use]
    pub fn dimension(&self) -> usize {
        match self {
            Self::Biharmonic(spline) => spline.dimension,
            Self::LsMesh { dimension, .. } => *dimension,
            Self::SparseManifold(_)
            | Self::Trivariate(_)
            | Self::PowellSabin(_)
            | Self::TSpline(_) => 3,
            Self::Chart(_) => 1,
        }
    }

    /// Returns the vertices that are knots or control vertices.
    #[must_use]
    pub fn knots(&self) -> &[u32] {
        match self {
            Self::Biharmonic(spline) => &spline.knots,
            Self::LsMesh { controls, .. } => controls,
            Self::SparseManifold(_)
            | Self::Chart(_)
            | Self::Trivariate(_)
            | Self::PowellSabin(_)
            | Self::TSpline(_) => &[],
        }
    }

    /// Returns the places of the knots or control vertices on the domain `mesh`.
    ///
    /// # Panics
    /// If the spline belongs to another mesh.
    #[must_use]
    pub fn knot_places(&self, mesh: &TriangleMesh) -> Vec<Point3<f64>> {
        let added = match self {
            Self::Biharmonic(spline) => spline.added_points.as_slice(),
            Self::LsMesh { .. }
            | Self::SparseManifold(_)
            | Self::Chart(_)
            | Self::Trivariate(_)
            | Self::PowellSabin(_)
            | Self::TSpline(_) => &[],
        };
        let place = |&knot: &u32| match mesh.positions().get(knot as usize) {
            Some(vertex) => *vertex,
            None => mesh.position(added[knot as usize - mesh.vertex_count()]),
        };
        self.knots().iter().map(place).collect()
    }

    /// Returns the values at the vertices of `mesh`, or of its midpoint subdivision after `rounds`
    /// rounds, with the mesh they belong to.
    ///
    /// # Errors
    /// Numbers that do not fit the mesh, or a system that cannot be solved.
    pub fn evaluate(
        &self,
        mesh: &TriangleMesh,
        rounds: u32,
    ) -> Result<(TriangleMesh, Vec<f64>), SplineFileError> {
        self.evaluate_by(Scheme::Planar, mesh, rounds)
    }

    /// Returns what [`Self::evaluate`] does on the subdivision of another scheme, where it is not the
    /// spline.
    ///
    /// # Errors
    /// As [`Self::evaluate`].
    pub fn evaluate_by(
        &self,
        scheme: Scheme,
        mesh: &TriangleMesh,
        rounds: u32,
    ) -> Result<(TriangleMesh, Vec<f64>), SplineFileError> {
        self.evaluate_in(None, scheme, mesh, rounds)
    }

    /// The same in the space that a biharmonic spline was fitted in: what that has computed is not
    /// computed again.
    pub(crate) fn evaluate_in(
        &self,
        space: Option<&Arc<Space>>,
        scheme: Scheme,
        mesh: &TriangleMesh,
        rounds: u32,
    ) -> Result<(TriangleMesh, Vec<f64>), SplineFileError> {
        match self {
            Self::Biharmonic(stored) => {
                let spline = match space {
                    Some(space) => stored.restore_in(space)?,
                    None => stored.restore(mesh)?,
                };
                if rounds == 0 {
                    return Ok((mesh.clone(), spline.vertex_values()?));
                }
                Ok(spline.extension_by(scheme, rounds)?)
            }
            Self::SparseManifold(_) | Self::Chart(_) => Err(SplineFileError::Polygons),
            Self::Trivariate(_) => Err(SplineFileError::Cube),
            Self::PowellSabin(_) => Err(SplineFileError::SurfacePoints),
            Self::TSpline(_) => Err(SplineFileError::OwnTessellation),
            Self::LsMesh { .. } if rounds > 0 => Err(SplineFileError::VerticesOnly),
            Self::LsMesh {
                dimension,
                controls,
                control_values,
                constraints,
            } => {
                check_lengths(controls, *dimension, control_values, mesh.vertex_count())?;
                let spline = LsMesh::from_parts(
                    mesh,
                    *constraints,
                    *dimension,
                    controls.clone(),
                    control_values.clone(),
                )?;
                Ok((mesh.clone(), spline.vertex_values().to_vec()))
            }
        }
    }
}

/// Checks that there are values for every knot, and that the knots are vertices.
fn check_lengths(
    knots: &[u32],
    dimension: usize,
    values: &[f64],
    vertices: usize,
) -> Result<(), SplineFileError> {
    if dimension == 0 || knots.len().checked_mul(dimension) != Some(values.len()) {
        return Err(SplineFileError::WrongLength {
            knots: knots.len(),
            dimension,
            values: values.len(),
        });
    }
    if let Some(&vertex) = knots.iter().find(|&&v| v as usize >= vertices) {
        return Err(SplineFileError::NoSuchVertex { vertex, vertices });
    }
    match values.iter().position(|x| !x.is_finite()) {
        Some(index) => Err(SplineFileError::NotFinite {
            what: "coefficient",
            index,
        }),
        None => Ok(()),
    }
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
