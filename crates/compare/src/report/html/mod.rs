//! The report as one page: what failed first, then every paper's tables and figures, then all
//! methods beside each other. Everything it shows is inside of it.

mod context;
mod peers;

use std::path::Path;

use minijinja::{AutoEscape, Environment};

use super::PageOptions;
use super::drawing::Drawings;
use crate::campaign::Report;

const PAGE: &str = include_str!("page.html");
const PEERS: &str = include_str!("peers.html");
const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("../tables.js");

/// Why a page cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("the page of the report: {0}")]
pub struct PageError(#[from] minijinja::Error);

/// Returns the page of a report that is written into `folder`, where a comparison with other libraries
/// may lie.
///
/// # Errors
/// A template and a context that do not fit together, which a test rules out.
pub fn page(
    report: &Report,
    drawings: &Drawings,
    options: &PageOptions<'_>,
    folder: &Path,
) -> Result<String, PageError> {
    let mut environment = Environment::new();
    environment.set_auto_escape_callback(|_| AutoEscape::Html);
    environment.set_trim_blocks(true);
    environment.set_lstrip_blocks(true);
    environment.add_template("page.html", PAGE)?;
    environment.add_template("peers.html", PEERS)?;
    let context = context::page(report, drawings, options);
    let template = environment.get_template("page.html")?;
    Ok(template.render(minijinja::context! {
        page => context,
        peers => peers::section(folder),
        style => STYLE,
        script => SCRIPT,
    })?)
}
