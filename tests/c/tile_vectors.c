/* The draws pinned in tests/vectors/tile.txt, to the bit; the file's head says how they are made. */
#include "vector_file.h"
#include "tile_file.h"

static void check_line(const char *line, int number)
{
    unsigned in[9], expected[4], k;
    char name[64];
    memory file;
    nf_tile tile;
    nf_tile_sampler sampler;
    float u[4];
    if (sscanf(line, "%63s %u %u %u %u %u %u %u %u %u : %x %x %x %x", name, &in[0], &in[1], &in[2], &in[3], &in[4],
               &in[5], &in[6], &in[7], &in[8], &expected[0], &expected[1], &expected[2], &expected[3]) != 14) {
        fprintf(stderr, "tests/vectors/tile.txt:%d: cannot be read\n", number);
        CHECK(0);
        return;
    }
    file = tile_file(name);
    CHECK_STATUS(nf_tile_from_bytes(file.start, file.bytes, &tile), NF_OK);
    sampler = nf_tile_sampler_pixel(&tile, in[0], in[1], in[2], in[3]);
    if (in[4] == 0)
        sampler = nf_tile_sampler_scramble(sampler, in[5]);
    for (k = 0; k < in[4] && k < 3; ++k) {
        if (k + 1 == in[4])
            sampler = nf_tile_sampler_scramble(sampler, in[5]);
        sampler = nf_tile_sampler_domain(sampler, in[6 + k]);
    }
    nf_tile_sampler_draw(sampler, 4, u);
    for (k = 0; k < 4; ++k) {
        uint32_t bits;
        memcpy(&bits, &u[k], sizeof bits);
        if (bits != expected[k])
            fprintf(stderr, "tests/vectors/tile.txt:%d: u[%u] is %08x\n", number, k, (unsigned)bits);
        CHECK(bits == expected[k]);
    }
    memory_free(&file);
}

int main(void)
{
    CHECK(each_vector("tests/vectors/tile.txt", check_line) == 400);
    set_as_hosts_do();
    CHECK(each_vector("tests/vectors/tile.txt", check_line) == 400);
    return report("tile_vectors");
}
