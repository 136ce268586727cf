//! Optimal MIS gradients with momentum.

use crate::magic::{self, magic};
use crate::omis::solver_of;
use crate::status::*;
use crate::{convert, dispatch};
use noisefloor_core::minibatch::{self, Batch, Gradient, System};

/// Optimal MIS gradients from explicit per-item gradients, with momentum over steps (section 6.2.3): averages over the
/// batches so far of J + 1 floats per parameter. May be moved and copied as nf_cv_accumulator. Without momentum
/// nf_omis_weights gives the same estimate at the cost of one weighted backward pass.
#[allow(non_camel_case_types)]
pub struct nf_gradient {
    _private: (),
}

/// What stands at the start of the memory, before the f32 averages.
#[repr(C, align(8))]
#[derive(Clone, Copy)]
struct Header {
    magic: u64,
    techniques: u32,
    parameters: u32,
    system: System,
}

const MAGIC: u64 = magic::<Header>("nf_gradient");

/// Bytes of an nf_gradient, 4 (techniques + 1) per parameter and about 1.4 kB; 0 unless techniques is
/// 1..NF_MIS_MAX_TECHNIQUES and parameters at least 1, or if no memory has them.
#[unsafe(no_mangle)]
pub extern "C" fn nf_gradient_size(techniques: u32, parameters: u32) -> usize {
    convert::object_size::<Header, f32>(minibatch::gradient_len(techniques as usize, parameters as usize))
}

/// Makes an nf_gradient without a batch in `memory`, or makes one forget: `*out` is its handle, the same address.
///
/// NF_ERR_RANGE: techniques or parameters; NF_ERR_MEMORY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_gradient_init(
    memory: *mut core::ffi::c_void,
    bytes: usize,
    techniques: u32,
    parameters: u32,
    out: *mut *mut nf_gradient,
) -> nf_status {
    status((|| {
        let size = nf_gradient_size(techniques, parameters);
        ensure(size > 0, NF_ERR_RANGE)?;
        // SAFETY: the caller passes a place for a pointer.
        let out = unsafe { convert::room(out) }?;
        let header = Header { magic: MAGIC, techniques, parameters, system: System::new(techniques as usize) };
        // SAFETY: the caller passes memory of the size it says; all-zero averages are those of no batches.
        out.write(unsafe { convert::create(memory, bytes, size, header) }?.cast());
        Ok(())
    })())
}

/// Adds a batch of drawn items, and estimates the gradient of the mean loss from it and, with momentum, those before.
///
/// solver, ridge, items, pdf[batch * techniques], technique[batch]: as for nf_omis_weights. beta: the momentum, 0..1. A
/// batch that is t steps old counts beta^t, divided by the sum of those weights: 0 forgets the earlier batches, 1
/// averages all; from 2^16 batches on, more is 1 - 2^-16. Older gradients lag: with an optimiser's momentum, use 0.
/// gradient[batch * parameters]: those of each sample, row after row, finite, unweighted; read twice.
/// estimate[parameters]: the output; one beyond the range of float becomes the largest finite float.
///
/// NF_ERR_RANGE also for beta, or gradients over probabilities beyond the range of float; NF_ERR_NOT_FINITE also for
/// beta or a gradient; else as for nf_omis_weights.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_gradient_estimate(
    state: *mut nf_gradient,
    solver: u32,
    ridge: f32,
    beta: f32,
    items: u32,
    pdf: *const f32,
    technique: *const u32,
    gradient: *const f32,
    batch: u32,
    estimate: *mut f32,
) -> nf_status {
    status((|| {
        // SAFETY: the caller passes an object that no one else uses meanwhile.
        let (header, averages) = unsafe { open(state) }?;
        let (techniques, parameters) = (header.techniques as usize, header.parameters as usize);
        let samples = batch as usize;
        let (pdfs, gradients) = (convert::product(samples, techniques)?, convert::product(samples, parameters)?);
        // SAFETY: the caller passes arrays of these lengths, none of which is written.
        let (pdf, technique, gradient) = unsafe {
            (convert::slice(pdf, pdfs)?, convert::slice(technique, samples)?, convert::slice(gradient, gradients)?)
        };
        // SAFETY: as above, but written, and no part of another.
        let estimate = unsafe { convert::outputs(estimate, parameters) }?;
        let solver = solver_of(solver, ridge)?;
        let batch = Batch::new(items, techniques, pdf, technique)?;
        let mut state = Gradient::resume(averages, header.system, parameters)?;
        dispatch::gradient(&mut state, &batch, solver, beta, gradient, estimate)?;
        header.system = *state.system();
        Ok(())
    })())
}

/// The object's header and averages.
///
/// # Safety
/// A non-NULL, aligned `state` must point to at least 8 initialised bytes that no one else uses during `'a`. If they
/// are the magic number, an nf_gradient must stand there: what nf_gradient_init wrote, or all its bytes copied there,
/// changed since by this library alone. So memory follows for as many averages as its header says.
unsafe fn open<'a>(state: *mut nf_gradient) -> Result<(&'a mut Header, &'a mut [f32]), nf_status> {
    // SAFETY: passed on to the caller.
    unsafe { magic::check::<Header>(state.cast(), MAGIC) }?;
    // SAFETY: passed on to the caller, who promises more where the number has been found.
    let header = unsafe { convert::reference_mut(state.cast::<Header>()) }?;
    let len = minibatch::gradient_len(header.techniques as usize, header.parameters as usize);
    ensure(len > 0, NF_ERR_STATE)?;
    // SAFETY: nf_gradient_init made the averages right behind the header, which is no part of them.
    let averages = unsafe { convert::slice_mut(state.cast::<Header>().add(1).cast::<f32>(), len) }?;
    Ok((header, averages))
}
