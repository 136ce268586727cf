/* The sampler of a tile: by value, what it draws, its batch form, and what bad arguments do. */
#include "tile_file.h"

static int same(const float *a, const float *b, size_t n) { return memcmp(a, b, n * sizeof *a) == 0; }

static void draws(const nf_tile *tile)
{
    uint32_t i, d;
    for (i = 0; i < 2000; ++i) {
        float all[4], few[5];
        nf_tile_sampler s = nf_tile_sampler_pixel(tile, i % 23, i / 23, i % 3, i % 11), copy;
        if (i % 4 == 1)
            s = nf_tile_sampler_domain(s, i);
        if (i % 4 == 2)
            s = nf_tile_sampler_domain(nf_tile_sampler_domain(s, 1), i);
        if (i % 5 == 0)
            s = nf_tile_sampler_scramble(s, i + 1);
        CHECK(sizeof s <= 32);
        copy = s;
        nf_tile_sampler_draw(s, 4, all);
        CHECK(memcmp(&s, &copy, sizeof s) == 0);
        for (d = 1; d <= 4; ++d) {
            poison(few, sizeof few);
            nf_tile_sampler_draw(copy, d, few);
            CHECK(same(few, all, d));
            CHECK(is_poisoned(few + d, (5 - d) * sizeof *few));
        }
    }
}

static void nothing(const nf_tile *tile)
{
    float u[4];
    unsigned char room[sizeof(nf_tile) + 8];
    nf_tile zero;
    nf_tile_sampler none[4], s = nf_tile_sampler_pixel(tile, 1, 2, 3, 4);
    size_t i;
    memset(&zero, 0, sizeof zero);
    memset(&none[0], 0, sizeof none[0]);
    none[1] = nf_tile_sampler_pixel(NULL, 1, 2, 3, 4);
    none[2] = nf_tile_sampler_pixel(&zero, 1, 2, 3, 4);
    memcpy(room + 1, tile, sizeof *tile);
    none[3] = nf_tile_sampler_pixel((const nf_tile *)misaligned(room), 1, 2, 0, 0);
    for (i = 0; i < 4; ++i) {
        poison(u, sizeof u);
        nf_tile_sampler_draw(none[i], 4, u);
        CHECK(u[0] == 0.0f && u[1] == 0.0f && u[2] == 0.0f && u[3] == 0.0f);
        poison(u, sizeof u);
        nf_tile_sampler_draw(nf_tile_sampler_scramble(nf_tile_sampler_domain(none[i], 3), 0), 2, u);
        CHECK(u[0] == 0.0f && u[1] == 0.0f && is_poisoned(u + 2, 2 * sizeof *u));
    }
    poison(u, sizeof u);
    nf_tile_sampler_draw(s, 0, u);
    nf_tile_sampler_draw(s, 5, u);
    nf_tile_sampler_draw(s, UINT32_MAX, u);
    CHECK(is_poisoned(u, sizeof u));
    nf_tile_sampler_draw(s, 2, NULL);
    nf_tile_sampler_draw(s, 4, NULL);
    nf_tile_sampler_draw(s, 2, (float *)misaligned(u));
    nf_tile_sampler_draw(s, 3, (float *)misaligned(u));
    CHECK(is_poisoned(u, sizeof u));
}

/* What is wrong is named, with its range. */
static void checked(const nf_tile *tile)
{
    const nf_tile_sampler good = nf_tile_sampler_scramble(nf_tile_sampler_pixel(tile, 7, 7, 0, 3), 1);
    nf_tile_sampler s = good;
    nf_tile wrong = *tile;
    uint32_t dims;
    CHECK_NAMED(NF_CHECK_TILE_SAMPLER, &s, NULL);
    s.scrambled = 2;
    CHECK_NAMED(NF_CHECK_TILE_SAMPLER, &s, "scrambled must be 0 or 1");
    s = good;
    s.y = (uint16_t)tile->size;
    CHECK_NAMED(NF_CHECK_TILE_SAMPLER, &s, "below the tile's size");
    s = good;
    s.frame = (uint16_t)tile->frames;
    CHECK_NAMED(NF_CHECK_TILE_SAMPLER, &s, "below the tile's frames");
    wrong.bits = 9;
    s.tile = &wrong;
    CHECK_NAMED(NF_CHECK_TILE_SAMPLER, &s, "bits must be 8 or 16");
    s = nf_tile_sampler_pixel(NULL, 1, 2, 3, 4);
    CHECK_NAMED(NF_CHECK_TILE_SAMPLER, &s, NULL);
    CHECK_NAMED(NF_CHECK_TILE_SAMPLER, NULL, "NULL");
    for (dims = 0; dims < 6; ++dims)
        CHECK_NAMED(NF_CHECK_DIMS, &dims, dims < 1 || dims > 4 ? "dims must be 1 to 4" : NULL);
}

static void fill(const nf_tile *tile)
{
    static const uint32_t dims[3] = {2, 4, 1};
    enum { WIDTH = 11, HEIGHT = 3, SAMPLES = 6, EACH = 7, COUNT = WIDTH * HEIGHT * SAMPLES * EACH };
    memory room = memory_new(COUNT * sizeof(float));
    float *u = (float *)room.start;
    nf_tile_sampler s[3];
    nf_tile wrong;
    uint32_t x, y, i, bad[3] = {2, 5, 1};
    size_t at = 0;
    s[0] = nf_tile_sampler_pixel(tile, 6, 7, 1, 2);
    s[1] = nf_tile_sampler_domain(s[0], 4);
    s[2] = nf_tile_sampler_domain(nf_tile_sampler_scramble(s[0], 5), 6);
    CHECK_STATUS(nf_tile_sampler_fill(s, dims, 3, WIDTH, HEIGHT, SAMPLES, u, COUNT), NF_OK);
    for (y = 0; y < HEIGHT; ++y)
        for (x = 0; x < WIDTH; ++x)
            for (i = 0; i < SAMPLES; ++i) {
                nf_tile_sampler here = nf_tile_sampler_pixel(tile, 6 + x, 7 + y, 1, 2 + i);
                float single[EACH];
                nf_tile_sampler_draw(here, 2, single);
                nf_tile_sampler_draw(nf_tile_sampler_domain(here, 4), 4, single + 2);
                nf_tile_sampler_draw(nf_tile_sampler_domain(nf_tile_sampler_scramble(here, 5), 6), 1, single + 6);
                CHECK(same(single, u + at, EACH));
                at += EACH;
            }

    poison(u, room.bytes);
    CHECK_STATUS(nf_tile_sampler_fill(NULL, dims, 3, 1, 1, 1, u, COUNT), NF_ERR_NULL);
    CHECK_STATUS(nf_tile_sampler_fill(s, NULL, 3, 1, 1, 1, u, COUNT), NF_ERR_NULL);
    CHECK_STATUS(nf_tile_sampler_fill(s, dims, 3, 1, 1, 1, NULL, COUNT), NF_ERR_NULL);
    CHECK_STATUS(nf_tile_sampler_fill((const nf_tile_sampler *)misaligned(s), dims, 3, 1, 1, 1, u, COUNT),
                 NF_ERR_ALIGNMENT);
    CHECK_STATUS(nf_tile_sampler_fill(s, (const uint32_t *)misaligned(bad), 2, 1, 1, 1, u, COUNT), NF_ERR_ALIGNMENT);
    CHECK_STATUS(nf_tile_sampler_fill(s, dims, 3, 1, 1, 1, (float *)misaligned(u), COUNT - 1), NF_ERR_ALIGNMENT);
    CHECK_STATUS(nf_tile_sampler_fill(s, bad, 3, 1, 1, 1, u, COUNT), NF_ERR_RANGE);
    CHECK_STATUS(nf_tile_sampler_fill(s, dims, 3, UINT32_MAX, UINT32_MAX, UINT32_MAX, u, SIZE_MAX), NF_ERR_RANGE);
    CHECK_STATUS(nf_tile_sampler_fill(s, dims, 3, WIDTH, HEIGHT, SAMPLES, u, COUNT - 1), NF_ERR_MEMORY);
    CHECK_STATUS(nf_tile_sampler_fill(NULL, NULL, 0, 0xffff, 0xffff, 1, NULL, 0), NF_OK); /* nothing to draw, at once */
    CHECK(is_poisoned(u, room.bytes));
    CHECK_STATUS(nf_tile_sampler_fill(s, dims, 3, 0, 9, 9, NULL, 0), NF_OK);
    CHECK_STATUS(nf_tile_sampler_fill(NULL, NULL, 0, 9, 9, 9, NULL, 0), NF_OK);

    /* Samplers without a tile draw zeros here too. */
    s[1].tile = NULL;
    CHECK_STATUS(nf_tile_sampler_fill(s, dims, 3, 1, 1, 1, u, EACH), NF_OK);
    CHECK(u[2] == 0.0f && u[5] == 0.0f && u[0] != 0.0f);

    /* A tile that nobody made, and one that cannot be read. */
    wrong = *tile;
    s[1].tile = &wrong;
    poison(u, room.bytes);
    wrong.values = NULL;
    CHECK_STATUS(nf_tile_sampler_fill(s, dims, 3, 1, 1, 1, u, EACH), NF_ERR_NULL);
    wrong.values = tile->values;
    wrong.bytes -= 1;
    CHECK_STATUS(nf_tile_sampler_fill(s, dims, 3, 1, 1, 1, u, EACH), NF_ERR_RANGE);
    s[1].tile = (const nf_tile *)misaligned(&wrong);
    CHECK_STATUS(nf_tile_sampler_fill(s, dims, 3, 1, 1, 1, u, EACH), NF_ERR_ALIGNMENT);
    s[1].tile = tile;
    s[1].scrambled = 2;
    CHECK_STATUS(nf_tile_sampler_fill(s, dims, 3, 1, 1, 1, u, EACH), NF_ERR_RANGE);
    CHECK(is_poisoned(u, room.bytes));
    memory_free(&room);
}

int main(void)
{
    static const char *const names[] = {"plain.nft", "progressive.nft", "single.nft"};
    size_t i;
    for (i = 0; i < 3; ++i) {
        memory file = tile_file(names[i]);
        nf_tile tile;
        CHECK_STATUS(nf_tile_from_bytes(file.start, file.bytes, &tile), NF_OK);
        draws(&tile);
        nothing(&tile);
        checked(&tile);
        fill(&tile);
        memory_free(&file);
    }
    return report("tile_sampler");
}
