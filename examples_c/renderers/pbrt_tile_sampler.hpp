// A sampler for pbrt-v4 that draws from a tile.
#pragma once

#include "pbrt_interface.hpp"

namespace pbrt {

class TileSampler {
public:
    // The tile must outlive the sampler and stay where it is. `frame` counts the images of an animation.
    TileSampler(const nf_tile *tile, int samplesPerPixel, int frame = 0)
        : tile_(tile), samplesPerPixel_(samplesPerPixel), frame_(static_cast<uint32_t>(frame))
    {
    }

    static constexpr const char *Name() { return "TileSampler"; }
    int SamplesPerPixel() const { return samplesPerPixel_; }

    void StartPixelSample(Point2i p, int sampleIndex, int dim)
    {
        pixel_ = nf_tile_sampler_pixel(tile_, static_cast<uint32_t>(p.x), static_cast<uint32_t>(p.y), frame_,
                                  static_cast<uint32_t>(sampleIndex));
        dimension_ = static_cast<uint32_t>(dim);
    }

    // pbrt counts dimensions. Each request has the count as the key of a domain of its own.
    Float Get1D()
    {
        Float u;
        nf_tile_sampler_draw(nf_tile_sampler_domain(pixel_, dimension_), 1, &u);
        dimension_ += 1;
        return u;
    }
    Point2f Get2D()
    {
        Float u[2];
        nf_tile_sampler_draw(nf_tile_sampler_domain(pixel_, dimension_), 2, u);
        dimension_ += 2;
        return {u[0], u[1]};
    }
    // Not counted in pbrt: the root of the domains, which is the tile in its own place.
    Point2f GetPixel2D()
    {
        Float u[2];
        nf_tile_sampler_draw(pixel_, 2, u);
        return {u[0], u[1]};
    }

    // A copy for each thread; they share the tile, which none of them writes.
    std::vector<TileSampler> Clone(int n) const { return std::vector<TileSampler>(static_cast<size_t>(n), *this); }

    // What the request at a count of dimensions was, or will be, answered with.
    nf_tile_sampler Request(Point2i p, uint32_t dimension) const
    {
        return nf_tile_sampler_domain(
            nf_tile_sampler_pixel(tile_, static_cast<uint32_t>(p.x), static_cast<uint32_t>(p.y), frame_, 0), dimension);
    }

private:
    const nf_tile *tile_;
    int samplesPerPixel_;
    uint32_t frame_;
    nf_tile_sampler pixel_{};
    uint32_t dimension_ = 0;
};

} // namespace pbrt
