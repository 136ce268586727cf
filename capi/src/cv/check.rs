//! What is wrong with a configuration, in words.

use super::config::{is_narrow, nf_cv_config, read};
use super::descent::{nf_cv_descent, with};
use super::image::{check_image, nf_cv_image};
use crate::convert;
use crate::status::*;
use core::ffi::{CStr, c_char};

/// What is wrong with a configuration, and with an image and a descent unless they are NULL: a static sentence that
/// names the first field that is out of its range, or NULL. Arrays are not read, and options that only some functions
/// take, NF_ERR_UNSUPPORTED elsewhere, pass.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_cv_check(
    config: *const nf_cv_config,
    image: *const nf_cv_image,
    descent: *const nf_cv_descent,
) -> *const c_char {
    // SAFETY: the caller's pointers, checked there for NULL and alignment.
    let (config, image, descent) = unsafe {
        let Ok(config) = convert::reference(config) else {
            return c"the configuration is NULL or misaligned".as_ptr();
        };
        (config, convert::optional(image), convert::optional(descent))
    };
    let (Ok(image), Ok(descent)) = (image, descent) else { return c"the image or descent is misaligned".as_ptr() };
    let result = check(config).and_then(|()| image.map_or(Ok(()), check_image)).and_then(|()| match descent {
        Some(descent) => with(read(config)?, descent)?.check().map_err(|(_, words)| words),
        None => Ok(()),
    });
    result.err().map_or(core::ptr::null(), CStr::as_ptr)
}

fn check(config: &nf_cv_config) -> Result<(), &'static CStr> {
    read(config)?.check().map_err(|(_, words)| words)?;
    is_narrow(config).map(|_| ()).map_err(|status| match status {
        NF_ERR_UNSUPPORTED => c"precision must be NF_PRECISION_F32: this library was built for float alone",
        _ => c"precision must be one of NF_PRECISION_*, 0 or 1",
    })
}
