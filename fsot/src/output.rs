//! Files that appear whole or not at all.
//!
//! [`Outputs`] writes every file of a command beside its final place first; only when all are complete does
//! [`commit`](Outputs::commit) rename them, one after the other, each of which replaces an older file atomically. What
//! a run that was killed leaves beside them, [`check`] removes before the next.

mod temporary;

use crate::error::{Error, Result};
use std::collections::HashSet;
use std::fs::{self, File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf, is_separator};
use tempfile::NamedTempFile;
use temporary::folder;

/// Files that are complete but not yet in their place. Dropped before [`commit`](Outputs::commit), they leave nothing.
#[derive(Debug, Default)]
pub struct Outputs {
    pending: Vec<Pending>,
}

#[derive(Debug)]
enum Pending {
    File {
        file: NamedTempFile,
        path: PathBuf,
    },
    /// Something that is not a regular file, a pipe or a device, cannot be replaced: it is written to.
    Stream {
        bytes: Vec<u8>,
        path: PathBuf,
    },
}

impl Outputs {
    /// No files yet.
    pub fn new() -> Outputs {
        Outputs::default()
    }

    /// Prepares the file `path` with this content.
    ///
    /// # Errors
    /// As [`check`]; the folder's disk is full; `path` was added before.
    pub fn add(&mut self, path: &Path, bytes: &[u8]) -> Result<()> {
        let place = place(path)?;
        if self.pending.iter().any(|pending| pending.path() == place) {
            return Err(Error::Input(format!("two outputs have the same name {}: give each its own", path.display())));
        }
        if is_stream(&place) {
            self.pending.push(Pending::Stream { bytes: bytes.to_vec(), path: place });
            return Ok(());
        }
        let mut file = temporary::create(&place).map_err(Error::write(path))?;
        // Synchronised, so that a full disk or quota is noticed before anything is replaced.
        file.as_file_mut().write_all(bytes).and_then(|()| file.as_file().sync_all()).map_err(Error::write(path))?;
        self.pending.push(Pending::File { file, path: place });
        Ok(())
    }

    /// Puts all files into their places, those first that cannot be replaced atomically.
    ///
    /// # Errors
    /// What the system says of a stream that takes no more, or of a folder that vanished meanwhile: the files renamed
    /// before that stay.
    pub fn commit(self) -> Result<()> {
        let (streams, files): (Vec<_>, Vec<_>) =
            self.pending.into_iter().partition(|pending| matches!(pending, Pending::Stream { .. }));
        let _turn = files.first().and_then(|file| temporary::turn(folder(file.path()).to_owned()));
        for pending in streams.into_iter().chain(files) {
            match pending {
                Pending::Stream { bytes, path } => write_stream(&path, &bytes).map_err(Error::write(path))?,
                Pending::File { file, path } => {
                    file.persist(&path).map_err(|error| Error::Write { path, source: error.error })?;
                }
            }
        }
        Ok(())
    }
}

impl Pending {
    fn path(&self) -> &Path {
        match self {
            Pending::File { path, .. } | Pending::Stream { path, .. } => path,
        }
    }
}

/// Whether something can be written at each of these paths, or at what they link to: asked before an hour of work
/// rather than after it. Also removes what earlier runs with the same outputs left behind when they were killed.
///
/// # Errors
/// A folder is missing or cannot be written to; a path is a folder or a read-only file; two are the same file, or one
/// is one of the `inputs`, which would be lost.
pub fn check<'a, 'b>(
    paths: impl IntoIterator<Item = &'a Path>,
    inputs: impl IntoIterator<Item = &'b Path>,
) -> Result<()> {
    // One that does not exist is named by whoever reads it.
    let inputs: HashSet<PathBuf> = inputs.into_iter().filter_map(|input| fs::canonicalize(input).ok()).collect();
    let mut places = Vec::new();
    let mut seen = HashSet::new();
    for path in paths {
        let place = place(path)?;
        let stream = is_stream(&place);
        if stream {
            check_stream(&place).map_err(Error::write(path))?;
        }
        if !stream && inputs.contains(&place) {
            return Err(Error::Input(format!(
                "{} is an input, which would be replaced: give what is written another name",
                path.display()
            )));
        }
        if !seen.insert(place.clone()) {
            return Err(Error::Input(format!(
                "{} would be written twice: give each file its own name",
                place.display()
            )));
        }
        if !stream {
            places.push((path, place));
        }
    }
    temporary::sweep(places.iter().map(|(_, place)| place.as_path()));
    for (path, place) in places {
        temporary::create(&place).map_err(Error::write(path))?;
    }
    Ok(())
}

/// Where `path` is written: there, or at what it links to. Errors as those of [`check`], but for whether a file can be
/// made in the folder.
fn place(path: &Path) -> Result<PathBuf> {
    if is_stream(path) {
        return Ok(match path {
            path if is_standard_output(path) => STANDARD_OUTPUT.into(),
            path if is_standard_error(path) => STANDARD_ERROR.into(),
            path => path.to_owned(),
        });
    }
    let place = fs::canonicalize(path).or_else(|_| followed(path))?;
    if place.is_dir() || path.as_os_str().as_encoded_bytes().last().is_some_and(|last| is_separator((*last).into())) {
        return Err(Error::Input(format!("{} is a folder: give the name of a file in it", path.display())));
    }
    if fs::metadata(&place).is_ok_and(|metadata| metadata.is_file() && metadata.permissions().readonly()) {
        return Err(Error::Input(format!("{} is read-only: choose another name or remove it", path.display())));
    }
    if place.file_name().is_none() {
        return Err(Error::Input(format!("`{}` is not the name of a file", path.display())));
    }
    let folder = folder(&place);
    if !folder.is_dir() {
        return Err(Error::Input(format!(
            "cannot write {}: the folder {} does not exist; create it first",
            path.display(),
            folder.display()
        )));
    }
    // One name for one place, whether it exists or not.
    Ok(match (fs::canonicalize(folder), place.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => place,
    })
}

/// What a link to a file that does not exist stands for; `path` itself if it is no link.
fn followed(path: &Path) -> Result<PathBuf> {
    let mut place = path.to_owned();
    for _ in 0..LINKS {
        match fs::read_link(&place) {
            Ok(target) => place = place.parent().unwrap_or(Path::new("")).join(target),
            Err(_) => return Ok(place),
        }
    }
    Err(Error::Input(format!("cannot write {}: it is a link that leads nowhere; remove it", path.display())))
}

/// More links one behind the other are taken for a circle, as Linux does.
const LINKS: usize = 40;

/// Writes one file, whole or not at all.
///
/// # Errors
/// As [`Outputs::add`] and [`Outputs::commit`].
pub fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    let mut outputs = Outputs::new();
    outputs.add(path, bytes)?;
    outputs.commit()
}

/// Whether `path` is `-` (standard output), an open file of this process by its name in `/dev`, a pipe or a device:
/// something that is written to, not replaced.
pub fn is_stream(path: &Path) -> bool {
    // What these names stand for may be a regular file, opened by the shell.
    is_standard_output(path)
        || is_standard_error(path)
        || is_open_file(path)
        || fs::metadata(path).is_ok_and(|metadata| !metadata.is_file() && !metadata.is_dir())
}

const STANDARD_OUTPUT: &str = "/dev/stdout";
const STANDARD_ERROR: &str = "/dev/stderr";

fn is_standard_output(path: &Path) -> bool {
    path == "-" || path == STANDARD_OUTPUT || path == "/dev/fd/1"
}

fn is_standard_error(path: &Path) -> bool {
    path == STANDARD_ERROR || path == "/dev/fd/2"
}

fn is_open_file(path: &Path) -> bool {
    path.parent() == Some(Path::new("/dev/fd"))
}

/// Opens something that is written to. On Linux the name of an open file opens it once more, at its beginning: what it
/// holds, of whoever opened it, stays.
fn open_stream(path: &Path) -> std::io::Result<File> {
    OpenOptions::new().write(true).append(is_open_file(path)).open(path)
}

/// Whether a pipe or a device is there, and can be opened. A pipe is not opened: that waits until somebody reads it.
fn check_stream(path: &Path) -> std::io::Result<()> {
    #[cfg(unix)]
    if !is_standard_output(path) && !is_standard_error(path) {
        use std::os::unix::fs::FileTypeExt;
        if !fs::metadata(path)?.file_type().is_fifo() {
            open_stream(path)?;
        }
    }
    #[cfg(not(unix))]
    let _ = path;
    Ok(())
}

fn write_stream(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    if is_standard_output(path) {
        let mut stream = std::io::stdout().lock();
        return stream.write_all(bytes).and_then(|()| stream.flush());
    }
    if is_standard_error(path) {
        let mut stream = std::io::stderr().lock();
        return stream.write_all(bytes).and_then(|()| stream.flush());
    }
    let mut stream = open_stream(path)?;
    stream.write_all(bytes)?;
    stream.flush()
}
