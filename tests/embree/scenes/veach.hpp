// Figure 4.9: glossy plates under lights of several sizes, which light sampling and direction sampling find with
// opposite ease (Veach and Guibas 1995). The lights are one mesh.
#pragma once

#include "../shapes.hpp"
#include "../stage.hpp"

namespace harness {

inline void make_veach(uint32_t, float aspect, Scene &scene)
{
    Stage stage(scene);
    scene.camera.look({0, 1.5f, 6.2f}, {0, .95f, 0}, 30, aspect);
    const uint32_t wall = stage.material({.7f, .68f, .64f});
    stage.parallelogram({-6, -.6f, 4}, {12, 0, 0}, {0, 0, -7}, wall);
    stage.parallelogram({-6, -.6f, -2.4f}, {12, 0, 0}, {0, 6, 0}, wall);
    const float sharpness[4] = {400, 120, 40, 14};
    const Vector at[4] = {{0, .86f, -1.35f}, {0, .42f, -.75f}, {0, .06f, 0}, {0, -.22f, 1}}, middle{0, 2, -1.1f};
    for (int i = 0; i < 4; ++i) {
        // So that it mirrors the lights' middle into the camera.
        Vector normal = demo::normalize(scene.camera.eye - at[i]) + demo::normalize(middle - at[i]);
        float tilt = std::atan2(normal.z, normal.y) * 180 / demo::pi;
        stage.put(box({2.7f, .03f, .5f}, .01f), stage.material({.05f, .06f, .07f}, {.5f, .5f, .5f}, sharpness[i]),
                  move(at[i]) * turn({1, 0, 0}, tilt));
    }
    Mesh lights;
    const float radius[4] = {.04f, .12f, .22f, .34f}, x[4] = {-1.2f, -.55f, .2f, 1.08f};
    for (int i = 0; i < 4; ++i)
        lights.add(move(middle + Vector{x[i], 0, 0}) * ball({radius[i], radius[i], radius[i]}, 20));
    stage.lamp(lights, {7, 6.4f, 5.5f});
}

} // namespace harness
