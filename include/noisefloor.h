/* noisefloor: less Monte Carlo noise for the samples you already pay for.
 *
 * For C99 and newer. Generated from capi/ by `cargo xtask header`; do not edit. MIT OR Apache-2.0.
 *
 * Conventions, written once:
 *  - Arguments: configuration or object first (for an init function, the memory of the object to be), then inputs, then
 *    memory, then outputs. No memory or output may overlap any other argument.
 *  - Samples are points of primary sample space, u in [0, 1]^dims, row after row; f = integrand / pdf, any unit.
 *  - Every function that can fail returns nf_status: 0 (NF_OK) or a negative NF_ERR_*. Outputs are written, and objects
 *    changed, only on success. Inputs are checked: NULL, ranges, lengths, alignment, finite values.
 *  - Memory: nothing is ever allocated. Objects and workspaces live in caller memory, 8-byte aligned, of at least the
 *    bytes that the matching size function returns. Neither they nor outputs need be initialised, and nothing
 *    destroyed. Pointers are kept by tables, tiles and tile samplers alone. An object must not be moved or copied while
 *    it is in use, unless its description says otherwise. The bytes of one mean something only to the library file that
 *    made them, which alone may change them: NF_ERR_STATE tells memory that holds no object, not an object whose bytes
 *    were changed. Tables are kept, and sent elsewhere, with nf_table_save(). Calls take up to 40 kB of stack (x86-64).
 *  - Threads: no locks, and no shared state but a cached answer of the processor's. Any number of threads may read an
 *    object; one at a time may write it.
 *  - Arithmetic: IEEE 754, rounding to nearest. Where the host flushes subnormal numbers to zero, values above 1e-30
 *    give the same bits. Built for x86-64, nothing raises an invalid operation, a division by zero or an overflow for
 *    zeros and for values of magnitude 1e-15 to 1e15 (control functions in float: 1e-8 to 1e8), but for a descent with
 *    a `learning_rate` of the caller's: hosts may trap these.
 *  - Configurations are plain numbers; zero in an optional field means the documented default (of nf_cv_config all but
 *    dims, order and channels are optional), an unknown value is NF_ERR_RANGE. Zero or NULL is what is not there.
 *  - Not listed with each function: NF_ERR_NULL and NF_ERR_ALIGNMENT of any pointer, NF_ERR_STATE of any object. Arrays
 *    of no elements may be NULL, and calls for no rows, items or integrals succeed, unless their errors name that.
 *  - NF_ERR_RANGE does not say which argument it means: a function's comment lists those that it can mean, with their
 *    ranges there or where they are declared. nf_check() names the field of a configuration.
 *  - References such as (4.22) are to C. Salaun, "Toward Improving Monte Carlo Estimator for Rendering and
 *    Machine Learning", 2025.
 */

#ifndef NOISEFLOOR_H
#define NOISEFLOOR_H

#include "noisefloor/base.h"
#include "noisefloor/cv.h"
#include "noisefloor/mis.h"
#include "noisefloor/tile.h"
#include "noisefloor/table.h"

/* Layouts: what the library was compiled with. C99 has no alignment operator. */
#if defined(__cplusplus) && __cplusplus >= 201103L
#define NF_ASSERT_LAYOUT(condition) static_assert(condition, "noisefloor: unexpected struct layout")
#define NF_ASSERT_ALIGNED_AS(a, b) NF_ASSERT_LAYOUT(alignof(a) == alignof(b))
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L
#define NF_ASSERT_LAYOUT(condition) _Static_assert(condition, "noisefloor: unexpected struct layout")
#define NF_ASSERT_ALIGNED_AS(a, b) NF_ASSERT_LAYOUT(_Alignof(a) == _Alignof(b))
#else
#define NF_ASSERT_LAYOUT(condition) unsigned : (condition) ? 1 : -1
#define NF_ASSERT_ALIGNED_AS(a, b) NF_ASSERT_LAYOUT(sizeof(a) % sizeof(b) == 0)
#endif
#define NF_ASSERT_STRUCT(a, size, field, offset, b) \
    NF_ASSERT_LAYOUT(sizeof(a) == (size) && offsetof(a, field) == (offset)); NF_ASSERT_ALIGNED_AS(a, b)
struct nf_layouts { /* In one struct: C99's are bit-fields without names. */
NF_ASSERT_LAYOUT(sizeof(nf_status) == 4 && sizeof(nf_cv_descent) == 16 && sizeof(nf_importance_arguments) == 12);
NF_ASSERT_STRUCT(nf_cv_config, 64, ridge, 60, uint32_t);
NF_ASSERT_LAYOUT(sizeof(nf_cv_samples) == 6 * sizeof(void *) + sizeof(size_t));
NF_ASSERT_STRUCT(nf_estimate, 40, samples, 32, float);
NF_ASSERT_LAYOUT(sizeof(nf_cv_image) == 24 + 3 * sizeof(void *) + 32 && offsetof(nf_cv_image, samples) == 24);
NF_ASSERT_STRUCT(nf_cv_rectangle, 16, width, 8, uint32_t);
NF_ASSERT_STRUCT(nf_recommendation, 96, config, 32, uint32_t);
NF_ASSERT_STRUCT(nf_omis_arguments, 2 * sizeof(void *) + 16, beta, sizeof(void *) + 16, void *);
NF_ASSERT_STRUCT(nf_tile, 2 * sizeof(void *) + 24, size, 2 * sizeof(void *), void *);
NF_ASSERT_STRUCT(nf_tile_sampler, sizeof(void *) + 16, domain, sizeof(void *), void *);
NF_ASSERT_STRUCT(nf_sampler, 16, x, 8, uint32_t);
NF_ASSERT_STRUCT(nf_rng, 16, increment, 8, uint64_t);
NF_ASSERT_STRUCT(nf_table, 2 * sizeof(void *) + 24, items, 2 * sizeof(void *) + 8, double);
NF_ASSERT_STRUCT(nf_shard, 16, items, 8, uint64_t);
char unused; };
#undef NF_ASSERT_STRUCT
#undef NF_ASSERT_ALIGNED_AS
#undef NF_ASSERT_LAYOUT

#endif /* NOISEFLOOR_H */
