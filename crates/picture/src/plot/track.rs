//! An axis: from numbers to places along it.

use crate::plot::Quantity;
use crate::ticks::Ticks;
use crate::{PictureError, Spacing};

/// Where the numbers of a quantity stand between two ends of an axis.
#[derive(Clone, Debug)]
pub(super) struct Track {
    /// Numbers, or their decimal logarithms, at the two ends.
    ends: [f64; 2],
    spacing: Spacing,
    /// Places of the two ends.
    places: [f64; 2],
}

/// Free space at both ends, as a share of the span of the numbers.
const MARGIN: f64 = 0.06;

/// Returns an error if a logarithmic axis cannot show a finite value of the series.
pub(super) fn check(
    quantity: &Quantity<'_>,
    series: &str,
    mut values: impl Iterator<Item = f64>,
) -> Result<(), PictureError> {
    if quantity.spacing == Spacing::Linear {
        return Ok(());
    }
    let wrong = values.find(|value| value.is_finite() && *value <= 0.0);
    wrong.map_or(Ok(()), |value| {
        let series = series.to_owned();
        Err(PictureError::NotPositive { series, value })
    })
}

impl Track {
    /// Returns the axis around all finite values, from place `from` to place `to`.
    ///
    /// # Errors
    /// If there is no finite value.
    pub(super) fn around(
        values: impl Iterator<Item = f64>,
        quantity: &Quantity<'_>,
        places: [f64; 2],
    ) -> Result<Self, PictureError> {
        let mut track = Self::tight(values, quantity, places)?;
        let [low, high] = track.ends;
        let span = if high > low {
            high - low
        } else {
            low.abs().max(1.0)
        };
        track.ends = [low - MARGIN * span, high + MARGIN * span];
        Ok(track)
    }

    /// Returns the axis for bars: from zero, or from a power of ten, to beyond all finite values.
    ///
    /// # Errors
    /// If there is no finite value.
    pub(super) fn from_base(
        values: impl Iterator<Item = f64>,
        quantity: &Quantity<'_>,
        places: [f64; 2],
    ) -> Result<Self, PictureError> {
        let mut track = Self::tight(values, quantity, places)?;
        let [low, high] = track.ends;
        track.ends = match quantity.spacing {
            Spacing::Linear => [low.min(0.0), high.max(0.0)],
            // A bar of exactly a power of ten must not vanish.
            Spacing::Logarithmic => [(low - 0.1).floor(), high],
        };
        let [low, high] = track.ends;
        let span = if high > low { high - low } else { 1.0 };
        track.ends[1] = high + MARGIN * span;
        Ok(track)
    }

    fn tight(
        values: impl Iterator<Item = f64>,
        quantity: &Quantity<'_>,
        places: [f64; 2],
    ) -> Result<Self, PictureError> {
        let spacing = quantity.spacing;
        let mut track = Self {
            ends: [f64::MAX, f64::MIN],
            spacing,
            places,
        };
        for value in values.filter(|value| value.is_finite()) {
            let number = track.number(value);
            track.ends = [track.ends[0].min(number), track.ends[1].max(number)];
        }
        if track.ends[0] > track.ends[1] {
            return Err(PictureError::NothingToPlot);
        }
        Ok(track)
    }

    fn number(&self, value: f64) -> f64 {
        match self.spacing {
            Spacing::Linear => value,
            Spacing::Logarithmic => value.log10(),
        }
    }

    /// Returns the place of a value.
    pub(super) fn place(&self, value: f64) -> f64 {
        let [low, high] = self.ends;
        // Halves, so that the span of the largest numbers is still finite.
        let share = (self.number(value) / 2.0 - low / 2.0) / (high / 2.0 - low / 2.0);
        self.places[0] + share * (self.places[1] - self.places[0])
    }

    /// Returns where bars start.
    pub(super) fn base(&self) -> f64 {
        match self.spacing {
            Spacing::Linear => self.place(0.0),
            Spacing::Logarithmic => self.places[0],
        }
    }

    /// Returns the round numbers of the axis.
    pub(super) fn ticks(&self, most: usize) -> Ticks {
        match self.spacing {
            Spacing::Linear => Ticks::linear(self.ends, most),
            Spacing::Logarithmic => {
                Ticks::logarithmic(self.ends.map(|number| 10.0_f64.powf(number)), most)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Track, check};
    use crate::PictureError;
    use crate::plot::Quantity;

    #[test]
    fn values_lie_between_the_ends() {
        for quantity in [Quantity::linear(""), Quantity::logarithmic("")] {
            let values = [1.0, f64::NAN, 10.0, 100.0];
            let track = Track::around(values.into_iter(), &quantity, [50.0, 250.0]);
            let track = track.expect("values");
            let places = [1.0, 10.0, 100.0].map(|value| track.place(value));
            assert!(50.0 < places[0] && places[0] < places[1] && places[2] < 250.0);
        }
    }

    #[test]
    fn one_value_or_huge_ones_have_a_place() {
        for values in [[3.0, 3.0], [0.0, 0.0], [-f64::MAX, f64::MAX]] {
            let track = Track::around(values.into_iter(), &Quantity::linear(""), [0.0, 100.0]);
            assert!(track.is_ok_and(|track| !track.ticks(5).values.is_empty()));
        }
    }

    #[test]
    fn bars_start_at_zero_or_at_a_power_of_ten() {
        let bars = |quantity| Track::from_base([2.0, 30.0].into_iter(), &quantity, [10.0, 110.0]);
        let linear = bars(Quantity::linear("")).expect("values");
        assert_eq!((linear.base(), linear.place(0.0)), (10.0, 10.0));
        let logarithmic = bars(Quantity::logarithmic("")).expect("values");
        assert!((logarithmic.place(1.0) - 10.0).abs() < 1e-9);
    }

    #[test]
    fn what_cannot_be_shown_is_named() {
        let none = Track::around([f64::NAN].into_iter(), &Quantity::linear(""), [0.0, 1.0]);
        assert_eq!(none.err(), Some(PictureError::NothingToPlot));
        let values = [1.0, -2.0];
        let wrong = check(&Quantity::logarithmic(""), "a", values.into_iter());
        let series = "a".to_owned();
        assert_eq!(
            wrong,
            Err(PictureError::NotPositive {
                series,
                value: -2.0
            })
        );
        assert_eq!(
            check(&Quantity::linear(""), "a", values.into_iter()),
            Ok(())
        );
    }
}
