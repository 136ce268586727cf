/* Weights at a point: nf_mis_weight/optimal/optimal_contribution(). */
#include "check.h"

static float pdf[16], alpha[16];
static uint32_t counts[16];

static void values(void)
{
    static const float p[2] = {1.0f, 3.0f}, a[2] = {0.5f, -1.0f};
    static const uint32_t one[2] = {1, 1}, n[2] = {2, 1};
    static const struct {
        uint32_t heuristic;
        float parameter;
        const uint32_t *counts;
        uint32_t technique;
        float expected;
    } known[] = {{NF_MIS_BALANCE, 0.0f, n, 1, 0.6f},    {NF_MIS_POWER, 2.0f, one, 1, 0.9f},
                 {NF_MIS_POWER, 0.0f, one, 1, 0.9f},    {NF_MIS_POWER, 1.0f, one, 1, 0.75f},
                 {NF_MIS_CUTOFF, 0.5f, one, 0, 0.0f},   {NF_MIS_CUTOFF, 0.25f, one, 0, 0.25f},
                 {NF_MIS_MAXIMUM, 0.0f, one, 1, 1.0f}};
    float w;
    size_t i;
    for (i = 0; i < sizeof known / sizeof *known; ++i) {
        CHECK_STATUS(nf_mis_weight(known[i].heuristic, known[i].parameter, p, known[i].counts, 2, known[i].technique,
                                   &w), NF_OK);
        CHECK(w == known[i].expected);
    }
    CHECK_STATUS(nf_mis_optimal_contribution(p, n, 2, 0, a, 0.0f, &w), NF_OK);
    CHECK(w == 0.75f);
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
    errors();
    return report("mis");
}
