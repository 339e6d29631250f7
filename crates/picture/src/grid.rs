//! Pictures side by side, each with its label.

use crate::error::{PictureError, check_option, check_text_size};
use crate::{Anchor, Image, Rgb, TextStyle};

/// A picture of a grid and what is written beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Panel<'a> {
    /// The picture.
    pub image: &'a Image,
    /// A line of text; may be empty.
    pub label: &'a str,
}

/// Where the labels of a grid stand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LabelPlace {
    /// Above each picture.
    Above,
    /// Below each picture, as in papers.
    #[default]
    Below,
}

/// How pictures are arranged in rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Pictures in a row.
    pub columns: usize,
    /// Space between pictures and around all, in pixels.
    pub gap: usize,
    /// Size of the labels in pixels.
    pub text_size: f64,
    /// Where the labels stand.
    pub place: LabelPlace,
    /// Colour between the pictures.
    pub background: Rgb,
}

impl Default for Grid {
    fn default() -> Self {
        Self {
            columns: 3,
            gap: 12,
            text_size: 30.0,
            place: LabelPlace::Below,
            background: Rgb::WHITE,
        }
    }
}

/// Height of a line of labels in text sizes.
const LINE: f64 = 1.5;

impl Grid {
    /// Returns the panels in rows from the upper left; all cells are as large as the largest
    /// picture, and pictures stand in the middle of their cells.
    ///
    /// # Errors
    /// If there are no panels or no columns, the text size is not 6 to 200 pixels, or the whole
    /// becomes too large.
    pub fn compose(&self, panels: &[Panel<'_>]) -> Result<Image, PictureError> {
        let size = self.text_size;
        check_option("columns", self.columns as f64, |c| c >= 1.0, "at least 1")?;
        check_text_size(size)?;
        let across = panels.iter().map(|p| p.image.width()).max().unwrap_or(0);
        let down = panels.iter().map(|p| p.image.height()).max().unwrap_or(0);
        if panels.is_empty() {
            return Err(PictureError::Empty {
                width: across,
                height: down,
            });
        }
        let labelled = panels.iter().any(|panel| !panel.label.is_empty());
        let line = if labelled { (LINE * size) as usize } else { 0 };
        let columns = self.columns.min(panels.len());
        let rows = panels.len().div_ceil(columns);
        let [step_x, step_y] = [across, down + line].map(|side| side.saturating_add(self.gap));
        let width = columns.saturating_mul(step_x).saturating_add(self.gap);
        let height = rows.saturating_mul(step_y).saturating_add(self.gap);
        let mut whole = Image::new(width, height, self.background)?;
        for (index, panel) in panels.iter().enumerate() {
            let x = self.gap + index % columns * step_x;
            let y = self.gap + index / columns * step_y;
            let [free_x, free_y] = [across - panel.image.width(), down - panel.image.height()];
            let (top, baseline) = match self.place {
                LabelPlace::Above => (y + line, y as f64 + size),
                LabelPlace::Below => (y, (y + down) as f64 + size),
            };
            whole.paste(panel.image, x + free_x / 2, top + free_y / 2);
            let style = TextStyle {
                size,
                anchor: Anchor::Centre,
                ..TextStyle::default()
            };
            let middle = (x + across / 2) as f64;
            whole.text(panel.label, [middle, baseline], &style);
        }
        Ok(whole)
    }
}

#[cfg(test)]
mod tests {
    use super::{Grid, LabelPlace, Panel};
    use crate::{Image, PictureError, Rgb};

    #[test]
    fn panels_fill_rows_and_stand_in_the_middle() {
        let [large, small] = [40, 20].map(|side| Image::new(side, side, Rgb::RED).expect("a size"));
        let panels = [&large, &small, &large].map(|image| Panel { image, label: "" });
        let grid = Grid {
            columns: 2,
            gap: 10,
            ..Grid::default()
        };
        let whole = grid.compose(&panels).expect("a grid");
        assert_eq!((whole.width(), whole.height()), (110, 110));
        assert_eq!(whole.pixel(10, 10), Some(Rgb::RED));
        assert_eq!(whole.pixel(69, 30), Some(Rgb::WHITE));
        assert_eq!(whole.pixel(70, 20), Some(Rgb::RED));
        assert_eq!(whole.pixel(80, 80), Some(Rgb::WHITE));
    }

    #[test]
    fn labels_take_a_line_below_or_above() {
        let image = Image::new(60, 40, Rgb::SKY).expect("a size");
        for place in [LabelPlace::Above, LabelPlace::Below] {
            let grid = Grid {
                place,
                gap: 0,
                text_size: 20.0,
                ..Grid::default()
            };
            let whole = grid
                .compose(&[Panel {
                    image: &image,
                    label: "a)",
                }])
                .expect("a grid");
            assert_eq!((whole.width(), whole.height()), (60, 70));
            let dark = |rows: std::ops::Range<usize>| {
                rows.flat_map(|y| (0..60).map(move |x| (x, y)))
                    .any(|(x, y)| whole.pixel(x, y).is_some_and(|p| p.red < 100))
            };
            assert_eq!(dark(0..30), place == LabelPlace::Above);
            assert_eq!(dark(40..70), place == LabelPlace::Below);
        }
    }

    #[test]
    fn nothing_to_arrange_is_an_error() {
        let grid = Grid::default();
        assert_eq!(
            grid.compose(&[]),
            Err(PictureError::Empty {
                width: 0,
                height: 0
            })
        );
        let image = Image::new(1, 1, Rgb::SKY).expect("a size");
        let huge = Grid {
            gap: usize::MAX,
            ..grid
        };
        assert!(
            huge.compose(&[Panel {
                image: &image,
                label: ""
            }])
            .is_err()
        );
        let none = Grid { columns: 0, ..grid };
        assert!(
            none.compose(&[Panel {
                image: &image,
                label: ""
            }])
            .is_err()
        );
    }
}
