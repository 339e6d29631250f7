//! Laws of the command line.

use clap::Parser;
use msplines_cli::Arguments;

/// Holds the command line to its laws: one argument a line, each number of which is finite.
pub fn arguments(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    match Arguments::try_parse_from(["msplines"].into_iter().chain(text.lines())) {
        Ok(arguments) => {
            let told = format!("{arguments:?}");
            // Names of files stand in quotes.
            let mut told = told.replace("\\\"", "");
            while let Some((before, (_, after))) = told
                .split_once('"')
                .and_then(|(before, rest)| Some((before, rest.split_once('"')?)))
            {
                told = format!("{before}{after}");
            }
            let odd = told
                .split(|c: char| !c.is_alphanumeric())
                .find(|word| matches!(*word, "NaN" | "inf"));
            assert_eq!(odd, None, "{told}");
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}
