//! T-splines over surfaces as runs are asked for them.

use std::str::FromStr;

use msplines_conformal::poles::ProtrusionOptions;
use msplines_t_spline::domain::SnapOptions;
use msplines_t_spline::{FitOptions, Sampling};
use serde::{Deserialize, Serialize};

use super::Form;

/// A T-spline that approximates a surface, with its options.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TSplineMethod {
    /// The form that cuts a closed surface with handles into cylinders; [`Form::Integer`] where absent.
    pub form: Option<Form>,
    /// Which vertices become poles.
    pub puncture: Puncture,
    /// What counts as thin and near when cylinders are cut.
    pub snap: SnapOptions,
    /// The fit. A tolerance is a fraction of the longest side of the bounding box here.
    pub fit: FitOptions,
    /// Samples inside of faces.
    pub face_samples: Sampling,
    /// Segments along each side of a face in files of the surface; its points at the vertices of the
    /// input where absent.
    pub tessellate: Option<u32>,
    /// Whether everything that pictures show is kept: cylinders, control points, surfaces on the way.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub pictures: bool,
}

/// Which vertices become poles: `"auto"`, a list of vertices, or options of protrusions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Puncture {
    /// As people name them.
    Named(NamedPuncture),
    /// These vertices; as many as are needed where there are none.
    Vertices(Vec<u32>),
    /// Vertices at the protrusions of a closed surface.
    Protrusions(ProtrusionOptions),
}

/// Poles by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NamedPuncture {
    /// Two vertices far from each other on a closed surface of genus 0, one far from the boundary of a
    /// surface with one loop, none otherwise.
    Needed,
    /// Vertices at the protrusions of a closed surface of any genus; as many as are needed where it has a
    /// boundary.
    Auto,
}

impl Default for Puncture {
    fn default() -> Self {
        Self::Named(NamedPuncture::Needed)
    }
}

/// No poles are written so.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` names no vertices; give auto, or numbers of vertices with commas between them")]
pub struct PunctureError {
    /// What was given.
    pub text: String,
}

impl FromStr for Puncture {
    type Err = PunctureError;

    fn from_str(text: &str) -> Result<Self, PunctureError> {
        if text.trim() == "auto" {
            return Ok(Self::Named(NamedPuncture::Auto));
        }
        let vertices = text.split(',').map(|vertex| vertex.trim().parse());
        let vertices = vertices.collect::<Result<Vec<u32>, _>>();
        vertices.map(Self::Vertices).map_err(|_| PunctureError {
            text: text.to_owned(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poles_are_read_from_words_lists_and_options() {
        let auto = Puncture::Named(NamedPuncture::Auto);
        assert_eq!("auto".parse(), Ok(auto.clone()));
        assert_eq!("7, 12".parse(), Ok(Puncture::Vertices(vec![7, 12])));
        for text in ["", "1,,2", "-3", "ears"] {
            let error = text.parse::<Puncture>().expect_err(text).to_string();
            assert!(error.contains("give auto"), "{error}");
        }
        let read = |text: &str| serde_json::from_str::<Puncture>(text).expect(text);
        assert_eq!(read("\"auto\""), auto);
        assert_eq!(read("\"needed\""), Puncture::default());
        assert_eq!(read("[3, 4]"), Puncture::Vertices(vec![3, 4]));
        let few = ProtrusionOptions {
            most: 3,
            ..ProtrusionOptions::default()
        };
        assert_eq!(read("{\"most\": 3}"), Puncture::Protrusions(few));
        assert!(serde_json::from_str::<Puncture>("{\"least\": 3}").is_err());
    }
}
