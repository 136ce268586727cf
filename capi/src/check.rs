//! What is wrong with a configuration, in words.

use crate::convert;
use crate::cv::{check_config, check_descent, check_image};
use crate::importance::check_importance;
use crate::omis::check_omis;
use crate::status::*;
use crate::table::check_table;
use crate::tile::{check_sampler, check_tile};
use crate::wrong::{Wrong, rule};
use core::ffi::{c_char, c_void};

/// nf_check: an nf_cv_config.
pub const NF_CHECK_CV_CONFIG: u32 = 0;
/// nf_check: an nf_cv_image.
pub const NF_CHECK_CV_IMAGE: u32 = 1;
/// nf_check: an nf_cv_descent.
pub const NF_CHECK_CV_DESCENT: u32 = 2;
/// nf_check: an nf_omis_arguments.
pub const NF_CHECK_OMIS: u32 = 3;
/// nf_check: an nf_importance_arguments.
pub const NF_CHECK_IMPORTANCE: u32 = 4;
/// nf_check: an nf_table.
pub const NF_CHECK_TABLE: u32 = 5;
/// nf_check: an nf_tile.
pub const NF_CHECK_TILE: u32 = 6;
/// nf_check: an nf_tile_sampler, its tile included.
pub const NF_CHECK_TILE_SAMPLER: u32 = 7;
/// nf_check: a uint32_t, the `dims` that any sampler is to draw.
pub const NF_CHECK_DIMS: u32 = 8;

/// What is wrong with the configuration that `what` points to, of a kind NF_CHECK_*: a static sentence that names the
/// first field that is out of its range, and the range, or NULL. No array is read but the counts of nf_omis_arguments,
/// and options that only some functions take, NF_ERR_UNSUPPORTED elsewhere, pass. Any nf_sampler is a valid one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_check(kind: u32, what: *const c_void) -> *const c_char {
    // SAFETY: the caller passes NULL or what the kind says, and what that points to.
    let result = unsafe {
        match kind {
            NF_CHECK_CV_CONFIG => of(what, check_config),
            NF_CHECK_CV_IMAGE => of(what, check_image),
            NF_CHECK_CV_DESCENT => of(what, check_descent),
            NF_CHECK_OMIS => of(what, |omis| check_omis(omis)),
            NF_CHECK_IMPORTANCE => of(what, |nodes| check_importance(nodes).map(|_| ())),
            NF_CHECK_TABLE => of(what, |table| check_table(table)),
            NF_CHECK_TILE => of(what, check_tile),
            NF_CHECK_TILE_SAMPLER => of(what, |sampler| check_sampler(sampler)),
            NF_CHECK_DIMS => of(what, |dims| rule((1..=4).contains(dims), c"dims must be 1 to 4")),
            _ => Err(Wrong(NF_ERR_RANGE, c"kind must be one of NF_CHECK_*, 0 to 8")),
        }
    };
    result.err().map_or(core::ptr::null(), |Wrong(_, words)| words.as_ptr())
}

/// # Safety
/// A non-NULL, aligned `what` must point to a `T` that no one writes meanwhile.
unsafe fn of<T>(what: *const c_void, check: impl FnOnce(&T) -> Result<(), Wrong>) -> Result<(), Wrong> {
    // SAFETY: passed on to the caller.
    match unsafe { convert::reference(what.cast()) } {
        Ok(what) => check(what),
        Err(status) => Err(Wrong(status, c"what is to be checked is NULL or misaligned")),
    }
}
