//! Files on their way to their places, and those that ended runs have left behind.
//!
//! A temporary file is named after its place and locked as long as its process lives: the system unlocks the files of a
//! process that ends, however it ends. So a file of such a name that another process can lock is one that nobody will
//! rename any more. Where a file system has no locks, none is removed.

use crate::digest::digest;
use std::collections::{HashMap, HashSet};
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use tempfile::{Builder, NamedTempFile};

/// Digits of the place's name: of its digest, because a name may be as long as the system allows.
const DIGITS: usize = 16;
/// Letters by which the temporary files of one place differ.
const LETTERS: usize = 6;
/// A new file is taken for one left behind only in the moment before it is locked: seldom once, never this often.
const ATTEMPTS: usize = 64;
/// Another run renames its files in milliseconds. Whoever locks the folder for longer is no run of fsot.
const TURN: Duration = Duration::from_secs(2);

/// The folder of a file.
pub(super) fn folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// How the names of the temporary files of a place begin.
fn prefix(place: &Path) -> String {
    let name = place.file_name().unwrap_or_default();
    format!(".fsot-{}-", digest(name.as_encoded_bytes()).get(..DIGITS).unwrap_or_default())
}

/// In the folder of `place`, because files are renamed only within one file system; with the permissions that a new
/// file, or the file that it replaces, has.
pub(super) fn create(place: &Path) -> io::Result<NamedTempFile> {
    let prefix = prefix(place);
    let mut builder = Builder::new();
    builder.prefix(&prefix).rand_bytes(LETTERS);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    for _ in 0..ATTEMPTS {
        let file = builder.tempfile_in(folder(place)).map_err(|error| {
            // It names a file that nobody asked for.
            let text = error.to_string();
            io::Error::new(error.kind(), text.rsplit_once(" at path ").map_or(&*text, |(why, _)| why).to_owned())
        })?;
        if matches!(file.as_file().try_lock(), Err(TryLockError::WouldBlock)) || !names(file.path(), file.as_file()) {
            continue;
        }
        if let Ok(metadata) = fs::metadata(place) {
            file.as_file().set_permissions(metadata.permissions())?;
        }
        return Ok(file);
    }
    Err(io::Error::other("temporary files vanish as soon as they are made"))
}

/// Removes the temporary files of these places that are left of ended runs.
pub(super) fn sweep<'a>(places: impl IntoIterator<Item = &'a Path>) {
    let mut folders: HashMap<&Path, HashSet<String>> = HashMap::new();
    for place in places {
        folders.entry(folder(place)).or_default().insert(prefix(place));
    }
    for (folder, prefixes) in folders {
        let Ok(entries) = fs::read_dir(folder) else { continue };
        for entry in entries.flatten() {
            let name = entry.file_name();
            let prefix = name.to_str().and_then(|name| name.get(..name.len().saturating_sub(LETTERS)));
            if prefix.is_some_and(|prefix| prefixes.contains(prefix)) {
                // What cannot be removed costs its space, and nothing else.
                remove(&entry.path()).ok();
            }
        }
    }
}

/// Removes a temporary file, unless its process lives.
fn remove(path: &Path) -> io::Result<()> {
    if !fs::symlink_metadata(path)?.is_file() {
        return Ok(());
    }
    let file = OpenOptions::new().write(true).open(path)?;
    // It may have been renamed, or removed by another run, since it was found.
    if file.try_lock().is_ok() && names(path, &file) { fs::remove_file(path) } else { Ok(()) }
}

/// Whether `path` names this open file, and no other or none.
#[cfg(unix)]
fn names(path: &Path, file: &File) -> bool {
    use std::os::unix::fs::MetadataExt;
    let identity = |metadata: fs::Metadata| (metadata.dev(), metadata.ino());
    match (fs::symlink_metadata(path), file.metadata()) {
        (Ok(named), Ok(open)) => identity(named) == identity(open),
        _ => false,
    }
}

/// Elsewhere a file that is open is neither renamed nor removed by others.
#[cfg(not(unix))]
fn names(path: &Path, _: &File) -> bool {
    path.exists()
}

/// The turn to rename files in a folder, until it is dropped: of two runs with the same outputs, all files are those of
/// the later one. None where folders have no locks.
pub(super) fn turn(folder: PathBuf) -> Option<File> {
    let folder = File::open(folder).ok()?;
    let start = Instant::now();
    loop {
        match folder.try_lock() {
            Ok(()) => return Some(folder),
            Err(TryLockError::WouldBlock) if start.elapsed() < TURN => std::thread::sleep(Duration::from_millis(1)),
            Err(_) => return None,
        }
    }
}
