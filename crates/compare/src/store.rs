//! Finished rows on disk, so that a run that was killed continues where it stopped.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::case::{Case, Input};
use msplines_io::sha256_file;

use crate::input::{file_name, hexadecimal};
use crate::record::{Record, Tool};

/// The schema of a stored row.
pub const ROW_SCHEMA: &str = "msplines.row/1";

/// Finished rows in a folder, each in a file named by the hash of everything that matters to it.
#[derive(Clone, Debug)]
pub struct RowStore {
    folder: PathBuf,
}

/// One stored row.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    schema: String,
    key: String,
    /// SHA-256 of the record as JSON: a file system that loses bytes is found out.
    digest: String,
    record: Record,
}

/// What the store has for a key.
#[derive(Clone, Debug, PartialEq)]
pub enum Stored {
    /// Nothing.
    Nothing,
    /// The record of a finished row.
    Finished(Box<Record>),
    /// A damaged file, now set aside under this name.
    Damaged(PathBuf),
}

impl RowStore {
    /// Opens the store in `folder`, which is made where it is missing.
    ///
    /// # Errors
    /// A folder that cannot be made.
    pub fn open(folder: &Path) -> std::io::Result<Self> {
        std::fs::create_dir_all(folder)?;
        Ok(Self {
            folder: folder.to_owned(),
        })
    }

    /// Returns what is stored under `key`, and sets a damaged file aside.
    ///
    /// # Errors
    /// A damaged file that cannot be renamed, or a file that cannot be read.
    pub fn load(&self, key: &str) -> std::io::Result<Stored> {
        let path = self.path(key);
        let bytes = match std::fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                return Ok(Stored::Nothing);
            }
            Err(error) => return Err(error),
        };
        if let Some(record) = intact_record(&bytes, key) {
            return Ok(Stored::Finished(Box::new(record)));
        }
        let aside = path.with_extension("damaged");
        std::fs::rename(&path, &aside)?;
        Ok(Stored::Damaged(aside))
    }

    /// Stores a finished row: all of it or, if the process dies meanwhile, nothing.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn save(&self, key: &str, record: &Record) -> std::io::Result<()> {
        let entry = Entry {
            schema: ROW_SCHEMA.to_owned(),
            key: key.to_owned(),
            digest: record_digest(record)?,
            record: record.clone(),
        };
        let mut file = tempfile::NamedTempFile::new_in(&self.folder)?;
        serde_json::to_writer_pretty(&mut file, &entry)?;
        file.as_file().sync_all()?;
        file.persist(self.path(key))?;
        Ok(())
    }

    fn path(&self, key: &str) -> PathBuf {
        self.folder.join(format!("{key}.json"))
    }
}

fn intact_record(bytes: &[u8], key: &str) -> Option<Record> {
    let entry: Entry = serde_json::from_slice(bytes).ok()?;
    let intact = entry.schema == ROW_SCHEMA
        && entry.key == key
        && record_digest(&entry.record).is_ok_and(|digest| digest == entry.digest);
    intact.then_some(entry.record)
}

fn record_digest(record: &Record) -> serde_json::Result<String> {
    Ok(hexadecimal(&Sha256::digest(serde_json::to_vec(record)?)))
}

/// Returns the hash of everything that the figures of a row depend on: the case without its
/// folders, the digest of its input, the program that runs it and the number of threads.
///
/// # Errors
/// A program that cannot be read.
pub fn row_key(
    case: &Case,
    input_digest: &str,
    program: &Path,
    threads: usize,
) -> std::io::Result<String> {
    let mut case = case.clone();
    if let Input::File { path, .. } = &mut case.input {
        *path = file_name(path).into();
    }
    // The digest of the program, as uncommitted changes do not show in its version.
    let parts = serde_json::json!({
        "schema": ROW_SCHEMA,
        "case": case,
        "input": input_digest,
        "tool": Tool::this(),
        "program": sha256_file(program)?,
        "threads": threads,
    });
    Ok(hexadecimal(&Sha256::digest(serde_json::to_vec(&parts)?)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::{Amount, Method};
    use crate::record::tests::sample;

    fn store() -> (tempfile::TempDir, RowStore) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let store = RowStore::open(&folder.path().join("rows")).expect("opened");
        (folder, store)
    }

    #[test]
    fn a_finished_row_is_found_again_and_no_other() {
        let (_folder, store) = store();
        assert_eq!(store.load("k").expect("readable"), Stored::Nothing);
        store.save("k", &sample()).expect("saved");
        assert_eq!(
            store.load("k").expect("readable"),
            Stored::Finished(Box::new(sample()))
        );
        assert_eq!(store.load("other").expect("readable"), Stored::Nothing);
    }

    #[test]
    fn every_damage_is_set_aside_and_the_row_runs_again() {
        let (_folder, store) = store();
        store.save("k", &sample()).expect("saved");
        let path = store.path("k");
        let good = std::fs::read(&path).expect("stored");
        let flipped = String::from_utf8(good.clone())
            .expect("text")
            .replace("0.0004", "0.0003");
        assert_ne!(flipped.as_bytes(), good);
        for bad in [&good[..good.len() / 2], b"", flipped.as_bytes()] {
            std::fs::write(&path, bad).expect("written");
            assert!(matches!(
                store.load("k").expect("readable"),
                Stored::Damaged(_)
            ));
            assert_eq!(store.load("k").expect("readable"), Stored::Nothing);
        }
        std::fs::rename(path.with_extension("damaged"), store.path("other")).expect("renamed");
        std::fs::write(store.path("other"), &good).expect("written");
        assert!(matches!(
            store.load("other").expect("readable"),
            Stored::Damaged(_)
        ));
    }

    #[test]
    fn the_key_changes_with_all_that_matters_but_not_with_folders() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let program = folder.path().join("program");
        std::fs::write(&program, "one").expect("written");
        let input = |path: &str| Input::File {
            path: path.into(),
            repair: false,
        };
        let case = |path: &str| Case::new(input(path), Method::biharmonic(Amount::Count(5)));
        let key = |case: &Case, sha: &str, threads| {
            row_key(case, sha, &program, threads).expect("a readable program")
        };
        let base = key(&case("a/m.ply"), "00", 2);
        assert_eq!(key(&case("b/m.ply"), "00", 2), base);
        let mut more = case("a/m.ply");
        more.method = Method::biharmonic(Amount::Count(6));
        let mut seeded = case("a/m.ply");
        seeded.seed = 1;
        let mut others = vec![
            key(&more, "00", 2),
            key(&seeded, "00", 2),
            key(&case("a/m.ply"), "01", 2),
            key(&case("a/m.ply"), "00", 1),
        ];
        std::fs::write(&program, "two").expect("written");
        others.push(key(&case("a/m.ply"), "00", 2));
        assert!(others.iter().all(|other| *other != base));
    }
}
