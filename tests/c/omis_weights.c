/* One weight per drawn item: nf_omis_weights(). */
#include "check.h"

#define ITEMS 20
#define BATCH 12

static const uint32_t solvers[3] = {NF_OMIS_RIDGE, NF_OMIS_PLAIN, NF_OMIS_BALANCE};

/* Technique 0 is uniform, technique 1 draws item i in proportion to i + 1. */
static double probability(uint32_t technique, uint32_t item)
{
    return technique == 0 ? 1.0 / ITEMS : 2.0 * (item + 1.0) / (ITEMS * (ITEMS + 1.0));
}

static void draw(nf_rng *rng, uint32_t *item, uint32_t *technique, float *pdf)
{
    uint32_t s;
    for (s = 0; s < BATCH; ++s) {
        technique[s] = s % 2;
        item[s] = (uint32_t)(nf_rng_uniform(rng) * ITEMS);
        if (s % 2 == 1) {
            /* max(a, b - 1) is k for 2 k + 2 of the pairs of a < ITEMS and b <= ITEMS. */
            const uint32_t other = (uint32_t)(nf_rng_uniform(rng) * (ITEMS + 1));
            item[s] = other > item[s] ? other - 1 : item[s];
        }
        pdf[2 * s] = (float)probability(0, item[s]);
        pdf[2 * s + 1] = (float)probability(1, item[s]);
    }
}

static void normal_use(void)
{
    nf_rng rng;
    uint32_t item[BATCH], technique[BATCH], s, k, round;
    float pdf[2 * BATCH], weight[BATCH], again[BATCH];
    double balance = 0.0;
    const int rounds = 4000;
    nf_rng_seed(&rng, 5);
    for (round = 0; round < (uint32_t)rounds; ++round) {
        double estimate = 0.0;
        draw(&rng, item, technique, pdf);
        /* Gradient i + 1 + 3: a combination of both techniques' probabilities, which plain weights recover. */
        CHECK_STATUS(nf_omis_weights(NF_OMIS_PLAIN, 0.0f, 2, ITEMS, pdf, technique, BATCH, weight), NF_OK);
        for (s = 0; s < BATCH; ++s)
            estimate += (double)weight[s] * (item[s] + 4.0) / BATCH;
        CHECK(fabs(estimate - (3.0 + (ITEMS + 1) / 2.0)) < 2e-3);
        CHECK_STATUS(nf_omis_weights(NF_OMIS_BALANCE, 0.0f, 2, ITEMS, pdf, technique, BATCH, weight), NF_OK);
        for (s = 0; s < BATCH; ++s) {
            const double sum = 6.0 * ((double)pdf[2 * s] + (double)pdf[2 * s + 1]);
            CHECK(fabs((double)weight[s] - BATCH / (ITEMS * sum)) < 1e-5);
            balance += (double)weight[s] * (item[s] + 4.0) / BATCH / rounds;
        }
    }
    /* Unbiased: one batch's standard deviation is below 1, so 4.4 standard errors are below .07. */
    CHECK(fabs(balance - (3.0 + (ITEMS + 1) / 2.0)) < 0.07);

    CHECK_STATUS(nf_omis_weights(NF_OMIS_RIDGE, 0.0f, 2, ITEMS, pdf, technique, BATCH, weight), NF_OK);
    CHECK_STATUS(nf_omis_weights(NF_OMIS_RIDGE, 2.0f, 2, ITEMS, pdf, technique, BATCH, again), NF_OK);
    CHECK(memcmp(weight, again, sizeof weight) == 0);
    CHECK_STATUS(nf_omis_weights(NF_OMIS_RIDGE, 1e8f, 2, ITEMS, pdf, technique, BATCH, weight), NF_OK);
    CHECK_STATUS(nf_omis_weights(NF_OMIS_BALANCE, not_a_number(), 2, ITEMS, pdf, technique, BATCH, again), NF_OK);
    for (s = 0; s < BATCH; ++s)
        CHECK(fabsf(weight[s] - again[s]) < 1e-5f);

    /* Uniform sampling: weight 1. Also with 16 identical techniques of one sample or none each. */
    for (k = 0; k < 3; ++k) {
        float equal[16 * BATCH];
        for (s = 0; s < 16 * BATCH; ++s)
            equal[s] = 1.0f / ITEMS;
        for (s = 0; s < BATCH; ++s)
            technique[s] = s;
        CHECK_STATUS(nf_omis_weights(solvers[k], 0.0f, 16, ITEMS, equal, technique, BATCH, weight), NF_OK);
        for (s = 0; s < BATCH; ++s)
            CHECK(fabsf(weight[s] - 1.0f) < 1e-5f);
    }
}

static void errors(void)
{
    float pdf[4] = {0.5f, 0.25f, 0.125f, 0.5f}, weight[2];
    uint32_t technique[2] = {0, 1}, k;
    const float bad[3] = {not_a_number(), infinity_f(), -0.5f};
#define WEIGHTS(solver, ridge, techniques, items, batch) \
    nf_omis_weights(solver, ridge, techniques, items, pdf, technique, batch, weight)
    CHECK_STATUS(WEIGHTS(NF_OMIS_RIDGE, 0.0f, 2, 10, 2), NF_OK);
    CHECK_REFUSED(nf_omis_weights(NF_OMIS_RIDGE, 0.0f, 2, 10, NULL, technique, 2, weight), NF_ERR_NULL, weight);
    CHECK_REFUSED(nf_omis_weights(NF_OMIS_RIDGE, 0.0f, 2, 10, pdf, NULL, 2, weight), NF_ERR_NULL, weight);
    CHECK_STATUS(nf_omis_weights(NF_OMIS_RIDGE, 0.0f, 2, 10, pdf, technique, 2, NULL), NF_ERR_NULL);
    CHECK_REFUSED(nf_omis_weights(NF_OMIS_RIDGE, 0.0f, 1, 10, (const float *)misaligned(pdf), technique, 2, weight),
                  NF_ERR_ALIGNMENT, weight);
    CHECK_REFUSED(nf_omis_weights(NF_OMIS_RIDGE, 0.0f, 2, 10, pdf, (const uint32_t *)misaligned(technique), 1, weight),
                  NF_ERR_ALIGNMENT, weight);
    CHECK_REFUSED(nf_omis_weights(NF_OMIS_RIDGE, 0.0f, 2, 10, pdf, technique, 1, (float *)misaligned(weight)),
                  NF_ERR_ALIGNMENT, weight);
    CHECK_REFUSED(WEIGHTS(4, 0.0f, 2, 10, 2), NF_ERR_RANGE, weight);
    CHECK_REFUSED(WEIGHTS(NF_OMIS_PROGRESSIVE, 0.0f, 2, 10, 2), NF_ERR_UNSUPPORTED, weight);
    CHECK_REFUSED(WEIGHTS(NF_OMIS_RIDGE, 1e-9f, 2, 10, 2), NF_ERR_RANGE, weight);
    CHECK_REFUSED(WEIGHTS(NF_OMIS_RIDGE, not_a_number(), 2, 10, 2), NF_ERR_NOT_FINITE, weight);
    CHECK_REFUSED(WEIGHTS(NF_OMIS_RIDGE, 0.0f, 0, 10, 2), NF_ERR_RANGE, weight);
    CHECK_REFUSED(WEIGHTS(NF_OMIS_RIDGE, 0.0f, 17, 10, 2), NF_ERR_RANGE, weight);
    CHECK_REFUSED(WEIGHTS(NF_OMIS_RIDGE, 0.0f, UINT32_MAX, 10, UINT32_MAX), NF_ERR_RANGE, weight);
    CHECK_REFUSED(WEIGHTS(NF_OMIS_RIDGE, 0.0f, 2, 0, 2), NF_ERR_RANGE, weight);
    CHECK_REFUSED(WEIGHTS(NF_OMIS_RIDGE, 0.0f, 2, 10, 0), NF_ERR_NO_SAMPLES, weight);
    technique[1] = 2;
    CHECK_REFUSED(WEIGHTS(NF_OMIS_RIDGE, 0.0f, 2, 10, 2), NF_ERR_RANGE, weight);
    technique[1] = 1;
    for (k = 0; k < 3; ++k) {
        pdf[2] = bad[k];
        CHECK_REFUSED(WEIGHTS(NF_OMIS_BALANCE, 0.0f, 2, 10, 2), k < 2 ? NF_ERR_NOT_FINITE : NF_ERR_RANGE, weight);
    }
    pdf[2] = 0.0f;
    CHECK_STATUS(WEIGHTS(NF_OMIS_RIDGE, 0.0f, 2, 10, 2), NF_OK);
    pdf[3] = 0.0f;
    CHECK_REFUSED(WEIGHTS(NF_OMIS_RIDGE, 0.0f, 2, 10, 2), NF_ERR_RANGE, weight);
}

int main(void)
{
    normal_use();
    errors();
    return report("omis_weights");
}
