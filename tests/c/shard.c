/* Tables of several processes drawn as one: nf_table_shard(), nf_shards_allocate(), nf_table_draw_shard(). */
#include "check.h"

#define SHARDS 3
#define MOST 50
static const uint32_t sizes[SHARDS] = {50, 7, 20};

typedef struct set {
    nf_table table[SHARDS];
    memory room[SHARDS];
    nf_shard shard[SHARDS];
} set;

/* The second table has importances of 0 only. */
static void make(set *s, float fraction)
{
    uint32_t k, i;
    for (k = 0; k < SHARDS; ++k) {
        float q[MOST];
        uint32_t every[MOST];
        for (i = 0; i < sizes[k]; ++i) {
            every[i] = i;
            q[i] = k == 1 ? 0.0f : k == 2 ? 10.0f : 1.0f + (float)(i % 4);
        }
        s->room[k] = memory_new(nf_table_size(sizes[k]));
        CHECK_STATUS(nf_table_init(&s->table[k], s->room[k].start, s->room[k].bytes, sizes[k], NULL), NF_OK);
        CHECK_STATUS(nf_table_update(&s->table[k], every, q, sizes[k], 0.0f), NF_OK);
        s->table[k].uniform_fraction = fraction;
        CHECK_STATUS(nf_table_shard(&s->table[k], &s->shard[k]), NF_OK);
        CHECK(s->shard[k].items == sizes[k] && s->shard[k].importance == total_of(&s->table[k]));
    }
}

static void set_free(set *s)
{
    uint32_t k;
    for (k = 0; k < SHARDS; ++k)
        memory_free(&s->room[k]);
}

/* Counts that sum to the batch, and items with the weights of their probabilities among all. */
static void normal_use(void)
{
    set s;
    nf_rng rng;
    double items = 0.0, importance = 0.0;
    uint32_t counts[SHARDS], index[10], drawn = 0, k, i;
    float weight[10];
    make(&s, 0.2f);
    nf_rng_seed(&rng, 8);
    CHECK_STATUS(nf_shards_allocate(s.shard, SHARDS, 0.2f, &rng, 10, counts), NF_OK);
    for (k = 0; k < SHARDS; ++k) {
        items += (double)s.shard[k].items;
        importance += s.shard[k].importance;
        drawn += counts[k];
    }
    CHECK(drawn == 10);
    for (k = 0; k < SHARDS; ++k) {
        CHECK_STATUS(nf_table_draw_shard(&s.table[k], s.shard, SHARDS, &rng, counts[k], index, weight), NF_OK);
        for (i = 0; i < counts[k]; ++i) {
            CHECK(index[i] < sizes[k]);
            CHECK(fabs(weight[i] * (0.8 * s.table[k].importance[index[i]] / importance * items + 0.2) - 1.0) < 1e-6);
        }
    }
    set_free(&s);
}

static void errors(void)
{
    set s;
    nf_rng rng, before;
    uint32_t counts[SHARDS], index[4];
    float weight[4];
    nf_shard bad[SHARDS], out;
    make(&s, 0.2f);
    nf_rng_seed(&rng, 1);
    before = rng;
    CHECK_REFUSED(nf_table_shard(NULL, &out), NF_ERR_NULL, out);
    CHECK_STATUS(nf_table_shard(&s.table[0], NULL), NF_ERR_NULL);
    CHECK_STATUS(nf_table_shard(&s.table[0], (nf_shard *)misaligned(&out)), NF_ERR_ALIGNMENT);

    CHECK_REFUSED(nf_shards_allocate(NULL, SHARDS, 0.2f, &rng, 10, counts), NF_ERR_NULL, counts);
    CHECK_REFUSED(nf_shards_allocate(s.shard, SHARDS, 0.2f, NULL, 10, counts), NF_ERR_NULL, counts);
    CHECK_STATUS(nf_shards_allocate(s.shard, SHARDS, 0.2f, &rng, 10, NULL), NF_ERR_NULL);
    CHECK_REFUSED(nf_shards_allocate((const nf_shard *)misaligned(s.shard), SHARDS, 0.2f, &rng, 10, counts),
                  NF_ERR_ALIGNMENT, counts);
    CHECK_REFUSED(nf_shards_allocate(s.shard, SHARDS, -0.1f, &rng, 10, counts), NF_ERR_RANGE, counts);
    CHECK_REFUSED(nf_shards_allocate(s.shard, SHARDS, 1.1f, &rng, 10, counts), NF_ERR_RANGE, counts);
    CHECK_REFUSED(nf_shards_allocate(s.shard, SHARDS, not_a_number(), &rng, 10, counts), NF_ERR_NOT_FINITE, counts);
    CHECK_STATUS(nf_shards_allocate(s.shard, 0, 0.2f, &rng, 10, NULL), NF_ERR_NO_SAMPLES);

    poison(weight, sizeof weight);
    CHECK_REFUSED(nf_table_draw_shard(NULL, s.shard, SHARDS, &rng, 4, index, weight), NF_ERR_NULL, index);
    CHECK_REFUSED(nf_table_draw_shard(&s.table[0], NULL, SHARDS, &rng, 4, index, weight), NF_ERR_NULL, index);
    CHECK_REFUSED(nf_table_draw_shard(&s.table[0], s.shard, 0, &rng, 4, index, weight), NF_ERR_NO_SAMPLES, index);
    CHECK_REFUSED(nf_table_draw_shard(&s.table[0], s.shard, SHARDS, NULL, 4, index, weight), NF_ERR_NULL, index);
    CHECK_STATUS(nf_table_draw_shard(&s.table[0], s.shard, SHARDS, &rng, 4, NULL, weight), NF_ERR_NULL);
    /* The first shard is not among the others. */
    CHECK_REFUSED(nf_table_draw_shard(&s.table[0], s.shard + 1, 2, &rng, 4, index, weight), NF_ERR_RANGE, index);

    memcpy(bad, s.shard, sizeof bad);
    bad[1].importance = -1.0;
    CHECK_REFUSED(nf_shards_allocate(bad, SHARDS, 0.2f, &rng, 10, counts), NF_ERR_RANGE, counts);
    CHECK_REFUSED(nf_table_draw_shard(&s.table[0], bad, SHARDS, &rng, 4, index, weight), NF_ERR_RANGE, index);
    bad[1].importance = not_a_number();
    CHECK_REFUSED(nf_shards_allocate(bad, SHARDS, 0.2f, &rng, 10, counts), NF_ERR_NOT_FINITE, counts);
    CHECK_REFUSED(nf_table_draw_shard(&s.table[0], bad, SHARDS, &rng, 4, index, weight), NF_ERR_NOT_FINITE, index);
    bad[1].importance = infinity_f();
    CHECK_REFUSED(nf_shards_allocate(bad, SHARDS, 0.2f, &rng, 10, counts), NF_ERR_NOT_FINITE, counts);
    bad[1].importance = 0.0;
    bad[1].items = UINT64_C(1) << 53;
    CHECK_REFUSED(nf_shards_allocate(bad, SHARDS, 0.2f, &rng, 10, counts), NF_ERR_RANGE, counts);
    CHECK_REFUSED(nf_table_draw_shard(&s.table[0], bad, SHARDS, &rng, 4, index, weight), NF_ERR_RANGE, index);

    s.table[1].uniform_fraction = 0.0f;
    CHECK_REFUSED(nf_table_draw_shard(&s.table[1], s.shard, SHARDS, &rng, 4, index, weight), NF_ERR_NO_SAMPLES, index);
    CHECK_REFUSED(nf_table_draw_shard(&s.table[1], s.shard + 1, 1, &rng, 4, index, weight), NF_ERR_NO_SAMPLES, index);
    CHECK_REFUSED(nf_shards_allocate(s.shard + 1, 1, 0.0f, &rng, 10, counts), NF_ERR_NO_SAMPLES, counts);
    CHECK(is_poisoned(weight, sizeof weight) && memcmp(&rng, &before, sizeof rng) == 0);
    CHECK_STATUS(nf_table_draw_shard(&s.table[0], s.shard, SHARDS, &rng, 4, index, weight), NF_OK);
    set_free(&s);
}

int main(void)
{
    normal_use();
    errors();
    return report("shard");
}
