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
/// Bytes are missing, or there are too many.
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
    let text = match status {
        NF_OK => c"success",
        NF_ERR_NULL => c"a required pointer is NULL",
        NF_ERR_RANGE => {
            c"an argument is outside its range: its description says what can be, nf_check() a configuration's"
        }
        NF_ERR_NOT_FINITE => c"an input value is NaN or infinite",
        NF_ERR_MEMORY => c"caller-supplied memory is too small: ask the matching size function",
        NF_ERR_ALIGNMENT => c"caller-supplied memory is not aligned: 8 bytes are needed",
        NF_ERR_NO_SAMPLES => c"no samples, or nothing that can be drawn",
        NF_ERR_UNSUPPORTED => c"this combination of options is not supported",
        NF_ERR_STATE => c"the memory holds no initialised object: call the matching init function first",
        NF_ERR_MISMATCH => c"the two objects were made with different configurations",
        NF_ERR_FOREIGN => c"the bytes are not a noisefloor tile or table",
        NF_ERR_VERSION => c"the format is newer than this library",
        NF_ERR_LENGTH => c"bytes are missing, or there are too many: ask the matching size function",
        NF_ERR_CORRUPT => c"the bytes are damaged: the checksum does not match, or fields make no sense",
        _ => c"not a noisefloor status",
    };
    text.as_ptr()
}

/// The status that stands for a core error.
pub(crate) fn status_of(error: Error) -> nf_status {
    match error {
        Error::Range => NF_ERR_RANGE,
        Error::NotFinite => NF_ERR_NOT_FINITE,
        Error::Memory => NF_ERR_MEMORY,
        Error::NoSamples => NF_ERR_NO_SAMPLES,
        Error::Unsupported => NF_ERR_UNSUPPORTED,
        Error::Mismatch => NF_ERR_MISMATCH,
        Error::Foreign => NF_ERR_FOREIGN,
        Error::Version => NF_ERR_VERSION,
        Error::Length => NF_ERR_LENGTH,
        Error::Corrupt => NF_ERR_CORRUPT,
        // `Error` is non-exhaustive: a variant added there without a line here is at least an error.
        _ => NF_ERR_RANGE,
    }
}

/// What a C function returns for the outcome of its body.
pub(crate) fn status(result: Result<(), nf_status>) -> nf_status {
    result.err().unwrap_or(NF_OK)
}
