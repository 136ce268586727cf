// A scene: geometry, materials, lights and a camera, and how its integrand uses the sample vector.
#pragma once

#include "camera.hpp"
#include "integrand.hpp"
#include "light.hpp"
#include "material.hpp"
#include <functional>
#include <string>

namespace demo {

// What the sample vector decides, in this order: the point in the pixel's footprint (2), the time (1), the point on the
// lens (2); then for every vertex of a path the point on a light (2), which light (1), and for paths the next direction
// (2).
struct Layout {
    bool footprint = false; // the command line decides: --filter
    bool time = false, lens = false;
    bool choice = false;  // among the scene's lights, which must otherwise be one
    uint32_t bounces = 0; // reflections of a path; 0: direct light alone, by next event estimation
    bool roulette =
        false; // paths go on beyond that by Russian roulette, with numbers that are not in the sample vector

    uint32_t head() const { return (footprint ? 2u : 0u) + (time ? 1u : 0u) + (lens ? 2u : 0u); }
    uint32_t dims_per_bounce() const { return 2u + (choice ? 1u : 0u) + (bounces > 0 ? 2u : 0u); }

    std::vector<Domain> domains() const
    {
        std::vector<Domain> all;
        if (footprint)
            all.push_back({Domain::footprint, 0, 2});
        if (time)
            all.push_back({Domain::time, 0, 1});
        if (lens)
            all.push_back({Domain::lens, 0, 2});
        for (uint32_t bounce = 0; bounce < std::max(bounces, 1u); ++bounce) {
            all.push_back({Domain::light, bounce, 2});
            if (choice)
                all.push_back({Domain::choice, bounce, 1});
            if (bounces > 0)
                all.push_back({Domain::direction, bounce, 2});
        }
        return all;
    }
};

struct Scene {
    Layout layout;
    Geometry geometry;
    std::vector<Material> materials;
    std::vector<Light> lights;
    Camera camera;

    // The light that rays see which meet nothing; null if they see black.
    const Light *environment() const
    {
        for (const Light &light : lights)
            if (light.kind == Light::environment)
                return &light;
        return nullptr;
    }
};

// A scene that the command line knows by its name.
struct SceneEntry {
    std::string name, description;
    // Fills an empty scene, as it is in a frame of its animation. `aspect`: the image's width over its height.
    std::function<void(uint32_t frame, float aspect, Scene &scene)> build;
};

// A function that makes an intersector for a geometry, which will outlive it.
using MakeIntersector = std::function<std::unique_ptr<Intersector>(const Geometry &)>;

// What a program around the renderer consists of: its scenes, and the ray tracer that it renders them with.
struct Program {
    std::string name; // as its messages say it
    std::vector<SceneEntry> scenes; // at least one
    MakeIntersector make_intersector;
};

} // namespace demo
