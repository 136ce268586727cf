// Section 5.8, figures 5.23 and 5.24: eighteen frames in which the camera glides around a turntable that turns slowly
// the other way.
#pragma once

#include "killeroos.hpp"
#include "../load.hpp"

namespace harness {

inline void make_animation(uint32_t frame, float aspect, Scene &scene)
{
    Stage stage(scene);
    const float time = static_cast<float>(frame);
    const Vector eye = turn_up(-10 + .7f * time).point({.2f, 1.25f, 3.3f});
    scene.camera.look(eye, {0, .34f, 0}, 35, aspect);
    stage.put(backdrop(8, 7, 1.6f, 5, 1.3f), stage.material({.5f, .53f, .58f}));
    const Transform table = turn_up(-1.6f * time);
    stage.put(lathe(rounded({{0, 0}, {.95f, 0}, {1, .02f}, {1, .07f}, {.97f, .09f}, {0, .09f}}), 96, 50),
              stage.material({.42f, .28f, .17f}, {.1f, .1f, .1f}, 30));
    const Transform top = move({0, .09f, 0}) * table;
    for (int i = 0; i < 24; ++i) // marks by which one sees it turn
        stage.put(box({.03f, .006f, .1f}, .002f, 2), stage.material({.8f, .75f, .6f}),
                  top * turn_up(15 * static_cast<float>(i)) * move({0, 0, .88f}));
    stage.put(shipped("bunny.ply"), stage.material({.55f, .45f, .38f}),
              top * move({-.36f, 0, .22f}) * turn_up(20) * scale(.62f));
    stage.put(shipped("teapot.ply"), stage.material({.1f, .3f, .4f}, {.2f, .2f, .2f}, 25),
              top * move({.3f, 0, -.36f}) * turn_up(-30) * scale(.42f));
    const Duck bird = duck();
    const Transform nest = top * move({.4f, 0, .4f}) * turn_up(-60) * scale(.4f);
    stage.put(bird.body, stage.material({.75f, .55f, .07f}, {.12f, .12f, .12f}, 30), nest);
    stage.put(bird.beak, stage.material({.7f, .25f, .05f}), nest);
    stage.put(bird.eyes, stage.material({.03f, .03f, .03f}), nest);
    // A ball rolls past the turntable.
    const float way = .045f * time;
    stage.sphere({-.8f + way, .13f, 1.2f}, .13f, stage.material({.6f, .12f, .08f}, {.2f, .2f, .2f}, 50));
    stage.area_light({-2.1f, 3, .3f}, {1.5f, 0, .3f}, {-.2f, .4f, 1.4f}, {34, 32, 28});
}

} // namespace harness
