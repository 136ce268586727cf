// A sampler for pbrt-v4 that draws from noisefloor.
#pragma once

#include "pbrt_interface.hpp"

namespace pbrt {

class NoisefloorSampler {
public:
    // `frame` counts the images of an animation.
    explicit NoisefloorSampler(int samplesPerPixel, int frame = 0)
        : samplesPerPixel_(samplesPerPixel), frame_(static_cast<uint32_t>(frame))
    {
    }

    static constexpr const char *Name() { return "NoisefloorSampler"; }
    int SamplesPerPixel() const { return samplesPerPixel_; }

    void StartPixelSample(Point2i p, int sampleIndex, int dim)
    {
        pixel_ = nf_sampler_pixel(static_cast<uint32_t>(p.x), static_cast<uint32_t>(p.y), frame_,
                                  static_cast<uint32_t>(sampleIndex));
        dimension_ = static_cast<uint32_t>(dim);
    }

    // pbrt counts dimensions. Each request has the count as the key of a domain of its own.
    Float Get1D()
    {
        Float u;
        nf_sampler_draw(nf_sampler_domain(pixel_, dimension_), 1, &u);
        dimension_ += 1;
        return u;
    }
    Point2f Get2D()
    {
        Float u[2];
        nf_sampler_draw(nf_sampler_domain(pixel_, dimension_), 2, u);
        dimension_ += 2;
        return {u[0], u[1]};
    }
    // Not counted in pbrt: the root of the domains.
    Point2f GetPixel2D()
    {
        Float u[2];
        nf_sampler_draw(pixel_, 2, u);
        return {u[0], u[1]};
    }

    // A copy for each thread.
    std::vector<NoisefloorSampler> Clone(int n) const
    {
        return std::vector<NoisefloorSampler>(static_cast<size_t>(n), *this);
    }

    // What the request at a count of dimensions was, or will be, answered with.
    nf_sampler Request(Point2i p, uint32_t dimension) const
    {
        return nf_sampler_domain(
            nf_sampler_pixel(static_cast<uint32_t>(p.x), static_cast<uint32_t>(p.y), frame_, 0), dimension);
    }

private:
    int samplesPerPixel_;
    uint32_t frame_;
    nf_sampler pixel_{};
    uint32_t dimension_ = 0;
};

} // namespace pbrt
