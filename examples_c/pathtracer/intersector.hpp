// What the renderer asks of a ray tracer, and the geometry that it offers. Implement Intersector to use another one
// (Embree, a GPU): the renderer, scenes, lights and estimators need nothing else.
#pragma once

#include "vector.hpp"
#include <cstdint>
#include <vector>

namespace demo {

// Like spheres, triangles move on a line: what is said of their places holds at time 0, and at time t in [0, 1] they are
// t * motion further. Lights do not move.
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

struct Intersector {
    virtual ~Intersector() = default;
    // The nearest surface; false if there is none, and `hit` is then undefined.
    virtual bool closest(const Ray &ray, Hit &hit) const = 0;
    // Whether any surface is nearer than `distance`.
    virtual bool occluded(const Ray &ray, float distance) const = 0;
};

} // namespace demo
