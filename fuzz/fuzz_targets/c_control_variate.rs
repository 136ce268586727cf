//! Every control-variate function of the C library: any configuration, samples and addresses give an error, and outputs
//! as they were, or finite numbers.
#![no_main]

mod support;

use arbitrary::{Result, Unstructured};
use libfuzzer_sys::fuzz_target;
use noisefloor::basis::Family;
use noisefloor_c::*;
use std::ptr::{from_ref, null, null_mut};
use support::{Array, Source};

/// Bytes beyond which no workspace is allocated.
const MOST: usize = 1 << 21;
/// An output that was not written.
const UNTOUCHED: nf_estimate = nf_estimate { mean: [-7.0; 4], std_error: [-7.0; 4], samples: 7, gain: -7.0 };

fn config(source: &mut Source<'_>) -> Result<nf_cv_config> {
    Ok(nf_cv_config {
        dims: source.small(5)?,
        order: source.small(4)?,
        channels: source.small(4)?,
        estimator: source.small(6)?,
        basis: source.small(Family::ALL.len() as u32)?,
        stratified: u32::from(source.rarely(8)?),
        slices: source.small(4)?.saturating_sub(2),
        edges: source.small(4)?.saturating_sub(2),
        controls: source.small(6)?.saturating_sub(3),
        stride: source.small(12)?.saturating_sub(6),
        solver: source.small(4)?,
        precision: source.small(1)?,
        nonfinite: source.small(1)?,
        color: u32::from(source.rarely(8)?),
        folds: source.small(5)?,
        ridge: source.number()?,
    })
}

fn descent(source: &mut Source<'_>) -> Result<nf_cv_descent> {
    let iterations = source.small(40)?;
    Ok(nf_cv_descent {
        optimizer: source.small(3)?,
        // Many steps are no other code, only slow.
        iterations: if iterations > 1 << 20 { iterations } else { iterations % 41 },
        learning_rate: source.number()?,
        momentum: source.number()?,
    })
}

fn arrays(u: *const f32, f: *const f32, n: usize) -> nf_cv_samples {
    let nothing = null();
    nf_cv_samples { u, f, n, controls: nothing, control_integrals: nothing, known: nothing, known_integrals: nothing }
}

fn is_sound(estimate: &nf_estimate) -> bool {
    estimate.mean.iter().all(|mean| mean.is_finite())
        && estimate.std_error.iter().all(|&error| error >= 0.0)
        && !estimate.gain.is_nan()
}

/// A call succeeded with a sound estimate, or changed nothing.
fn check(status: nf_status, out: &nf_estimate) {
    match status {
        NF_OK => assert!(is_sound(out), "{:?} {:?} {}", out.mean, out.std_error, out.gain),
        _ => {
            assert!(out.mean == UNTOUCHED.mean && out.std_error == UNTOUCHED.std_error && out.samples == 7, "{status}")
        }
    }
}

struct Samples {
    n: usize,
    u: Array<f32>,
    f: Array<f32>,
    h: Array<f32>,
    integrals: Array<f32>,
}

/// As many numbers as a valid configuration reads; none for one that must be refused.
fn samples(source: &mut Source<'_>, config: &nf_cv_config, n: usize) -> Result<Samples> {
    // SAFETY: a reference is a valid pointer.
    let valid = unsafe { nf_cv_terms(config) } > 0;
    // SAFETY: as above.
    assert!(valid || !unsafe { nf_check(NF_CHECK_CV_CONFIG, from_ref(config).cast()) }.is_null());
    let len = |width: u32| if valid { n * width as usize } else { 0 };
    let stride = if config.stride == 0 { config.dims } else { config.stride };
    let used =
        len(stride).saturating_sub(if valid && n > 0 { (stride.saturating_sub(config.dims)) as usize } else { 0 });
    // A stride below dims is refused, one of gigabytes means little.
    let used = if used > 1 << 16 { 0 } else { used };
    Ok(Samples {
        n: if used == 0 { 0 } else { n },
        u: source.array(used, Source::unit)?,
        f: source.array(len(config.channels), Source::number)?,
        h: source.array(len(config.controls), Source::number)?,
        integrals: source.array(len(config.controls).min(config.controls as usize), Source::number)?,
    })
}

fn batch(source: &mut Source<'_>, config: &nf_cv_config) -> Result<()> {
    let count = usize::from(source.any::<u8>()? % 33);
    let Samples { n, u, f, h, integrals } = samples(source, config, count)?;
    // SAFETY: arrays have the lengths that the header asks for; wrong addresses are NULL or misaligned, which are
    // refused.
    unsafe {
        let bytes = nf_cv_workspace_size(config, n);
        if bytes > MOST {
            return Ok(());
        }
        let mut workspace = source.memory(bytes)?;
        let (memory, size) = (workspace.pointer_mut().cast(), workspace.bytes());
        let mut out = UNTOUCHED;
        let samples = arrays(u.pointer(), f.pointer(), n);
        check(nf_cv_estimate(config, &samples, 1, memory, size, &mut out), &out);
        assert!(nf_cv_estimate(config, &samples, 1, memory, size, null_mut()) < 0);
        let mut out = UNTOUCHED;
        let controlled = nf_cv_samples { controls: h.pointer(), control_integrals: integrals.pointer(), ..samples };
        check(nf_cv_estimate(config, &controlled, 1, memory, size, &mut out), &out);
        // Half of them as an integral each.
        let mut each = vec![UNTOUCHED; n / 2 + 1];
        let count = n / 2;
        let halves = nf_cv_samples { n: 2, ..samples };
        if nf_cv_workspace_size(config, 2) <= size {
            let status = nf_cv_estimate(config, &halves, count, memory, size, each.as_mut_ptr());
            each.iter().take(count).for_each(|out| check(status, out));
            assert!(each.iter().skip(count).all(|out| out.samples == UNTOUCHED.samples));
        }
        let steps = descent(source)?;
        nf_check(NF_CHECK_CV_DESCENT, from_ref(&steps).cast());
        let rows = if config.color == NF_COLOR_LUMINANCE_RATIO { 1 } else { config.channels };
        let terms = nf_cv_terms(config).saturating_sub(1);
        let mut start = source.array((terms * rows.min(4)) as usize, Source::number)?;
        let before = start.values.clone();
        let mut out = UNTOUCHED;
        let start_pointer = start.pointer_mut();
        let status = nf_cv_gradient_descent(config, &samples, &steps, start_pointer, memory, size, &mut out);
        check(status, &out);
        let bits = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert!(status == NF_OK || bits(&before) == bits(&start.values));
        assert!(status != NF_OK || start.values.iter().all(|value| value.is_finite()));
    }
    Ok(())
}

fn rectangle(source: &mut Source<'_>) -> Result<nf_cv_rectangle> {
    Ok(nf_cv_rectangle { x: source.small(4)?, y: source.small(4)?, width: source.small(4)?, height: source.small(4)? })
}

fn is_zero(of: &nf_cv_rectangle) -> bool {
    of.x | of.y | of.width | of.height == 0
}

/// What must be given for the pixels that are wanted, which is enough for them.
fn needed(image: &nf_cv_image) -> nf_cv_rectangle {
    let mut given = nf_cv_rectangle { x: 7, y: 7, width: 7, height: 7 };
    // SAFETY: references are valid pointers.
    if unsafe { nf_cv_image_needed(image, &mut given) } != NF_OK {
        assert_eq!([given.x, given.y, given.width, given.height], [7; 4]);
        return nf_cv_rectangle::default();
    }
    let enough = nf_cv_image { given, ..*image };
    // SAFETY: as above.
    let is_allowed = unsafe { nf_check(NF_CHECK_CV_IMAGE, from_ref(&enough).cast()) }.is_null();
    // The one rule that it does not ask for is that of the number of pixels.
    let pixels = [given.width, given.height, image.frames.max(1)].map(u128::from).iter().product::<u128>();
    assert_eq!(is_allowed, pixels < 1 << 30);
    given
}

fn shared(source: &mut Source<'_>, config: &nf_cv_config) -> Result<()> {
    let (width, height, frames) = (source.small(4)?, source.small(3)?, source.small(2)?);
    let mut image = nf_cv_image {
        width,
        height,
        frames,
        window: source.small(5)?,
        stride: source.small(5)?,
        unordered: u32::from(source.rarely(4)?),
        samples: if source.rarely(3)? { source.small(4)? as usize } else { 0 },
        surfaces: null(),
        factors: null(),
        given: nf_cv_rectangle::default(),
        wanted: if source.rarely(3)? { rectangle(source)? } else { nf_cv_rectangle::default() },
    };
    let whole = nf_cv_rectangle { x: 0, y: 0, width, height };
    match source.any::<u8>()? % 4 {
        0 => image.given = whole,
        1 => image.given = needed(&image),
        2 => image.given = rectangle(source)?,
        _ => {}
    }
    let pixels = |of: &nf_cv_rectangle| {
        [of.width, of.height, frames.max(1)].iter().try_fold(1_u32, |a, &b| a.checked_mul(b)).unwrap_or(0) as usize
    };
    let part = pixels(&image.wanted);
    let pixels = pixels(if is_zero(&image.given) { &whole } else { &image.given });
    let n = usize::from(source.any::<u8>()? % 4);
    if pixels > 64 {
        return Ok(());
    }
    let Samples { n: all, u, f, .. } = samples(source, config, n * pixels)?;
    let n = if all == 0 { 0 } else { n };
    let surfaces = source.array(pixels, |source| source.small(2))?;
    let channels = if config.channels > 4 { 0 } else { config.channels as usize };
    let factors = source.array(pixels * channels, |source| source.number().map(f32::abs))?;
    let known = source.array(all * channels, Source::number)?;
    let integrals = source.array(pixels * channels, |source| source.number().map(f32::abs))?;
    let has_known = source.rarely(3)?;
    // Now and then without the integrals.
    let has_integrals = has_known != source.rarely(9)?;
    image.surfaces = if source.any()? { surfaces.pointer() } else { null() };
    image.factors = if source.any()? { factors.pointer() } else { null() };
    let samples = nf_cv_samples {
        known: if has_known { known.pointer() } else { null() },
        known_integrals: if has_integrals { integrals.pointer() } else { null() },
        ..arrays(u.pointer(), f.pointer(), n)
    };
    // SAFETY: as in `batch`.
    unsafe {
        let bytes = nf_cv_image_workspace_size(config, &image, &samples);
        assert!(bytes == 0 || nf_check(NF_CHECK_CV_IMAGE, from_ref(&image).cast()).is_null());
        if bytes > MOST {
            return Ok(());
        }
        let mut workspace = source.memory(bytes)?;
        let (memory, size) = (workspace.pointer_mut().cast(), workspace.bytes());
        let mut out = vec![UNTOUCHED; pixels];
        let status = nf_cv_image_estimate(config, &image, &samples, memory, size, out.as_mut_ptr());
        let written = if !is_zero(&image.wanted) && status == NF_OK { part } else { pixels };
        out.iter().take(written).for_each(|out| check(status, out));
    }
    Ok(())
}

/// An accumulator's estimate, to the bit, and its status; `workspace` is large enough.
///
/// # Safety
/// The accumulator must be NULL or live.
unsafe fn state_of(accumulator: *const nf_cv_accumulator, workspace: &mut [u64]) -> (nf_status, [u32; 10]) {
    let mut out = UNTOUCHED;
    let (memory, size) = (workspace.as_mut_ptr().cast(), size_of_val(workspace));
    // SAFETY: passed on to the caller; the workspace is a slice.
    let status = unsafe { nf_cv_accumulator_estimate(accumulator, memory, size, &mut out) };
    let [a, b, c, d] = out.mean.map(f32::to_bits);
    let [e, f, g, h] = out.std_error.map(f32::to_bits);
    (status, [a, b, c, d, e, f, g, h, out.samples, out.gain.to_bits()])
}

fn streaming(source: &mut Source<'_>, config: &nf_cv_config) -> Result<()> {
    // SAFETY: as in `batch`; an accumulator lives in memory that outlives it.
    unsafe {
        let mut work = 0;
        let bytes = nf_cv_accumulator_size(config, &mut work);
        if bytes > MOST || work > MOST {
            return Ok(());
        }
        let mut memory = [source.memory(bytes)?, source.memory(bytes)?];
        let mut workspace = source.memory(work)?;
        let mut sound = vec![0; work.div_ceil(8)];
        let mut objects = [null_mut(); 2];
        for (memory, object) in memory.iter_mut().zip(&mut objects) {
            let status = nf_cv_accumulator_init(memory.pointer_mut().cast(), memory.bytes(), config, object);
            assert_eq!(status == NF_OK, !object.is_null());
        }
        for _ in 0..source.any::<u8>()? % 8 {
            let [first, second] = objects;
            let count = usize::from(source.any::<u8>()? % 12);
            let Samples { n, u, f, h, integrals } = samples(source, config, count)?;
            let before = objects.map(|object| state_of(object, &mut sound));
            let samples = arrays(u.pointer(), f.pointer(), n);
            let controlled = nf_cv_samples { controls: h.pointer(), control_integrals: integrals.pointer(), ..samples };
            let status = match source.any::<u8>()? % 6 {
                0 => nf_cv_accumulator_add(first, &samples),
                1 => nf_cv_accumulator_add(second, &samples),
                2 => nf_cv_accumulator_add(first, &controlled),
                3 => nf_cv_accumulator_merge(first, second),
                4 => {
                    let status = nf_cv_accumulator_merge(first, first);
                    assert!(status < 0);
                    status
                }
                // Made anew: empty.
                _ => match second.is_null() {
                    true => nf_cv_accumulator_add(second, &samples),
                    false => nf_cv_accumulator_init(second.cast(), bytes, config, &mut objects[1]),
                },
            };
            let after = objects.map(|object| state_of(object, &mut sound));
            assert!(status == NF_OK || before == after, "{status}: {before:?} became {after:?}");
            for object in objects {
                let mut out = UNTOUCHED;
                let (memory, size) = (workspace.pointer_mut().cast(), workspace.bytes());
                check(nf_cv_accumulator_estimate(object, memory, size, &mut out), &out);
            }
        }
    }
    Ok(())
}

fn run(bytes: &[u8]) -> Result<()> {
    let mut source = Source(Unstructured::new(bytes));
    let config = config(&mut source)?;
    match source.any::<u8>()? % 3 {
        0 => batch(&mut source, &config),
        1 => shared(&mut source, &config),
        _ => streaming(&mut source, &config),
    }
}

/// What is to be fuzzed is there: a library without double precision would refuse half of all inputs, and none would
/// fail.
fn defaults_work() {
    let (u, f) = ([0.1, 0.2, 0.7, 0.4, 0.5, 0.9], [1.0, 2.0, 3.0]);
    // SAFETY: arrays have the lengths that the header asks for.
    unsafe {
        // All zeros but these are defaults.
        let default = nf_cv_config { dims: 2, order: 2, channels: 1, ..std::mem::zeroed() };
        let samples = arrays(u.as_ptr(), f.as_ptr(), 3);
        for precision in [NF_PRECISION_F64, NF_PRECISION_F32] {
            let config = nf_cv_config { precision, ..default };
            let mut out = UNTOUCHED;
            let mut workspace = vec![0_u64; nf_cv_workspace_size(&config, 3).div_ceil(8)];
            let (memory, size) = (workspace.as_mut_ptr().cast(), 8 * workspace.len());
            assert_eq!(nf_cv_estimate(&config, &samples, 1, memory, size, &mut out), NF_OK);
            check(NF_OK, &out);
            let mut work = 0;
            let mut state = vec![0_u64; nf_cv_accumulator_size(&config, &mut work).div_ceil(8)];
            let (memory, size, mut accumulator) = (state.as_mut_ptr().cast(), 8 * state.len(), null_mut());
            assert_eq!(nf_cv_accumulator_init(memory, size, &config, &mut accumulator), NF_OK);
            assert_eq!(nf_cv_accumulator_add(accumulator, &samples), NF_OK);
            let mut workspace = vec![0; work.div_ceil(8)];
            assert_eq!(state_of(accumulator, &mut workspace).0, NF_OK);
        }
    }
}

fuzz_target!(init: defaults_work(), |bytes: &[u8]| {
    // SAFETY: NULL is allowed.
    unsafe { assert_eq!(nf_cv_terms(null()), 0) };
    // Bytes that ran out are no input.
    run(bytes).ok();
});
