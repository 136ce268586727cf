// Two intersectors on the same rays.
#pragma once

#include "pathtracer/intersector.hpp"
#include "pathtracer/random.hpp"
#include <ctime>
#include <stdexcept>
#include <string>

namespace harness {

using demo::Vector;

// A stream of uniform numbers, and of vectors of them.
struct Numbers : demo::SplitMix {
    using SplitMix::SplitMix;

    Vector vector(float low, float high)
    {
        float x = (*this)(low, high), y = (*this)(low, high);
        return {x, y, (*this)(low, high)};
    }
};

struct Comparison {
    size_t rays = 0, hits = 0, shadows = 0;
    size_t other_surface = 0, other_distance = 0, other_normal = 0, other_shadow = 0;

    // `closest` and `occluded` up to `distance` of one ray.
    void add(const demo::Intersector &own, const demo::Intersector &other, const demo::Ray &ray, float distance)
    {
        demo::Hit a = {}, b = {};
        ++rays;
        bool found = own.closest(ray, a);
        if (found != other.closest(ray, b) || (found && (a.material != b.material || a.light != b.light))) {
            ++other_surface;
        } else if (found) {
            ++hits;
            // A grazing ray's distance is as uncertain as its angle is flat.
            float slope = std::max(1e-3f, std::abs(demo::dot(a.geometric, ray.direction)));
            other_distance += std::abs(a.distance - b.distance) * slope > 1e-5f * std::max(1.0f, a.distance);
            other_normal += (length(a.geometric - b.geometric) + length(a.shading - b.shading)) * slope > 1e-3f;
        }
        bool hidden = own.occluded(ray, distance);
        shadows += hidden;
        other_shadow += hidden != other.occluded(ray, distance);
    }

    // Where a ray grazes an edge or a silhouette, rounding decides which surface it meets: one ray in 5000 may differ
    // in each respect.
    void check(const std::string &what) const
    {
        const size_t graze = rays / 5000;
        if (other_surface > graze || other_distance > graze || other_normal > graze || other_shadow > graze)
            throw std::runtime_error(
                what + ": Embree and the path tracer's own tree differ in more than " + std::to_string(graze) + " of " +
                std::to_string(rays) + " rays: " + std::to_string(other_surface) + " meet another surface, " +
                std::to_string(other_distance) + " at another distance, " + std::to_string(other_normal) +
                " with another normal; " + std::to_string(other_shadow) + " are shadowed differently");
    }
};

// Millions of rays in a second of one core's time.
inline double speed(const demo::Intersector &intersector, const std::vector<demo::Ray> &rays)
{
    const std::clock_t start = std::clock();
    size_t hits = 0;
    demo::Hit hit;
    for (const demo::Ray &ray : rays)
        hits += intersector.closest(ray, hit);
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    return hits > rays.size() ? 0 : 1e-6 * static_cast<double>(rays.size()) / seconds;
}

} // namespace harness
