//! A picture as rows of pixels, and its PNG.

use crate::{PictureError, Rgb};

/// The most pixels that an image has: 128 million, a third of a gigabyte.
pub const MAX_PIXELS: usize = 1 << 27;

/// The most samples along a side of a picture, which keeps the sums of the rasteriser in range.
const MAX_SIDE: usize = 1 << 17;

/// A rectangle of pixels; x runs to the right and y down from the upper left corner.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rect {
    /// First column.
    pub x: usize,
    /// First row.
    pub y: usize,
    /// Number of columns.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
}

/// A picture: rows of sRGB pixels, three bytes each, from the upper left corner.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    width: usize,
    height: usize,
    bytes: Vec<u8>,
}

impl Image {
    /// Returns an image of one colour.
    ///
    /// # Errors
    /// If it has no pixel or more than [`MAX_PIXELS`].
    pub fn new(width: usize, height: usize, colour: Rgb) -> Result<Self, PictureError> {
        check_size(width, height, 1)?;
        let bytes = colour.channels().repeat(width * height);
        Ok(Self {
            width,
            height,
            bytes,
        })
    }

    /// Returns the number of columns.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Returns the number of rows.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// Returns the bytes red, green, blue of all pixels, row by row.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Returns the bytes, to be painted over in place.
    pub(crate) fn bytes_mut(&mut self) -> &mut [u8] {
        &mut self.bytes
    }

    /// Returns the colour of a pixel; `None` outside.
    #[must_use]
    pub fn pixel(&self, x: usize, y: usize) -> Option<Rgb> {
        (x < self.width && y < self.height).then(|| {
            let at = 3 * (y * self.width + x);
            Rgb::new(self.bytes[at], self.bytes[at + 1], self.bytes[at + 2])
        })
    }

    /// Replaces the share `amount` of a pixel by a colour; does nothing outside.
    pub(crate) fn mix(&mut self, x: i64, y: i64, colour: Rgb, amount: f64) {
        let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) else {
            return;
        };
        if let Some(below) = self.pixel(x, y) {
            let at = 3 * (y * self.width + x);
            self.bytes[at..at + 3].copy_from_slice(&below.mix(colour, amount).channels());
        }
    }

    /// Fills the part of a rectangle that lies inside.
    pub fn fill(&mut self, rect: Rect, colour: Rgb) {
        let right = rect.x.saturating_add(rect.width).min(self.width);
        for y in rect.y..rect.y.saturating_add(rect.height).min(self.height) {
            for x in rect.x..right {
                let at = 3 * (y * self.width + x);
                self.bytes[at..at + 3].copy_from_slice(&colour.channels());
            }
        }
    }

    /// Draws the frame of a rectangle, `thickness` pixels wide and inside of it.
    pub fn frame(&mut self, rect: Rect, thickness: usize, colour: Rgb) {
        let [across, down] = [thickness.min(rect.width), thickness.min(rect.height)];
        let right = rect.x.saturating_add(rect.width) - across;
        let below = rect.y.saturating_add(rect.height) - down;
        let [row, column] = [
            Rect {
                height: down,
                ..rect
            },
            Rect {
                width: across,
                ..rect
            },
        ];
        for side in [
            row,
            column,
            Rect { y: below, ..row },
            Rect { x: right, ..column },
        ] {
            self.fill(side, colour);
        }
    }

    /// Copies another image so that its upper left corner is at `(x, y)`; what lies outside is
    /// left out.
    pub fn paste(&mut self, other: &Self, x: usize, y: usize) {
        if x >= self.width {
            return;
        }
        let width = other.width.min(self.width - x);
        for row in 0..other.height.min(self.height.saturating_sub(y)) {
            let to = 3 * ((y + row) * self.width + x);
            let from = 3 * row * other.width;
            self.bytes[to..to + 3 * width].copy_from_slice(&other.bytes[from..from + 3 * width]);
        }
    }

    /// Draws a straight line between two points in pixels, with smooth edges.
    pub fn line(&mut self, from: [f64; 2], to: [f64; 2], width: f64, colour: Rgb) {
        let limit = |value: f64, most: usize| value.clamp(0.0, most as f64) as i64;
        let reach = width / 2.0 + 1.0;
        let [x0, x1] = [from[0].min(to[0]) - reach, from[0].max(to[0]) + reach];
        let [y0, y1] = [from[1].min(to[1]) - reach, from[1].max(to[1]) + reach];
        let along = [to[0] - from[0], to[1] - from[1]];
        let length = along[0] * along[0] + along[1] * along[1];
        for y in limit(y0, self.height)..limit(y1.ceil(), self.height) {
            for x in limit(x0, self.width)..limit(x1.ceil(), self.width) {
                let p = [x as f64 + 0.5 - from[0], y as f64 + 0.5 - from[1]];
                let t = if length > 0.0 {
                    ((p[0] * along[0] + p[1] * along[1]) / length).clamp(0.0, 1.0)
                } else {
                    0.0
                };
                let distance = (p[0] - t * along[0]).hypot(p[1] - t * along[1]);
                let cover = (width / 2.0 + 0.5 - distance).clamp(0.0, 1.0);
                self.mix(x, y, colour, cover);
            }
        }
    }

    /// Returns the picture as a PNG file of eight bits a channel; the same picture gives the same
    /// bytes.
    ///
    /// # Panics
    /// Never: a vector takes all bytes, and an image has at least one pixel.
    #[must_use]
    pub fn to_png(&self) -> Vec<u8> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        // A twentieth of the time of the balanced level, for files a quarter larger.
        encoder.set_compression(png::Compression::Fast);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        encoder
            .write_header()
            .and_then(|mut writer| {
                writer.write_image_data(&self.bytes)?;
                writer.finish()
            })
            .expect("a vector takes all bytes");
        file
    }
}

/// Returns an error unless a picture of this size and of `samples` per side of a pixel can be made.
pub(crate) fn check_size(width: usize, height: usize, samples: usize) -> Result<(), PictureError> {
    if width == 0 || height == 0 {
        return Err(PictureError::Empty { width, height });
    }
    let count = [height, samples, samples]
        .into_iter()
        .try_fold(width, usize::checked_mul);
    let long = width.max(height).saturating_mul(samples) > MAX_SIDE;
    if long || count.is_none_or(|count| count > MAX_PIXELS) {
        return Err(PictureError::TooLarge {
            width,
            height,
            samples,
            limit: MAX_PIXELS,
            side: MAX_SIDE,
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{Image, Rect};
    use crate::{PictureError, Rgb};

    fn colourful() -> Image {
        let mut image = Image::new(37, 23, Rgb::WHITE).expect("a size");
        for y in 0..23 {
            for x in 0..37 {
                let colour = Rgb::new((7 * x) as u8, (11 * y) as u8, (x * y) as u8);
                image.fill(
                    Rect {
                        x,
                        y,
                        width: 1,
                        height: 1,
                    },
                    colour,
                );
            }
        }
        image
    }

    #[test]
    fn a_png_decodes_to_the_same_pixels() {
        let image = colourful();
        let png = image.to_png();
        assert_eq!(png, image.to_png());
        let mut reader = png::Decoder::new(std::io::Cursor::new(png))
            .read_info()
            .expect("a header");
        let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
        let info = reader.next_frame(&mut bytes).expect("pixels");
        assert_eq!((info.width, info.height), (37, 23));
        assert_eq!(bytes, image.bytes());
    }

    #[test]
    fn a_size_without_pixels_or_with_too_many_is_refused() {
        let new = |width, height| Image::new(width, height, Rgb::WHITE);
        assert_eq!(
            new(0, 5),
            Err(PictureError::Empty {
                width: 0,
                height: 5
            })
        );
        for size in [1 << 20, usize::MAX] {
            assert!(matches!(
                new(size, size),
                Err(PictureError::TooLarge { .. })
            ));
        }
    }

    #[test]
    fn what_lies_outside_is_left_out() {
        let mut image = Image::new(4, 4, Rgb::WHITE).expect("a size");
        image.fill(
            Rect {
                x: 3,
                y: 3,
                width: usize::MAX,
                height: 9,
            },
            Rgb::RED,
        );
        image.paste(&colourful(), 9, 9);
        image.paste(&colourful(), 3, 0);
        image.line([-1e9, 2.0], [1e9, 2.0], 1.0, Rgb::INK);
        let pasted = colourful().pixel(0, 3);
        assert_eq!(image.pixel(3, 3), pasted);
        assert_eq!(image.pixel(4, 0), None);
    }

    #[test]
    fn a_frame_leaves_its_inside_alone() {
        let mut image = Image::new(6, 5, Rgb::WHITE).expect("a size");
        image.frame(
            Rect {
                x: 0,
                y: 0,
                width: 6,
                height: 5,
            },
            1,
            Rgb::RED,
        );
        let count = image
            .bytes()
            .chunks(3)
            .filter(|p| *p == Rgb::RED.channels())
            .count();
        assert_eq!(count, 2 * 6 + 2 * 3);
    }
}
