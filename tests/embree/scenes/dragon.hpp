// Figure 4.10, top: one object under an environment of high frequency.
#pragma once

#include "../figures.hpp"
#include "../sky.hpp"

namespace harness {

inline void make_dragon(uint32_t, float aspect, Scene &scene)
{
    Stage stage(scene);
    scene.camera.look({1.6f, 1.0f, 2.7f}, {0, .47f, 0}, 33, aspect);
    stage.put(lathe({{0, -.3f}, {30, -.3f}, {30, -.29f}, {0, -.29f}}, 64),
              stage.material({.48f, .44f, .4f}, {.06f, .06f, .06f}, 20));
    std::vector<Profile> foot{{0, -.29f},    {1.06f, -.29f}, {1.06f, -.22f}, {1, -.2f},
                              {.98f, -.06f}, {1.02f, -.04f}, {1.02f, 0},     {0, 0}};
    stage.put(lathe(foot, 96), stage.material({.5f, .5f, .52f}, {.12f, .12f, .12f}, 30));
    stage.put(dragon(), stage.material({.1f, .42f, .28f}, {.3f, .32f, .28f}, 30), turn_up(-18));
    stage.environment(town_sky({-.55f, .62f, .5f}));
}

} // namespace harness
