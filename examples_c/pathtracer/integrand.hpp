// The integrand in primary sample space: a pixel's radiance as a function of the sample vector u in [0, 1)^dims,
// divided by the density of what u stands for. Its mean over u is the pixel's value.
//
// All that samplers, estimators and the renderer know of what is rendered. SceneIntegrand is the path tracer's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace demo {

// What consecutive numbers of the sample vector decide. A sampler stratifies the numbers of a domain together; it knows
// nothing else of the scene.
struct Domain {
    enum Kind : uint32_t { light, choice, direction, lens, time, footprint } kind; // choice: which light
    uint32_t bounce, dims;
};

struct Shown; // lobe.hpp: what a camera ray ended at

struct Integrand {
    virtual ~Integrand() = default;
    // In the order of the sample vector.
    virtual std::vector<Domain> domains() const = 0;
    // How many alternatives the domain `choice` picks from; 1 if there is none.
    virtual uint32_t lights() const = 0;
    // Whether each sample traces a camera ray of its own. If not, one ray serves all samples of a pixel that are
    // evaluated together, and the number of the surface comes with it; else that number costs a ray.
    virtual bool camera_ray_per_sample() const = 0;
    // How many numbers a sample's value has: red, green and blue, unless estimators of another kind take more.
    virtual uint32_t values() const { return 3; }
    // The values of n samples of pixel (x, y): u[n * dims] -> f[n * values()]. n may be 0, if only the surface is asked
    // for. *surface, unless null: a number for what the pixel shows. It does not depend on u. *shown, unless null: for
    // each camera ray what it ended at; of integrands that something is known of.
    virtual void evaluate(uint32_t x, uint32_t y, size_t n, const float *u, float *f, uint32_t *surface,
                          Shown *shown) const = 0;
    // Whether something is known of the samples. The first call makes the tables that `known` needs.
    virtual bool has_known() const { return false; }
    // What n samples of a pixel would be with nothing in the way, as far as that is known, and its integral over u; of
    // samples with camera rays of their own, the mean of their integrals. u and shown as for evaluate ->
    // values[n * 3], integral[3].
    virtual void known(size_t, const float *, const Shown *, float *, float *) const {}
};

inline uint32_t dims(const std::vector<Domain> &domains)
{
    uint32_t sum = 0;
    for (const Domain &domain : domains)
        sum += domain.dims;
    return sum;
}

// The first number of the sample vector, counted from 1, that picks a point of a light; 0 if none does.
inline uint32_t light_point(const std::vector<Domain> &domains)
{
    uint32_t sum = 0;
    for (const Domain &domain : domains) {
        if (domain.kind == Domain::light)
            return sum + 1;
        sum += domain.dims;
    }
    return 0;
}

// How many numbers of the sample vector there are up to the first that picks a light; 0 if none does.
inline uint32_t choice(const std::vector<Domain> &domains)
{
    uint32_t sum = 0;
    for (const Domain &domain : domains) {
        sum += domain.dims;
        if (domain.kind == Domain::choice)
            return sum;
    }
    return 0;
}

} // namespace demo
