//! How large the parts of a WebAssembly module are.

use super::sizes::Size;
use anyhow::{Context, Result, bail};

/// What a module begins with: its magic number and version 1.
const HEADER: [u8; 8] = *b"\0asm\x01\0\0\0";
const CODE: u8 = 10;
const DATA: u8 = 11;

/// Bytes of the section of code and of that of data; a module's variables are data, too.
pub(crate) fn size(service: &'static str, module: &[u8]) -> Result<Size> {
    let mut rest = module.strip_prefix(&HEADER).context("the linker wrote no WebAssembly module of version 1")?;
    let mut size = Size { service, text: 0, rodata: 0, data: 0 };
    while let Some((&id, after)) = rest.split_first() {
        let (length, after) = number(after)?;
        let Some((_, next)) = usize::try_from(length).ok().and_then(|length| after.split_at_checked(length)) else {
            bail!("section {id} of the module has {length} bytes, but {} are left", after.len());
        };
        match id {
            CODE => size.text += length,
            DATA => size.rodata += length,
            _ => {}
        }
        rest = next;
    }
    Ok(size)
}

/// A number in LEB128, and what follows it.
fn number(bytes: &[u8]) -> Result<(u64, &[u8])> {
    let mut value = 0;
    for (at, byte) in bytes.iter().enumerate().take(5) {
        value |= u64::from(byte & 0x7f) << (7 * at);
        if byte & 0x80 == 0 {
            return Ok((value, &bytes[at + 1..]));
        }
    }
    bail!("the module ends within a section's length")
}

#[cfg(test)]
mod tests {
    use super::{HEADER, number, size};

    #[test]
    fn sections_are_counted() {
        assert_eq!(number(&[0xe5, 0x8e, 0x26, 7]).unwrap(), (624_485, &[7][..]));
        let module = [&HEADER[..], &[1, 2, 0, 0, 10, 3, 0, 0, 0, 11, 1, 0]].concat();
        let found = size("test", &module).unwrap();
        assert_eq!((found.text, found.rodata, found.data), (3, 1, 0));
        assert!(size("test", &module[..module.len() - 1]).is_err());
        assert!(size("test", b"\x7fELF").is_err());
    }
}
