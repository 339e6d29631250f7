//! Libraries are functions from values to values: no files, no printing, no clocks.

use super::Finding;
use super::code::{find_word, library_code, line_of};
use crate::tree::File;

/// A kind of effect, the words that betray it, and the packages that may have it.
struct Effect {
    words: &'static [&'static str],
    allowed: &'static [&'static str],
    remedy: &'static str,
}

const EFFECTS: [Effect; 3] = [
    Effect {
        words: &["fs", "File", "OpenOptions", "tempfile"],
        allowed: &[
            "crates/io",
            "crates/compare",
            "crates/cli",
            "xtask",
            "xtask/harness",
        ],
        remedy: "only io, compare, cli and xtask touch files; take or return a value",
    },
    Effect {
        words: &[
            "println",
            "eprintln",
            "print",
            "eprint",
            "stdout",
            "stderr",
            "indicatif",
        ],
        allowed: &["crates/compare", "crates/cli", "xtask", "xtask/harness"],
        remedy: "only compare, cli and xtask print; report through the observer",
    },
    Effect {
        words: &["Instant", "SystemTime", "env"],
        allowed: &["crates/compare", "crates/cli", "xtask", "xtask/harness"],
        remedy: "only compare, cli and xtask read clocks and the environment; take an argument",
    },
];

/// Finds effects where they do not belong.
pub(super) fn check(files: &[File]) -> Vec<Finding> {
    let mut findings = Vec::new();
    for file in files.iter().filter(|f| f.is_rust() && !f.is_apart()) {
        let code = library_code(file);
        for effect in EFFECTS
            .iter()
            .filter(|e| !e.allowed.contains(&file.package()))
        {
            for word in effect.words {
                for at in find_word(&code, word).filter(|&at| is_use(&code, at, word)) {
                    let text = format!("uses `{word}`: {}", effect.remedy);
                    findings.push(Finding::new(file, line_of(&code, at), text));
                }
            }
        }
    }
    findings
}

/// Printing words are macros or calls, module words stand in a path; variables of the same name
/// are neither.
fn is_use(code: &str, at: usize, word: &str) -> bool {
    let after = code[at + word.len()..].trim_start();
    let before = code[..at].trim_end();
    match word {
        "println" | "eprintln" | "print" | "eprint" => after.starts_with('!'),
        "stdout" | "stderr" => after.starts_with('('),
        "fs" | "env" => after.starts_with("::") || before.ends_with("std::") || in_std_list(before),
        _ => true,
    }
}

/// Whether the text ends inside of `use std::{..`.
fn in_std_list(before: &str) -> bool {
    before
        .rfind("std::{")
        .is_some_and(|start| !before[start..].contains('}'))
}

#[cfg(test)]
mod tests {
    use super::check;
    use crate::tree::File;

    fn count(path: &str, text: &str) -> usize {
        check(&[File::new(path, text)]).len()
    }

    #[test]
    fn a_library_that_reads_prints_or_times_is_found() {
        let path = "crates/biharmonic/src/fit.rs";
        assert_eq!(count(path, "use std::fs;"), 1);
        assert_eq!(count(path, "use std::{env, fs};"), 2);
        assert_eq!(count(path, "let f = File::open(p)?;"), 1);
        assert_eq!(count(path, "fn f() { println!(\"x\"); }"), 1);
        assert_eq!(count(path, "let t = std::time::Instant::now();"), 1);
        assert_eq!(count(path, "let v = std::env::var(\"X\");"), 1);
    }

    #[test]
    fn the_rooms_that_may_have_effects_may() {
        assert_eq!(count("crates/io/src/ply.rs", "use std::fs::File;"), 0);
        assert_eq!(count("crates/io/src/ply.rs", "fn f() { eprintln!(); }"), 1);
        assert_eq!(
            count(
                "crates/cli/src/main.rs",
                "println!(\"{:?}\", Instant::now());"
            ),
            0
        );
        assert_eq!(
            count(
                "crates/biharmonic/tests/models.rs",
                "println!(\"not run\");"
            ),
            0
        );
    }

    #[test]
    fn names_that_only_look_alike_are_left_alone() {
        assert_eq!(
            count(
                "crates/common/src/lib.rs",
                "// println!\nlet fs = 1; let print = fs;"
            ),
            0
        );
    }
}
