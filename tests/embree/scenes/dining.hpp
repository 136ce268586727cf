// Figure 4.4, bottom: a laid table under one light, a single triangle.
#pragma once

#include "../load.hpp"
#include "../shapes.hpp"
#include "../stage.hpp"

namespace harness {

inline Mesh chair()
{
    Mesh mesh = move({0, .43f, 0}) * box({.42f, .05f, .42f}, .02f);
    for (float x : {-.18f, .18f})
        for (float z : {-.18f, .18f})
            mesh.add(rod({x, 0, z}, {x, z < 0 ? .95f : .45f, z - (z < 0 ? .05f : 0)}, .02f));
    for (float y : {.6f, .73f, .86f})
        mesh.add(move({0, y, -.22f}) * box({.34f, .07f, .02f}, .008f));
    return mesh;
}

inline Mesh plate(float radius)
{
    std::vector<Profile> profile =
        rounded({{0, 0}, {.55f, 0}, {.7f, .04f}, {1, .12f}, {.99f, .15f}, {.68f, .07f}, {.5f, .04f}, {0, .035f}});
    return scale(radius) * lathe(profile, 64, 60);
}

inline Mesh goblet()
{
    return lathe(rounded({{0, 0},
                          {.036f, 0},
                          {.037f, .004f},
                          {.012f, .012f},
                          {.006f, .03f},
                          {.006f, .085f},
                          {.02f, .1f},
                          {.04f, .13f},
                          {.042f, .16f},
                          {.035f, .2f},
                          {.033f, .2f},
                          {.04f, .16f},
                          {.036f, .13f},
                          {.015f, .108f},
                          {0, .105f}}),
                 48, 60);
}

inline Mesh vase()
{
    return lathe(rounded({{0, 0},
                          {.05f, 0},
                          {.09f, .08f},
                          {.1f, .15f},
                          {.06f, .25f},
                          {.035f, .3f},
                          {.05f, .34f},
                          {.045f, .34f},
                          {.03f, .3f},
                          {0, .25f}}),
                 64, 60);
}

// Knife and fork lie beside a plate at the origin, whose guest sits at +z.
inline Mesh cutlery()
{
    Mesh mesh = move({.17f, .002f, 0}) * box({.016f, .006f, .2f}, .003f, 2);
    mesh.add(move({-.17f, .002f, .03f}) * box({.01f, .006f, .14f}, .003f, 2));
    for (float x : {-.009f, -.003f, .003f, .009f})
        mesh.add(move({-.17f + x, .002f, -.06f}) * box({.0035f, .005f, .06f}));
    mesh.add(move({-.17f, .002f, -.037f}) * box({.023f, .006f, .02f}, .003f, 2));
    return mesh;
}

inline void lay_table(Stage &stage, float top)
{
    const uint32_t china = stage.material({.78f, .78f, .76f}, {.1f, .1f, .1f}, 40),
                   rim = stage.material({.2f, .3f, .5f}, {.1f, .1f, .1f}, 40);
    const uint32_t silver = stage.material({.25f, .25f, .25f}, {.5f, .5f, .5f}, 40),
                   crystal = stage.material({.35f, .4f, .42f}, {.3f, .3f, .3f}, 50);
    const Mesh small = plate(.085f), large = plate(.135f), glass = goblet(), tools = cutlery();
    auto cover = [&](Vector at, float degrees) {
        Transform place = move({at.x, top, at.z}) * turn_up(degrees);
        stage.put(large, china, place);
        stage.put(small, rim, place * move({0, .012f, 0}));
        stage.put(tools, silver, place);
        stage.put(glass, crystal, place * move({.13f, 0, -.17f}));
    };
    for (float x : {-.5f, .15f}) {
        cover({x, 0, .27f}, 0);
        cover({x, 0, -.27f}, 180);
    }
    cover({.72f, 0, 0}, 90);
    stage.put(shipped("teapot.ply"), china, move({-.2f, top, 0}) * turn_up(25) * scale(.15f));
    stage.put(vase(), stage.material({.1f, .3f, .35f}, {.25f, .25f, .25f}, 40), move({.17f, top, .02f}));
    const uint32_t bowl = stage.material({.55f, .35f, .15f}, {.1f, .1f, .1f}, 30);
    stage.put(lathe(rounded({{0, .01f}, {.05f, 0}, {.1f, .03f}, {.13f, .09f}, {.122f, .09f}, {.09f, .04f}, {0, .02f}}),
                    64, 60),
              bowl, move({-.62f, top, .02f}));
    const Color fruit[3] = {{.7f, .12f, .06f}, {.75f, .42f, .05f}, {.45f, .6f, .1f}};
    const Vector heap[6] = {{.05f, .075f, 0}, {-.03f, .075f, .045f}, {-.03f, .075f, -.045f},
                            {0, .13f, 0},     {.06f, .1f, .055f},    {-.075f, .09f, 0}};
    for (int i = 0; i < 6; ++i)
        stage.sphere(heap[i] + Vector{-.62f, top, .02f}, .036f, stage.material(fruit[i % 3], {.15f, .15f, .15f}, 40));
}

inline void make_dining(uint32_t frame, float aspect, Scene &scene)
{
    Stage stage(scene);
    // In later frames the camera draws nearer.
    const float time = static_cast<float>(frame);
    scene.camera.look({1.1f - .02f * time, 1.8f - .01f * time, 1.75f - .03f * time}, {-.06f, .66f, -.06f}, 42, aspect);
    const uint32_t wall = stage.material({.5f, .55f, .5f}), panel = stage.material({.7f, .68f, .62f}),
                   wood = stage.material({.36f, .2f, .1f}, {.1f, .1f, .1f}, 30);
    stage.parallelogram({-2.2f, 0, -1.6f}, {6, 0, 0}, {0, 3, 0}, wall);
    stage.parallelogram({-2.2f, 0, 4}, {0, 0, -5.6f}, {0, 3, 0}, wall);
    const Color plank[3] = {{.42f, .29f, .18f}, {.38f, .25f, .15f}, {.45f, .32f, .2f}};
    for (int i = 0; i < 40; ++i) {
        float z = -1.6f + .14f * static_cast<float>(i);
        stage.parallelogram({-2.2f, 0, z + .137f}, {6, 0, 0}, {0, 0, -.134f},
                            stage.material(plank[(i * 7) % 3], {.08f, .08f, .08f}, 20));
    }
    stage.parallelogram({-2.2f, -.004f, 4}, {6, 0, 0}, {0, 0, -5.6f}, stage.material({.1f, .07f, .05f}));
    // Panelling, and pictures.
    for (int i = 0; i < 6; ++i) {
        stage.put(box({.62f, .8f, .05f}, .02f), panel, move({-1.85f + .68f * static_cast<float>(i), .1f, -1.6f}));
        stage.put(box({.05f, .8f, .62f}, .02f), panel, move({-2.2f, .1f, -1.2f + .68f * static_cast<float>(i)}));
    }
    const uint32_t moulding = stage.material({.5f, .36f, .12f}, {.2f, .18f, .1f}, 30);
    const Color canvas[3] = {{.2f, .35f, .5f}, {.55f, .3f, .2f}, {.35f, .45f, .25f}};
    for (int i = 0; i < 3; ++i) {
        Vector at{-1.35f + .8f * static_cast<float>(i), 1.15f, -1.58f};
        stage.put(box({.6f, .46f, .05f}, .02f), moulding, move(at));
        stage.put(box({.5f, .36f, .02f}), stage.material(canvas[i]), move(at + Vector{0, .05f, .025f}));
    }
    // The table with its cloth, and chairs.
    stage.put(box({1.9f, .04f, .95f}, .015f), stage.material({.72f, .69f, .63f}), move({.02f, .71f, 0}));
    stage.put(box({.6f, .004f, .96f}, .001f), stage.material({.5f, .12f, .12f}), move({.02f, .7485f, 0}));
    for (float x : {-.8f, .84f})
        for (float z : {-.38f, .38f})
            stage.put(box({.07f, .71f, .07f}, .015f), wood, move({x, 0, z}));
    lay_table(stage, .753f);
    const Mesh seat = chair();
    for (float x : {-.5f, .15f}) {
        stage.put(seat, wood, move({x, 0, .75f}) * turn_up(180));
        stage.put(seat, wood, move({x, 0, -.72f}));
    }
    stage.put(seat, wood, move({-1.3f, 0, 0}) * turn_up(90));
    stage.triangle_area_light({-1.2f, 2.6f, .3f}, {1.3f, 2.6f, .5f}, {.3f, 2.6f, 2.2f}, {13.5f, 12.2f, 10.2f});
}

} // namespace harness
