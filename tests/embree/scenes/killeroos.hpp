// Figure 4.4, top: beasts before a backdrop, one of them leaping during the exposure, under one spherical light.
#pragma once

#include "../figures.hpp"
#include "../stage.hpp"

namespace harness {

// A floor that bends up into a wall behind z = -depth.
inline Mesh backdrop(float width, float front, float depth, float height, float bend)
{
    Surface surface;
    auto row = [&](float y, float z) {
        surface.points.push_back({-width, y, z});
        surface.points.push_back({width, y, z});
    };
    row(0, front);
    for (int i = 0; i <= 24; ++i) {
        float angle = demo::pi / 2 * static_cast<float>(i) / 24;
        row(bend * (1 - std::cos(angle)), -depth - bend * std::sin(angle));
    }
    row(height, -depth - bend);
    for (size_t i = 0; i + 3 < surface.points.size(); i += 2)
        surface.quad(i, i + 1, i + 3, i + 2);
    return smooth(surface, 60);
}

inline void make_killeroos(uint32_t, float aspect, Scene &scene)
{
    Stage stage(scene);
    scene.layout.time = true;
    scene.camera.look({.25f, 1.25f, 4.4f}, {.02f, .62f, 0}, 33, aspect);
    stage.put(backdrop(8, 6, 1.2f, 5, 1.4f), stage.material({.62f, .57f, .5f}));
    const Mesh beast = leaper();
    const uint32_t hide = stage.material({.42f, .25f, .13f}, {.12f, .11f, .1f}, 25),
                   steel = stage.material({.16f, .28f, .42f}, {.2f, .22f, .25f}, 40);
    stage.put(beast, hide, move({-.72f, 0, .15f}) * turn_up(-28));
    stage.put(beast, steel, move({.62f, .22f, -.1f}) * turn_up(208) * turn({0, 0, 1}, 9), {-.07f, .06f, .02f});
    stage.put(beast, stage.material({.5f, .46f, .36f}), move({.15f, 0, -1.25f}) * turn_up(-70) * scale(.8f));
    stage.sphere({-.02f, 1.28f, .25f}, .11f, stage.material({.6f, .12f, .08f}, {.25f, .25f, .25f}, 60),
                 {.13f, .09f, 0});
    stage.sphere({-.35f, .09f, .95f}, .09f, stage.material({.15f, .4f, .2f}, {.25f, .25f, .25f}, 60), {.1f, 0, .03f});
    stage.sphere_light({-1.3f, 3.1f, 2.6f}, .45f, {76, 71, 62});
}

} // namespace harness
