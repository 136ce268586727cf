/* The batches pinned in tests/vectors/table.txt, to the bit; the file's head says what its columns are. */
#include "vector_file.h"

/* An importance from 32 random bits: 2^-12 to 2^19, or 0. */
static float importance(uint32_t bits)
{
    if ((bits & 0xe0) == 0)
        return 0.0f;
    return ldexpf(1.0f + (float)(bits >> 9) / 8388608.0f, (int)(bits & 31) - 12);
}

/* FNV-1a, 64 bits. */
#define FNV_START UINT64_C(0xcbf29ce484222325)
static uint64_t add_byte(uint64_t hash, unsigned byte) { return (hash ^ byte) * UINT64_C(0x100000001b3); }

static uint64_t add_word(uint64_t hash, uint32_t word)
{
    int i;
    for (i = 0; i < 4; ++i)
        hash = add_byte(hash, word >> (8 * i) & 0xff);
    return hash;
}

static uint32_t bits_of(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static uint64_t hash_batch(const uint32_t *index, const float *weight, uint32_t draws)
{
    uint64_t hash = FNV_START;
    uint32_t k;
    for (k = 0; k < draws; ++k)
        hash = add_word(add_word(hash, index[k]), bits_of(weight[k]));
    return hash;
}

static void *array(size_t count, size_t size)
{
    void *start = malloc(count * size);
    if (!start) {
        fprintf(stderr, "out of memory\n");
        exit(2);
    }
    return start;
}

typedef struct result {
    uint32_t item[2], weight[2];
    uint64_t hash[6];
} result;

static result draw(uint32_t items, uint64_t seed, uint32_t draws, float fraction)
{
    result r;
    nf_rng rng;
    nf_table table;
    memory m = memory_new(nf_table_size(items)), bytes;
    float *values = (float *)array(items, sizeof *values), *weight = (float *)array(draws, sizeof *weight);
    uint32_t *index = (uint32_t *)array(draws, sizeof *index), k;
    const uint32_t second = draws > 1 ? 1 : 0, distinct = draws < items ? draws : items;
    double total;
    nf_rng_seed(&rng, seed);
    for (k = 0; k < items; ++k) {
        float q = importance(nf_rng_next(&rng));
        values[k] = k == 0 ? 1.0f : k / 16 % 5 == 2 ? 0.0f : q;
    }
    CHECK_STATUS(nf_table_init(&table, m.start, m.bytes, items, values), NF_OK);
    table.uniform_fraction = fraction;

    CHECK_STATUS(nf_table_draw(&table, &rng, draws, index, weight), NF_OK);
    r.hash[0] = hash_batch(index, weight, draws);
    r.item[0] = index[0];
    r.weight[0] = bits_of(weight[0]);
    r.item[1] = index[second];
    r.weight[1] = bits_of(weight[second]);

    /* Every third item comes twice in a row. */
    for (k = 1; k < draws; k += 3)
        index[k] = index[k - 1];
    for (k = 0; k < draws; ++k)
        weight[k] = importance(nf_rng_next(&rng));
    weight[0] = 3.0f;
    CHECK_STATUS(nf_table_update(&table, index, weight, draws, 0.3f), NF_OK);
    CHECK_STATUS(nf_table_draw_stratified(&table, &rng, draws, index, weight), NF_OK);
    r.hash[1] = hash_batch(index, weight, draws);

    CHECK_STATUS(nf_table_add_epsilon(&table, 0.001f), NF_OK);
    CHECK_STATUS(nf_table_draw(&table, &rng, draws, index, weight), NF_OK);
    r.hash[2] = hash_batch(index, weight, draws);

    CHECK_STATUS(nf_table_draw_distinct(&table, &rng, distinct, index, weight), NF_OK);
    r.hash[3] = hash_batch(index, weight, distinct);
    total = total_of(&table);
    memcpy(&r.hash[4], &total, sizeof total);
    bytes = memory_new((NF_TABLE_SAVED_HEADER + 4 * (size_t)table.items));
    CHECK_STATUS(nf_table_save(&table, bytes.start, bytes.bytes), NF_OK);
    r.hash[5] = FNV_START;
    for (k = 0; k < bytes.bytes; ++k)
        r.hash[5] = add_byte(r.hash[5], ((const unsigned char *)bytes.start)[k]);
    memory_free(&bytes);
    memory_free(&m);
    free(values);
    free(weight);
    free(index);
    return r;
}

static void check_line(const char *line, int number)
{
    unsigned items, draws, fraction_bits, item[2], weight[2], k;
    unsigned long long seed, hash[6];
    float fraction;
    result r;
    if (sscanf(line, "%u %llu %u %x : %u %x %u %x %llx %llx %llx %llx %llx %llx", &items, &seed, &draws, &fraction_bits,
               &item[0], &weight[0], &item[1], &weight[1], &hash[0], &hash[1], &hash[2], &hash[3], &hash[4],
               &hash[5]) != 14) {
        fprintf(stderr, "tests/vectors/table.txt:%d: cannot be read\n", number);
        CHECK(0);
        return;
    }
    memcpy(&fraction, &fraction_bits, sizeof fraction);
    r = draw(items, seed, draws, fraction);
    for (k = 0; k < 2; ++k) {
        if (r.item[k] != item[k] || r.weight[k] != weight[k])
            fprintf(stderr, "tests/vectors/table.txt:%d: draw %u is %u %08x\n", number, k, (unsigned)r.item[k],
                    (unsigned)r.weight[k]);
        CHECK(r.item[k] == item[k] && r.weight[k] == weight[k]);
    }
    for (k = 0; k < 6; ++k) {
        if (r.hash[k] != hash[k])
            fprintf(stderr, "tests/vectors/table.txt:%d: figure %u is %016llx\n", number, k,
                    (unsigned long long)r.hash[k]);
        CHECK(r.hash[k] == hash[k]);
    }
}

int main(void)
{
    CHECK(each_vector("tests/vectors/table.txt", check_line) == 32);
    set_as_hosts_do();
    CHECK(each_vector("tests/vectors/table.txt", check_line) == 32);
    return report("table_vectors");
}
