//! Words, lines and binary numbers of a file, one after another.

use crate::error::{Fault, Place};
use crate::text::{self, is_space, without_mark};

/// A place in a file that may be text and binary by turns.
#[derive(Clone)]
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        let at = bytes.len() - without_mark(bytes).len();
        Self { bytes, at }
    }

    /// Returns what follows.
    pub(super) fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    /// Returns the line reached. Counts from the start of the file: for errors.
    pub(super) fn line_place(&self) -> Place {
        let before = &self.bytes[..self.at.min(self.bytes.len())];
        let mut ends = before.iter().filter(|&&b| b == b'\n').count();
        if ends == 0 {
            ends = before.iter().filter(|&&b| b == b'\r').count();
        }
        Place::Line(ends as u64 + 1)
    }

    /// Returns the byte reached.
    pub(super) fn byte_place(&self) -> Place {
        Place::Byte(self.at as u64)
    }

    /// Returns what is left of this line, and passes on to the next.
    pub(super) fn line(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest();
        if rest.is_empty() {
            return None;
        }
        let end = rest.iter().position(|&b| b == b'\n' || b == b'\r');
        let end = end.unwrap_or(rest.len());
        self.at += match &rest[end..] {
            [b'\r', b'\n', ..] => end + 2,
            [] => end,
            _ => end + 1,
        };
        Some(&rest[..end])
    }

    /// Returns the next word, and leaves what follows it.
    pub(super) fn word(&mut self) -> Option<&'a [u8]> {
        let start = self.rest().iter().position(|&b| !is_space(b))?;
        self.at += start;
        let rest = self.rest();
        let end = rest.iter().position(|&b| is_space(b)).unwrap_or(rest.len());
        self.at += end;
        Some(&rest[..end])
    }

    /// Returns the next word that is in no comment after `#`.
    pub(super) fn uncommented(&mut self) -> Option<&'a [u8]> {
        loop {
            let word = self.word()?;
            match word.iter().position(|&b| b == b'#') {
                None => return Some(word),
                Some(place) => {
                    self.at -= word.len() - place;
                    self.line();
                    if place > 0 {
                        return Some(&word[..place]);
                    }
                }
            }
        }
    }

    /// Returns the next word, which must be there; `what` names it in the error.
    pub(super) fn expect(&mut self, what: &str) -> Result<&'a [u8], Fault> {
        let word = self.uncommented();
        word.ok_or_else(|| self.ends_before(what))
    }

    pub(super) fn ends_before(&self, what: &str) -> Fault {
        Fault::truncated(self.line_place(), format!("{what} is missing"))
    }

    pub(super) fn number(&mut self, what: &str) -> Result<f64, Fault> {
        let word = self.expect(what)?;
        text::number(word, what, || self.line_place())
    }

    pub(super) fn integer(&mut self, what: &str) -> Result<i64, Fault> {
        let word = self.expect(what)?;
        text::integer(word, what, || self.line_place())
    }

    /// Returns the next word as a number of things of which each takes `least` bytes or more.
    pub(super) fn count(&mut self, what: &str, least: usize) -> Result<usize, Fault> {
        let claimed = self.integer(what)?;
        self.check_room(what, claimed, least)
    }

    /// Refuses counts that the rest of the file cannot hold, before anything is done for them.
    pub(super) fn check_room(
        &self,
        what: &str,
        claimed: i64,
        least: usize,
    ) -> Result<usize, Fault> {
        let count = usize::try_from(claimed)
            .map_err(|_| Fault::malformed(self.line_place(), format!("{what} is {claimed}")))?;
        // The last item may end with the file instead of a space.
        let room = (self.rest().len() + 1) / least;
        if count <= room {
            return Ok(count);
        }
        let problem = format!("{what} is {count}, there is room for at most {room}");
        Err(Fault::truncated(self.line_place(), problem))
    }

    /// Returns the next bytes.
    pub(super) fn take<const N: usize>(&mut self, what: &str) -> Result<[u8; N], Fault> {
        let Some(taken) = self.rest().first_chunk::<N>() else {
            return Err(Fault::truncated(
                self.byte_place(),
                format!("{what} is missing"),
            ));
        };
        self.at += N;
        Ok(*taken)
    }

    /// Passes over bytes.
    pub(super) fn skip(&mut self, count: usize, what: &str) -> Result<(), Fault> {
        if count > self.rest().len() {
            let problem = format!("{what} is missing");
            return Err(Fault::truncated(self.byte_place(), problem));
        }
        self.at += count;
        Ok(())
    }
}
