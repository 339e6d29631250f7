//! Trivariate splines in spline files.

use msplines_common::Point3;
use msplines_trivariate::TrivariateSpline;
use serde::{Deserialize, Serialize};

use crate::error::SplineFileError;
use crate::record::{InputFacts, InputKind};

/// A trivariate spline: its lattice of control points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredTrivariate {
    /// Spans in each direction.
    pub spans: usize,
    /// Control points, the first of their three indices fastest: three more than spans in each
    /// direction.
    pub points: Vec<[f64; 3]>,
}

impl StoredTrivariate {
    /// Returns the stored form of a spline.
    #[must_use]
    pub fn of(spline: &TrivariateSpline) -> Self {
        Self {
            spans: spline.spans(),
            points: spline.points().iter().map(|p| [p.x, p.y, p.z]).collect(),
        }
    }

    /// Returns the spline.
    ///
    /// # Errors
    /// Points that do not fill the lattice, or are not finite.
    pub fn restore(&self) -> Result<TrivariateSpline, SplineFileError> {
        let points = self.points.iter().map(|&p| Point3::from(p)).collect();
        Ok(TrivariateSpline::build(self.spans, points)?)
    }
}

/// The unit cube as a domain, which needs no mesh, and what the solid came from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredCube {
    /// SHA-256 of the file of the solid, or of the generated mesh.
    pub sha256: String,
    /// What it held.
    pub kind: InputKind,
    /// Its vertices.
    pub vertices: u64,
    /// Its faces; of a solid those of its boundary.
    pub faces: u64,
    /// Its cells; 0 for a surface.
    pub cells: u64,
}

impl StoredCube {
    /// Returns the cube that an input was mapped to.
    #[must_use]
    pub fn of(input: &InputFacts) -> Self {
        Self {
            sha256: input.sha256.clone(),
            kind: input.kind,
            vertices: input.vertices,
            faces: input.faces,
            cells: input.cells,
        }
    }

    /// Returns the facts of the input, under the name of `file`.
    #[must_use]
    pub fn facts(&self, file: String) -> InputFacts {
        InputFacts {
            file,
            sha256: self.sha256.clone(),
            kind: self.kind,
            vertices: self.vertices,
            faces: self.faces,
            cells: self.cells,
            genus: Some(0),
            boundary_loops: 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{SplineFile, StoredDomain, StoredSpline};
    use super::*;

    fn file() -> SplineFile {
        let bend = |[u, v, w]: [f64; 3]| Point3::new(u + 0.1 * v * v, v / 3.0, w - 0.7 * u);
        let spline = TrivariateSpline::from_map(2, bend).expect("a spline");
        let cube = StoredCube {
            sha256: "ab".repeat(32),
            kind: InputKind::Tets,
            vertices: 8,
            faces: 12,
            cells: 6,
        };
        let spline = StoredSpline::Trivariate(StoredTrivariate::of(&spline));
        SplineFile::new(StoredDomain::Cube { cube }, serde_json::json!({}), spline)
    }

    #[test]
    fn a_solid_and_its_domain_round_trip_to_the_same_bits() {
        let file = file();
        let mut bytes = Vec::new();
        file.write(&mut bytes).expect("memory takes all bytes");
        let read = SplineFile::parse(&bytes).expect("it reads back");
        assert_eq!(read, file);
        let (StoredSpline::Trivariate(a), StoredSpline::Trivariate(b)) =
            (&read.spline, &file.spline)
        else {
            panic!("another method");
        };
        let bits = |stored: &StoredTrivariate| -> Vec<u64> {
            let numbers = stored.points.as_flattened().iter();
            numbers.map(|x| x.to_bits()).collect()
        };
        assert_eq!(bits(a), bits(b));
        assert_eq!(a.restore().expect("a spline").points().len(), 125);
        let value: serde_json::Value = serde_json::from_slice(&bytes).expect("json");
        assert_eq!(value["method"], "trivariate");
        assert_eq!(value["domain"]["cube"]["kind"], "tets");
        assert_eq!(value["data"]["spans"], 2);
    }

    #[test]
    fn a_lattice_that_is_not_full_is_refused() {
        let stored = StoredTrivariate {
            spans: 2,
            points: vec![[0.0; 3]; 124],
        };
        let text = stored.restore().expect_err("refused").to_string();
        assert!(text.contains("124") && text.contains("125"), "{text}");
        let nothing = StoredTrivariate {
            spans: 0,
            points: Vec::new(),
        };
        assert!(nothing.restore().is_err());
    }
}
