//! From a row to the run that it asks for.

use std::path::Path;

use super::{Campaign, RowResult};
use crate::animation::Animation;
use crate::case::{Case, Creases, Input, Task};
use crate::experiment::{Ancestors, Row, RowFrames, ViewHint};
use crate::models::{Located, Manifest, Provenance};
use crate::run::creases_file;
use msplines_io::sha256_file;

/// What becomes of a row.
pub(super) struct Plan {
    /// Where its mesh comes from.
    pub(super) provenance: Provenance,
    /// The run, or why there is none.
    pub(super) run: Result<Planned, RowResult>,
}

/// A run that can start.
pub(super) struct Planned {
    pub(super) case: Case,
    pub(super) input_digest: String,
    pub(super) view: Option<ViewHint>,
}

/// Returns what becomes of `row`, whose ancestors have ended.
pub(super) fn plan(
    campaign: &Campaign,
    manifest: &Manifest,
    models: &Path,
    row: &Row,
    ancestors: &Ancestors,
) -> Plan {
    let model = row.model.as_deref().map(|name| manifest.model(name));
    let provenance = model
        .flatten()
        .map_or(Provenance::Generated, |model| model.provenance());
    let not = |result| Plan {
        provenance,
        run: Err(result),
    };
    if row.full_only && !campaign.full {
        return not(RowResult::NotRun("only with --full".to_owned()));
    }
    let (input, input_digest, view) = match (model, &row.surface) {
        (Some(None), _) => {
            let name = row.model.as_deref().unwrap_or_default();
            return not(RowResult::Failed(format!(
                "no model {name} in data/models.toml"
            )));
        }
        (Some(Some(model)), _) => match model.locate(models) {
            Located::Found(path) => {
                let repair = false;
                let digest = with_creases(&path, &model.sha256, row);
                (Input::File { path, repair }, digest, model.view)
            }
            Located::Missing(why) => return not(RowResult::NotRun(why)),
        },
        (None, surface) => {
            let name = surface.as_deref().unwrap_or_default();
            match row.generated(name) {
                Ok(input) => (input, format!("generated {name}"), None),
                Err(error) => return not(RowResult::Failed(error)),
            }
        }
    };
    let animation = row.over_time.as_ref();
    let animation = animation.map(|asked| animation_of(row, asked, manifest, models));
    let task = match animation {
        None => None,
        Some(Ok(task)) => Some(task),
        Some(Err(result)) => return not(result),
    };
    let case = row.case(input, ancestors).map(|case| Case {
        task: task.unwrap_or_else(|| case.task.clone()),
        ..case
    });
    match case {
        Ok(case) => Plan {
            provenance,
            run: Ok(Planned {
                case,
                input_digest,
                view,
            }),
        },
        Err(error) => not(RowResult::Failed(error.to_string())),
    }
}

/// Returns the digest of a model together with that of the file beside it that says what is sharp.
fn with_creases(path: &Path, sha256: &str, row: &Row) -> String {
    let beside = creases_file(path, &Creases::Beside).filter(|_| row.takes_control_mesh());
    match beside.and_then(|file| sha256_file(&file).ok()) {
        Some(creases) => format!("{sha256} {creases}"),
        None => sha256.to_owned(),
    }
}

/// Returns the task of a row about an animation, or why it cannot run.
fn animation_of(
    row: &Row,
    asked: &RowFrames,
    manifest: &Manifest,
    models: &Path,
) -> Result<Task, RowResult> {
    let name = asked.animation.as_str();
    if name == Animation::TWIST_AND_WAVE {
        return Ok(Task::Frames(asked.of(Animation::TwistAndWave)));
    }
    let failed = |problem: String| RowResult::Failed(format!("animation {name}: {problem}"));
    let Some(animation) = manifest.animation(name) else {
        return Err(failed("not in data/models.toml".to_owned()));
    };
    if row.model.as_ref() != Some(&animation.rest) {
        let rest = &animation.rest;
        return Err(failed(format!("it moves {rest}; give that as `model`")));
    }
    let located = animation.locate(models).map_err(RowResult::NotRun)?;
    Ok(Task::Frames(asked.of(located)))
}
