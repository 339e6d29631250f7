//! The record of one run: what went in, what came out, how well and how fast.

use std::collections::BTreeMap;

use msplines_common::metrics::{Distance, UnitCubeError, VertexError};
use msplines_common::progress::Outcome;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// The schema of [`Record`].
pub const RUN_SCHEMA: &str = "msplines.run/1";

/// What one run did. Lengths are fractions, never percent.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    /// Always [`RUN_SCHEMA`].
    pub schema: String,
    /// The program that ran.
    pub tool: Tool,
    /// `biharmonic`, `ls-mesh`, `sparse-manifold`, `curve-network`, `chart`, `trivariate` or `conformal`.
    pub method: String,
    /// Facts of the input mesh.
    pub input: InputFacts,
    /// All options of the method, defaults included.
    pub options: Value,
    /// How the fit ended.
    pub outcome: Outcome,
    /// Free real coefficients of the spline; an atlas has none.
    pub dofs: u64,
    /// What the domain mesh costs beside them: positions in double precision and 32-bit indices.
    pub domain_bytes: u64,
    /// The spline against the data at the vertices; `None` where there is no data to compare with.
    pub error: Option<VertexError>,
    /// The same errors over the longest side of the bounding box; only for positions.
    pub error_unit_cube: Option<UnitCubeError>,
    /// Two-sided distance between the surfaces, where it was asked for.
    pub distance: Option<Distance>,
    /// Flat values of the method, such as its number of iterations.
    pub checks: BTreeMap<String, Value>,
    /// Where the time went.
    pub seconds: Seconds,
    /// Largest resident memory of the process, in bytes; 0 where the system does not say.
    pub peak_rss_bytes: u64,
    /// Threads of the run.
    pub threads: usize,
    /// Seed of the run.
    pub seed: u64,
    /// Everything that a reader of the figures should know.
    pub warnings: Vec<String>,
}

/// Fields of a record in which paths to numbers start.
const NUMBERS: [&str; 12] = [
    "checks",
    "distance",
    "dofs",
    "domain_bytes",
    "error",
    "error_unit_cube",
    "input",
    "options",
    "peak_rss_bytes",
    "seconds",
    "seed",
    "threads",
];

impl Record {
    /// Returns the record of a run by this program that nothing is known of yet but what it was given.
    pub(crate) fn start(
        method: &'static str,
        input: InputFacts,
        options: Value,
        seed: u64,
    ) -> Self {
        Self {
            schema: RUN_SCHEMA.to_owned(),
            tool: Tool::this(),
            method: method.to_owned(),
            input,
            options,
            outcome: Outcome::Converged,
            dofs: 0,
            domain_bytes: 0,
            error: None,
            error_unit_cube: None,
            distance: None,
            checks: BTreeMap::new(),
            seconds: Seconds::default(),
            peak_rss_bytes: 0,
            threads: rayon::current_num_threads(),
            seed,
            warnings: Vec::new(),
        }
    }

    /// Adds a value of the method.
    pub(crate) fn check(&mut self, name: &str, value: impl Into<Value>) {
        self.checks.insert(name.to_owned(), value.into());
    }

    /// Returns the number at a dotted path, such as `error.max` or `checks.reference_rms`; `None`
    /// where this record has none there.
    #[must_use]
    pub fn number(&self, path: &str) -> Option<f64> {
        let values = serde_json::to_value(self).ok()?;
        let mut fields = path.split('.');
        let found = fields.try_fold(&values, |value, field| value.get(field))?;
        found.as_f64()
    }
}

/// Flat values of a method by name.
pub(crate) type Checks = BTreeMap<String, Value>;

/// Returns values with their names.
pub(crate) fn named<const N: usize>(checks: [(&str, Value); N]) -> Checks {
    checks.map(|(name, value)| (name.to_owned(), value)).into()
}

/// Returns what is wrong with a dotted path that no record has, and what to write.
pub(crate) fn path_problem(path: &str) -> Option<String> {
    let start = path.split('.').next().unwrap_or_default();
    (!NUMBERS.contains(&start)).then(|| {
        format!(
            "no record has `{path}`; a path starts with {}",
            NUMBERS.join(", ")
        )
    })
}

/// The program a record comes from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tool {
    /// Version of the package.
    pub version: String,
    /// Commit it was built from, or `unknown`.
    pub commit: String,
    /// Compiler it was built by.
    pub rustc: String,
}

impl Tool {
    /// Returns this program.
    #[must_use]
    pub fn this() -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            commit: env!("MSPLINES_COMMIT").to_owned(),
            rustc: env!("MSPLINES_RUSTC").to_owned(),
        }
    }
}

/// Kind of an input.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum InputKind {
    /// A triangle mesh.
    Triangles,
    /// A mesh of polygons.
    Polygons,
    /// A tetrahedral mesh.
    Tets,
    /// A curve network.
    Curves,
}

/// Facts of the mesh that a run was given.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InputFacts {
    /// Name of the file without its folder, or of the generated surface.
    pub file: String,
    /// SHA-256 of the file, or of the generated mesh.
    pub sha256: String,
    /// What the file held.
    pub kind: InputKind,
    /// Vertices of the mesh that was fitted.
    pub vertices: u64,
    /// Faces of the mesh that was fitted.
    pub faces: u64,
    /// Cells of a volume; 0 for a surface.
    pub cells: u64,
    /// Genus, where it is defined.
    pub genus: Option<u64>,
    /// Number of boundary loops.
    pub boundary_loops: u64,
}

/// Where the time went, in seconds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Seconds {
    /// From the start of the process until the last output file was closed.
    pub total: f64,
    /// Processor time of all threads; 0 where the system does not say.
    pub cpu: f64,
    /// Wall time of the phases that took place: `read`, `preflight`, `domain`, `factor`, `select`,
    /// `fit`, `evaluate`, `measure`, `write`. Only frames of an animation tell `factor`, what they
    /// share, from `evaluate`.
    pub phases: BTreeMap<String, f64>,
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) fn sample() -> Record {
        Record {
            schema: RUN_SCHEMA.to_owned(),
            tool: Tool::this(),
            method: "biharmonic".to_owned(),
            input: InputFacts {
                file: "a.ply".to_owned(),
                sha256: "0".repeat(64),
                kind: InputKind::Triangles,
                vertices: 10,
                faces: 16,
                cells: 0,
                genus: Some(0),
                boundary_loops: 0,
            },
            options: serde_json::json!({ "seed": 0 }),
            outcome: Outcome::Converged,
            dofs: 12,
            domain_bytes: 432,
            error: Some(VertexError {
                kind: "vertices".to_owned(),
                mean: 0.000_4,
                rms: 0.000_5,
                max: 0.001,
                scale: 2.0,
                psnr_db: Some(60.0),
            }),
            error_unit_cube: Some(UnitCubeError {
                rms: 0.001,
                max: 0.002,
            }),
            distance: None,
            checks: BTreeMap::new(),
            seconds: Seconds::default(),
            peak_rss_bytes: 1,
            threads: 2,
            seed: 0,
            warnings: Vec::new(),
        }
    }

    fn keys(value: &Value) -> Vec<&str> {
        value
            .as_object()
            .expect("an object")
            .keys()
            .map(String::as_str)
            .collect()
    }

    #[test]
    fn record_has_exactly_the_fields_of_its_schema() {
        let value = serde_json::to_value(sample()).expect("a record serialises");
        let expected = [
            "checks",
            "distance",
            "domain_bytes",
            "dofs",
            "error",
            "error_unit_cube",
            "input",
            "method",
            "options",
            "outcome",
            "peak_rss_bytes",
            "schema",
            "seconds",
            "seed",
            "threads",
            "tool",
            "warnings",
        ];
        let mut expected = expected.to_vec();
        expected.sort_unstable();
        assert_eq!(keys(&value), expected);
        assert_eq!(value["schema"], "msplines.run/1");
        assert_eq!(keys(&value["tool"]), ["commit", "rustc", "version"]);
        assert_eq!(
            keys(&value["input"]),
            [
                "boundary_loops",
                "cells",
                "faces",
                "file",
                "genus",
                "kind",
                "sha256",
                "vertices"
            ]
        );
        assert_eq!(
            keys(&value["error"]),
            ["kind", "max", "mean", "psnr_db", "rms", "scale"]
        );
        assert_eq!(keys(&value["seconds"]), ["cpu", "phases", "total"]);
        assert_eq!(value["outcome"], "converged");
        assert_eq!(value["error"]["kind"], "vertices");
    }

    #[test]
    fn numbers_are_found_by_their_paths_which_start_with_fields_of_a_record() {
        let record = sample();
        assert_eq!(record.number("error.max"), Some(0.001));
        assert_eq!(record.number("dofs"), Some(12.0));
        for absent in ["checks.none", "error.kind", "error", "distance.rms"] {
            assert_eq!(record.number(absent), None, "{absent}");
        }
        let value = serde_json::to_value(record).expect("a record serialises");
        assert!(NUMBERS.iter().all(|field| keys(&value).contains(field)));
        assert_eq!(path_problem("checks.none"), None);
        let text = path_problem("errors.max").expect("refused");
        assert!(text.contains("no record has `errors.max`") && text.contains("checks"));
    }

    #[test]
    fn record_survives_a_round_trip_through_json() {
        let text = serde_json::to_string(&sample()).expect("a record serialises");
        assert_eq!(
            serde_json::from_str::<Record>(&text).expect("it reads back"),
            sample()
        );
    }
}
