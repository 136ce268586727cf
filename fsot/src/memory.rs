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
            "this would need {} of memory, more than {}: ask for fewer points or samples",
            gibibytes(bytes),
            gibibytes(MOST)
        )));
    }
    // Given back at once, and never written to.
    let given = usize::try_from(bytes).is_ok_and(|bytes| Vec::<u8>::new().try_reserve_exact(bytes).is_ok());
    if given {
        return Ok(());
    }
    Err(Error::Input(format!(
        "this would need {} of memory, more than there is: ask for fewer points or samples",
        gibibytes(bytes)
    )))
}

/// Rounded up, so that what is more than a limit says so.
fn gibibytes(bytes: u64) -> String {
    format!("{} GiB", (bytes as f64 / f64::from(1 << 30) * 10.0).ceil() / 10.0)
}

/// How many of `wanted` workers, each of which needs `each` bytes beside the `base` of all, there is memory for.
///
/// # Errors
/// As [`check`], if there is not enough for one.
pub(crate) fn workers(base: u64, each: u64, wanted: usize) -> Result<usize> {
    let needed = |workers: usize| base.saturating_add(each.saturating_mul(workers as u64));
    let fewer = (2..=allowed(base, each, wanted)).rev().find(|workers| check(needed(*workers)).is_ok());
    fewer.map_or_else(|| check(needed(1)).map(|()| 1), Ok)
}

/// How many of them [`MOST`] allows, at least one.
fn allowed(base: u64, each: u64, wanted: usize) -> usize {
    let most = MOST.saturating_sub(base) / each.max(1);
    usize::try_from(most).unwrap_or(usize::MAX).min(wanted).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn too_much_is_refused_with_its_size() {
        assert!(check(1 << 20).is_ok());
        for (bytes, size) in [(MOST + 1, "need 16.1 GiB of memory, more than 16 GiB:"), (u64::MAX, "17179869184 GiB")] {
            assert!(check(bytes).unwrap_err().to_string().contains(size));
        }
    }

    #[test]
    fn fewer_work_where_there_is_no_memory_for_all() {
        let quarter = MOST / 4;
        assert_eq!([1, 2, 3, 64].map(|wanted| allowed(quarter, quarter, wanted)), [1, 2, 3, 3]);
        assert_eq!(allowed(MOST, quarter, 64), 1);
        assert_eq!(workers(1 << 10, 1 << 10, 64).unwrap(), 64);
        assert!(workers(MOST, quarter, 64).unwrap_err().to_string().contains("need 20 GiB"));
        assert!(workers(u64::MAX, u64::MAX, 0).is_err());
    }
}
