/* Optimal multiple importance sampling from the samples: nf_omis_*(). */
#include "check.h"

static const uint32_t counts[2] = {2, 1};

/* The samples of `pinned_values` in tests/tests/mis_optimal.rs. */
static void add_samples_of(nf_omis *omis, nf_omis *other)
{
    nf_rng rng;
    uint32_t i;
    nf_rng_seed(&rng, 31);
    for (i = 0; i < 30; ++i) {
        const float x = nf_rng_uniform(&rng);
        const float pdf[2] = {1.0f, 0.5f + x}, value[2] = {x * x, 1.0f - x};
        const uint32_t technique = i % 2;
        CHECK_STATUS(nf_omis_add(i % 5 == 0 ? other : omis, pdf, &technique, value, 1), NF_OK);
        if (i == 14)
            CHECK_STATUS(nf_omis_next_batch(omis, NF_OMIS_PLAIN, 0.0f, 0.5f), NF_OK);
    }
}

static nf_omis *make(memory *memory_out)
{
    nf_omis *omis = NULL;
    *memory_out = memory_new(nf_omis_size(2, 2));
    CHECK_STATUS(nf_omis_init(memory_out->start, memory_out->bytes, 2, 2, counts, &omis), NF_OK);
    CHECK((void *)omis == memory_out->start);
    return omis;
}

/* Bits that tests/tests/mis_optimal.rs pins too. */
static void normal_use(void)
{
    static const struct {
        uint32_t solver;
        float ridge;
    } solvers[5] = {{NF_OMIS_RIDGE, 0.0f}, {NF_OMIS_RIDGE, 0.5f}, {NF_OMIS_PLAIN, -1.0f}, {NF_OMIS_PROGRESSIVE, 0.0f},
                    {NF_OMIS_BALANCE, 0.0f}};
    memory m, m2;
    nf_omis *omis = make(&m), *other = make(&m2);
    float both[6], estimate[2], alpha[4];
    uint64_t hash = 0;
    size_t k, i;
    add_samples_of(omis, other);
    CHECK_STATUS(nf_omis_merge(omis, other), NF_OK);
    for (k = 0; k < 5; ++k) {
        CHECK_STATUS(nf_omis_solve(omis, solvers[k].solver, solvers[k].ridge, both, both + 2), NF_OK);
        for (i = 0; i < 6; ++i) {
            uint32_t bits;
            memcpy(&bits, &both[i], sizeof bits);
            hash = (hash ^ bits) * UINT64_C(0x100000001b3);
        }
        CHECK_STATUS(nf_omis_solve(omis, solvers[k].solver, solvers[k].ridge, estimate, NULL), NF_OK);
        CHECK_STATUS(nf_omis_solve(omis, solvers[k].solver, solvers[k].ridge, NULL, alpha), NF_OK);
        CHECK(memcmp(estimate, both, sizeof estimate) == 0 && memcmp(alpha, both + 2, sizeof alpha) == 0);
    }
    CHECK(hash == UINT64_C(0x38ef5b52ff5ef3cf));
    /* Made anew in the same memory: empty. */
    CHECK_STATUS(nf_omis_init(m.start, m.bytes, 2, 2, counts, &omis), NF_OK);
    CHECK_REFUSED(nf_omis_solve(omis, NF_OMIS_RIDGE, 0.0f, estimate, NULL), NF_ERR_NO_SAMPLES, estimate);
    CHECK_REFUSED(nf_omis_solve(omis, NF_OMIS_RIDGE, 0.0f, NULL, alpha), NF_ERR_NO_SAMPLES, alpha);
    CHECK_STATUS(nf_omis_next_batch(omis, NF_OMIS_RIDGE, 0.0f, 1.0f), NF_ERR_NO_SAMPLES);
    memory_free(&m);
    memory_free(&m2);
}

static void sizes_and_init(void)
{
    static const uint32_t zero[2] = {1, 0};
    const size_t bytes = nf_omis_size(2, 2);
    memory m = memory_new(bytes);
    nf_omis *out;
    uint32_t j;
    CHECK(nf_omis_size(0, 1) == 0 && nf_omis_size(17, 1) == 0 && nf_omis_size(1, 0) == 0 &&
          nf_omis_size(UINT32_MAX, 1) == 0);
    for (j = 1; j <= 16; ++j)
        CHECK(nf_omis_size(j, 1) > 0 && nf_omis_size(j, 1) % 8 == 0 && nf_omis_size(j, 2) > nf_omis_size(j, 1));
    CHECK(sizeof(size_t) == 4 ? nf_omis_size(16, UINT32_MAX) == 0 : nf_omis_size(16, UINT32_MAX) / 272 >= UINT32_MAX);
    CHECK_REFUSED(nf_omis_init(NULL, bytes, 2, 2, counts, &out), NF_ERR_NULL, out);
    CHECK_REFUSED(nf_omis_init(m.start, bytes, 2, 2, NULL, &out), NF_ERR_NULL, out);
    CHECK_STATUS(nf_omis_init(m.start, bytes, 2, 2, counts, NULL), NF_ERR_NULL);
    CHECK_REFUSED(nf_omis_init(m.start, bytes - 1, 2, 2, counts, &out), NF_ERR_MEMORY, out);
    CHECK_REFUSED(nf_omis_init(m.start, bytes, 2, UINT32_MAX, counts, &out), NF_ERR_MEMORY, out);
    CHECK_REFUSED(nf_omis_init((char *)m.start + 4, bytes, 2, 2, counts, &out), NF_ERR_ALIGNMENT, out);
    CHECK_REFUSED(nf_omis_init(m.start, bytes, 0, 2, counts, &out), NF_ERR_RANGE, out);
    CHECK_REFUSED(nf_omis_init(m.start, bytes, 17, 2, counts, &out), NF_ERR_RANGE, out);
    CHECK_REFUSED(nf_omis_init(m.start, bytes, 2, 0, counts, &out), NF_ERR_RANGE, out);
    CHECK_REFUSED(nf_omis_init(m.start, bytes, 2, 2, zero, &out), NF_ERR_RANGE, out);
    CHECK_REFUSED(nf_omis_init(m.start, bytes, 2, 2, (const uint32_t *)misaligned((void *)(size_t)counts), &out),
                  NF_ERR_ALIGNMENT, out);
    CHECK(is_poisoned(m.start, bytes));
    memory_free(&m);
}

/* Whatever is refused leaves every byte as it was. */
static void errors(void)
{
    static const uint32_t other_counts[2] = {1, 1};
    memory m, m2, before;
    nf_omis *omis = make(&m), *other = NULL, *odd = (nf_omis *)misaligned(m.start);
    const float nan = not_a_number(), infinite = infinity_f();
    float pdf[2] = {1.0f, 1.0f}, value[2] = {1.0f, 2.0f}, out[4];
    uint32_t technique = 0;
    size_t i;
    add_samples_of(omis, omis);
    before = memory_new(m.bytes);
    memcpy(before.start, m.start, m.bytes);

    CHECK_STATUS(nf_omis_add(NULL, pdf, &technique, value, 1), NF_ERR_NULL);
    CHECK_STATUS(nf_omis_add(odd, pdf, &technique, value, 1), NF_ERR_ALIGNMENT);
    CHECK_STATUS(nf_omis_add(omis, NULL, &technique, value, 1), NF_ERR_NULL);
    CHECK_STATUS(nf_omis_add(omis, pdf, NULL, value, 1), NF_ERR_NULL);
    CHECK_STATUS(nf_omis_add(omis, pdf, &technique, NULL, 1), NF_ERR_NULL);
    CHECK_STATUS(nf_omis_add(omis, (const float *)misaligned(pdf), &technique, value, 1), NF_ERR_ALIGNMENT);
    technique = 2;
    CHECK_STATUS(nf_omis_add(omis, pdf, &technique, value, 1), NF_ERR_RANGE);
    technique = UINT32_MAX;
    CHECK_STATUS(nf_omis_add(omis, pdf, &technique, value, 1), NF_ERR_RANGE);
    technique = 0;
    pdf[1] = nan;
    CHECK_STATUS(nf_omis_add(omis, pdf, &technique, value, 1), NF_ERR_NOT_FINITE);
    pdf[1] = infinite;
    CHECK_STATUS(nf_omis_add(omis, pdf, &technique, value, 1), NF_ERR_NOT_FINITE);
    pdf[1] = -1.0f;
    CHECK_STATUS(nf_omis_add(omis, pdf, &technique, value, 1), NF_ERR_RANGE);
    pdf[1] = 0.0f;
    technique = 1;
    CHECK_STATUS(nf_omis_add(omis, pdf, &technique, value, 1), NF_ERR_RANGE);
    technique = 0;
    pdf[1] = 1.0f;
    value[1] = nan;
    CHECK_STATUS(nf_omis_add(omis, pdf, &technique, value, 1), NF_ERR_NOT_FINITE);
    value[1] = 2.0f;

    CHECK_REFUSED(nf_omis_solve(NULL, NF_OMIS_RIDGE, 0.0f, out, NULL), NF_ERR_NULL, out);
    CHECK_STATUS(nf_omis_solve(omis, NF_OMIS_RIDGE, 0.0f, NULL, NULL), NF_ERR_NULL);
    CHECK_REFUSED(nf_omis_solve(omis, NF_OMIS_RIDGE, 0.0f, (float *)misaligned(out), NULL), NF_ERR_ALIGNMENT, out);
    CHECK_REFUSED(nf_omis_solve(NULL, NF_OMIS_RIDGE, 0.0f, NULL, out), NF_ERR_NULL, out);
    CHECK_REFUSED(nf_omis_solve(odd, NF_OMIS_RIDGE, 0.0f, out, NULL), NF_ERR_ALIGNMENT, out);
    {
        static const float ridges[] = {-1.0f, 1e-9f, 1e9f};
        CHECK_REFUSED(nf_omis_solve(omis, 4, 0.0f, out, NULL), NF_ERR_RANGE, out);
        CHECK_REFUSED(nf_omis_solve(omis, UINT32_MAX, 0.0f, out, NULL), NF_ERR_RANGE, out);
        CHECK_REFUSED(nf_omis_solve(omis, 4, 0.0f, NULL, out), NF_ERR_RANGE, out);
        CHECK_STATUS(nf_omis_next_batch(omis, 4, 0.0f, 1.0f), NF_ERR_RANGE);
        for (i = 0; i < 3; ++i) {
            CHECK_REFUSED(nf_omis_solve(omis, NF_OMIS_RIDGE, ridges[i], out, NULL), NF_ERR_RANGE, out);
            CHECK_REFUSED(nf_omis_solve(omis, NF_OMIS_RIDGE, ridges[i], NULL, out), NF_ERR_RANGE, out);
            CHECK_STATUS(nf_omis_next_batch(omis, NF_OMIS_RIDGE, ridges[i], 1.0f), NF_ERR_RANGE);
        }
        CHECK_REFUSED(nf_omis_solve(omis, NF_OMIS_RIDGE, nan, out, NULL), NF_ERR_NOT_FINITE, out);
        CHECK_REFUSED(nf_omis_solve(omis, NF_OMIS_RIDGE, infinite, NULL, out), NF_ERR_NOT_FINITE, out);
        CHECK_STATUS(nf_omis_next_batch(omis, NF_OMIS_RIDGE, nan, 1.0f), NF_ERR_NOT_FINITE);
        /* Other solvers ignore the ridge. */
        CHECK_STATUS(nf_omis_solve(omis, NF_OMIS_PLAIN, nan, out, NULL), NF_OK);
    }
    CHECK_STATUS(nf_omis_next_batch(omis, NF_OMIS_PROGRESSIVE, 0.0f, 1.0f), NF_ERR_UNSUPPORTED);
    CHECK_STATUS(nf_omis_next_batch(NULL, NF_OMIS_RIDGE, 0.0f, 1.0f), NF_ERR_NULL);
    CHECK_STATUS(nf_omis_next_batch(omis, NF_OMIS_BALANCE, 0.0f, -0.1f), NF_ERR_RANGE);
    CHECK_STATUS(nf_omis_next_batch(omis, NF_OMIS_BALANCE, 0.0f, 1.1f), NF_ERR_RANGE);
    CHECK_STATUS(nf_omis_next_batch(omis, NF_OMIS_BALANCE, 0.0f, nan), NF_ERR_NOT_FINITE);
    CHECK_STATUS(nf_omis_next_batch(omis, NF_OMIS_BALANCE, 0.0f, infinite), NF_ERR_NOT_FINITE);
    CHECK_STATUS(nf_omis_next_batch(odd, NF_OMIS_RIDGE, 0.0f, 1.0f), NF_ERR_ALIGNMENT);

    CHECK_STATUS(nf_omis_merge(omis, omis), NF_ERR_RANGE);
    CHECK_STATUS(nf_omis_merge(NULL, omis), NF_ERR_NULL);
    CHECK_STATUS(nf_omis_merge(omis, NULL), NF_ERR_NULL);
    CHECK_STATUS(nf_omis_merge(NULL, NULL), NF_ERR_NULL);
    CHECK_STATUS(nf_omis_merge(odd, omis), NF_ERR_ALIGNMENT);
    CHECK_STATUS(nf_omis_merge(omis, odd), NF_ERR_ALIGNMENT);
    m2 = memory_new(nf_omis_size(2, 3));
    CHECK_STATUS(nf_omis_init(m2.start, m2.bytes, 2, 2, other_counts, &other), NF_OK);
    CHECK_STATUS(nf_omis_merge(omis, other), NF_ERR_MISMATCH);
    CHECK_STATUS(nf_omis_init(m2.start, m2.bytes, 2, 3, counts, &other), NF_OK);
    CHECK_STATUS(nf_omis_merge(omis, other), NF_ERR_MISMATCH);
    CHECK_STATUS(nf_omis_init(m2.start, m2.bytes, 1, 2, counts, &other), NF_OK);
    CHECK_STATUS(nf_omis_merge(omis, other), NF_ERR_MISMATCH);
    for (i = 0; i < 2; ++i) {
        memset(m2.start, i == 0 ? 0 : POISON, m2.bytes);
        CHECK_STATUS(nf_omis_merge(omis, other), NF_ERR_STATE);
        CHECK_STATUS(nf_omis_merge(other, omis), NF_ERR_STATE);
        CHECK_STATUS(nf_omis_add(other, pdf, &technique, value, 1), NF_ERR_STATE);
        CHECK_REFUSED(nf_omis_solve(other, NF_OMIS_RIDGE, 0.0f, out, NULL), NF_ERR_STATE, out);
        CHECK_REFUSED(nf_omis_solve(other, NF_OMIS_RIDGE, 0.0f, NULL, out), NF_ERR_STATE, out);
        CHECK_STATUS(nf_omis_next_batch(other, NF_OMIS_RIDGE, 0.0f, 1.0f), NF_ERR_STATE);
    }
    {
        /* One of two is refused: neither is added. */
        static const float densities[4] = {1.0f, 1.0f, 1.0f, 0.0f}, values[4] = {1.0f, 2.0f, 3.0f, 4.0f};
        static const uint32_t drawn[2] = {0, 1};
        CHECK_STATUS(nf_omis_add(omis, densities, drawn, values, 2), NF_ERR_RANGE);
        CHECK_STATUS(nf_omis_add(omis, densities, drawn, values, SIZE_MAX), NF_ERR_RANGE);
        CHECK_STATUS(nf_omis_add(omis, NULL, NULL, NULL, 0), NF_OK);
    }
    CHECK(memcmp(before.start, m.start, m.bytes) == 0);
    memory_free(&m);
    memory_free(&m2);
    memory_free(&before);
}

static nf_status add(void *object)
{
    static const float ones[2] = {1.0f, 1.0f};
    static const uint32_t technique = 0;
    return nf_omis_add((nf_omis *)object, ones, &technique, ones, 1);
}

/* Bytes of another build of the library, which may mean something else by them. */
static void another_build(void)
{
    memory m;
    check_other_builds(make(&m), "nf_omis\x01", add);
    memory_free(&m);
}

/* What is wrong is named, with its range. */
static void checked(void)
{
    static const uint32_t zero[2] = {1, 0};
    nf_omis_arguments of;
    memset(&of, 0, sizeof of);
    CHECK_NAMED(NF_CHECK_OMIS, &of, "techniques must be 1 to 16");
    of.techniques = 17;
    CHECK_NAMED(NF_CHECK_OMIS, &of, "techniques must be 1 to 16");
    of.techniques = 2;
    CHECK_NAMED(NF_CHECK_OMIS, &of, NULL);
    of.counts = zero;
    CHECK_NAMED(NF_CHECK_OMIS, &of, "counts must be at least 1");
    of.counts = (const uint32_t *)misaligned(&of);
    CHECK_NAMED(NF_CHECK_OMIS, &of, "counts are misaligned");
    of.counts = counts;
    of.integrals = 3;
    of.solver = 4;
    CHECK_NAMED(NF_CHECK_OMIS, &of, "solver must be one of NF_OMIS_*, 0 to 3");
    of.solver = NF_OMIS_PROGRESSIVE;
    of.ridge = -1.0f;
    CHECK_NAMED(NF_CHECK_OMIS, &of, NULL); /* read with NF_OMIS_RIDGE alone */
    of.solver = NF_OMIS_RIDGE;
    CHECK_NAMED(NF_CHECK_OMIS, &of, "ridge must be 1e-8 to 1e8");
    of.ridge = not_a_number();
    CHECK_NAMED(NF_CHECK_OMIS, &of, "ridge must be 1e-8 to 1e8");
    of.ridge = 1e8f;
    of.beta = 1.5f;
    CHECK_NAMED(NF_CHECK_OMIS, &of, "beta must be 0 to 1");
    of.beta = 1.0f;
    CHECK_NAMED(NF_CHECK_OMIS, &of, NULL);
    CHECK_NAMED(NF_CHECK_OMIS, NULL, "NULL");
}

int main(void)
{
    normal_use();
    checked();
    sizes_and_init();
    errors();
    another_build();
    return report("omis");
}
