#version 450
// noisefloor_sampler.h in GLSL: the draws of expected.h.
#extension GL_GOOGLE_include_directive : require
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Table { uint table[]; };
layout(std430, binding = 1) writeonly buffer Numbers { vec4 numbers[]; };
layout(push_constant) uniform Push { uint first; };

#define NOISEFLOOR_TABLE(i) table[i]
#include "noisefloor_sampler.h"
#include "sampler_of.h"

void main()
{
    nfs s = sampler_of(first + gl_GlobalInvocationID.x);
    nfs_floats four = nfs_draw4(s), two = nfs_draw2(s);
    numbers[2u * gl_GlobalInvocationID.x] = vec4(four.x, four.y, four.z, four.w);
    numbers[2u * gl_GlobalInvocationID.x + 1u] = vec4(two.x, two.y, 0.0, 0.0);
}
