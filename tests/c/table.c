/* Tables of importances: nf_table_*(). */
#include "check.h"

#define ITEMS 100
static float ones[ITEMS], mixed[ITEMS];

static void fill(void)
{
    uint32_t i;
    for (i = 0; i < ITEMS; ++i) {
        ones[i] = 1.0f;
        mixed[i] = i % 3 == 1 ? 0.0f : (float)(i + 1);
    }
}

static memory make(nf_table *table, uint32_t items, const float *importance)
{
    memory m = memory_new(nf_table_size(items));
    CHECK_STATUS(nf_table_init(table, m.start, m.bytes, items, importance), NF_OK);
    return m;
}

/* The three ways to draw a batch. */
static nf_status draw(uint32_t way, nf_table *table, nf_rng *rng, uint32_t batch, uint32_t *index, float *weight)
{
    switch (way) {
    case 0: return nf_table_draw(table, rng, batch, index, weight);
    case 1: return nf_table_draw_stratified(table, rng, batch, index, weight);
    default: return nf_table_draw_distinct(table, rng, batch, index, weight);
    }
}

static void normal_use(void)
{
    nf_table table;
    memory m = make(&table, ITEMS, mixed);
    nf_rng rng, copy;
    uint32_t index[64], again[64], i;
    float weight[64], p[3 * 64], fresh[2] = {10.0f, 20.0f};
    CHECK(memcmp(table.importance, mixed, sizeof mixed) == 0);
    CHECK(table.items == ITEMS && table.uniform_fraction == 0.2f);
    CHECK(fabsf(probability_of(&table, 1) - 0.002f) < 1e-9f);

    /* Without weights the same items. */
    nf_rng_seed(&rng, 1);
    copy = rng;
    for (i = 0; i < 3; ++i) {
        CHECK_STATUS(draw(i, &table, &rng, 64, index, weight), NF_OK);
        CHECK_STATUS(draw(i, &table, &copy, 64, again, NULL), NF_OK);
        CHECK(memcmp(index, again, sizeof index) == 0 && memcmp(&rng, &copy, sizeof rng) == 0);
    }

    /* One column of three: the others stay as they are. */
    poison(p, sizeof p);
    CHECK_STATUS(nf_table_probabilities(&table, index, 64, 3, p), NF_OK);
    for (i = 0; i < 64; ++i) {
        CHECK(p[3 * i] == probability_of(&table, index[i]));
        CHECK(is_poisoned(p + 3 * i + 1, 2 * sizeof *p));
    }

    /* Updates in order, an item twice. */
    again[0] = again[1] = 5;
    CHECK_STATUS(nf_table_update(&table, again, fresh, 2, 0.5f), NF_OK);
    CHECK(table.importance[5] == ((6.0f + 10.0f) / 2.0f + 20.0f) / 2.0f);
    CHECK_STATUS(nf_table_add_epsilon(&table, 0.5f), NF_OK);
    CHECK(table.importance[5] == 14.5f);

    /* Nothing at all is no error. */
    for (i = 0; i < 3; ++i)
        CHECK_STATUS(draw(i, &table, &rng, 0, NULL, NULL), NF_OK);
    CHECK_STATUS(nf_table_update(&table, NULL, NULL, 0, 0.3f), NF_OK);
    CHECK_STATUS(nf_table_append(&table, NULL, 0), NF_OK);
    CHECK_STATUS(nf_table_probabilities(&table, NULL, 0, 1, NULL), NF_OK);
    memory_free(&m);

    m = make(&table, ITEMS, NULL);
    CHECK(total_of(&table) == ITEMS && table.importance[ITEMS - 1] == 1.0f);
    memory_free(&m);
}

static void sizes_and_init(void)
{
    static const uint32_t some[] = {1, 15, 16, 17, 255, 256, 257, 4096, 4097, 60000, 1000000};
    float bad[3] = {1.0f, 2.0f, 3.0f};
    const size_t bytes = nf_table_size(3);
    memory m = memory_new(bytes);
    nf_table out;
    size_t k;
    CHECK(nf_table_size(0) == 0);
    for (k = 0; k < sizeof some / sizeof *some; ++k) {
        CHECK((double)nf_table_size(some[k]) <= 4.6 * some[k] + 400.0);
        CHECK(some[k] < 60000 || nf_table_size(some[k]) <= 5 * (size_t)some[k]);
    }
    CHECK(sizeof(size_t) < 8 ? nf_table_size(UINT32_MAX) == 0 : nf_table_size(UINT32_MAX) > UINT32_MAX);

    CHECK_STATUS(nf_table_init(NULL, m.start, bytes, 3, ones), NF_ERR_NULL);
    CHECK_REFUSED(nf_table_init(&out, NULL, bytes, 3, ones), NF_ERR_NULL, out);
    CHECK_STATUS(nf_table_init((nf_table *)misaligned(&out), m.start, bytes, 3, ones), NF_ERR_ALIGNMENT);
    CHECK_REFUSED(nf_table_init(&out, misaligned(m.start), bytes, 3, ones), NF_ERR_ALIGNMENT, out);
    CHECK_REFUSED(nf_table_init(&out, (char *)m.start + 4, bytes, 3, ones), NF_ERR_ALIGNMENT, out);
    CHECK_REFUSED(nf_table_init(&out, m.start, bytes, 3, (const float *)misaligned(ones)), NF_ERR_ALIGNMENT, out);
    CHECK_REFUSED(nf_table_init(&out, m.start, bytes - 1, 3, ones), NF_ERR_MEMORY, out);
    CHECK_REFUSED(nf_table_init(&out, m.start, 0, 3, ones), NF_ERR_MEMORY, out);
    CHECK_REFUSED(nf_table_init(&out, m.start, SIZE_MAX, 3, ones), NF_ERR_RANGE, out);
    CHECK_REFUSED(nf_table_init(&out, m.start, bytes, UINT32_MAX, NULL), NF_ERR_MEMORY, out);
    CHECK_REFUSED(nf_table_init(&out, m.start, bytes, 0, ones), NF_ERR_RANGE, out);
    bad[1] = -1.0f;
    CHECK_REFUSED(nf_table_init(&out, m.start, bytes, 3, bad), NF_ERR_RANGE, out);
    bad[1] = not_a_number();
    CHECK_REFUSED(nf_table_init(&out, m.start, bytes, 3, bad), NF_ERR_NOT_FINITE, out);
    bad[1] = infinity_f();
    CHECK_REFUSED(nf_table_init(&out, m.start, bytes, 3, bad), NF_ERR_NOT_FINITE, out);
    bad[0] = bad[2] = 0.0f;
    bad[1] = -0.0f;
    CHECK_REFUSED(nf_table_init(&out, m.start, bytes, 3, bad), NF_ERR_NO_SAMPLES, out);
    CHECK(is_poisoned(m.start, bytes));
    memory_free(&m);

    /* Any alignment to 8 bytes will do. */
    for (k = 0; k < 64; k += 8) {
        memory shifted = memory_new(nf_table_size(ITEMS) + k);
        CHECK_STATUS(nf_table_init(&out, (char *)shifted.start + k, shifted.bytes - k, ITEMS, mixed), NF_OK);
        CHECK(out.importance[ITEMS - 1] == mixed[ITEMS - 1]);
        memory_free(&shifted);
    }
}

/* Whatever is refused leaves the struct, the memory, the generator and the outputs as they were. */
static void errors(void)
{
    nf_table table, before_struct, *odd = (nf_table *)misaligned(&table);
    memory m = make(&table, ITEMS, mixed), before = memory_new(m.bytes);
    nf_rng rng, before_rng;
    uint32_t index[4] = {0, 1, 2, 3}, many[65] = {0}, out[4], k;
    float weight[4], room[65], value[4] = {1.0f, 2.0f, 3.0f, 4.0f};
    const float nan = not_a_number(), infinite = infinity_f();
    nf_rng_seed(&rng, 1);
    many[64] = ITEMS;
    before_rng = rng;
    before_struct = table;
    memcpy(before.start, m.start, m.bytes);

    for (k = 0; k < 3; ++k) {
        poison(weight, sizeof weight);
        CHECK_REFUSED(draw(k, NULL, &rng, 4, out, weight), NF_ERR_NULL, out);
        CHECK_REFUSED(draw(k, odd, &rng, 4, out, weight), NF_ERR_ALIGNMENT, out);
        CHECK_REFUSED(draw(k, &table, NULL, 4, out, weight), NF_ERR_NULL, out);
        CHECK_REFUSED(draw(k, &table, &rng, 4, out, (float *)misaligned(weight)), NF_ERR_ALIGNMENT, out);
        CHECK_STATUS(draw(k, &table, &rng, 4, NULL, weight), NF_ERR_NULL);
        CHECK_STATUS(draw(k, &table, &rng, 4, (uint32_t *)misaligned(out), weight), NF_ERR_ALIGNMENT);
        CHECK(is_poisoned(weight, sizeof weight));
    }
    {
        uint32_t many[ITEMS + 1];
        CHECK_REFUSED(nf_table_draw_distinct(&table, &rng, ITEMS + 1, many, NULL), NF_ERR_RANGE, many);
    }
    CHECK(is_poisoned(weight, sizeof weight));

    CHECK_STATUS(nf_table_update(NULL, index, value, 4, 0.0f), NF_ERR_NULL);
    CHECK_STATUS(nf_table_update(odd, index, value, 4, 0.0f), NF_ERR_ALIGNMENT);
    CHECK_STATUS(nf_table_update(&table, NULL, value, 4, 0.0f), NF_ERR_NULL);
    CHECK_STATUS(nf_table_update(&table, index, NULL, 4, 0.0f), NF_ERR_NULL);
    CHECK_STATUS(nf_table_update(&table, index, (const float *)misaligned(value), 4, 0.0f), NF_ERR_ALIGNMENT);
    CHECK_STATUS(nf_table_update(&table, index, value, 4, -0.1f), NF_ERR_RANGE);
    CHECK_STATUS(nf_table_update(&table, index, value, 4, 1.1f), NF_ERR_RANGE);
    CHECK_STATUS(nf_table_update(&table, index, value, 4, nan), NF_ERR_NOT_FINITE);
    index[3] = ITEMS;
    CHECK_STATUS(nf_table_update(&table, index, value, 4, 0.0f), NF_ERR_RANGE);
    CHECK_REFUSED(nf_table_probabilities(&table, index, 4, 1, weight), NF_ERR_RANGE, weight);
    /* The last of 65: they are computed 64 at a time. */
    CHECK_REFUSED(nf_table_probabilities(&table, many, 65, 1, room), NF_ERR_RANGE, room);
    index[3] = UINT32_MAX;
    CHECK_STATUS(nf_table_update(&table, index, value, 4, 0.0f), NF_ERR_RANGE);
    CHECK_REFUSED(nf_table_probabilities(&table, index, 4, 1, weight), NF_ERR_RANGE, weight);
    index[3] = 3;
    value[3] = -1.0f;
    CHECK_STATUS(nf_table_update(&table, index, value, 4, 0.0f), NF_ERR_RANGE);
    CHECK_STATUS(nf_table_append(&table, value, 4), NF_ERR_RANGE);
    value[3] = nan;
    CHECK_NAN_STATUS(nf_table_update(&table, index, value, 4, 0.0f));
    CHECK_STATUS(nf_table_append(&table, value, 4), NF_ERR_NOT_FINITE);
    value[3] = infinite;
    CHECK_STATUS(nf_table_update(&table, index, value, 4, 0.0f), NF_ERR_NOT_FINITE);
    value[3] = 4.0f;
    CHECK_STATUS(nf_table_append(NULL, value, 4), NF_ERR_NULL);
    CHECK_STATUS(nf_table_append(&table, NULL, 4), NF_ERR_NULL);

    CHECK_REFUSED(nf_table_probabilities(NULL, index, 4, 1, weight), NF_ERR_NULL, weight);
    CHECK_REFUSED(nf_table_probabilities(&table, NULL, 4, 1, weight), NF_ERR_NULL, weight);
    CHECK_STATUS(nf_table_probabilities(&table, index, 4, 1, NULL), NF_ERR_NULL);
    CHECK_REFUSED(nf_table_probabilities(&table, index, 4, 0, weight), NF_ERR_RANGE, weight);

    {
        const float kept = table.uniform_fraction, bad[] = {-0.1f, 1.1f, nan, infinite};
        size_t k;
        for (k = 0; k < sizeof bad / sizeof *bad; ++k) {
            table.uniform_fraction = bad[k];
            CHECK_REFUSED(nf_table_draw(&table, &rng, 4, out, weight), NF_ERR_RANGE, out);
            CHECK_STATUS(nf_table_add_epsilon(&table, 0.1f), NF_ERR_RANGE);
        }
        table.uniform_fraction = kept;
    }
    CHECK_STATUS(nf_table_add_epsilon(NULL, 0.1f), NF_ERR_NULL);
    CHECK_STATUS(nf_table_add_epsilon(&table, -0.1f), NF_ERR_RANGE);
    CHECK_STATUS(nf_table_add_epsilon(&table, nan), NF_ERR_NOT_FINITE);
    CHECK_STATUS(nf_table_add_epsilon(&table, infinite), NF_ERR_NOT_FINITE);
    CHECK(memcmp(before.start, m.start, m.bytes) == 0 && memcmp(&before_struct, &table, sizeof table) == 0);
    CHECK(memcmp(&before_rng, &rng, sizeof rng) == 0);

    /* Fewer items than are asked for can be drawn. */
    table.uniform_fraction = 0.0f;
    {
        uint32_t many[ITEMS];
        CHECK_REFUSED(nf_table_draw_distinct(&table, &rng, ITEMS, many, NULL), NF_ERR_NO_SAMPLES, many);
    }
    CHECK(memcmp(&before_rng, &rng, sizeof rng) == 0);
    /* And it can still be used. */
    CHECK_STATUS(nf_table_draw(&table, &rng, 4, out, weight), NF_OK);
    CHECK(fabs(weight[0] * ITEMS * probability_of(&table, out[0]) - 1.0) < 1e-6);
    memory_free(&before);
    memory_free(&m);
}

/* What is wrong is named. */
static void checked(void)
{
    nf_table table;
    memory m = memory_new(nf_table_size(17));
    CHECK_STATUS(nf_table_init(&table, m.start, m.bytes, 17, NULL), NF_OK);
    CHECK_NAMED(NF_CHECK_TABLE, &table, NULL);
    table.uniform_fraction = 1.5f;
    CHECK_NAMED(NF_CHECK_TABLE, &table, "uniform_fraction must be 0 to 1");
    table.uniform_fraction = not_a_number();
    CHECK_NAMED(NF_CHECK_TABLE, &table, "uniform_fraction must be 0 to 1");
    table.uniform_fraction = 0.0f;
    CHECK_NAMED(NF_CHECK_TABLE, &table, NULL);
    table.magic ^= 1;
    CHECK_NAMED(NF_CHECK_TABLE, &table, "as nf_table_init() made them");
    table.magic ^= 1;
    table.items = 0;
    CHECK_NAMED(NF_CHECK_TABLE, &table, "as nf_table_init() made them");
    table.items = 33;
    CHECK_NAMED(NF_CHECK_TABLE, &table, "as nf_table_init() made them");
    CHECK_NAMED(NF_CHECK_TABLE, NULL, "NULL");
    memory_free(&m);
}

static void no_table(void)
{
    nf_table table;
    nf_rng rng;
    nf_shard shard, all = {1.0, 1};
    uint32_t index[2] = {0, 0}, k, way;
    float value[2] = {1.0f, 1.0f};
    char bytes[64];
    nf_rng_seed(&rng, 1);
    for (k = 0; k < 2; ++k) {
        memset(&table, k == 0 ? 0 : POISON, sizeof table);
        if (k == 1)
            table.importance = value;
        CHECK_NAMED(NF_CHECK_TABLE, &table, "as nf_table_init() made them");
        for (way = 0; way < 3; ++way)
            CHECK_REFUSED(draw(way, &table, &rng, 2, index, NULL), NF_ERR_STATE, index);
        CHECK_REFUSED(nf_table_draw_shard(&table, &all, 1, &rng, 2, index, NULL), NF_ERR_STATE, index);
        CHECK_REFUSED(nf_table_shard(&table, &shard), NF_ERR_STATE, shard);
        index[0] = index[1] = 0;
        CHECK_STATUS(nf_table_update(&table, index, value, 2, 0.0f), NF_ERR_STATE);
        CHECK_REFUSED(nf_table_probabilities(&table, index, 2, 1, value), NF_ERR_STATE, value);
        value[0] = value[1] = 1.0f;
        CHECK_STATUS(nf_table_append(&table, value, 2), NF_ERR_STATE);
        CHECK_STATUS(nf_table_add_epsilon(&table, 0.5f), NF_ERR_STATE);
        CHECK_REFUSED(nf_table_save(&table, bytes, sizeof bytes), NF_ERR_STATE, bytes);
    }
}

/* A table of zeros draws uniformly, or not at all. */
static void zeros(void)
{
    nf_table table;
    memory m = make(&table, 2, ones);
    nf_rng rng;
    uint32_t every[2] = {0, 1}, index[8], way;
    float none[2] = {0.0f, 0.0f}, weight[8];
    nf_rng_seed(&rng, 4);
    CHECK_STATUS(nf_table_update(&table, every, none, 2, 0.0f), NF_OK);
    CHECK_STATUS(nf_table_draw(&table, &rng, 8, index, weight), NF_OK);
    table.uniform_fraction = 0.0f;
    for (way = 0; way < 3; ++way)
        CHECK_REFUSED(draw(way, &table, &rng, 2, index, NULL), NF_ERR_NO_SAMPLES, index);
    CHECK_REFUSED(nf_table_probabilities(&table, every, 2, 1, weight), NF_ERR_NO_SAMPLES, weight);
    memory_free(&m);
}

static void growing(void)
{
    nf_table table;
    memory m = memory_new(nf_table_size(20));
    uint32_t items;
    double total;
    CHECK_STATUS(nf_table_init(&table, m.start, m.bytes, 1, ones), NF_OK);
    CHECK_STATUS(nf_table_append(&table, mixed + 2, 19), NF_OK);
    CHECK(table.items == 20 && table.importance[19] == mixed[20] && total_of(&table) > mixed[20]);
    while (nf_table_append(&table, ones, 1) == NF_OK) {
    }
    items = table.items;
    total = total_of(&table);
    CHECK_STATUS(nf_table_append(&table, ones, 1), NF_ERR_MEMORY);
    CHECK(table.items == items && items < 40 && total_of(&table) == total);
    memory_free(&m);
}

static void saving(void)
{
    nf_table table, loaded;
    memory m = make(&table, ITEMS, mixed), m2 = memory_new(nf_table_size(ITEMS)), saved, changed;
    size_t i, len;
    table.uniform_fraction = 0.3f;
    len = (NF_TABLE_SAVED_HEADER + 4 * (size_t)table.items);
    CHECK(len == 32 + 4 * ITEMS);
    saved = memory_new(len);
    changed = memory_new(len + 1);
    CHECK_STATUS(nf_table_save(NULL, saved.start, len), NF_ERR_NULL);
    CHECK_STATUS(nf_table_save(&table, NULL, len), NF_ERR_NULL);
    CHECK_STATUS(nf_table_save(&table, saved.start, len - 1), NF_ERR_LENGTH);
    CHECK_STATUS(nf_table_save(&table, saved.start, 0), NF_ERR_LENGTH);
    CHECK_STATUS(nf_table_save(&table, changed.start, len + 1), NF_ERR_LENGTH);
    CHECK(is_poisoned(saved.start, len) && is_poisoned(changed.start, len + 1));
    CHECK_STATUS(nf_table_save(&table, saved.start, len), NF_OK);
    /* Of any alignment. */
    CHECK_STATUS(nf_table_save(&table, misaligned(changed.start), len), NF_OK);
    CHECK(memcmp(saved.start, misaligned(changed.start), len) == 0);
    /* A uniform fraction of -0 is saved as 0. */
    table.uniform_fraction = -0.0f;
    CHECK_STATUS(nf_table_save(&table, misaligned(changed.start), len), NF_OK);
    CHECK(memcmp((const char *)misaligned(changed.start) + 24, "\0\0\0", 4) == 0);
    table.uniform_fraction = 0.3f;

    CHECK_STATUS(nf_table_load(NULL, m2.start, m2.bytes, saved.start, len), NF_ERR_NULL);
    CHECK_REFUSED(nf_table_load(&loaded, NULL, m2.bytes, saved.start, len), NF_ERR_NULL, loaded);
    CHECK_REFUSED(nf_table_load(&loaded, m2.start, m2.bytes, NULL, len), NF_ERR_NULL, loaded);
    CHECK_REFUSED(nf_table_load(&loaded, m2.start, m2.bytes, NULL, 0), NF_ERR_NULL, loaded);
    CHECK_REFUSED(nf_table_load(&loaded, m2.start, m2.bytes, "PK\3\4", 4), NF_ERR_FOREIGN, loaded);
    CHECK_REFUSED(nf_table_load(&loaded, m2.start, m2.bytes - 1, saved.start, len), NF_ERR_MEMORY, loaded);
    CHECK_REFUSED(nf_table_load(&loaded, m2.start, SIZE_MAX, saved.start, len), NF_ERR_RANGE, loaded);
    CHECK_REFUSED(nf_table_load(&loaded, misaligned(m2.start), m2.bytes, saved.start, len), NF_ERR_ALIGNMENT, loaded);
    CHECK_STATUS(nf_table_load((nf_table *)misaligned(&loaded), m2.start, m2.bytes, saved.start, len),
                 NF_ERR_ALIGNMENT);
    for (i = 0; i < 4; ++i) {
        static const nf_status expected[4] = {NF_ERR_FOREIGN, NF_ERR_VERSION, NF_ERR_LENGTH, NF_ERR_CORRUPT};
        memcpy(changed.start, saved.start, len);
        ((unsigned char *)changed.start)[4 * i + 4] ^= 0xff;
        CHECK_REFUSED(nf_table_load(&loaded, m2.start, m2.bytes, changed.start, len), expected[i], loaded);
    }
    CHECK_REFUSED(nf_table_load(&loaded, m2.start, m2.bytes, saved.start, 0), NF_ERR_LENGTH, loaded);
    CHECK_REFUSED(nf_table_load(&loaded, m2.start, m2.bytes, saved.start, len - 1), NF_ERR_LENGTH, loaded);
    memcpy(changed.start, saved.start, len);
    CHECK_REFUSED(nf_table_load(&loaded, m2.start, m2.bytes, changed.start, len + 1), NF_ERR_LENGTH, loaded);
    CHECK(is_poisoned(m2.start, m2.bytes));

    memcpy(misaligned(changed.start), saved.start, len);
    CHECK_STATUS(nf_table_load(&loaded, m2.start, m2.bytes, misaligned(changed.start), len), NF_OK);
    CHECK(loaded.items == ITEMS && total_of(&loaded) == total_of(&table) &&
          loaded.uniform_fraction == 0.3f);
    CHECK(memcmp(loaded.importance, mixed, sizeof mixed) == 0);
    memory_free(&m);
    memory_free(&m2);
    memory_free(&saved);
    memory_free(&changed);
}

/* A bit of the struct that has changed on its own: an error, or items that exist. */
static void damaged(void)
{
    nf_table table, made;
    memory m = make(&table, 300, NULL), kept = memory_new(m.bytes);
    nf_rng rng;
    nf_shard shards[2] = {{1.0, 1}, {1000.0, 300}};
    uint32_t index[70], every[300], i, way, k, drawn = 0;
    float weight[70], importance[300];
    for (i = 0; i < 300; ++i) {
        every[i] = i;
        importance[i] = (float)(i % 7);
    }
    CHECK_STATUS(nf_table_update(&table, every, importance, 300, 0.0f), NF_OK);
    made = table;
    memcpy(kept.start, m.start, m.bytes);
    nf_rng_seed(&rng, 7);
    for (i = 0; i < 3000; ++i) {
        unsigned char *const bytes = (unsigned char *)(i % 10 < 8 ? m.start : (void *)&table);
        const uint32_t count = i % 10 < 8 ? (uint32_t)m.bytes : (uint32_t)sizeof table;
        const uint32_t flips = i % 10 >= 8 || i % 2 == 0 ? 1 : i % 5 == 0 ? 1000 : 5;
        const uint32_t batch = i % 3 == 0 ? 70 : 1;
        table.uniform_fraction = i % 4 == 0 ? 0.2f : 0.0f;
        for (k = 0; k < flips; ++k)
            bytes[nf_rng_next(&rng) % count] ^= (unsigned char)(1 << nf_rng_next(&rng) % 8);
        for (way = 0; way < 4; ++way) {
            nf_status status = NF_ERR_STATE;
            poison(index, sizeof index);
            if (way < 3)
                status = draw(way, &table, &rng, batch, index, weight);
            else if (nf_table_shard(&table, shards) == NF_OK)
                status = nf_table_draw_shard(&table, shards, 2, &rng, batch, index, weight);
            for (k = 0; status == NF_OK && k < batch; ++k)
                CHECK(index[k] < table.items);
            drawn += status == NF_OK;
        }
        table = made;
        memcpy(m.start, kept.start, m.bytes);
    }
    /* Most damage leaves something that can be drawn. */
    CHECK(drawn > 3 * 3000);
    memory_free(&kept);
    memory_free(&m);
}

static void shuffling(void)
{
    uint32_t order[13], again[4];
    CHECK_STATUS(nf_shuffle(7, 10, 0, 13, order), NF_OK);
    CHECK(order[0] < 10 && order[0] != order[1] && memcmp(order, order + 10, 3 * sizeof *order) == 0);
    CHECK_STATUS(nf_shuffle(7, 10, UINT64_MAX / 10 * 10 + 2, 4, again), NF_OK);
    CHECK(memcmp(order + 2, again, sizeof again) == 0);
    CHECK_STATUS(nf_shuffle(7, 10, 70000000002u, 4, again), NF_OK);
    CHECK(memcmp(order + 2, again, sizeof again) == 0);
    CHECK_REFUSED(nf_shuffle(7, 0, 3, 4, again), NF_ERR_RANGE, again);
    CHECK_STATUS(nf_shuffle(7, 9, 3, 4, NULL), NF_ERR_NULL);
    CHECK_STATUS(nf_shuffle(7, 9, 3, 0, NULL), NF_OK);
}

int main(void)
{
    fill();
    normal_use();
    sizes_and_init();
    errors();
    checked();
    no_table();
    zeros();
    growing();
    saving();
    damaged();
    shuffling();
    return report("table");
}
