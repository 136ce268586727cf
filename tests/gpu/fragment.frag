#version 310 es
// noisefloor_sampler.h in a fragment shader of GLSL ES, whose numbers have less than 32 bits by default. Compiled only.
#extension GL_GOOGLE_include_directive : require
precision mediump float;
layout(std430, binding = 0) readonly buffer Table { highp uint table[]; };
layout(location = 0) out vec4 colour;

#define NOISEFLOOR_TABLE(i) table[i]
#include "noisefloor_sampler.h"

void main()
{
    nfs s = nfs_domain(nfs_pixel(uint(gl_FragCoord.x), uint(gl_FragCoord.y), 0u, 1u), 7u);
    nfs_floats u = nfs_draw4(s);
    colour = vec4(u.x, u.y, u.z, u.w);
}
