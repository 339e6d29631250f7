//! Ended rows on disk, so that a run that was killed continues where it stopped.
//!
//! A row is one file `KEY.json` and, where it has any, a folder `KEY` with the files that pictures
//! are drawn from. The key is the hash of what is asked; the file says which program answered.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use msplines_io::sha256_file;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::case::{Case, Input};
use crate::input::{file_name, hexadecimal};
use crate::machine::Machine;
use crate::row_process::{HistoryPoint, RowAnswer};

/// The schema of a stored row.
pub const ROW_SCHEMA: &str = "msplines.row/2";

/// Ended rows in a folder.
#[derive(Clone, Debug)]
pub struct RowStore {
    folder: PathBuf,
    program: String,
}

/// A row that has ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EndedRow {
    /// Its record, or why there is none.
    pub answer: RowAnswer,
    /// What the optimisation minimised, over time.
    pub history: Vec<HistoryPoint>,
    /// Seconds that the row took in all, with what is kept for pictures.
    pub seconds: f64,
    /// Where it ran.
    pub machine: Machine,
}

/// One file of the store.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    schema: String,
    key: String,
    /// SHA-256 of the program that answered, as uncommitted changes do not show in its version.
    program: String,
    /// SHA-256 of the row as JSON: a file system that loses bytes is found out.
    digest: String,
    /// SHA-256 of the files in the folder of the row.
    files: BTreeMap<String, String>,
    row: EndedRow,
}

/// What the store has for a key.
#[derive(Clone, Debug, PartialEq)]
pub enum Stored {
    /// Nothing.
    Nothing,
    /// A row that this program ended.
    Ended(Box<EndedRow>),
    /// A row that another build of the program ended.
    Stale(Box<EndedRow>),
    /// A damaged file, now set aside under this name.
    Damaged(PathBuf),
}

impl RowStore {
    /// Opens the store in `folder`, which is made where it is missing, for the rows of `program`.
    ///
    /// # Errors
    /// A folder that cannot be made, or a program that cannot be read.
    pub fn open(folder: &Path, program: &Path) -> std::io::Result<Self> {
        std::fs::create_dir_all(folder)?;
        Ok(Self {
            folder: folder.to_owned(),
            program: sha256_file(program)?,
        })
    }

    /// Returns the folder for the files of a row.
    #[must_use]
    pub fn files(&self, key: &str) -> PathBuf {
        self.folder.join(key)
    }

    /// Returns the folder for the files of a row that has not ended, without what a row that was
    /// killed may have left there.
    ///
    /// # Errors
    /// A folder that cannot be removed.
    pub fn unfinished(&self, key: &str) -> std::io::Result<PathBuf> {
        let folder = self.folder.join(format!("{key}.part"));
        remove(std::fs::remove_dir_all(&folder))?;
        Ok(folder)
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
        match self.intact(&bytes, key) {
            Some(entry) if entry.program == self.program => Ok(Stored::Ended(Box::new(entry.row))),
            Some(entry) => Ok(Stored::Stale(Box::new(entry.row))),
            None => {
                let aside = path.with_extension("damaged");
                std::fs::rename(&path, &aside)?;
                Ok(Stored::Damaged(aside))
            }
        }
    }

    /// Stores a row with the files that lie in `files`: all of it or, if the process dies
    /// meanwhile, nothing. The folder is moved.
    ///
    /// # Errors
    /// A file that cannot be read or written.
    pub fn save(&self, key: &str, row: &EndedRow, files: &Path) -> std::io::Result<()> {
        let path = self.path(key);
        remove(std::fs::remove_file(&path))?;
        remove(std::fs::remove_dir_all(self.files(key)))?;
        if files.is_dir() {
            std::fs::rename(files, self.files(key))?;
        }
        let entry = Entry {
            schema: ROW_SCHEMA.to_owned(),
            key: key.to_owned(),
            program: self.program.clone(),
            digest: digest(row)?,
            files: digests(&self.files(key))?,
            row: row.clone(),
        };
        let bytes = serde_json::to_vec_pretty(&entry)?;
        msplines_io::write_atomically(&path, |out| out.write_all(&bytes))
            .map_err(std::io::Error::other)?;
        std::fs::File::open(&path)?.sync_all()
    }

    fn path(&self, key: &str) -> PathBuf {
        self.folder.join(format!("{key}.json"))
    }

    fn intact(&self, bytes: &[u8], key: &str) -> Option<Entry> {
        let entry: Entry = serde_json::from_slice(bytes).ok()?;
        let intact = entry.schema == ROW_SCHEMA
            && entry.key == key
            && digest(&entry.row).is_ok_and(|digest| digest == entry.digest)
            && digests(&self.files(key)).is_ok_and(|files| files == entry.files);
        intact.then_some(entry)
    }
}

/// Takes a file that was not there for removed.
fn remove(removed: std::io::Result<()>) -> std::io::Result<()> {
    match removed {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(()),
        other => other,
    }
}

fn digest(row: &EndedRow) -> serde_json::Result<String> {
    Ok(hexadecimal(&Sha256::digest(serde_json::to_vec(row)?)))
}

/// Returns the digests of the files of a folder, none where it is missing.
fn digests(folder: &Path) -> std::io::Result<BTreeMap<String, String>> {
    let mut digests = BTreeMap::new();
    if !folder.is_dir() {
        return Ok(digests);
    }
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        digests.insert(file_name(&path), sha256_file(&path)?);
    }
    Ok(digests)
}

/// Returns the hash of what is asked of a row: the case without its folders, the digests of the
/// files that it reads, and the number of threads.
///
/// # Errors
/// A file of another row that cannot be read.
pub fn row_key(case: &Case, input_digest: &str, threads: usize) -> std::io::Result<String> {
    let mut case = case.clone();
    if let Input::File { path, .. } = &mut case.input {
        *path = file_name(path).into();
    }
    let mut files = Vec::new();
    for path in case.files_mut() {
        files.push(sha256_file(path)?);
        *path = file_name(path).into();
    }
    let parts = serde_json::json!({
        "schema": ROW_SCHEMA,
        "case": case,
        "input": input_digest,
        "files": files,
        "threads": threads,
    });
    let digest = Sha256::digest(serde_json::to_vec(&parts)?);
    Ok(hexadecimal(&digest[..16]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::{Amount, Knots, Method};
    use crate::record::tests::sample;

    fn row() -> EndedRow {
        EndedRow {
            answer: RowAnswer::Record(Box::new(sample())),
            history: vec![HistoryPoint {
                seconds: 0.5,
                phase: "select".to_owned(),
                objective: 0.25,
            }],
            seconds: 2.0,
            machine: Machine::this(),
        }
    }

    struct Place {
        folder: tempfile::TempDir,
        store: RowStore,
    }

    fn place() -> Place {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let program = folder.path().join("program");
        std::fs::write(&program, "one").expect("written");
        let store = RowStore::open(&folder.path().join("rows"), &program).expect("opened");
        Place { folder, store }
    }

    impl Place {
        fn save(&self, key: &str) {
            let files = self.folder.path().join("files");
            std::fs::create_dir_all(&files).expect("made");
            std::fs::write(files.join("surface.ply"), "ply").expect("written");
            self.store.save(key, &row(), &files).expect("saved");
        }

        fn load(&self, key: &str) -> Stored {
            self.store.load(key).expect("readable")
        }
    }

    #[test]
    fn an_ended_row_is_found_again_with_its_files_and_no_other() {
        let place = place();
        assert_eq!(place.load("k"), Stored::Nothing);
        place.save("k");
        place.save("k");
        assert_eq!(place.load("k"), Stored::Ended(Box::new(row())));
        assert!(place.store.files("k").join("surface.ply").is_file());
        assert_eq!(place.load("other"), Stored::Nothing);
    }

    #[test]
    fn what_a_killed_row_left_does_not_stay() {
        let place = place();
        let folder = place.store.unfinished("k").expect("nothing there");
        std::fs::create_dir_all(&folder).expect("made");
        std::fs::write(folder.join("surface.ply"), "half").expect("written");
        assert_eq!(place.store.unfinished("k").expect("removed"), folder);
        assert!(!folder.exists());
    }

    #[test]
    fn a_row_of_another_program_is_stale() {
        let place = place();
        place.save("k");
        let program = place.folder.path().join("program");
        std::fs::write(&program, "two").expect("written");
        let rows = place.folder.path().join("rows");
        let store = RowStore::open(&rows, &program).expect("opened");
        let found = store.load("k").expect("readable");
        assert_eq!(found, Stored::Stale(Box::new(row())));
    }

    #[test]
    fn every_damage_is_set_aside_and_the_row_runs_again() {
        let place = place();
        place.save("k");
        let path = place.store.path("k");
        let good = std::fs::read(&path).expect("stored");
        let flipped = String::from_utf8(good.clone())
            .expect("text")
            .replace("0.0004", "0.0003");
        assert_ne!(flipped.as_bytes(), good);
        for bad in [&good[..good.len() / 2], b"", flipped.as_bytes()] {
            std::fs::write(&path, bad).expect("written");
            assert!(matches!(place.load("k"), Stored::Damaged(_)));
            assert_eq!(place.load("k"), Stored::Nothing);
        }
        std::fs::write(place.store.path("other"), &good).expect("written");
        assert!(matches!(place.load("other"), Stored::Damaged(_)));
    }

    #[test]
    fn a_lost_or_changed_file_of_a_row_is_a_damage() {
        let place = place();
        place.save("k");
        std::fs::write(place.store.files("k").join("surface.ply"), "other").expect("written");
        assert!(matches!(place.load("k"), Stored::Damaged(_)));
        place.save("k");
        std::fs::remove_dir_all(place.store.files("k")).expect("removed");
        assert!(matches!(place.load("k"), Stored::Damaged(_)));
    }

    #[test]
    fn the_key_changes_with_all_that_matters_but_not_with_folders() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let case = |path: &str| {
            let input = Input::File {
                path: path.into(),
                repair: false,
            };
            let knots = Knots::Optimised(Amount::Count(5));
            Case::new(input, Method::biharmonic(knots))
        };
        let key = |case: &Case, sha: &str, threads| row_key(case, sha, threads).expect("readable");
        let base = key(&case("a/m.ply"), "00", 2);
        assert_eq!(key(&case("b/m.ply"), "00", 2), base);
        let mut others = vec![
            key(&case("a/m.ply"), "01", 2),
            key(&case("a/m.ply"), "00", 1),
        ];
        let mut seeded = case("a/m.ply");
        seeded.seed = 1;
        others.push(key(&seeded, "00", 2));
        let points = folder.path().join("knots.ply");
        let mut placed = case("a/m.ply");
        placed.method = Method::biharmonic(Knots::Near(points.clone()));
        for text in ["one", "two"] {
            std::fs::write(&points, text).expect("written");
            others.push(key(&placed, "00", 2));
        }
        others.push(base);
        others.sort();
        others.dedup();
        assert_eq!(others.len(), 6);
    }
}
