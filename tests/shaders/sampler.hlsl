// noisefloor_sampler.h in HLSL: draws of many pixels, as a compute shader.
StructuredBuffer<uint> table : register(t0);
RWStructuredBuffer<float4> numbers : register(u0);

#define NFS_HLSL // DXC says so itself
#define NOISEFLOOR_TABLE(i) table[i]
#include "noisefloor_sampler.h"

[numthreads(64, 1, 1)] void main(uint3 id : SV_DispatchThreadID)
{
    uint i = id.x;
    nfs_floats all = nfs_draw4(nfs_domain(nfs_pixel(i & 127u, i >> 7, 0u, i), 3u));
    nfs_floats two = nfs_draw2(nfs_scramble(nfs_white(i, i, 1u, 2u), 7u));
    numbers[i] = float4(all.x + two.x, all.y + two.y, all.z, all.w);
}
