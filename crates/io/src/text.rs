//! Lines and words of a text file, with the line number of each.

use crate::error::{Fault, Place};

/// The lines of a text, whatever ends them: `\n`, `\r\n` or `\r`.
pub(crate) struct Lines<'a> {
    rest: &'a [u8],
    number: u64,
}

impl<'a> Lines<'a> {
    /// Returns the lines of `bytes`; a byte order mark at their start is skipped.
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self {
            rest: without_mark(bytes),
            number: 0,
        }
    }

    /// Returns the lines of what follows line `number` of a larger text.
    pub(crate) fn after(rest: &'a [u8], number: u64) -> Self {
        Self { rest, number }
    }

    /// Returns the number of the line last returned.
    pub(crate) fn number(&self) -> u64 {
        self.number
    }

    /// Returns the line last returned as a place.
    pub(crate) fn place(&self) -> Place {
        Place::Line(self.number.max(1))
    }

    /// Returns what follows the line last returned.
    pub(crate) fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// Returns the next line that has words once what follows a `#` is dropped.
    pub(crate) fn next_with_words(&mut self) -> Option<Words<'a>> {
        loop {
            let line = self.next()?;
            let line = line.split(|&b| b == b'#').next().unwrap_or_default();
            let words = Words {
                rest: line,
                line: self.number,
            };
            if words.clone().next().is_some() {
                return Some(words);
            }
        }
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        self.number += 1;
        let end = self.rest.iter().position(|&b| b == b'\n' || b == b'\r');
        let end = end.unwrap_or(self.rest.len());
        let (line, tail) = self.rest.split_at(end);
        self.rest = match tail {
            [b'\r', b'\n', rest @ ..] | [_, rest @ ..] => rest,
            [] => tail,
        };
        Some(line)
    }
}

/// The words of one line, separated by white space.
#[derive(Clone)]
pub(crate) struct Words<'a> {
    rest: &'a [u8],
    line: u64,
}

impl<'a> Words<'a> {
    /// Returns the words of line number `line`.
    pub(crate) fn new(text: &'a [u8], line: u64) -> Self {
        Self { rest: text, line }
    }

    /// Returns what follows the word last returned.
    pub(crate) fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// Returns where these words are.
    pub(crate) fn place(&self) -> Place {
        Place::Line(self.line)
    }

    /// Returns the next word as a number; `what` names it in the error.
    pub(crate) fn number(&mut self, what: &str) -> Result<f64, Fault> {
        match self.next() {
            Some(word) => number(word, what, || self.place()),
            None => Err(self.missing(what)),
        }
    }

    /// Returns the next word as a whole number; `what` names it in the error.
    pub(crate) fn integer(&mut self, what: &str) -> Result<i64, Fault> {
        match self.next() {
            Some(word) => integer(word, what, || self.place()),
            None => Err(self.missing(what)),
        }
    }

    fn missing(&self, what: &str) -> Fault {
        Fault::malformed(
            self.place(),
            format!("the line ends where {what} is expected"),
        )
    }
}

impl<'a> Iterator for Words<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let start = self.rest.iter().position(|b| !is_space(*b))?;
        let rest = &self.rest[start..];
        let end = rest.iter().position(|b| is_space(*b)).unwrap_or(rest.len());
        let (word, rest) = rest.split_at(end);
        self.rest = rest;
        Some(word)
    }
}

/// Returns whether a byte separates words.
pub(crate) fn is_space(byte: u8) -> bool {
    byte.is_ascii_whitespace() || byte == 0x0b
}

/// Returns `bytes` without the byte order mark some editors put in front.
pub(crate) fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

/// Returns a word as a number: decimal, or `nan` and `inf` in any case.
pub(crate) fn number(word: &[u8], what: &str, place: impl Fn() -> Place) -> Result<f64, Fault> {
    let parsed = std::str::from_utf8(word)
        .ok()
        .and_then(|word| word.parse().ok());
    parsed.ok_or_else(|| {
        let problem = format!("{what} is {}, which is no number", quoted(word));
        Fault::malformed(place(), problem)
    })
}

/// Returns a word as a whole number.
pub(crate) fn integer(word: &[u8], what: &str, place: impl Fn() -> Place) -> Result<i64, Fault> {
    let parsed = std::str::from_utf8(word)
        .ok()
        .and_then(|word| word.parse().ok());
    parsed.ok_or_else(|| {
        let problem = format!("{what} is {}, which is no whole number", quoted(word));
        Fault::malformed(place(), problem)
    })
}

/// Returns a word fit for a message: printable, quoted and short.
pub(crate) fn quoted(word: &[u8]) -> String {
    const SHOWN: usize = 40;
    let shown = word[..word.len().min(SHOWN)].escape_ascii();
    let more = if word.len() > SHOWN { "…" } else { "" };
    format!("`{shown}{more}`")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_ending_counts_one_line() {
        let mut lines = Lines::new(b"a\nb\r\nc\rd\r\n\r\ne");
        let seen: Vec<_> = lines.by_ref().collect();
        assert_eq!(seen, [b"a".as_slice(), b"b", b"c", b"d", b"", b"e"]);
        assert_eq!(lines.number(), 6);
    }

    #[test]
    fn comments_and_blank_lines_are_passed_but_counted() {
        let mut lines = Lines::new(b"\xef\xbb\xbf# note\n\n  \n1 2 # tail\n");
        let words: Vec<_> = lines.next_with_words().unwrap().collect();
        assert_eq!(words, [b"1", b"2"]);
        assert_eq!(lines.number(), 4);
        assert!(lines.next_with_words().is_none());
    }

    #[test]
    fn a_bad_number_is_told_with_its_line() {
        let fault = Words::new(b" 1x ", 7).number("x").unwrap_err();
        let expected = Fault::malformed(Place::Line(7), "x is `1x`, which is no number");
        assert_eq!(fault, expected);
    }
}
