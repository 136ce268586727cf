// Environment maps, computed: a smooth one, and one full of small bright things.
#pragma once

#include "pathtracer/environment.hpp"
#include "pathtracer/random.hpp"
#include "stage.hpp"
#include <functional>
#include <memory>

namespace harness {

inline Color mix(Color a, Color b, float t) { return (1 - t) * a + t * b; }

inline float smoothstep(float low, float high, float x)
{
    float t = std::min(1.0f, std::max(0.0f, (x - low) / (high - low)));
    return t * t * (3 - 2 * t);
}

inline std::shared_ptr<const demo::Environment> map(uint32_t width, uint32_t height,
                                                    const std::function<Color(Vector)> &sky)
{
    std::vector<Color> pixels;
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
            float longitude = 2 * demo::pi * (static_cast<float>(x) + .5f) / static_cast<float>(width);
            float latitude = demo::pi * (static_cast<float>(y) + .5f) / static_cast<float>(height),
                  sine = std::sin(latitude);
            pixels.push_back(sky({sine * std::sin(longitude), std::cos(latitude), sine * std::cos(longitude)}));
        }
    return std::make_shared<const demo::Environment>(width, height, std::move(pixels));
}

// A lobe of light around a unit direction, 1 in its middle; the larger `sharpness`, the smaller.
inline float glow(Vector direction, Vector around, float sharpness)
{
    return std::exp(sharpness * (dot(direction, demo::normalize(around)) - 1));
}

// Evening: blue above, warm at the horizon, a glow where the sun is, large and soft unless it is sharpened, and another
// colour opposite.
inline std::shared_ptr<const demo::Environment> smooth_sky(Vector sun, float sharpness = 9, float strength = 1)
{
    return map(128, 64, [=](Vector d) {
        Color sky = mix({.95f, .78f, .62f}, {.22f, .38f, .72f}, smoothstep(-.05f, .7f, d.y));
        sky = mix({.3f, .26f, .22f}, sky, smoothstep(-.25f, .05f, d.y));
        sky += glow(d, sun, sharpness) * (strength * sharpness / 9) * Color{5.2f, 3.9f, 2.5f};
        sky += glow(d, {-sun.x, .25f, -sun.z}, 5) * Color{.35f, .25f, .6f};
        return sky;
    });
}

// Night falls over a town: facades with lit windows all around, lamps, a strong low sun. Half of all light is in few
// pixels, but no single one decides a picture.
inline std::shared_ptr<const demo::Environment> town_sky(Vector sun)
{
    return map(768, 384, [=](Vector d) {
        float longitude = std::atan2(d.x, d.z), elevation = std::asin(std::min(1.0f, std::max(-1.0f, d.y)));
        Color sky = mix({.34f, .26f, .3f}, {.06f, .1f, .24f}, smoothstep(0, .8f, d.y));
        auto hash = [](int a, int b, int c) {
            uint64_t key = demo::mix(static_cast<uint64_t>(a + 4096) << 40 ^ static_cast<uint64_t>(b + 4096) << 20 ^
                                     static_cast<uint64_t>(c + 64));
            return demo::unit(static_cast<uint32_t>(key));
        };
        // Houses, each with its own height; windows on a grid, every third lit.
        int house = static_cast<int>(std::floor(longitude / (2 * demo::pi) * 26));
        float height = .16f + .42f * hash(house, 0, 1);
        if (elevation < height && elevation > -.04f) {
            sky = Color{.09f, .08f, .09f} + hash(house, 0, 2) * Color{.07f, .05f, .05f};
            float column = longitude / (2 * demo::pi) * 26 * 6, row = elevation * 26;
            int i = static_cast<int>(std::floor(column)), j = static_cast<int>(std::floor(row));
            float x = column - std::floor(column), y = row - std::floor(row);
            if (x > .25f && x < .8f && y > .2f && y < .8f && hash(i, j, 3) < .36f)
                sky = (1.5f + 7 * hash(i, j, 4)) *
                      mix({1, .72f, .38f}, {.75f, .88f, 1}, hash(i, j, 5) > .7f ? 1.0f : 0.0f);
        } else if (elevation <= -.04f) {
            sky = {.12f, .11f, .1f};
        } else {
            // Lanterns above the roofs.
            float column = longitude / (2 * demo::pi) * 60, row = elevation * 12;
            int i = static_cast<int>(std::floor(column)), j = static_cast<int>(std::floor(row));
            float x = column - std::floor(column) - .5f, y = row - std::floor(row) - .5f;
            if (elevation < 1.2f && x * x + y * y < .06f && hash(i, j, 6) < .28f)
                sky = 9 * mix({1, .6f, .3f}, {.9f, .95f, 1}, hash(i, j, 7));
        }
        float to_sun = dot(d, demo::normalize(sun));
        return sky + smoothstep(.992f, .995f, to_sun) * Color{62, 50, 36} + glow(d, sun, 30) * Color{1.6f, 1.1f, .7f};
    });
}

} // namespace harness
