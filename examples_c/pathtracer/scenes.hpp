// The scenes that come with the path tracer, all in one box: x in [-1, 1], y (up) in [0, 2], z in [-1, 1], open to the
// camera.
#pragma once

#include "builder.hpp"

namespace demo {

inline void walls(Builder &builder)
{
    uint32_t white = builder.material({.73f, .71f, .68f}), red = builder.material({.63f, .09f, .07f});
    uint32_t green = builder.material({.14f, .45f, .11f});
    uint32_t floor = builder.material({.6f, .58f, .55f}, {.15f, .15f, .15f}, 30);
    builder.parallelogram({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, floor);
    builder.parallelogram({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}, white);
    builder.parallelogram({-1, 0, -1}, {2, 0, 0}, {0, 2, 0}, white);
    builder.parallelogram({-1, 0, 1}, {0, 0, -2}, {0, 2, 0}, red);
    builder.parallelogram({1, 0, -1}, {0, 0, 2}, {0, 2, 0}, green);
}

inline void furnish(Builder &builder)
{
    walls(builder);
    builder.block({-.42f, 0, -.42f}, {.52f, 1.1f, .52f}, .32f, builder.material({.7f, .68f, .64f}));
    builder.knot({.38f, .44f, .08f}, .138f, builder.material({.5f, .33f, .1f}, {.35f, .3f, .2f}, 40));
    builder.sphere({-.48f, .24f, .48f}, .24f, builder.material({.12f, .2f, .42f}, {.4f, .4f, .4f}, 60));
}

inline void look(float aspect, Scene &scene) { scene.camera.look({0, 1, 4.2f}, {0, .95f, 0}, 36, aspect); }

inline void make_direct(uint32_t, float aspect, Scene &scene)
{
    Builder builder(scene);
    look(aspect, scene);
    furnish(builder);
    builder.area_light({-.35f, 1.98f, -.35f}, {.7f, 0, 0}, {0, 0, .7f}, {16, 14.5f, 12});
}

inline void make_motion(uint32_t, float aspect, Scene &scene)
{
    Builder builder(scene);
    look(aspect, scene);
    scene.layout.time = true;
    walls(builder);
    builder.knot({.42f, .44f, -.3f}, .138f, builder.material({.5f, .33f, .1f}, {.35f, .3f, .2f}, 40));
    builder.sphere({-.62f, .3f, .2f}, .3f, builder.material({.12f, .2f, .42f}, {.4f, .4f, .4f}, 60), {.5f, .12f, .1f});
    builder.sphere_light({-.1f, 1.6f, .3f}, .2f, {26, 24, 21});
}

inline void make_lens(uint32_t, float aspect, Scene &scene)
{
    Builder builder(scene);
    scene.layout.lens = true;
    scene.camera.look({.1f, .75f, 2.9f}, {-.05f, .5f, 0}, 34, aspect);
    scene.camera.aperture = .12f;
    scene.camera.focus = 2.4f; // the blue sphere's distance
    furnish(builder);
    builder.area_light({-.35f, 1.98f, -.35f}, {.7f, 0, 0}, {0, 0, .7f}, {16, 14.5f, 12});
}

inline void make_lights(uint32_t, float aspect, Scene &scene)
{
    Builder builder(scene);
    look(aspect, scene);
    scene.layout.choice = true;
    furnish(builder);
    // Four panels at the ceiling, one lamp at the back, one near the floor.
    const Color colors[4] = {{18, 13, 9}, {9, 14, 19}, {13, 13, 13}, {17, 9, 13}};
    for (int i = 0; i < 4; ++i) {
        Vector corner{i % 2 ? .35f : -.75f, 1.98f, i / 2 ? .2f : -.7f};
        builder.area_light(corner, {.4f, 0, 0}, {0, 0, .4f}, colors[i]);
    }
    builder.area_light({.3f, 1.25f, -.98f}, {.45f, 0, 0}, {0, .25f, 0}, {10, 8, 5});
    builder.sphere_light({.05f, .16f, .62f}, .1f, {12, 10, 7});
}

inline void make_global(uint32_t, float aspect, Scene &scene)
{
    Builder builder(scene);
    look(aspect, scene);
    scene.layout.choice = true;
    scene.layout.bounces = 3;
    furnish(builder);
    builder.area_light({-.3f, 1.98f, -.3f}, {.6f, 0, 0}, {0, 0, .6f}, {12, 11, 9.5f});
    builder.area_light({-.98f, 1.1f, .75f}, {0, 0, -.35f}, {0, .35f, 0}, {5, 6.5f, 9});
}

inline std::vector<SceneEntry> box_scenes()
{
    return {
        {"direct", "2 dims: a point on the area light", make_direct},
        {"motion", "3 dims: the time, a point on the spherical light", make_motion},
        {"lens", "4 dims: points on the lens and on the area light", make_lens},
        {"lights", "3 dims: a point on a light, which of six lights", make_lights},
        {"global", "15 dims: for three reflections a point on a light, which of two, the next direction", make_global},
    };
}

} // namespace demo
