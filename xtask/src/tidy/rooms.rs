//! What belongs where inside of a crate.

use super::Finding;
use super::code::{find_word, library_code, line_of};
use super::layers::METHODS;
use crate::tree::File;

/// Folder, words its code may not use, and why.
const FOREIGN: [(&str, &[&str], &str); 2] = [
    (
        "crates/common/src/mesh/",
        &["linalg", "operators", "metrics", "faer"],
        "a mesh knows no matrices; what needs both belongs in operators",
    ),
    (
        "crates/common/src/linalg/",
        &["mesh", "operators", "metrics", "TriangleMesh"],
        "linear algebra knows no geometry; what needs both belongs in operators",
    ),
];

/// Files that every method crate has; one of each row is enough.
const ROOMS: [&[&str]; 4] = [&["lib"], &["options"], &["fit"], &["domain", "space"]];

/// Finds code in the wrong room, and method crates without the rooms they share.
pub(super) fn check(files: &[File]) -> Vec<Finding> {
    let mut findings = Vec::new();
    for file in files.iter().filter(|f| f.is_rust()) {
        for (folder, words, reason) in FOREIGN {
            if !file.path.starts_with(folder) || file.is_apart() {
                continue;
            }
            let code = library_code(file);
            for word in words {
                for at in find_word(&code, word) {
                    let text = format!("uses `{word}`: {reason}");
                    findings.push(Finding::new(file, line_of(&code, at), text));
                }
            }
        }
    }
    findings.extend(
        METHODS
            .iter()
            .flat_map(|method| missing_rooms(files, method)),
    );
    findings
}

fn missing_rooms(files: &[File], method: &str) -> Vec<Finding> {
    let manifest = format!("{method}/Cargo.toml");
    let Some(manifest) = files.iter().find(|f| f.path == manifest) else {
        return Vec::new();
    };
    let has = |room: &str| {
        let (file, folder) = (
            format!("{method}/src/{room}.rs"),
            format!("{method}/src/{room}/"),
        );
        files
            .iter()
            .any(|f| f.path == file || f.path.starts_with(&folder))
    };
    let missing = ROOMS
        .iter()
        .filter(|rooms| !rooms.iter().any(|room| has(room)));
    missing
        .map(|rooms| {
            let text = format!(
                "has no src/{}.rs, which every method has",
                rooms.join(".rs or src/")
            );
            Finding::new(manifest, 0, text)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::check;
    use crate::tree::File;

    #[test]
    fn a_mesh_may_speak_of_matrices_but_not_use_them() {
        let path = "crates/common/src/mesh/triangle.rs";
        assert!(check(&[File::new(path, "// see linalg\nfn f() {}")]).is_empty());
        let findings = check(&[File::new(path, "\nuse crate::linalg::Cholesky;")]);
        assert_eq!(findings.len(), 1);
        assert_eq!(findings[0].line, 2);
    }

    #[test]
    fn linear_algebra_uses_no_mesh_outside_of_its_tests() {
        let path = "crates/common/src/linalg/cholesky.rs";
        assert_eq!(
            check(&[File::new(path, "use crate::mesh::TriangleMesh;")]).len(),
            2
        );
        let tested = "#[cfg(test)]\nmod tests { use crate::mesh::TriangleMesh; }";
        assert!(check(&[File::new(path, tested)]).is_empty());
    }

    #[test]
    fn a_method_without_options_is_found() {
        let method = |rooms: &[&str]| -> Vec<File> {
            rooms
                .iter()
                .map(|room| File::new(&format!("crates/t-spline/{room}"), ""))
                .collect()
        };
        let whole = [
            "Cargo.toml",
            "src/lib.rs",
            "src/options.rs",
            "src/fit/mod.rs",
            "src/space.rs",
        ];
        assert!(check(&method(&whole)).is_empty());
        assert_eq!(check(&method(&whole[..2])).len(), 3);
    }
}
