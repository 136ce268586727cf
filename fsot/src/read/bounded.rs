//! Files, pipes and devices, read no further than they are of use: some never end.

use crate::error::{Error, Result};
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// The most bytes of a file.
const MOST: u64 = 1 << 30;
/// The most bytes of a pipe or a device, which do not say how many will come.
const MOST_STREAMED: u64 = 128 << 20;
/// As many bytes tell what a file is.
const BEGINNING: u64 = 4096;

/// The content of a file, or of standard input if the name is `-`. `fits` says of its first bytes why it is not what is
/// asked for, before the others are read.
pub(super) fn read(path: &Path, fits: impl FnOnce(&[u8]) -> std::result::Result<(), &'static str>) -> Result<Vec<u8>> {
    let name = path.display();
    if path.is_dir() {
        return Err(Error::Input(format!("{name} is a folder: give the name of a file")));
    }
    let (mut file, length): (Box<dyn Read>, Option<u64>) = if path == "-" {
        (Box::new(io::stdin().lock()), None)
    } else {
        let file = File::open(path).map_err(Error::io(path))?;
        let metadata = file.metadata().map_err(Error::io(path))?;
        (Box::new(file), metadata.is_file().then_some(metadata.len()))
    };
    let mut bytes = Vec::new();
    (&mut file).take(BEGINNING).read_to_end(&mut bytes).map_err(Error::io(path))?;
    if bytes.is_empty() {
        return Err(Error::Input(format!("{name} is empty")));
    }
    fits(&bytes).map_err(|why| Error::Input(format!("{name} is {why}")))?;
    if let Some(length) = length.filter(|&length| length > MOST) {
        return Err(Error::Input(format!("{name} is too large: it has {length} bytes, and at most {MOST} are read")));
    }
    let most = if length.is_some() { MOST } else { MOST_STREAMED };
    // One more tells that there are too many.
    file.take(most + 1 - bytes.len() as u64).read_to_end(&mut bytes).map_err(Error::io(path))?;
    if bytes.len() as u64 > most {
        let advice = if length.is_some() { "give a smaller file" } else { "save what comes from it to a file first" };
        return Err(Error::Input(format!("{name} has not ended after {most} bytes, and no more are read: {advice}")));
    }
    Ok(bytes)
}
