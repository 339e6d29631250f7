//! A bar that says which number a colour stands for.

use crate::colour_map::{ColourScale, Spacing};
use crate::error::{PictureError, check_text_size};
use crate::ticks::Ticks;
use crate::{Image, Rect, Rgb, TextStyle, text_width};

/// A colour bar to the right of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColourBar<'a> {
    /// The scale that the picture was painted with.
    pub scale: ColourScale,
    /// What is measured and its unit, written above the bar; may be empty.
    pub label: &'a str,
    /// Size of the text in pixels; the bar is as wide.
    pub text_size: f64,
    /// Colour behind bar and text.
    pub background: Rgb,
}

impl<'a> ColourBar<'a> {
    /// Returns a bar on white with text of 24 pixels.
    #[must_use]
    pub fn new(scale: ColourScale, label: &'a str) -> Self {
        Self {
            scale,
            label,
            text_size: TextStyle::default().size,
            background: Rgb::WHITE,
        }
    }

    /// Returns the picture with the bar to its right; the marks are round numbers.
    ///
    /// # Errors
    /// If the range of the scale makes no sense, the text size is not 6 to 200 pixels, or the whole
    /// becomes too large.
    pub fn beside(&self, image: &Image) -> Result<Image, PictureError> {
        self.scale.check()?;
        let size = self.text_size;
        check_text_size(size)?;
        let ticks = self.ticks(image.height() as f64);
        let title = ticks.title(self.label);
        let widest = ticks
            .labels
            .iter()
            .map(|l| text_width(l, size))
            .fold(0.0, f64::max);
        let strip = (widest + 2.4 * size).max(text_width(&title, size) + size);
        let width = image.width() + strip.ceil() as usize;
        let mut whole = Image::new(width, image.height(), self.background)?;
        whole.paste(image, 0, 0);
        self.paint(&mut whole, image.width(), &ticks, &title);
        Ok(whole)
    }

    fn ticks(&self, height: f64) -> Ticks {
        // Marks are at least two and a half lines apart.
        let most = ((0.7 * height / (2.5 * self.text_size)) as usize).clamp(1, 6);
        match self.scale.spacing {
            Spacing::Linear => Ticks::linear(self.scale.range, most),
            Spacing::Logarithmic => Ticks::logarithmic(self.scale.range, most.max(2)),
        }
    }

    fn paint(&self, whole: &mut Image, left: usize, ticks: &Ticks, title: &str) {
        let size = self.text_size;
        let height = whole.height();
        let bar = Rect {
            x: left + (0.4 * size) as usize,
            y: (0.15 * height as f64) as usize,
            width: size as usize,
            height: ((0.7 * height as f64) as usize).max(1),
        };
        for row in 0..bar.height {
            let place = 1.0 - (row as f64 + 0.5) / bar.height as f64;
            let line = Rect {
                y: bar.y + row,
                height: 1,
                ..bar
            };
            whole.fill(line, self.scale.map.colour(place));
        }
        whole.frame(bar, 1, Rgb::INK);
        let style = TextStyle {
            size,
            ..TextStyle::default()
        };
        let right = (bar.x + bar.width) as f64;
        for (value, label) in ticks.values.iter().zip(&ticks.labels) {
            let place = self.scale.place(*value).clamp(0.0, 1.0);
            let y = bar.y as f64 + 0.5 + (1.0 - place) * (bar.height as f64 - 1.0);
            whole.line([right, y], [right + 0.25 * size, y], 1.2, Rgb::INK);
            // A third of the size above the baseline is the middle of a digit.
            whole.text(label, [right + 0.45 * size, y + 0.34 * size], &style);
        }
        whole.text(title, [bar.x as f64, bar.y as f64 - 0.8 * size], &style);
    }
}

#[cfg(test)]
mod tests {
    use super::ColourBar;
    use crate::{ColourMap, ColourScale, Image, Rgb};

    #[test]
    fn the_bar_shows_the_scale_from_top_to_bottom() {
        let image = Image::new(100, 400, Rgb::SKY).expect("a size");
        let scale = ColourScale::linear(ColourMap::Viridis, [0.0, 1.0]);
        let whole = ColourBar::new(scale, "error")
            .beside(&image)
            .expect("a bar");
        assert_eq!(whole.pixel(50, 200), Some(Rgb::SKY));
        let bar = |y: usize| whole.pixel(100 + 20, y).expect("inside");
        assert!(bar(63).green > 200 && bar(336).green < 40);
        assert_eq!(bar(10).channels()[0], 255);
    }

    #[test]
    fn ticks_shrink_with_the_picture_and_never_fail() {
        let scale = ColourScale::logarithmic(ColourMap::Magma, [1e-7, 1e-2]);
        for height in [1, 10, 50, 1000] {
            let image = Image::new(1, height, Rgb::WHITE).expect("a size");
            assert!(ColourBar::new(scale, "").beside(&image).is_ok());
        }
        let image = Image::new(9, 9, Rgb::WHITE).expect("a size");
        let wrong = ColourScale::linear(ColourMap::Magma, [f64::NAN, 1.0]);
        assert!(ColourBar::new(wrong, "").beside(&image).is_err());
    }

    #[test]
    fn a_common_power_of_ten_stands_in_the_title() {
        let bar = ColourBar::new(ColourScale::linear(ColourMap::ColdWarm, [0.0, 3e-6]), "mm");
        assert_eq!(bar.ticks(500.0).title(bar.label), "mm (×10⁻⁶)");
    }
}
