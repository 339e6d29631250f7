//! The models that experiments name: what is known about them, and where their files are.

use std::path::{Path, PathBuf};

use msplines_io::sha256_file;
use serde::{Deserialize, Serialize};

use crate::animation::Animation;
use crate::experiment::{ExperimentError, ViewHint, read_text};

/// The schema of [`Manifest`].
pub const MODELS_SCHEMA: &str = "msplines.models/1";

/// All models, as `data/models.toml` lists them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// Always [`MODELS_SCHEMA`].
    pub schema: String,
    /// The models.
    #[serde(rename = "model")]
    pub models: Vec<Model>,
    /// Motions of models.
    #[serde(default, rename = "animation")]
    pub animations: Vec<SkinnedAnimation>,
}

/// A motion of a model: weights of its vertices, and a map of every bone for every frame.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SkinnedAnimation {
    /// Name in experiments.
    pub name: String,
    /// Name of the model that moves.
    pub rest: String,
    /// What it is and how it differs from the paper's.
    pub status: String,
    /// Weights of the vertices.
    pub weights: DataFile,
    /// Maps of the bones.
    pub transforms: DataFile,
    /// Who made it and where it is found.
    pub origin: String,
    /// Under which terms.
    pub terms: String,
}

/// A file of numbers.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DataFile {
    /// Path below the folder of the models.
    pub file: String,
    /// SHA-256 of the file.
    pub sha256: String,
}

/// One model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Model {
    /// Name in experiments.
    pub name: String,
    /// Path below the folder of the models.
    pub file: String,
    /// Whether a paper used this model; a stand-in otherwise.
    pub real: bool,
    /// What it is and how it differs from the paper's.
    pub status: String,
    /// Number of vertices.
    pub vertices: u64,
    /// Number of faces.
    pub faces: u64,
    /// Genus.
    pub genus: u64,
    /// Number of boundary loops.
    pub boundary_loops: u64,
    /// SHA-256 of the file.
    pub sha256: String,
    /// Who made it and where it is found.
    pub origin: String,
    /// Under which terms.
    pub terms: String,
    /// What was done to it.
    pub processing: String,
    /// Where it is best seen from.
    pub view: Option<ViewHint>,
}

/// Where the mesh of a row comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Provenance {
    /// The model that a paper used.
    Real,
    /// Another model in its place.
    StandIn,
    /// A formula.
    Generated,
}

impl Provenance {
    /// Returns what tables say.
    #[must_use]
    pub fn text(self) -> &'static str {
        match self {
            Self::Real => "real",
            Self::StandIn => "stand-in",
            Self::Generated => "generated",
        }
    }
}

/// Whether the file of a model can be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Located {
    /// It is there, with the digest of the manifest.
    Found(PathBuf),
    /// It is not; the text says why and what to do.
    Missing(String),
}

impl Manifest {
    /// Reads `data/models.toml`.
    ///
    /// # Errors
    /// A file that cannot be read or has other fields.
    pub fn read(path: &Path) -> Result<Self, ExperimentError> {
        Self::parse(&read_text(path)?, &path.display().to_string())
    }

    /// Reads the text of such a file called `name`.
    ///
    /// # Errors
    /// Other fields.
    pub fn parse(text: &str, name: &str) -> Result<Self, ExperimentError> {
        toml::from_str(text).map_err(|e| ExperimentError::Syntax {
            path: name.to_owned(),
            message: e.to_string(),
        })
    }

    /// Returns the model of this name.
    #[must_use]
    pub fn model(&self, name: &str) -> Option<&Model> {
        self.models.iter().find(|model| model.name == name)
    }

    /// Returns the animation of this name.
    #[must_use]
    pub fn animation(&self, name: &str) -> Option<&SkinnedAnimation> {
        self.animations.iter().find(|found| found.name == name)
    }
}

impl SkinnedAnimation {
    /// Looks for the files below `folder` and compares their digests.
    ///
    /// # Errors
    /// Why they cannot be used, and what to do.
    pub fn locate(&self, folder: &Path) -> Result<Animation, String> {
        let file =
            |file: &DataFile| match locate(&self.name, &folder.join(&file.file), &file.sha256) {
                Located::Found(path) => Ok(path),
                Located::Missing(why) => Err(why),
            };
        Ok(Animation::Skinned {
            weights: file(&self.weights)?,
            transforms: file(&self.transforms)?,
        })
    }
}

impl Model {
    /// Returns whether this is the model of a paper or one in its place.
    #[must_use]
    pub fn provenance(&self) -> Provenance {
        if self.real {
            Provenance::Real
        } else {
            Provenance::StandIn
        }
    }

    /// Looks for the file below `folder` and compares its digest.
    #[must_use]
    pub fn locate(&self, folder: &Path) -> Located {
        locate(&self.name, &folder.join(&self.file), &self.sha256)
    }
}

/// Looks for a file that belongs to the model or animation `name`.
fn locate(name: &str, path: &Path, sha256: &str) -> Located {
    match sha256_file(path) {
        Ok(digest) if digest == sha256 => Located::Found(path.to_owned()),
        Ok(digest) => Located::Missing(format!(
            "{name}: another file than data/models.toml lists (SHA-256 {}...)",
            &digest[..12]
        )),
        Err(_) => Located::Missing(name.to_owned()),
    }
}

/// Returns the folder of the models: the given one, else `$MSPLINES_MODELS`, else `data/models`
/// below `root`.
#[must_use]
pub fn models_folder(given: Option<&Path>, root: &Path) -> PathBuf {
    match (given, std::env::var_os("MSPLINES_MODELS")) {
        (Some(folder), _) => folder.to_owned(),
        (None, Some(folder)) if !folder.is_empty() => folder.into(),
        _ => root.join("data/models"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_is_used_only_with_the_digest_of_the_manifest() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let digest = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        let text = format!(
            "schema = \"msplines.models/1\"\n[[model]]\nname = \"m\"\nfile = \"m.ply\"\nreal = true\n\
             status = \"\"\nvertices = 4\nfaces = 4\ngenus = 0\nboundary_loops = 0\nsha256 = \
             \"{digest}\"\norigin = \"\"\nterms = \"\"\nprocessing = \"\"\n"
        );
        let manifest: Manifest = toml::from_str(&text).expect("a manifest");
        let model = manifest.model("m").expect("listed");
        assert_eq!(
            model.locate(folder.path()),
            Located::Missing("m".to_owned())
        );
        let path = folder.path().join("m.ply");
        std::fs::write(&path, "abc").expect("written");
        assert_eq!(model.locate(folder.path()), Located::Found(path.clone()));
        std::fs::write(&path, "abd").expect("written");
        assert!(
            matches!(model.locate(folder.path()), Located::Missing(why) if why.contains("another"))
        );
    }
}
