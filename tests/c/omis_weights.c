/* One weight per drawn item: nf_omis_weights(). */
#include "check.h"

static void normal_use(void)
{
    static const float pdf[4] = {0.5f, 0.25f, 0.125f, 0.5f};
    static const uint32_t technique[2] = {0, 1};
    float weight[2], again[2];
    CHECK_STATUS(nf_omis_weights(NF_OMIS_BALANCE, not_a_number(), 2, 10, pdf, technique, 2, weight), NF_OK);
    CHECK(fabsf(weight[0] - 0.2f / 0.75f) < 1e-6f && fabsf(weight[1] - 0.2f / 0.625f) < 1e-6f);
    /* Plain weights recover both techniques' probabilities. */
    CHECK_STATUS(nf_omis_weights(NF_OMIS_PLAIN, 0.0f, 2, 10, pdf, technique, 2, weight), NF_OK);
    CHECK(fabsf(weight[0] * pdf[0] + weight[1] * pdf[2] - 0.2f) < 1e-5f);
    CHECK(fabsf(weight[0] * pdf[1] + weight[1] * pdf[3] - 0.2f) < 1e-5f);
    CHECK_STATUS(nf_omis_weights(NF_OMIS_RIDGE, 0.0f, 2, 10, pdf, technique, 2, weight), NF_OK);
    CHECK_STATUS(nf_omis_weights(NF_OMIS_RIDGE, 2.0f, 2, 10, pdf, technique, 2, again), NF_OK);
    CHECK(memcmp(weight, again, sizeof weight) == 0);
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
    pdf[2] = 1.01f; /* more than rounding above 1 */
    CHECK_REFUSED(WEIGHTS(NF_OMIS_BALANCE, 0.0f, 2, 10, 2), NF_ERR_RANGE, weight);
    pdf[2] = 1.0005f;
    CHECK_STATUS(WEIGHTS(NF_OMIS_BALANCE, 0.0f, 2, 10, 2), NF_OK);
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
