/* Random numbers: the same on every target. */
#include "check.h"

/* PCG32 (O'Neill 2014), written out: the reference the library must match from whatever state it starts in. */
static uint32_t pcg32(nf_rng *rng)
{
    uint64_t old = rng->state;
    uint32_t shifted = (uint32_t)(((old >> 18) ^ old) >> 27);
    uint32_t rotation = (uint32_t)(old >> 59);
    rng->state = old * UINT64_C(6364136223846793005) + (rng->increment | 1u);
    return (shifted >> rotation) | (shifted << ((0u - rotation) & 31u));
}

int main(void)
{
    nf_rng rng, copy, reference;
    uint64_t seed;
    int i;

    for (seed = 0; seed < 4; ++seed) {
        nf_rng_seed(&rng, seed * UINT64_C(0x9e3779b97f4a7c15));
        reference = rng;
        for (i = 0; i < 1000; ++i)
            CHECK(nf_rng_next(&rng) == pcg32(&reference));
    }

    /* Any value of the fields is valid. */
    memset(&rng, 0, sizeof rng);
    reference = rng;
    CHECK(nf_rng_next(&rng) == pcg32(&reference));
    memset(&rng, 0xff, sizeof rng);
    reference = rng;
    for (i = 0; i < 10; ++i)
        CHECK(nf_rng_next(&rng) == pcg32(&reference));

    /* A copy repeats; uniform numbers are the upper 24 bits. */
    nf_rng_seed(&rng, 7);
    copy = rng;
    for (i = 0; i < 10000; ++i) {
        float u = nf_rng_uniform(&rng);
        uint32_t bits = nf_rng_next(&copy);
        CHECK(u >= 0.0f && u < 1.0f);
        CHECK(u == (float)(bits >> 8) / 16777216.0f);
    }
    nf_rng_seed(&rng, 1);
    nf_rng_seed(&copy, 1);
    CHECK(memcmp(&rng, &copy, sizeof rng) == 0);

    nf_rng_seed(NULL, 1);
    CHECK(nf_rng_next(NULL) == 0);
    CHECK(nf_rng_uniform(NULL) == 0.0f);
    return report("rng");
}
