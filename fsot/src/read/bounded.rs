//! Files, pipes and devices, read no further than they are of use: some never end.

use crate::error::{Error, Result};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// The most bytes of a file.
const MOST: u64 = 1 << 30;
/// The most bytes of a pipe or a device, which do not say how many will come.
const MOST_STREAMED: u64 = 128 << 20;
/// As many bytes tell what a file is.
const BEGINNING: u64 = 4096;

/// The content of a file. `fits` says of its first bytes why it is not what is asked for, before the others are read.
pub(super) fn read(path: &Path, fits: impl FnOnce(&[u8]) -> std::result::Result<(), &'static str>) -> Result<Vec<u8>> {
    let name = path.display();
    let path = if path == "-" { Path::new("/dev/stdin") } else { path };
    if path.is_dir() {
        return Err(Error::Input(format!("{name} is a folder: give the name of a file")));
    }
    let file = File::open(path).map_err(Error::io(path))?;
    let metadata = file.metadata().map_err(Error::io(path))?;
    let mut bytes = Vec::new();
    (&file).take(BEGINNING).read_to_end(&mut bytes).map_err(Error::io(path))?;
    if bytes.is_empty() {
        return Err(Error::Input(format!("{name} is empty")));
    }
    fits(&bytes).map_err(|why| Error::Input(format!("{name} is {why}")))?;
    if metadata.is_file() && metadata.len() > MOST {
        let length = metadata.len();
        return Err(Error::Input(format!("{name} is too large: it has {length} bytes, and at most {MOST} are read")));
    }
    let most = if metadata.is_file() { MOST } else { MOST_STREAMED };
    // One more tells that there are too many.
    (&file).take(most + 1 - bytes.len() as u64).read_to_end(&mut bytes).map_err(Error::io(path))?;
    if bytes.len() as u64 > most {
        let advice = if metadata.is_file() { "give a smaller file" } else { "save what comes from it to a file first" };
        return Err(Error::Input(format!("{name} has not ended after {most} bytes, and no more are read: {advice}")));
    }
    Ok(bytes)
}
