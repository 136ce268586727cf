/* Optimal multiple importance sampling from the samples: nf_omis_*(). */
#include "check.h"

/* Two techniques on [0, 1]: p_0 = 1 and p_1 = 2x, and two integrands: 3 p_0 + 2 p_1, whose integral is 5 and which
 * optimal weights integrate without error, and x^2, whose integral is 1/3. */
static const uint32_t counts[2] = {2, 1};

static void add_round(nf_omis *omis, nf_rng *rng)
{
    uint32_t technique, i;
    for (technique = 0; technique < 2; ++technique)
        for (i = 0; i < counts[technique]; ++i) {
            float x = technique == 0 ? nf_rng_uniform(rng) : sqrtf(1.0f - nf_rng_uniform(rng));
            float pdf[2], value[2];
            pdf[0] = 1.0f;
            pdf[1] = 2.0f * x;
            value[0] = 3.0f * pdf[0] + 2.0f * pdf[1];
            value[1] = x * x;
            CHECK_STATUS(nf_omis_add(omis, technique, pdf, value), NF_OK);
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

static void normal_use(void)
{
    static const uint32_t solvers[] = {NF_OMIS_RIDGE, NF_OMIS_PLAIN, NF_OMIS_PROGRESSIVE, NF_OMIS_BALANCE};
    memory m, m2;
    nf_omis *omis = make(&m), *second = make(&m2);
    nf_rng rng;
    float estimate[2], again[2], alpha[4];
    size_t k, i;
    nf_rng_seed(&rng, 31);
    for (i = 0; i < 200; ++i) {
        add_round(omis, &rng);
        if (i % 50 == 49)
            CHECK_STATUS(nf_omis_next_batch(omis, NF_OMIS_RIDGE, 0.0f, 1.0f), NF_OK);
    }
    for (k = 0; k < 4; ++k) {
        CHECK_STATUS(nf_omis_solve(omis, solvers[k], 0.0f, estimate, NULL), NF_OK);
        CHECK_STATUS(nf_omis_solve(omis, solvers[k], 0.0f, again, NULL), NF_OK);
        CHECK(memcmp(estimate, again, sizeof estimate) == 0);
        /* The balance heuristic's standard errors at 600 samples are about .05 and .012. */
        CHECK(fabsf(estimate[0] - 5.0f) < 0.2f && fabsf(estimate[1] - 1.0f / 3.0f) < 0.05f);
    }
    CHECK_STATUS(nf_omis_solve(omis, NF_OMIS_PLAIN, 0.0f, estimate, NULL), NF_OK);
    CHECK(fabsf(estimate[0] - 5.0f) < 1e-4f);
    CHECK_STATUS(nf_omis_solve(omis, NF_OMIS_PLAIN, 0.0f, NULL, alpha), NF_OK);
    CHECK(fabsf(alpha[0] - 3.0f) < 1e-3f && fabsf(alpha[1] - 2.0f) < 1e-3f);
    CHECK_STATUS(nf_omis_solve(omis, NF_OMIS_BALANCE, 0.0f, NULL, alpha), NF_OK);
    CHECK(alpha[0] == 0.0f && alpha[3] == 0.0f);
    CHECK_STATUS(nf_omis_solve(omis, NF_OMIS_RIDGE, 2.0f, estimate, NULL), NF_OK);
    CHECK_STATUS(nf_omis_solve(omis, NF_OMIS_RIDGE, 0.0f, again, NULL), NF_OK);
    CHECK(memcmp(estimate, again, sizeof estimate) == 0);

    /* Fading keeps a ratio of sums; with half of the samples the same ridge counts twice. */
    CHECK_STATUS(nf_omis_next_batch(omis, NF_OMIS_BALANCE, 0.0f, 0.5f), NF_OK);
    CHECK_STATUS(nf_omis_solve(omis, NF_OMIS_RIDGE, 1.0f, again, NULL), NF_OK);
    CHECK(fabsf(estimate[0] - again[0]) < 1e-5f && fabsf(estimate[1] - again[1]) < 1e-6f);

    /* Merging: the samples of both. */
    for (i = 0; i < 100; ++i)
        add_round(second, &rng);
    CHECK_STATUS(nf_omis_merge(omis, second), NF_OK);
    CHECK_STATUS(nf_omis_solve(omis, NF_OMIS_PLAIN, 0.0f, estimate, NULL), NF_OK);
    CHECK(fabsf(estimate[0] - 5.0f) < 1e-4f);

    CHECK_STATUS(nf_omis_solve(omis, NF_OMIS_PLAIN, 0.0f, again, alpha), NF_OK);
    CHECK(memcmp(estimate, again, sizeof estimate) == 0 && fabsf(alpha[0] - 3.0f) < 1e-3f);

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
    if (sizeof(size_t) == 4)
        CHECK(nf_omis_size(16, UINT32_MAX) == 0);
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
    nf_rng rng;
    const float nan = not_a_number(), infinite = infinity_f();
    float pdf[2] = {1.0f, 1.0f}, value[2] = {1.0f, 2.0f}, out[4];
    size_t i;
    nf_rng_seed(&rng, 41);
    for (i = 0; i < 20; ++i)
        add_round(omis, &rng);
    before = memory_new(m.bytes);
    memcpy(before.start, m.start, m.bytes);

    CHECK_STATUS(nf_omis_add(NULL, 0, pdf, value), NF_ERR_NULL);
    CHECK_STATUS(nf_omis_add(odd, 0, pdf, value), NF_ERR_ALIGNMENT);
    CHECK_STATUS(nf_omis_add(omis, 0, NULL, value), NF_ERR_NULL);
    CHECK_STATUS(nf_omis_add(omis, 0, pdf, NULL), NF_ERR_NULL);
    CHECK_STATUS(nf_omis_add(omis, 0, (const float *)misaligned(pdf), value), NF_ERR_ALIGNMENT);
    CHECK_STATUS(nf_omis_add(omis, 2, pdf, value), NF_ERR_RANGE);
    CHECK_STATUS(nf_omis_add(omis, UINT32_MAX, pdf, value), NF_ERR_RANGE);
    pdf[1] = nan;
    CHECK_STATUS(nf_omis_add(omis, 0, pdf, value), NF_ERR_NOT_FINITE);
    pdf[1] = infinite;
    CHECK_STATUS(nf_omis_add(omis, 0, pdf, value), NF_ERR_NOT_FINITE);
    pdf[1] = -1.0f;
    CHECK_STATUS(nf_omis_add(omis, 0, pdf, value), NF_ERR_RANGE);
    pdf[1] = 0.0f;
    CHECK_STATUS(nf_omis_add(omis, 1, pdf, value), NF_ERR_RANGE);
    pdf[1] = 1.0f;
    value[1] = nan;
    CHECK_STATUS(nf_omis_add(omis, 0, pdf, value), NF_ERR_NOT_FINITE);
    value[1] = 2.0f;

    CHECK_REFUSED(nf_omis_solve(NULL, NF_OMIS_RIDGE, 0.0f, out, NULL), NF_ERR_NULL, out);
    CHECK_STATUS(nf_omis_solve(omis, NF_OMIS_RIDGE, 0.0f, NULL, NULL), NF_ERR_NULL);
    CHECK_REFUSED(nf_omis_solve(omis, NF_OMIS_RIDGE, 0.0f, (float *)misaligned(out), NULL), NF_ERR_ALIGNMENT, out);
    CHECK_REFUSED(nf_omis_solve(NULL, NF_OMIS_RIDGE, 0.0f, NULL, out), NF_ERR_NULL, out);
    CHECK_STATUS(nf_omis_solve(omis, NF_OMIS_RIDGE, 0.0f, NULL, NULL), NF_ERR_NULL);
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
        CHECK_STATUS(nf_omis_add(other, 0, pdf, value), NF_ERR_STATE);
        CHECK_REFUSED(nf_omis_solve(other, NF_OMIS_RIDGE, 0.0f, out, NULL), NF_ERR_STATE, out);
        CHECK_REFUSED(nf_omis_solve(other, NF_OMIS_RIDGE, 0.0f, NULL, out), NF_ERR_STATE, out);
        CHECK_STATUS(nf_omis_next_batch(other, NF_OMIS_RIDGE, 0.0f, 1.0f), NF_ERR_STATE);
    }
    CHECK(memcmp(before.start, m.start, m.bytes) == 0);
    memory_free(&m);
    memory_free(&m2);
    memory_free(&before);
}

static nf_status add(void *object)
{
    static const float ones[2] = {1.0f, 1.0f};
    return nf_omis_add((nf_omis *)object, 0, ones, ones);
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
