// Embree's intersector against the path tracer's own: the same surfaces, hit by hit, on random rays through triangles and
// spheres that stand still and that move.
#include "embree.hpp"
#include "load.hpp"
#include "shapes.hpp"

#include "pathtracer/bvh.hpp"
#include "pathtracer/random.hpp"
#include <cstdio>

namespace {

using demo::Vector;

struct Numbers {
    uint64_t counter;
    float operator()(float low, float high) { return low + (high - low) * demo::unit(static_cast<uint32_t>(demo::mix(counter += demo::golden))); }
    Vector vector(float low, float high) { return {(*this)(low, high), (*this)(low, high), (*this)(low, high)}; }
};

void put(demo::Geometry &geometry, const harness::Mesh &mesh, uint32_t material, Vector motion)
{
    for (const harness::Facet &f : mesh.facets)
        geometry.triangles.push_back({{f.corner[0], f.corner[1], f.corner[2]}, {f.normal[0], f.normal[1], f.normal[2]}, material, -1, motion});
}

demo::Geometry geometry(Numbers &numbers)
{
    demo::Geometry geometry;
    put(geometry, harness::shipped("bunny.ply"), 0, {});
    put(geometry, harness::move({1.2f, 0, 0}) * harness::shipped("teapot.ply"), 1, {.3f, .1f, -.2f});
    put(geometry, harness::move({0, -1.5f, 0}) * harness::box({3, 1, 3}, .2f), 2, {});
    for (uint32_t i = 0; i < 2000; ++i) {
        demo::Triangle t{{}, {}, 3 + i, static_cast<int32_t>(i % 5) - 1, i % 2 ? numbers.vector(-.2f, .2f) : Vector{}};
        Vector center = numbers.vector(-2, 2);
        for (Vector &corner : t.corner)
            corner = center + numbers.vector(-.15f, .15f);
        for (Vector &normal : t.normal)
            normal = demo::normalize(demo::cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0]) + numbers.vector(-1e-3f, 1e-3f));
        geometry.triangles.push_back(t);
    }
    for (uint32_t i = 0; i < 200; ++i)
        geometry.spheres.push_back({numbers.vector(-2, 2), numbers(.02f, .3f), i % 2 ? numbers.vector(-.3f, .3f) : Vector{}, 5000 + i, -1});
    return geometry;
}

float difference(Vector a, Vector b) { return demo::length(a - b); }

} // namespace

int main()
{
    try {
        Numbers numbers{7};
        const demo::Geometry scene = geometry(numbers);
        const demo::Bvh own(scene);
        const harness::EmbreeIntersector embree(scene);
        // Where a ray grazes an edge or a silhouette, rounding decides which surface it meets.
        const int rays = 400000, graze = rays / 5000;
        int hits = 0, other_surface = 0, far = 0, other_normal = 0, other_shadow = 0, shadows = 0;
        for (int i = 0; i < rays; ++i) {
            demo::Ray ray{numbers.vector(-3, 3), demo::normalize(numbers.vector(-1, 1) + Vector{1e-6f, 0, 0}), numbers(0, 1)};
            demo::Hit a, b;
            bool found = own.closest(ray, a);
            if (found != embree.closest(ray, b) || (found && (a.material != b.material || a.light != b.light))) {
                ++other_surface;
            } else if (found) {
                ++hits;
                // A grazing ray's distance is as uncertain as its angle is flat.
                float slope = std::max(1e-3f, std::abs(demo::dot(a.geometric, ray.direction)));
                far += std::abs(a.distance - b.distance) * slope > 1e-5f;
                other_normal += (difference(a.geometric, b.geometric) + difference(a.shading, b.shading)) * slope > 1e-3f;
            }
            float distance = numbers(0, 3);
            bool hidden = own.occluded(ray, distance);
            shadows += hidden;
            other_shadow += hidden != embree.occluded(ray, distance);
        }
        std::printf("%d rays, %d hits: %d meet another surface, %d at another distance, %d with another normal; %d shadows, %d other\n", rays, hits,
                    other_surface, far, other_normal, shadows, other_shadow);
        if (hits < rays / 4 || shadows < rays / 10)
            throw std::runtime_error("too few rays hit anything");
        if (other_surface > graze || far > graze || other_normal > graze || other_shadow > graze)
            throw std::runtime_error("Embree and the path tracer's own tree differ in more than " + std::to_string(graze) + " rays");
        return 0;
    } catch (const std::exception &error) {
        std::fprintf(stderr, "agreement: %s\n", error.what());
        return 1;
    }
}
