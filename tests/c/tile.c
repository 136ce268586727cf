/* Tiles: those that come with the library, those of a file, and every error. */
#include "tile_file.h"

static void built_in(void)
{
    static const struct {
        const nf_tile *tile;
        uint32_t size, spp, dims, frames, progressive;
    } all[] = {{&nf_tile_128_1spp_2d, 128, 1, 2, 1, 0},
               {&nf_tile_128_4spp_2d, 128, 4, 2, 1, 0},
               {&nf_tile_128_16spp_2d, 128, 16, 2, 1, 0},
               {&nf_tile_128_16spp_2d_progressive, 128, 16, 2, 1, 1},
               {&nf_tile_128_1spp_4d, 128, 1, 4, 1, 0},
               {&nf_tile_128_4spp_4d, 128, 4, 4, 1, 0},
               {&nf_tile_128_1spp_2d_gaussian, 128, 1, 2, 1, 0},
               {&nf_tile_128_4spp_2d_gaussian, 128, 4, 2, 1, 0},
               {&nf_tile_128_1spp_2d_temporal, 128, 1, 2, 16, 0},
               {&nf_tile_64_1spp_2d, 64, 1, 2, 1, 0},
               {&nf_tile_64_4spp_2d, 64, 4, 2, 1, 0},
               {&nf_tile_64_4spp_2d_temporal, 64, 4, 2, 16, 0}};
    size_t i;
    for (i = 0; i < sizeof all / sizeof *all; ++i) {
        const nf_tile tile = *all[i].tile;
        CHECK(tile.size == all[i].size && tile.spp == all[i].spp && tile.dims == all[i].dims);
        CHECK(tile.frames == all[i].frames && tile.progressive == all[i].progressive);
        CHECK(tile.bits == 8 || tile.bits == 16);
        CHECK(tile.bytes == (size_t)tile.size * tile.size * tile.spp * tile.dims * tile.frames * tile.bits / 8);
    }
}

static void from_bytes(void)
{
    memory file = tile_file("plain.nft"), odd;
    unsigned char *bytes = (unsigned char *)file.start;
    nf_tile tile, again;
    size_t i;
    CHECK_STATUS(nf_tile_from_bytes(bytes, file.bytes, &tile), NF_OK);
    CHECK(tile.size == 8 && tile.spp == 4 && tile.dims == 3 && tile.frames == 1 && tile.bits == 16 &&
          tile.progressive == 0);
    CHECK(tile.values == bytes + 128 && tile.bytes == file.bytes - 128);

    /* Any alignment. */
    odd = memory_new(file.bytes + 1);
    memcpy(misaligned(odd.start), bytes, file.bytes);
    CHECK_STATUS(nf_tile_from_bytes(misaligned(odd.start), file.bytes, &again), NF_OK);
    for (i = 0; i < 16; ++i) {
        float a[3], b[3];
        nf_tile_sampler_draw(nf_tile_sampler_pixel(&tile, (uint32_t)i, 3, 0, (uint32_t)i), 3, a);
        nf_tile_sampler_draw(nf_tile_sampler_pixel(&again, (uint32_t)i, 3, 0, (uint32_t)i), 3, b);
        CHECK(memcmp(a, b, sizeof a) == 0);
    }
    memory_free(&odd);

    CHECK_REFUSED(nf_tile_from_bytes(NULL, file.bytes, &tile), NF_ERR_NULL, tile);
    CHECK_REFUSED(nf_tile_from_bytes(NULL, 0, &tile), NF_ERR_NULL, tile);
    CHECK_REFUSED(nf_tile_from_bytes(bytes, SIZE_MAX, &tile), NF_ERR_RANGE, tile);
    CHECK_STATUS(nf_tile_from_bytes(bytes, file.bytes, NULL), NF_ERR_NULL);
    CHECK_STATUS(nf_tile_from_bytes(bytes, file.bytes, (nf_tile *)misaligned(&tile)), NF_ERR_ALIGNMENT);

    CHECK_REFUSED(nf_tile_from_bytes(bytes, 0, &tile), NF_ERR_FOREIGN, tile);
    CHECK_REFUSED(nf_tile_from_bytes(bytes, 1, &tile), NF_ERR_LENGTH, tile);
    CHECK_REFUSED(nf_tile_from_bytes(bytes, file.bytes - 1, &tile), NF_ERR_LENGTH, tile);
    bytes[file.bytes - 1] ^= 1;
    CHECK_REFUSED(nf_tile_from_bytes(bytes, file.bytes, &tile), NF_ERR_CORRUPT, tile);
    bytes[8] = 2;
    CHECK_REFUSED(nf_tile_from_bytes(bytes, file.bytes, &tile), NF_ERR_VERSION, tile);
    bytes[0] = 'P';
    CHECK_REFUSED(nf_tile_from_bytes(bytes, file.bytes, &tile), NF_ERR_FOREIGN, tile);
    memory_free(&file);
}

/* What is wrong is named, with its range. */
static void checked(void)
{
    memory file = tile_file("plain.nft");
    nf_tile good, tile;
    memset(&tile, 0, sizeof tile);
    CHECK_NAMED(NF_CHECK_TILE, &tile, NULL);
    CHECK_NAMED(NF_CHECK_TILE, &nf_tile_64_1spp_2d, NULL);
    CHECK_NAMED(NF_CHECK_TILE, NULL, "NULL");
    CHECK_STATUS(nf_tile_from_bytes(file.start, file.bytes, &good), NF_OK);
    CHECK_NAMED(NF_CHECK_TILE, &good, NULL);
#define NAMED(change, words)                          \
    do {                                              \
        tile = good;                                  \
        tile.change;                                  \
        CHECK_NAMED(NF_CHECK_TILE, &tile, words);     \
    } while (0)
    NAMED(size = 12, "size must be a power of two, 1 to 1024");
    NAMED(size = 2048, "size must be a power of two, 1 to 1024");
    NAMED(spp = 0, "spp must be a power of two, 1 to 256");
    NAMED(dims = 9, "dims must be 1 to 8");
    NAMED(frames = 257, "frames must be 1 to 256");
    NAMED(bits = 12, "bits must be 8 or 16");
    NAMED(progressive = 2, "progressive must be 0 or 1");
    NAMED(values = NULL, "values must not be NULL");
    NAMED(bytes = good.bytes - 1, "bytes must be");
    memory_free(&file);
}

int main(void)
{
    checked();
    built_in();
    from_bytes();
    return report("tile");
}
