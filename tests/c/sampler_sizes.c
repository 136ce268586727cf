/* noisefloor_sampler.h with a table of 64 x 64 pixels and 2^7 entries, given as an argument: of the library's table,
 * repeated, it draws the library's leading bits.
 */
#include "check.h"

#define NFS_SIDE 6
#define NFS_BITS 7
#define NFS_BUFFER const uint32_t
#include "noisefloor_sampler.h"

static uint32_t table[64 * 64 << 7];

int main(void)
{
    uint32_t i;
    size_t different = 0;
    for (i = 0; i < 64 * 64 << 7; ++i) {
        const uint32_t x = i >> 7 & 31, y = i >> 13 & 31;
        table[i] = nf_sampler_table()[(y * 32 + x) << 6 | (i >> 1 & 63)];
    }
    for (i = 0; i < 100000; ++i) {
        const uint32_t x = i * 40503u, y = i * 30011u, index = i >> i % 16;
        nf_sampler expected = nf_sampler_domain(nf_sampler_pixel(x, y, i % 3, index), i);
        nfs actual = nfs_domain(nfs_pixel(x, y, i % 3, index), i);
        float four[4];
        nfs_floats u = nfs_draw4(actual, table);
        nf_sampler_draw(expected, 4, four);
        /* Further bits are hashes of the pixel's number. */
        different += (int)(u.x * 256) != (int)(four[0] * 256) || (int)(u.y * 256) != (int)(four[1] * 256);
        different += (int)(u.z * 256) != (int)(four[2] * 256) || (int)(u.w * 256) != (int)(four[3] * 256);
    }
    CHECK(different == 0);
    return report("sampler_sizes");
}
