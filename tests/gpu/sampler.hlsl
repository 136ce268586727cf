// noisefloor_sampler.h in HLSL: the draws of expected.h.
[[vk::binding(0)]] StructuredBuffer<uint> table;
[[vk::binding(1)]] RWStructuredBuffer<float4> numbers;
[[vk::push_constant]] cbuffer Push
{
    uint first;
};

#define NFS_HLSL // glslang does not say so, DXC does
#define NOISEFLOOR_TABLE(i) table[i]
#include "noisefloor_sampler.h"
#include "sampler_of.h"

[numthreads(64, 1, 1)] void main(uint3 id : SV_DispatchThreadID)
{
    nfs s = sampler_of(first + id.x);
    nfs_floats four = nfs_draw4(s), two = nfs_draw2(s);
    numbers[2u * id.x] = float4(four.x, four.y, four.z, four.w);
    numbers[2u * id.x + 1u] = float4(two.x, two.y, 0.0, 0.0);
}
