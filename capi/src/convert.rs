//! All pointer checks: raw pointers in, references or a status out.
//!
//! Lengths are checked against `isize::MAX` bytes, alignment against the element type, before any slice is made.

use crate::status::*;

/// A shared reference to one object.
///
/// # Safety
/// A non-NULL, aligned `pointer` must point to an initialised `T` that no one writes to during `'a`.
pub(crate) unsafe fn reference<'a, T>(pointer: *const T) -> Result<&'a T, nf_status> {
    if pointer.is_null() {
        return Err(NF_ERR_NULL);
    }
    if !pointer.is_aligned() {
        return Err(NF_ERR_ALIGNMENT);
    }
    // SAFETY: not NULL and aligned as just checked; the rest is the caller's promise.
    Ok(unsafe { &*pointer })
}

/// An exclusive reference to one object.
///
/// # Safety
/// As for [`reference`], and no one else may read or write the object during `'a`.
pub(crate) unsafe fn reference_mut<'a, T>(pointer: *mut T) -> Result<&'a mut T, nf_status> {
    if pointer.is_null() {
        return Err(NF_ERR_NULL);
    }
    if !pointer.is_aligned() {
        return Err(NF_ERR_ALIGNMENT);
    }
    // SAFETY: not NULL and aligned as just checked; the rest is the caller's promise.
    Ok(unsafe { &mut *pointer })
}

/// `len` elements to read; a zero length gives an empty slice whatever the pointer.
///
/// # Safety
/// A non-NULL, aligned `pointer` must point to `len` initialised elements that no one writes to during `'a`.
pub(crate) unsafe fn slice<'a, T>(pointer: *const T, len: usize) -> Result<&'a [T], nf_status> {
    if len == 0 {
        return Ok(&[]);
    }
    check(pointer, len)?;
    // SAFETY: not NULL, aligned and of a representable length as just checked; the rest is the caller's promise.
    Ok(unsafe { core::slice::from_raw_parts(pointer, len) })
}

/// `len` elements to write; a zero length gives an empty slice whatever the pointer.
///
/// # Safety
/// As for [`slice`], and no one else may read or write the elements during `'a`.
pub(crate) unsafe fn slice_mut<'a, T>(pointer: *mut T, len: usize) -> Result<&'a mut [T], nf_status> {
    if len == 0 {
        return Ok(&mut []);
    }
    check(pointer, len)?;
    // SAFETY: not NULL, aligned and of a representable length as just checked; the rest is the caller's promise.
    Ok(unsafe { core::slice::from_raw_parts_mut(pointer, len) })
}

/// `a * b` elements, or the status for a length that no array can have.
pub(crate) fn product(a: usize, b: usize) -> Result<usize, nf_status> {
    a.checked_mul(b).ok_or(NF_ERR_RANGE)
}

fn check<T>(pointer: *const T, len: usize) -> Result<(), nf_status> {
    if pointer.is_null() {
        return Err(NF_ERR_NULL);
    }
    if !pointer.is_aligned() {
        return Err(NF_ERR_ALIGNMENT);
    }
    match len.checked_mul(size_of::<T>()) {
        Some(bytes) if bytes <= isize::MAX as usize => Ok(()),
        _ => Err(NF_ERR_RANGE),
    }
}
