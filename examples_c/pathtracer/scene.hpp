// A scene: geometry, materials, lights and a camera, and how its integrand uses the sample vector.
#pragma once

#include "intersector.hpp"
#include "light.hpp"
#include "material.hpp"
#include <vector>

namespace demo {

struct Camera {
    Vector eye, forward, right, up; // right and up span the image plane at distance 1
    float aperture = 0;             // radius of the lens; 0: a pinhole
    float focus = 1;                // distance of the plane that is sharp

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
    // The same through a point of the lens, (u, v) in [0, 1)^2, by the concentric map (Shirley and Chiu 1997).
    Ray ray(float x, float y, float u, float v) const
    {
        float a = 2 * u - 1, b = 2 * v - 1;
        bool wide = std::abs(a) > std::abs(b);
        float radius = aperture * (wide ? a : b);
        float angle = wide ? pi / 4 * (b / a) : b != 0 ? pi / 2 - pi / 4 * (a / b) : 0.0f;
        Vector offset = radius * (std::cos(angle) * normalize(right) + std::sin(angle) * normalize(up));
        Vector at = focus * (forward + (2 * x - 1) * right + (1 - 2 * y) * up);
        return {eye + offset, normalize(at - offset), 0};
    }
};

// What consecutive numbers of the sample vector decide. A sampler stratifies the numbers of a domain together; it knows
// nothing else of the scene.
struct Domain {
    enum Kind : uint32_t { light, choice, direction, lens, time } kind; // choice: which light
    uint32_t bounce, dims;
};

// Which domains a scene has; `domains()` lists them.
enum class Layout { direct, motion, lens, lights, global };

constexpr uint32_t bounces = 3, dims_per_bounce = 5;

struct Scene {
    Layout layout = Layout::direct;
    Geometry geometry;
    std::vector<Material> materials;
    std::vector<Light> lights;
    Camera camera;

    // In the order of the sample vector.
    std::vector<Domain> domains() const
    {
        switch (layout) {
        case Layout::direct: return {{Domain::light, 0, 2}};
        case Layout::motion: return {{Domain::time, 0, 1}, {Domain::light, 0, 2}};
        case Layout::lens: return {{Domain::lens, 0, 2}, {Domain::light, 0, 2}};
        case Layout::lights: return {{Domain::light, 0, 2}, {Domain::choice, 0, 1}};
        case Layout::global: break;
        }
        std::vector<Domain> all;
        for (uint32_t bounce = 0; bounce < bounces; ++bounce)
            all.insert(all.end(), {{Domain::light, bounce, 2}, {Domain::choice, bounce, 1}, {Domain::direction, bounce, 2}});
        return all;
    }

    uint32_t dims() const
    {
        uint32_t sum = 0;
        for (const Domain &domain : domains())
            sum += domain.dims;
        return sum;
    }

    // Numbers of the sample vector up to the first that picks a light; 0 if none does.
    uint32_t choice() const
    {
        uint32_t sum = 0;
        for (const Domain &domain : domains()) {
            sum += domain.dims;
            if (domain.kind == Domain::choice)
                return sum;
        }
        return 0;
    }
};

} // namespace demo
