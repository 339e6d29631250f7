//! The section of other libraries on the same work, if they were compared.

use std::path::Path;

use serde::Serialize;

use crate::peers::{self, FILE, HEAD, Peers};

/// What the template shows.
#[derive(Serialize)]
pub(super) struct Section {
    /// Why the record cannot be shown.
    error: Option<String>,
    conditions: String,
    slow: Vec<String>,
    header: [&'static str; HEAD.len()],
    tasks: Vec<Task>,
    remarks: Vec<String>,
}

#[derive(Serialize)]
struct Task {
    name: String,
    measure: String,
    rows: Vec<[String; HEAD.len()]>,
}

/// Returns the section of the record in a folder, or none without one.
pub(super) fn section(folder: &Path) -> Option<Section> {
    let path = folder.join(FILE);
    path.exists().then(|| match Peers::read(&path) {
        Ok(peers) => shown(&peers),
        Err(error) => Section {
            error: Some(error),
            conditions: String::new(),
            slow: Vec::new(),
            header: HEAD,
            tasks: Vec::new(),
            remarks: Vec::new(),
        },
    })
}

fn shown(peers: &Peers) -> Section {
    let mut tasks: Vec<Task> = Vec::new();
    for row in &peers.rows {
        if tasks.last().is_none_or(|task| task.name != row.task) {
            tasks.push(Task {
                name: row.task.clone(),
                measure: row.measure.clone(),
                rows: Vec::new(),
            });
        }
        if let Some(task) = tasks.last_mut() {
            task.rows.push(peers::cells(row));
        }
    }
    Section {
        error: None,
        conditions: peers::conditions(peers),
        slow: peers::slow_steps(peers),
        header: HEAD,
        tasks,
        remarks: peers::remarks(peers),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_is_no_section_without_a_record_and_one_that_says_what_is_wrong_with_a_bad_one() {
        let folder = tempfile::tempdir().expect("a folder");
        assert!(section(folder.path()).is_none());
        std::fs::write(folder.path().join(FILE), "{}").expect("a file");
        let section = section(folder.path()).expect("a section");
        assert!(section.error.expect("an error").contains(FILE));
    }
}
