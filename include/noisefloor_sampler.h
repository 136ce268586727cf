/* noisefloor's default sampler as one source, for C99, C++, CUDA, HIP, OpenCL C, GLSL, HLSL and Metal: the bits of
 * nf_sampler_draw(), inlined, without a library call. MIT OR Apache-2.0.
 *
 * Before it is included, say how an entry of the table is read; the table is nf_sampler_table(), 65,536 numbers of 32
 * bits, as an array, a buffer or a texture:
 *
 *     #define NOISEFLOOR_TABLE(i) table[i]
 *     #include "noisefloor_sampler.h"
 *
 *     nfs s = nfs_domain(nfs_pixel(x, y, 0u, index), LIGHT);
 *     nfs_floats u = nfs_draw2(s);      // u.x, u.y in [0, 1)
 *
 * GPUs read faster what is stored elsewhere for each pixel of a row: store entry i at i ^ (i >> 6 & 63u), and define
 * NOISEFLOOR_TABLE(i) as table[(i) ^ ((i) >> 6 & 63u)].
 *
 * With NFS_BUFFER defined as the type of an entry, `const unsigned` in CUDA say, the table is the last argument of a
 * draw: nfs_draw2(s, table). NOISEFLOOR_TABLE may then use `table`, and without a definition is table[i]. In OpenCL C
 * and Metal, which have no global buffers, it always is: `__global` or `device`. GLSL and HLSL have no pointers.
 * For HLSL by another compiler than DXC, glslang say, define NFS_HLSL. For a table of 2^NFS_SIDE x 2^NFS_SIDE pixels
 * with 2^NFS_BITS entries each (`fsot sampler --size 64` has a side of 6), define these.
 *
 * Functions and arguments are those of noisefloor.h. Drawing twice gives the same numbers; each decision needs a
 * domain. At indices 0 and 1 the numbers of all domains repeat every 32 pixels: seeds of further numbers need the
 * pixel, too. GLSL needs version 400 or ES 310, there with a table of highp uint.
 */
#ifndef NOISEFLOOR_SAMPLER_H
#define NOISEFLOOR_SAMPLER_H

#if defined(NFS_HLSL) || defined(__HLSL_VERSION) || defined(__hlsl_dx_compiler)
#undef NFS_HLSL
#define NFS_HLSL
#define NFS_FUNCTION
#define NFS_REVERSE(a) reversebits(a)
typedef uint nfs_uint;
#elif defined(GL_core_profile) || defined(GL_compatibility_profile) || defined(GL_ES)
#define NFS_GLSL
#define NFS_FUNCTION
#define NFS_REVERSE(a) bitfieldReverse(a)
#define NFS_INSERT(low, high, at, bits) bitfieldInsert(low, high, at, bits)
#define NFS_SIGN(a, k) uint(bitfieldExtract(int(a), k, 1))
#if defined(GL_ES) /* fragment shaders have less by default */
#define nfs_uint highp uint
#define nfs_float highp float
#else
#define nfs_uint uint
#define nfs_float float
#endif
#elif defined(__METAL_VERSION__)
#define NFS_FUNCTION static inline
#define NFS_REVERSE(a) metal::reverse_bits(a)
#if !defined(NFS_BUFFER)
#define NFS_BUFFER device const uint
#endif
typedef uint nfs_uint;
#elif defined(__OPENCL_VERSION__) || defined(__OPENCL_C_VERSION__) || defined(__OPENCL_CPP_VERSION__)
#define NFS_FUNCTION static inline
#if !defined(NFS_BUFFER)
#define NFS_BUFFER __global const uint
#endif
typedef uint nfs_uint;
#elif defined(__CUDACC__) || defined(__HIPCC__)
#define NFS_FUNCTION static inline __host__ __device__
#if defined(__CUDA_ARCH__) || defined(__HIP_DEVICE_COMPILE__)
#define NFS_REVERSE(a) __brev(a)
#endif
typedef unsigned int nfs_uint;
#else
#include <stdint.h>
#define NFS_FUNCTION static inline
#if defined(__clang__)
#define NFS_REVERSE(a) __builtin_bitreverse32(a)
#endif
#define NFS_PASCAL_4(a) (a), (a) ^ 0xff, (a) ^ 0xaa, (a) ^ 0x55
#define NFS_PASCAL_16(a) NFS_PASCAL_4(a), NFS_PASCAL_4(a ^ 0xcc), NFS_PASCAL_4(a ^ 0x88), NFS_PASCAL_4(a ^ 0x44)
#define NFS_PASCAL(a) NFS_PASCAL_16(a), NFS_PASCAL_16(a ^ 0xf0), NFS_PASCAL_16(a ^ 0xa0), NFS_PASCAL_16(a ^ 0x50)
typedef uint32_t nfs_uint;
#endif

/* The low bits up to `at`, above them `bits` of the high ones; and a bit as many times as there is room. */
#if !defined(NFS_INSERT)
#define NFS_INSERT(low, high, at, bits) ((((high) & ((1u << (bits)) - 1u)) << (at)) | ((low) & ((1u << (at)) - 1u)))
#define NFS_SIGN(a, k) (0u - (((a) >> (k)) & 1u))
#define nfs_float float
#endif

#if defined(NFS_BUFFER)
#define NFS_TABLE , NFS_BUFFER *table
#define NFS_GIVEN , table
#else
#define NFS_TABLE
#define NFS_GIVEN
#endif
#if !defined(NOISEFLOOR_TABLE) && defined(NFS_BUFFER)
#define NOISEFLOOR_TABLE(i) table[i]
#elif !defined(NOISEFLOOR_TABLE)
#error "noisefloor_sampler.h: define NOISEFLOOR_TABLE(i), how entry i of the table is read, before it is included"
#endif

#if !defined(NFS_SIDE)
#define NFS_SIDE 5
#endif
#if !defined(NFS_BITS)
#define NFS_BITS 6
#endif

#if defined(__cplusplus) || defined(NFS_HLSL) || defined(NFS_GLSL)
#define NFS_FLOAT(a) float(a)
#else
#define NFS_FLOAT(a) (float)(a)
typedef struct nfs nfs;
typedef struct nfs_floats nfs_floats;
typedef struct nfs_point nfs_point;
#endif

/* One sample of one pixel: 16 bytes. */
struct nfs {
    nfs_uint domain; /* 0 is the root */
    nfs_uint order;  /* the sample's number, its bits reversed */
    nfs_uint place;  /* the pixel's column, its row from bit 16 on */
    nfs_uint flags;  /* 1: scrambled, 2: white */
};

struct nfs_floats {
    nfs_float x, y, z, w;
};

/* A point in 32-bit fixed point; or a place in the table, and its sample's number. */
struct nfs_point {
    nfs_uint x, y, order;
};

NFS_FUNCTION nfs_uint nfs_mix(nfs_uint h)
{
    h = (h ^ (h >> 16)) * 0x85ebca6bu;
    h = (h ^ (h >> 13)) * 0xc2b2ae35u;
    return h ^ (h >> 16);
}

NFS_FUNCTION nfs_uint nfs_child(nfs_uint domain, nfs_uint key)
{
    nfs_uint h = nfs_mix((key * 0x9e3779b9u) ^ domain);
    return h == 0u ? 0x2c9277b5u : h;
}

NFS_FUNCTION nfs_uint nfs_reverse(nfs_uint a)
{
#if defined(NFS_REVERSE)
    return NFS_REVERSE(a);
#else
    a = (a << 16) | (a >> 16);
    a = ((a & 0x00ff00ffu) << 8) | ((a >> 8) & 0x00ff00ffu);
    a = ((a & 0x0f0f0f0fu) << 4) | ((a >> 4) & 0x0f0f0f0fu);
    a = ((a & 0x33333333u) << 2) | ((a >> 2) & 0x33333333u);
    return ((a & 0x55555555u) << 1) | ((a >> 1) & 0x55555555u);
#endif
}

/* Sobol's second dimension at a number whose bits are reversed: Pascal's matrix modulo 2. Of 256 samples by table. */
NFS_FUNCTION nfs_uint nfs_pascal(nfs_uint order)
{
    nfs_uint second = order ^ (order << 16);
#if defined(NFS_PASCAL)
    static const unsigned char byte[256] = {NFS_PASCAL(0), NFS_PASCAL(0xc0), NFS_PASCAL(0x80), NFS_PASCAL(0x40)};
    if ((order & 0x00ffffffu) == 0u) {
        second = byte[order >> 24];
        return second << 24;
    }
#endif
    second ^= (second & 0x00ff00ffu) << 8;
    second ^= (second & 0x0f0f0f0fu) << 4;
    second ^= (second & 0x33333333u) << 2;
    second ^= (second & 0x55555555u) << 1;
    return second;
}

NFS_FUNCTION nfs nfs_pixel(nfs_uint x, nfs_uint y, nfs_uint frame, nfs_uint index)
{
    nfs s;
    s.domain = frame == 0u ? 0u : nfs_child(0x6672616du, frame);
    s.order = nfs_reverse(index);
    s.place = NFS_INSERT(x, y, 16, 16);
    s.flags = 0u;
    return s;
}

NFS_FUNCTION nfs nfs_white(nfs_uint x, nfs_uint y, nfs_uint frame, nfs_uint index)
{
    nfs s = nfs_pixel(x, y, frame, index);
    s.flags = 2u;
    return s;
}

NFS_FUNCTION nfs nfs_domain(nfs s, nfs_uint key)
{
    s.domain = nfs_child(s.domain, key);
    return s;
}

NFS_FUNCTION nfs nfs_scramble(nfs s, nfs_uint seed)
{
    if (seed != 0u) {
        s.domain = nfs_child(s.domain ^ 0x73637261u, seed);
        s.flags |= 1u;
    }
    return s;
}

/* An entry of the table: the only names that NOISEFLOOR_TABLE can meet. */
NFS_FUNCTION nfs_uint nfs_entry(nfs_uint nfs_i NFS_TABLE)
{
    return NOISEFLOOR_TABLE(nfs_i);
}

/* Where in the table the domain's pixel is, of whose x and y the lowest NFS_SIDE bits count, and the domain's order. */
NFS_FUNCTION nfs_point nfs_find(nfs s)
{
    nfs_uint at = (s.flags & 2u) != 0u ? nfs_mix(s.place * 0x9e3779b9u) : s.place;
    nfs_point p;
    p.x = at; /* the row above the column */
    p.y = at >> 16;
    p.order = s.order;
    if (s.domain != 0u) {
        nfs_uint h = s.domain + ((at + s.domain) & 0xfff8fff8u) * 0x2c1b3c6du; /* of 8 x 8 pixels */
        h = (h ^ (h >> 15)) * 0x735a2d97u;
        h ^= h >> 15;
        p.order ^= p.order * (h << 1);
        p.order *= (h >> 15) | 1u;
        if (s.domain > 0x7fffffffu) {
            p.x = p.y;
            p.y = at;
        }
        p.x = (p.x ^ NFS_SIGN(s.domain, 30)) + s.domain;
        p.y = (p.y ^ NFS_SIGN(s.domain, 29)) + (s.domain >> 8);
    }
    return p;
}

/* The point there. */
NFS_FUNCTION nfs_point nfs_pair(nfs_point at NFS_TABLE)
{
    nfs_uint pixel = NFS_INSERT(at.x, at.y, NFS_SIDE, NFS_SIDE); /* in the lowest bits */
    nfs_uint second = nfs_pascal(at.order);
    nfs_point p = at;
    p.x = nfs_entry(NFS_INSERT(at.order >> (32 - (NFS_BITS)), pixel, NFS_BITS, 2 * (NFS_SIDE)) NFS_GIVEN);
    p.y = nfs_entry(NFS_INSERT(second >> (32 - (NFS_BITS)), pixel, NFS_BITS, 2 * (NFS_SIDE)) NFS_GIVEN);
    p.x = at.order ^ (p.x << 16);
    p.y = second ^ (p.y & 0xffff0000u);
    p.x ^= (NFS_INSERT(p.x >> 24, pixel, 8, 2 * (NFS_SIDE)) * 0x9e3779b9u) >> 8;
    p.y ^= (NFS_INSERT(p.y >> 24, pixel, 8, 2 * (NFS_SIDE)) * 0xc13fa9a9u) >> 8;
    return p;
}

/* In [0, 1); scrambled exclusive-or a hash, which keeps nets. */
NFS_FUNCTION nfs_float nfs_unit(nfs s, nfs_uint value, nfs_uint number)
{
    if ((s.flags & 1u) != 0u)
        value ^= nfs_mix(s.domain + 0x9e3779b9u * number);
    return NFS_FLOAT(value >> 8) * (1.0f / 16777216.0f);
}

/* nf_sampler_draw() of 1 or 2 numbers: x and y. */
NFS_FUNCTION nfs_floats nfs_draw2(nfs s NFS_TABLE)
{
    nfs_point p = nfs_pair(nfs_find(s) NFS_GIVEN);
    nfs_floats u;
    u.x = nfs_unit(s, p.x, 1u);
    u.y = nfs_unit(s, p.y, 2u);
    u.z = u.w = 0.0f;
    return u;
}

/* A column of the matrix, if bit k of the index is set. */
#define NFS_COLUMN(k, column) ((0u - ((at.order >> (31 - (k))) & 1u)) & column)
/* nf_sampler_draw() of 3 or 4 numbers. */
NFS_FUNCTION nfs_floats nfs_draw4(nfs s NFS_TABLE)
{
    nfs_point at = nfs_find(s);
    nfs_point p = nfs_pair(at NFS_GIVEN);
    nfs_uint further = at.order & 0x007fffffu;
    nfs_floats u;
    u.x = nfs_unit(s, p.x, 1u);
    u.y = nfs_unit(s, p.y, 2u);
    further ^= further << 6;
    further ^= further << 8;
    further ^= further << 9;
    further ^= further << 10;
    further ^= further << 16;
    at.order = further ^ NFS_COLUMN(0, 0x80000000u) ^ NFS_COLUMN(1, 0x40000000u) ^ NFS_COLUMN(2, 0xa0000000u) ^
            NFS_COLUMN(3, 0xd0000000u) ^ NFS_COLUMN(4, 0x68000000u) ^ NFS_COLUMN(5, 0xfc000000u) ^
            NFS_COLUMN(6, 0x72000000u) ^ NFS_COLUMN(7, 0xab000000u) ^ NFS_COLUMN(8, 0xcb800000u);
    at.x += 11u;
    at.y += 5u;
    p = nfs_pair(at NFS_GIVEN);
    u.z = nfs_unit(s, p.x, 3u);
    u.w = nfs_unit(s, p.y, 4u);
    return u;
}
#undef NFS_COLUMN

#endif
