//! Horizontal bars, such as running times.

use super::Quantity;
use super::curves::{GRID, LABEL, TICK, TITLE, WIDER};
use super::sheet::{self, Lettering, Sheet, Weight, series_colour};
use super::track::{self, Track};
use crate::ticks::scientific;
use crate::{Anchor, PictureError, Rgb, text_width};

/// A bar of a chart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bar<'a> {
    /// What it stands for.
    pub name: &'a str,
    /// How long it is; one that is not finite has no bar.
    pub value: f64,
    /// Number of its colour: bars of a kind share one.
    pub kind: usize,
}

/// A chart of horizontal bars from zero, or from a power of ten on a logarithmic axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bars<'a> {
    /// A line above the chart; may be empty.
    pub title: &'a str,
    /// What the lengths measure.
    pub quantity: Quantity<'a>,
    /// The bars from top to bottom.
    pub bars: &'a [Bar<'a>],
    /// Width in pixels; the height follows from the number of bars.
    pub width: u32,
}

impl<'a> Bars<'a> {
    /// Returns a chart 680 pixels wide without a title.
    #[must_use]
    pub const fn new(quantity: Quantity<'a>, bars: &'a [Bar<'a>]) -> Self {
        Self {
            title: "",
            quantity,
            bars,
            width: 680,
        }
    }

    /// Returns the chart as an SVG file; the same chart gives the same text.
    ///
    /// # Errors
    /// If no bar is finite, a logarithmic axis has one that is not positive, or the chart is not
    /// 100 to 10,000 pixels wide and high.
    pub fn to_svg(&self) -> Result<String, PictureError> {
        for bar in self.bars {
            track::check(&self.quantity, bar.name, std::iter::once(bar.value))?;
        }
        let top = if self.title.is_empty() {
            14.0
        } else {
            14.0 + 1.5 * TITLE
        };
        let bottom = top + ROW * self.bars.len() as f64;
        // The cast saturates, and the sheet refuses what is too high.
        let height = (bottom + 2.9 * TICK + 14.0).max(LEAST) as u32;
        sheet::svg([self.width, height], |sheet| {
            let [left, right] = self.sides();
            let values = self.bars.iter().map(|bar| bar.value);
            let track = Track::from_base(values, &self.quantity, [left, right])?;
            self.axis(&track, [top, bottom], sheet);
            for (index, bar) in self.bars.iter().enumerate() {
                let middle = top + ROW * (index as f64 + 0.5);
                draw_bar(bar, &track, middle, left, sheet);
            }
            Ok(())
        })
    }

    /// Returns the places between which bars may extend, with space for their names and values.
    fn sides(&self) -> [f64; 2] {
        let width = f64::from(self.width);
        let widest = |texts: &mut dyn Iterator<Item = f64>| texts.fold(0.0, f64::max);
        let names = widest(&mut self.bars.iter().map(|bar| text_width(bar.name, TICK)));
        let values = self
            .bars
            .iter()
            .map(|bar| text_width(&scientific(bar.value), TICK));
        let values = widest(&mut values.into_iter());
        let left = (24.0 + WIDER * names).min(0.6 * width);
        [
            left,
            (width - 20.0 - WIDER * values).max(left + 0.1 * width),
        ]
    }

    fn axis(&self, track: &Track, [top, bottom]: [f64; 2], sheet: &mut Sheet<'_>) {
        let middle = f64::from(self.width) / 2.0;
        let title = Lettering {
            weight: Weight::Bold,
            ..Lettering::new(TITLE, Anchor::Centre)
        };
        sheet.text(self.title, [middle, 14.0 + 0.6 * TITLE], title);
        let [left, right] = self.sides();
        let ticks = track.ticks(((right - left) / 80.0) as usize);
        for (value, label) in ticks.values.iter().zip(&ticks.labels) {
            let x = track.place(*value);
            sheet.line(&[[x, top], [x, bottom]], 1.0, GRID);
            let at = [x, bottom + 0.9 * TICK];
            sheet.text(label, at, Lettering::new(TICK, Anchor::Centre));
        }
        let at = [(left + right) / 2.0, bottom + 2.2 * TICK];
        let label = ticks.title(self.quantity.label);
        sheet.text(&label, at, Lettering::new(LABEL, Anchor::Centre));
        let base = track.base();
        sheet.line(&[[base, top], [base, bottom]], 1.4, Rgb::INK);
    }
}

/// Height of a row and of the bar in it, in pixels.
const ROW: f64 = 32.0;
const THICKNESS: f64 = 20.0;
/// Least height of a chart in pixels.
const LEAST: f64 = 100.0;

fn draw_bar(bar: &Bar<'_>, track: &Track, middle: f64, left: f64, sheet: &mut Sheet<'_>) {
    let name = Lettering::new(TICK, Anchor::Right);
    sheet.text(bar.name, [left - 10.0, middle], name);
    let lettering = Lettering::new(TICK, Anchor::Left);
    if !bar.value.is_finite() {
        sheet.text("–", [track.base() + 8.0, middle], lettering);
        return;
    }
    let [from, to] = [track.base(), track.place(bar.value)];
    let [top, bottom] = [middle - THICKNESS / 2.0, middle + THICKNESS / 2.0];
    let corners = [[from, top], [to, top], [to, bottom], [from, bottom]];
    sheet.fill(&corners, series_colour(bar.kind));
    let end = [from.max(to) + 8.0, middle];
    sheet.text(&scientific(bar.value), end, lettering);
}
