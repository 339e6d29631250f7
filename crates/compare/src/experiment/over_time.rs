//! Rows about data that change over time.

use serde::{Deserialize, Serialize};

use super::{Panel, Row, Show};
use crate::animation::{Animation, FrameChoice, FrameError, Frames};

/// The animation that a row fits, frame by frame, in place of its mesh.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RowFrames {
    /// Name of an animation in `data/models.toml`, whose rest mesh is the model of the row, or
    /// [`Animation::TWIST_AND_WAVE`].
    pub animation: String,
    /// Which frames are fitted: `"all"`, `"every 25"` or a list.
    pub frames: FrameChoice,
    /// Which of them pictures show; the last where absent.
    #[serde(default)]
    pub show: Vec<usize>,
}

impl RowFrames {
    /// Returns the frames of the animation that the row names.
    #[must_use]
    pub fn of(&self, animation: Animation) -> Frames {
        Frames {
            animation,
            chosen: self.frames.clone(),
            shown: self.show.clone(),
        }
    }
}

impl Row {
    /// Returns what is wrong with the frames, as far as it can be known without the animation.
    pub(super) fn frames_problem(&self) -> Option<String> {
        let RowFrames { frames, show, .. } = self.over_time.as_ref()?;
        let FrameChoice::List(list) = frames else {
            return None;
        };
        let problem = match show.iter().find(|frame| !list.contains(frame)) {
            Some(&frame) => Some(FrameError::NotChosen { frame }),
            None => frames.of(usize::MAX).err(),
        };
        problem.map(|problem| format!("over_time: {problem}"))
    }
}

/// Returns why a panel cannot show what it asks for of `row`.
pub(super) fn panel_problem(panel: &Panel, row: &Row) -> Option<String> {
    let shown = row.over_time.as_ref().map(|frames| &frames.show);
    match (shown, panel.frame) {
        (None, None) => None,
        (None, Some(_)) => Some(format!("row `{}` has no frames; leave out `frame`", row.id)),
        (Some(_), _) if panel.knots => {
            Some("knots of frames lie on the mesh at rest; use `show = \"knots\"`".to_owned())
        }
        (Some(_), Some(_)) if panel.show == Show::Knots => {
            Some("`knots` shows those of the last frame of `show`; leave out `frame`".to_owned())
        }
        (Some(shown), Some(frame)) if !shown.contains(&frame) => Some(format!(
            "row `{}` does not keep frame {frame}; list it in its `show`",
            row.id
        )),
        (Some(_), _) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::Experiment;

    fn parse(over_time: &str, panel: &str) -> Result<Experiment, String> {
        let text = format!(
            "schema = \"msplines.experiment/1\"\npaper = \"p\"\nitem = \"i\"\ntitle = \"t\"\n\
             [[row]]\nid = \"a\"\nlabel = \"A\"\nmethod = \"biharmonic\"\nknots = \"5\"\n\
             surface = \"genus-2\"\n{over_time}\n[[figure]]\nid = \"f\"\ncaption = \"\"\n\
             [[figure.panel]]\nrow = \"a\"\n{panel}\n"
        );
        Experiment::parse(&text, "p/i.toml").map_err(|e| e.to_string())
    }

    #[test]
    fn a_row_names_its_frames_and_panels_those_it_keeps() {
        let over_time = |frames: &str, show: &str| {
            format!(
                "over_time = {{ animation = \"twist-and-wave\", frames = {frames}, show = {show} }}"
            )
        };
        let good = over_time("\"every 25\"", "[0, 25]");
        parse(&good, "show = \"spline\"\nframe = 25").expect("a good row");
        parse(&good, "show = \"knots\"").expect("the last one");
        let bad = [
            (
                good.clone(),
                "show = \"error\"\nframe = 50",
                "does not keep frame 50",
            ),
            (good, "show = \"knots\"\nframe = 25", "leave out `frame`"),
            (
                String::new(),
                "show = \"error\"\nframe = 0",
                "has no frames",
            ),
            (over_time("\"some\"", "[]"), "show = \"error\"", "every 25"),
            (
                over_time("[]", "[]"),
                "show = \"error\"",
                "no frame is chosen",
            ),
            (
                over_time("[3]", "[4]"),
                "show = \"error\"",
                "frame 4 is to be shown",
            ),
        ];
        for (over_time, panel, message) in bad {
            let error = parse(&over_time, panel).expect_err(panel);
            assert!(
                error.contains(message) && error.contains("p/i.toml"),
                "{error}"
            );
        }
    }
}
