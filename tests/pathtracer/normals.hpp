// The normals that an intersector reports, against those of the surface that it met: computed from the geometry, in
// double precision.
#pragma once

#include "../../examples_c/pathtracer/intersector.hpp"
#include "../../examples_c/pathtracer/random.hpp"
#include <algorithm>
#include <cmath>

namespace test {

// In double precision.
struct Wide {
    double x, y, z;

    Wide(double x, double y, double z) : x(x), y(y), z(z) {}
    Wide(demo::Vector v) : x(v.x), y(v.y), z(v.z) {}
};
inline Wide operator+(Wide a, Wide b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Wide operator-(Wide a, Wide b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Wide operator*(double s, Wide v) { return {s * v.x, s * v.y, s * v.z}; }
inline double dot(Wide a, Wide b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Wide cross(Wide a, Wide b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline double length(Wide v) { return std::sqrt(dot(v, v)); }
inline Wide normalize(Wide v) { return 1 / length(v) * v; }

// What a ray meets, and how flat: 1 is straight on.
struct Surface {
    Wide geometric, shading;
    double slope;
};

// Normals are by the order of the corners, whichever side the ray comes from.
inline Surface surface(const demo::Triangle &t, const demo::Ray &ray)
{
    const Wide first = Wide(t.corner[0]) + ray.time * Wide(t.motion);
    const Wide a = Wide(t.corner[1]) - t.corner[0], b = Wide(t.corner[2]) - t.corner[0];
    const Wide normal = cross(a, b), direction(ray.direction), from = Wide(ray.origin) - first;
    // Cramer's rule for from + distance direction = b1 a + b2 b.
    const double below = dot(direction, normal);
    const double b1 = dot(direction, cross(from, b)) / below, b2 = dot(direction, cross(a, from)) / below;
    const Wide shading = (1 - b1 - b2) * Wide(t.normal[0]) + b1 * Wide(t.normal[1]) + b2 * Wide(t.normal[2]);
    return {normalize(normal), normalize(shading), std::abs(below) / length(normal)};
}

// Normals point outwards, from within, too.
inline Surface surface(const demo::Sphere &s, const demo::Ray &ray)
{
    const Wide direction = normalize(Wide(ray.direction)),
               from = Wide(ray.origin) - (Wide(s.center) + ray.time * Wide(s.motion));
    const double middle = -dot(from, direction), radius = s.radius;
    const double half = std::sqrt(std::max(0.0, radius * radius - dot(from, from) + middle * middle));
    const Wide normal = 1 / radius * (from + (middle > half ? middle - half : middle + half) * direction);
    return {normal, normal, half / radius};
}

struct Normals {
    size_t triangles = 0, spheres = 0;
    size_t inside = 0, behind = 0; // of spheres met from within, of triangles met from the back
    double worst = 0;              // the largest distance of a normal from the surface's

    // The materials of the geometry are the numbers of its triangles, then of its spheres.
    void add(const demo::Intersector &intersector, const demo::Geometry &geometry, const demo::Ray &ray)
    {
        demo::Hit hit;
        if (!intersector.closest(ray, hit))
            return;
        const bool flat = hit.material < geometry.triangles.size();
        const Surface met = flat ? surface(geometry.triangles[hit.material], ray)
                                 : surface(geometry.spheres[hit.material - geometry.triangles.size()], ray);
        // Where a ray grazes a surface, the place that it meets is uncertain.
        if (met.slope < 0.1)
            return;
        (flat ? triangles : spheres) += 1;
        if (dot(met.geometric, ray.direction) > 0)
            (flat ? behind : inside) += 1;
        worst = std::max({worst, length(met.geometric - hit.geometric), length(met.shading - hit.shading)});
    }
};

// Triangles with uneven shading normals and spheres, half of them moving; rays from within all over, and from outside.
inline Normals normals_of_jumble(const demo::Geometry &geometry, const demo::Intersector &intersector)
{
    demo::SplitMix random(6);
    auto vector = [&](float size) {
        float x = random(-size, size), y = random(-size, size);
        return demo::Vector{x, y, random(-size, size)};
    };
    Normals normals;
    for (int i = 0; i < 100000; ++i) {
        demo::Vector origin = vector(i % 2 ? 2.0f : 4.0f);
        normals.add(intersector, geometry, {origin, demo::normalize(vector(2) - origin), random(0, 1)});
    }
    return normals;
}

inline demo::Geometry jumble_of_normals()
{
    demo::SplitMix random(5);
    auto vector = [&](float size) {
        float x = random(-size, size), y = random(-size, size);
        return demo::Vector{x, y, random(-size, size)};
    };
    demo::Geometry geometry;
    for (uint32_t i = 0; i < 400; ++i) {
        demo::Triangle t{{}, {}, i, -1, i % 2 ? vector(.3f) : demo::Vector{}};
        const demo::Vector center = vector(2);
        for (demo::Vector &corner : t.corner)
            corner = center + vector(.3f);
        const demo::Vector flat = demo::normalize(cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0]));
        for (demo::Vector &normal : t.normal)
            normal = demo::normalize(flat + vector(.3f));
        geometry.triangles.push_back(t);
    }
    for (uint32_t i = 0; i < 100; ++i)
        geometry.spheres.push_back({vector(2), random(.1f, .4f), i % 2 ? vector(.3f) : demo::Vector{}, 400 + i, -1});
    return geometry;
}

} // namespace test
