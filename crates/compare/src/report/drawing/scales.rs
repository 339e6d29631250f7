//! The colour scales of a figure, and the bars that explain them.

use msplines_picture::{ColourBar, ColourMap, ColourScale, Image, Rgb};
use serde::Serialize;

use super::png_address;
use super::values::{Measure, Subject, Values};
use crate::experiment::{FieldColours, FieldScale, Panel};

/// Share of the vertices whose errors the colour scale of a figure spans.
const SPANNED: f64 = 0.98;
/// What stands above the scale of errors.
const ERRORS: &str = "% of diagonal";
/// What stands above the scale of errors of colours.
const COLOUR_ERRORS: &str = "% of a channel";
/// Height of a bar beside the panels of a page in pixels, drawn twice as large.
const BAR_HEIGHT: usize = 480;

/// A scale and what it measures.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Scale {
    pub(super) colours: ColourScale,
    pub(super) label: String,
}

/// A bar for the page.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Bar {
    picture: String,
    width: usize,
    height: usize,
    label: String,
}

/// The scales of a figure.
pub(super) struct Scales {
    /// That of each panel; none where nothing is measured, or all errors are zero.
    pub(super) of_panels: Vec<Option<Scale>>,
    /// The one of all panels that have any, where there is only one: it is explained once.
    pub(super) common: Option<Scale>,
}

/// Panels with the same key have the same scale; the index is that of a panel with its own.
type Key<'a> = (&'a Measure, Option<usize>);

impl Scales {
    /// Returns the scales of panels and of what they show.
    pub(super) fn of(panels: &[Panel], subjects: &[Result<Subject<'_>, String>]) -> Self {
        let keyed: Vec<Option<(Key<'_>, &Subject<'_>)>> = panels
            .iter()
            .zip(subjects)
            .enumerate()
            .map(|(index, (panel, subject))| {
                let subject = subject.as_ref().ok()?;
                let Values::Scalars { measure, .. } = &subject.values else {
                    return None;
                };
                let is_own = panel.scale == Some(FieldScale::Own);
                Some(((measure, is_own.then_some(index)), subject))
            })
            .collect();
        let scale_of = |key: Key<'_>| {
            let same = keyed.iter().flatten().filter(|(other, _)| *other == key);
            scale(key.0, same.map(|(_, subject)| *subject))
        };
        let of_panels: Vec<Option<Scale>> = keyed
            .iter()
            .map(|keyed| keyed.and_then(|(key, _)| scale_of(key)))
            .collect();
        let mut known: Vec<Key<'_>> = Vec::new();
        for (key, _) in keyed.iter().flatten() {
            if !known.contains(key) {
                known.push(*key);
            }
        }
        let common = match known.as_slice() {
            [key] => scale_of(*key),
            _ => None,
        };
        Self { of_panels, common }
    }

    /// Returns the scale that has to be explained beside the panel `index`.
    pub(super) fn beside(&self, index: usize) -> Option<&Scale> {
        let own = self.of_panels.get(index)?.as_ref();
        own.filter(|_| self.common.is_none())
    }
}

fn scale<'a>(measure: &Measure, subjects: impl Iterator<Item = &'a Subject<'a>>) -> Option<Scale> {
    match measure {
        Measure::Error | Measure::ColourError => {
            let fitted = subjects.filter_map(|subject| subject.source.fitted.as_ref().ok());
            let highest = fitted
                .map(|fitted| 100.0 * fitted.error_quantile(SPANNED))
                .fold(0.0, f64::max);
            (highest > 0.0).then(|| Scale {
                colours: ColourScale::linear(ColourMap::ColdWarm, [0.0, highest]),
                label: if *measure == Measure::Error {
                    ERRORS.to_owned()
                } else {
                    COLOUR_ERRORS.to_owned()
                },
            })
        }
        Measure::Field {
            name,
            colours,
            span,
        } => {
            let mut sorted: Vec<f64> = Vec::new();
            for subject in subjects {
                if let Values::Scalars { values, .. } = &subject.values {
                    sorted.extend(values.iter().filter(|value| value.is_finite()));
                }
            }
            let [low, high] = middle(&mut sorted, *span)?;
            let furthest = high.max(-low);
            Some(Scale {
                colours: match colours {
                    FieldColours::Diverging => {
                        ColourScale::linear(ColourMap::Diverging, [-furthest, furthest])
                    }
                    _ => ColourScale::linear(ColourMap::Viridis, [low, high]),
                },
                label: name.replace('_', " "),
            })
        }
    }
}

/// Returns the ends of the middle share `span` of numbers.
fn middle(numbers: &mut [f64], span: f64) -> Option<[f64; 2]> {
    numbers.sort_by(f64::total_cmp);
    let last = numbers.len().checked_sub(1)?;
    let left_out = 0.5 * (1.0 - span) * last as f64;
    let cut = (left_out.round() as usize).min(last / 2);
    Some([numbers[cut], numbers[last - cut]])
}

impl Scale {
    /// Returns a picture with the bar to its right.
    pub(super) fn beside(&self, image: &Image) -> Option<Image> {
        ColourBar::new(self.colours, &self.label).beside(image).ok()
    }

    /// Returns the bar for the page.
    pub(super) fn bar(&self) -> Option<Bar> {
        let nothing = Image::new(2, BAR_HEIGHT, Rgb::WHITE).ok()?;
        let image = self.beside(&nothing)?;
        Some(Bar {
            picture: png_address(&image),
            width: image.width() / 2,
            height: image.height() / 2,
            label: self.label.clone(),
        })
    }
}
