//! Text in pictures, set in Ubuntu Light, which is embedded; characters that it lacks are taken
//! from Hack.

use std::sync::LazyLock;

use ab_glyph::{Font, FontRef, Glyph, PxScale, ScaleFont, point};

use crate::{Image, Rgb};

/// The part of a line of text that stands at the given point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Anchor {
    /// Its left end.
    #[default]
    Left,
    /// Its middle.
    Centre,
    /// Its right end.
    Right,
}

/// How a line of text looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextStyle {
    /// Size of the font in pixels: the height of a line without leading.
    pub size: f64,
    /// Its colour.
    pub colour: Rgb,
    /// Which part of it stands at the given point.
    pub anchor: Anchor,
}

impl Default for TextStyle {
    fn default() -> Self {
        Self {
            size: 24.0,
            colour: Rgb::INK,
            anchor: Anchor::Left,
        }
    }
}

/// Sizes of text are kept within these bounds, in pixels.
const SIZES: [f64; 2] = [1.0, 2000.0];

/// The fonts, in the order in which they are asked for a character.
static FONTS: LazyLock<[FontRef<'static>; 2]> = LazyLock::new(|| {
    let files = [
        epaint_default_fonts::UBUNTU_LIGHT,
        epaint_default_fonts::HACK_REGULAR,
    ];
    files.map(|file| FontRef::try_from_slice(file).expect("the embedded fonts are fonts"))
});

/// A character with its place in a line.
struct Letter {
    font: &'static FontRef<'static>,
    glyph: Glyph,
}

/// Returns the first font that has a character; the first of all if none has it.
fn font_of(character: char) -> &'static FontRef<'static> {
    let has = |font: &&FontRef<'_>| font.glyph_id(character).0 != 0;
    FONTS.iter().find(has).unwrap_or(&FONTS[0])
}

/// Returns the letters of a line that starts at the origin, and its width. Control characters,
/// line breaks among them, are left out.
fn set(text: &str, size: f64) -> (Vec<Letter>, f64) {
    let size = if size.is_nan() {
        SIZES[0]
    } else {
        size.clamp(SIZES[0], SIZES[1])
    };
    let mut letters: Vec<Letter> = Vec::new();
    let mut x = 0.0;
    for character in text.chars().filter(|c| !c.is_control()) {
        let font = font_of(character);
        // A scale is a height from the lowest to the highest point of all letters, not an em.
        let em = font.units_per_em().unwrap_or(1000.0);
        let scaled = font.as_scaled(PxScale::from(size as f32 * font.height_unscaled() / em));
        let mut glyph = scaled.scaled_glyph(character);
        if let Some(last) = letters.last().filter(|last| std::ptr::eq(last.font, font)) {
            x += scaled.kern(last.glyph.id, glyph.id);
        }
        glyph.position = point(x, 0.0);
        x += scaled.h_advance(glyph.id);
        letters.push(Letter { font, glyph });
    }
    (letters, f64::from(x))
}

/// Returns the width in pixels of a line of text of this size.
#[must_use]
pub fn text_width(text: &str, size: f64) -> f64 {
    set(text, size).1
}

impl Image {
    /// Draws a line of text whose baseline passes through `at`, in pixels from the upper left
    /// corner; what lies outside is left out.
    pub fn text(&mut self, text: &str, at: [f64; 2], style: &TextStyle) {
        let (letters, width) = set(text, style.size);
        let before = match style.anchor {
            Anchor::Left => 0.0,
            Anchor::Centre => width / 2.0,
            Anchor::Right => width,
        };
        let origin = [at[0] - before, at[1]];
        if !origin.iter().all(|c| c.abs() < 1e6) {
            return;
        }
        for Letter { font, mut glyph } in letters {
            glyph.position.x += origin[0] as f32;
            glyph.position.y += origin[1] as f32;
            let Some(outline) = font.outline_glyph(glyph) else {
                continue;
            };
            let corner = outline.px_bounds().min;
            outline.draw(|x, y, cover| {
                let [x, y] = [
                    corner.x as i64 + i64::from(x),
                    corner.y as i64 + i64::from(y),
                ];
                self.mix(x, y, style.colour, stroke(cover));
            });
        }
    }
}

/// Returns the cover of a pixel with the thin strokes of the light font made a little stronger.
fn stroke(cover: f32) -> f64 {
    f64::from(cover.clamp(0.0, 1.0)).powf(0.7)
}

#[cfg(test)]
mod tests {
    use ab_glyph::Font;

    use super::{Anchor, TextStyle, font_of, text_width};
    use crate::{Image, Rgb};

    #[test]
    fn the_fonts_have_what_labels_need() {
        for character in "aZ09äé×·−⁻⁰¹²³⁴⁵⁶⁷⁸⁹µ°σ%()".chars() {
            assert_ne!(font_of(character).glyph_id(character).0, 0, "{character}");
        }
    }

    #[test]
    fn a_line_is_as_wide_as_its_letters_and_scales() {
        assert_eq!(text_width("", 20.0), 0.0);
        let width = text_width("Hello", 20.0);
        assert!((30.0..70.0).contains(&width), "{width}");
        assert!((text_width("Hello", 40.0) / width - 2.0).abs() < 1e-4);
    }

    #[test]
    fn text_stays_between_its_anchor_and_the_edge() {
        let mut image = Image::new(200, 60, Rgb::WHITE).expect("a size");
        let style = TextStyle {
            anchor: Anchor::Right,
            ..TextStyle::default()
        };
        image.text("Ende", [150.0, 40.0], &style);
        let dark = |x: usize| (0..60).any(|y| image.pixel(x, y) != Some(Rgb::WHITE));
        assert!((152..200).all(|x| !dark(x)) && (100..150).any(dark));
    }

    #[test]
    fn wild_places_and_sizes_are_survived() {
        let mut image = Image::new(20, 20, Rgb::WHITE).expect("a size");
        for value in [f64::NAN, f64::INFINITY, -1e300, 1e5] {
            let style = TextStyle {
                size: value,
                ..TextStyle::default()
            };
            image.text("a\nb\u{0}\u{10FFFF}", [value, 10.0], &style);
        }
        let style = TextStyle::default();
        image.text("abc", [-1e5, 1e5], &style);
    }
}
