//! The text of ISO 10303-21: numbered entities, lists and numbers.

use std::fmt;
use std::io::{self, Write};

/// Items of a list after which a line ends: a list of all faces is no line for an editor.
const ITEMS_OF_A_LINE: usize = 16;

/// The number by which other entities name one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Id(u64);

impl fmt::Display for Id {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{}", self.0)
    }
}

/// Entities, numbered as they come.
pub(super) struct Entities<'a> {
    to: &'a mut dyn Write,
    count: u64,
}

impl<'a> Entities<'a> {
    pub(super) fn of(to: &'a mut dyn Write) -> Self {
        Self { to, count: 0 }
    }

    /// Writes an entity and returns its number.
    pub(super) fn add(&mut self, entity: fmt::Arguments<'_>) -> io::Result<Id> {
        self.count += 1;
        let id = Id(self.count);
        writeln!(self.to, "{id}={entity};")?;
        Ok(id)
    }
}

/// A number with a point, as the format wants it, and no more digits than it takes to come back.
#[derive(Clone, Copy)]
pub(super) struct Real(pub(super) f64);

impl fmt::Display for Real {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = format!("{:?}", self.0);
        let Some((digits, exponent)) = text.split_once('e') else {
            return f.write_str(
                text.strip_suffix('0')
                    .filter(|t| t.ends_with('.'))
                    .unwrap_or(&text),
            );
        };
        let point = if digits.contains('.') { "" } else { "." };
        write!(f, "{digits}{point}E{exponent}")
    }
}

/// A list.
pub(super) struct List<'a, T>(pub(super) &'a [T]);

impl<T: fmt::Display> fmt::Display for List<'_, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (at, item) in self.0.iter().enumerate() {
            f.write_str(match at {
                0 => "(",
                at if at % ITEMS_OF_A_LINE == 0 => ",\n",
                _ => ",",
            })?;
            item.fmt(f)?;
        }
        f.write_str(")")
    }
}

/// A list of lists of this length.
pub(super) struct Rows<'a, T>(pub(super) &'a [T], pub(super) usize);

impl<T: fmt::Display> fmt::Display for Rows<'_, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rows: Vec<List<'_, T>> = self.0.chunks(self.1).map(List).collect();
        List(&rows).fmt(f)
    }
}

/// How often the knots 0 and 1 of a single span of this degree are repeated.
pub(super) struct Knots(pub(super) usize);

impl fmt::Display for Knots {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "({0},{0})", self.0 + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_a_point_and_come_back() {
        for (x, text) in [
            (0.0, "0."),
            (-0.0, "-0."),
            (1.0, "1."),
            (10.0, "10."),
            (-0.25, "-0.25"),
            (0.1, "0.1"),
            (1.05e-7, "1.05E-7"),
            (1e-7, "1.E-7"),
            (-3e22, "-3.E22"),
            (0.1 + 0.2, "0.30000000000000004"),
            (f64::MAX, "1.7976931348623157E308"),
            (5e-324, "5.E-324"),
        ] {
            let written = Real(x).to_string();
            assert_eq!(written, text);
            let read: f64 = written.parse().unwrap();
            assert_eq!(read.to_bits(), x.to_bits(), "{text}");
        }
    }

    #[test]
    fn lists_break_their_lines() {
        let items: Vec<usize> = (0..ITEMS_OF_A_LINE + 2).collect();
        let text = List(&items).to_string();
        assert_eq!(text, "(0,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,\n16,17)");
        assert_eq!(Rows(&items[..4], 2).to_string(), "((0,1),(2,3))");
    }
}
