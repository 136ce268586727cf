//! Choosing, at run time, code for the vector units that the processor has.
//!
//! Every version is the same Rust code, compiled for more registers, but for the inner operations of tables, which
//! [`avx2`](crate::avx2) writes out. No operation is fused or reordered, so all return the same bits. Code for a
//! feature that the build does not assume is entered here alone.
//!
//! Not all has two. With AVX2 `nf_cv_accumulator_add` takes 1 to 9 % more instructions: it goes through one sample at a
//! time, in rows too short for wide registers. `nf_cv_accumulator_estimate` keeps its bulk in functions of its own, and
//! gains nothing. Gradient descent, whose steps are such functions too, takes 14 to 22 % fewer if all of it is inlined,
//! for some 70 kB of code: too much for one estimator.

use noisefloor_core::Error;
use noisefloor_core::control_variate::{self as cv, Config, Estimate, Image, Samples};
use noisefloor_core::minibatch::table::{Kernel, Portable, Shard, State, Table};
use noisefloor_core::minibatch::{Batch, Gradient};
use noisefloor_core::mis::Solver;
#[cfg(target_arch = "x86_64")]
use noisefloor_core::processor::{Processor, Step};
use noisefloor_core::real::Real;
use noisefloor_core::rng::Rng;

#[cfg(target_arch = "x86_64")]
use crate::avx2::Avx2;

/// A table to draw from, and one to change.
pub(crate) type Reader<'a> = Table<&'a [f32], &'a [i64]>;
pub(crate) type Writer<'a, K = Portable> = Table<&'a mut [f32], &'a mut [i64], K>;

type Weights<'a> = Option<&'a mut [f32]>;
type Done = Result<(), Error>;

/// Functions of two bodies: one compiled for every processor of the target, and one for those that have the vector
/// units named, which run that.
macro_rules! by_processor {
    ($(
        $(#[$doc:meta])*
        fn $name:ident $(<$real:ident: $bound:path>)? ($($argument:ident: $type:ty),* $(,)?) -> $result:ty {
            $features:literal => $fast:expr,
            _ => $portable:expr $(,)?
        }
    )*) => {$(
        $(#[$doc])*
        pub(crate) fn $name $(<$real: $bound>)? ($($argument: $type),*) -> $result {
            #[cfg(target_arch = "x86_64")]
            if x86::has_avx2() {
                #[target_feature(enable = $features)]
                fn fast $(<$real: $bound>)? ($($argument: $type),*) -> $result {
                    $fast
                }
                // SAFETY: the processor and the operating system support AVX2 and POPCNT, as just found out.
                return unsafe { fast($($argument),*) };
            }
            $portable
        }
    )*};
}

by_processor! {
    /// [`cv::estimate`] in the precision of the workspace.
    fn estimate<R: Real>(config: &Config, samples: Samples<'_>, workspace: &mut [R]) -> Result<Estimate, Error> {
        "avx2" => cv::estimate_inlined(config, samples, workspace),
        _ => cv::estimate_inlined(config, samples, workspace),
    }

    /// [`cv::estimate_image`].
    fn estimate_image(
        config: &Config,
        image: &Image<'_>,
        samples: Samples<'_>,
        workspace: &mut [f32],
        out: &mut dyn FnMut(usize, Estimate),
    ) -> Done {
        "avx2" => cv::estimate_image_by::<Avx2>(config, image, samples, workspace, out),
        _ => cv::estimate_image(config, image, samples, workspace, out),
    }

    /// [`Reader::draw`].
    fn table_draw(table: Reader<'_>, rng: &mut Rng, index: &mut [u32], weight: Weights<'_>) -> Done {
        "avx2,popcnt" => table.with_kernel::<Avx2>().draw(rng, index, weight),
        _ => table.draw(rng, index, weight),
    }

    /// [`Reader::draw_stratified`].
    fn table_draw_stratified(table: Reader<'_>, rng: &mut Rng, index: &mut [u32], weight: Weights<'_>) -> Done {
        "avx2,popcnt" => table.with_kernel::<Avx2>().draw_stratified(rng, index, weight),
        _ => table.draw_stratified(rng, index, weight),
    }

    /// [`Reader::draw_shard`].
    fn table_draw_shard(
        table: Reader<'_>,
        all: &Shard,
        rng: &mut Rng,
        index: &mut [u32],
        weight: Weights<'_>,
    ) -> Done {
        "avx2,popcnt" => table.with_kernel::<Avx2>().draw_shard(all, rng, index, weight),
        _ => table.draw_shard(all, rng, index, weight),
    }

    /// [`Writer::draw_distinct`].
    fn table_draw_distinct(table: Writer<'_>, rng: &mut Rng, index: &mut [u32], weight: Weights<'_>) -> Done {
        "avx2,popcnt" => table.with_kernel::<Avx2>().draw_distinct(rng, index, weight),
        _ => table.with_kernel::<Portable>().draw_distinct(rng, index, weight),
    }

    /// [`Writer::update`]: how the table then is.
    fn table_update(table: Writer<'_>, index: &[u32], importance: &[f32], momentum: f32) -> Result<State, Error> {
        "avx2,popcnt" => changed(table.with_kernel::<Avx2>(), |table| table.update(index, importance, momentum)),
        _ => changed(table, |table| table.update(index, importance, momentum)),
    }

    /// [`Writer::add_epsilon`]: how the table then is.
    fn table_add_epsilon(table: Writer<'_>, epsilon: f32) -> Result<State, Error> {
        "avx2,popcnt" => changed(table.with_kernel::<Avx2>(), |table| table.add_epsilon(epsilon)),
        _ => changed(table, |table| table.add_epsilon(epsilon)),
    }

    /// [`Gradient::estimate`].
    fn gradient(
        state: &mut Gradient<&mut [f32]>,
        batch: &Batch<'_>,
        solver: Solver,
        beta: f32,
        gradient: &[f32],
        estimate: &mut [f32],
    ) -> Done {
        "avx2" => state.estimate(batch, solver, beta, gradient, estimate),
        _ => state.estimate(batch, solver, beta, gradient, estimate),
    }
}

#[cfg(target_arch = "x86_64")]
impl Processor for Avx2 {
    #[inline(always)]
    fn run<S: Step>(step: S) -> S::Output {
        #[target_feature(enable = "avx2")]
        fn fast<S: Step>(step: S) -> S::Output {
            step.run()
        }
        // SAFETY: this type is used where the processor has AVX2 and POPCNT.
        unsafe { fast(step) }
    }
}

/// Changes a table, and says how it then is.
#[inline(always)]
fn changed<K: Kernel>(
    mut table: Writer<'_, K>,
    change: impl FnOnce(&mut Writer<'_, K>) -> Result<(), Error>,
) -> Result<State, Error> {
    change(&mut table)?;
    Ok(table.state())
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use core::arch::x86_64::{__cpuid, __cpuid_count, _xgetbv};
    use core::sync::atomic::{AtomicU8, Ordering};

    const UNKNOWN: u8 = 0;
    const ABSENT: u8 = 1;
    const PRESENT: u8 = 2;

    /// What was found out: asking takes longer than an estimate. Whoever writes it writes the same.
    static AVX2: AtomicU8 = AtomicU8::new(UNKNOWN);

    #[inline(always)]
    pub(super) fn has_avx2() -> bool {
        match AVX2.load(Ordering::Relaxed) {
            UNKNOWN => ask(),
            known => known == PRESENT,
        }
    }

    #[cold]
    fn ask() -> bool {
        const OSXSAVE_AVX_POPCNT: u32 = 1 << 27 | 1 << 28 | 1 << 23;
        const AVX2_BIT: u32 = 1 << 5;
        /// The operating system keeps the xmm and ymm registers.
        const REGISTERS: u64 = 0b110;
        let present = __cpuid(0).eax >= 7
            && __cpuid(1).ecx & OSXSAVE_AVX_POPCNT == OSXSAVE_AVX_POPCNT
            // SAFETY: the OSXSAVE bit says that the instruction exists.
            && unsafe { _xgetbv(0) } & REGISTERS == REGISTERS
            && __cpuid_count(7, 0).ebx & AVX2_BIT != 0;
        AVX2.store(if present { PRESENT } else { ABSENT }, Ordering::Relaxed);
        present
    }
}
