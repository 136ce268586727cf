/* The default sampler: by value, what it draws, its batch form, and what bad arguments do. */
#include "check.h"

static int same(const float *a, const float *b, size_t n) { return memcmp(a, b, n * sizeof *a) == 0; }

/* The numbers that tests/tests/sampler.rs pins; sampler_source.c has the other bits. */
static void pinned(void)
{
    static const float numbers[4] = {7610915.0f, 13897400.0f, 1615489.0f, 16714429.0f};
    float u[4], white[4];
    uint32_t k;
    nf_sampler_draw(nf_sampler_pixel(0, 0, 0, 0), 4, u);
    for (k = 0; k < 4; ++k)
        CHECK(u[k] * 16777216.0f == numbers[k]);
    nf_sampler_draw(nf_sampler_pixel(3, 5, 0, 1), 4, u);
    nf_sampler_draw(nf_sampler_white(3, 5, 0, 1), 4, white);
    CHECK(!same(u, white, 4));
}

static void draws(void)
{
    uint32_t i, d;
    for (i = 0; i < 4000; ++i) {
        float all[4], few[5];
        const uint32_t index = i % 11 << i % 32;
        nf_sampler s = (i % 7 == 0 ? nf_sampler_white : nf_sampler_pixel)(i % 23, i / 23, i % 3, index), copy;
        if (i % 4 == 1)
            s = nf_sampler_domain(s, i);
        if (i % 4 == 2)
            s = nf_sampler_domain(nf_sampler_domain(s, 1), i);
        if (i % 5 == 0)
            s = nf_sampler_scramble(s, i + 1);
        CHECK(sizeof s == 16);
        copy = s;
        nf_sampler_draw(s, 4, all);
        CHECK(memcmp(&s, &copy, sizeof s) == 0);
        for (d = 1; d <= 4; ++d) {
            poison(few, sizeof few);
            nf_sampler_draw(copy, d, few);
            CHECK(same(few, all, d));
            CHECK(is_poisoned(few + d, (5 - d) * sizeof *few));
        }
    }
}

static void nothing(void)
{
    float u[4];
    const nf_sampler s = nf_sampler_pixel(1, 2, 3, 4);
    poison(u, sizeof u);
    nf_sampler_draw(s, 0, u);
    nf_sampler_draw(s, 5, u);
    nf_sampler_draw(s, UINT32_MAX, u);
    nf_sampler_draw(s, 2, NULL);
    nf_sampler_draw(s, 2, (float *)misaligned(u));
    CHECK(is_poisoned(u, sizeof u));
}

#define WIDTH 5
#define HEIGHT 3
#define SAMPLES 6
#define EACH 7
#define COUNT (WIDTH * HEIGHT * SAMPLES * EACH)

static void fill(void)
{
    static float u[COUNT];
    static const uint32_t dims[3] = {2, 4, 1}, bad[3] = {2, 5, 1};
    nf_sampler s[3];
    uint32_t x, y, i;
    size_t at = 0;
    s[0] = nf_sampler_pixel(6, 7, 1, 2);
    s[1] = nf_sampler_domain(s[0], 4);
    s[2] = nf_sampler_domain(nf_sampler_scramble(s[0], 5), 6);
    CHECK_STATUS(nf_sampler_fill(s, dims, 3, WIDTH, HEIGHT, SAMPLES, u, COUNT), NF_OK);
    for (y = 0; y < HEIGHT; ++y)
        for (x = 0; x < WIDTH; ++x)
            for (i = 0; i < SAMPLES; ++i) {
                const nf_sampler here = nf_sampler_pixel(6 + x, 7 + y, 1, 2 + i);
                float single[EACH];
                nf_sampler_draw(here, 2, single);
                nf_sampler_draw(nf_sampler_domain(here, 4), 4, single + 2);
                nf_sampler_draw(nf_sampler_domain(nf_sampler_scramble(here, 5), 6), 1, single + 6);
                CHECK(same(single, u + at, EACH));
                at += EACH;
            }

    poison(u, sizeof u);
    CHECK_STATUS(nf_sampler_fill(NULL, dims, 3, 1, 1, 1, u, COUNT), NF_ERR_NULL);
    CHECK_STATUS(nf_sampler_fill(s, NULL, 3, 1, 1, 1, u, COUNT), NF_ERR_NULL);
    CHECK_STATUS(nf_sampler_fill(s, dims, 3, 1, 1, 1, NULL, COUNT), NF_ERR_NULL);
    CHECK_STATUS(nf_sampler_fill((const nf_sampler *)misaligned(s), dims, 2, 1, 1, 1, u, COUNT), NF_ERR_ALIGNMENT);
    CHECK_STATUS(nf_sampler_fill(s, dims, 3, 1, 1, 1, (float *)misaligned(u), COUNT - 1), NF_ERR_ALIGNMENT);
    CHECK_STATUS(nf_sampler_fill(s, bad, 3, 1, 1, 1, u, COUNT), NF_ERR_RANGE);
    CHECK_STATUS(nf_sampler_fill(s, dims, 3, UINT32_MAX, UINT32_MAX, UINT32_MAX, u, SIZE_MAX), NF_ERR_RANGE);
    CHECK_STATUS(nf_sampler_fill(s, dims, 3, WIDTH, HEIGHT, SAMPLES, u, COUNT - 1), NF_ERR_MEMORY);
    CHECK_STATUS(nf_sampler_fill(NULL, NULL, 0, 0xffff, 0xffff, 1, NULL, 0), NF_OK); /* nothing to draw, at once */
    CHECK_STATUS(nf_sampler_fill(s, dims, 3, 0, 9, 9, NULL, 0), NF_OK);
    CHECK(is_poisoned(u, sizeof u));
}

int main(void)
{
    pinned();
    draws();
    nothing();
    fill();
    return report("sampler");
}
