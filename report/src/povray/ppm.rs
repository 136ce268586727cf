//! POV-Ray's pictures: PPM with 16 bits per value.

use anyhow::{Context, Result, bail};
use std::fs;
use std::path::Path;

/// The values of a picture of `size` x `size` pixels, rows from the top down.
pub(crate) fn read(path: &Path, size: u32) -> Result<Vec<u16>> {
    let bytes = fs::read(path).with_context(|| format!("POV-Ray made no {}", path.display()))?;
    parse(&bytes, size).with_context(|| format!("{} is not the picture that was expected", path.display()))
}

fn parse(bytes: &[u8], size: u32) -> Result<Vec<u16>> {
    let mut rest = bytes;
    let mut words = Vec::new();
    // The magic, width, height and the largest value; POV-Ray puts comments between them.
    while words.len() < 4 {
        let end = rest.iter().position(|&byte| byte == b'\n').context("its header ends early")?;
        let line = String::from_utf8_lossy(&rest[..end]).into_owned();
        rest = &rest[end + 1..];
        if !line.starts_with('#') {
            words.extend(line.split_whitespace().map(str::to_owned));
        }
    }
    let expected = ["P6".to_owned(), size.to_string(), size.to_string(), "65535".to_owned()];
    if words != expected {
        bail!("its header says `{}`, not `{}`", words.join(" "), expected.join(" "));
    }
    let (values, []) = rest.as_chunks::<2>() else { bail!("half a value at its end") };
    let wanted = 3 * size as usize * size as usize;
    if values.len() != wanted {
        bail!("it has {} values, not {wanted}", values.len());
    }
    Ok(values.iter().map(|&bytes| u16::from_be_bytes(bytes)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_are_skipped_and_short_files_refused() {
        let mut bytes = b"P6\n# made by hand\n1 1\n65535\n".to_vec();
        bytes.extend([0, 1, 1, 0, 0xff, 0xfe]);
        assert_eq!(parse(&bytes, 1).expect("a picture"), [1, 256, 65534]);
        assert!(parse(&bytes, 2).is_err());
        bytes.pop();
        assert!(parse(&bytes, 1).is_err());
        assert!(parse(b"P6\n1 1\n", 1).is_err());
    }
}
