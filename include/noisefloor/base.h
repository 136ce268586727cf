/* Generated from capi/ by `cargo xtask header`; do not edit. Conventions: noisefloor.h. */

#ifndef NOISEFLOOR_BASE_H
#define NOISEFLOOR_BASE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Version and status. */

#define NF_ABI_VERSION 1 // The version of this header. `nf_abi_version()` returns the library's.

uint32_t nf_abi_version(void); // The ABI version the library was built with; it must equal `NF_ABI_VERSION`.

typedef int32_t nf_status; // 0 is success, a negative value an error; `nf_status_message` explains it.

#define NF_OK 0 // Success.
#define NF_ERR_NULL (-1) // A required pointer is NULL.
#define NF_ERR_RANGE (-2) // An argument is outside its documented range.
#define NF_ERR_NOT_FINITE (-3) // An input value is NaN or infinite.
#define NF_ERR_MEMORY (-4) // Caller-supplied memory is too small.
#define NF_ERR_ALIGNMENT (-5) // Caller-supplied memory is not aligned as its type needs.
#define NF_ERR_NO_SAMPLES (-6) // There is nothing to estimate or to draw from.
#define NF_ERR_UNSUPPORTED (-7) // The options exist, but not in this combination.
#define NF_ERR_STATE (-8) // The memory holds no initialised object.
#define NF_ERR_MISMATCH (-9) // Two objects were made with different configurations.
#define NF_ERR_FOREIGN (-10) // The bytes are no tile, or no table.
#define NF_ERR_VERSION (-11) // The format is newer than this library.
#define NF_ERR_LENGTH (-12) // Bytes, or elements of an array, are missing, or there are too many.
#define NF_ERR_CORRUPT (-13) // The bytes are damaged.

// A static, NUL-terminated sentence for a status; never NULL, also for values that are no status.
const char *nf_status_message(nf_status status);

#define NF_CHECK_CV_CONFIG 0 // nf_check: an nf_cv_config.
#define NF_CHECK_CV_IMAGE 1 // nf_check: an nf_cv_image.
#define NF_CHECK_CV_DESCENT 2 // nf_check: an nf_cv_descent.
#define NF_CHECK_OMIS 3 // nf_check: an nf_omis_arguments.
#define NF_CHECK_IMPORTANCE 4 // nf_check: an nf_importance_arguments.
#define NF_CHECK_TABLE 5 // nf_check: an nf_table.
#define NF_CHECK_TILE 6 // nf_check: an nf_tile.
#define NF_CHECK_TILE_SAMPLER 7 // nf_check: an nf_tile_sampler, its tile included.
#define NF_CHECK_DIMS 8 // nf_check: a uint32_t, the `dims` that any sampler is to draw.

// What is wrong with the configuration that `what` points to, of a kind NF_CHECK_*: a static sentence that names the
// first field that is out of its range, and the range, or NULL. No array is read but the counts of nf_omis_arguments,
// and options that only some functions take, NF_ERR_UNSUPPORTED elsewhere, pass. Any nf_sampler is a valid one.
const char *nf_check(uint32_t kind, const void *what);

/* Random numbers. */

// A PCG32 random number generator (O'Neill 2014), for minibatches and tests: the same numbers on every target.
//
// A complete struct, kept by value. A copy repeats the numbers its original has yet to give. Give each thread its own,
// with its own seed. Any value of the fields is valid; nf_rng_seed sets them well. Not for cryptography.
typedef struct nf_rng {
    uint64_t state; // Where the generator is.
    uint64_t increment; // Which of 2^63 streams it is on; the lowest bit counts as set.
} nf_rng;

// Starts a generator. Any seed is good, and neighbouring seeds (pixel numbers, say) give unrelated numbers. Does
// nothing if `rng` is NULL.
void nf_rng_seed(nf_rng *rng, uint64_t seed);

uint32_t nf_rng_next(nf_rng *rng); // The next 32 random bits; 0 if `rng` is NULL.

float nf_rng_uniform(nf_rng *rng); // The next number uniform in [0, 1), a multiple of 2^-24; 0 if `rng` is NULL.

#ifdef __cplusplus
}
#endif

#endif /* NOISEFLOOR_BASE_H */
