//! A magnified part of a picture in one of its corners.

use crate::error::{PictureError, check_option};
use crate::{Detail, Image, Rect, Rgb};

/// A corner of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Corner {
    /// Upper left.
    TopLeft,
    /// Upper right.
    TopRight,
    /// Lower left.
    BottomLeft,
    /// Lower right.
    #[default]
    BottomRight,
}

/// A frame around a part of a picture, the part magnified in a corner, and a line between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Callout {
    /// The part in pixels of the picture.
    pub source: Rect,
    /// Pixels in the corner per pixel of the part.
    pub magnification: usize,
    /// Where the magnified part goes.
    pub corner: Corner,
    /// Colour of both frames and the line.
    pub colour: Rgb,
    /// Width of the frames in pixels.
    pub thickness: usize,
}

impl Callout {
    /// Returns a callout of this part, four times as large, in red in the lower right corner.
    #[must_use]
    pub fn new(source: Rect) -> Self {
        Self {
            source,
            magnification: 4,
            corner: Corner::default(),
            colour: Rgb::RED,
            thickness: 3,
        }
    }

    /// Returns what [`Drawing::detail`](crate::Drawing::detail) needs to draw the part anew, which
    /// is sharper than pixels magnified.
    #[must_use]
    pub fn detail(&self) -> Detail {
        Detail {
            source: self.source,
            magnification: self.magnification,
        }
    }

    /// Returns the picture with the part's own pixels magnified in the corner.
    ///
    /// # Errors
    /// If the part holds no pixel of the picture, or its magnification is not 1 to 64.
    pub fn enlarge(&self, image: &Image) -> Result<Image, PictureError> {
        let range = |m: f64| (1.0..=64.0).contains(&m);
        check_option(
            "magnification",
            self.magnification as f64,
            range,
            "from 1 to 64",
        )?;
        let source = self.inside(image)?;
        let magnified = magnify(image, source, self.magnification)?;
        self.place(image, &magnified)
    }

    /// Returns the picture with `inset` in the corner: the part drawn anew by means of
    /// [`Callout::detail`].
    ///
    /// # Errors
    /// If the part holds no pixel of the picture.
    pub fn place(&self, image: &Image, inset: &Image) -> Result<Image, PictureError> {
        let source = self.inside(image)?;
        let mut whole = image.clone();
        let margin = image.width().min(image.height()) / 50;
        let right = image.width().saturating_sub(inset.width() + margin);
        let bottom = image.height().saturating_sub(inset.height() + margin);
        let (x, y) = match self.corner {
            Corner::TopLeft => (margin, margin),
            Corner::TopRight => (right, margin),
            Corner::BottomLeft => (margin, bottom),
            Corner::BottomRight => (right, bottom),
        };
        let target = Rect {
            x,
            y,
            width: inset.width(),
            height: inset.height(),
        };
        let [from, to] = nearest_corners(source, target);
        whole.line(from, to, self.thickness as f64 * 0.6, self.colour);
        whole.frame(source, self.thickness, self.colour);
        whole.paste(inset, x, y);
        whole.frame(target, self.thickness, self.colour);
        Ok(whole)
    }

    /// Returns the part of the source that lies in the picture.
    fn inside(&self, image: &Image) -> Result<Rect, PictureError> {
        let source = self.source;
        let width = source.width.min(image.width().saturating_sub(source.x));
        let height = source.height.min(image.height().saturating_sub(source.y));
        if width == 0 || height == 0 {
            return Err(PictureError::Empty { width, height });
        }
        Ok(Rect {
            width,
            height,
            ..source
        })
    }
}

/// Returns the pixels of a rectangle enlarged, mixed linearly between their middles.
fn magnify(image: &Image, source: Rect, times: usize) -> Result<Image, PictureError> {
    let (width, height) = (source.width * times, source.height * times);
    let mut large = Image::new(width, height, Rgb::WHITE)?;
    let split = |target: usize, first: usize, count: usize| {
        let place = ((target as f64 + 0.5) / times as f64 - 0.5).clamp(0.0, (count - 1) as f64);
        let low = place.floor() as usize;
        let high = (low + 1).min(count - 1);
        (first + low, first + high, place - low as f64)
    };
    let at = |x: usize, y: usize| image.pixel(x, y).unwrap_or(Rgb::WHITE);
    for y in 0..height {
        let (top, bottom, down) = split(y, source.y, source.height);
        for x in 0..width {
            let (left, right, across) = split(x, source.x, source.width);
            let upper = at(left, top).mix(at(right, top), across);
            let lower = at(left, bottom).mix(at(right, bottom), across);
            large.mix(x as i64, y as i64, upper.mix(lower, down), 1.0);
        }
    }
    Ok(large)
}

/// Returns the corners of two rectangles that are nearest to each other.
fn nearest_corners(a: Rect, b: Rect) -> [[f64; 2]; 2] {
    let corners = |rect: Rect| {
        let [x, y] = [rect.x as f64, rect.y as f64];
        let [right, bottom] = [x + rect.width as f64, y + rect.height as f64];
        [[x, y], [right, y], [x, bottom], [right, bottom]]
    };
    let mut best = [corners(a)[0], corners(b)[0]];
    let length = |[p, q]: [[f64; 2]; 2]| (p[0] - q[0]).hypot(p[1] - q[1]);
    for from in corners(a) {
        for to in corners(b) {
            if length([from, to]) < length(best) {
                best = [from, to];
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::{Callout, Corner};
    use crate::{Image, PictureError, Rect, Rgb};

    fn picture() -> Image {
        let mut image = Image::new(100, 100, Rgb::WHITE).expect("a size");
        image.fill(
            Rect {
                x: 10,
                y: 10,
                width: 10,
                height: 10,
            },
            Rgb::BLUE,
        );
        image
    }

    #[test]
    fn the_part_appears_in_the_corner_in_a_frame() {
        let source = Rect {
            x: 10,
            y: 10,
            width: 10,
            height: 10,
        };
        for (corner, x, y) in [
            (Corner::BottomRight, 78, 78),
            (Corner::TopRight, 78, 22),
            (Corner::BottomLeft, 22, 78),
        ] {
            let callout = Callout {
                corner,
                thickness: 1,
                ..Callout::new(source)
            };
            let whole = callout.enlarge(&picture()).expect("a callout");
            assert_eq!(whole.pixel(x, y), Some(Rgb::BLUE), "{corner:?}");
            assert_eq!(whole.pixel(10, 15), Some(Rgb::RED));
        }
        let below = Callout::new(source).enlarge(&picture()).expect("a callout");
        assert_eq!(below.pixel(97, 97), Some(Rgb::RED));
    }

    #[test]
    fn a_part_outside_is_an_error_and_one_too_large_is_cut() {
        let away = Callout::new(Rect {
            x: 200,
            y: 0,
            width: 5,
            height: 5,
        });
        assert_eq!(
            away.enlarge(&picture()),
            Err(PictureError::Empty {
                width: 0,
                height: 5
            })
        );
        let large = Callout::new(Rect {
            x: 90,
            y: 0,
            width: usize::MAX,
            height: 100,
        });
        assert!(large.enlarge(&picture()).is_ok());
    }
}
