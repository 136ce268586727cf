//! What tells an object in caller memory from other bytes, and from one that another build of the library made.
//!
//! The compiler chooses the layout of what objects are made of, and may choose another one in each build. So the number
//! depends on what can be known of it here: a check against the plain mistake of keeping objects in files, or sending
//! them to another program, not a proof. The header says what may be done with their bytes.
//!
//! Behind the number there is no check, and could be none: an object says itself how long it is, and in its header
//! stand enums, of which not every pattern of bits is one. Who finds the number takes the rest for what the library
//! wrote, and the header asks that no one else write there.

use crate::convert;
use crate::status::{NF_ABI_VERSION, NF_ERR_STATE, nf_status};

/// The number of objects whose header is an `H`, for the library's version and the target's width of pointers. It is to
/// stand first.
pub(crate) const fn magic<H>(name: &str) -> u64 {
    let numbers = [size_of::<H>(), align_of::<H>(), usize::BITS as usize, NF_ABI_VERSION as usize];
    let mut hash = add(BASIS, name.as_bytes());
    hash = add(hash, env!("CARGO_PKG_VERSION").as_bytes());
    // No iterators in constants.
    let mut i = 0;
    while i < numbers.len() {
        hash = add(hash, &(numbers[i] as u64).to_le_bytes());
        i += 1;
    }
    hash
}

/// Whether an object with this number stands there: nothing behind the number is looked at. An `Ok` says that `object`
/// is not NULL and aligned as its header.
///
/// # Safety
/// A non-NULL, aligned `object` must point to at least 8 initialised bytes that no one writes meanwhile.
pub(crate) unsafe fn check<H>(object: *const H, magic: u64) -> Result<(), nf_status> {
    const { assert!(align_of::<H>() >= align_of::<u64>()) };
    convert::usable(object)?;
    // SAFETY: not NULL and aligned, as just checked; the rest is the caller's promise. Any 8 bytes are a number.
    if unsafe { object.cast::<u64>().read() } == magic { Ok(()) } else { Err(NF_ERR_STATE) }
}

/// FNV-1a: Fowler, Noll and Vo's hash.
const BASIS: u64 = 0xCBF2_9CE4_8422_2325;
const PRIME: u64 = 0x0000_0100_0000_01B3;

const fn add(mut hash: u64, bytes: &[u8]) -> u64 {
    let mut i = 0;
    while i < bytes.len() {
        hash = (hash ^ bytes[i] as u64).wrapping_mul(PRIME);
        i += 1;
    }
    hash
}

const _: () = {
    assert!(add(BASIS, b"foobar") == 0x8594_4171_F739_67E8, "the hash's published value");
    assert!(magic::<u64>("a") != magic::<u64>("b"), "another object");
    assert!(magic::<u64>("a") != magic::<[u64; 2]>("a"), "another size");
    assert!(magic::<[u64; 2]>("a") != magic::<[u8; 16]>("a"), "another alignment");
};
