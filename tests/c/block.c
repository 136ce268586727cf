/* A block of pixels that share a fit: nf_cv_block_estimate(). */
#include "check.h"

#define PIXELS 16
#define N 8
static float u[PIXELS * N * 2], f[PIXELS * N * 3];

/* Pixel p integrates (1 + x + y) (1 + p / 512). */
static void fill_pixels(size_t channels)
{
    size_t p, i, c;
    fill_linear(f, u, PIXELS * N, 2, channels);
    for (p = 0; p < PIXELS; ++p)
        for (i = 0; i < N; ++i)
            for (c = 0; c < channels; ++c)
                f[(p * N + i) * channels + c] *= 1.0f + (float)p / 512.0f;
}

static void estimates(void)
{
    uint32_t channels, precision, c;
    size_t p;
    for (precision = 0; precision < 2; ++precision)
        for (channels = 1; channels <= 3; ++channels) {
            nf_cv_config config = make_config(2, 2, channels, NF_CV_ROBUST);
            memory work, outputs;
            nf_estimate *out;
            double plain_error = 0.0, error = 0.0;
            config.precision = precision;
            fill_pixels(channels);
            work = memory_new(nf_cv_block_workspace_size(&config, PIXELS, N));
            outputs = memory_new(PIXELS * sizeof(nf_estimate));
            out = (nf_estimate *)outputs.start;
            CHECK_STATUS(nf_cv_block_estimate(&config, u, f, PIXELS, N, work.start, work.bytes, out), NF_OK);
            for (p = 0; p < PIXELS; ++p) {
                const float scale = 1.0f + (float)p / 512.0f;
                double mean = 0.0;
                size_t i;
                for (i = 0; i < N; ++i)
                    mean += f[(p * N + i) * channels] / (double)N;
                plain_error += (mean - 2.0 * scale) * (mean - 2.0 * scale);
                error += (out[p].mean[0] - 2.0 * scale) * (out[p].mean[0] - 2.0 * scale);
                CHECK(out[p].samples == N && isfinite(out[p].gain));
                for (c = 0; c < 4; ++c)
                    CHECK(c < channels ? out[p].std_error[c] > 0.0f
                                       : out[p].mean[c] == 0.0f && out[p].std_error[c] == 0.0f);
                if (channels > 1)
                    CHECK(fabsf(out[p].mean[1] - 2.0f * out[p].mean[0]) < 0.2f);
            }
            /* Pixels that are alike: the shared fit must be worth it. */
            CHECK(error < 0.5 * plain_error);
            memory_free(&work);
            memory_free(&outputs);
        }
}

static void single_pixel_is_the_mean(void)
{
    nf_cv_config config = make_config(2, 2, 1, NF_CV_ROBUST), plain = make_config(2, 0, 1, NF_CV_ROBUST);
    memory work = memory_new(1 << 16);
    nf_estimate out, mean;
    fill_pixels(1);
    CHECK_STATUS(nf_cv_block_estimate(&config, u, f, 1, N, work.start, work.bytes, &out), NF_OK);
    CHECK_STATUS(nf_cv_estimate(&plain, u, f, N, work.start, work.bytes, &mean), NF_OK);
    CHECK(fabsf(out.mean[0] - mean.mean[0]) < 1e-6f);
    memory_free(&work);
}

static void errors(void)
{
    static const size_t huge[] = {SIZE_MAX,      SIZE_MAX / 2,    SIZE_MAX / 2 + 1,
                                  SIZE_MAX / 16, SIZE_MAX / 4096, (SIZE_MAX >> 16) + 1};
    nf_cv_config config = make_config(2, 2, 1, NF_CV_ROBUST);
    const size_t bytes = nf_cv_block_workspace_size(&config, PIXELS, N);
    memory work = memory_new(bytes);
    nf_estimate out[PIXELS];
    float saved;
    size_t i;
    fill_pixels(1);
    CHECK_STATUS(nf_cv_block_estimate(&config, u, f, PIXELS, N, work.start, bytes, out), NF_OK);
    CHECK_REFUSED(nf_cv_block_estimate(NULL, u, f, PIXELS, N, work.start, bytes, out), NF_ERR_NULL, out);
    CHECK_REFUSED(nf_cv_block_estimate(&config, NULL, f, PIXELS, N, work.start, bytes, out), NF_ERR_NULL, out);
    CHECK_REFUSED(nf_cv_block_estimate(&config, u, NULL, PIXELS, N, work.start, bytes, out), NF_ERR_NULL, out);
    CHECK_REFUSED(nf_cv_block_estimate(&config, u, f, PIXELS, N, NULL, bytes, out), NF_ERR_NULL, out);
    CHECK_STATUS(nf_cv_block_estimate(&config, u, f, PIXELS, N, work.start, bytes, NULL), NF_ERR_NULL);
    CHECK_REFUSED(nf_cv_block_estimate(&config, u, f, 0, N, work.start, bytes, out), NF_ERR_NO_SAMPLES, out);
    CHECK_REFUSED(nf_cv_block_estimate(&config, u, f, PIXELS, 0, work.start, bytes, out), NF_ERR_NO_SAMPLES, out);
    CHECK_REFUSED(nf_cv_block_estimate(&config, u, f, PIXELS, N, work.start, bytes - 1, out), NF_ERR_MEMORY, out);
    CHECK_REFUSED(nf_cv_block_estimate(&config, u, f, PIXELS, N, misaligned(work.start), bytes - 1, out),
                  NF_ERR_ALIGNMENT, out);
    CHECK_REFUSED(nf_cv_block_estimate(&config, (const float *)misaligned(u), f, PIXELS, N, work.start, bytes, out),
                  NF_ERR_ALIGNMENT, out);
    CHECK_REFUSED(nf_cv_block_estimate(&config, u, f, PIXELS, N, work.start, bytes, (nf_estimate *)misaligned(out)),
                  NF_ERR_ALIGNMENT, out);
    for (i = 0; i < sizeof huge / sizeof *huge; ++i) {
        nf_status status;
        poison(out, sizeof out);
        status = nf_cv_block_estimate(&config, u, f, huge[i], N, work.start, bytes, out);
        CHECK(status == NF_ERR_RANGE || status == NF_ERR_MEMORY);
        status = nf_cv_block_estimate(&config, u, f, PIXELS, huge[i], work.start, bytes, out);
        CHECK(status == NF_ERR_RANGE || status == NF_ERR_MEMORY);
        status = nf_cv_block_estimate(&config, u, f, huge[i], huge[i], work.start, bytes, out);
        CHECK(status == NF_ERR_RANGE || status == NF_ERR_MEMORY);
        CHECK(is_poisoned(out, sizeof out));
        CHECK(nf_cv_block_workspace_size(&config, huge[i], huge[i]) == 0);
    }
    /* The last sample of the last pixel: nothing of the first pixels may have been written by then. */
    saved = f[PIXELS * N - 1];
    f[PIXELS * N - 1] = not_a_number();
    CHECK_NAN_REFUSED(nf_cv_block_estimate(&config, u, f, PIXELS, N, work.start, bytes, out), out);
    f[PIXELS * N - 1] = saved;
    saved = u[PIXELS * N * 2 - 1];
    u[PIXELS * N * 2 - 1] = 1.5f;
    CHECK_REFUSED(nf_cv_block_estimate(&config, u, f, PIXELS, N, work.start, bytes, out), NF_ERR_RANGE, out);
    u[PIXELS * N * 2 - 1] = saved;
    memory_free(&work);

    work = memory_new(1 << 18);
    config.nonfinite = NF_NONFINITE_SKIP;
    CHECK_REFUSED(nf_cv_block_estimate(&config, u, f, PIXELS, N, work.start, work.bytes, out), NF_ERR_UNSUPPORTED, out);
    config = make_config(2, 2, 3, NF_CV_ROBUST);
    config.color = NF_COLOR_LUMINANCE_RATIO;
    fill_pixels(3);
    CHECK_REFUSED(nf_cv_block_estimate(&config, u, f, PIXELS, N, work.start, work.bytes, out), NF_ERR_UNSUPPORTED, out);
    config = make_config(2, 2, 1, NF_CV_ROBUST);
    config.controls = 1;
    CHECK_REFUSED(nf_cv_block_estimate(&config, u, f, PIXELS, N, work.start, work.bytes, out), NF_ERR_UNSUPPORTED, out);
    CHECK(nf_cv_block_workspace_size(NULL, PIXELS, N) == 0);
    memory_free(&work);
}

int main(void)
{
    fill_uniform(u, PIXELS * N * 2, 11);
    estimates();
    single_pixel_is_the_mean();
    errors();
    return report("block");
}
