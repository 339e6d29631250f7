//! What can be wrong with a picture that is asked for.

use thiserror::Error;

/// Returns why a picture or plot could not be made; nothing is drawn in part.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PictureError {
    /// A picture has no pixel.
    #[error("a picture of {width}x{height} pixels holds nothing; ask for at least 1x1")]
    Empty {
        /// Width in pixels.
        width: usize,
        /// Height in pixels.
        height: usize,
    },
    /// A picture, or its samples while it is drawn, would take too much memory.
    #[error(
        "a picture of {width}x{height} with {samples}x{samples} samples per pixel exceeds {limit} \
         samples, or {side} along a side; ask for a smaller one or fewer samples"
    )]
    TooLarge {
        /// Width in pixels.
        width: usize,
        /// Height in pixels.
        height: usize,
        /// Samples along each side of a pixel.
        samples: usize,
        /// The most samples that are drawn.
        limit: usize,
        /// The most samples along a side.
        side: usize,
    },
    /// A face, segment or cell names a point that is not there.
    #[error(
        "object {object}: element {element} uses point {point}, but there are only {points} points; \
         check which positions belong to these indices"
    )]
    IndexOutOfRange {
        /// Number of the object in the order of adding, from 0.
        object: usize,
        /// Number of the face, segment or cell, from 0.
        element: usize,
        /// The index it holds.
        point: u32,
        /// How many points there are.
        points: usize,
    },
    /// A coordinate that is used is NaN or infinite.
    #[error(
        "object {object}: point {point} has a coordinate that is not finite; repair or remove it"
    )]
    NotFinite {
        /// Number of the object in the order of adding, from 0.
        object: usize,
        /// Number of the point, from 0.
        point: usize,
    },
    /// A paint has too few or too many values.
    #[error("object {object}: {found} {what} were given for {expected}; give one for each")]
    WrongCount {
        /// Number of the object in the order of adding, from 0.
        object: usize,
        /// What is counted: scalars, colours, corners.
        what: &'static str,
        /// How many are needed.
        expected: usize,
        /// How many were given.
        found: usize,
    },
    /// An option lies outside of its range.
    #[error("{name} is {value}; it must be {wanted}")]
    BadOption {
        /// Name of the option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        wanted: &'static str,
    },
    /// A plot has no finite point, or a chart no bar.
    #[error("there is nothing to plot; give at least one point with finite coordinates")]
    NothingToPlot,
    /// A value on a logarithmic axis is zero or negative.
    #[error(
        "series {series} holds {value}, which a logarithmic axis cannot show; use a linear axis or \
         leave the value out"
    )]
    NotPositive {
        /// Name of the series.
        series: String,
        /// The value.
        value: f64,
    },
}

/// Checks the size of a text in pixels.
pub(crate) fn check_text_size(size: f64) -> Result<(), PictureError> {
    let is_legible = |s| (6.0..=200.0).contains(&s);
    check_option("text size", size, is_legible, "from 6 to 200 pixels")
}

/// Returns an error unless `value` is finite and `holds` of it.
pub(crate) fn check_option(
    name: &'static str,
    value: f64,
    holds: impl Fn(f64) -> bool,
    wanted: &'static str,
) -> Result<(), PictureError> {
    if value.is_finite() && holds(value) {
        return Ok(());
    }
    Err(PictureError::BadOption {
        name,
        value,
        wanted,
    })
}

#[cfg(test)]
mod tests {
    use super::{PictureError, check_option};

    #[test]
    fn the_texts_say_what_is_wrong_and_what_to_do() {
        let index = PictureError::IndexOutOfRange {
            object: 1,
            element: 2,
            point: 9,
            points: 4,
        };
        assert_eq!(
            index.to_string(),
            "object 1: element 2 uses point 9, but there are only 4 points; check which positions \
             belong to these indices"
        );
        let large = PictureError::TooLarge {
            width: 100_000,
            height: 100_000,
            samples: 3,
            limit: 10,
            side: 5,
        };
        assert_eq!(
            large.to_string(),
            "a picture of 100000x100000 with 3x3 samples per pixel exceeds 10 samples, or 5 \
             along a side; ask for a smaller one or fewer samples"
        );
        let count = PictureError::WrongCount {
            object: 0,
            what: "scalars",
            expected: 3,
            found: 2,
        };
        assert_eq!(
            count.to_string(),
            "object 0: 2 scalars were given for 3; give one for each"
        );
        let option = check_option("zoom", f64::NAN, |zoom| zoom > 0.0, "positive");
        let text = option.map_err(|error| error.to_string());
        assert_eq!(text, Err("zoom is NaN; it must be positive".to_owned()));
        let positive = PictureError::NotPositive {
            series: "fit".to_owned(),
            value: 0.0,
        };
        assert!(positive.to_string().contains("series fit holds 0"));
    }
}
