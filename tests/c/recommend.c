/* What to use for how many samples: nf_recommend(). */
#include "check.h"

static void fields(void)
{
    static const uint32_t dims[] = {2, 64, UINT32_MAX};
    uint32_t sampling;
    size_t j;
    for (j = 0; j < sizeof dims / sizeof *dims; ++j)
        for (sampling = 0; sampling < 2; ++sampling) {
            nf_recommendation out;
            CHECK_STATUS(nf_recommend(dims[j], UINT32_MAX, sampling, 1, INFINITY, &out), NF_OK);
            CHECK(out.method <= NF_METHOD_SHARED && nf_cv_terms(&out.config) > 0);
            CHECK_NAMED(NF_CHECK_CV_CONFIG, &out.config, NULL);
            CHECK(out.config.dims <= dims[j] && out.config.channels == 1);
            CHECK(out.config.stride == dims[j] && out.config.stratified == sampling);
            CHECK(out.tile_samples >= 1 && (out.tile_dims == 2 || out.tile_dims == 4));
            CHECK(out.image_stride == 4 || out.image_stride == 8);
            CHECK(out.error > 0.0f && out.error < 1.1f && out.filtered_error > 0.0f);
        }
}

/* 4 x 4 pixels of 4 samples each, of f = 1 + x + y. */
static void shared_estimates_follow(void)
{
    static float u[16 * 4 * 2], f[16 * 4];
    nf_recommendation out;
    nf_cv_image image;
    nf_estimate estimates[16];
    memory work;
    double plain_error = 0.0, error = 0.0;
    size_t p, i;
    fill_uniform(u, 16 * 4 * 2, 3);
    fill_linear(f, u, 16 * 4, 2, 1);
    memset(&image, 0, sizeof image);
    image.width = image.height = 4;
    image.window = 4;
    image.stride = 4;
    CHECK_STATUS(nf_recommend(2, 4, NF_SAMPLING_INDEPENDENT, 1, INFINITY, &out), NF_OK);
    CHECK(out.method == NF_METHOD_SHARED);
    work = memory_new(image_workspace_size(&out.config, &image, 4));
    CHECK_STATUS(estimate_image(&out.config, &image, u, f, 4, work.start, work.bytes, estimates), NF_OK);
    for (p = 0; p < 16; ++p) {
        double mean = 0.0;
        for (i = 0; i < 4; ++i)
            mean += f[p * 4 + i] / 4.0;
        plain_error += (mean - 2.0) * (mean - 2.0);
        error += (estimates[p].mean[0] - 2.0) * (estimates[p].mean[0] - 2.0);
    }
    CHECK(error < 0.5 * plain_error);
    memory_free(&work);
}

/* Cheap samples are better spent on more of them. */
static void cost_of_samples(void)
{
    nf_recommendation out;
    float from;
    CHECK_STATUS(nf_recommend(2, 1, NF_SAMPLING_STRATIFIED, 1, 1e6f, &out), NF_OK);
    from = out.pays_from;
    CHECK(out.method == NF_METHOD_SHARED && out.cost > 0.0f && from > 0.0f);
    CHECK_STATUS(nf_recommend(2, 1, NF_SAMPLING_STRATIFIED, 1, 0.9f * from, &out), NF_OK);
    CHECK(out.method == NF_METHOD_PLAIN_MEAN && out.cost == 0.0f && out.pays_from == from);
    CHECK_STATUS(nf_recommend(2, 4, NF_SAMPLING_STRATIFIED, 0, 1e6f, &out), NF_OK);
    CHECK(out.method == NF_METHOD_PLAIN_MEAN && out.pays_from == INFINITY);
    /* No fit pays: not even if samples cost no end of time. */
    CHECK_STATUS(nf_recommend(2, 64, NF_SAMPLING_STRATIFIED, 1, INFINITY, &out), NF_OK);
    CHECK(out.method == NF_METHOD_PLAIN_MEAN && out.pays_from == INFINITY);
}

static void errors(void)
{
    nf_recommendation out;
    CHECK_REFUSED(nf_recommend(0, 4, NF_SAMPLING_INDEPENDENT, 1, INFINITY, &out), NF_ERR_RANGE, out);
    CHECK_REFUSED(nf_recommend(2, 0, NF_SAMPLING_INDEPENDENT, 1, INFINITY, &out), NF_ERR_RANGE, out);
    CHECK_REFUSED(nf_recommend(2, 4, 2, 1, INFINITY, &out), NF_ERR_RANGE, out);
    CHECK_REFUSED(nf_recommend(2, 4, UINT32_MAX, 1, INFINITY, &out), NF_ERR_RANGE, out);
    CHECK_REFUSED(nf_recommend(2, 4, NF_SAMPLING_STRATIFIED, 2, INFINITY, &out), NF_ERR_RANGE, out);
    CHECK_REFUSED(nf_recommend(2, 4, NF_SAMPLING_STRATIFIED, 1, 0.0f, &out), NF_ERR_RANGE, out);
    CHECK_REFUSED(nf_recommend(2, 4, NF_SAMPLING_STRATIFIED, 1, -1.0f, &out), NF_ERR_RANGE, out);
    CHECK_REFUSED(nf_recommend(2, 4, NF_SAMPLING_STRATIFIED, 1, not_a_number(), &out), NF_ERR_NOT_FINITE, out);
    CHECK_STATUS(nf_recommend(2, 4, NF_SAMPLING_STRATIFIED, 1, INFINITY, NULL), NF_ERR_NULL);
    CHECK_REFUSED(nf_recommend(2, 4, NF_SAMPLING_STRATIFIED, 1, INFINITY, (nf_recommendation *)misaligned(&out)),
                  NF_ERR_ALIGNMENT, out);
}

int main(void)
{
    fields();
    shared_estimates_follow();
    cost_of_samples();
    errors();
    return report("recommend");
}
