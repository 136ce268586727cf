/* noisefloor_sampler.h draws the bits of the library. */
#include "check.h"

static const uint32_t *table;
#define NOISEFLOOR_TABLE(i) table[i]
#include "noisefloor_sampler.h"

static uint32_t number(nf_rng *rng)
{
    const uint32_t bits = nf_rng_next(rng);
    return bits >> nf_rng_next(rng) % 32; /* of all sizes */
}

int main(void)
{
    nf_rng rng;
    uint32_t i;
    size_t different = 0;
    table = nf_sampler_table();
    nf_rng_seed(&rng, 1);
    CHECK(sizeof(nfs) == 16);
    for (i = 0; i < 1000000; ++i) {
        const uint32_t x = number(&rng), y = number(&rng), frame = i % 3, index = number(&rng), seed = i % 5;
        nf_sampler expected = (i % 2 ? nf_sampler_white : nf_sampler_pixel)(x, y, frame, index);
        nfs actual = (i % 2 ? nfs_white : nfs_pixel)(x, y, frame, index);
        float four[4], two[2];
        nfs_floats u, v;
        uint32_t depth = i % 4;
        while (depth-- > 0) {
            const uint32_t key = number(&rng);
            expected = nf_sampler_domain(expected, key);
            actual = nfs_domain(actual, key);
        }
        expected = nf_sampler_scramble(expected, seed);
        actual = nfs_scramble(actual, seed);
        nf_sampler_draw(expected, 4, four);
        nf_sampler_draw(expected, 2, two);
        u = nfs_draw4(actual);
        v = nfs_draw2(actual);
        different += u.x != four[0] || u.y != four[1] || u.z != four[2] || u.w != four[3];
        different += v.x != two[0] || v.y != two[1];
    }
    CHECK(different == 0);
    return report("sampler_source");
}
