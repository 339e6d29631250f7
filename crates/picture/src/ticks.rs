//! Round numbers along a scale, and how they are written.

/// Round numbers of a range with their labels.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ticks {
    /// The numbers, increasing, all within the range.
    pub(crate) values: Vec<f64>,
    /// What stands at each; with [`Ticks::exponent`] taken out.
    pub(crate) labels: Vec<String>,
    /// Power of ten by which all labels are to be multiplied.
    pub(crate) exponent: i32,
}

/// Factors of a power of ten that count as round.
const ROUND: [i32; 3] = [1, 2, 5];
/// Slack in steps, so that the ends of a range are not lost to rounding.
const SLACK: f64 = 1e-9;
/// Numbers of these powers of ten are written out.
const PLAIN: std::ops::RangeInclusive<i32> = -3..=4;

impl Ticks {
    /// Returns at most `most + 1` numbers 1, 2 or 5 times a power of ten apart.
    ///
    /// The range is finite and in order. A range of one number has that number alone.
    pub(crate) fn linear(range: [f64; 2], most: usize) -> Self {
        let [low, high] = range;
        let span = high - low;
        if span <= 0.0 || !span.is_finite() {
            return Self {
                values: vec![low],
                labels: vec![scientific(low)],
                exponent: 0,
            };
        }
        let rough = span / most.max(1) as f64;
        let power = rough.log10().floor() as i32 - 1;
        let (factor, power) = (power..power + 4)
            .flat_map(|power| ROUND.map(|factor| (factor, power)))
            .find(|&(factor, power)| f64::from(factor) * ten(power) >= rough * (1.0 - SLACK))
            .unwrap_or((1, power + 4));
        let step = f64::from(factor) * ten(power);
        let first = (low / step - SLACK).ceil();
        let count = ((high / step + SLACK).floor() - first).max(0.0) as usize;
        let steps: Vec<f64> = (0..=count.min(most))
            .map(|i| (first + i as f64) * f64::from(factor))
            .collect();
        let largest = low.abs().max(high.abs()).log10().floor() as i32;
        let exponent = if PLAIN.contains(&largest) { 0 } else { largest };
        let decimals = (exponent - power).clamp(0, 17) as usize;
        // Adding zero turns a negative zero into a plain one.
        let scaled = |number: f64, power: i32| scale(number, power) + 0.0;
        Self {
            values: steps.iter().map(|n| scaled(*n, power)).collect(),
            labels: steps
                .iter()
                .map(|n| format!("{:.decimals$}", scaled(*n, power - exponent)))
                .collect(),
            exponent,
        }
    }

    /// Returns the name of what the numbers measure, with the power of ten that their labels share.
    pub(crate) fn title(&self, label: &str) -> String {
        match (label, self.exponent) {
            (label, 0) => label.to_owned(),
            ("", power) => format!("×10{}", superscript(power)),
            (label, power) => format!("{label} (×10{})", superscript(power)),
        }
    }

    /// Returns powers of ten, and 2 and 5 times them where the range holds few; both ends of the
    /// range are positive. Every label stands for itself.
    pub(crate) fn logarithmic(range: [f64; 2], most: usize) -> Self {
        let [low, high] = range;
        let powers = low.log10().floor() as i32..=high.log10().ceil() as i32;
        let inside = |value: &f64| *value >= low * (1.0 - SLACK) && *value <= high * (1.0 + SLACK);
        let within = |factors: &[i32]| -> Vec<(i32, i32)> {
            let all = powers
                .clone()
                .flat_map(|power| factors.iter().map(move |f| (*f, power)));
            all.filter(|&(factor, power)| inside(&scale(f64::from(factor), power)))
                .collect()
        };
        let mut ticks = within(&ROUND);
        if ticks.len() > most {
            ticks = within(&[1]);
        }
        let stride = ticks.len().div_ceil(most.max(1)).max(1) as i32;
        if stride > 1 {
            ticks.retain(|(_, power)| power.rem_euclid(stride) == 0);
        }
        if ticks.len() < 2 {
            return Self::linear(range, most);
        }
        let short = ticks.iter().all(|(_, power)| PLAIN.contains(power));
        let style = if short {
            Powers::WrittenOut
        } else {
            Powers::Raised
        };
        Self {
            values: ticks
                .iter()
                .map(|&(factor, power)| scale(f64::from(factor), power))
                .collect(),
            labels: ticks
                .iter()
                .map(|&(factor, power)| product(factor, power, style))
                .collect(),
            exponent: 0,
        }
    }
}

fn ten(power: i32) -> f64 {
    scale(1.0, power)
}

/// Returns a number times a power of ten, rounded once as long as the power is exact.
fn scale(number: f64, power: i32) -> f64 {
    if power >= 0 {
        number * 10.0_f64.powi(power)
    } else {
        number / 10.0_f64.powi(-power)
    }
}

/// Returns `factor` times a power of ten, written out or as a power.
fn product(factor: i32, power: i32, style: Powers) -> String {
    match (style, factor) {
        (Powers::WrittenOut, _) => {
            let decimals = (-power).max(0) as usize;
            format!("{:.decimals$}", scale(f64::from(factor), power))
        }
        (Powers::Raised, 1) => format!("10{}", superscript(power)),
        (Powers::Raised, _) => format!("{factor}×10{}", superscript(power)),
    }
}

/// How the powers of ten along one scale are written.
#[derive(Clone, Copy)]
enum Powers {
    WrittenOut,
    Raised,
}

/// Returns a number in few letters.
pub(crate) fn scientific(value: f64) -> String {
    let plain = value == 0.0 || (1e-3..1e5).contains(&value.abs());
    if plain || !value.is_finite() {
        let text = format!("{value:.4}");
        let text = if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.')
        } else {
            &text
        };
        return text.to_owned();
    }
    let text = format!("{value:.2e}");
    match text.split_once('e') {
        Some((digits, power)) => {
            let digits = digits.trim_end_matches('0').trim_end_matches('.');
            format!("{digits}×10{}", superscript(power.parse().unwrap_or(0)))
        }
        None => text,
    }
}

/// Returns an exponent in raised digits.
fn superscript(power: i32) -> String {
    let raise = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        '9' => '⁹',
        _ => '⁰',
    };
    power.to_string().chars().map(raise).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::{Ticks, scientific, superscript};

    proptest! {
        #[test]
        fn ticks_are_round_and_inside(low in -9.0..9.0_f64, log_span in -4.0..3.0_f64) {
            let high = low + 10.0_f64.powf(log_span);
            let ticks = Ticks::linear([low, high], 6);
            prop_assert!((2..=7).contains(&ticks.values.len()), "{:?}", ticks);
            let slack = 1e-6 * (high - low);
            for (value, label) in ticks.values.iter().zip(&ticks.labels) {
                prop_assert!(*value >= low - slack && *value <= high + slack);
                let read: f64 = label.parse::<f64>().expect("a number") * 10.0_f64.powi(ticks.exponent);
                prop_assert!((read - value).abs() <= 1e-12 * value.abs().max(1.0), "{} {}", label, value);
            }
            let step = ticks.values[1] - ticks.values[0];
            let digits = step / 10.0_f64.powf(step.log10().floor() + 1e-9_f64.copysign(-1.0));
            let round = [1.0, 2.0, 5.0, 10.0].iter().any(|r| (digits / r - 1.0).abs() < 1e-4);
            prop_assert!(round, "step {}", step);
        }
    }

    #[test]
    fn small_numbers_share_a_power_of_ten() {
        let ticks = Ticks::linear([0.0, 4e-5], 5);
        assert_eq!(ticks.exponent, -5);
        assert_eq!(ticks.title("mm"), "mm (×10⁻⁵)");
        assert_eq!(ticks.labels, ["0", "1", "2", "3", "4"]);
        assert_eq!(ticks.values[3], 3e-5);
        assert_eq!(
            Ticks::linear([-1.0, 1.0], 4).labels,
            ["-1.0", "-0.5", "0.0", "0.5", "1.0"]
        );
    }

    #[test]
    fn a_range_of_one_number_has_one_tick() {
        assert_eq!(Ticks::linear([2.0, 2.0], 5).labels, ["2"]);
        assert_eq!(Ticks::linear([-f64::MAX, f64::MAX], 5).values.len(), 1);
        assert!(!Ticks::linear([1e15, 1e15 + 0.25], 5).values.is_empty());
    }

    #[test]
    fn decades_are_marked_on_a_logarithmic_scale() {
        let ticks = Ticks::logarithmic([1e-6, 1e-1], 7);
        assert_eq!(
            ticks.labels,
            ["10⁻⁶", "10⁻⁵", "10⁻⁴", "10⁻³", "10⁻²", "10⁻¹"]
        );
        assert_eq!(
            Ticks::logarithmic([1.0, 20.0], 6).labels,
            ["1", "2", "5", "10", "20"]
        );
        assert!(Ticks::logarithmic([1e-300, 1e300], 6).values.len() <= 6);
        assert!(Ticks::logarithmic([1.01, 1.02], 6).values.len() >= 2);
    }

    #[test]
    fn numbers_are_written_short() {
        assert_eq!(scientific(0.25), "0.25");
        assert_eq!(scientific(1234.0), "1234");
        assert_eq!(scientific(2.5e-7), "2.5×10⁻⁷");
        assert_eq!(scientific(0.0), "0");
        assert_eq!(superscript(-120), "⁻¹²⁰");
    }
}
