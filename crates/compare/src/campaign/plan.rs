//! From a row to the run that it asks for.

use std::path::Path;

use super::{Campaign, RowResult};
use crate::case::{Case, Input};
use crate::experiment::{Ancestors, Row, ViewHint};
use crate::generated::GeneratedSurface;
use crate::models::{Located, Manifest, Provenance};

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
                (
                    Input::File { path, repair },
                    model.sha256.clone(),
                    model.view,
                )
            }
            Located::Missing(why) => return not(RowResult::NotRun(why)),
        },
        (None, surface) => match surface.as_deref().unwrap_or_default().parse() {
            Ok(surface) => {
                let surface: GeneratedSurface = surface;
                let digest = format!("generated {surface}");
                (Input::Surface(surface), digest, None)
            }
            Err(error) => return not(RowResult::Failed(error.to_string())),
        },
    };
    match row.case(input, ancestors) {
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
