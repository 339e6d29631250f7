//! The pictures of a report: figures of surfaces from the files of its rows, and plots of its
//! quantities.

mod camera;
mod companions;
mod fitted;
mod frames;
mod lines;
mod panel;
mod plots;
mod scales;
mod source;
mod t_spline;
mod turnable;
mod values;

use std::collections::BTreeMap;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use msplines_picture::{Grid, Image};
use rayon::prelude::*;
use serde::Serialize;

use super::Unit;
use super::tables::one_line;
use crate::campaign::{ItemReport, Report, RowReport, RowResult};
use crate::experiment::{Figure, Panel, PaperFacts, Show};
use scales::{Bar, Scales};
use source::{Domains, Source};
use values::Subject;

/// How pictures are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DrawingOptions {
    /// Side of a picture in pixels.
    pub pixels: usize,
    /// Whether the surfaces themselves are kept too, for views that can be turned.
    pub views: Views,
}

/// What is kept of a surface beside its picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Views {
    /// Nothing.
    Still,
    /// A lighter mesh of it.
    Turnable,
}

/// All pictures of a report, one entry per item.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Drawings {
    pub(super) items: Vec<DrawnItem>,
}

/// All pictures of an item.
#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct DrawnItem {
    figures: Vec<DrawnFigure>,
    plots: Vec<DrawnPlot>,
}

#[derive(Clone, Debug, Serialize)]
struct DrawnFigure {
    id: String,
    caption: String,
    look_for: String,
    columns: usize,
    panels: Vec<DrawnPanel>,
    /// The scale of all panels, where there is only one.
    bar: Option<Bar>,
    /// The whole figure as one picture, for other documents.
    #[serde(skip)]
    sheet: Option<Image>,
}

/// A picture of a row, or why there is none.
#[derive(Clone, Debug, Default, Serialize)]
struct DrawnPanel {
    label: String,
    measure: String,
    /// As `data:` address.
    picture: Option<String>,
    width: usize,
    height: usize,
    payload: Option<String>,
    /// Its scale, where that is not the only one of the figure.
    bar: Option<Bar>,
    absent: String,
}

/// A plot as `data:` address.
#[derive(Clone, Debug, Serialize)]
struct DrawnPlot {
    id: String,
    caption: String,
    look_for: String,
    picture: String,
    width: u32,
    height: u32,
}

impl Drawings {
    /// Returns every figure as one picture with its labels, named `PAPER-ITEM-FIGURE.png`.
    #[must_use]
    pub fn sheets(&self, report: &Report) -> Vec<(String, Vec<u8>)> {
        let mut sheets = Vec::new();
        for (item, drawn) in report.items.iter().zip(&self.items) {
            for figure in &drawn.figures {
                if let Some(sheet) = &figure.sheet {
                    let name = format!("{}-{}-{}.png", item.paper, item.item, figure.id);
                    sheets.push((name, sheet.to_png()));
                }
            }
        }
        sheets
    }
}

impl DrawnItem {
    pub(super) fn is_empty(&self) -> bool {
        self.figures.is_empty() && self.plots.is_empty()
    }
}

/// Size of the labels of a figure as one picture, over the side of its panels.
const SHEET_TEXT: f64 = 0.045;

/// Draws everything that a report shows. A picture that cannot be drawn says why in its place.
#[must_use]
pub fn draw(report: &Report, options: DrawingOptions) -> Drawings {
    let domains = Domains::default();
    let items = report.items.par_iter().map(|item| {
        let figures = item.figures.iter();
        let mut plots: Vec<DrawnPlot> = item
            .plots
            .iter()
            .filter_map(|plot| plots::plot(item, plot))
            .collect();
        if item.paper == PaperFacts::ACROSS {
            plots.extend(plots::pareto(item));
        }
        DrawnItem {
            figures: figures
                .map(|figure| draw_figure(item, figure, &domains, options))
                .collect(),
            plots,
        }
    });
    Drawings {
        items: items.collect(),
    }
}

/// A row, and a frame of it where a panel names one.
type SourceKey = (String, Option<usize>);

fn key(panel: &Panel) -> SourceKey {
    (panel.row.clone(), panel.frame)
}

/// Returns what the panels of a figure are drawn from, each loaded once.
fn sources(
    item: &ItemReport,
    figure: &Figure,
    domains: &Domains,
) -> BTreeMap<SourceKey, Result<Source, String>> {
    let mut keys: Vec<SourceKey> = figure.panels.iter().map(key).collect();
    keys.sort_unstable();
    keys.dedup();
    let loaded = keys.into_par_iter().filter_map(|key| {
        let source = source_of(item.row(&key.0)?, key.1, domains);
        Some((key, source))
    });
    loaded.collect()
}

fn draw_figure(
    item: &ItemReport,
    figure: &Figure,
    domains: &Domains,
    options: DrawingOptions,
) -> DrawnFigure {
    let sources = sources(item, figure, domains);
    let panels = figure.panels.iter();
    let subjects: Vec<Result<Subject<'_>, String>> = panels
        .map(|panel| match sources.get(&key(panel)) {
            Some(Ok(source)) => Subject::of(panel, source),
            Some(Err(why)) => Err(why.clone()),
            None => Err(format!("no row {}", panel.row)),
        })
        .collect();
    let scales = Scales::of(&figure.panels, &subjects);
    let places = (0..figure.panels.len()).into_par_iter();
    let (panels, images): (Vec<DrawnPanel>, Vec<Option<Image>>) = places
        .map(|at| {
            draw_panel(
                item,
                (at, &figure.panels[at]),
                &subjects[at],
                &scales,
                options,
            )
        })
        .unzip();
    let columns = figure.columns.clamp(1, 6);
    let sheet = sheet(&panels, &images, columns);
    let common = scales.common.as_ref();
    DrawnFigure {
        id: figure.id.clone(),
        caption: one_line(&figure.caption),
        look_for: one_line(&figure.look_for),
        columns,
        panels,
        bar: common.and_then(|scale| scale.bar()),
        sheet: sheet.map(|sheet| {
            let beside = common.and_then(|scale| scale.beside(&sheet));
            beside.unwrap_or(sheet)
        }),
    }
}

/// Draws the panel `at` for the page, and as it stands in the figure as one picture.
fn draw_panel(
    item: &ItemReport,
    (at, panel): (usize, &Panel),
    subject: &Result<Subject<'_>, String>,
    scales: &Scales,
    options: DrawingOptions,
) -> (DrawnPanel, Option<Image>) {
    let mut drawn = DrawnPanel {
        label: label(item, panel),
        ..DrawnPanel::default()
    };
    let colours = scales.of_panels[at].as_ref().map(|scale| &scale.colours);
    let picture = match subject {
        Ok(subject) => panel::draw(panel, subject, colours, options),
        Err(why) => Err(why.clone()),
    };
    let picture = match picture {
        Ok(picture) => picture,
        Err(why) => {
            drawn.absent = why;
            return (drawn, None);
        }
    };
    drawn.width = picture.image.width();
    drawn.height = picture.image.height();
    drawn.picture = Some(png_address(&picture.image));
    drawn.payload = picture.payload;
    let source = subject.as_ref().ok().map(|subject| subject.source);
    drawn.measure = measure(item, panel, source);
    let beside = scales.beside(at);
    drawn.bar = beside.and_then(|scale| scale.bar());
    let whole = beside.and_then(|scale| scale.beside(&picture.image));
    (drawn, Some(whole.unwrap_or(picture.image)))
}

/// Returns the panels that could be drawn, side by side.
fn sheet(panels: &[DrawnPanel], images: &[Option<Image>], columns: usize) -> Option<Image> {
    let labelled = panels.iter().zip(images);
    let panels: Vec<msplines_picture::Panel<'_>> = labelled
        .filter_map(|(panel, image)| {
            let (image, label) = (image.as_ref()?, panel.label.as_str());
            Some(msplines_picture::Panel { image, label })
        })
        .collect();
    let columns = columns.min(panels.len());
    let side = panels.iter().map(|panel| panel.image.width()).max()?;
    let grid = Grid {
        columns,
        text_size: (SHEET_TEXT * side as f64).max(6.0),
        ..Grid::default()
    };
    grid.compose(&panels).ok()
}

fn source_of(
    report: &RowReport,
    frame: Option<usize>,
    domains: &Domains,
) -> Result<Source, String> {
    match &report.result {
        RowResult::Done(_) => Source::load(report, frame, domains),
        RowResult::NotRun(why) => Err(format!("not run: {why}")),
        RowResult::Failed(why) => Err(format!("failed: {why}")),
    }
}

fn label(item: &ItemReport, panel: &Panel) -> String {
    let of_row = || item.row(&panel.row).map(|report| report.row.label.clone());
    let of_level = || t_spline::label(item.row(&panel.row)?, panel.level?);
    let label = panel.label.clone().or_else(of_level);
    label.or_else(of_row).unwrap_or_default()
}

/// Returns the number behind a picture of a spline.
fn measure(item: &ItemReport, panel: &Panel, source: Option<&Source>) -> String {
    let row = item
        .row(&panel.row)
        .filter(|_| matches!(panel.show, Show::Error | Show::Spline));
    let of_frame = row.filter(|row| row.row.over_time.is_some());
    if let (Some(_), Some(Ok(fitted))) = (of_frame, source.map(|source| &source.fitted)) {
        // The figures of the row are those of all frames.
        return format!("mean error {}", Unit::Fraction.show(fitted.mean_error()));
    }
    let error = row.map(super::error_quantity);
    let Some((unit, ours)) = error.and_then(|quantity| Some((quantity.unit, quantity.ours?)))
    else {
        return String::new();
    };
    let name = match unit {
        Unit::Decibel => "PSNR",
        _ if panel.show == Show::Error => "mean",
        _ => "mean error",
    };
    format!("{name} {}", unit.show(ours))
}

fn png_address(image: &Image) -> String {
    format!("data:image/png;base64,{}", STANDARD.encode(image.to_png()))
}

fn svg_address(svg: &str) -> String {
    format!("data:image/svg+xml;base64,{}", STANDARD.encode(svg))
}
