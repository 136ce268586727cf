//! The inner operations of a table of importances, in AVX2: the same bits as [`Portable`], in a third of the
//! instructions.
//!
//! Compilers do not find these: they spread the columns of a block over scalar registers. Tests compare both.

use core::arch::x86_64::*;
use noisefloor_core::minibatch::table::{Block, Kernel, Node};

/// To be used only inside functions that are compiled for AVX2 and POPCNT and called where the processor has them.
pub(crate) struct Avx2;

/// Methods that are compiled for AVX2 and POPCNT.
macro_rules! by_avx2 {
    ($($(#[$doc:meta])* fn $name:ident($($argument:ident: $type:ty),*) $(-> $result:ty)? $body:block)*) => {$(
        $(#[$doc])*
        #[inline(always)]
        fn $name($($argument: $type),*) $(-> $result)? {
            #[inline]
            #[target_feature(enable = "avx2,popcnt")]
            fn fast($($argument: $type),*) $(-> $result)? $body
            // SAFETY: the type is used where the processor has AVX2 and POPCNT.
            unsafe { fast($($argument),*) }
        }
    )*};
}

impl Kernel for Avx2 {
    by_avx2! {
        fn total(block: &Block) -> f64 {
            let two = _mm256_add_pd(row(block, 0), row(block, 1));
            running(_mm256_add_pd(_mm256_add_pd(two, row(block, 2)), row(block, 3))).3
        }

        /// The sum is that of registers: reading the block back would wait for the one element to arrive in memory.
        fn replace(block: &mut Block, item: usize, q: f32) -> f64 {
            let (which, fresh) = (_mm_set1_epi32(item as i32), _mm_set1_ps(q));
            let (rows, _) = block.as_chunks::<4>();
            let mut sum = _mm256_setzero_pd();
            for (i, &[a, b, c, d]) in rows.iter().enumerate() {
                let first = 4 * i as i32;
                let is = _mm_cmpeq_epi32(_mm_setr_epi32(first, first + 1, first + 2, first + 3), which);
                let new = _mm_blendv_ps(_mm_setr_ps(a, b, c, d), fresh, _mm_castsi128_ps(is));
                // Adding to 0 changes nothing: no row has an element below 0.
                sum = _mm256_add_pd(sum, _mm256_cvtps_pd(_mm_max_ps(new, _mm_setzero_ps())));
            }
            block[item % 16] = q;
            running(sum).3
        }

        fn find_item(block: &Block, u: f64) -> (usize, f64) {
            let one = row(block, 0);
            let two = _mm256_add_pd(one, row(block, 1));
            let three = _mm256_add_pd(two, row(block, 2));
            let four = _mm256_add_pd(three, row(block, 3));
            let (a, b, c, total) = running(four);
            let starts = _mm256_setr_pd(0.0, a, b, c);
            let y = _mm256_set1_pd(u * total);
            let ended = |sums| _mm256_castpd_si256(_mm256_cmp_pd::<_CMP_LE_OQ>(_mm256_add_pd(starts, sums), y));
            // A comparison that holds is -1.
            let counts =
                _mm256_add_epi64(_mm256_add_epi64(ended(one), ended(two)), _mm256_add_epi64(ended(three), ended(four)));
            let halves = _mm_add_epi64(_mm256_castsi256_si128(counts), _mm256_extracti128_si256::<1>(counts));
            let count = _mm_cvtsi128_si64(_mm_add_epi64(halves, _mm_unpackhi_epi64(halves, halves)));
            let position = count.wrapping_neg() as usize % 16;
            (position % 4 * 4 + position / 4, total)
        }

        fn find_child(node: &Node, r: i64) -> usize {
            let r = _mm256_set1_epi64x(r);
            let later = |which| _mm256_cmpgt_epi64(quarter(node, which), r);
            let (low, high) = (_mm256_packs_epi32(later(0), later(1)), _mm256_packs_epi32(later(2), later(3)));
            // Two bits for each that ends later, in an order that does not matter.
            let all = _mm256_packs_epi16(low, high);
            16 - (_mm256_movemask_epi8(all) as u32).count_ones() as usize / 2
        }

        fn add(node: &mut Node, child: usize, difference: i64) {
            let before = _mm256_set1_epi64x(child as i64 - 1);
            let difference = _mm256_set1_epi64x(difference);
            let (quarters, _) = node.as_chunks_mut::<4>();
            for (i, quarter) in quarters.iter_mut().enumerate() {
                let &mut [a, b, c, d] = quarter;
                let first = 4 * i as i64;
                let behind = _mm256_cmpgt_epi64(_mm256_setr_epi64x(first, first + 1, first + 2, first + 3), before);
                let sum = _mm256_add_epi64(_mm256_setr_epi64x(a, b, c, d), _mm256_and_si256(behind, difference));
                // SAFETY: a quarter is 32 bytes, and a store may be unaligned.
                unsafe { _mm256_storeu_si256(quarter.as_mut_ptr().cast(), sum) };
            }
        }
    }

    #[inline(always)]
    fn prefetch<T>(soon: &T) {
        let lines = size_of::<T>().div_ceil(64);
        for line in 0..lines {
            // SAFETY: a prefetch reads nothing that the program sees, whatever the address.
            unsafe { _mm_prefetch::<_MM_HINT_T0>((&raw const *soon).cast::<i8>().wrapping_add(64 * line)) };
        }
    }
}

/// Row `row` of a block, in f64; what is not above 0 as 0.
#[inline]
#[target_feature(enable = "avx2,popcnt")]
fn row(block: &Block, row: usize) -> __m256d {
    let (rows, _) = block.as_chunks::<4>();
    let &[a, b, c, d] = &rows[row % 4];
    // The maximum of a NaN and 0 is the second of them: 0.
    _mm256_cvtps_pd(_mm_max_ps(_mm_setr_ps(a, b, c, d), _mm_setzero_ps()))
}

/// The four sums of columns: t0, t0 + t1, (t0 + t1) + t2 and all.
#[inline]
#[target_feature(enable = "avx2,popcnt")]
fn running(sums: __m256d) -> (f64, f64, f64, f64) {
    let (low, high) = (_mm256_castpd256_pd128(sums), _mm256_extractf128_pd::<1>(sums));
    let a = _mm_cvtsd_f64(low);
    let b = a + _mm_cvtsd_f64(_mm_unpackhi_pd(low, low));
    let c = b + _mm_cvtsd_f64(high);
    (a, b, c, c + _mm_cvtsd_f64(_mm_unpackhi_pd(high, high)))
}

/// A quarter of a node.
#[inline]
#[target_feature(enable = "avx2,popcnt")]
fn quarter(node: &Node, which: usize) -> __m256i {
    let (quarters, _) = node.as_chunks::<4>();
    let &[a, b, c, d] = &quarters[which % 4];
    _mm256_setr_epi64x(a, b, c, d)
}
