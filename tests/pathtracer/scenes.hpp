// Scenes and directions that several tests use.
#pragma once

#include "../../examples_c/pathtracer/builder.hpp"
#include "../../examples_c/pathtracer/bvh.hpp"
#include "../../examples_c/pathtracer/scene_integrand.hpp"
#include "check.hpp"

namespace test {

using namespace demo;

// Uniform on the sphere; density 1 / (4 pi).
inline Vector direction(Random &random)
{
    float z = 1 - 2 * random(), r = std::sqrt(std::max(0.0f, 1 - z * z)), a = 2 * pi * random();
    return {r * std::cos(a), r * std::sin(a), z};
}

// Six faces, outwards; `inwards` turns them.
inline void cube(Builder &builder, Vector low, float size, uint32_t material, bool inwards = false)
{
    Vector x{size, 0, 0}, y{0, size, 0}, z{0, 0, size};
    auto face = [&](Vector corner, Vector a, Vector b) {
        builder.parallelogram(corner, inwards ? b : a, inwards ? a : b, material);
    };
    face(low, y, x);
    face(low, x, z);
    face(low, z, y);
    face(low + x, y, z);
    face(low + y, z, x);
    face(low + z, x, y);
}

// Uneven, with black parts, a spot thousands of times as bright as the rest, and light at both poles.
inline std::shared_ptr<const Environment> uneven_sky()
{
    constexpr uint32_t width = 37, height = 18;
    std::vector<Color> pixels;
    for (uint32_t y = 0; y < height; ++y) {
        for (uint32_t x = 0; x < width; ++x) {
            float value = x < 12 ? 0.0f : 0.2f + 0.1f * static_cast<float>((x * 7 + y * 3) % 5);
            value = y == 0 || y == height - 1 ? 3.0f : x == 5 && y == 4 ? 1000.0f : value;
            pixels.push_back({value, 0.5f * value, 0.25f * value});
        }
    }
    return std::make_shared<Environment>(width, height, pixels);
}

inline std::shared_ptr<const Environment> constant_sky(float value)
{
    return std::make_shared<Environment>(8, 4, std::vector<Color>(32, Color{value, value, value}));
}

// One light of each kind around the origin, above a floor that is not there yet.
struct LitScene {
    const char *name;
    Scene scene;
};

inline std::vector<LitScene> lit_scenes()
{
    std::vector<LitScene> all(5);
    const Color radiance{2, 3, 1};
    all[0].name = "parallelogram";
    Builder(all[0].scene).area_light({-.7f, 1.5f, -.3f}, {1.1f, .2f, 0}, {.2f, -.1f, .9f}, radiance);
    all[1].name = "triangle";
    Builder(all[1].scene).triangle_area_light({-.7f, 1.5f, -.3f}, {.4f, 1.2f, -.2f}, {.1f, 1.4f, .9f}, radiance);
    all[2].name = "sphere";
    Builder(all[2].scene).sphere_light({.3f, 1.3f, -.2f}, .5f, radiance);
    all[3].name = "mesh";
    Builder builder(all[3].scene);
    cube(builder, {-.2f, 1, -.3f}, .6f, builder.material({}));
    builder.parallelogram({-1.3f, 1.4f, -.2f}, {.5f, 0, 0}, {0, .1f, .5f}, builder.material({}));
    builder.shine(0, radiance);
    all[4].name = "environment";
    Builder(all[4].scene).environment(uneven_sky());
    return all;
}

} // namespace test
