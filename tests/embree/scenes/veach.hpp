// Figure 4.9: glossy plates under lights of several sizes, which light sampling and direction sampling find with opposite ease
// (Veach and Guibas 1995). The lights are one mesh.
#pragma once

#include "../shapes.hpp"
#include "../stage.hpp"

namespace harness {

inline void make_veach(uint32_t, float aspect, Scene &scene)
{
    Stage stage(scene);
    scene.camera.look({0, 1.5f, 6.2f}, {0, .95f, 0}, 30, aspect);
    const uint32_t wall = stage.material({.42f, .42f, .42f});
    stage.parallelogram({-6, -.6f, 4}, {12, 0, 0}, {0, 0, -7}, wall);
    stage.parallelogram({-6, -.6f, -2.4f}, {12, 0, 0}, {0, 6, 0}, wall);
    const float tilt[4] = {62, 45, 31, 19}, sharpness[4] = {1200, 220, 60, 18};
    const Vector at[4] = {{0, .78f, -1.05f}, {0, .32f, -.35f}, {0, -.02f, .45f}, {0, -.26f, 1.35f}};
    for (int i = 0; i < 4; ++i)
        stage.put(box({2.7f, .03f, .62f}, .01f), stage.material({.05f, .06f, .07f}, {.5f, .5f, .5f}, sharpness[i]), move(at[i]) * turn({1, 0, 0}, tilt[i]));
    Mesh lights;
    const float radius[4] = {.04f, .12f, .22f, .34f}, x[4] = {-1.2f, -.55f, .2f, 1.08f};
    for (int i = 0; i < 4; ++i)
        lights.add(move({x[i], 2, -1.1f}) * ball({radius[i], radius[i], radius[i]}, 20));
    stage.lamp(lights, {5, 4.6f, 4});
}

} // namespace harness
