//! The one error type of the crate.

use core::fmt;

/// Why a call was refused. A refused call leaves its outputs and its object as they were.
///
/// ```
/// use noisefloor::Error;
///
/// let error: Box<dyn std::error::Error> = Error::Range.into();
/// assert!(error.to_string().contains("outside its documented range"));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Error {
    /// An argument is outside its documented range.
    Range,
    /// An input value is NaN or infinite.
    NotFinite,
    /// A caller-supplied buffer is too small.
    Memory,
    /// There is nothing to estimate or to draw from.
    NoSamples,
    /// The options exist, but not in this combination.
    Unsupported,
    /// Two objects made with different configurations cannot be combined.
    Mismatch,
    /// The bytes are no tile, or no table.
    Foreign,
    /// The format is newer than this library.
    Version,
    /// Bytes are missing, or there are too many.
    Length,
    /// The bytes are damaged: the checksum does not match, or fields make no sense.
    Corrupt,
}

impl Error {
    /// A static sentence that says what was wrong.
    pub const fn message(self) -> &'static str {
        match self {
            Error::Range => "an argument is outside its documented range: the function's description lists what can be",
            Error::NotFinite => "an input value is NaN or infinite",
            Error::Memory => "a caller-supplied buffer is too small: ask the matching size function",
            Error::NoSamples => "no samples, or nothing that can be drawn",
            Error::Unsupported => "this combination of options is not supported",
            Error::Mismatch => "the two objects were made with different configurations",
            Error::Foreign => "the bytes are not a noisefloor tile or table",
            Error::Version => "the format is newer than this library",
            Error::Length => "bytes are missing, or there are too many: ask the matching size function",
            Error::Corrupt => "the bytes are damaged: the checksum does not match, or fields make no sense",
        }
    }
}

/// Whether an argument is a number from 0 to 1.
#[allow(dead_code, reason = "each feature uses some of it")]
pub(crate) fn check_part(value: f32) -> Result<(), Error> {
    if !value.is_finite() {
        return Err(Error::NotFinite);
    }
    if (0.0..=1.0).contains(&value) { Ok(()) } else { Err(Error::Range) }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.message())
    }
}

impl core::error::Error for Error {}
