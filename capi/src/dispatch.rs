//! Choosing, at run time, code for the vector units that the processor has.
//!
//! Every version is the same Rust code, compiled for more registers, but for the inner operations of tables, which
//! [`avx2`](crate::avx2) writes out. No operation is fused or reordered, so all return the same bits. Code for a feature that the
//! build does not assume is entered here alone.

use noisefloor_core::Error;
use noisefloor_core::control_variate::{self as cv, Config, Estimate, Image, Samples};
use noisefloor_core::minibatch::table::Shard;
use noisefloor_core::minibatch::{Batch, Gradient};
use noisefloor_core::mis::Solver;
use noisefloor_core::real::Real;
use noisefloor_core::rng::Rng;

use crate::table::{Reader, Writer};

/// The version of a function that the processor runs fastest, or else the second expression.
macro_rules! by_processor {
    ($name:ident($($argument:expr),*), $portable:expr) => {{
        #[cfg(target_arch = "x86_64")]
        if x86::has_avx2() {
            // SAFETY: the processor and the operating system support AVX2 and POPCNT, as just found out.
            return unsafe { x86::$name($($argument),*) };
        }
        $portable
    }};
}

/// [`cv::estimate`] in the precision of the workspace.
pub(crate) fn estimate<R: Real>(config: &Config, samples: Samples<'_>, workspace: &mut [R]) -> Result<Estimate, Error> {
    by_processor!(estimate(config, samples, workspace), cv::estimate(config, samples, workspace))
}

/// [`cv::estimate_image`] in the precision of the workspace.
pub(crate) fn estimate_image<R: Real>(
    config: &Config,
    image: &Image<'_>,
    samples: Samples<'_>,
    workspace: &mut [R],
    out: impl FnMut(usize, Estimate),
) -> Result<(), Error> {
    by_processor!(
        estimate_image(config, image, samples, workspace, out),
        cv::estimate_image(config, image, samples, workspace, out)
    )
}

/// [`Reader::draw`].
pub(crate) fn table_draw(
    table: &Reader<'_>,
    rng: &mut Rng,
    index: &mut [u32],
    weight: Option<&mut [f32]>,
) -> Result<(), Error> {
    by_processor!(table_draw(table, rng, index, weight), table.draw(rng, index, weight))
}

/// [`Reader::draw_stratified`].
pub(crate) fn table_draw_stratified(
    table: &Reader<'_>,
    rng: &mut Rng,
    index: &mut [u32],
    weight: Option<&mut [f32]>,
) -> Result<(), Error> {
    by_processor!(table_draw_stratified(table, rng, index, weight), table.draw_stratified(rng, index, weight))
}

/// [`Reader::draw_shard`].
pub(crate) fn table_draw_shard(
    table: &Reader<'_>,
    all: &Shard,
    rng: &mut Rng,
    index: &mut [u32],
    weight: Option<&mut [f32]>,
) -> Result<(), Error> {
    by_processor!(table_draw_shard(table, all, rng, index, weight), table.draw_shard(all, rng, index, weight))
}

/// [`Writer::draw_distinct`].
pub(crate) fn table_draw_distinct(
    table: &mut Writer<'_>,
    rng: &mut Rng,
    index: &mut [u32],
    weight: Option<&mut [f32]>,
) -> Result<(), Error> {
    by_processor!(table_draw_distinct(table, rng, index, weight), table.draw_distinct(rng, index, weight))
}

/// [`Writer::update`].
pub(crate) fn table_update(
    table: &mut Writer<'_>,
    index: &[u32],
    importance: &[f32],
    momentum: f32,
) -> Result<(), Error> {
    by_processor!(table_update(table, index, importance, momentum), table.update(index, importance, momentum))
}

/// [`Writer::add_epsilon`].
pub(crate) fn table_add_epsilon(table: &mut Writer<'_>, epsilon: f32) -> Result<(), Error> {
    by_processor!(table_add_epsilon(table, epsilon), table.add_epsilon(epsilon))
}

/// [`Gradient::estimate`].
pub(crate) fn gradient(
    state: &mut Gradient<&mut [f32]>,
    batch: &Batch<'_>,
    solver: Solver,
    beta: f32,
    gradient: &[f32],
    estimate: &mut [f32],
) -> Result<(), Error> {
    by_processor!(
        gradient(state, batch, solver, beta, gradient, estimate),
        state.estimate(batch, solver, beta, gradient, estimate)
    )
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::*;
    use crate::avx2::Avx2;
    use core::arch::x86_64::{__cpuid, __cpuid_count, _xgetbv};
    use core::sync::atomic::{AtomicU8, Ordering};

    const UNKNOWN: u8 = 0;
    const ABSENT: u8 = 1;
    const PRESENT: u8 = 2;

    /// What was found out: asking takes longer than an estimate. Whoever writes it writes the same.
    static AVX2: AtomicU8 = AtomicU8::new(UNKNOWN);

    #[target_feature(enable = "avx2")]
    pub(super) fn estimate<R: Real>(
        config: &Config,
        samples: Samples<'_>,
        workspace: &mut [R],
    ) -> Result<Estimate, Error> {
        cv::estimate(config, samples, workspace)
    }

    #[target_feature(enable = "avx2")]
    pub(super) fn estimate_image<R: Real>(
        config: &Config,
        image: &Image<'_>,
        samples: Samples<'_>,
        workspace: &mut [R],
        out: impl FnMut(usize, Estimate),
    ) -> Result<(), Error> {
        cv::estimate_image(config, image, samples, workspace, out)
    }

    #[target_feature(enable = "avx2,popcnt")]
    pub(super) fn table_draw(
        table: &Reader<'_>,
        rng: &mut Rng,
        index: &mut [u32],
        weight: Option<&mut [f32]>,
    ) -> Result<(), Error> {
        table.draw_by::<Avx2>(rng, index, weight)
    }

    #[target_feature(enable = "avx2,popcnt")]
    pub(super) fn table_draw_stratified(
        table: &Reader<'_>,
        rng: &mut Rng,
        index: &mut [u32],
        weight: Option<&mut [f32]>,
    ) -> Result<(), Error> {
        table.draw_stratified_by::<Avx2>(rng, index, weight)
    }

    #[target_feature(enable = "avx2,popcnt")]
    pub(super) fn table_draw_shard(
        table: &Reader<'_>,
        all: &Shard,
        rng: &mut Rng,
        index: &mut [u32],
        weight: Option<&mut [f32]>,
    ) -> Result<(), Error> {
        table.draw_shard_by::<Avx2>(all, rng, index, weight)
    }

    #[target_feature(enable = "avx2,popcnt")]
    pub(super) fn table_draw_distinct(
        table: &mut Writer<'_>,
        rng: &mut Rng,
        index: &mut [u32],
        weight: Option<&mut [f32]>,
    ) -> Result<(), Error> {
        table.draw_distinct_by::<Avx2>(rng, index, weight)
    }

    #[target_feature(enable = "avx2,popcnt")]
    pub(super) fn table_update(
        table: &mut Writer<'_>,
        index: &[u32],
        importance: &[f32],
        momentum: f32,
    ) -> Result<(), Error> {
        table.update_by::<Avx2>(index, importance, momentum)
    }

    #[target_feature(enable = "avx2,popcnt")]
    pub(super) fn table_add_epsilon(table: &mut Writer<'_>, epsilon: f32) -> Result<(), Error> {
        table.add_epsilon_by::<Avx2>(epsilon)
    }

    #[target_feature(enable = "avx2")]
    pub(super) fn gradient(
        state: &mut Gradient<&mut [f32]>,
        batch: &Batch<'_>,
        solver: Solver,
        beta: f32,
        gradient: &[f32],
        estimate: &mut [f32],
    ) -> Result<(), Error> {
        state.estimate(batch, solver, beta, gradient, estimate)
    }

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
