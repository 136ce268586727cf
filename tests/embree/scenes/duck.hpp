// Figure 4.7: a box with ducks, parted by a shelf. A lamp on either wall throws its light upwards: the upper half is
// lit by the lamps, the lower one only by what the upper one reflects.
#pragma once

#include "../figures.hpp"
#include "../stage.hpp"

namespace harness {

inline void make_duck(uint32_t, float aspect, Scene &scene)
{
    Stage stage(scene);
    scene.layout.choice = true;
    scene.layout.bounces = 3;
    scene.camera.look({0, 1.08f, 4.3f}, {0, .99f, 0}, 30, aspect);
    const uint32_t white = stage.material({.78f, .76f, .72f});
    stage.parallelogram({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, white);
    stage.parallelogram({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}, stage.material({.82f, .82f, .8f}));
    stage.parallelogram({-1, 0, -1}, {2, 0, 0}, {0, 2, 0}, white);
    stage.parallelogram({-1, 0, 1}, {0, 0, -2}, {0, 2, 0}, stage.material({.66f, .16f, .11f}));
    stage.parallelogram({1, 0, -1}, {0, 0, 2}, {0, 2, 0}, stage.material({.2f, .5f, .17f}));
    stage.put(box({.8f, .05f, .6f}, .015f), stage.material({.45f, .3f, .18f}, {.1f, .1f, .1f}, 30),
              move({0, .98f, -.55f}));

    const Duck bird = duck();
    const uint32_t beak = stage.material({.75f, .28f, .05f}, {.15f, .15f, .15f}, 30),
                   black = stage.material({.03f, .03f, .03f}, {.4f, .4f, .4f}, 60);
    auto place = [&](Transform where, Color color) {
        stage.put(bird.body, stage.material(color, {.12f, .12f, .12f}, 30), where);
        stage.put(bird.beak, beak, where);
        stage.put(bird.eyes, black, where);
    };
    place(move({.02f, 1.03f, -.5f}) * turn_up(-52) * scale(.62f), {.78f, .6f, .08f});
    place(move({-.3f, 0, .05f}) * turn_up(-35) * scale(.7f), {.78f, .6f, .08f});
    place(move({.45f, 0, .45f}) * turn_up(-110) * scale(.38f), {.75f, .55f, .1f});
    place(move({.52f, 0, -.35f}) * turn_up(-150) * scale(.38f), {.25f, .45f, .7f});

    // Each in a shade that hides it from below.
    const uint32_t brass = stage.material({.5f, .38f, .18f}, {.2f, .18f, .12f}, 40);
    for (float side : {-1.0f, 1.0f}) {
        float x = side * .85f;
        stage.put(box({.3f, .06f, .6f}, .02f), brass, move({x, 1, -.05f}));
        stage.area_light({x - .11f, 1.065f, .2f}, {.22f, 0, 0}, {0, 0, -.5f},
                         side < 0 ? Color{40, 33, 25} : Color{27, 31, 37});
    }
}

} // namespace harness
