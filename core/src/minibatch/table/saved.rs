//! A table as bytes.
//!
//! Little-endian: the magic "nf_table", version u32, items u32, scale f64, uniform fraction f32, CRC-32 of all other
//! bytes u32, and an f32 for each item. The sums are made again: they are the same.

use super::importances::{State, Table};
use super::kernel::{Kernel, Portable};
use crate::checksum::crc;
use crate::error::{Error, ensure};
use crate::matrix::{copy, first, from, from_mut, is_same};

/// Bytes before the importances.
pub const HEADER_BYTES: usize = 32;
const MAGIC: [u8; 8] = *b"nf_table";
const VERSION: u32 = 1;
/// Where the checksum stands.
const CHECKSUM: usize = 28;

/// How many bytes a table of so many items takes; 0 if no memory has them.
pub const fn saved_len(items: u32) -> usize {
    let len = HEADER_BYTES as u64 + items as u64 * size_of::<f32>() as u64;
    if len <= isize::MAX as u64 { len as usize } else { 0 }
}

impl<I: AsRef<[f32]>, S: AsRef<[i64]>, K: Kernel> Table<I, S, K> {
    /// Writes the table to exactly [`saved_len`] bytes. A table loaded from them draws the same items from the same
    /// generator.
    ///
    /// # Errors
    /// [`Error::Length`] for another number of bytes.
    pub fn save(&self, bytes: &mut [u8]) -> Result<(), Error> {
        let State { scale, items, uniform_fraction } = self.state;
        ensure(bytes.len() == saved_len(items), Error::Length)?;
        let (scale, fraction) = (scale.to_le_bytes(), uniform_fraction.to_le_bytes());
        let fields = [&MAGIC[..], &VERSION.to_le_bytes(), &items.to_le_bytes(), &scale, &fraction];
        bytes.iter_mut().zip(fields.into_iter().flatten()).for_each(|(to, &from)| *to = from);
        let (values, _) = from_mut(bytes, HEADER_BYTES).as_chunks_mut();
        values.iter_mut().zip(self.importance.as_ref()).for_each(|(to, q)| *to = q.to_le_bytes());
        let checksum = checksum(bytes).to_le_bytes();
        copy(from_mut(bytes, CHECKSUM), &checksum);
        Ok(())
    }
}

/// The number of items in a saved table, to make memory for it. Only the header and the length are looked at.
///
/// # Errors
/// [`Error::Foreign`] for other bytes, [`Error::Version`] for a newer format, [`Error::Length`],
/// [`Error::Corrupt`] for a version or a number of items that no table has.
pub fn saved_items(bytes: &[u8]) -> Result<u32, Error> {
    ensure(is_same(bytes, &MAGIC), Error::Foreign)?;
    let (version, items) = (u32::from_le_bytes(field(bytes, 8)?), u32::from_le_bytes(field(bytes, 12)?));
    match (version, items) {
        (0, _) | (VERSION, 0) => Err(Error::Corrupt),
        (VERSION, _) if bytes.len() == saved_len(items) => Ok(items),
        (VERSION, _) => Err(Error::Length),
        _ => Err(Error::Version),
    }
}

impl<I: AsRef<[f32]> + AsMut<[f32]>, S: AsRef<[i64]> + AsMut<[i64]>> Table<I, S> {
    /// A table as it was when it was saved, in memory for at least as many items.
    ///
    /// # Errors
    /// Before any of these no memory is touched: [`Error::Foreign`] for other bytes, [`Error::Version`],
    /// [`Error::Length`], [`Error::Corrupt`] if they are damaged; [`Error::Memory`].
    pub fn load(importance: I, sums: S, bytes: &[u8]) -> Result<Self, Error> {
        let mut table = Table::resume(importance, sums, check(bytes)?)?;
        table.clear().iter_mut().zip(values(bytes)).for_each(|(to, from)| *to = from);
        // A scale that no library has saved with these importances loses nothing.
        let in_range = table.build::<Portable>();
        table.restore_scale(in_range);
        Ok(table)
    }
}

fn check(bytes: &[u8]) -> Result<State, Error> {
    let items = saved_items(bytes)?;
    let (scale, uniform_fraction) = (f64::from_le_bytes(field(bytes, 16)?), f32::from_le_bytes(field(bytes, 24)?));
    let state = State { scale, items, uniform_fraction };
    let sound = u32::from_le_bytes(field(bytes, CHECKSUM)?) == checksum(bytes)
        && state.is_valid()
        && values(bytes).all(|q| q.is_finite() && q.is_sign_positive());
    ensure(sound, Error::Corrupt)?;
    Ok(state)
}

fn values(bytes: &[u8]) -> impl Iterator<Item = f32> {
    from(bytes, HEADER_BYTES).as_chunks().0.iter().map(|&q| f32::from_le_bytes(q))
}

/// That of all bytes but the checksum's own.
fn checksum(bytes: &[u8]) -> u32 {
    crc([first(bytes, CHECKSUM), from(bytes, HEADER_BYTES)])
}

fn field<const N: usize>(bytes: &[u8], at: usize) -> Result<[u8; N], Error> {
    from(bytes, at).first_chunk().copied().ok_or(Error::Length)
}
