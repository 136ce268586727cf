// Figure 4.10, bottom: a complex, glossy object under an environment of low frequency.
#pragma once

#include "../figures.hpp"
#include "../sky.hpp"

namespace harness {

// Looks along x, stands on its skids.
struct Helicopter {
    Mesh hull, glass, metal, marks;
};

inline Mesh rotor(int blades, float span, float chord)
{
    Mesh mesh = lathe(rounded({{0, -.06f}, {.06f, -.06f}, {.07f, 0}, {.04f, .05f}, {0, .06f}}), 32, 60);
    for (int i = 0; i < blades; ++i) {
        Transform place = turn_up(360 * static_cast<float>(i) / static_cast<float>(blades) + 20);
        mesh.add(place * rod({0, 0, 0}, {.2f, 0, 0}, .022f));
        mesh.add(place *
                 (move({.15f + .5f * span, -.008f, 0}) * turn({1, 0, 0}, 6) * box({span, .016f, chord}, .007f, 2)));
    }
    return mesh;
}

inline Helicopter helicopter()
{
    Helicopter h;
    Body hull(.14f);
    hull.egg({.05f, .62f, 0}, {.72f, .3f, .3f}, -3).egg({-.22f, .82f, 0}, {.42f, .16f, .19f}, -4);
    hull.limbs({{{-.5f, .7f, 0}, .17f}, {{-1.1f, .77f, 0}, .085f}, {{-1.78f, .86f, 0}, .045f}});
    Body tail(.03f);
    tail.limb({-1.72f, .84f, 0}, .04f, {-2, 1.22f, 0}, .022f).limb({-1.78f, .86f, 0}, .03f, {-1.93f, .64f, 0}, .016f);
    tail.limb({-1.5f, .82f, -.34f}, .018f, {-1.5f, .82f, .34f}, .018f);
    h.hull = sculpt(
        [&](Vector center, float radius) {
            return [a = hull.near(center, radius), b = tail.near(center, radius)](Vector p) {
                return blend(a(p), b(p), .06f);
            };
        },
        {-2.2f, .1f, -.5f}, {1, 1.4f, .5f}, .022f);
    Body dome(.05f);
    dome.egg({.36f, .68f, 0}, {.46f, .26f, .27f}, -14);
    h.glass = sculpt(dome, {-.3f, .2f, -.5f}, {1.1f, 1.2f, .5f}, .022f);
    // Skids, and what carries them.
    for (float side : {-1.0f, 1.0f}) {
        const float z = .36f * side;
        h.metal.add(tube([=](float t) { return Vector{-.7f + 1.5f * t, .03f + .16f * std::pow(t, 8.0f), z}; },
                         [](float) { return .028f; }, 40));
        for (float x : {-.35f, .35f})
            h.metal.add(tube(
                [=](float t) { return Vector{x, .42f - .39f * t * t, z * (.45f + .55f * std::sin(demo::pi / 2 * t))}; },
                [](float) { return .022f; }, 16));
        // Turbines and pods at both sides.
        h.metal.add(move({-.5f, .86f, .17f * side}) * turn({0, 0, 1}, 90) *
                    lathe({{.05f, 0}, {.075f, 0}, {.085f, .3f}, {.06f, .32f}, {.05f, .05f}, {0, .05f}}, 32, 40));
        h.metal.add(rod({-.1f, .56f, .2f * side}, {-.1f, .52f, .5f * side}, .03f));
        h.marks.add(move({.22f, .5f, .5f * side}) * turn({0, 0, 1}, 90) *
                    lathe(rounded({{0, 0}, {.04f, .03f}, {.07f, .15f}, {.07f, .5f}, {.04f, .6f}, {0, .6f}}), 32, 60));
    }
    h.metal.add(rod({-.12f, .95f, 0}, {-.12f, 1.14f, 0}, .05f, 24));
    h.metal.add(move({-.12f, 1.16f, 0}) * rotor(4, 1.45f, .13f));
    h.metal.add(move({-1.93f, 1.08f, .06f}) * turn({1, 0, 0}, 90) * scale(.24f) * rotor(4, 1.2f, .2f));
    h.marks.add(move({-1.25f, .785f, 0}) * turn({0, 0, 1}, 97) * cylinder(.088f, .12f));
    h.marks.add(move({-1.45f, .81f, 0}) * turn({0, 0, 1}, 97) * cylinder(.075f, .06f));
    for (float z : {-.3f, .3f}) // door handles and rails
        h.metal.add(rod({-.2f, .66f, z * 1.01f}, {.12f, .66f, z * 1.0f}, .012f, 12));
    return h;
}

inline void make_chopper(uint32_t, float aspect, Scene &scene)
{
    Stage stage(scene);
    scene.camera.look({2.1f, 2.05f, 3.6f}, {-.52f, .58f, -.1f}, 38, aspect);
    // The pad: concrete slabs, and a ring.
    const uint32_t slab[2] = {stage.material({.42f, .41f, .39f}), stage.material({.38f, .375f, .36f})},
                   paint = stage.material({.75f, .68f, .3f});
    stage.put(lathe({{0, -.04f}, {40, -.04f}, {40, -.03f}, {0, -.03f}}, 64), stage.material({.3f, .3f, .29f}));
    const Mesh tile = box({.985f, .03f, .985f}, .008f, 2);
    for (int i = -4; i < 4; ++i)
        for (int j = -4; j < 4; ++j)
            stage.put(tile, slab[(i * 3 + j * 5 + 32) % 2],
                      move({static_cast<float>(i) + .5f, -.03f, static_cast<float>(j) + .5f}));
    stage.put(lathe({{1.45f, 0}, {1.6f, 0}, {1.6f, .003f}, {1.45f, .003f}}, 96), paint);
    const Helicopter h = helicopter();
    const Transform place = turn_up(12);
    stage.put(h.hull, stage.material({.5f, .08f, .06f}, {.22f, .22f, .22f}, 22), place);
    stage.put(h.glass, stage.material({.04f, .05f, .06f}, {.42f, .42f, .42f}, 22), place);
    stage.put(h.metal, stage.material({.13f, .13f, .14f}, {.36f, .36f, .36f}, 14), place);
    stage.put(h.marks, stage.material({.7f, .7f, .68f}, {.15f, .15f, .15f}, 20), place);
    stage.environment(smooth_sky({-.4f, .55f, .75f}));
}

} // namespace harness
