//! Same input, options and seed give the same bits on any number of threads.

use super::Finding;
use super::code::{find_word, library_code, line_of};
use crate::tree::File;

/// Containers whose order of iteration differs from run to run, and unseeded randomness.
const UNORDERED: [&str; 8] = [
    "HashMap",
    "HashSet",
    "RandomState",
    "DashMap",
    "thread_rng",
    "from_os_rng",
    "from_entropy",
    "ThreadRng",
];

/// Files that may use a word of the list above, with the reason.
const ALLOWED: [(&str, &str, &str); 0] = [];

/// What starts a parallel iterator.
const PARALLEL: [&str; 8] = [
    "par_iter",
    "par_iter_mut",
    "into_par_iter",
    "par_chunks",
    "par_chunks_exact",
    "par_chunks_mut",
    "par_bridge",
    "par_windows",
];
/// Reductions whose order depends on how the work was split.
const REDUCTIONS: [&str; 5] = ["sum", "product", "reduce", "reduce_with", "fold"];
/// Comment that says why a reduction does not depend on its order.
const EXCUSE: &str = "// order-free:";

/// Finds what would make results depend on a run or on the number of threads.
pub(super) fn check(files: &[File]) -> Vec<Finding> {
    let libraries = files
        .iter()
        .filter(|f| f.is_rust() && f.path.starts_with("crates/") && !f.is_apart());
    libraries.flat_map(check_file).collect()
}

fn check_file(file: &File) -> Vec<Finding> {
    let code = library_code(file);
    let mut findings = Vec::new();
    for word in UNORDERED {
        let allowed = ALLOWED
            .iter()
            .any(|(path, name, _)| *path == file.path && *name == word);
        for at in find_word(&code, word).filter(|_| !allowed) {
            let text = format!(
                "uses `{word}`, which differs from run to run; use an ordered container or a seed"
            );
            findings.push(Finding::new(file, line_of(&code, at), text));
        }
    }
    for start in PARALLEL.iter().flat_map(|word| find_word(&code, word)) {
        let Some((at, name)) = reduction_in_chain(&code, start) else {
            continue;
        };
        let line = line_of(&code, at);
        if !has_excuse(&file.text, line) {
            let text = format!(
                "`{name}` over a parallel iterator depends on the split; collect parts of fixed size and add them in order, or say `{EXCUSE} why`"
            );
            findings.push(Finding::new(file, line, text));
        }
    }
    findings
}

/// Returns the first reduction called in the method chain that goes on at `start`.
fn reduction_in_chain(code: &str, start: usize) -> Option<(usize, &'static str)> {
    let bytes = code.as_bytes();
    let mut depth = 0_i32;
    for (at, &byte) in bytes.iter().enumerate().skip(start) {
        match byte {
            b'(' | b'[' | b'{' => depth += 1,
            b')' | b']' | b'}' => depth -= 1,
            b';' | b',' if depth == 0 => return None,
            b'.' if depth == 0 => {
                let rest = &code[at + 1..];
                let name = rest
                    .split(|c: char| !c.is_alphanumeric() && c != '_')
                    .next();
                if let Some(found) = REDUCTIONS.iter().find(|word| Some(**word) == name) {
                    return Some((at, found));
                }
            }
            _ => {}
        }
        if depth < 0 {
            return None;
        }
    }
    None
}

/// Whether the line, or the comment right above it, says why its order does not matter.
fn has_excuse(text: &str, line: usize) -> bool {
    let lines: Vec<&str> = text.lines().collect();
    let above = lines[..line - 1]
        .iter()
        .rev()
        .take_while(|l| l.trim_start().starts_with("//"));
    above.chain(lines.get(line - 1)).any(|l| l.contains(EXCUSE))
}

#[cfg(test)]
mod tests {
    use super::check;
    use crate::tree::File;

    fn count(text: &str) -> usize {
        check(&[File::new("crates/common/src/x.rs", text)]).len()
    }

    #[test]
    fn unordered_containers_and_unseeded_randomness_are_found() {
        assert_eq!(count("use std::collections::HashMap;"), 1);
        assert_eq!(count("let mut rng = rand::thread_rng();"), 1);
        assert_eq!(count("use std::collections::BTreeMap;"), 0);
    }

    #[test]
    fn a_parallel_sum_is_found_and_a_sum_inside_of_a_task_is_not() {
        assert_eq!(count("let s: f64 = v.par_iter().map(|x| x * x).sum();"), 1);
        assert_eq!(
            count("let s = v.par_chunks(8).map(|c| c.iter().sum::<f64>()).collect();"),
            0
        );
        assert_eq!(
            count("v.par_iter_mut().for_each(|x| *x = 0.0); let s: f64 = v.iter().sum();"),
            0
        );
    }

    #[test]
    fn a_reason_excuses_a_reduction() {
        let text = "let m = v.par_iter().copied()\n    // order-free: largest integer\n    .reduce(|| 0, u32::max);";
        assert_eq!(count(text), 0);
    }
}
