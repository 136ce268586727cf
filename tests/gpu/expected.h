/* What devices are to draw: samplers of all kinds, by the library. */
#ifndef EXPECTED_H
#define EXPECTED_H

#include "noisefloor.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#if !defined(NOISEFLOOR_TABLE)
#define NOISEFLOOR_TABLE(i) nf_sampler_table()[i]
#endif
#include "noisefloor_sampler.h"

/* Samplers at a time; each draws four numbers, then two and two zeros. */
#define AT_ONCE (1u << 20)
#define ROUNDS 5u
#define BYTES (AT_ONCE * 8 * sizeof(float))

static void expected(uint32_t i, float out[8])
{
    const uint32_t a = nfs_mix(i), b = nfs_mix(i ^ 0x5bd1e995u);
    nf_sampler s = (i & 2u ? nf_sampler_white : nf_sampler_pixel)(a, b, i % 3u, b >> (a & 31u));
    uint32_t k;
    for (k = 0; k < i % 4u; ++k)
        s = nf_sampler_domain(s, a ^ k);
    s = nf_sampler_scramble(s, i % 5u);
    memset(out, 0, 8 * sizeof *out);
    nf_sampler_draw(s, 4, out);
    nf_sampler_draw(s, 2, out + 4);
}

/* How many samplers drew other bits. */
static size_t differences(uint32_t first, const float *drawn)
{
    size_t different = 0;
    uint32_t i;
    for (i = 0; i < AT_ONCE; ++i) {
        float here[8];
        expected(first + i, here);
        different += memcmp(here, drawn + 8 * (size_t)i, sizeof here) != 0;
    }
    return different;
}

static double seconds(void)
{
    struct timespec now;
    timespec_get(&now, TIME_UTC);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* The first round, which compiles, is not timed. */
static void report_device(const char *device, const char *language, size_t different, double time)
{
    printf("%s, %s: %zu of %u samplers draw other bits; %.0f million numbers a second\n", device, language, different,
           ROUNDS * AT_ONCE, (ROUNDS - 1) * AT_ONCE * 6e-6 / time);
}

static void failed(const char *what, int status)
{
    fprintf(stderr, "%s: error %d\n", what, status);
    exit(1);
}

#endif
