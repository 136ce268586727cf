//! Status codes and the ABI version.

use core::ffi::c_char;
use noisefloor_core::Error;

/// 0 is success, a negative value an error; `nf_status_message` explains it.
#[allow(non_camel_case_types)]
pub type nf_status = i32;

/// Success.
pub const NF_OK: nf_status = 0;
/// A required pointer is NULL.
pub const NF_ERR_NULL: nf_status = -1;
/// An argument is outside its documented range.
pub const NF_ERR_RANGE: nf_status = -2;
/// An input value is NaN or infinite.
pub const NF_ERR_NOT_FINITE: nf_status = -3;
/// Caller-supplied memory is too small.
pub const NF_ERR_MEMORY: nf_status = -4;
/// Caller-supplied memory is not aligned as its type needs.
pub const NF_ERR_ALIGNMENT: nf_status = -5;
/// There is nothing to estimate or to draw from.
pub const NF_ERR_NO_SAMPLES: nf_status = -6;
/// The options exist, but not in this combination.
pub const NF_ERR_UNSUPPORTED: nf_status = -7;
/// The memory holds no initialised object.
pub const NF_ERR_STATE: nf_status = -8;
/// Two objects were made with different configurations.
pub const NF_ERR_MISMATCH: nf_status = -9;
/// The bytes are no tile, or no table.
pub const NF_ERR_FOREIGN: nf_status = -10;
/// The format is newer than this library.
pub const NF_ERR_VERSION: nf_status = -11;
/// Bytes, or elements of an array, are missing, or there are too many.
pub const NF_ERR_LENGTH: nf_status = -12;
/// The bytes are damaged.
pub const NF_ERR_CORRUPT: nf_status = -13;

/// The version of this header. `nf_abi_version()` returns the library's.
pub const NF_ABI_VERSION: u32 = 1;

/// The ABI version the library was built with; it must equal `NF_ABI_VERSION`.
#[unsafe(no_mangle)]
pub extern "C" fn nf_abi_version() -> u32 {
    NF_ABI_VERSION
}

/// A static, NUL-terminated sentence for a status; never NULL, also for values that are no status.
#[unsafe(no_mangle)]
pub extern "C" fn nf_status_message(status: nf_status) -> *const c_char {
    let words = match status {
        NF_OK => c"success",
        NF_ERR_NULL => c"a required pointer is NULL",
        NF_ERR_RANGE => Error::Range.words(),
        NF_ERR_NOT_FINITE => Error::NotFinite.words(),
        NF_ERR_MEMORY => Error::Memory.words(),
        NF_ERR_ALIGNMENT => c"a pointer is not aligned as its type needs, or memory of an object not to 8 bytes",
        NF_ERR_NO_SAMPLES => Error::NoSamples.words(),
        NF_ERR_UNSUPPORTED => Error::Unsupported.words(),
        NF_ERR_STATE => c"the memory holds no initialised object: call the matching init function first",
        NF_ERR_MISMATCH => Error::Mismatch.words(),
        NF_ERR_FOREIGN => Error::Foreign.words(),
        NF_ERR_VERSION => Error::Version.words(),
        NF_ERR_LENGTH => Error::Length.words(),
        NF_ERR_CORRUPT => Error::Corrupt.words(),
        _ => c"not a noisefloor status",
    };
    words.as_ptr()
}

const _: () = assert!(
    Error::Range as nf_status == NF_ERR_RANGE
        && Error::NotFinite as nf_status == NF_ERR_NOT_FINITE
        && Error::Memory as nf_status == NF_ERR_MEMORY
        && Error::NoSamples as nf_status == NF_ERR_NO_SAMPLES
        && Error::Unsupported as nf_status == NF_ERR_UNSUPPORTED
        && Error::Mismatch as nf_status == NF_ERR_MISMATCH
        && Error::Foreign as nf_status == NF_ERR_FOREIGN
        && Error::Version as nf_status == NF_ERR_VERSION
        && Error::Length as nf_status == NF_ERR_LENGTH
        && Error::Corrupt as nf_status == NF_ERR_CORRUPT
);

/// Refuses what is not so.
#[inline]
pub(crate) fn ensure<E>(is_so: bool, error: E) -> Result<(), E> {
    if is_so { Ok(()) } else { Err(error) }
}

/// What a C function returns for the outcome of its body.
pub(crate) fn status(result: Result<(), nf_status>) -> nf_status {
    result.err().unwrap_or(NF_OK)
}
