#version 450
// noisefloor_sampler.h in GLSL: draws of many pixels, as a compute shader.
#extension GL_GOOGLE_include_directive : require
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Table { uint table[]; };
layout(std430, binding = 1) writeonly buffer Numbers { vec4 numbers[]; };

#define NOISEFLOOR_TABLE(i) table[i]
#include "noisefloor_sampler.h"

void main()
{
    uint i = gl_GlobalInvocationID.x;
    nfs_floats all = nfs_draw4(nfs_domain(nfs_pixel(i & 127u, i >> 7, 0u, i), 3u));
    nfs_floats two = nfs_draw2(nfs_scramble(nfs_white(i, i, 1u, 2u), 7u));
    numbers[i] = vec4(all.x + two.x, all.y + two.y, all.z, all.w);
}
