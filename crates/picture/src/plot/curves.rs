//! Series of points over an axis.

use super::Quantity;
use super::sheet::{self, Direction, Lettering, Sheet, Weight, series_colour};
use super::track::{self, Track};
use crate::{Anchor, PictureError, Rgb, text_width};

/// What is drawn for the points of a series.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Look {
    /// A line through the points in the given order, and a mark at each.
    #[default]
    LineAndMarks,
    /// A line alone: for many points.
    Line,
    /// Marks alone: for points without an order.
    Marks,
}

/// Points with a name in the legend, a colour and a shape of mark.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Series<'a> {
    /// Name in the legend; without one the series is left out there.
    pub name: &'a str,
    /// Points (x, y); one that is not finite interrupts the line.
    pub points: &'a [[f64; 2]],
    /// What is drawn for them.
    pub look: Look,
}

impl<'a> Series<'a> {
    /// Returns a series with a line and marks.
    #[must_use]
    pub const fn new(name: &'a str, points: &'a [[f64; 2]]) -> Self {
        Self {
            name,
            points,
            look: Look::LineAndMarks,
        }
    }
}

/// Text beside a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Note<'a> {
    /// The point (x, y).
    pub at: [f64; 2],
    /// The text; it is put where it covers least.
    pub text: &'a str,
}

/// A broad line below the series, such as a Pareto front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Highlight<'a> {
    /// Name in the legend; may be empty.
    pub name: &'a str,
    /// Points (x, y) in order.
    pub points: &'a [[f64; 2]],
}

/// Several series over the same axes. The axes span all points.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot<'a> {
    /// A line above the plot; may be empty.
    pub title: &'a str,
    /// Quantity to the right.
    pub x: Quantity<'a>,
    /// Quantity upwards.
    pub y: Quantity<'a>,
    /// The series, in the order of their colours.
    pub series: Vec<Series<'a>>,
    /// Texts beside points.
    pub notes: Vec<Note<'a>>,
    /// A broad line below the series.
    pub highlight: Option<Highlight<'a>>,
    /// Width and height in pixels.
    pub size: [u32; 2],
}

impl Default for Plot<'_> {
    fn default() -> Self {
        Self {
            title: "",
            x: Quantity::default(),
            y: Quantity::default(),
            series: Vec::new(),
            notes: Vec::new(),
            highlight: None,
            size: [680, 480],
        }
    }
}

/// Sizes of letters in pixels: large enough on a phone that shows a plot at half its size.
pub(super) const TITLE: f64 = 22.0;
pub(super) const LABEL: f64 = 19.0;
pub(super) const TICK: f64 = 17.0;
/// Letters of other fonts may be wider than those that widths are taken from.
pub(super) const WIDER: f64 = 1.12;
const MARK: f64 = 5.5;
const LINE: f64 = 2.2;
pub(super) const GRID: Rgb = Rgb::new(226, 228, 232);
const HIGHLIGHT: Rgb = Rgb::new(240, 228, 66);

/// The part of the sheet between the axes.
struct Area {
    x: Track,
    y: Track,
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

/// An entry of the legend: the number of its series, or none for the highlighted line.
struct Entry<'a> {
    name: &'a str,
    series: Option<usize>,
    at: [f64; 2],
}

impl<'a> Plot<'a> {
    /// Returns the plot as an SVG file; the same plot gives the same text.
    ///
    /// # Errors
    /// If no point is finite, a logarithmic axis has a value that is not positive, or a side is not
    /// 100 to 10,000 pixels.
    pub fn to_svg(&self) -> Result<String, PictureError> {
        for (name, points) in self.all() {
            track::check(&self.x, name, points.iter().map(|p| p[0]))?;
            track::check(&self.y, name, points.iter().map(|p| p[1]))?;
        }
        sheet::svg(self.size, |sheet| {
            let (legend, top) = self.legend();
            let area = self.area(top)?;
            self.axes(&area, sheet);
            self.draw_legend(&legend, sheet);
            self.draw_series(&area, sheet);
            self.draw_notes(&area, sheet);
            Ok(())
        })
    }

    /// Returns the names and points of everything that axes must span.
    fn all(&self) -> impl Iterator<Item = (&'a str, &'a [[f64; 2]])> {
        let series = self
            .series
            .iter()
            .map(|series| (series.name, series.points));
        series.chain(self.highlight.iter().map(|line| (line.name, line.points)))
    }

    /// Returns the entries of the legend in rows below the title, and where the rows end.
    fn legend(&self) -> (Vec<Entry<'a>>, f64) {
        let top = if self.title.is_empty() {
            14.0
        } else {
            14.0 + 1.5 * TITLE
        };
        let series = self.series.iter().enumerate();
        let names = series.map(|(index, series)| (series.name, Some(index)));
        let names = names.chain(self.highlight.iter().map(|line| (line.name, None)));
        let mut entries = Vec::new();
        let [mut x, mut y] = [20.0, top + 0.7 * TICK];
        for (name, series) in names.filter(|(name, _)| !name.is_empty()) {
            let width = 46.0 + WIDER * text_width(name, TICK) + 14.0;
            if x > 20.0 && x + width > f64::from(self.size[0]) {
                [x, y] = [20.0, y + 1.5 * TICK];
            }
            let at = [x, y];
            entries.push(Entry { name, series, at });
            x += width;
        }
        let end = if entries.is_empty() { top } else { y + TICK };
        (entries, end)
    }

    fn area(&self, top: f64) -> Result<Area, PictureError> {
        let [width, height] = self.size.map(f64::from);
        let bottom = height - 14.0 - 2.9 * TICK;
        let ys = || self.all().flat_map(|(_, points)| points).map(|p| p[1]);
        let xs = || self.all().flat_map(|(_, points)| points).map(|p| p[0]);
        let top = top + 10.0;
        let y = Track::around(ys(), &self.y, [bottom, top])?;
        let widest = y
            .ticks(6)
            .labels
            .iter()
            .map(|l| text_width(l, TICK))
            .fold(0.0, f64::max);
        let left = 14.0 + 1.6 * LABEL + WIDER * widest + 10.0;
        let right = width - 24.0;
        let x = Track::around(xs(), &self.x, [left, right])?;
        Ok(Area {
            x,
            y,
            left,
            right,
            top,
            bottom,
        })
    }

    fn axes(&self, area: &Area, sheet: &mut Sheet<'_>) {
        let [width, height] = self.size.map(f64::from);
        let title = Lettering {
            weight: Weight::Bold,
            ..Lettering::new(TITLE, Anchor::Centre)
        };
        sheet.text(self.title, [width / 2.0, 14.0 + 0.6 * TITLE], title);
        let across = area.x.ticks(((area.right - area.left) / 80.0) as usize);
        for (value, label) in across.values.iter().zip(&across.labels) {
            let x = area.x.place(*value);
            sheet.line(&[[x, area.top], [x, area.bottom]], 1.0, GRID);
            let at = [x, area.bottom + 0.9 * TICK];
            sheet.text(label, at, Lettering::new(TICK, Anchor::Centre));
        }
        let up = area.y.ticks(6);
        for (value, label) in up.values.iter().zip(&up.labels) {
            let y = area.y.place(*value);
            sheet.line(&[[area.left, y], [area.right, y]], 1.0, GRID);
            sheet.text(
                label,
                [area.left - 8.0, y],
                Lettering::new(TICK, Anchor::Right),
            );
        }
        let corner = [area.left, area.bottom];
        sheet.line(
            &[[area.left, area.top], corner, [area.right, area.bottom]],
            1.4,
            Rgb::INK,
        );
        let middle = [(area.left + area.right) / 2.0, height - 8.0 - 0.6 * LABEL];
        let label = Lettering::new(LABEL, Anchor::Centre);
        sheet.text(&across.title(self.x.label), middle, label);
        let upwards = Lettering {
            direction: Direction::Up,
            ..label
        };
        let side = [10.0 + 0.6 * LABEL, (area.top + area.bottom) / 2.0];
        sheet.text(&up.title(self.y.label), side, upwards);
    }

    fn draw_legend(&self, entries: &[Entry<'_>], sheet: &mut Sheet<'_>) {
        for entry in entries {
            let [x, y] = entry.at;
            let sample = [[x, y], [x + 36.0, y]];
            match entry.series.map(|index| (index, self.series[index].look)) {
                None => sheet.stroke(&sample, 10.0, HIGHLIGHT, 0.8),
                Some((index, look)) => {
                    if look != Look::Marks {
                        sheet.line(&sample, LINE, series_colour(index));
                    }
                    if look != Look::Line {
                        sheet.mark(index, [x + 18.0, y], MARK);
                    }
                }
            }
            sheet.text(
                entry.name,
                [x + 44.0, y],
                Lettering::new(TICK, Anchor::Left),
            );
        }
    }

    fn draw_series(&self, area: &Area, sheet: &mut Sheet<'_>) {
        if let Some(line) = &self.highlight {
            for run in area.runs(line.points) {
                sheet.stroke(&run, 10.0, HIGHLIGHT, 0.8);
            }
        }
        for (index, series) in self.series.iter().enumerate() {
            for run in area.runs(series.points) {
                // A run of one point is no line.
                if series.look != Look::Marks && run.len() > 1 {
                    sheet.line(&run, LINE, series_colour(index));
                }
                if series.look != Look::Line {
                    run.iter().for_each(|at| sheet.mark(index, *at, MARK));
                }
            }
        }
    }

    /// Writes each note on that side of its point where it covers the fewest points and notes.
    fn draw_notes(&self, area: &Area, sheet: &mut Sheet<'_>) {
        let points = self.all().flat_map(|(_, points)| points);
        let mut taken: Vec<[f64; 4]> = points
            .map(|p| [area.x.place(p[0]), area.y.place(p[1])])
            .map(|[x, y]| [x - MARK, y - MARK, x + MARK, y + MARK])
            .collect();
        for note in &self.notes {
            let [x, y] = [area.x.place(note.at[0]), area.y.place(note.at[1])];
            let width = WIDER * text_width(note.text, TICK);
            let boxes = [[1.0, -1.0], [-1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[side, over]| {
                let near = x + side * 1.6 * MARK;
                let [left, right] = if side > 0.0 {
                    [near, near + width]
                } else {
                    [near - width, near]
                };
                let middle = y + over * (MARK + 0.5 * TICK);
                [left, middle - 0.55 * TICK, right, middle + 0.55 * TICK]
            });
            let cost = |area_box: &[f64; 4]| {
                let hits = taken
                    .iter()
                    .filter(|other| overlap(area_box, other))
                    .count();
                let outside = area_box[0] < area.left
                    || area_box[2] > area.right
                    || area_box[1] < area.top - TICK
                    || area_box[3] > area.bottom;
                hits + if outside { taken.len() + 1 } else { 0 }
            };
            // The first of the best, so that equal places do not depend on anything else.
            let mut best = boxes[0];
            for candidate in boxes {
                if cost(&candidate) < cost(&best) {
                    best = candidate;
                }
            }
            let at = [best[0], (best[1] + best[3]) / 2.0];
            sheet.text(note.text, at, Lettering::new(TICK, Anchor::Left));
            taken.push(best);
        }
    }
}

impl Area {
    /// Returns the places of points, cut where a point is not finite.
    fn runs(&self, points: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
        let parts = points.split(|p| !p.iter().all(|c| c.is_finite()));
        let places = parts.filter(|part| !part.is_empty());
        let place = |p: &[f64; 2]| [self.x.place(p[0]), self.y.place(p[1])];
        places
            .map(|part| part.iter().map(place).collect())
            .collect()
    }
}

/// Returns whether two boxes (left, top, right, bottom) have an inner point in common.
fn overlap(a: &[f64; 4], b: &[f64; 4]) -> bool {
    a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]
}
