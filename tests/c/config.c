/* Configurations: what every function makes of one that is out of range. */
#include "check.h"

#define N 40
static float u[N * 20], f[N * 5];

static void terms(void)
{
    nf_cv_config config = make_config(2, 2, 1, NF_CV_ROBUST);
    CHECK(nf_cv_terms(&config) == 6);
    config.controls = 3;
    CHECK(nf_cv_terms(&config) == 9);
    config = make_config(3, 1, 1, NF_CV_ROBUST);
    config.slices = 4;
    /* The constant, 2 coordinates, 4 indicators, and the 2 coordinates again for each of the 4. */
    CHECK(nf_cv_terms(&config) == 1 + 2 + 4 + 8);
    CHECK(nf_cv_terms(NULL) == 0);
}

/* The values of a field count up from 0, as the words say, and each is a choice. */
#define CHOICES(field, ...)                                                    \
    do {                                                                       \
        const uint32_t values[] = {__VA_ARGS__};                               \
        const uint32_t count = sizeof values / sizeof values[0];               \
        nf_cv_config config = make_config(2, 2, 1, NF_CV_ROBUST);              \
        char words[32];                                                        \
        for (config.field = 0; config.field < count; ++config.field) {         \
            const char *found = nf_check(NF_CHECK_CV_CONFIG, &config);         \
            CHECK(values[config.field] == config.field);                       \
            CHECK(!found || !strstr(found, #field " must be one of"));         \
        }                                                                      \
        snprintf(words, sizeof words, ", 0 %s %u", count > 2 ? "to" : "or", count - 1u); \
        CHECK_NAMED(NF_CHECK_CV_CONFIG, &config, words);                       \
        CHECK_NAMED(NF_CHECK_CV_CONFIG, &config, #field " must be one of");    \
    } while (0)

static void choices(void)
{
    CHOICES(estimator, NF_CV_ROBUST, NF_CV_LEAST_SQUARES, NF_CV_LEAVE_ONE_OUT, NF_CV_K_FOLD,
            NF_CV_GRADIENT_DESCENT, NF_CV_INCREMENTAL);
    CHOICES(basis, NF_BASIS_LEGENDRE, NF_BASIS_STEP, NF_BASIS_SINE, NF_BASIS_GAUSSIAN);
    CHOICES(solver, NF_SOLVER_AUTO, NF_SOLVER_NORMAL_EQUATIONS, NF_SOLVER_SQUARE_ROOT, NF_SOLVER_DUAL);
    CHOICES(precision, NF_PRECISION_F64, NF_PRECISION_F32);
    CHOICES(nonfinite, NF_NONFINITE_ERROR, NF_NONFINITE_SKIP);
    CHOICES(color, NF_COLOR_PER_CHANNEL, NF_COLOR_LUMINANCE_RATIO);
}

/* What is wrong is named; a configuration of which nothing is said is taken. */
static void checked(void)
{
    nf_cv_config config = make_config(2, 2, 1, NF_CV_ROBUST);
    memory work = memory_new(1 << 16);
    const uint32_t surface = 0;
    nf_cv_image image;
    nf_estimate out;
    memset(&image, 0, sizeof image);
    CHECK_NAMED(NF_CHECK_CV_CONFIG, &config, NULL);
    CHECK_NAMED(NF_CHECK_CV_IMAGE, &image, "width");
    image.width = image.height = 64;
    CHECK_NAMED(NF_CHECK_CV_IMAGE, &image, NULL);
    CHECK_NAMED(NF_CHECK_CV_IMAGE, misaligned(&image), "misaligned");
    image.unordered = 2;
    CHECK_NAMED(NF_CHECK_CV_IMAGE, &image, "unordered must be 0 or 1");
    image.unordered = 1;
    CHECK_NAMED(NF_CHECK_CV_IMAGE, &image, NULL);
    image.surfaces = &surface;
    CHECK_NAMED(NF_CHECK_CV_IMAGE, &image, "at most 1024");
    image.surfaces = NULL;
    image.width = image.height = 1 << 15;
    CHECK_NAMED(NF_CHECK_CV_IMAGE, &image, "2^30 - 1");
    image.width = image.height = 64;
    image.wanted.width = image.wanted.height = 8;
    CHECK_NAMED(NF_CHECK_CV_IMAGE, &image, "all zero");
    image.unordered = 0;
    image.window = 33;
    CHECK_NAMED(NF_CHECK_CV_IMAGE, &image, "1024 pixels");
    image.window = 8;
    image.stride = 9;
    CHECK_NAMED(NF_CHECK_CV_IMAGE, &image, "stride");
    image.stride = 0;
    image.given.width = 65;
    image.given.height = 1;
    CHECK_NAMED(NF_CHECK_CV_IMAGE, &image, "given must lie");
    image.given.width = 0;
    image.given.height = 0;
    image.given.x = 1;
    CHECK_NAMED(NF_CHECK_CV_IMAGE, &image, "given must lie in the image, and have pixels");
    image.given.x = 0;
    image.wanted.x = 60;
    CHECK_NAMED(NF_CHECK_CV_IMAGE, &image, "wanted must lie");
    image.wanted.x = 0;
    image.given = image.wanted;
    CHECK_NAMED(NF_CHECK_CV_IMAGE, &image, "nf_cv_image_needed");
    CHECK_STATUS(nf_cv_image_needed(&image, &image.given), NF_OK);
    CHECK_NAMED(NF_CHECK_CV_IMAGE, &image, NULL);
    config.edges = 2;
    CHECK_NAMED(NF_CHECK_CV_CONFIG, &config, "edges must be");
    config.edges = 1;
    CHECK_NAMED(NF_CHECK_CV_CONFIG, &config, NULL);
    config.dims = 1;
    CHECK_NAMED(NF_CHECK_CV_CONFIG, &config, "edges must be");
    config.dims = 17;
    CHECK(strcmp(nf_check(NF_CHECK_CV_CONFIG, &config), "dims must be 1 to 16") == 0);
    config = make_config(7, 4, 1, NF_CV_ROBUST);
    CHECK_NAMED(NF_CHECK_CV_CONFIG, &config, "136 terms");
    config = make_config(2, 2, 1, NF_CV_ROBUST);
    config.solver = NF_SOLVER_SQUARE_ROOT;
    CHECK_NAMED(NF_CHECK_CV_CONFIG, &config, "solver must not be the square root");
    config.solver = NF_SOLVER_DUAL;
    CHECK_NAMED(NF_CHECK_CV_CONFIG, &config, NULL);
    config.controls = 1;
    CHECK_NAMED(NF_CHECK_CV_CONFIG, &config, "solver must not be the dual with controls");
    config.controls = 0;
    config.estimator = NF_CV_INCREMENTAL;
    CHECK_NAMED(NF_CHECK_CV_CONFIG, &config, "solver must not be the dual for the incremental estimator");
    CHECK_NAMED(NF_CHECK_CV_CONFIG, NULL, "NULL");
    CHECK_NAMED(NF_CHECK_DIMS + 1, &config, "NF_CHECK_*");
    CHECK_NAMED(UINT32_MAX, NULL, "NF_CHECK_*");
    config = make_config(3, 1, 3, NF_CV_ROBUST);
    config.color = NF_COLOR_LUMINANCE_RATIO;
    config.stride = 4;
    config.folds = 16;
    CHECK_NAMED(NF_CHECK_CV_CONFIG, &config, NULL);
    CHECK_STATUS(estimate_one(&config, u, f, 8, work.start, work.bytes, &out), NF_OK);
    memory_free(&work);
}

/* Every function that takes a configuration refuses this one. */
static void refused(const nf_cv_config *config, nf_status status)
{
    memory work = memory_new(1 << 16);
    nf_estimate out, two[2];
    float coefficients[4];
    nf_cv_accumulator *accumulator;
    nf_cv_config descent = *config;
    const nf_cv_descent steps = {0, 0, 0.0f, 0.0f};
    nf_cv_image pixels;
    /* Images and descents take no control functions at all. */
    const nf_status narrower = config->controls > 0 ? NF_ERR_UNSUPPORTED : status;
    memset(&pixels, 0, sizeof pixels);
    pixels.width = 2;
    pixels.height = 1;
    CHECK(nf_cv_workspace_size(config, N) == 0);
    CHECK(image_workspace_size(config, &pixels, N / 2) == 0);
    CHECK(nf_cv_accumulator_size(config, NULL) == 0);
    CHECK(accumulator_workspace_size(config) == 0);
    CHECK_REFUSED(estimate_one(config, u, f, N, work.start, work.bytes, &out), status, out);
    CHECK_REFUSED(estimate_controlled(config, u, f, u, u, N, work.start, work.bytes, &out), status, out);
    CHECK_REFUSED(estimate_image(config, &pixels, u, f, N / 2, work.start, work.bytes, two), narrower, two);
    CHECK_REFUSED(nf_cv_accumulator_init(work.start, work.bytes, config, &accumulator), status, accumulator);
    if (config->estimator == NF_CV_ROBUST)
        descent.estimator = NF_CV_GRADIENT_DESCENT;
    poison(coefficients, sizeof coefficients);
    CHECK_REFUSED(descend(&descent, u, f, N, &steps, coefficients, work.start, work.bytes, &out), narrower,
                  out);
    CHECK(is_poisoned(coefficients, sizeof coefficients));
    memory_free(&work);
}

#define REFUSED(change, status)                                 \
    do {                                                        \
        nf_cv_config config = make_config(2, 2, 1, NF_CV_ROBUST); \
        change;                                                 \
        refused(&config, status);                               \
        CHECK(nf_cv_terms(&config) == 0);                       \
        CHECK(nf_check(NF_CHECK_CV_CONFIG, &config) != NULL);   \
    } while (0)
/* The number of terms does not depend on these fields, so that nf_cv_terms() need not look at them. */
#define REFUSED_AFTER_TERMS(change, status)                     \
    do {                                                        \
        nf_cv_config config = make_config(2, 2, 1, NF_CV_ROBUST); \
        change;                                                 \
        refused(&config, status);                               \
    } while (0)

static void ranges(void)
{
    const float nan = not_a_number(), infinite = infinity_f();
    REFUSED(config.dims = 0, NF_ERR_RANGE);
    REFUSED(config.dims = 17, NF_ERR_RANGE);
    REFUSED(config.dims = UINT32_MAX, NF_ERR_RANGE);
    REFUSED(config.order = 8, NF_ERR_RANGE);
    REFUSED(config.order = UINT32_MAX, NF_ERR_RANGE);
    REFUSED((config.dims = 16, config.order = 2), NF_ERR_RANGE); /* 153 terms */
    REFUSED(config.channels = 0, NF_ERR_RANGE);
    REFUSED(config.channels = 5, NF_ERR_RANGE);
    REFUSED(config.channels = UINT32_MAX, NF_ERR_RANGE);
    REFUSED(config.estimator = 6, NF_ERR_RANGE);
    REFUSED(config.estimator = UINT32_MAX, NF_ERR_RANGE);
    REFUSED(config.basis = BASES, NF_ERR_RANGE);
    REFUSED(config.stratified = 2, NF_ERR_RANGE);
    REFUSED(config.slices = 136, NF_ERR_RANGE);
    REFUSED(config.slices = UINT32_MAX, NF_ERR_RANGE);
    REFUSED(config.edges = config.dims, NF_ERR_RANGE);
    REFUSED(config.edges = UINT32_MAX, NF_ERR_RANGE);
    REFUSED((config.slices = 4, config.edges = 1), NF_ERR_RANGE); /* the second picks the slice */
    REFUSED(config.controls = 5, NF_ERR_RANGE);
    REFUSED(config.controls = UINT32_MAX, NF_ERR_RANGE);
    REFUSED(config.stride = 1, NF_ERR_RANGE);
    REFUSED(config.solver = 4, NF_ERR_RANGE);
    REFUSED_AFTER_TERMS(config.precision = 2, NF_ERR_RANGE);
    REFUSED(config.nonfinite = 2, NF_ERR_RANGE);
    REFUSED(config.color = 2, NF_ERR_RANGE);
    REFUSED(config.folds = 1, NF_ERR_RANGE);
    REFUSED(config.folds = 17, NF_ERR_RANGE);
    REFUSED(config.solver = NF_SOLVER_SQUARE_ROOT, NF_ERR_UNSUPPORTED);
    REFUSED(config.color = NF_COLOR_LUMINANCE_RATIO, NF_ERR_UNSUPPORTED);
    REFUSED(config.ridge = -0.5f, NF_ERR_RANGE);
    REFUSED(config.ridge = -2.0f, NF_ERR_RANGE);
    REFUSED(config.ridge = nan, NF_ERR_RANGE);
    REFUSED(config.ridge = infinite, NF_ERR_RANGE);
}

int main(void)
{
    fill_uniform(u, N * 20, 1);
    fill_linear(f, u, N, 2, 1);
    terms();
    choices();
    checked();
    ranges();
    return report("config");
}
