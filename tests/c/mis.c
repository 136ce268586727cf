/* Weights at a point: nf_mis_weight/optimal/optimal_contribution(). */
#include "check.h"

/* Of each heuristic. */
static const float parameter[4] = {0.0f, 0.0f, 0.1f, 0.0f};

static float pdf[16], alpha[16];
static uint32_t counts[16];

static void values(void)
{
    static const float p[3] = {1.0f, 2.0f, 0.05f};
    static const uint32_t n[3] = {2, 1, 4};
    float w;
    /* n p = 2, 2, .2 */
    CHECK_STATUS(nf_mis_weight(NF_MIS_BALANCE, 0.0f, p, n, 3, 0, &w), NF_OK);
    CHECK(fabsf(w - 2.0f / 4.2f) < 1e-6f);
    CHECK_STATUS(nf_mis_weight(NF_MIS_POWER, 2.0f, p, n, 3, 2, &w), NF_OK);
    CHECK(fabsf(w - 0.04f / 8.04f) < 1e-6f);
    CHECK_STATUS(nf_mis_weight(NF_MIS_POWER, 0.0f, p, n, 3, 2, &w), NF_OK);
    CHECK(fabsf(w - 0.04f / 8.04f) < 1e-6f);
    CHECK_STATUS(nf_mis_weight(NF_MIS_POWER, 1.0f, p, n, 3, 2, &w), NF_OK);
    CHECK(fabsf(w - 0.2f / 4.2f) < 1e-6f);
    CHECK_STATUS(nf_mis_weight(NF_MIS_CUTOFF, 0.2f, p, n, 3, 2, &w), NF_OK);
    CHECK(w == 0.0f);
    CHECK_STATUS(nf_mis_weight(NF_MIS_CUTOFF, 0.2f, p, n, 3, 0, &w), NF_OK);
    CHECK(w == 0.5f);
    CHECK_STATUS(nf_mis_weight(NF_MIS_MAXIMUM, 0.0f, p, n, 3, 0, &w), NF_OK);
    CHECK(w == 1.0f);
    CHECK_STATUS(nf_mis_weight(NF_MIS_MAXIMUM, 0.0f, p, n, 3, 1, &w), NF_OK);
    CHECK(w == 0.0f);
}

static void sums(void)
{
    nf_rng rng;
    uint32_t round, techniques, j;
    uint32_t k;
    nf_rng_seed(&rng, 23);
    for (round = 0; round < 200; ++round) {
        techniques = 1 + round % 16;
        for (j = 0; j < techniques; ++j) {
            pdf[j] = 0.01f + nf_rng_uniform(&rng) * (round % 2 ? 1e30f : 1e-30f);
            counts[j] = 1 + (nf_rng_next(&rng) & 7);
            alpha[j] = nf_rng_uniform(&rng) - 0.5f;
        }
        for (k = 0; k < 4; ++k) {
            double total = 0.0;
            for (j = 0; j < techniques; ++j) {
                float w = -1.0f;
                CHECK_STATUS(nf_mis_weight(k, parameter[k], pdf, counts, techniques, j, &w), NF_OK);
                CHECK(w >= 0.0f && w <= 1.0f);
                total += w;
            }
            CHECK(fabs(total - 1.0) < 1e-5);
        }
        for (j = 0; j < techniques; ++j)
            pdf[j] = 0.5f + nf_rng_uniform(&rng);
        {
            const float value = 0.7f;
            double total = 0.0;
            for (j = 0; j < techniques; ++j) {
                float contribution;
                CHECK_STATUS(nf_mis_optimal_contribution(pdf, counts, techniques, j, alpha, value, &contribution),
                             NF_OK);
                /* w f / (n p), and the weights w sum to 1. */
                total += contribution * (double)((float)counts[j] * pdf[j]) / value;
            }
            CHECK(fabs(total - 1.0) < 1e-4);
        }
    }
}

static void edges(void)
{
    float w = -1.0f;
    uint32_t j, k;
    /* A point that nothing draws; a technique without samples; a delta distribution. */
    for (j = 0; j < 3; ++j) {
        pdf[j] = 0.0f;
        counts[j] = 1;
    }
    for (k = 0; k < 4; ++k) {
        CHECK_STATUS(nf_mis_weight(k, parameter[k], pdf, counts, 3, 1, &w), NF_OK);
        CHECK(w == 0.0f);
    }
    pdf[0] = pdf[1] = pdf[2] = 1.0f;
    counts[0] = 0;
    for (k = 0; k < 4; ++k) {
        CHECK_STATUS(nf_mis_weight(k, parameter[k], pdf, counts, 3, 0, &w), NF_OK);
        CHECK(w == 0.0f);
    }
    counts[0] = 1;
    pdf[2] = infinity_f();
    for (k = 0; k < 4; ++k) {
        CHECK_STATUS(nf_mis_weight(k, parameter[k], pdf, counts, 3, 2, &w), NF_OK);
        CHECK(w == 1.0f);
        CHECK_STATUS(nf_mis_weight(k, parameter[k], pdf, counts, 3, 0, &w), NF_OK);
        CHECK(w == 0.0f);
    }
}

/* The arguments that both heuristics and optimal weights have. */
#define SHARED_ERRORS(call)                                                                          \
    do {                                                                                             \
        const float *p = pdf;                                                                        \
        const uint32_t *n = counts;                                                                  \
        uint32_t techniques = 3, j = 1;                                                              \
        float w, *out = &w;                                                                          \
        CHECK_STATUS(call, NF_OK);                                                                   \
        p = NULL;                                                                                    \
        CHECK_REFUSED(call, NF_ERR_NULL, w);                                                         \
        p = (const float *)misaligned(pdf);                                                          \
        CHECK_REFUSED(call, NF_ERR_ALIGNMENT, w);                                                    \
        p = pdf;                                                                                     \
        n = NULL;                                                                                    \
        CHECK_REFUSED(call, NF_ERR_NULL, w);                                                         \
        n = (const uint32_t *)misaligned(counts);                                                    \
        CHECK_REFUSED(call, NF_ERR_ALIGNMENT, w);                                                    \
        n = counts;                                                                                  \
        out = NULL;                                                                                  \
        CHECK_STATUS(call, NF_ERR_NULL);                                                             \
        out = &w;                                                                                    \
        techniques = 0;                                                                              \
        CHECK_REFUSED(call, NF_ERR_RANGE, w);                                                        \
        techniques = 17;                                                                             \
        CHECK_REFUSED(call, NF_ERR_RANGE, w);                                                        \
        techniques = UINT32_MAX;                                                                     \
        CHECK_REFUSED(call, NF_ERR_RANGE, w);                                                        \
        techniques = 3;                                                                              \
        j = 3;                                                                                       \
        CHECK_REFUSED(call, NF_ERR_RANGE, w);                                                        \
        j = UINT32_MAX;                                                                              \
        CHECK_REFUSED(call, NF_ERR_RANGE, w);                                                        \
        j = 1;                                                                                       \
        pdf[2] = -1.0f;                                                                              \
        CHECK_REFUSED(call, NF_ERR_RANGE, w);                                                        \
        pdf[2] = not_a_number();                                                                     \
        CHECK_REFUSED(call, NF_ERR_NOT_FINITE, w);                                                   \
        pdf[2] = 1.0f;                                                                               \
    } while (0)

static void errors(void)
{
    const float nan = not_a_number(), infinite = infinity_f();
    float w;
    uint32_t j;
    for (j = 0; j < 16; ++j) {
        pdf[j] = 1.0f;
        counts[j] = 1;
        alpha[j] = 0.1f;
    }
    SHARED_ERRORS(nf_mis_weight(NF_MIS_BALANCE, 0.0f, p, n, techniques, j, out));
    SHARED_ERRORS(nf_mis_weight(NF_MIS_POWER, 2.0f, p, n, techniques, j, out));
    SHARED_ERRORS(nf_mis_weight(NF_MIS_CUTOFF, 0.5f, p, n, techniques, j, out));
    SHARED_ERRORS(nf_mis_weight(NF_MIS_MAXIMUM, 0.0f, p, n, techniques, j, out));
    SHARED_ERRORS(nf_mis_optimal_contribution(p, n, techniques, j, alpha, 1.0f, out));

    CHECK_REFUSED(nf_mis_weight(NF_MIS_MAXIMUM + 1, 0.0f, pdf, counts, 3, 0, &w), NF_ERR_RANGE, w);
    CHECK_REFUSED(nf_mis_weight(NF_MIS_POWER, -1.0f, pdf, counts, 3, 0, &w), NF_ERR_RANGE, w);
    CHECK_REFUSED(nf_mis_weight(NF_MIS_POWER, nan, pdf, counts, 3, 0, &w), NF_ERR_NOT_FINITE, w);
    CHECK_REFUSED(nf_mis_weight(NF_MIS_POWER, infinite, pdf, counts, 3, 0, &w), NF_ERR_NOT_FINITE, w);
    CHECK_REFUSED(nf_mis_weight(NF_MIS_CUTOFF, -0.1f, pdf, counts, 3, 0, &w), NF_ERR_RANGE, w);
    CHECK_REFUSED(nf_mis_weight(NF_MIS_CUTOFF, 1.1f, pdf, counts, 3, 0, &w), NF_ERR_RANGE, w);
    CHECK_REFUSED(nf_mis_weight(NF_MIS_CUTOFF, nan, pdf, counts, 3, 0, &w), NF_ERR_NOT_FINITE, w);
    CHECK_REFUSED(nf_mis_weight(NF_MIS_CUTOFF, infinite, pdf, counts, 3, 0, &w), NF_ERR_NOT_FINITE, w);

    CHECK_STATUS(nf_mis_optimal_contribution(pdf, counts, 3, 0, alpha, 0.0f, &w), NF_OK);
    CHECK_REFUSED(nf_mis_optimal_contribution(pdf, counts, 3, 0, NULL, 1.0f, &w), NF_ERR_NULL, w);
    CHECK_REFUSED(nf_mis_optimal_contribution(pdf, counts, 3, 0, alpha, infinite, &w), NF_ERR_NOT_FINITE, w);
    alpha[2] = nan;
    CHECK_REFUSED(nf_mis_optimal_contribution(pdf, counts, 3, 0, alpha, 1.0f, &w), NF_ERR_NOT_FINITE, w);
    alpha[2] = 0.1f;
    pdf[2] = infinite;
    CHECK_REFUSED(nf_mis_optimal_contribution(pdf, counts, 3, 0, alpha, 1.0f, &w), NF_ERR_NOT_FINITE, w);
    pdf[2] = 1.0f;
    counts[2] = 0;
    CHECK_REFUSED(nf_mis_optimal_contribution(pdf, counts, 3, 0, alpha, 1.0f, &w), NF_ERR_RANGE, w);
    counts[2] = 1;
    pdf[0] = 0.0f;
    CHECK_REFUSED(nf_mis_optimal_contribution(pdf, counts, 3, 0, alpha, 1.0f, &w), NF_ERR_RANGE, w);
}

int main(void)
{
    values();
    sums();
    edges();
    errors();
    return report("mis");
}
