/* What the C tests share: a check that says where it failed, poisoned outputs, and memory with guards on both sides.
 * Each program ends with `return report("theme");`. The same files are compiled as C++17 against noisefloor.hpp. */
#ifndef NF_TESTS_CHECK_H
#define NF_TESTS_CHECK_H

#ifdef __cplusplus
#include "noisefloor.hpp"
#else
#include "noisefloor.h"
#endif
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int nf_checks, nf_failures, nf_left_out;

static inline void check_at(int condition, const char *text, const char *file, int line)
{
    ++nf_checks;
    if (!condition) {
        ++nf_failures;
        fprintf(stderr, "%s:%d: failed: %s\n", file, line, text);
    }
}

static inline void check_status_at(nf_status actual, nf_status expected, const char *text, const char *file, int line)
{
    ++nf_checks;
    if (actual != expected) {
        ++nf_failures;
        fprintf(stderr, "%s:%d: %s\n    returned %d (%s), not %d\n", file, line, text, (int)actual,
                nf_status_message(actual), (int)expected);
    }
}

static inline void check_named_at(const char *found, const char *words, const char *text, const char *file, int line)
{
    ++nf_checks;
    if (words ? !found || !strstr(found, words) : found != NULL) {
        ++nf_failures;
        fprintf(stderr, "%s:%d: %s: \"%s\" is found wrong, not \"%s\"\n", file, line, text, found ? found : "nothing",
                words ? words : "nothing");
    }
}

/* How many bases there are: their numbers are 0 and up. */
#define BASES (NF_BASIS_GAUSSIAN + 1u)

#define CHECK(condition) check_at((condition) ? 1 : 0, #condition, __FILE__, __LINE__)
/* nf_check() says nothing, or a sentence that contains the words. */
#define CHECK_NAMED(kind, what, words) check_named_at(nf_check((kind), (what)), (words), #what, __FILE__, __LINE__)
#define CHECK_STATUS(call, expected) check_status_at((call), (expected), #call, __FILE__, __LINE__)
/* The call must fail with `expected` and leave the object `out` as it was. */
#define CHECK_REFUSED(call, expected, out)                     \
    do {                                                       \
        poison(&(out), sizeof(out));                           \
        check_status_at((call), (expected), #call, __FILE__, __LINE__); \
        check_at(is_poisoned(&(out), sizeof(out)), "outputs untouched: " #call, __FILE__, __LINE__); \
    } while (0)

/* The same with NF_ERR_NOT_FINITE, for a NaN that the library finds by comparing vectors. Where NAN_TAKEN_FOR_FINITE is
 * defined, because what emulates the processor gets that comparison wrong, these checks and no others are left out. */
#ifdef NAN_TAKEN_FOR_FINITE
#define CHECK_NAN_STATUS(call) ((void)++nf_left_out)
#define CHECK_NAN_REFUSED(call, out) ((void)++nf_left_out)
#else
#define CHECK_NAN_STATUS(call) CHECK_STATUS(call, NF_ERR_NOT_FINITE)
#define CHECK_NAN_REFUSED(call, out) CHECK_REFUSED(call, NF_ERR_NOT_FINITE, out)
#endif

static inline int report(const char *theme)
{
    printf("%-12s %d checks, %d failed", theme, nf_checks, nf_failures);
    if (nf_left_out > 0)
        printf(", %d with NaN left out", nf_left_out);
    printf("\n");
    return nf_failures == 0 ? 0 : 1;
}

#define POISON 0xC3
static inline void poison(void *bytes, size_t count) { memset(bytes, POISON, count); }

static inline int is_poisoned(const void *bytes, size_t count)
{
    const unsigned char *byte = (const unsigned char *)bytes;
    size_t i;
    for (i = 0; i < count; ++i)
        if (byte[i] != POISON)
            return 0;
    return 1;
}

/* Exactly `bytes` bytes at `start`, 16-byte aligned, with guards before and behind; full of what is no useful number.
 */
#define GUARD 64
typedef struct memory {
    unsigned char *base;
    void *start;
    size_t bytes;
} memory;

static inline memory memory_new(size_t bytes)
{
    memory m;
    m.base = (unsigned char *)malloc(bytes + 2 * GUARD);
    if (!m.base) {
        fprintf(stderr, "out of memory\n");
        exit(2);
    }
    poison(m.base, bytes + 2 * GUARD);
    m.start = m.base + GUARD;
    m.bytes = bytes;
    return m;
}

static inline int memory_is_intact(const memory *m)
{
    return is_poisoned(m->base, GUARD) && is_poisoned(m->base + GUARD + m->bytes, GUARD);
}

static inline void memory_free(memory *m)
{
    CHECK(memory_is_intact(m));
    free(m->base);
    m->base = NULL;
}

/* The first 8 bytes of an object say which build of the library made it. `call` must take them for its
 * own, but find NF_ERR_STATE where a byte differs, and for `before`, a fixed name, which says nothing of the object's
 * layout. Of memory that holds no object nothing behind them may be read. */
static inline void check_other_builds(void *object, const char *before, nf_status (*call)(void *object))
{
    unsigned char *byte = (unsigned char *)object, kept[8];
    int i;
    memcpy(kept, object, sizeof kept);
    CHECK_STATUS(call(object), NF_OK);
    for (i = 0; i < 8; ++i) {
        byte[i] = (unsigned char)(byte[i] ^ 1);
        CHECK_STATUS(call(object), NF_ERR_STATE);
        byte[i] = kept[i];
    }
    memcpy(object, before, sizeof kept);
    CHECK_STATUS(call(object), NF_ERR_STATE);
    memcpy(object, kept, sizeof kept);
    CHECK_STATUS(call(object), NF_OK);
    object = malloc(sizeof kept);
    if (object != NULL) {
        memcpy(object, before, sizeof kept);
        CHECK_STATUS(call(object), NF_ERR_STATE);
    }
    free(object);
}

/* One address further on: misaligned for anything larger than a byte. */
static inline void *misaligned(void *pointer) { return (unsigned char *)pointer + 1; }

static inline float not_a_number(void) { return (float)sqrt(-1.0); }
static inline float infinity_f(void) { return (float)HUGE_VAL; }

static inline nf_cv_config make_config(uint32_t dims, uint32_t order, uint32_t channels, uint32_t estimator)
{
    nf_cv_config config;
    memset(&config, 0, sizeof config);
    config.dims = dims;
    config.order = order;
    config.channels = channels;
    config.estimator = estimator;
    return config;
}

static inline nf_cv_samples samples_of(const float *u, const float *f, size_t n)
{
    nf_cv_samples samples;
    memset(&samples, 0, sizeof samples);
    samples.u = u;
    samples.f = f;
    samples.n = n;
    return samples;
}

/* The calls of samples as functions of their arrays. */
static inline nf_status estimate_many(const nf_cv_config *config, const float *u, const float *f, size_t n,
                                      size_t integrals, void *workspace, size_t bytes, nf_estimate *out)
{
    const nf_cv_samples samples = samples_of(u, f, n);
    return nf_cv_estimate(config, &samples, integrals, workspace, bytes, out);
}
static inline nf_status estimate_one(const nf_cv_config *config, const float *u, const float *f, size_t n,
                                     void *workspace, size_t bytes, nf_estimate *out)
{
    return estimate_many(config, u, f, n, 1, workspace, bytes, out);
}
static inline nf_status estimate_image(const nf_cv_config *config, const nf_cv_image *image, const float *u,
                                       const float *f, size_t n, void *workspace, size_t bytes, nf_estimate *out)
{
    const nf_cv_samples samples = samples_of(u, f, n);
    return nf_cv_image_estimate(config, image, &samples, workspace, bytes, out);
}
static inline size_t image_workspace_size(const nf_cv_config *config, const nf_cv_image *image, size_t n)
{
    const nf_cv_samples samples = samples_of(NULL, NULL, n);
    return nf_cv_image_workspace_size(config, image, &samples);
}
static inline nf_status estimate_controlled(const nf_cv_config *config, const float *u, const float *f, const float *h,
                                            const float *integral, size_t n, void *workspace, size_t bytes,
                                            nf_estimate *out)
{
    nf_cv_samples samples = samples_of(u, f, n);
    samples.controls = h;
    samples.control_integrals = integral;
    return nf_cv_estimate(config, &samples, 1, workspace, bytes, out);
}
static inline nf_status descend(const nf_cv_config *config, const float *u, const float *f, size_t n,
                                const nf_cv_descent *descent, float *coefficients, void *workspace, size_t bytes,
                                nf_estimate *out)
{
    const nf_cv_samples samples = samples_of(u, f, n);
    return nf_cv_gradient_descent(config, &samples, descent, coefficients, workspace, bytes, out);
}
static inline nf_status add_samples(nf_cv_accumulator *accumulator, const float *u, const float *f, size_t n)
{
    const nf_cv_samples samples = samples_of(u, f, n);
    return nf_cv_accumulator_add(accumulator, &samples);
}
static inline size_t accumulator_workspace_size(const nf_cv_config *config)
{
    size_t workspace;
    nf_cv_accumulator_size(config, &workspace);
    return workspace;
}

/* What a table says of one item, and of all. */
static inline float probability_of(const nf_table *table, uint32_t item)
{
    float p;
    return nf_table_probabilities(table, &item, 1, 1, &p) == NF_OK ? p : 0.0f;
}
static inline double total_of(const nf_table *table)
{
    nf_shard shard;
    return nf_table_shard(table, &shard) == NF_OK ? shard.importance : 0.0;
}

/* n rows of `stride` uniform numbers. */
static inline void fill_uniform(float *u, size_t count, uint64_t seed)
{
    nf_rng rng;
    size_t i;
    nf_rng_seed(&rng, seed);
    for (i = 0; i < count; ++i)
        u[i] = nf_rng_uniform(&rng);
}

/* f = (c + 1) (1 + sum of the coordinates), whose integral is (c + 1) (1 + dims / 2). */
static inline void fill_linear(float *f, const float *u, size_t n, size_t dims, size_t channels)
{
    size_t i, d, c;
    for (i = 0; i < n; ++i) {
        float sum = 1.0f;
        for (d = 0; d < dims; ++d)
            sum += u[i * dims + d];
        for (c = 0; c < channels; ++c)
            f[i * channels + c] = (float)(c + 1) * sum;
    }
}

#endif
