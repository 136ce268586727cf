// A stand-in for the parts of Mitsuba 3 that a sampler meets, in a scalar variant: the same names and calling order,
// none of its code.
#pragma once

#include "noisefloor.h"
#include "room.hpp"
#include <memory>

namespace mitsuba {

using Float = float;
using Mask = bool;
template <class T> using ref = std::shared_ptr<T>;
struct Point2f {
    Float x, y;
};
struct Point2u {
    uint32_t x, y;
};

class Sampler {
public:
    explicit Sampler(uint32_t sample_count) : m_sample_count(sample_count) {}
    virtual ~Sampler() = default;
    virtual ref<Sampler> fork() = 0;
    virtual ref<Sampler> clone() = 0;
    virtual void seed(uint32_t seed, uint32_t wavefront_size = static_cast<uint32_t>(-1)) = 0;
    virtual void advance() = 0;
    virtual Float next_1d(Mask active = true) = 0;
    virtual Point2f next_2d(Mask active = true) = 0;
    uint32_t sample_count() const { return m_sample_count; }

protected:
    uint32_t m_sample_count;
};

class IndependentSampler : public Sampler {
public:
    using Sampler::Sampler;
    ref<Sampler> fork() override { return std::make_shared<IndependentSampler>(m_sample_count); }
    ref<Sampler> clone() override { return std::make_shared<IndependentSampler>(*this); }
    void seed(uint32_t seed, uint32_t) override { nf_rng_seed(&m_rng, seed); }
    void advance() override {}
    Float next_1d(Mask) override { return nf_rng_uniform(&m_rng); }
    Point2f next_2d(Mask) override
    {
        const Float x = nf_rng_uniform(&m_rng);
        return {x, nf_rng_uniform(&m_rng)};
    }

private:
    nf_rng m_rng{};
};

// Light sampling at the first hit. Mitsuba asks for two numbers; the first chooses the emitter, and what is left of it
// is used again.
inline Float sample(const room::Hit &hit, Sampler &sampler)
{
    const Point2f u = sampler.next_2d();
    const Float scaled = u.x * static_cast<Float>(room::lamps);
    const int lamp = static_cast<int>(scaled);
    return room::direct_light(hit, lamp, scaled - static_cast<Float>(lamp), u.y);
}

// SamplingIntegrator::render_sample: the film's two numbers, (aperture, time, wavelengths: not in this scene and
// variant,) then the integrator's.
inline Float render_sample(Sampler &sampler, Point2u pos, Point2u film_size)
{
    const Point2f offset = sampler.next_2d();
    return sample(room::camera_ray((static_cast<Float>(pos.x) + offset.x) / static_cast<Float>(film_size.x),
                                   (static_cast<Float>(pos.y) + offset.y) / static_cast<Float>(film_size.y)),
                  sampler);
}

// Stands for SamplingIntegrator::render_block over the whole film. `pass` counts renderings: Mitsuba's own seed is such
// a number times the film's pixels. Unlike in Mitsuba a pixel's seed adds its place in the film, not that in a block.
// `store(pixel, sample, value)` stands for the image block.
template <class Store> void render(Sampler &sampler, Point2u film_size, uint32_t pass, const Store &store)
{
    for (uint32_t y = 0; y < film_size.y; ++y)
        for (uint32_t x = 0; x < film_size.x; ++x) {
            const uint32_t pixel = y * film_size.x + x;
            sampler.seed(pass * film_size.x * film_size.y + pixel);
            for (uint32_t j = 0; j < sampler.sample_count(); ++j) {
                store(pixel, j, render_sample(sampler, {x, y}, film_size));
                sampler.advance();
            }
        }
}

} // namespace mitsuba
