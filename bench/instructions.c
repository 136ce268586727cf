/* Calls the library's hottest functions, so that callgrind can count their instructions: a number that no other program
 * on the machine changes. `cargo xtask report --only instructions` compiles, runs and tabulates it.
 *
 *     ./instructions         the cases: name, repetitions, what a repetition does so often
 *     valgrind --tool=callgrind --toggle-collect=measured ./instructions NAME
 *
 * Inputs are always the same. Each case runs once before it is counted: caches of answers are full then. */
#include "noisefloor.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ITEMS 60000
#define BATCH 64
#define TECHNIQUES 8
#define PARAMETERS 1000
#define SIDE 16 /* of the image */
#define SPP 4
#define SAMPLES (SIDE * SIDE * SPP)
#define FILL 32 /* side of the filled part of an image */

static nf_rng rng;
static float u[2 * SAMPLES], f[SAMPLES], weight[BATCH], importance[BATCH], out[2 * FILL * FILL];
static uint32_t item[BATCH], technique[BATCH];
static float pdf[BATCH * TECHNIQUES], gradient[BATCH * PARAMETERS], mean[PARAMETERS];
static nf_estimate estimates[SIDE * SIDE];
static const uint32_t *entries;
#define NOISEFLOOR_TABLE(i) entries[i]
#include "noisefloor_sampler.h"
static nf_table table;
static nf_tile tile;
static nf_cv_config config;
static nf_cv_image image;
static nf_cv_accumulator *accumulator;
static nf_gradient *state;
static void *workspace;
static size_t bytes;

static void check(nf_status status, const char *what)
{
    if (status == NF_OK)
        return;
    fprintf(stderr, "instructions: %s: %s\n", what, nf_status_message(status));
    exit(EXIT_FAILURE);
}

static void *allocate(size_t size, const char *what)
{
    void *memory = size > 0 ? calloc(1, size) : NULL;
    if (memory == NULL) {
        fprintf(stderr, "instructions: %s: no memory, or a size of 0\n", what);
        exit(EXIT_FAILURE);
    }
    return memory;
}

/* ---- what is prepared, and what is counted ---- */

static void configure(uint32_t estimator)
{
    config = (nf_cv_config){.dims = 2, .order = 2, .channels = 1};
    config.estimator = estimator;
}

static void prepare_estimate(uint32_t estimator, size_t n)
{
    configure(estimator);
    bytes = nf_cv_workspace_size(&config, n);
    workspace = allocate(bytes, "nf_cv_workspace_size");
}

static void prepare_robust_16(void) { prepare_estimate(NF_CV_ROBUST, 16); }
static void prepare_robust_64(void) { prepare_estimate(NF_CV_ROBUST, 64); }
static void prepare_least_squares(void) { prepare_estimate(NF_CV_LEAST_SQUARES, 64); }
static void call_estimate(size_t n)
{
    const nf_cv_samples samples = {.u = u, .f = f, .n = n};
    check(nf_cv_estimate(&config, &samples, 1, workspace, bytes, estimates), "nf_cv_estimate");
}

static void call_16(void) { call_estimate(16); }
static void call_64(void) { call_estimate(64); }

static void prepare_accumulator(void)
{
    configure(NF_CV_ROBUST);
    size_t size = nf_cv_accumulator_size(&config, NULL);
    check(nf_cv_accumulator_init(allocate(size, "accumulator"), size, &config, &accumulator), "nf_cv_accumulator_init");
}

static void call_accumulator(void)
{
    for (int i = 0; i < 64; ++i) {
        const nf_cv_samples samples = {.u = u + 2 * i, .f = f + i, .n = 1};
        check(nf_cv_accumulator_add(accumulator, &samples), "nf_cv_accumulator_add");
    }
}

static nf_cv_samples pixels = {.u = u, .f = f, .n = SPP};

static void prepare_image(void)
{
    configure(NF_CV_ROBUST);
    image.width = SIDE, image.height = SIDE;
    bytes = nf_cv_image_workspace_size(&config, &image, &pixels);
    workspace = allocate(bytes, "nf_cv_image_workspace_size");
}

/* Where one pixel is far from the others, windows that hold it are fitted once more without it. */
static void prepare_bright_image(void)
{
    prepare_image();
    for (size_t i = 0; i < SPP; ++i)
        f[(SIDE * SIDE / 2 + SIDE / 2) * SPP + i] *= 1000.0f;
}

/* Every window has lit and dark samples. */
static void prepare_edges(void)
{
    prepare_image();
    config.edges = 1;
    bytes = nf_cv_image_workspace_size(&config, &image, &pixels);
    workspace = allocate(bytes, "nf_cv_image_workspace_size");
    for (size_t i = 0; i < SAMPLES; ++i)
        f[i] = u[2 * i] + u[2 * i + 1] < 1.0f ? f[i] : 0;
}

/* A third number picks one of 16 lights. */
static void prepare_slices(void)
{
    static float picked[3 * SAMPLES];
    configure(NF_CV_ROBUST);
    config.dims = 3, config.slices = 16;
    image.width = SIDE, image.height = SIDE;
    pixels.u = picked;
    bytes = nf_cv_image_workspace_size(&config, &image, &pixels);
    workspace = allocate(bytes, "nf_cv_image_workspace_size");
    for (size_t i = 0; i < SAMPLES; ++i) {
        memcpy(picked + 3 * i, u + 2 * i, 2 * sizeof *u);
        picked[3 * i + 2] = nf_rng_uniform(&rng);
        f[i] *= picked[3 * i + 2];
    }
}

static void call_image(void)
{
    check(nf_cv_image_estimate(&config, &image, &pixels, workspace, bytes, estimates), "nf_cv_image_estimate");
}

static void call_sampler(void)
{
    for (uint32_t i = 0; i < 64; ++i)
        nf_sampler_draw(nf_sampler_pixel(i, 3 * i, 0, i % 4), 2, out);
}

static void call_sampler_domain(void)
{
    for (uint32_t i = 0; i < 64; ++i)
        nf_sampler_draw(nf_sampler_domain(nf_sampler_pixel(i, 3 * i, 0, i % 4), 7), 2, out);
}

static void call_sampler_4(void)
{
    for (uint32_t i = 0; i < 64; ++i)
        nf_sampler_draw(nf_sampler_domain(nf_sampler_pixel(i, 3 * i, 0, 64 + i), 7), 4, out);
}

static void prepare_inlined(void) { entries = nf_sampler_table(); }

/* A sample that the compiler does not know: it would leave out a part. */
static volatile uint32_t inlined = 0;

static void call_inlined(void)
{
    const uint32_t first = inlined;
    for (uint32_t i = 0; i < 64; ++i) {
        const nfs_floats drawn = nfs_draw2(nfs_pixel(i, 3 * i, 0, first + i % 4));
        out[i % 2] = drawn.x + drawn.y;
    }
}

static void call_inlined_4(void)
{
    const uint32_t first = inlined;
    for (uint32_t i = 0; i < 64; ++i) {
        const nfs_floats drawn = nfs_draw4(nfs_domain(nfs_pixel(i, 3 * i, 0, first + 64 + i), i));
        out[i % 2] = drawn.x + drawn.y + drawn.z + drawn.w;
    }
}

static void prepare_tile(void) { tile = nf_tile_128_4spp_2d; }
static void prepare_tile_4(void) { tile = nf_tile_128_4spp_4d; }
static void prepare_tile_16(void) { tile = nf_tile_128_16spp_2d; }

static void call_draw(void)
{
    for (uint32_t i = 0; i < 64; ++i)
        nf_tile_sampler_draw(nf_tile_sampler_pixel(&tile, i, 3 * i, 0, i % 4), 2, out);
}

static void call_domain(void)
{
    for (uint32_t i = 0; i < 64; ++i)
        nf_tile_sampler_draw(nf_tile_sampler_domain(nf_tile_sampler_pixel(&tile, i, 3 * i, 0, i % 4), 7), 2, out);
}

static void call_draw_4(void)
{
    for (uint32_t i = 0; i < 64; ++i)
        nf_tile_sampler_draw(nf_tile_sampler_pixel(&tile, i, 3 * i, 0, i % tile.spp), 4, out);
}

static void call_two_domains(void)
{
    for (uint32_t i = 0; i < 64; ++i) {
        nf_tile_sampler pixel = nf_tile_sampler_pixel(&tile, i, 3 * i, 0, i % 16);
        nf_tile_sampler_draw(nf_tile_sampler_domain(pixel, 0), 2, out);
        nf_tile_sampler_draw(nf_tile_sampler_domain(pixel, 1), 2, out + 2);
    }
}

static void call_fill_pixels(void)
{
    nf_tile_sampler pixel = nf_tile_sampler_pixel(&tile, 0, 0, 0, 0);
    nf_tile_sampler both[2] = {nf_tile_sampler_domain(pixel, 0), nf_tile_sampler_domain(pixel, 1)};
    uint32_t dims[2] = {2, 2};
    check(nf_tile_sampler_fill(both, dims, 2, 4, 8, 16, out, 4 * 4 * 8 * 16), "nf_tile_sampler_fill");
}

static void call_fill(void)
{
    nf_tile_sampler pixel = nf_tile_sampler_pixel(&tile, 0, 0, 0, 0);
    uint32_t dims = 2;
    check(nf_tile_sampler_fill(&pixel, &dims, 1, FILL, FILL, 1, out, 2 * FILL * FILL), "nf_tile_sampler_fill");
}

static void prepare_table(void)
{
    float *all = allocate(ITEMS * sizeof *all, "importances");
    for (uint32_t i = 0; i < ITEMS; ++i)
        all[i] = 0.1f + nf_rng_uniform(&rng);
    size_t size = nf_table_size(ITEMS);
    check(nf_table_init(&table, allocate(size, "table"), size, ITEMS, all), "nf_table_init");
    free(all);
}

static void call_table_draw(void) { check(nf_table_draw(&table, &rng, BATCH, item, weight), "nf_table_draw"); }
static void call_table_update(void)
{
    check(nf_table_update(&table, item, importance, BATCH, 0.3f), "nf_table_update");
}

static void call_balance(void)
{
    uint32_t counts[TECHNIQUES] = {8, 8, 8, 8, 8, 8, 8, 8};
    for (uint32_t i = 0; i < BATCH; ++i)
        check(nf_mis_weight(NF_MIS_BALANCE, 0.0f, pdf + i * TECHNIQUES, counts, TECHNIQUES, technique[i], weight + i),
              "nf_mis_weight");
}

static void call_omis(void)
{
    check(nf_omis_weights(NF_OMIS_RIDGE, 0.0f, TECHNIQUES, ITEMS, pdf, technique, BATCH, weight), "nf_omis_weights");
}

static void prepare_gradient(void)
{
    size_t size = nf_gradient_size(TECHNIQUES, PARAMETERS);
    check(nf_gradient_init(allocate(size, "gradient"), size, TECHNIQUES, PARAMETERS, &state), "nf_gradient_init");
}

static void call_gradient(void)
{
    check(nf_gradient_estimate(state, NF_OMIS_RIDGE, 0.0f, 0.0f, ITEMS, pdf, technique, gradient, BATCH, mean),
          "nf_gradient_estimate");
}

static void nothing(void) {}

/* ---- the cases ---- */

static const struct {
    const char *name;
    void (*prepare)(void);
    void (*call)(void);
    uint32_t repeat; /* calls that are counted */
    uint32_t parts;  /* of what `unit` names, in each */
    const char *unit;
} cases[] = {
    {"nf_cv_estimate robust 16", prepare_robust_16, call_16, 100, 16, "sample"},
    {"nf_cv_estimate robust 64", prepare_robust_64, call_64, 100, 64, "sample"},
    {"nf_cv_estimate least squares 64", prepare_least_squares, call_64, 100, 64, "sample"},
    {"nf_cv_accumulator_add", prepare_accumulator, call_accumulator, 20, 64, "sample"},
    {"nf_cv_image_estimate", prepare_image, call_image, 1, SAMPLES, "sample"},
    {"nf_cv_image_estimate bright pixel", prepare_bright_image, call_image, 1, SAMPLES, "sample"},
    {"nf_cv_image_estimate edges", prepare_edges, call_image, 1, SAMPLES, "sample"},
    {"nf_cv_image_estimate 16 slices", prepare_slices, call_image, 1, SAMPLES, "sample"},
    {"nf_sampler_draw", nothing, call_sampler, 100, 64, "draw"},
    {"nf_sampler_draw domain", nothing, call_sampler_domain, 100, 64, "draw"},
    {"nf_sampler_draw 4 domain", nothing, call_sampler_4, 100, 64, "draw"},
    {"nfs_draw2", prepare_inlined, call_inlined, 100, 64, "draw"},
    {"nfs_draw4 domain", prepare_inlined, call_inlined_4, 100, 64, "draw"},
    {"nf_tile_sampler_draw", prepare_tile, call_draw, 100, 64, "draw"},
    {"nf_tile_sampler_draw domain", prepare_tile, call_domain, 100, 64, "draw"},
    {"nf_tile_sampler_draw 4 of 4 dims", prepare_tile_4, call_draw_4, 100, 64, "sample"},
    {"nf_tile_sampler_draw 4 of 2 dims", prepare_tile_16, call_draw_4, 100, 64, "sample"},
    {"nf_tile_sampler_draw two domains", prepare_tile_16, call_two_domains, 100, 64, "sample"},
    {"nf_tile_sampler_fill", prepare_tile, call_fill, 10, FILL * FILL, "draw"},
    {"nf_tile_sampler_fill two domains", prepare_tile_16, call_fill_pixels, 10, 4 * 8 * 16, "sample"},
    {"nf_table_draw", prepare_table, call_table_draw, 100, BATCH, "draw"},
    {"nf_table_update", prepare_table, call_table_update, 100, BATCH, "update"},
    {"nf_mis_weight", nothing, call_balance, 100, BATCH, "weight"},
    {"nf_omis_weights", nothing, call_omis, 20, BATCH, "weight"},
    {"nf_gradient_estimate", prepare_gradient, call_gradient, 4, PARAMETERS, "parameter"},
};
#define CASES (sizeof cases / sizeof *cases)

/* What callgrind counts, by this name. Called through a pointer that the compiler does not know: never inlined. */
void measured(void (*volatile call)(void), uint32_t repeat);
#if defined(__GNUC__)
__attribute__((noinline))
#endif
void measured(void (*volatile call)(void), uint32_t repeat)
{
    for (uint32_t i = 0; i < repeat; ++i)
        call();
}

/* Samples of a smooth function; densities and gradients without a pattern. */
static void fill_inputs(void)
{
    nf_rng_seed(&rng, 1);
    for (size_t i = 0; i < 2 * SAMPLES; ++i)
        u[i] = nf_rng_uniform(&rng);
    for (size_t i = 0; i < SAMPLES; ++i)
        f[i] = 1.0f + u[2 * i] * (2.0f - u[2 * i + 1]) + 0.1f * nf_rng_uniform(&rng);
    for (uint32_t i = 0; i < BATCH; ++i) {
        technique[i] = i % TECHNIQUES;
        item[i] = (uint32_t)(nf_rng_uniform(&rng) * ITEMS);
        importance[i] = nf_rng_uniform(&rng);
    }
    for (size_t i = 0; i < BATCH * TECHNIQUES; ++i)
        pdf[i] = (0.1f + nf_rng_uniform(&rng)) / ITEMS;
    for (size_t i = 0; i < BATCH * PARAMETERS; ++i)
        gradient[i] = nf_rng_uniform(&rng) - 0.5f;
}

int main(int count, char **words)
{
    if (count < 2) {
#if defined(__GNUC__) && (defined(__x86_64__) || defined(__i386__))
        printf("vector units,%s\n", __builtin_cpu_supports("avx2") ? "AVX2" : "none");
#else
        printf("vector units,none\n");
#endif
        for (size_t k = 0; k < CASES; ++k)
            printf("%s,%u,%u,%s\n", cases[k].name, cases[k].repeat, cases[k].parts, cases[k].unit);
        return EXIT_SUCCESS;
    }
    for (size_t k = 0; k < CASES; ++k)
        if (strcmp(words[1], cases[k].name) == 0) {
            fill_inputs();
            cases[k].prepare();
            cases[k].call();
            measured(cases[k].call, cases[k].repeat);
            return EXIT_SUCCESS;
        }
    fprintf(stderr, "instructions: there is no case `%s`; without arguments it names them\n", words[1]);
    return EXIT_FAILURE;
}
