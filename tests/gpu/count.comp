#version 450
// One draw of two numbers, of the root or of a child: what tests/programs/spirv.py counts.
#extension GL_GOOGLE_include_directive : require
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Table { uint table[]; };
layout(std430, binding = 1) writeonly buffer Numbers { vec2 numbers[]; };
layout(push_constant) uniform Push { uint x, y, sample_index, key; };

#define NOISEFLOOR_TABLE(i) table[i]
#include "noisefloor_sampler.h"

void main()
{
    nfs s = nfs_pixel(x, y, 0u, sample_index);
#if defined(CHILD)
    s = nfs_domain(s, key);
#endif
    nfs_floats u = nfs_draw2(s);
    numbers[0] = vec2(u.x, u.y);
}
