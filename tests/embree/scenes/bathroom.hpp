// Figure 4.4, middle: a bathroom with several mesh lights, one of which is picked at random.
#pragma once

#include "../shapes.hpp"
#include "../sculpt.hpp"
#include "../stage.hpp"

namespace harness {

// Tiles of a wall from `corner`, over `edge1` by `edge2`, standing out by a little.
inline void tile_wall(Stage &stage, Vector corner, Vector edge1, Vector edge2, float size,
                      const std::vector<uint32_t> &materials)
{
    const float width = length(edge1), height = length(edge2);
    const Vector x = edge1 / width, y = edge2 / height, z = cross(x, y);
    const Mesh tile = box({size * .94f, .016f, size * .94f}, .008f, 2);
    int i = 0;
    for (float v = .5f * size; v < height; v += size, ++i) {
        int j = 0;
        for (float u = .5f * size; u < width; u += size, ++j)
            stage.put(tile, materials[static_cast<size_t>(i + j) % materials.size()],
                      Transform{x, z, -y, corner + u * x + v * y});
    }
    stage.parallelogram(corner + .004f * z, edge1, edge2, stage.material({.5f, .5f, .48f}));
}

inline Mesh tub()
{
    std::vector<Profile> profile = rounded({{0, .1f},
                                            {.28f, .1f},
                                            {.36f, .2f},
                                            {.41f, .5f},
                                            {.45f, .56f},
                                            {.43f, .58f},
                                            {.38f, .52f},
                                            {.33f, .25f},
                                            {.25f, .17f},
                                            {0, .16f}});
    Mesh mesh = scale({1.9f, 1, 1}) * lathe(profile, 96, 60);
    for (float x : {-.45f, .45f})
        for (float z : {-.2f, .2f})
            mesh.add(move({x, .05f, z}) * ball({.05f, .06f, .05f}, 20));
    return mesh;
}

inline Mesh basin()
{
    return lathe(
        rounded({{0, 0}, {.12f, 0}, {.2f, .07f}, {.24f, .14f}, {.225f, .15f}, {.18f, .08f}, {.08f, .03f}, {0, .025f}}),
        64, 60);
}

inline Mesh toilet()
{
    Body body(.08f);
    body.limbs({{{0, .05f, .05f}, .13f}, {{0, .2f, .04f}, .11f}, {{0, .34f, .1f}, .17f}})
        .egg({0, .36f, .14f}, {.19f, .08f, .25f});
    Mesh mesh = sculpt(body, {-.4f, -.15f, -.4f}, {.4f, .7f, .6f}, .02f);
    mesh.add(move({0, .36f, -.2f}) * box({.42f, .36f, .18f}, .04f));
    mesh.add(move({0, .42f, .13f}) * scale({1, 1, 1.25f}) * cylinder(.19f, .03f));
    return mesh;
}

inline Mesh faucet()
{
    Mesh mesh = cylinder(.022f, .1f, 24);
    mesh.add(
        tube([](float t) { return Vector{0, .1f + .1f * std::sin(demo::pi * t), .07f * (1 - std::cos(demo::pi * t))}; },
             [](float) { return .012f; }, 24));
    for (float x : {-.09f, .09f})
        mesh.add(move({x, 0, 0}) *
                 lathe(rounded({{0, 0}, {.02f, 0}, {.014f, .03f}, {.03f, .05f}, {.025f, .07f}, {0, .075f}}), 24, 60));
    return mesh;
}

inline void make_bathroom(uint32_t, float aspect, Scene &scene)
{
    Stage stage(scene);
    scene.layout.choice = true;
    scene.camera.look({1.3f, 1.5f, 2.6f}, {-.2f, .84f, -.6f}, 44, aspect);
    const uint32_t white = stage.material({.78f, .8f, .8f}, {.08f, .08f, .08f}, 40),
                   blue = stage.material({.2f, .4f, .5f}, {.1f, .1f, .1f}, 40);
    const uint32_t pale = stage.material({.62f, .72f, .74f}, {.1f, .1f, .1f}, 40),
                   plaster = stage.material({.72f, .68f, .6f});
    const uint32_t dark = stage.material({.16f, .17f, .19f}, {.12f, .12f, .12f}, 40),
                   chrome = stage.material({.12f, .12f, .13f}, {.7f, .7f, .7f}, 60);
    const uint32_t porcelain = stage.material({.8f, .8f, .78f}, {.12f, .12f, .12f}, 60),
                   oak = stage.material({.45f, .28f, .14f}, {.08f, .08f, .08f}, 25);
    // The room: x in [-1.7, 1.7], z from -1.5; tiles up to a border.
    tile_wall(stage, {-1.7f, 0, -1.5f}, {3.4f, 0, 0}, {0, 1.36f, 0}, .17f, {white, pale});
    tile_wall(stage, {-1.7f, 1.36f, -1.5f}, {3.4f, 0, 0}, {0, .17f, 0}, .17f, {blue});
    tile_wall(stage, {-1.7f, 0, 2.6f}, {0, 0, -4.1f}, {0, 1.36f, 0}, .17f, {white, pale});
    tile_wall(stage, {-1.7f, 1.36f, 2.6f}, {0, 0, -4.1f}, {0, .17f, 0}, .17f, {blue});
    tile_wall(stage, {-1.7f, 0, 2.9f}, {3.6f, 0, 0}, {0, 0, -4.4f}, .34f, {white, dark});
    stage.parallelogram({-1.7f, 1.53f, -1.5f}, {3.4f, 0, 0}, {0, 1.2f, 0}, plaster);
    stage.parallelogram({-1.7f, 1.53f, 2.6f}, {0, 0, -4.1f}, {0, 1.2f, 0}, plaster);
    // The bath.
    stage.put(tub(), porcelain, move({-1.12f, .015f, .1f}) * turn_up(90));
    stage.put(faucet(), chrome, move({-1.12f, .57f, -.83f}));
    stage.put(box({.5f, .03f, .34f}, .01f), oak, move({-1.12f, .585f, .25f}));
    stage.sphere({-1.2f, .66f, .22f}, .045f, stage.material({.75f, .6f, .25f}));
    stage.put(lathe(rounded({{0, 0}, {.03f, 0}, {.03f, .1f}, {.012f, .13f}, {.012f, .16f}, {0, .16f}}), 32, 50), blue,
              move({-.98f, .615f, .3f}));
    // Cabinet, basin, mirror and shelf.
    stage.put(box({1.15f, .66f, .46f}, .02f), oak, move({.1f, .12f, -1.24f}));
    for (float x : {-.17f, .37f}) {
        stage.put(box({.5f, .56f, .03f}, .012f), stage.material({.5f, .32f, .17f}, {.1f, .1f, .1f}, 25),
                  move({x, .17f, -1.01f}));
        stage.put(ball({.022f, .022f, .022f}, 20), chrome, move({x + (x < 0 ? .2f : -.2f), .46f, -.98f}));
    }
    stage.put(box({1.22f, .04f, .52f}, .01f), dark, move({.1f, .78f, -1.23f}));
    stage.put(basin(), porcelain, move({.1f, .82f, -1.2f}));
    stage.put(faucet(), chrome, move({.1f, .82f, -1.43f}));
    stage.put(box({.96f, .8f, .03f}, .012f), oak, move({.1f, 1.22f, -1.49f}));
    stage.put(box({.88f, .72f, .02f}), stage.material({.16f, .2f, .22f}, {.6f, .6f, .6f}, 30),
              move({.1f, 1.26f, -1.475f}));
    stage.put(box({.07f, .17f, .07f}, .02f), pale, move({.56f, .82f, -1.3f}));
    stage.put(lathe(rounded({{0, 0}, {.035f, 0}, {.04f, .07f}, {.036f, .1f}, {.033f, .1f}, {.034f, .03f}, {0, .02f}}),
                    32, 60),
              blue, move({-.36f, .82f, -1.25f}));
    stage.put(rod({-.36f, .84f, -1.25f}, {-.31f, 1.01f, -1.26f}, .006f), stage.material({.7f, .2f, .15f}), {});
    // Toilet, mat, and a towel on its rail.
    stage.put(toilet(), porcelain, move({1.12f, .015f, -1.15f}));
    stage.put(box({.8f, .03f, .55f}, .014f), stage.material({.25f, .42f, .4f}),
              move({.12f, .016f, -.35f}) * turn_up(8));
    stage.put(rod({-1.62f, 1.2f, .35f}, {-1.62f, 1.2f, 1.25f}, .014f), chrome);
    stage.put(box({.05f, .62f, .5f}, .02f), stage.material({.7f, .32f, .22f}), move({-1.62f, .6f, .8f}));
    // Lamps: a globe on either side of the mirror, a ring at the ceiling, a window, and a shelf that glows.
    for (float x : {-.55f, .75f}) {
        stage.put(rod({x, 1.62f, -1.5f}, {x, 1.62f, -1.36f}, .02f), chrome);
        stage.lamp(ball({.09f, .09f, .09f}, 16), {17, 14.6f, 11.2f}, move({x, 1.62f, -1.3f}));
    }
    stage.lamp(torus(.34f, .05f, 24, 8), {26, 23.8f, 20.5f}, move({.1f, 2.35f, .35f}));
    stage.put(box({.05f, .95f, .8f}, .02f), oak, move({-1.71f, 1.55f, 1}));
    stage.lamp(rectangle({-1.68f, 1.6f, 1.35f}, {0, 0, -.7f}, {0, .85f, 0}), {9, 11.5f, 14.5f});
    stage.put(box({.5f, .025f, .2f}, .01f), oak, move({1.12f, 1.4f, -1.4f}));
    stage.lamp(rectangle({.9f, 1.398f, -1.32f}, {0, 0, -.12f}, {.44f, 0, 0}), {7, 5.2f, 3.4f});
    for (float x : {.98f, 1.12f, 1.26f})
        stage.put(lathe(rounded({{0, 0}, {.04f, 0}, {.045f, .1f}, {.018f, .16f}, {.022f, .2f}, {0, .2f}}), 32, 50),
                  x > 1.2f   ? blue
                  : x > 1.1f ? dark
                             : pale,
                  move({x, 1.425f, -1.4f}));
}

} // namespace harness
