// Sample points by pixel, domain and index, from the path tracer's samplers.
#pragma once

#include "settings.hpp"
#include "vector.hpp"
#include <cmath>
#include <memory>
#include <vector>

namespace noisefloor_povray {

// The centres of a grid's cells: not to be used but to compare with pictures of the lights' points one by one.
class GridSampler final : public demo::Sampler {
public:
    explicit GridSampler(const demo::SamplerSetup &setup)
        : setup_(setup), side_(static_cast<uint32_t>(std::lround(std::sqrt(setup.samples))))
    {
        if (side_ * side_ != setup.samples)
            throw std::runtime_error("NOISEFLOOR_SAMPLER=grid needs a square number of samples, not " +
                                     std::to_string(setup.samples));
    }

    void points(uint32_t, uint32_t, float *u) const override
    {
        auto center = [&](uint32_t i) { return (static_cast<float>(i) + 0.5f) / static_cast<float>(side_); };
        for (uint32_t i = 0; i < setup_.samples; ++i)
            for (uint32_t d = 0; d < setup_.dims; ++d)
                *u++ = center(d % 2 ? i / side_ : i % side_);
    }

private:
    demo::SamplerSetup setup_;
    uint32_t side_;
};

// Numbers first, first + 1, ... of the two-dimensional domains that a pixel has. A renderer's kinds of decisions do not
// matter to a sampler, so a domain is told from others by its number alone.
inline std::unique_ptr<demo::Sampler> make_sampler(const Settings &settings, uint32_t samples, uint32_t first,
                                                   uint32_t count)
{
    demo::SamplerSetup setup{};
    for (uint32_t d = first; d < first + count; ++d)
        setup.domains.push_back({demo::Domain::light, d, 2});
    setup.dims = 2 * count;
    setup.samples = samples;
    setup.frame = settings.seed;
    // Tiles know domains and frames, the others one seed.
    setup.seed = settings.sampler == "tile" ? 1 : demo::mix(demo::golden * (first + 1));
    if (settings.sampler == "grid")
        return std::make_unique<GridSampler>(setup);
    return settings.samplers->make(setup);
}

// Points of one pixel in two-dimensional domains, made when they are asked for: how many light rays a path will need is
// not known before.
class LazyPoints {
public:
    LazyPoints(const Settings &settings, uint32_t samples, uint32_t first)
        : settings_(settings), samples_(samples), first_(first)
    {
    }

    void move_to(uint32_t x, uint32_t y)
    {
        x_ = x;
        y_ = y;
        for (Part &part : parts_)
            part.made = false;
    }

    const float *at(uint32_t domain, uint32_t index)
    {
        while (parts_.size() <= domain) {
            uint32_t number = first_ + static_cast<uint32_t>(parts_.size());
            parts_.push_back(
                {make_sampler(settings_, samples_, number, 1), std::vector<float>(size_t{2} * samples_), false});
        }
        Part &part = parts_[domain];
        if (!part.made)
            part.sampler->points(x_, y_, part.points.data());
        part.made = true;
        return &part.points[size_t{2} * index];
    }

private:
    struct Part {
        std::unique_ptr<demo::Sampler> sampler;
        std::vector<float> points;
        bool made;
    };

    const Settings &settings_;
    uint32_t samples_, first_, x_ = 0, y_ = 0;
    std::vector<Part> parts_;
};

// As the path tracer does, in POV-Ray's type.
inline void concentric_disc(const float u[2], double disc[2])
{
    float x, y;
    demo::concentric_disc(u[0], u[1], x, y);
    disc[0] = static_cast<double>(x);
    disc[1] = static_cast<double>(y);
}

} // namespace noisefloor_povray
