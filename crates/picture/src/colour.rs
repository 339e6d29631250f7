//! Colours in sRGB, and in the linear light in which they are mixed.

/// A colour in sRGB, eight bits a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rgb {
    /// Red.
    pub red: u8,
    /// Green.
    pub green: u8,
    /// Blue.
    pub blue: u8,
}

impl Rgb {
    /// White: paper.
    pub const WHITE: Self = Self::new(255, 255, 255);
    /// Nearly black: text and frames.
    pub const INK: Self = Self::new(34, 36, 40);
    /// Middle grey: edges of meshes, and where a scalar is not a number.
    pub const GREY: Self = Self::new(140, 142, 146);
    /// Warm light grey: a surface without paint.
    pub const CLAY: Self = Self::new(214, 208, 198);
    /// Cool light blue: a second surface.
    pub const SKY: Self = Self::new(168, 194, 222);
    /// Light yellow: a third surface, and freshly cut cells.
    pub const SAND: Self = Self::new(240, 208, 130);
    /// Red of curves on surfaces.
    pub const RED: Self = Self::new(205, 32, 38);
    /// Blue of knots and of a second family of curves.
    pub const BLUE: Self = Self::new(28, 92, 168);
    /// Green of a third family.
    pub const GREEN: Self = Self::new(34, 134, 84);

    /// Returns the colour of these channels.
    #[must_use]
    pub const fn new(red: u8, green: u8, blue: u8) -> Self {
        Self { red, green, blue }
    }

    /// Returns the channels in the order red, green, blue.
    #[must_use]
    pub const fn channels(self) -> [u8; 3] {
        [self.red, self.green, self.blue]
    }

    /// Returns the colour in linear light, each channel in 0..=1.
    pub(crate) fn to_linear(self) -> Linear {
        self.channels().map(linear_from_byte)
    }

    /// Returns this colour with the share `amount` in 0..=1 replaced by `other`, mixed as sRGB.
    ///
    /// That is how dark text on light paper keeps its weight; light is mixed linearly elsewhere.
    pub(crate) fn mix(self, other: Self, amount: f64) -> Self {
        let mix = |a: u8, b: u8| {
            let value = f64::from(a) + (f64::from(b) - f64::from(a)) * amount.clamp(0.0, 1.0);
            value.round() as u8
        };
        Self::new(
            mix(self.red, other.red),
            mix(self.green, other.green),
            mix(self.blue, other.blue),
        )
    }
}

/// Red, green and blue in linear light; 1 is white.
pub(crate) type Linear = [f32; 3];

/// Returns a channel of sRGB in linear light.
///
/// # Reference
/// IEC 61966-2-1, the transfer function of sRGB.
fn linear_from_byte(byte: u8) -> f32 {
    let value = f32::from(byte) / 255.0;
    if value <= 0.040_45 {
        value / 12.92
    } else {
        ((value + 0.055) / 1.055).powf(2.4)
    }
}

/// Returns a channel of linear light as sRGB, clamped to what can be shown.
fn byte_from_linear(value: f32) -> u8 {
    let value = if value <= 0.003_130_8 {
        12.92 * value
    } else {
        1.055 * value.clamp(0.0, 1.0).powf(1.0 / 2.4) - 0.055
    };
    // NaN and negative values become 0.
    (255.0 * value + 0.5) as u8
}

/// Returns the sRGB bytes of a colour in linear light.
pub(crate) fn bytes_from_linear(colour: Linear) -> [u8; 3] {
    colour.map(byte_from_linear)
}

/// Returns `a` with the share `amount` replaced by `b`.
pub(crate) fn blend(a: Linear, b: Linear, amount: f32) -> Linear {
    [0, 1, 2].map(|i| a[i] + (b[i] - a[i]) * amount)
}

#[cfg(test)]
mod tests {
    use super::{Rgb, bytes_from_linear};

    #[test]
    fn every_byte_survives_the_way_to_linear_light_and_back() {
        for byte in 0..=255 {
            let colour = Rgb::new(byte, 255 - byte, 7);
            assert_eq!(bytes_from_linear(colour.to_linear()), colour.channels());
        }
    }

    #[test]
    fn half_the_light_is_far_brighter_than_half_the_byte() {
        assert_eq!(bytes_from_linear([0.5; 3]), [188; 3]);
        assert_eq!(bytes_from_linear([f32::NAN, -1.0, 9.0]), [0, 0, 255]);
    }

    #[test]
    fn a_mix_runs_from_one_colour_to_the_other() {
        assert_eq!(Rgb::INK.mix(Rgb::WHITE, 0.0), Rgb::INK);
        assert_eq!(Rgb::INK.mix(Rgb::WHITE, 2.0), Rgb::WHITE);
    }
}
