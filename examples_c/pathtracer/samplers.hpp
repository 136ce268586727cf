// Where sample points come from. To see how a renderer draws from noisefloor, read DefaultSampler in tile_sampler.hpp.
#pragma once

#include "integrand.hpp"
#include "sobol.hpp"
#include <stdexcept>
#include <vector>

namespace demo {

// Threads share one sampler: it holds nothing that changes.
struct Sampler {
    virtual ~Sampler() = default;
    // All points of a pixel at once.
    // u: a row of the integrand's dims numbers in [0, 1) for each sample of pixel (x, y).
    virtual void points(uint32_t x, uint32_t y, float *u) const = 0;
    // `count` of them from number `first` on, for passes over the image: the same numbers. Not every sampler can.
    virtual void range(uint32_t, uint32_t, uint32_t, uint32_t, float *) const
    {
        throw std::runtime_error(
            "this sampler makes all samples of a pixel at once, and none for passes over the image");
    }
};

// What is to be sampled, and what else the points depend on.
struct SamplerSetup {
    std::vector<Domain> domains;
    uint32_t dims;
    uint32_t samples; // per pixel
    uint32_t frame;
    uint64_t seed;
    bool scramble = false; // tile and default: values scrambled by the seed, exactly unbiased, and not as good
};

// Neighbouring domains that are sampled as one: they have at most `limit` dimensions together, or are a single domain.
struct Group {
    Domain first;
    uint32_t dims;
};

inline std::vector<Group> group(const std::vector<Domain> &domains, uint32_t limit)
{
    std::vector<Group> groups;
    for (const Domain &domain : domains) {
        if (!groups.empty() && groups.back().dims + domain.dims <= limit)
            groups.back().dims += domain.dims;
        else
            groups.push_back({domain, domain.dims});
    }
    return groups;
}

// What one function makes from a pixel's key.
template <void (*make_points)(uint64_t key, size_t first, size_t n, uint32_t dims, float *u)>
class KeyedSampler final : public Sampler {
public:
    explicit KeyedSampler(const SamplerSetup &setup) : setup_(setup) {}

    void points(uint32_t x, uint32_t y, float *u) const override
    {
        range(x, y, 0, setup_.samples, u);
    }
    void range(uint32_t x, uint32_t y, uint32_t first, uint32_t count, float *u) const override
    {
        make_points(pixel_key(setup_.seed, setup_.frame, x, y), first, count, setup_.dims, u);
    }

private:
    SamplerSetup setup_;
};

using RandomSampler = KeyedSampler<random_points>;   // independent uniform points
using LatticeSampler = KeyedSampler<lattice_points>; // for references only

// Owen-scrambled Sobol points, scrambled anew in each pixel. Groups of up to four dimensions are paired in a random
// order ("padding").
class SobolSampler final : public Sampler {
public:
    explicit SobolSampler(const SamplerSetup &setup) : setup_(setup), groups_(group(setup.domains, sobol_dims))
    {
        while (levels_ < 32 && uint64_t{1} << levels_ < setup.samples)
            ++levels_;
    }

    void points(uint32_t x, uint32_t y, float *u) const override { range(x, y, 0, setup_.samples, u); }
    void range(uint32_t x, uint32_t y, uint32_t first, uint32_t count, float *u) const override
    {
        uint64_t key = pixel_key(setup_.seed, setup_.frame, x, y);
        for (const Group &g : groups_) {
            Tree order(key += golden), trees[sobol_dims];
            for (uint32_t d = 0; d < g.dims; ++d)
                trees[d] = Tree(key += golden);
            for (uint32_t i = 0; i < count; ++i) {
                uint32_t index = shuffle(first + i, levels_, order);
                for (uint32_t d = 0; d < g.dims; ++d)
                    u[size_t{i} * setup_.dims + d] = unit(scramble(sobol_.digits(index, d), levels_, trees[d]));
            }
            u += g.dims;
        }
    }

private:
    SamplerSetup setup_;
    std::vector<Group> groups_;
    Sobol sobol_;
    uint32_t levels_ = 0; // of the trees: 2^levels_ points or fewer
};

} // namespace demo
