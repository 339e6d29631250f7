//! A report as terminal tables, CSV, JSON, Markdown, and as one page with its pictures.

pub mod drawing;
pub mod html;
mod properties;
mod quantities;
pub mod references;
pub mod surface_payload;
mod tables;
pub mod viewer;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use comfy_table::ContentArrangement;
use comfy_table::presets::UTF8_FULL_CONDENSED;

use crate::campaign::{CampaignError, ItemReport, Report, RowReport, Times};

pub use properties::property_table;
pub use quantities::{Quantity, Unit, cost_quantities, error_quantity};
pub use tables::{Cell, Table, cost_table, error_table, notes};

/// Returns the tables of an item that say anything.
fn tables(item: &ItemReport, times: Times) -> impl Iterator<Item = Table> {
    let all = [
        error_table(item),
        property_table(item),
        cost_table(item, times),
    ];
    all.into_iter().filter(|table| !table.rows.is_empty())
}

/// Returns the report for a terminal.
#[must_use]
pub fn terminal(report: &Report) -> String {
    let mut text = String::new();
    for item in &report.items {
        for table in tables(item, report.times) {
            let mut drawn = comfy_table::Table::new();
            drawn.load_style(UTF8_FULL_CONDENSED);
            drawn.set_content_arrangement(ContentArrangement::Dynamic);
            drawn.set_header(&table.header);
            drawn.add_rows(&table.rows);
            let _ = writeln!(text, "{}\n{drawn}", table.title);
        }
        for note in notes(item) {
            let _ = writeln!(text, "  {note}");
        }
        text.push('\n');
    }
    text
}

/// Returns the items of `paper` as a Markdown page.
#[must_use]
pub fn markdown(report: &Report, paper: &str) -> String {
    let records = report.items.iter().flat_map(|item| &item.rows);
    let threads = records
        .filter_map(|row| Some(row.result.record()?.threads))
        .max();
    let tool = &report.tool;
    let mut text = format!(
        "# Results: {paper}\n\nWritten by `cargo xtask repro {paper}` (version {}, {}, {} threads). Errors are \
         the mean over the vertices, in percent of the bounding-box diagonal; PSNR is per channel. \
         Only models that the paper used are judged; stand-ins and generated surfaces are compared \
         with our own recorded values. T_k is factorisation and knot selection, T_f the fit at the \
         chosen knots.\n",
        tool.version,
        tool.rustc,
        threads.unwrap_or(0)
    );
    for item in report.items.iter().filter(|item| item.paper == paper) {
        let _ = writeln!(text, "\n## {}: {}\n", item.item, item.title);
        for table in tables(item, report.times) {
            push_markdown_table(&mut text, &table);
        }
        for note in notes(item) {
            let _ = writeln!(text, "- {}", cell(&note));
        }
    }
    text
}

fn push_markdown_table(text: &mut String, table: &Table) {
    let mut line = |cells: Vec<String>| {
        let _ = writeln!(text, "| {} |", cells.join(" | "));
    };
    let cell = |text: &str| cell(&text.trim().replace('\n', "<br>"));
    line(table.header.iter().map(|name| cell(name)).collect());
    line(vec!["---".to_owned(); table.header.len()]);
    for row in &table.rows {
        line(row.iter().map(|c| cell(&c.text)).collect());
    }
    text.push('\n');
}

fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

/// Returns all quantities as CSV, one per line; fractions, seconds, bytes, never percent.
///
/// # Errors
/// What the writer reports, which memory never does.
pub fn csv(report: &Report) -> std::io::Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record([
        "paper",
        "item",
        "row",
        "domain",
        "provenance",
        "method",
        "knots",
        "quantity",
        "unit",
        "paper_value",
        "ours",
        "ratio",
        "tolerance",
        "verdict",
        "regression",
        "analysis",
    ])?;
    for item in &report.items {
        for row in &item.rows {
            let judged = error_quantity(row);
            writer.write_record(csv_line([&item.paper, &item.item], row, &judged, true))?;
            for quantity in cost_quantities(row) {
                writer.write_record(csv_line([&item.paper, &item.item], row, &quantity, false))?;
            }
        }
    }
    writer.into_inner().map_err(|error| error.into_error())
}

fn csv_line(
    [paper, item]: [&String; 2],
    report: &RowReport,
    quantity: &Quantity,
    is_judged: bool,
) -> Vec<String> {
    let number = |value: Option<f64>| value.map_or(String::new(), |v| v.to_string());
    let row = &report.row;
    let domain = row.model.as_ref().or(row.surface.as_ref());
    let regression = serde_json::to_value(report.judgement.regression).unwrap_or_default();
    let verdict = if is_judged {
        report.judgement.verdict.text()
    } else {
        ""
    };
    let text = |value: &serde_json::Value| value.as_str().unwrap_or_default().to_owned();
    vec![
        paper.clone(),
        item.clone(),
        row.id.clone(),
        domain.cloned().unwrap_or_default(),
        report.provenance.text().to_owned(),
        row.method.name().to_owned(),
        row.asked_knots(),
        quantity.name.to_owned(),
        quantity.unit.name().to_owned(),
        number(quantity.paper),
        number(quantity.ours),
        number(quantity.ratio),
        if is_judged {
            row.tolerance.to_string()
        } else {
            String::new()
        },
        verdict.to_owned(),
        if is_judged {
            text(&regression)
        } else {
            String::new()
        },
        row.analysis.trim().to_owned(),
    ]
}

/// How the page of a report is made.
#[derive(Clone, Copy, Debug)]
pub struct PageOptions<'a> {
    /// The project's folder of experiments, which says what the papers are called.
    pub experiments: &'a Path,
    /// Side of a picture in pixels.
    pub pixels: usize,
    /// The script that makes pictures turnable.
    pub viewer: &'a viewer::Viewer,
    /// Comparisons with code that nobody here wrote, if there are any.
    pub references: &'a [references::Reference],
}

/// Writes `index.html`, `report.json`, `report.csv`, one `PAPER.md` per paper and one
/// `pictures/PAPER-ITEM-FIGURE.png` per figure into `folder`, and returns their paths.
///
/// # Errors
/// A file that cannot be written.
pub fn write(
    report: &Report,
    folder: &Path,
    options: &PageOptions<'_>,
) -> Result<Vec<PathBuf>, CampaignError> {
    let mut written = Vec::new();
    let mut put = |name: String, bytes: std::io::Result<Vec<u8>>| {
        let path = folder.join(name);
        let done = bytes.and_then(|bytes| replace(&path, &bytes));
        done.map_err(|source| CampaignError::Output {
            path: path.clone(),
            source,
        })?;
        written.push(path);
        Ok::<(), CampaignError>(())
    };
    let drawings = drawing::draw(report, options.drawing());
    for (name, png) in drawings.sheets(report) {
        put(format!("{PICTURES}/{name}"), Ok(png))?;
    }
    let page = html::page(report, &drawings, options, folder);
    let page = page.map(String::into_bytes).map_err(std::io::Error::other);
    put("index.html".to_owned(), page)?;
    let json = serde_json::to_vec_pretty(report).map_err(std::io::Error::from);
    put("report.json".to_owned(), json)?;
    put("report.csv".to_owned(), csv(report))?;
    for paper in papers(report) {
        put(
            format!("{paper}.md"),
            Ok(markdown(report, &paper).into_bytes()),
        )?;
    }
    Ok(written)
}

/// Folder of the figures as pictures.
pub const PICTURES: &str = "pictures";

impl PageOptions<'_> {
    fn drawing(&self) -> drawing::DrawingOptions {
        drawing::DrawingOptions {
            pixels: self.pixels,
            views: match self.viewer {
                viewer::Viewer::Script(_) => drawing::Views::Turnable,
                viewer::Viewer::Absent(_) => drawing::Views::Still,
            },
        }
    }
}

/// Returns the papers of a report, each once.
#[must_use]
pub fn papers(report: &Report) -> Vec<String> {
    let mut papers: Vec<String> = report.items.iter().map(|item| item.paper.clone()).collect();
    papers.dedup();
    papers
}

/// Writes a file beside its place and renames it.
///
/// # Errors
/// A file that cannot be written.
pub fn replace(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    std::fs::create_dir_all(path.parent().unwrap_or(Path::new(".")))?;
    msplines_io::write_atomically(path, |out| out.write_all(bytes)).map_err(std::io::Error::other)
}
