// Figure 4.15: a diffuse plane under 1, 4, 16 or 64 lights, one of which is picked at random. All together are equally
// strong.
#pragma once

#include "killeroos.hpp"

namespace harness {

inline void make_plane(uint32_t side, float aspect, Scene &scene)
{
    Stage stage(scene);
    scene.layout.choice = side > 1;
    scene.camera.look({0, .62f, 3.5f}, {0, .16f, 0}, 36, aspect);
    stage.put(backdrop(8, 5, 1.3f, 5, .5f), stage.material({.72f, .7f, .67f}));
    const float step = 2 / static_cast<float>(side), half = .27f * step;
    for (uint32_t j = 0; j < side; ++j)
        for (uint32_t i = 0; i < side; ++i) {
            auto number = [&](uint64_t what) {
                return demo::unit(static_cast<uint32_t>(demo::mix(64 * (i + 8 * j) + side * 8192 + what)));
            };
            const float x = -1 + step * (static_cast<float>(i) + .5f), z = -1 + step * (static_cast<float>(j) + .5f);
            const float y = .95f + (side > 1 ? .2f * number(1) : 0);
            // Each leans a little differently.
            const Transform lean = turn({1, 0, 0}, side > 1 ? 20 * (number(2) - .5f) : 0);
            const Vector right = lean.direction({2 * half, 0, 0}), back = lean.direction({0, 0, 2 * half});
            Color color = side > 1 ? mix({1, .68f, .4f}, {.5f, .75f, 1}, number(3)) : Color{1, .93f, .82f};
            stage.area_light(Vector{x, y, z} - .5f * (right + back), right, back,
                             5.5f * (side > 1 ? .55f + .9f * number(4) : 1.0f) * color);
        }
}

inline demo::SceneEntry plane(uint32_t side)
{
    const uint32_t lights = side * side;
    std::string name = "plane_" + std::to_string(lights);
    return {name,
            lights == 1
                ? "2 dims (figure 4.15): a point on one light over a plane"
                : "3 dims (figure 4.15): a point on one of " + std::to_string(lights) + " lights, which of them",
            [side](uint32_t, float aspect, Scene &scene) { make_plane(side, aspect, scene); }};
}

} // namespace harness
