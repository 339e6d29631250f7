//! What a comparison found, for people and for programs.

use std::fs;
use std::path::Path;

use serde::Serialize;

use crate::Library;

/// The largest deviation of one quantity from a library, over several meshes.
#[derive(Debug, Serialize)]
pub struct Comparison {
    quantity: String,
    reference: String,
    meshes: Vec<String>,
    largest_deviation: f64,
    at: String,
    bound: f64,
    why_this_bound: String,
}

impl Comparison {
    /// Returns an empty comparison that accepts deviations up to `bound`.
    #[must_use]
    pub fn new(quantity: &str, library: Library, bound: f64, why_this_bound: &str) -> Self {
        Self {
            quantity: quantity.to_owned(),
            reference: library.version(),
            meshes: Vec::new(),
            largest_deviation: 0.0,
            at: String::new(),
            bound,
            why_this_bound: why_this_bound.to_owned(),
        }
    }

    /// Adds the deviations on one mesh.
    pub fn add(&mut self, mesh: &str, deviations: impl IntoIterator<Item = f64>) {
        if self.meshes.last().is_none_or(|last| last != mesh) {
            self.meshes.push(mesh.to_owned());
        }
        for deviation in deviations {
            // A NaN is larger than every bound.
            if deviation.is_nan() || deviation > self.largest_deviation {
                self.largest_deviation = if deviation.is_nan() {
                    f64::INFINITY
                } else {
                    deviation
                };
                mesh.clone_into(&mut self.at);
            }
        }
    }

    /// Writes the comparison to `target/reference` and checks it.
    ///
    /// # Panics
    /// If the bound is exceeded, or nothing was compared, or the record cannot be written.
    pub fn finish(self) {
        assert!(!self.meshes.is_empty(), "nothing was compared");
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target/reference");
        fs::create_dir_all(&folder).expect("the target folder can be written");
        let name = self.quantity.replace(' ', "-");
        let text = serde_json::to_string_pretty(&self).expect("a record is plain data");
        fs::write(folder.join(format!("{name}.json")), text).expect("the record can be written");
        println!(
            "{}: {:e} on {}",
            self.quantity, self.largest_deviation, self.at
        );
        assert!(
            self.largest_deviation <= self.bound,
            "{} deviates from {} by {:e} on {}, more than {:e} ({})",
            self.quantity,
            self.reference,
            self.largest_deviation,
            self.at,
            self.bound,
            self.why_this_bound,
        );
    }
}
