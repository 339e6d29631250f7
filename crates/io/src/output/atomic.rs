//! Files that are whole or absent.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use tempfile::NamedTempFile;

use super::WriteError;

/// How the names of unfinished files begin and end.
const UNFINISHED: (&str, &str) = (".msplines-", ".tmp");

/// Writes a file beside `path` and renames it to `path`, which so holds either its old content or
/// all of the new. On an error nothing is left behind.
///
/// A process that is killed leaves `.msplines-XXXXXX.tmp` there, which the next write into the
/// folder removes: a file is locked while it is written, so that one without a lock has no writer.
///
/// # Errors
/// The file cannot be written, or `write` fails.
pub fn write_atomically(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), WriteError> {
    replace(path, write).map_err(|source| WriteError::Io {
        path: path.to_owned(),
        source,
    })
}

fn replace(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    remove_abandoned(folder);
    let file = unfinished(folder)?;
    let mut buffered = BufWriter::with_capacity(1 << 16, file);
    write(&mut buffered)?;
    let file = buffered
        .into_inner()
        .map_err(io::IntoInnerError::into_error)?;
    file.persist(path)?;
    Ok(())
}

/// Returns a new file that is locked, where the file system can lock.
fn unfinished(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(UNFINISHED.0).suffix(UNFINISHED.1);
    #[cfg(unix)]
    builder.permissions(ordinary_permissions());
    loop {
        let file = builder.tempfile_in(folder)?;
        // Without locks nobody takes it for abandoned either. Between its making and its lock
        // somebody may have: then it is gone, and the next one is tried.
        if file.as_file().lock().is_err() || file.path().exists() {
            return Ok(file);
        }
    }
}

/// Removes what killed writers left in a folder. What cannot be removed stays: it harms nobody.
fn remove_abandoned(folder: &Path) {
    let Ok(entries) = folder.read_dir() else {
        return;
    };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        if !name.starts_with(UNFINISHED.0) || !name.ends_with(UNFINISHED.1) {
            continue;
        }
        let path = entry.path();
        if let Ok(file) = File::options().write(true).open(&path)
            && file.try_lock().is_ok()
        {
            // The lock is held until it is gone, so that its maker, if there is one, sees that.
            let _ = std::fs::remove_file(&path);
        }
    }
}

/// Returns what an ordinary new file gets, before the user's mask; temporary ones are private.
#[cfg(unix)]
fn ordinary_permissions() -> std::fs::Permissions {
    use std::os::unix::fs::PermissionsExt;
    std::fs::Permissions::from_mode(0o666)
}
