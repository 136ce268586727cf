//! Random numbers.

use crate::convert;
use crate::status::nf_status;
use noisefloor_core::Error;
pub(crate) use noisefloor_core::rng::Rng;

/// A PCG32 random number generator (O'Neill 2014), for minibatches and tests: the same numbers on every target.
///
/// A complete struct, kept by value. A copy repeats the numbers its original has yet to give. Give each thread its own,
/// with its own seed. Any value of the fields is valid; nf_rng_seed sets them well. Not for cryptography.
#[repr(C)]
#[allow(non_camel_case_types)]
pub struct nf_rng {
    /// Where the generator is.
    pub state: u64,
    /// Which of 2^63 streams it is on; the lowest bit counts as set.
    pub increment: u64,
}

/// Starts a generator. Any seed is good, and neighbouring seeds (pixel numbers, say) give unrelated numbers. Does
/// nothing if `rng` is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_rng_seed(rng: *mut nf_rng, seed: u64) {
    // SAFETY: the caller passes NULL or a generator that nothing else uses meanwhile.
    if let Ok(rng) = unsafe { convert::room(rng) } {
        rng.write(stored(Rng::seed(seed)));
    }
}

/// The next 32 random bits; 0 if `rng` is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_rng_next(rng: *mut nf_rng) -> u32 {
    // SAFETY: as for nf_rng_seed.
    unsafe { with(rng, Rng::next_u32) }
}

/// The next number uniform in [0, 1), a multiple of 2^-24; 0 if `rng` is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn nf_rng_uniform(rng: *mut nf_rng) -> f32 {
    // SAFETY: as for nf_rng_seed.
    unsafe { with(rng, Rng::uniform_f32) }
}

/// # Safety
/// `rng` must be NULL or a generator that nothing else uses meanwhile.
unsafe fn with<T: Default>(rng: *mut nf_rng, draw: impl FnOnce(&mut Rng) -> T) -> T {
    // SAFETY: passed on to the caller.
    unsafe { try_with(rng, |rng| Ok(draw(rng))) }.unwrap_or_default()
}

/// A draw that can fail, and then leaves the generator where it was.
///
/// # Safety
/// A non-NULL `rng` must be a generator that nothing else uses meanwhile.
pub(crate) unsafe fn try_with<T>(
    rng: *mut nf_rng,
    draw: impl FnOnce(&mut Rng) -> Result<T, Error>,
) -> Result<T, nf_status> {
    // SAFETY: passed on to the caller.
    let rng = unsafe { convert::reference_mut(rng) }?;
    let mut generator = Rng { state: rng.state, increment: rng.increment };
    let value = draw(&mut generator)?;
    *rng = stored(generator);
    Ok(value)
}

fn stored(generator: Rng) -> nf_rng {
    nf_rng { state: generator.state, increment: generator.increment }
}
