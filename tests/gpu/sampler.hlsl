// noisefloor_sampler.h in HLSL: the draws that expected.h has.
[[vk::binding(0)]] StructuredBuffer<uint> table;
[[vk::binding(1)]] RWStructuredBuffer<float4> numbers;
struct Push {
    uint first;
};
[[vk::push_constant]] Push push;

#define NFS_HLSL // DXC says so itself
#define NOISEFLOOR_TABLE(i) table[i]
#include "noisefloor_sampler.h"

[numthreads(64, 1, 1)] void main(uint3 id : SV_DispatchThreadID)
{
    uint i = push.first + id.x;
    uint a = nfs_mix(i), b = nfs_mix(i ^ 0x5bd1e995u);
    nfs s = nfs_pixel(a, b, i % 3u, b >> (a & 31u));
    s.flags = i & 2u;
    for (uint k = 0u; k < i % 4u; ++k)
        s = nfs_domain(s, a ^ k);
    s = nfs_scramble(s, i % 5u);
    nfs_floats four = nfs_draw4(s), two = nfs_draw2(s);
    numbers[2u * id.x] = float4(four.x, four.y, four.z, four.w);
    numbers[2u * id.x + 1u] = float4(two.x, two.y, 0.0, 0.0);
}
