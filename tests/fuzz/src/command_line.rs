//! Laws of the command line.

use clap::Parser;
use msplines_cli::Arguments;

/// Holds the command line to its laws: one argument a line, understood or refused with a text.
pub fn arguments(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    if let Err(error) = Arguments::try_parse_from(["msplines"].into_iter().chain(text.lines())) {
        assert!(!error.to_string().is_empty());
    }
}
