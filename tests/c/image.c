/* The pixels of an image, which share fits within windows: nf_cv_image_estimate(). */
#include "check.h"

#define WIDTH 11
#define HEIGHT 7
#define PIXELS (WIDTH * HEIGHT)
#define N 4
static float u[PIXELS * N * 2], f[PIXELS * N * 3];

static nf_cv_image make_image(uint32_t width, uint32_t height)
{
    nf_cv_image image;
    memset(&image, 0, sizeof image);
    image.width = width;
    image.height = height;
    return image;
}

/* Pixel (x, y) integrates (1 + u0 + u1) (1 + x / 16): fits must follow it across the image. */
static float brightness(size_t pixel) { return 1.0f + (float)(pixel % WIDTH) / 16.0f; }

static void fill_pixels(size_t channels)
{
    size_t p, i;
    fill_linear(f, u, PIXELS * N, 2, channels);
    for (p = 0; p < PIXELS; ++p)
        for (i = 0; i < N * channels; ++i)
            f[p * N * channels + i] *= brightness(p);
}

static void estimate(const nf_cv_config *config, const nf_cv_image *image, size_t n, nf_estimate *out)
{
    memory work = memory_new(image_workspace_size(config, image, n));
    CHECK(work.bytes > 0);
    CHECK_STATUS(estimate_image(config, image, u, f, n, work.start, work.bytes, out), NF_OK);
    memory_free(&work);
}

/* What is 0 stands for a default, bit for bit; what is given changes the estimates. */
static void defaults(void)
{
    static uint32_t surfaces[PIXELS];
    static float factors[PIXELS * 2];
    nf_cv_config config = make_config(2, 2, 2, NF_CV_ROBUST);
    nf_cv_image image = make_image(WIDTH, HEIGHT);
    nf_estimate expected[PIXELS], out[PIXELS];
    size_t i;
    fill_pixels(2);
    estimate(&config, &image, N, expected);
    image.frames = 1;
    image.window = 8;
    image.stride = 4;
    image.samples = N;
    config.ridge = NF_RIDGE_AUTO;
    estimate(&config, &image, N, out);
    CHECK(memcmp(out, expected, sizeof out) == 0);
    config.ridge = 0.0f;
    for (i = 0; i < PIXELS; ++i)
        CHECK(out[i].samples == N && out[i].mean[2] == 0.0f && out[i].std_error[3] == 0.0f);

    image.stride = 2;
    estimate(&config, &image, N, out);
    CHECK(memcmp(out, expected, sizeof out) != 0);
    image.stride = 4;
    surfaces[0] = surfaces[1] = surfaces[2] = 1;
    image.surfaces = surfaces;
    estimate(&config, &image, N, out);
    CHECK(memcmp(out, expected, sizeof out) != 0);
    image.surfaces = NULL;
    for (i = 0; i < PIXELS * 2; ++i)
        factors[i] = brightness(i / 2);
    image.factors = factors;
    estimate(&config, &image, N, out);
    CHECK(memcmp(out, expected, sizeof out) != 0);
}

/* Pixels without places: those of an image or of a row have the same bits. */
static void unordered(void)
{
    nf_cv_config config = make_config(2, 3, 1, NF_CV_ROBUST);
    nf_cv_image image = make_image(WIDTH, HEIGHT);
    nf_estimate out[PIXELS], expected[PIXELS];
    nf_cv_image row = make_image(PIXELS, 1);
    static uint32_t surfaces[PIXELS];
    memory work;
    size_t i;
    fill_pixels(1);
    for (i = 0; i < PIXELS; ++i)
        surfaces[i] = i % 2;
    image.unordered = row.unordered = 1;
    work = memory_new(image_workspace_size(&config, &row, N));
    CHECK(image_workspace_size(&config, &image, N) == work.bytes);
    estimate(&config, &image, N, out);
    estimate(&config, &row, N, expected);
    CHECK(memcmp(out, expected, sizeof out) == 0);
    image.surfaces = surfaces;
    estimate(&config, &image, N, out);
    CHECK(memcmp(out, expected, sizeof out) != 0);
    image.unordered = 2;
    CHECK(image_workspace_size(&config, &image, N) == 0);
    CHECK_REFUSED(estimate_image(&config, &image, u, f, N, work.start, work.bytes, out), NF_ERR_RANGE, out);
    memory_free(&work);
}

/* Edges take a workspace of their own, from 4 samples, and change the estimates where some are dark. */
static void edges(void)
{
    nf_cv_config config = make_config(2, 2, 1, NF_CV_ROBUST), with = config;
    const nf_cv_image image = make_image(WIDTH, HEIGHT);
    nf_estimate out[PIXELS], expected[PIXELS];
    size_t i;
    with.edges = 1;
    fill_pixels(1);
    for (i = 0; i < PIXELS * N; ++i)
        f[i] = u[2 * i] < .6f ? f[i] : 0;
    CHECK(image_workspace_size(&with, &image, N) > image_workspace_size(&config, &image, N));
    estimate(&config, &image, N, expected);
    estimate(&with, &image, N, out);
    CHECK(memcmp(out, expected, sizeof out) != 0);
    with.edges = 2;
    CHECK(image_workspace_size(&with, &image, N) == 0);
}

#define REFUSED(expected)                                                                                              \
    CHECK_REFUSED(estimate_image(&config, &image, u, f, N, work.start, work.bytes, out), expected, out)

/* Parts: what is refused, and the bits of the whole. */
static void parts(void)
{
    nf_cv_config config = make_config(2, 2, 1, NF_CV_ROBUST);
    nf_cv_image image = make_image(WIDTH, HEIGHT);
    nf_cv_rectangle needed = {9, 9, 9, 9};
    nf_estimate out[PIXELS], whole[PIXELS];
    memory work;
    uint32_t x, y;
    fill_pixels(1);
    image.window = 4;
    estimate(&config, &image, N, whole);
    image.wanted.x = WIDTH - 1;
    image.wanted.y = 1;
    image.wanted.width = 1;
    image.wanted.height = 2;
    work = memory_new(image_workspace_size(&config, &image, N));
    CHECK(work.bytes > 0);
    CHECK_STATUS(estimate_image(&config, &image, u, f, N, work.start, work.bytes, out), NF_OK);
    for (y = 0; y < 2; ++y)
        CHECK(memcmp(&out[y], &whole[(1 + y) * WIDTH + WIDTH - 1], sizeof out[y]) == 0);
    CHECK_STATUS(nf_cv_image_needed(&image, &needed), NF_OK);
    CHECK(needed.x + needed.width == WIDTH && needed.x == WIDTH - 4 && needed.y == 0);
    image.given = needed;
    CHECK(image_workspace_size(&config, &image, N) > 0);
    ++image.given.x;
    --image.given.width;
    CHECK(image_workspace_size(&config, &image, N) == 0);
    CHECK_REFUSED(estimate_image(&config, &image, u, f, N, work.start, work.bytes, out), NF_ERR_RANGE, out);
    memset(&image.given, 0, sizeof image.given);
    for (x = 0; x < 4; ++x) {
        const uint32_t beyond[4][4] = {{WIDTH, 0, 1, 1}, {0, 0, 1, 0}, {0, 0, 0xffffffffu, 1}, {0xffffffffu, 1, 2, 1}};
        memcpy(&image.wanted, beyond[x], sizeof image.wanted);
        CHECK_REFUSED(estimate_image(&config, &image, u, f, N, work.start, work.bytes, out), NF_ERR_RANGE, out);
        CHECK_STATUS(nf_cv_image_needed(&image, &needed), NF_ERR_RANGE);
    }
    CHECK_STATUS(nf_cv_image_needed(NULL, &needed), NF_ERR_NULL);
    CHECK_STATUS(nf_cv_image_needed(&image, NULL), NF_ERR_NULL);
    CHECK_STATUS(nf_cv_image_needed((const nf_cv_image *)misaligned(&image), &needed), NF_ERR_ALIGNMENT);
    memory_free(&work);
}

/* What is known of the samples: refused, and where a constant share of it arrives, exact. */
static void known(void)
{
    static float values[PIXELS * N], integrals[PIXELS];
    nf_cv_config config = make_config(2, 2, 1, NF_CV_ROBUST);
    nf_cv_image image = make_image(WIDTH, HEIGHT);
    nf_cv_samples samples = samples_of(u, f, N);
    memory work;
    size_t bytes, i;
    nf_estimate out[PIXELS];
    fill_pixels(1);
    for (i = 0; i < PIXELS * N; ++i)
        values[i] = 2.0f * f[i];
    for (i = 0; i < PIXELS; ++i)
        integrals[i] = 1.0f + (float)i;
    bytes = image_workspace_size(&config, &image, N);
    samples.known = values;
    samples.known_integrals = integrals;
    CHECK(nf_cv_image_workspace_size(&config, &image, &samples) > bytes);
    bytes = nf_cv_image_workspace_size(&config, &image, &samples);
    work = memory_new(bytes);
    CHECK_STATUS(nf_cv_image_estimate(&config, &image, &samples, work.start, bytes, out), NF_OK);
    CHECK_REFUSED(nf_cv_image_estimate(&config, &image, &samples, work.start, bytes - 1, out), NF_ERR_MEMORY, out);
    samples.known_integrals = NULL;
    CHECK_REFUSED(nf_cv_image_estimate(&config, &image, &samples, work.start, bytes, out), NF_ERR_RANGE, out);
    samples.known_integrals = (const float *)misaligned(integrals);
    CHECK_REFUSED(nf_cv_image_estimate(&config, &image, &samples, work.start, bytes, out), NF_ERR_ALIGNMENT, out);
    samples.known_integrals = integrals;
    samples.known = (const float *)misaligned(values);
    CHECK_REFUSED(nf_cv_image_estimate(&config, &image, &samples, work.start, bytes, out), NF_ERR_ALIGNMENT, out);
    samples.known = NULL;
    CHECK_REFUSED(nf_cv_image_estimate(&config, &image, &samples, work.start, bytes, out), NF_ERR_RANGE, out);
    samples.known = values;
    values[PIXELS * N - 1] = not_a_number();
    CHECK_REFUSED(nf_cv_image_estimate(&config, &image, &samples, work.start, bytes, out), NF_ERR_NOT_FINITE, out);
    values[PIXELS * N - 1] = 2.0f * f[PIXELS * N - 1];
    integrals[PIXELS - 1] = -1.0f;
    CHECK_REFUSED(nf_cv_image_estimate(&config, &image, &samples, work.start, bytes, out), NF_ERR_RANGE, out);
    integrals[PIXELS - 1] = infinity_f();
    CHECK_REFUSED(nf_cv_image_estimate(&config, &image, &samples, work.start, bytes, out), NF_ERR_NOT_FINITE, out);
    integrals[PIXELS - 1] = (float)PIXELS;
    config.estimator = NF_CV_K_FOLD;
    CHECK_REFUSED(nf_cv_image_estimate(&config, &image, &samples, work.start, bytes, out), NF_ERR_UNSUPPORTED, out);
    CHECK(nf_cv_image_workspace_size(&config, &image, &samples) == 0);
    config.estimator = NF_CV_LEAVE_ONE_OUT;
    CHECK_STATUS(nf_cv_image_estimate(&config, &image, &samples, work.start, bytes, out), NF_OK);
    for (i = 0; i < PIXELS; ++i)
        CHECK(fabsf(out[i].mean[0] - 0.5f * integrals[i]) < 1e-5f * integrals[i]);
    memory_free(&work);
}

static void errors(void)
{
    static uint32_t surfaces[PIXELS + 1];
    static float factors[PIXELS + 1];
    static const uint32_t sizes[] = {0x10000u, 0x7fffffffu, 0x80000000u, 0xffffffffu};
    static const size_t many[] = {0xffffffffu / PIXELS + 1, 0x80000000u, 0xffffffffu};
    nf_cv_config config = make_config(2, 2, 1, NF_CV_ROBUST);
    nf_cv_image image = make_image(WIDTH, HEIGHT);
    const size_t bytes = image_workspace_size(&config, &image, N);
    memory work = memory_new(bytes);
    nf_estimate out[PIXELS];
    float saved;
    size_t i, j;
    fill_pixels(1);
    CHECK_STATUS(estimate_image(&config, &image, u, f, N, work.start, bytes, out), NF_OK);
    CHECK_REFUSED(estimate_image(NULL, &image, u, f, N, work.start, bytes, out), NF_ERR_NULL, out);
    CHECK_REFUSED(estimate_image(&config, NULL, u, f, N, work.start, bytes, out), NF_ERR_NULL, out);
    CHECK_REFUSED(estimate_image(&config, &image, NULL, f, N, work.start, bytes, out), NF_ERR_NULL, out);
    CHECK_REFUSED(estimate_image(&config, &image, u, NULL, N, work.start, bytes, out), NF_ERR_NULL, out);
    CHECK_REFUSED(estimate_image(&config, &image, u, f, N, NULL, bytes, out), NF_ERR_NULL, out);
    CHECK_STATUS(estimate_image(&config, &image, u, f, N, work.start, bytes, NULL), NF_ERR_NULL);
    CHECK_REFUSED(estimate_image(&config, &image, u, f, 0, work.start, bytes, out), NF_ERR_NO_SAMPLES, out);
    CHECK_REFUSED(estimate_image(&config, &image, u, f, N, work.start, bytes - 1, out), NF_ERR_MEMORY, out);
    CHECK_REFUSED(estimate_image(&config, &image, u, f, N, work.start, 0, out), NF_ERR_MEMORY, out);

    /* Alignment, of everything that is pointed to. */
    CHECK_REFUSED(
        estimate_image(&config, (const nf_cv_image *)misaligned(&image), u, f, N, work.start, bytes, out),
        NF_ERR_ALIGNMENT, out);
    CHECK_REFUSED(
        estimate_image((const nf_cv_config *)misaligned(&config), &image, u, f, N, work.start, bytes, out),
        NF_ERR_ALIGNMENT, out);
    CHECK_REFUSED(estimate_image(&config, &image, (const float *)misaligned(u), f, N, work.start, bytes, out),
                  NF_ERR_ALIGNMENT, out);
    CHECK_REFUSED(estimate_image(&config, &image, u, (const float *)misaligned(f), N, work.start, bytes, out),
                  NF_ERR_ALIGNMENT, out);
    CHECK_REFUSED(estimate_image(&config, &image, u, f, N, misaligned(work.start), bytes - 1, out),
                  NF_ERR_ALIGNMENT, out);
    CHECK_REFUSED(estimate_image(&config, &image, u, f, N, work.start, bytes, (nf_estimate *)misaligned(out)),
                  NF_ERR_ALIGNMENT, out);
    image.surfaces = (const uint32_t *)misaligned(surfaces);
    REFUSED(NF_ERR_ALIGNMENT);
    image.surfaces = NULL;
    image.factors = (const float *)misaligned(factors);
    REFUSED(NF_ERR_ALIGNMENT);

    /* Factors: the last pixel's, so that nothing of the first may have been written by then. */
    for (i = 0; i < PIXELS; ++i)
        factors[i] = 1.0f;
    image.factors = factors;
    factors[PIXELS - 1] = -1.0f;
    REFUSED(NF_ERR_RANGE);
    factors[PIXELS - 1] = not_a_number();
    REFUSED(NF_ERR_NOT_FINITE);
    factors[PIXELS - 1] = infinity_f();
    REFUSED(NF_ERR_NOT_FINITE);
    factors[PIXELS - 1] = -infinity_f();
    REFUSED(NF_ERR_NOT_FINITE);
    factors[PIXELS - 1] = -0.0f;
    CHECK_STATUS(estimate_image(&config, &image, u, f, N, work.start, bytes, out), NF_OK);
    image.factors = NULL;
    known();

    /* Sizes, windows, strides. */
    image = make_image(0, HEIGHT);
    REFUSED(NF_ERR_RANGE);
    CHECK(image_workspace_size(&config, &image, N) == 0);
    image = make_image(WIDTH, 0);
    REFUSED(NF_ERR_RANGE);
    CHECK(image_workspace_size(&config, &image, N) == 0);
    image = make_image(WIDTH, HEIGHT);
    image.window = 4;
    image.stride = 5;
    REFUSED(NF_ERR_RANGE);
    CHECK(image_workspace_size(&config, &image, N) == 0);
    image.window = 0;
    image.stride = 9;
    REFUSED(NF_ERR_RANGE);
    image = make_image(33, 32);
    image.window = 33;
    CHECK(image_workspace_size(&config, &image, 1) == 0);
    image.window = 32;
    CHECK(image_workspace_size(&config, &image, 1) > 0);
    image = make_image(8, 8);
    image.frames = 16;
    CHECK(image_workspace_size(&config, &image, 1) > 0);
    image.frames = 17;
    CHECK(image_workspace_size(&config, &image, 1) == 0);
    /* A window may be larger than the image, if the image is small enough. */
    image = make_image(WIDTH, HEIGHT);
    image.window = image.stride = 0xffffffffu;
    CHECK(image_workspace_size(&config, &image, N) > 0);
    for (i = 0; i < sizeof sizes / sizeof *sizes; ++i)
        for (j = 0; j < sizeof sizes / sizeof *sizes; ++j) {
            nf_status status;
            image = make_image(sizes[i], sizes[j]);
            poison(out, sizeof out);
            status = estimate_image(&config, &image, u, f, N, work.start, bytes, out);
            CHECK(status == NF_ERR_RANGE || status == NF_ERR_MEMORY);
            image = make_image(WIDTH, HEIGHT);
            image.frames = sizes[i];
            status = estimate_image(&config, &image, u, f, N, work.start, bytes, out);
            CHECK(status == NF_ERR_RANGE || status == NF_ERR_MEMORY);
            image.frames = 0;
            status = estimate_image(&config, &image, u, f, SIZE_MAX / (i + 1), work.start, bytes, out);
            CHECK(status == NF_ERR_RANGE);
            CHECK(is_poisoned(out, sizeof out));
            CHECK(image_workspace_size(&config, &image, SIZE_MAX / (i + 1)) == 0);
        }
    image = make_image(WIDTH, HEIGHT);
    /* Too many samples, one by one and in all, are no lack of memory. */
    for (i = 0; i < sizeof many / sizeof *many; ++i) {
        CHECK(image_workspace_size(&config, &image, many[i]) == 0);
        CHECK_REFUSED(estimate_image(&config, &image, u, f, many[i], work.start, bytes, out), NF_ERR_RANGE, out);
    }

    /* Samples: the last of the last pixel. */
    saved = f[PIXELS * N - 1];
    f[PIXELS * N - 1] = not_a_number();
    CHECK_NAN_REFUSED(estimate_image(&config, &image, u, f, N, work.start, work.bytes, out), out);
    f[PIXELS * N - 1] = saved;
    saved = u[PIXELS * N * 2 - 1];
    u[PIXELS * N * 2 - 1] = 1.5f;
    REFUSED(NF_ERR_RANGE);
    u[PIXELS * N * 2 - 1] = saved;
    memory_free(&work);

    /* Configurations. */
    work = memory_new(1 << 20);
    config.estimator = NF_CV_LEAST_SQUARES;
    REFUSED(NF_ERR_UNSUPPORTED);
    CHECK(image_workspace_size(&config, &image, N) == 0);
    config.estimator = NF_CV_GRADIENT_DESCENT;
    REFUSED(NF_ERR_UNSUPPORTED);
    config.estimator = NF_CV_INCREMENTAL;
    REFUSED(NF_ERR_UNSUPPORTED);
    config.estimator = 99;
    REFUSED(NF_ERR_RANGE);
    config = make_config(2, 2, 1, NF_CV_ROBUST);
    config.solver = NF_SOLVER_DUAL;
    REFUSED(NF_ERR_UNSUPPORTED);
    fill_pixels(3);
    for (i = 0; i < 2; ++i) {
        image.unordered = (uint32_t)i;
        config = make_config(2, 2, 1, NF_CV_ROBUST);
        config.controls = 1;
        REFUSED(NF_ERR_UNSUPPORTED);
        CHECK(image_workspace_size(&config, &image, N) == 0);
        config = make_config(2, 2, 1, NF_CV_ROBUST);
        config.nonfinite = NF_NONFINITE_SKIP;
        REFUSED(NF_ERR_UNSUPPORTED);
        config = make_config(2, 2, 3, NF_CV_ROBUST);
        config.color = NF_COLOR_LUMINANCE_RATIO;
        REFUSED(NF_ERR_UNSUPPORTED);
    }
    image.unordered = 0;
    config = make_config(2, 2, 1, NF_CV_ROBUST);
    image.samples = N + 1; /* more than there are */
    REFUSED(NF_ERR_RANGE);
    CHECK(image_workspace_size(&config, &image, N) == 0);
    image.samples = 0;
    config = make_config(0, 2, 1, NF_CV_ROBUST);
    REFUSED(NF_ERR_RANGE);
    config = make_config(1, 2, 1, NF_CV_ROBUST);
    config.edges = 1;
    REFUSED(NF_ERR_RANGE);
    config = make_config(2, 2, 1, NF_CV_ROBUST);
    CHECK(image_workspace_size(NULL, &image, N) == 0);
    CHECK(image_workspace_size(&config, NULL, N) == 0);
    memory_free(&work);
}

int main(void)
{
    fill_uniform(u, PIXELS * N * 2, 12);
    defaults();
    unordered();
    edges();
    parts();
    errors();
    return report("image");
}
