/* What renderers on GPUs draw four numbers with otherwise, in CUDA: sample `index` of a domain of a pixel. */
#ifndef PEERS_H
#define PEERS_H

#include "../../examples_c/pathtracer/sobol.hpp"

static __constant__ uint32_t sobol_columns[4][32];
/* Of a pixel: a power of two. */
constexpr uint32_t SAMPLES = 256;

static __device__ nfs_floats units(uint32_t x, uint32_t y, uint32_t z, uint32_t w)
{
    const float scale = 1.0f / 16777216.0f;
    return {float(x >> 8) * scale, float(y >> 8) * scale, float(z >> 8) * scale, float(w >> 8) * scale};
}

/* Independent numbers: pcg4d() of M. Jarzynski and M. Olano, "Hash Functions for GPU Rendering", 2020. */
struct Hash {
    __device__ nfs_floats operator()(uint32_t x, uint32_t y, uint32_t index, uint32_t domain) const
    {
        uint32_t v[4] = {x, y, index, domain};
        for (uint32_t &one : v)
            one = one * 1664525u + 1013904223u;
        for (uint32_t turn = 0; turn < 2; ++turn) {
            v[0] += v[1] * v[3], v[1] += v[2] * v[0], v[2] += v[0] * v[1], v[3] += v[1] * v[2];
            if (turn == 0)
                for (uint32_t &one : v)
                    one ^= one >> 16;
        }
        return units(v[0], v[1], v[2], v[3]);
    }
};

static __device__ uint32_t seed_of(uint32_t x, uint32_t y, uint32_t domain)
{
    return nfs_mix((x | y << 16) ^ nfs_mix(domain + 0x9e3779b9u));
}

/* Sobol's points, exclusive-or a hash of the pixel. */
struct SobolXor {
    __device__ nfs_floats operator()(uint32_t x, uint32_t y, uint32_t index, uint32_t domain) const
    {
        const uint32_t seed = seed_of(x, y, domain);
        uint32_t v[4];
        for (uint32_t d = 0; d < 4; ++d)
            v[d] = nfs_mix(seed + d);
        for (uint32_t k = 0; index != 0; index >>= 1, ++k)
            for (uint32_t d = 0; d < 4; ++d)
                v[d] ^= sobol_columns[d][k] & (0u - (index & 1u));
        return units(v[0], v[1], v[2], v[3]);
    }
};

/* Shuffled and scrambled by hashes: B. Burley, "Practical Hash-based Owen Scrambling", 2020. Of a shuffled index only
 * the digits count that samples have.
 */
struct SobolOwen {
    static __device__ uint32_t scramble(uint32_t digits, uint32_t seed)
    {
        uint32_t v = nfs_reverse(digits) + seed;
        v ^= v * 0x6c50b47cu;
        v ^= v * 0xb82f1e52u;
        v ^= v * 0xc7afe638u;
        v ^= v * 0x8d22f6e6u;
        return nfs_reverse(v);
    }
    __device__ nfs_floats operator()(uint32_t x, uint32_t y, uint32_t index, uint32_t domain) const
    {
        const uint32_t seed = seed_of(x, y, domain), order = scramble(index, seed) & (SAMPLES - 1);
        uint32_t v[4] = {0, 0, 0, 0};
#pragma unroll
        for (uint32_t k = 0; SAMPLES >> k > 1; ++k)
#pragma unroll
            for (uint32_t d = 0; d < 4; ++d)
                v[d] ^= sobol_columns[d][k] & (0u - (order >> k & 1u));
        for (uint32_t d = 0; d < 4; ++d)
            v[d] = scramble(v[d], nfs_mix(seed + d));
        return units(v[0], v[1], v[2], v[3]);
    }
};

/* A tile of 128 x 128 pixels as a texture, elsewhere for each domain, shifted by R. Cranley and T. Patterson's rotation
 * for each sample: M. Roberts's R4 sequence.
 */
struct Tile {
    cudaTextureObject_t texture;

    __device__ nfs_floats operator()(uint32_t x, uint32_t y, uint32_t index, uint32_t domain) const
    {
        const uint32_t moved = nfs_mix(domain);
        const float4 at = tex2D<float4>(texture, float((x + moved) & 127u), float((y + (moved >> 8)) & 127u));
        const nfs_floats by = units(index * 0xdb4f0b91u, index * 0xbbe05633u, index * 0xa0f2ec75u, index * 0x89e18285u);
        nfs_floats u = {at.x + by.x, at.y + by.y, at.z + by.z, at.w + by.w};
        u.x -= floorf(u.x), u.y -= floorf(u.y), u.z -= floorf(u.z), u.w -= floorf(u.w);
        return u;
    }
};

#endif
