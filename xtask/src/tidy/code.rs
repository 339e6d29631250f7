//! The bare code of a Rust file: without comments, literals and test modules.

use crate::tree::File;

/// Returns the text with every comment, literal and `#[cfg(test)]` item blanked.
///
/// Lines and columns stay where they are, so that a finding can name its line.
pub(crate) fn library_code(file: &File) -> String {
    blank_test_items(&blank_literals(&file.text))
}

/// Returns the one-based line of a byte offset.
pub(crate) fn line_of(text: &str, offset: usize) -> usize {
    1 + text.as_bytes()[..offset]
        .iter()
        .filter(|&&byte| byte == b'\n')
        .count()
}

/// Returns the offsets where `word` stands by itself, not inside of a longer identifier.
pub(crate) fn find_word<'a>(code: &'a str, word: &'a str) -> impl Iterator<Item = usize> + 'a {
    let is_name = |byte: Option<&u8>| byte.is_some_and(|b| b.is_ascii_alphanumeric() || *b == b'_');
    code.match_indices(word)
        .map(|(start, _)| start)
        .filter(move |&start| {
            let bytes = code.as_bytes();
            let before = start.checked_sub(1).and_then(|at| bytes.get(at));
            !is_name(before) && !is_name(bytes.get(start + word.len()))
        })
}

/// Returns the text with comments, strings and character literals replaced by spaces.
pub(crate) fn blank_literals(text: &str) -> String {
    let bytes = text.as_bytes();
    let mut out = bytes.to_vec();
    let mut at = 0;
    while at < bytes.len() {
        let end = literal_end(bytes, at);
        if end == at {
            at += 1;
            continue;
        }
        for byte in &mut out[at..end] {
            if *byte != b'\n' {
                *byte = b' ';
            }
        }
        at = end;
    }
    // Every multi-byte character that is left stands in an identifier and is whole.
    String::from_utf8_lossy(&out).into_owned()
}

/// Returns the end of the comment or literal that starts at `at`, or `at` if none does.
fn literal_end(bytes: &[u8], at: usize) -> usize {
    let rest = &bytes[at..];
    let in_name = at > 0 && (bytes[at - 1].is_ascii_alphanumeric() || bytes[at - 1] == b'_');
    match rest {
        [b'/', b'/', ..] => at + rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len()),
        [b'/', b'*', ..] => at + block_comment_length(rest),
        [b'r', b'"' | b'#', ..] if !in_name => at + raw_string_length(rest, 1),
        [b'b', b'r', b'"' | b'#', ..] if !in_name => at + raw_string_length(rest, 2),
        [b'"', ..] => at + quoted_length(rest, b'"'),
        [b'\'', b'\\', ..] => at + quoted_length(rest, b'\''),
        [b'\'', ..] => at + character_length(rest),
        _ => at,
    }
}

fn block_comment_length(rest: &[u8]) -> usize {
    let mut depth = 0;
    let mut at = 0;
    while at + 1 < rest.len() {
        match &rest[at..at + 2] {
            b"/*" => depth += 1,
            b"*/" => depth -= 1,
            _ => {
                at += 1;
                continue;
            }
        }
        at += 2;
        if depth == 0 {
            return at;
        }
    }
    rest.len()
}

/// Length of `r#"..."#` whose letters take `prefix` bytes, or 0 for a raw identifier.
fn raw_string_length(rest: &[u8], prefix: usize) -> usize {
    let hashes = rest[prefix..].iter().take_while(|&&b| b == b'#').count();
    if rest.get(prefix + hashes) != Some(&b'"') {
        return 0;
    }
    let body = prefix + hashes + 1;
    let mut closing = vec![b'"'];
    closing.resize(hashes + 1, b'#');
    let found = rest[body..]
        .windows(closing.len())
        .position(|window| window == closing);
    found.map_or(rest.len(), |offset| body + offset + closing.len())
}

fn quoted_length(rest: &[u8], quote: u8) -> usize {
    let mut at = 1;
    while at < rest.len() {
        match rest[at] {
            b'\\' => at += 2,
            byte if byte == quote => return at + 1,
            _ => at += 1,
        }
    }
    rest.len()
}

/// Length of `'x'`, or 0 for a lifetime: a lifetime has no quote after its first character.
fn character_length(rest: &[u8]) -> usize {
    let width = match rest.get(1) {
        Some(0xF0..) => 4,
        Some(0xE0..) => 3,
        Some(0xC0..) => 2,
        _ => 1,
    };
    if rest.get(1 + width) == Some(&b'\'') {
        width + 2
    } else {
        0
    }
}

/// Blanks what follows each `#[cfg(test)]`, up to the end of its braces or its semicolon.
fn blank_test_items(code: &str) -> String {
    const MARK: &str = "#[cfg(test)]";
    let mut out = code.as_bytes().to_vec();
    for (start, _) in code.match_indices(MARK) {
        let mut depth = 0;
        for byte in &mut out[start + MARK.len()..] {
            let here = *byte;
            match here {
                b'{' => depth += 1,
                b'}' => depth -= 1,
                _ => {}
            }
            if here != b'\n' {
                *byte = b' ';
            }
            if depth == 0 && (here == b'}' || here == b';') {
                break;
            }
        }
    }
    String::from_utf8_lossy(&out).into_owned()
}

#[cfg(test)]
mod tests {
    use super::{blank_literals, blank_test_items, find_word, line_of};

    #[test]
    fn comments_and_literals_are_blanked_and_lines_stay() {
        let text = "a // x\nb /* y /* z */ */ c \"d\\\"e\" 'f' 'g: 'life r#\"h\"# r#match";
        let code = blank_literals(text);
        assert_eq!(code.len(), text.len());
        for gone in ["x", "y", "z", "d", "'f'", "h\""] {
            assert!(!code.contains(gone), "{gone} is left in {code}");
        }
        for kept in ["a", "b", "c", "'g", "'life", "r#match"] {
            assert!(code.contains(kept), "{kept} is lost from {code}");
        }
        assert_eq!(line_of(&code, code.find('c').unwrap_or(0)), 2);
    }

    #[test]
    fn test_items_are_blanked_and_what_follows_stays() {
        let code = "fn a() {}\n#[cfg(test)]\nmod tests { fn b() { c(); } }\nfn d() {}\n";
        let left = blank_test_items(code);
        assert!(left.contains("fn a") && left.contains("fn d"));
        assert!(!left.contains("fn b") && !left.contains("c()"));
    }

    #[test]
    fn a_word_is_not_found_inside_of_another() {
        assert_eq!(find_word("mesh remesh mesh_id (mesh)", "mesh").count(), 2);
    }
}
