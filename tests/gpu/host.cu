/* noisefloor_sampler.h as CUDA and as HIP, compiled by clang for the host alone: the draws of expected.h. cuda.cu is
 * for GPUs.
 */
#if defined(__HIP__)
#define __HIPCC__ 1
#endif
/* What the vendors' headers define. */
#define __host__ __attribute__((host))
#define __device__ __attribute__((device))
#include "expected.h"
#include "sampler_of.h"

int main()
{
    size_t different = 0;
    for (uint32_t i = 0; i < ROUNDS * AT_ONCE; ++i) {
        float here[8], drawn[8] = {0};
        expected(i, here);
        nfs s = sampler_of(i);
        nfs_floats four = nfs_draw4(s), two = nfs_draw2(s);
        memcpy(drawn, &four, sizeof four);
        drawn[4] = two.x, drawn[5] = two.y;
        different += memcmp(here, drawn, sizeof here) != 0;
    }
    printf("clang's host side: %zu of %u samplers draw other bits\n", different, ROUNDS * AT_ONCE);
    return different != 0;
}
