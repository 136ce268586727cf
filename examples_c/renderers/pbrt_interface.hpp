// A stand-in for the parts of pbrt-v4 that a sampler meets: the same names and calling order, none of its code. In pbrt
// the class pbrt::Sampler passes calls on to one of a list of types; here integrators are templates over the type.
#pragma once

#include "noisefloor.h"
#include "room.hpp"

namespace pbrt {

using Float = float;
struct Point2i {
    int x, y;
};
struct Point2f {
    Float x, y;
};
struct CameraSample {
    Point2f pFilm, pLens;
    Float time;
};

// pbrt's film keeps sums; this one every sample, which is what estimators need.
class Film {
public:
    Film(Point2i resolution, int spp)
        : resolution_(resolution), spp_(spp), values_(index({0, resolution.y}, 0))
    {
    }
    Point2i FullResolution() const { return resolution_; }
    void AddSample(Point2i p, int sampleIndex, Float value)
    {
        values_[index(p, sampleIndex)] = value;
    }
    const std::vector<Float> &Values() const { return values_; }

private:
    // Images of many samples have more than an int counts.
    size_t index(Point2i p, int sampleIndex) const
    {
        const size_t row = static_cast<size_t>(p.y), width = static_cast<size_t>(resolution_.x);
        return (row * width + static_cast<size_t>(p.x)) * static_cast<size_t>(spp_) + static_cast<size_t>(sampleIndex);
    }

    Point2i resolution_;
    int spp_;
    std::vector<Float> values_;
};

// The order in which pbrt asks for a camera sample's numbers: film, time, lens.
template <class Sampler> CameraSample GetCameraSample(Sampler &sampler, Point2i pixel)
{
    CameraSample sample{};
    const Point2f film = sampler.GetPixel2D();
    sample.pFilm = {static_cast<Float>(pixel.x) + film.x, static_cast<Float>(pixel.y) + film.y};
    sample.time = sampler.Get1D();
    sample.pLens = sampler.Get2D();
    return sample;
}

// Light sampling at the first hit: which light, then where on it.
template <class Sampler> Float Li(const room::Hit &hit, Sampler &sampler)
{
    const Float choice = sampler.Get1D();
    const Point2f uLight = sampler.Get2D();
    const int lamp = static_cast<int>(choice * room::lamps);
    return room::direct_light(hit, lamp, uLight.x, uLight.y);
}

template <class Sampler> void EvaluatePixelSample(Point2i pPixel, int sampleIndex, Sampler &sampler, Film &film)
{
    sampler.Get1D(); // wavelengths
    const CameraSample camera = GetCameraSample(sampler, pPixel);
    const Point2i resolution = film.FullResolution();
    const room::Hit hit = room::camera_ray(camera.pFilm.x / static_cast<Float>(resolution.x),
                                           camera.pFilm.y / static_cast<Float>(resolution.y));
    film.AddSample(pPixel, sampleIndex, Li(hit, sampler));
}

// ImageTileIntegrator: pixels in any order, by several threads, each with a clone.
template <class Sampler> Film Render(Point2i resolution, Sampler sampler)
{
    Film film(resolution, sampler.SamplesPerPixel());
    for (int y = 0; y < resolution.y; ++y)
        for (int x = 0; x < resolution.x; ++x)
            for (int sampleIndex = 0; sampleIndex < sampler.SamplesPerPixel(); ++sampleIndex) {
                sampler.StartPixelSample({x, y}, sampleIndex, 0);
                EvaluatePixelSample({x, y}, sampleIndex, sampler, film);
            }
    return film;
}

class IndependentSampler {
public:
    explicit IndependentSampler(int samplesPerPixel) : samplesPerPixel_(samplesPerPixel) {}
    int SamplesPerPixel() const { return samplesPerPixel_; }
    void StartPixelSample(Point2i p, int sampleIndex, int dim)
    {
        const auto part = [](int value, int shift) {
            return static_cast<uint64_t>(static_cast<uint32_t>(value)) << shift;
        };
        nf_rng_seed(&rng_, part(p.x, 48) ^ part(p.y, 32) ^ part(sampleIndex, 8) ^ part(dim, 0));
    }
    Float Get1D() { return nf_rng_uniform(&rng_); }
    Point2f Get2D()
    {
        const Float x = Get1D();
        return {x, Get1D()};
    }
    Point2f GetPixel2D() { return Get2D(); }

private:
    int samplesPerPixel_;
    nf_rng rng_{};
};

} // namespace pbrt
