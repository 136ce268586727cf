// A scene: geometry, materials, lights and a pinhole camera, and how its integrand uses the sample vector.
#pragma once

#include "intersector.hpp"
#include "light.hpp"
#include "material.hpp"

namespace demo {

struct Camera {
    Vector eye, forward, right, up; // right and up span the image plane at distance 1

    // `field` is the vertical field of view in degrees.
    void look(Vector from, Vector at, float field, float aspect)
    {
        eye = from;
        forward = normalize(at - from);
        float height = std::tan(field * pi / 360);
        right = normalize(cross(forward, {0, 1, 0})) * (height * aspect);
        up = normalize(cross(right, forward)) * height;
    }
    // x and y in [0, 1], from the top left.
    Ray ray(float x, float y, float time) const
    {
        return {eye, normalize(forward + (2 * x - 1) * right + (1 - 2 * y) * up), time};
    }
};

// Which numbers of the sample vector mean what. `direct`: u, v on the only light. `motion`: time, u, v.
// `lights`: u, v, and which light. `global`: per bounce u, v, which light, and two for the next direction.
enum class Layout { direct, motion, lights, global };

constexpr uint32_t bounces = 3, dims_per_bounce = 5;

struct Scene {
    Layout layout = Layout::direct;
    Geometry geometry;
    std::vector<Material> materials;
    std::vector<Light> lights;
    Camera camera;

    uint32_t dims() const
    {
        switch (layout) {
        case Layout::direct: return 2;
        case Layout::motion:
        case Layout::lights: return 3;
        case Layout::global: return bounces * dims_per_bounce;
        }
        return 0;
    }
};

} // namespace demo
