//! Streaming accumulators in caller memory.

use super::config::{c_estimate, core_config, is_narrow, nf_cv_config, nf_estimate};
use super::samples::{self, nf_cv_samples};
use crate::convert;
use crate::magic::{self, magic};
use crate::status::*;
use core::ffi::c_void;
use noisefloor_core::Error;
use noisefloor_core::control_variate::{Accumulator, Config};
use noisefloor_core::real::Real;

/// A streaming estimate of fixed size, in caller memory. It may be moved or copied as bytes between calls, among
/// processes that run the same library file.
#[allow(non_camel_case_types)]
pub struct nf_cv_accumulator {
    _private: (),
}

/// What stands at the start of the memory, before the sums.
#[repr(C, align(8))]
struct Header {
    magic: u64,
    state: AnyState,
}

/// What there is in one of two precisions.
#[derive(Clone, Copy)]
enum Either<D, S> {
    Double(D),
    Single(S),
}

type AnyState = Either<Accumulator<f64>, Accumulator<f32>>;

/// Whether accumulators in double precision are part of the library: if not, nothing must make the compiler think so.
const HAS_DOUBLE: bool = cfg!(feature = "double");

const MAGIC: u64 = magic::<Header>("nf_cv_accumulator");

/// Bytes that the sums start at.
const HEADER: usize = size_of::<Header>();

/// Bytes of an accumulator, and in `workspace`, unless NULL, those that nf_cv_accumulator_estimate() needs; both 0 for
/// a configuration that is NULL, out of range or not for streaming, and the first for a misaligned `workspace`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_cv_accumulator_size(config: *const nf_cv_config, workspace: *mut usize) -> usize {
    // SAFETY: the caller's pointer, checked there for NULL and alignment.
    let empty = unsafe { convert::reference(config) }.and_then(empty);
    let [all, scratch] = empty.map_or([0; 2], |(_, sizes)| sizes);
    if workspace.is_null() {
        return all;
    }
    // SAFETY: the caller passes a place for a number.
    let Ok(workspace) = (unsafe { convert::room(workspace) }) else { return 0 };
    workspace.write(scratch);
    all
}

/// An empty accumulator, with its bytes and those of its workspace.
fn empty(config: &nf_cv_config) -> Result<(AnyState, [usize; 2]), nf_status> {
    fn of<R: Real>(config: &Config) -> Result<(Accumulator<R>, [usize; 2]), Error> {
        let state = Accumulator::new(config)?;
        Ok((state, [HEADER + state.len() * size_of::<R>(), state.workspace_len() * size_of::<R>()]))
    }
    let core = core_config(config)?;
    Ok(match is_narrow(config)? {
        true => of(&core).map(|(state, sizes)| (Either::Single(state), sizes)),
        false => of(&core).map(|(state, sizes)| (Either::Double(state), sizes)),
    }?)
}

/// Makes an empty accumulator in `memory`, or empties one: `*out` is its handle, the same address.
///
/// NF_ERR_RANGE: the configuration; NF_ERR_MEMORY; NF_ERR_UNSUPPORTED: what needs all samples at once, which are
/// NF_CV_LEAVE_ONE_OUT, NF_SOLVER_DUAL, and NF_RIDGE_AUTO of least squares; and NF_SOLVER_SQUARE_ROOT of all else.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_cv_accumulator_init(
    memory: *mut c_void,
    bytes: usize,
    config: *const nf_cv_config,
    out: *mut *mut nf_cv_accumulator,
) -> nf_status {
    status((|| {
        // SAFETY: the caller's pointers, each checked there.
        let (config, out) = unsafe { (convert::reference(config)?, convert::room(out)?) };
        let (state, [size, _]) = empty(config)?;
        let header = Header { magic: MAGIC, state };
        // SAFETY: the caller passes memory of the size it says; all-zero sums are those of no samples.
        out.write(unsafe { convert::create(memory, bytes, size, header) }?.cast());
        Ok(())
    })())
}

/// Adds samples of the one integral: all of them or, on an error, none. Several at a time are cheaper. In single
/// precision an accumulator holds 2^22 samples.
///
/// NF_ERR_RANGE also for more samples than it holds; NF_ERR_NO_SAMPLES: n is 0; else as for nf_cv_estimate(), but
/// NF_NONFINITE_SKIP may skip all.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_cv_accumulator_add(
    accumulator: *mut nf_cv_accumulator,
    samples: *const nf_cv_samples,
) -> nf_status {
    status((|| {
        // SAFETY: the caller's object and samples, checked there, and arrays of the lengths the header states.
        unsafe {
            let samples = convert::reference(samples)?;
            match open(accumulator)? {
                Either::Double((sums, state)) => add(state, sums, samples),
                Either::Single((sums, state)) => add(state, sums, samples),
            }
        }
    })())
}

/// Adds all samples of `other`, which stays as it is. The same parts in the same order have the same bits.
///
/// NF_ERR_MISMATCH: other configurations; NF_ERR_RANGE: both are the same object, or hold too many samples together.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_cv_accumulator_merge(
    accumulator: *mut nf_cv_accumulator,
    other: *const nf_cv_accumulator,
) -> nf_status {
    if core::ptr::eq(accumulator, other) && !other.is_null() {
        // Two references to one object must not be; and whoever asks for this has made a mistake.
        return NF_ERR_RANGE;
    }
    status((|| {
        // SAFETY: the caller's objects, checked there, and not the same one.
        let (ours, theirs) = unsafe { (open(accumulator)?, open_shared(other)?) };
        match (ours, theirs) {
            (Either::Double((sums, state)), Either::Double((theirs, other))) => Ok(state.merge(sums, other, theirs)?),
            (Either::Single((sums, state)), Either::Single((theirs, other))) => Ok(state.merge(sums, other, theirs)?),
            _ => Err(NF_ERR_MISMATCH),
        }
    })())
}

/// The estimate from all samples so far; more may be added afterwards.
///
/// NF_ERR_MEMORY; NF_ERR_NO_SAMPLES.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_cv_accumulator_estimate(
    accumulator: *const nf_cv_accumulator,
    workspace: *mut c_void,
    bytes: usize,
    out: *mut nf_estimate,
) -> nf_status {
    status((|| {
        // SAFETY: the caller's object and memory, each checked there.
        unsafe {
            let out = convert::room(out)?;
            let estimate = match open_shared(accumulator)? {
                Either::Double((sums, state)) => {
                    state.estimate(sums, convert::workspace(workspace, bytes, state.workspace_len())?)
                }
                Either::Single((sums, state)) => {
                    state.estimate(sums, convert::workspace(workspace, bytes, state.workspace_len())?)
                }
            };
            out.write(c_estimate(&estimate?));
            Ok(())
        }
    })())
}

type Opened<'a> = Either<(&'a mut [f64], &'a mut Accumulator<f64>), (&'a mut [f32], &'a mut Accumulator<f32>)>;
type OpenedShared<'a> = Either<(&'a [f64], &'a Accumulator<f64>), (&'a [f32], &'a Accumulator<f32>)>;

/// # Safety
/// A non-NULL, aligned pointer must be to at least 8 initialised bytes that nobody else uses during `'a`. If they are
/// the magic number, an accumulator must stand there: what nf_cv_accumulator_init() wrote, or all its bytes copied
/// there, changed since by this library alone. So the enums in its state are valid, and memory follows for as many sums
/// as the state says.
#[inline(always)]
unsafe fn open<'a>(accumulator: *mut nf_cv_accumulator) -> Result<Opened<'a>, nf_status> {
    // SAFETY: the caller's promise, of which the second half counts once the number has been found.
    unsafe {
        magic::check::<Header>(accumulator.cast(), MAGIC)?;
        let sums = accumulator.cast::<u8>().add(HEADER);
        Ok(match &mut (*accumulator.cast::<Header>()).state {
            Either::Double(_) if !HAS_DOUBLE => return Err(NF_ERR_STATE),
            Either::Double(state) => Either::Double((convert::slice_mut(sums.cast(), state.len())?, state)),
            Either::Single(state) => Either::Single((convert::slice_mut(sums.cast(), state.len())?, state)),
        })
    }
}

/// # Safety
/// As for [`open`], but others may read the object.
#[inline(always)]
unsafe fn open_shared<'a>(accumulator: *const nf_cv_accumulator) -> Result<OpenedShared<'a>, nf_status> {
    // SAFETY: as in `open`.
    unsafe {
        magic::check::<Header>(accumulator.cast(), MAGIC)?;
        let sums = accumulator.cast::<u8>().add(HEADER);
        Ok(match &(*accumulator.cast::<Header>()).state {
            Either::Double(_) if !HAS_DOUBLE => return Err(NF_ERR_STATE),
            Either::Double(state) => Either::Double((convert::slice(sums.cast(), state.len())?, state)),
            Either::Single(state) => Either::Single((convert::slice(sums.cast(), state.len())?, state)),
        })
    }
}

/// # Safety
/// As for [`samples::read`].
unsafe fn add<R: Real>(state: &mut Accumulator<R>, sums: &mut [R], samples: &nf_cv_samples) -> Result<(), nf_status> {
    // SAFETY: the caller's promise.
    let samples = unsafe { samples::read(state.config(), samples, 1, false)? };
    Ok(state.add(sums, samples)?)
}
