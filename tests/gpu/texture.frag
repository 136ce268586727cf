#version 400
// noisefloor_sampler.h in the oldest GLSL that has its functions, the table in a texture. Compiled only.
#extension GL_GOOGLE_include_directive : require
layout(location = 0) out vec4 colour;
uniform usampler2D table;

#define NOISEFLOOR_TABLE(i) texelFetch(table, ivec2(i & 255u, i >> 8), 0).x
#include "noisefloor_sampler.h"

void main()
{
    nfs s = nfs_domain(nfs_pixel(uint(gl_FragCoord.x), uint(gl_FragCoord.y), 0u, 1u), 7u);
    nfs_floats u = nfs_draw4(s);
    colour = vec4(u.x, u.y, u.z, u.w);
}
