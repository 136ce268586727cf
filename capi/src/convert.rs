//! Pointer checks: raw pointers in, references or a status out.
//!
//! Lengths are checked against `isize::MAX` bytes, alignment against the element type, before any slice is made.
//!
//! C callers pass outputs that nobody has written yet. A single output, and an array of structs, is therefore [`Room`],
//! which may hold anything, until its value is there. Arrays of numbers, which the core fills through slices, are
//! [`outputs`].

use crate::status::*;
use core::ffi::c_void;
use core::mem::MaybeUninit;

/// Where an object will be: to be written, never read.
pub(crate) type Room<T> = MaybeUninit<T>;

/// Whether an object can be there, for all that its address says.
pub(crate) fn usable<T>(pointer: *const T) -> Result<(), nf_status> {
    ensure(!pointer.is_null(), NF_ERR_NULL)?;
    ensure(pointer.is_aligned(), NF_ERR_ALIGNMENT)
}

/// A shared reference to one object.
///
/// # Safety
/// A non-NULL, aligned `pointer` must point to an initialised `T` that no one writes to during `'a`.
pub(crate) unsafe fn reference<'a, T>(pointer: *const T) -> Result<&'a T, nf_status> {
    usable(pointer)?;
    // SAFETY: not NULL and aligned as just checked; the rest is the caller's promise.
    Ok(unsafe { &*pointer })
}

/// An exclusive reference to one object that already exists; [`room`] is for one that may not.
///
/// # Safety
/// As for [`reference`], and no one else may read or write the object during `'a`.
pub(crate) unsafe fn reference_mut<'a, T>(pointer: *mut T) -> Result<&'a mut T, nf_status> {
    usable(pointer)?;
    // SAFETY: not NULL and aligned as just checked; the rest is the caller's promise.
    Ok(unsafe { &mut *pointer })
}

/// Room for one object, where there may never have been one.
///
/// # Safety
/// A non-NULL, aligned `pointer` must be the start of room for a `T` that no one else uses during `'a`.
pub(crate) unsafe fn room<'a, T>(pointer: *mut T) -> Result<&'a mut Room<T>, nf_status> {
    // SAFETY: any memory is a `Room`, written or not; the rest is the caller's promise.
    unsafe { reference_mut(pointer.cast()) }
}

/// Room for `len` objects, where there may never have been any; a zero length gives an empty slice whatever the
/// pointer.
///
/// # Safety
/// As for [`room`], of all elements.
pub(crate) unsafe fn rooms<'a, T>(pointer: *mut T, len: usize) -> Result<&'a mut [Room<T>], nf_status> {
    // SAFETY: as in `room`.
    unsafe { slice_mut(pointer.cast(), len) }
}

/// Writes one object to where there may never have been one.
///
/// # Safety
/// As for [`room`].
pub(crate) unsafe fn write<T>(pointer: *mut T, value: T) -> Result<(), nf_status> {
    // SAFETY: passed on to the caller.
    unsafe { room(pointer) }?.write(value);
    Ok(())
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

/// [`outputs`], or nothing for NULL.
///
/// # Safety
/// As for [`outputs`].
pub(crate) unsafe fn optional_outputs<'a, T: AnyBits>(
    pointer: *mut T,
    len: usize,
) -> Result<Option<&'a mut [T]>, nf_status> {
    // SAFETY: passed on to the caller.
    if pointer.is_null() { Ok(None) } else { unsafe { outputs(pointer, len) }.map(Some) }
}

/// `len` elements that already exist, to change; a zero length gives an empty slice whatever the pointer.
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

/// What [`slice`] makes, or [`slice_mut`].
pub(crate) trait Slice<T>: AsRef<[T]> + Sized {
    /// # Safety
    /// As for the one that makes it.
    unsafe fn of(pointer: *mut T, len: usize) -> Result<Self, nf_status>;
}

impl<T> Slice<T> for &[T] {
    unsafe fn of(pointer: *mut T, len: usize) -> Result<Self, nf_status> {
        // SAFETY: passed on to the caller.
        unsafe { slice(pointer, len) }
    }
}

impl<T> Slice<T> for &mut [T] {
    unsafe fn of(pointer: *mut T, len: usize) -> Result<Self, nf_status> {
        // SAFETY: passed on to the caller.
        unsafe { slice_mut(pointer, len) }
    }
}

/// Numbers of which every pattern of bits is one.
pub(crate) trait AnyBits: Copy {}

impl AnyBits for u8 {}
impl AnyBits for u32 {}
impl AnyBits for i64 {}
impl AnyBits for f32 {}
impl AnyBits for f64 {}

/// `len` numbers that the core will write, through the slices of its safe interface; clearing them first would cost
/// time, and an error must leave them as they are. A zero length gives an empty slice whatever the pointer.
///
/// A slice of numbers that Rust code has left uninitialised would be invalid, even unread. These are another
/// language's: the memory was allocated, and perhaps written, by code that this crate's compiler cannot see, so that it
/// must take them for some numbers, whatever C calls them; every pattern of bits being a number, they are. The core
/// writes each before it reads it, so no result depends on which. This fails where the compiler does see that code:
/// under link-time optimisation across languages, which the archive, machine code, takes no part in; and where Rust
/// code is the caller.
///
/// # Safety
/// A non-NULL, aligned `pointer` must be the start of room for `len` elements that no one else uses during `'a`. Where
/// this crate's compiler sees what allocated them, a Rust caller say, they must be initialised.
pub(crate) unsafe fn outputs<'a, T: AnyBits>(pointer: *mut T, len: usize) -> Result<&'a mut [T], nf_status> {
    // SAFETY: passed on to the caller; numbers of any bits are initialised, as said above.
    unsafe { slice_mut(pointer, len) }
}

/// `needed` bytes of caller memory, 8-byte aligned, of which nothing is assumed.
///
/// # Safety
/// A non-NULL `memory` must be the start of `bytes` bytes that no one else uses.
pub(crate) unsafe fn memory(memory: *mut c_void, bytes: usize, needed: usize) -> Result<*mut u8, nf_status> {
    usable(memory.cast::<u64>())?;
    ensure(bytes >= needed && needed <= isize::MAX as usize, NF_ERR_MEMORY)?;
    Ok(memory.cast())
}

/// `len` numbers of workspace: some numbers, as [`outputs`] says, which the core writes before it reads them.
///
/// # Safety
/// As for [`outputs`], of `bytes` bytes.
pub(crate) unsafe fn workspace<'a, T: AnyBits>(
    workspace: *mut c_void,
    bytes: usize,
    len: usize,
) -> Result<&'a mut [T], nf_status> {
    let needed = product(len, size_of::<T>())?;
    if needed == 0 {
        return Ok(&mut []);
    }
    // SAFETY: passed on to the caller; the memory is aligned to 8 bytes and long enough.
    unsafe { outputs(memory(workspace, bytes, needed)?.cast(), len) }
}

/// The bytes of an object in caller memory: an `H`, and `len` `T` right behind it. 0 for a `len` of 0 or a size no
/// memory has.
pub(crate) fn object_size<H, T>(len: usize) -> usize {
    match len.checked_mul(size_of::<T>()).and_then(|bytes| bytes.checked_add(size_of::<H>())) {
        Some(bytes) if len > 0 && bytes <= isize::MAX as usize => bytes,
        _ => 0,
    }
}

/// Makes an object of `size` bytes: its header, and zeros behind it.
///
/// # Safety
/// As for [`memory`]; `size` must be at least that of an `H`, whose alignment must be at most 8.
pub(crate) unsafe fn create<H>(memory: *mut c_void, bytes: usize, size: usize, header: H) -> Result<*mut H, nf_status> {
    // SAFETY: passed on to the caller; the memory is aligned to 8 bytes and of at least `size`.
    unsafe {
        let place = self::memory(memory, bytes, size)?;
        place.write_bytes(0, size);
        place.cast::<H>().write(header);
        Ok(place.cast())
    }
}

/// `a * b` elements, or the status for a length that no array can have.
pub(crate) fn product(a: usize, b: usize) -> Result<usize, nf_status> {
    a.checked_mul(b).ok_or(NF_ERR_RANGE)
}

fn check<T>(pointer: *const T, len: usize) -> Result<(), nf_status> {
    usable(pointer)?;
    ensure(product(len, size_of::<T>())? <= isize::MAX as usize, NF_ERR_RANGE)
}
