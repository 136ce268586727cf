// What the renderer asks of a ray tracer, and the geometry that it offers. Implement Intersector to use another one
// (Embree, a GPU): the renderer, scenes, lights and estimators need nothing else.
#pragma once

#include "vector.hpp"
#include <cstdint>
#include <vector>

namespace demo {

// Like spheres, triangles move on a line: what is said of their places holds at time 0, and at time t in [0, 1] they
// are t * motion further. Lights do not move.
struct Triangle {
    Vector corner[3];
    Vector normal[3]; // unit shading normals at the corners, interpolated
    uint32_t material;
    int32_t light; // index into the scene's lights, or -1
    Vector motion = {};
};

struct Sphere {
    Vector center;
    float radius;
    Vector motion;
    uint32_t material;
    int32_t light;
};

struct Geometry {
    std::vector<Triangle> triangles;
    std::vector<Sphere> spheres;
};

struct Ray {
    Vector origin, direction; // unit direction
    float time;
};

struct Hit {
    float distance;
    Vector geometric; // unit; outwards for spheres, by the corners' order for triangles
    Vector shading;   // unit, interpolated
    uint32_t material;
    int32_t light;
};

// What a triangle's point shows; b1 and b2 are its barycentric coordinates of the second and the third corner.
inline void describe(const Triangle &t, float b1, float b2, Hit &hit)
{
    hit.geometric = normalize(cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0]));
    hit.shading = normalize((1 - b1 - b2) * t.normal[0] + b1 * t.normal[1] + b2 * t.normal[2]);
    hit.material = t.material;
    hit.light = t.light;
}

// What the point of a sphere shows that the ray meets at hit.distance. Not divided by the radius: the distance is
// rounded, and beside a small sphere far away much so.
inline void describe(const Sphere &s, const Ray &ray, Hit &hit)
{
    Vector point = ray.origin + hit.distance * ray.direction;
    hit.geometric = hit.shading = normalize(point - (s.center + ray.time * s.motion));
    hit.material = s.material;
    hit.light = s.light;
}

struct Intersector {
    virtual ~Intersector() = default;
    // The nearest surface; false if there is none, and `hit` is then undefined.
    virtual bool closest(const Ray &ray, Hit &hit) const = 0;
    // Whether any surface is nearer than `distance`.
    virtual bool occluded(const Ray &ray, float distance) const = 0;
};

} // namespace demo
