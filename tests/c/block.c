/* Pixels in no order that share a fit: nf_cv_image_estimate() with `unordered`. */
#include "check.h"

#define PIXELS 16
#define N 8
static float u[PIXELS * N * 2], f[PIXELS * N * 3];

static nf_cv_image block(uint32_t pixels)
{
    nf_cv_image image;
    memset(&image, 0, sizeof image);
    image.width = pixels;
    image.height = 1;
    image.unordered = 1;
    return image;
}

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
    const nf_cv_image image = block(PIXELS);
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
            work = memory_new(image_workspace_size(&config, &image, N));
            outputs = memory_new(PIXELS * sizeof(nf_estimate));
            out = (nf_estimate *)outputs.start;
            CHECK_STATUS(estimate_image(&config, &image, u, f, N, work.start, work.bytes, out), NF_OK);
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
    const nf_cv_image image = block(1);
    nf_estimate out, mean;
    fill_pixels(1);
    CHECK_STATUS(estimate_image(&config, &image, u, f, N, work.start, work.bytes, &out), NF_OK);
    CHECK_STATUS(estimate_one(&plain, u, f, N, work.start, work.bytes, &mean), NF_OK);
    CHECK(fabsf(out.mean[0] - mean.mean[0]) < 1e-6f);
    memory_free(&work);
}

static void unsupported(void)
{
    const nf_cv_image image = block(PIXELS);
    nf_cv_config config = make_config(2, 2, 1, NF_CV_ROBUST);
    memory work = memory_new(1 << 18);
    nf_estimate out[PIXELS];
    fill_pixels(3);
    config.nonfinite = NF_NONFINITE_SKIP;
    CHECK_REFUSED(estimate_image(&config, &image, u, f, N, work.start, work.bytes, out), NF_ERR_UNSUPPORTED, out);
    config = make_config(2, 2, 3, NF_CV_ROBUST);
    config.color = NF_COLOR_LUMINANCE_RATIO;
    CHECK_REFUSED(estimate_image(&config, &image, u, f, N, work.start, work.bytes, out), NF_ERR_UNSUPPORTED, out);
    config = make_config(2, 2, 1, NF_CV_ROBUST);
    config.controls = 1;
    CHECK_REFUSED(estimate_image(&config, &image, u, f, N, work.start, work.bytes, out), NF_ERR_UNSUPPORTED, out);
    memory_free(&work);
}

int main(void)
{
    fill_uniform(u, PIXELS * N * 2, 11);
    estimates();
    single_pixel_is_the_mean();
    unsupported();
    return report("block");
}
