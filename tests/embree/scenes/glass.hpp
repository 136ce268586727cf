// Smooth glass on a table: paths of three bounces, and on from there by Russian roulette (section 4.3.5).
#pragma once

#include "killeroos.hpp"
#include "../load.hpp"

namespace harness {

inline void make_glass(uint32_t, float aspect, Scene &scene)
{
    Stage stage(scene);
    scene.layout.bounces = 3;
    scene.layout.roulette = true;
    scene.camera.look({.45f, 1.3f, 3.4f}, {.02f, .46f, 0}, 35, aspect);
    stage.put(backdrop(4, 3.5f, 1.3f, 4, .8f), stage.material({.62f, .6f, .56f}));
    const Color paint[3] = {{.6f, .16f, .1f}, {.15f, .4f, .3f}, {.75f, .6f, .25f}};
    for (int i = 0; i < 12; ++i) // a striped cloth, to be seen through the glass
        stage.put(box({.2f, .012f, 1.7f}, .004f, 2), stage.material(i % 2 ? Color{.72f, .7f, .66f} : paint[i / 2 % 3]),
                  move({-1.1f + .2f * static_cast<float>(i), 0, .1f}));
    const uint32_t glass = stage.dielectric(1.5f);
    stage.put(shipped("bunny.ply"), glass, move({-.34f, .014f, .05f}) * turn_up(15));
    scene.geometry.spheres.push_back({{.72f, .295f, .25f}, .28f, {}, glass, -1});
    stage.put(lathe(rounded({{0, 0},
                             {.2f, 0},
                             {.23f, .05f},
                             {.2f, .5f},
                             {.25f, .78f},
                             {.25f, .8f},
                             {.235f, .8f},
                             {.19f, .5f},
                             {.2f, .12f},
                             {.12f, .08f},
                             {0, .075f}}),
                    72, 60),
              glass, move({.3f, .013f, -.62f}));
    stage.sphere({-.74f, .165f, .72f}, .15f, stage.material({.1f, .2f, .5f}, {.2f, .2f, .2f}, 40));
    stage.sphere({.12f, .105f, .85f}, .09f, stage.material({.7f, .45f, .1f}, {.2f, .2f, .2f}, 40));
    stage.area_light({-1.5f, 3.1f, -.6f}, {2.6f, 0, 0}, {0, .5f, 2.2f}, {4.2f, 4, 3.7f});
}

} // namespace harness
