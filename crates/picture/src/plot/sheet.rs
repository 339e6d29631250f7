//! A sheet of SVG with lines, marks and text at fractions of a pixel.

use plotters::backend::DrawingBackend;
use plotters::prelude::SVGBackend;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{
    Color as _, FontFamily, FontTransform, IntoFont, RGBColor, ShapeStyle, TextStyle,
};

use crate::error::check_option;
use crate::{Anchor, PictureError, Rgb};

/// The backend takes whole numbers, so a pixel is this many units of the drawing.
const UNITS: f64 = 20.0;
/// Largest coordinate in pixels; what lies farther out is moved here.
const FAR: f64 = 1e5;
/// The backend divides sizes of fonts by this number.
const FONT_SIZE: f64 = 1.24;

/// Colours of series, after Okabe and Ito.
const SERIES: [Rgb; 7] = [
    Rgb::new(0, 114, 178),
    Rgb::new(213, 94, 0),
    Rgb::new(0, 158, 115),
    Rgb::new(204, 121, 167),
    Rgb::new(86, 180, 233),
    Rgb::new(230, 159, 0),
    Rgb::new(0, 0, 0),
];

/// Returns the colour of the series of this number; they repeat after seven.
pub(super) fn series_colour(index: usize) -> Rgb {
    SERIES[index % SERIES.len()]
}

/// How a line of text stands on a sheet.
#[derive(Clone, Copy)]
pub(super) struct Lettering {
    /// Height of the font in pixels.
    pub(super) size: f64,
    /// Which part stands at the point.
    pub(super) anchor: Anchor,
    pub(super) weight: Weight,
    pub(super) direction: Direction,
}

/// Weight of letters.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Weight {
    Normal,
    Bold,
}

/// Direction in which a line of text is read.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Direction {
    Right,
    Up,
}

impl Lettering {
    /// Returns plain letters of this size.
    pub(super) const fn new(size: f64, anchor: Anchor) -> Self {
        Self {
            size,
            anchor,
            weight: Weight::Normal,
            direction: Direction::Right,
        }
    }
}

/// A sheet that is being drawn on.
pub(super) struct Sheet<'a> {
    backend: SVGBackend<'a>,
}

/// Returns the SVG of what `draw` puts on a white sheet of this size in pixels.
///
/// # Errors
/// If a side is not 100 to 10,000 pixels, or `draw` fails.
pub(super) fn svg(
    size: [u32; 2],
    draw: impl FnOnce(&mut Sheet<'_>) -> Result<(), PictureError>,
) -> Result<String, PictureError> {
    for side in size {
        let range = |side: f64| (100.0..=10_000.0).contains(&side);
        check_option(
            "size of a plot",
            f64::from(side),
            range,
            "from 100 to 10000 pixels",
        )?;
    }
    let units = size.map(|side| side * UNITS as u32);
    let mut text = String::new();
    let backend = SVGBackend::with_string(&mut text, (units[0], units[1]));
    let mut sheet = Sheet { backend };
    let [width, height] = size.map(f64::from);
    sheet.fill(
        &[[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]],
        Rgb::WHITE,
    );
    draw(&mut sheet)?;
    drop(sheet);
    // The first line names the size in units; a page shall show it in pixels.
    let body = text.split_once('\n').map_or("", |(_, body)| body);
    Ok(format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" \
         viewBox=\"0 0 {} {}\">\n{body}",
        size[0], size[1], units[0], units[1]
    ))
}

impl Sheet<'_> {
    /// Draws a line through points in pixels; points that are not finite are left out.
    pub(super) fn line(&mut self, points: &[[f64; 2]], width: f64, colour: Rgb) {
        self.stroke(points, width, colour, 1.0);
    }

    /// Draws a line that shows what is below.
    pub(super) fn stroke(&mut self, points: &[[f64; 2]], width: f64, colour: Rgb, opacity: f64) {
        let style = ShapeStyle {
            color: rgb(colour).mix(opacity),
            filled: false,
            stroke_width: (width * UNITS).round() as u32,
        };
        let path: Vec<_> = points.iter().filter_map(units).collect();
        settle(self.backend.draw_path(path, &style));
    }

    /// Fills a polygon.
    pub(super) fn fill(&mut self, points: &[[f64; 2]], colour: Rgb) {
        let path: Vec<_> = points.iter().filter_map(units).collect();
        settle(self.backend.fill_polygon(path, &rgb(colour).filled()));
    }

    /// Draws the mark of the series of this number, of the size of a circle of this radius.
    pub(super) fn mark(&mut self, index: usize, at: [f64; 2], radius: f64) {
        let colour = series_colour(index);
        let shape = index % 6;
        if let (0, Some(centre)) = (shape, units(&at)) {
            let radius = (radius * UNITS).round() as u32;
            settle(
                self.backend
                    .draw_circle(centre, radius, &rgb(colour).filled(), true),
            );
            return;
        }
        // Polygons of about the circle's area: square, triangles, diamond, and a star of four rays.
        let (corners, turn, size) = match shape {
            1 => (4, 0.125, 1.25),
            2 => (3, 0.25, 1.5),
            3 => (4, 0.0, 1.35),
            4 => (3, 0.75, 1.5),
            _ => (8, 0.0, 1.7),
        };
        let corner = |i: usize| {
            let angle = std::f64::consts::TAU * (turn + i as f64 / corners as f64);
            let waist = if corners == 8 && i % 2 == 1 {
                0.42
            } else {
                1.0
            };
            let reach = radius * size * waist;
            [at[0] + reach * angle.cos(), at[1] - reach * angle.sin()]
        };
        let outline: Vec<_> = (0..corners).map(corner).collect();
        self.fill(&outline, colour);
    }

    /// Writes a line of text; `at` is at the middle of its height.
    pub(super) fn text(&mut self, text: &str, at: [f64; 2], lettering: Lettering) {
        let Some(at) = units(&at) else {
            return;
        };
        let clean: String = text.chars().filter(|c| is_xml(*c)).collect();
        let horizontal = match lettering.anchor {
            Anchor::Left => HPos::Left,
            Anchor::Centre => HPos::Center,
            Anchor::Right => HPos::Right,
        };
        let font = (FontFamily::SansSerif, lettering.size * UNITS * FONT_SIZE).into_font();
        let font = match lettering.weight {
            Weight::Normal => font,
            Weight::Bold => font.style(plotters::style::FontStyle::Bold),
        };
        let font = match lettering.direction {
            Direction::Right => font,
            Direction::Up => font.transform(FontTransform::Rotate270),
        };
        let ink = rgb(Rgb::INK);
        let style = TextStyle::from(font)
            .color(&ink)
            .pos(Pos::new(horizontal, VPos::Center));
        settle(self.backend.draw_text(&clean, &style, at));
    }
}

/// Drawing into a string cannot fail, so there is no error to pass on.
fn settle<T, E>(result: Result<T, E>) {
    drop(result);
}

/// Returns whether a character may stand in XML 1.0 and is no line break.
fn is_xml(character: char) -> bool {
    !character.is_control() && !matches!(character, '\u{FFFE}' | '\u{FFFF}')
}

fn rgb(colour: Rgb) -> RGBColor {
    RGBColor(colour.red, colour.green, colour.blue)
}

/// Returns the backend's whole numbers for a point in pixels; `None` if it is not finite.
fn units(point: &[f64; 2]) -> Option<(i32, i32)> {
    let finite = point.iter().all(|c| c.is_finite());
    let [x, y] = point.map(|c| (c.clamp(-FAR, FAR) * UNITS).round() as i32);
    finite.then_some((x, y))
}
