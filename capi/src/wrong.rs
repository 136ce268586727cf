//! Rules for arguments, each with words for whoever breaks it.

use crate::status::*;
use core::ffi::CStr;
use noisefloor_core::Invalid;

/// Why an argument is refused: the status of a function that is given it, and words.
#[derive(Clone, Copy)]
pub(crate) struct Wrong(pub(crate) nf_status, pub(crate) &'static CStr);

impl From<Wrong> for nf_status {
    fn from(Wrong(status, _): Wrong) -> nf_status {
        status
    }
}

impl From<Invalid> for Wrong {
    fn from(Invalid { error, rule, .. }: Invalid) -> Wrong {
        Wrong(error.into(), rule)
    }
}

/// What breaks a rule is out of range.
pub(crate) fn rule(is_kept: bool, words: &'static CStr) -> Result<(), Wrong> {
    ensure(is_kept, Wrong(NF_ERR_RANGE, words))
}

/// The choice that a number stands for.
pub(crate) fn pick<T: Copy>(value: u32, choices: &[T], words: &'static CStr) -> Result<T, Wrong> {
    choices.get(value as usize).copied().ok_or(Wrong(NF_ERR_RANGE, words))
}

/// A number from 0 to 1.
pub(crate) fn part(value: f32, words: &'static CStr) -> Result<(), Wrong> {
    let status = if value.is_finite() { NF_ERR_RANGE } else { NF_ERR_NOT_FINITE };
    ensure((0.0..=1.0).contains(&value), Wrong(status, words))
}
