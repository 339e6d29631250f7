//! Colour maps: from a number to a colour.

use crate::Rgb;
use crate::colour::Linear;
use crate::error::{PictureError, check_option};

/// A family of colours along the numbers 0..=1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColourMap {
    /// Dark violet over green to yellow; lightness rises steadily. For any quantity from low to high.
    #[default]
    Viridis,
    /// Black over violet and orange to nearly white; lightness rises steadily.
    Magma,
    /// Black over red and orange to light yellow; lightness rises steadily.
    Inferno,
    /// Blue over pale yellow to red: errors, from good to bad. Lightness rises to the middle and
    /// falls after it.
    ColdWarm,
    /// Blue over white to red: signed values; give a range symmetric about zero. Lightness rises
    /// to the middle and falls after it.
    Diverging,
}

impl ColourMap {
    /// Returns the colour at `t`, which is clamped to 0..=1; grey where `t` is NaN.
    #[must_use]
    pub fn colour(self, t: f64) -> Rgb {
        if t.is_nan() {
            return Rgb::GREY;
        }
        let t = t.clamp(0.0, 1.0);
        let colour = match self {
            Self::Viridis => colorous::VIRIDIS.eval_continuous(t),
            Self::Magma => colorous::MAGMA.eval_continuous(t),
            Self::Inferno => colorous::INFERNO.eval_continuous(t),
            Self::ColdWarm => colorous::RED_YELLOW_BLUE.eval_continuous(1.0 - t),
            Self::Diverging => colorous::RED_BLUE.eval_continuous(1.0 - t),
        };
        Rgb::new(colour.r, colour.g, colour.b)
    }
}

/// How the numbers of a scale are spread over its colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Spacing {
    /// Equal differences are equal steps of colour.
    #[default]
    Linear,
    /// Equal ratios are equal steps of colour; the range must be positive.
    Logarithmic,
}

/// A colour map with the range of numbers that it shows.
///
/// A surface and its colour bar take the same value, so that they cannot disagree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColourScale {
    /// The colours.
    pub map: ColourMap,
    /// Numbers of the first and the last colour; what lies outside takes the nearer of the two.
    pub range: [f64; 2],
    /// How the numbers between are spread.
    pub spacing: Spacing,
}

impl ColourScale {
    /// Returns a linear scale.
    #[must_use]
    pub const fn linear(map: ColourMap, range: [f64; 2]) -> Self {
        Self {
            map,
            range,
            spacing: Spacing::Linear,
        }
    }

    /// Returns a logarithmic scale; both ends of the range must be positive.
    #[must_use]
    pub const fn logarithmic(map: ColourMap, range: [f64; 2]) -> Self {
        Self {
            map,
            range,
            spacing: Spacing::Logarithmic,
        }
    }

    /// Returns the colour of `value`; grey where it is NaN.
    #[must_use]
    pub fn colour(&self, value: f64) -> Rgb {
        self.map.colour(self.place(value))
    }

    /// Returns where in 0..=1 a value stands, not clamped.
    pub(crate) fn place(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        // A range of one number shows it in the middle colour.
        let ratio = |above: f64, span: f64| if span > 0.0 { above / span } else { 0.5 };
        match self.spacing {
            _ if value.is_nan() => f64::NAN,
            Spacing::Linear => ratio(value - low, high - low),
            Spacing::Logarithmic if value <= 0.0 => 0.0,
            Spacing::Logarithmic => ratio((value / low).ln(), (high / low).ln()),
        }
    }

    /// Returns an error unless the range is finite, in order, and positive where it must be.
    pub(crate) fn check(&self) -> Result<(), PictureError> {
        let [low, high] = self.range;
        if self.spacing == Spacing::Logarithmic {
            check_option("start of the colour range", low, |v| v > 0.0, "positive")?;
        }
        check_option("start of the colour range", low, |_| true, "finite")?;
        check_option(
            "end of the colour range",
            high,
            |v| v >= low && (v - low).is_finite(),
            "finite and not below the start",
        )
    }
}

/// Entries of a table of colours; a step is then below what an eye can tell apart.
const TABLE: usize = 1024;

/// Colours of a scale in linear light, tabled, as shading asks for one per sample.
pub(crate) struct ColourTable {
    scale: ColourScale,
    colours: Vec<Linear>,
    none: Linear,
}

impl ColourTable {
    /// Returns the table of a scale.
    pub(crate) fn new(scale: ColourScale) -> Self {
        let at = |i: usize| scale.map.colour(i as f64 / (TABLE - 1) as f64).to_linear();
        Self {
            scale,
            colours: (0..TABLE).map(at).collect(),
            none: Rgb::GREY.to_linear(),
        }
    }

    /// Returns the colour of a value in linear light.
    pub(crate) fn colour(&self, value: f64) -> Linear {
        let place = self.scale.place(value);
        if place.is_nan() {
            return self.none;
        }
        let index = (place * (TABLE - 1) as f64 + 0.5).clamp(0.0, (TABLE - 1) as f64);
        self.colours[index as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::{ColourMap, ColourScale, ColourTable};
    use crate::Rgb;
    use crate::colour::bytes_from_linear;

    /// Returns the lightness L* of CIE 1976 under white of sRGB, 0 for black to 100.
    fn lightness(colour: Rgb) -> f64 {
        let [r, g, b] = colour.to_linear().map(f64::from);
        let y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        // Below this luminance L* is linear.
        if y <= 216.0 / 24_389.0 {
            return 24_389.0 / 27.0 * y;
        }
        116.0 * y.cbrt() - 16.0
    }

    /// Rounding to bytes may turn a step of lightness back by this much.
    const ROUNDING: f64 = 0.25;

    fn rises(map: ColourMap, from: f64, to: f64) -> bool {
        let at = |i: u32| from + (to - from) * f64::from(i) / 100.0;
        (0..100).all(|i| {
            let step = lightness(map.colour(at(i + 1))) - lightness(map.colour(at(i)));
            step > -ROUNDING
        })
    }

    #[test]
    fn sequential_maps_rise_in_lightness() {
        for map in [ColourMap::Viridis, ColourMap::Magma, ColourMap::Inferno] {
            assert!(rises(map, 0.0, 1.0), "{map:?}");
            let span = lightness(map.colour(1.0)) - lightness(map.colour(0.0));
            assert!(span > 70.0, "{map:?} spans {span}");
        }
    }

    #[test]
    fn diverging_maps_rise_to_the_middle_and_fall_after_it() {
        for map in [ColourMap::ColdWarm, ColourMap::Diverging] {
            assert!(rises(map, 0.0, 0.48) && rises(map, 1.0, 0.52), "{map:?}");
            let [cold, warm] = [map.colour(0.0), map.colour(1.0)];
            assert!(cold.blue > cold.red && warm.red > warm.blue, "{map:?}");
        }
    }

    #[test]
    fn a_scale_clamps_and_shows_what_is_no_number() {
        let scale = ColourScale::linear(ColourMap::Viridis, [1.0, 3.0]);
        assert_eq!(scale.colour(0.0), scale.colour(1.0));
        assert_eq!(scale.colour(2.0), ColourMap::Viridis.colour(0.5));
        assert_eq!(scale.colour(f64::INFINITY), scale.colour(3.0));
        assert_eq!(scale.colour(f64::NAN), Rgb::GREY);
        let constant = ColourScale::linear(ColourMap::Viridis, [2.0, 2.0]);
        assert_eq!(constant.colour(2.0), ColourMap::Viridis.colour(0.5));
    }

    #[test]
    fn a_logarithmic_scale_steps_by_ratios() {
        let scale = ColourScale::logarithmic(ColourMap::Magma, [1e-4, 1.0]);
        assert!((scale.place(1e-2) - 0.5).abs() < 1e-12);
        assert_eq!(scale.colour(-1.0), scale.colour(1e-9));
        let wrong = ColourScale::logarithmic(ColourMap::Magma, [0.0, 1.0]);
        let text = wrong.check().map_err(|error| error.to_string());
        let expected = "start of the colour range is 0; it must be positive";
        assert_eq!(text, Err(expected.to_owned()));
    }

    #[test]
    fn the_table_is_the_map_within_its_step() {
        let scale = ColourScale::linear(ColourMap::ColdWarm, [0.0, 1.0]);
        let table = ColourTable::new(scale);
        for i in 0..=64 {
            let value = f64::from(i) / 64.0;
            let exact = scale.colour(value).channels();
            for (a, b) in bytes_from_linear(table.colour(value)).iter().zip(exact) {
                assert!(a.abs_diff(b) <= 2, "{value}: {a} for {b}");
            }
        }
    }
}
