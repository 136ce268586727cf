/* noisefloor: less Monte Carlo noise for the samples you already pay for.
 *
 * Generated from capi/ by `cargo xtask header`; do not edit. MIT OR Apache-2.0.
 *
 * Conventions, written once:
 *  - Arguments: configuration or object first, then inputs, then memory, then outputs.
 *  - Samples are points of primary sample space, u in [0, 1]^dims, row after row; f = integrand / pdf, any unit.
 *  - Every function that can fail returns nf_status: 0 (NF_OK) or a negative NF_ERR_*. Outputs are written, and objects
 *    changed, only on success. Inputs are checked: NULL, ranges, lengths, alignment, finite values.
 *  - Memory: nothing is ever allocated. Objects and workspaces live in caller memory, 8-byte aligned, of at least the
 *    bytes that the matching size function returns. Nothing needs to be destroyed. An object must not be moved or
 *    copied while it is in use, unless its description says otherwise.
 *  - Threads: no locks and no shared mutable state. Any number of threads may read an object; one at a time may write it.
 *  - Configurations are plain integers; zero in an optional field means the documented default, an unknown value is
 *    NF_ERR_RANGE.
 *  - References such as (4.22) are to C. Salaun, "Toward Improving Monte Carlo Estimator for Rendering and
 *    Machine Learning", 2025.
 */

#ifndef NOISEFLOOR_H
#define NOISEFLOOR_H

#include <stddef.h>
#include <stdint.h>

/*
 The version of this header. `nf_abi_version()` returns the library's.
 */
#define NF_ABI_VERSION 1

/*
 0 is success, a negative value an error; `nf_status_message` explains it.
 */
typedef int32_t nf_status;

/*
 Success.
 */
#define NF_OK 0

/*
 A required pointer is NULL.
 */
#define NF_ERR_NULL -1

/*
 An argument is outside its documented range.
 */
#define NF_ERR_RANGE -2

/*
 An input value is NaN or infinite.
 */
#define NF_ERR_NOT_FINITE -3

/*
 Caller-supplied memory is too small.
 */
#define NF_ERR_MEMORY -4

/*
 Caller-supplied memory is not aligned as its type needs.
 */
#define NF_ERR_ALIGNMENT -5

/*
 There is nothing to estimate from.
 */
#define NF_ERR_NO_SAMPLES -6

/*
 The options exist, but not in this combination.
 */
#define NF_ERR_UNSUPPORTED -7

/*
 The memory holds no initialised object.
 */
#define NF_ERR_STATE -8

/*
 Two objects were made with different configurations.
 */
#define NF_ERR_MISMATCH -9

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/*
 The ABI version the library was built with; it must equal `NF_ABI_VERSION`.
 */
uint32_t nf_abi_version(void);

/*
 A static, NUL-terminated sentence for a status; never NULL, also for values that are no status.
 */
const char *nf_status_message(nf_status status);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* NOISEFLOOR_H */
