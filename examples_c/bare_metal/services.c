/* noisefloor without an operating system, a C library or a heap: draws from a tile, estimates of one pixel, at once and
   streamed, MIS and minibatches. Prints the bits of what it computes, which are the same on every target, and the stack
   that each call used. */
#include "platform.h"
#include "noisefloor.h"

#define SAMPLES 64
#define ITEMS 100
#define BATCH 8

/* The only tile that this program needs, as a file. */
__asm__(".section .rodata\n.balign 8\n.global tile_file\n.global tile_file_end\n"
        "tile_file:\n.incbin \"" TILE_FILE "\"\ntile_file_end:\n.previous\n");
extern const unsigned char tile_file[], tile_file_end[];

static uint64_t workspace[4096];
static float u[2 * SAMPLES], f[SAMPLES];
static int failures;

static uint32_t bits(float value)
{
    union { float value; uint32_t bits; } both;
    both.value = value;
    return both.bits;
}

static void print_number(uint32_t number, uint32_t base, int digits)
{
    char text[12];
    int at = 11;
    text[at] = 0;
    do {
        text[--at] = "0123456789abcdef"[number % base];
        number /= base;
    } while (--digits > 0 || number);
    platform_print(text + at);
}

/* One line: name, bits of two results, and the stack. */
static void line(const char *name, nf_status status, uint32_t first, uint32_t second)
{
    uint32_t stack = platform_stack_used();
    platform_print(name);
    platform_print(" ");
    print_number(first, 16, 8);
    platform_print(" ");
    print_number(second, 16, 8);
    if (stack) {
        platform_print(" stack ");
        print_number(stack, 10, 1);
    }
    if (status != NF_OK) {
        platform_print(" FAILED: ");
        platform_print(nf_status_message(status));
        ++failures;
    }
    platform_print("\n");
}

#ifdef FLOAT_ALONE /* what the library was built for */
#define PRECISION NF_PRECISION_F32
#else
#define PRECISION NF_PRECISION_F64
#endif

static void tile(void)
{
    nf_tile tile = {0}; /* What is printed after an error, too. */
    uint32_t i;
    nf_status status;
    platform_stack_paint();
    status = nf_tile_from_bytes(tile_file, (size_t)(tile_file_end - tile_file), &tile);
    line("nf_tile_from_bytes", status, tile.size, tile.spp);
    if (status != NF_OK)
        return;
    platform_stack_paint();
    for (i = 0; i < SAMPLES; ++i)
        nf_tile_sampler_draw(nf_tile_sampler_domain(nf_tile_sampler_pixel(&tile, 3, 5, 0, i), 7), 2, u + 2 * i);
    line("nf_tile_sampler_draw", NF_OK, bits(u[0]), bits(u[2 * SAMPLES - 1]));
    for (i = 0; i < SAMPLES; ++i)
        f[i] = u[2 * i] * u[2 * i] + 2.0f * u[2 * i + 1];
}

static void control_variate(void)
{
    const nf_cv_config config = {.dims = 2, .order = 2, .channels = 1, .precision = PRECISION};
    const nf_cv_samples samples = {.u = u, .f = f, .n = SAMPLES};
    nf_estimate estimate = {{0.0f, 0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 0.0f, 0.0f}, 0, 0.0f};
    nf_status status;
    platform_stack_paint();
    status = nf_cv_estimate(&config, &samples, 1, workspace, sizeof workspace, &estimate);
#ifdef FLOAT_ALONE /* what this is compared with computes in double */
    line("nf_cv_estimate", status, 0, 0);
#else
    line("nf_cv_estimate", status, bits(estimate.mean[0]), bits(estimate.std_error[0]));
#endif
}

static void streaming(void)
{
    const nf_cv_config config = {.dims = 2, .order = 2, .channels = 1, .precision = NF_PRECISION_F32};
    const nf_cv_samples samples = {.u = u, .f = f, .n = SAMPLES};
    nf_cv_accumulator *accumulator;
    nf_estimate estimate = {{0.0f, 0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 0.0f, 0.0f}, 0, 0.0f};
    nf_status status;
    platform_stack_paint();
    status = nf_cv_accumulator_init(workspace, sizeof workspace / 2, &config, &accumulator);
    if (status == NF_OK)
        status = nf_cv_accumulator_add(accumulator, &samples);
    if (status == NF_OK)
        status = nf_cv_accumulator_estimate(accumulator, workspace + 2048, sizeof workspace / 2, &estimate);
    line("nf_cv_accumulator", status, bits(estimate.mean[0]), bits(estimate.std_error[0]));
}

static void mis(void)
{
    static const float pdf[3] = {0.5f, 2.0f, 1.0f};
    static const uint32_t counts[3] = {2, 1, 4};
    const float value = 3.0f;
    float weight = 0.0f, estimate = 0.0f;
    nf_omis *omis;
    nf_status status;
    uint32_t j;
    platform_stack_paint();
    status = nf_mis_weight(NF_MIS_BALANCE, 0.0f, pdf, counts, 3, 1, &weight);
    line("nf_mis_weight", status, bits(weight), 0);
    platform_stack_paint();
    status = nf_omis_init(workspace, sizeof workspace, 3, 1, counts, &omis);
    for (j = 0; j < 3 && status == NF_OK; ++j)
        status = nf_omis_add(omis, pdf, &j, &value, 1);
    if (status == NF_OK)
        status = nf_omis_solve(omis, NF_OMIS_RIDGE, 0.0f, &estimate, NULL);
    line("nf_omis", status, bits(estimate), 0);
}

static void minibatch(void)
{
    nf_rng rng;
    nf_table table;
    float importance[ITEMS], weight[BATCH] = {0.0f};
    uint32_t index[BATCH] = {0}, i;
    nf_status status;
    nf_rng_seed(&rng, 1);
    for (i = 0; i < ITEMS; ++i)
        importance[i] = nf_rng_uniform(&rng);
    platform_stack_paint();
    status = nf_table_init(&table, workspace, sizeof workspace, ITEMS, importance);
    if (status == NF_OK)
        status = nf_table_draw(&table, &rng, BATCH, index, weight);
    if (status == NF_OK)
        status = nf_table_update(&table, index, importance, BATCH, 0.3f);
    line("nf_table", status, index[BATCH - 1], bits(weight[BATCH - 1]));
}

int services(void)
{
    tile();
    control_variate();
    streaming();
    mis();
    minibatch();
    platform_print(failures ? "failed\n" : "done\n");
    return failures;
}
