//! What is too much memory, said before it is asked for.

use crate::error::{Error, Result};

/// The most memory that an optimisation may need.
pub const MOST: u64 = 16 << 30;

/// Whether an optimisation may need this many bytes, and the system would give them.
///
/// # Errors
/// [`Error::Input`] that names them.
pub(crate) fn check(bytes: u64) -> Result<()> {
    if bytes > MOST {
        return Err(Error::Input(format!(
            "this would need {bytes} bytes of memory, more than {MOST}: ask for fewer points or samples"
        )));
    }
    // Given back at once, and never written to.
    let given = usize::try_from(bytes).is_ok_and(|bytes| Vec::<u8>::new().try_reserve_exact(bytes).is_ok());
    if given {
        return Ok(());
    }
    Err(Error::Input(format!(
        "this would need {bytes} bytes of memory, more than there is: ask for fewer points or samples"
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn too_much_is_refused_with_its_size() {
        assert!(check(1 << 20).is_ok());
        for bytes in [MOST + 1, u64::MAX] {
            assert!(check(bytes).unwrap_err().to_string().contains(&bytes.to_string()));
        }
    }
}
