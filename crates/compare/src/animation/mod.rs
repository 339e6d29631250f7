//! Data over time: where the frames of an animation come from, and which of them are fitted.
//!
//! An animation gives values at all vertices of one mesh for every frame. The mesh itself, the input
//! of a run, stays as it is: frames are functions on it.

mod choice;
mod source;

use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::input::file_name;

pub use choice::{FrameChoice, FrameError};
pub(crate) use source::Loaded;

/// Frames of an animation that are fitted one by one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Frames {
    /// Where they come from.
    pub animation: Animation,
    /// Which of them are fitted, in this order.
    pub chosen: FrameChoice,
    /// Which of those pictures show; the last where empty.
    #[serde(default)]
    pub shown: Vec<usize>,
}

/// Where the frames of an animation come from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Animation {
    /// Linear blend skinning of the input: vertex `i` in frame `t` is
    /// `Σ_b w[i][b] (A[t][b] x_i + a[t][b])`.
    Skinned {
        /// `w`, vertices × bones, as float32, little endian.
        weights: PathBuf,
        /// `[A a]`, frames × bones × 3 × 4, as float32, little endian.
        transforms: PathBuf,
    },
    /// A NumPy array, frames × vertices × components. Three components are positions.
    Array(PathBuf),
    /// A formula, so that nothing but the input is needed: see [`Animation::WAVE_FRAMES`].
    TwistAndWave,
}

impl Animation {
    /// Name of the formula in experiments.
    pub const TWIST_AND_WAVE: &'static str = "twist-and-wave";

    /// Frames of one period of [`Animation::TwistAndWave`]: the input is twisted about its vertical
    /// axis, there and back, while a wave runs along it.
    pub const WAVE_FRAMES: usize = 100;

    /// Returns the files it reads.
    pub(crate) fn files_mut(&mut self) -> impl Iterator<Item = &mut PathBuf> {
        let (first, second) = match self {
            Self::Skinned {
                weights,
                transforms,
            } => (Some(weights), Some(transforms)),
            Self::Array(path) => (Some(path), None),
            Self::TwistAndWave => (None, None),
        };
        first.into_iter().chain(second)
    }
}

impl Frames {
    /// Returns all frames of an animation.
    #[must_use]
    pub fn all(animation: Animation) -> Self {
        Self {
            animation,
            chosen: FrameChoice::Every(1),
            shown: Vec::new(),
        }
    }

    /// Returns what records say: files by their names, without folders.
    pub(crate) fn described(&self) -> Value {
        let mut frames = self.clone();
        for path in frames.animation.files_mut() {
            *path = file_name(path).into();
        }
        json!(frames)
    }
}
