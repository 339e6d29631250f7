//! Which frames of an animation are taken.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// Which frames are taken, counted from 0. In files `"all"`, `"every 25"` or a list.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "Written", into = "Written")]
pub enum FrameChoice {
    /// The first and every so many after it.
    Every(usize),
    /// These, in this order.
    List(Vec<usize>),
}

/// Why frames cannot be taken.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FrameError {
    /// No choice of frames.
    #[error("`{text}` is no choice of frames; write `all`, `every 25` or a list such as `0,25,50`")]
    Unreadable {
        /// What was given.
        text: String,
    },
    /// Nothing to fit.
    #[error("no frame is chosen; list at least one")]
    None,
    /// A frame that the animation does not have.
    #[error("frame {frame} is not among the {frames} frames of the animation, counted from 0")]
    NoSuchFrame {
        /// The frame.
        frame: usize,
        /// Frames of the animation.
        frames: usize,
    },
    /// A frame that is listed twice.
    #[error("frame {frame} is chosen twice; list it once")]
    Repeated {
        /// The frame.
        frame: usize,
    },
    /// A frame that is to be shown and is not fitted.
    #[error(
        "frame {frame} is to be shown but is not among those that are fitted; choose it as well"
    )]
    NotChosen {
        /// The frame.
        frame: usize,
    },
}

impl FrameChoice {
    /// Returns the chosen ones of so many frames.
    ///
    /// # Errors
    /// No frame, one that there is not, or one that is listed twice.
    pub fn of(&self, frames: usize) -> Result<Vec<usize>, FrameError> {
        let chosen: Vec<usize> = match self {
            Self::Every(step) => (0..frames).step_by((*step).max(1)).collect(),
            Self::List(list) => list.clone(),
        };
        if chosen.is_empty() {
            return Err(FrameError::None);
        }
        for (index, &frame) in chosen.iter().enumerate() {
            if frame >= frames {
                return Err(FrameError::NoSuchFrame { frame, frames });
            }
            if chosen[..index].contains(&frame) {
                return Err(FrameError::Repeated { frame });
            }
        }
        Ok(chosen)
    }
}

impl FromStr for FrameChoice {
    type Err = FrameError;

    fn from_str(text: &str) -> Result<Self, FrameError> {
        let unreadable = || FrameError::Unreadable {
            text: text.to_owned(),
        };
        let number = |text: &str| text.trim().parse::<usize>().map_err(|_| unreadable());
        let asked = text.trim();
        if asked == "all" {
            return Ok(Self::Every(1));
        }
        if let Some(step) = asked.strip_prefix("every ") {
            return match number(step)? {
                0 => Err(unreadable()),
                step => Ok(Self::Every(step)),
            };
        }
        asked
            .split(',')
            .map(number)
            .collect::<Result<_, _>>()
            .map(Self::List)
    }
}

impl fmt::Display for FrameChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Every(0 | 1) => f.write_str("all"),
            Self::Every(step) => write!(f, "every {step}"),
            Self::List(list) => {
                let list: Vec<String> = list.iter().map(usize::to_string).collect();
                f.write_str(&list.join(","))
            }
        }
    }
}

/// A choice as files hold it.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Written {
    Text(String),
    List(Vec<usize>),
}

impl TryFrom<Written> for FrameChoice {
    type Error = FrameError;

    fn try_from(written: Written) -> Result<Self, FrameError> {
        match written {
            Written::Text(text) => text.parse(),
            Written::List(list) => Ok(Self::List(list)),
        }
    }
}

impl From<FrameChoice> for Written {
    fn from(choice: FrameChoice) -> Self {
        match choice {
            FrameChoice::List(list) => Self::List(list),
            every => Self::Text(every.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_chosen_by_step_or_by_list() {
        let of = |text: &str| text.parse::<FrameChoice>().and_then(|choice| choice.of(10));
        assert_eq!(of("all"), Ok((0..10).collect()));
        assert_eq!(of("every 4"), Ok(vec![0, 4, 8]));
        assert_eq!(of("7, 2"), Ok(vec![7, 2]));
        let refused = [
            ("", "no choice"),
            ("every 0", "no choice"),
            ("every -1", "no choice"),
            ("1;2", "no choice"),
            ("3,10", "frame 10 is not among the 10 frames"),
            ("3,4,3", "frame 3 is chosen twice"),
        ];
        for (text, message) in refused {
            let error = of(text).expect_err(text).to_string();
            assert!(error.contains(message), "{text}: {error}");
        }
        assert_eq!(FrameChoice::List(Vec::new()).of(10), Err(FrameError::None));
        assert_eq!(FrameChoice::Every(3).of(0), Err(FrameError::None));
    }

    #[test]
    fn choices_survive_a_round_trip_through_a_file() {
        for text in ["\"all\"", "\"every 25\"", "[0,25,50]"] {
            let choice: FrameChoice = serde_json::from_str(text).expect(text);
            assert_eq!(serde_json::to_string(&choice).expect("json"), text);
        }
        let error = serde_json::from_str::<FrameChoice>("\"some\"").expect_err("refused");
        assert!(error.to_string().contains("every 25"), "{error}");
    }
}
