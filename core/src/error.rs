//! Why a call was refused, and which rule a configuration breaks.

use core::ffi::CStr;
use core::fmt;

/// Why a call was refused. A refused call leaves its outputs and its object as they were.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Error {
    /// An argument is outside its documented range.
    Range = -2,
    /// An input value is NaN or infinite.
    NotFinite = -3,
    /// A caller-supplied buffer is too small.
    Memory = -4,
    /// There is nothing to estimate or to draw from.
    NoSamples = -6,
    /// The options exist, but not in this combination.
    Unsupported = -7,
    /// Two objects made with different configurations cannot be combined.
    Mismatch = -9,
    /// The bytes are no tile, or no table.
    Foreign = -10,
    /// The format is newer than this library.
    Version = -11,
    /// Bytes, or elements of an array, are missing, or there are too many.
    Length = -12,
    /// The bytes are damaged: the checksum does not match, or fields make no sense.
    Corrupt = -13,
}

impl Error {
    /// A sentence that says what was wrong, with the NUL that C needs.
    pub const fn words(self) -> &'static CStr {
        match self {
            Error::Range => {
                c"an argument is outside its documented range, which the function's description says: of a \
                  configuration nf_check(), in Rust `check`, names the field; else look at arrays and counts"
            }
            Error::NotFinite => c"an input value, of an array or an argument, is NaN or infinite",
            Error::Memory => c"caller-supplied memory is too small: the function's description says how much it needs",
            Error::NoSamples => c"no samples, or nothing that can be drawn",
            Error::Unsupported => c"this combination of options is not supported: the description says which is",
            Error::Mismatch => c"the two objects were made with different configurations",
            Error::Foreign => c"the bytes are not a noisefloor tile or table",
            Error::Version => c"the format is newer than this library",
            Error::Length => c"lengths do not agree: bytes, or elements of an array, are missing or too many",
            Error::Corrupt => c"the bytes are damaged: the checksum does not match, or fields make no sense",
        }
    }
}

/// Its number in C, an `nf_status`.
impl From<Error> for i32 {
    fn from(error: Error) -> i32 {
        error as i32
    }
}

/// Refuses what is not so.
#[inline]
pub(crate) fn ensure<E>(is_so: bool, error: E) -> Result<(), E> {
    if is_so { Ok(()) } else { Err(error) }
}

/// Whether an argument is a number from 0 to 1.
pub(crate) fn check_part(value: f32) -> Result<(), Error> {
    ensure(value.is_finite(), Error::NotFinite)?;
    ensure((0.0..=1.0).contains(&value), Error::Range)
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.words().to_str().unwrap_or_default())
    }
}

impl core::error::Error for Error {}

/// The rule that a configuration, an image or a tile's shape breaks: what their `check` answers. It is displayed in
/// words.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct Invalid {
    /// What functions answer that are given it.
    pub error: Error,
    /// The rule, which names the field, with the NUL that C needs.
    pub rule: &'static CStr,
}

/// Refuses a field that is not as the rule says.
pub(crate) fn rule(is_kept: bool, rule: &'static CStr) -> Result<(), Invalid> {
    ensure(is_kept, Invalid::range(rule))
}

impl Invalid {
    /// A field out of its range.
    pub(crate) const fn range(rule: &'static CStr) -> Self {
        Self { error: Error::Range, rule }
    }
}

/// Without the rule: to say it to a person, display the [`Invalid`] itself.
impl From<Invalid> for Error {
    fn from(invalid: Invalid) -> Error {
        invalid.error
    }
}

impl fmt::Display for Invalid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.rule.to_str().unwrap_or_default())
    }
}

impl core::error::Error for Invalid {}
