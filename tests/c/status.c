/* Version, status messages, struct layouts, constants. */
#include "check.h"
#include <limits.h>

static void messages(void)
{
    static const nf_status known[] = {NF_OK,         NF_ERR_NULL,      NF_ERR_RANGE,      NF_ERR_NOT_FINITE,
                                      NF_ERR_MEMORY, NF_ERR_ALIGNMENT, NF_ERR_NO_SAMPLES, NF_ERR_UNSUPPORTED,
                                      NF_ERR_STATE,  NF_ERR_MISMATCH,  NF_ERR_FOREIGN,    NF_ERR_VERSION,
                                      NF_ERR_LENGTH, NF_ERR_CORRUPT};
    static const nf_status extremes[] = {INT32_MIN, INT32_MIN + 1, INT32_MAX, INT32_MAX - 1, 65536, -65536};
    const size_t count = sizeof known / sizeof *known;
    const char *unknown = nf_status_message(1);
    size_t i, k;
    int status;
    for (status = -2000; status <= 2000; ++status) {
        const char *text = nf_status_message((nf_status)status);
        CHECK(text != NULL);
        if (text)
            CHECK(strlen(text) > 0 && strlen(text) < 200);
    }
    for (i = 0; i < sizeof extremes / sizeof *extremes; ++i) {
        CHECK(nf_status_message(extremes[i]) != NULL);
        CHECK(strcmp(nf_status_message(extremes[i]), unknown) == 0);
    }
    for (i = 0; i < count; ++i) {
        CHECK(known[i] == -(nf_status)i);
        CHECK(strcmp(nf_status_message(known[i]), unknown) != 0);
        for (k = 0; k < i; ++k)
            CHECK(strcmp(nf_status_message(known[i]), nf_status_message(known[k])) != 0);
    }
}

static void layouts(void)
{
    CHECK(sizeof(nf_status) == 4);
    CHECK(sizeof(nf_cv_config) == 16 * 4);
    CHECK(offsetof(nf_cv_config, dims) == 0);
    CHECK(offsetof(nf_cv_config, order) == 4);
    CHECK(offsetof(nf_cv_config, channels) == 8);
    CHECK(offsetof(nf_cv_config, estimator) == 12);
    CHECK(offsetof(nf_cv_config, basis) == 16);
    CHECK(offsetof(nf_cv_config, stratified) == 20);
    CHECK(offsetof(nf_cv_config, slices) == 24);
    CHECK(offsetof(nf_cv_config, ridge) == 60);
    CHECK(sizeof(nf_cv_descent) == 16);
    CHECK(offsetof(nf_cv_samples, n) == 2 * sizeof(void *));
    CHECK(sizeof(nf_estimate) == 40);
    CHECK(offsetof(nf_estimate, mean) == 0);
    CHECK(offsetof(nf_estimate, std_error) == 16);
    CHECK(offsetof(nf_estimate, samples) == 32);
    CHECK(offsetof(nf_estimate, gain) == 36);
    CHECK(sizeof(nf_rng) == 16);
    CHECK(offsetof(nf_rng, state) == 0);
    CHECK(offsetof(nf_rng, increment) == 8);
    CHECK(sizeof(nf_tile) == 2 * sizeof(void *) + 24);
    CHECK(offsetof(nf_tile, size) == 2 * sizeof(void *));
    CHECK(sizeof(nf_tile_sampler) == sizeof(void *) + 16);
    CHECK(offsetof(nf_tile_sampler, domain) == sizeof(void *));
    CHECK(offsetof(nf_tile_sampler, x) == sizeof(void *) + 8);
}

/* Zero is the default of every choice, and signs survive in expressions. */
static void constants(void)
{
    CHECK(NF_CV_ROBUST == 0 && NF_CV_LEAST_SQUARES == 1 && NF_CV_LEAVE_ONE_OUT == 2);
    CHECK(NF_CV_K_FOLD == 3 && NF_CV_GRADIENT_DESCENT == 4 && NF_CV_INCREMENTAL == 5);
    CHECK(NF_BASIS_LEGENDRE == 0 && NF_SOLVER_AUTO == 0 && NF_PRECISION_F64 == 0 && NF_NONFINITE_ERROR == 0);
    CHECK(NF_COLOR_PER_CHANNEL == 0 && NF_OPTIMIZER_MOMENTUM == 0 && NF_OMIS_RIDGE == 0);
    CHECK(NF_MIS_MAX_TECHNIQUES == 16);
    CHECK(2 - NF_ERR_NULL == 3);
    CHECK(1.0f - NF_RIDGE_AUTO == 2.0f);
}

int main(void)
{
    CHECK(nf_abi_version() == NF_ABI_VERSION);
    messages();
    layouts();
    constants();
    return report("status");
}
