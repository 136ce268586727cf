// Whole paths: weights of multiple importance sampling, Russian roulette, furnaces whose radiance is known, and glass.
#include "scenes.hpp"

using namespace test;

namespace {

struct Estimate {
    double value = 0, deviation = 0;
    double mean() const { return value; }
    double error() const { return deviation; }
};

// The mean over all pixels of means over random sample vectors: pixels differ, which is no error.
Estimate render(const Scene &scene, uint32_t size, int samples, uint64_t seed)
{
    Bvh bvh(scene.geometry);
    SceneIntegrand integrand(scene, bvh, size, size);
    const uint32_t count = dims(integrand.domains());
    Random random(seed);
    Estimate all;
    std::vector<float> u(count * 16), f(3 * 16);
    for (uint32_t y = 0; y < size; ++y) {
        for (uint32_t x = 0; x < size; ++x) {
            Mean mean;
            for (int i = 0; i < samples; i += 16) {
                for (float &value : u)
                    value = random();
                integrand.evaluate(x, y, 16, u.data(), f.data(), nullptr, nullptr);
                for (int j = 0; j < 16; ++j)
                    mean.add(luminance({f[3 * j], f[3 * j + 1], f[3 * j + 2]}));
            }
            all.value += mean.mean() / (size * size);
            all.deviation += mean.error() * mean.error();
        }
    }
    all.deviation = std::sqrt(all.deviation) / (size * size);
    return all;
}

// Paths of one reflection are direct light: by next event estimation alone, and with directions, weighted.
void direct_light()
{
    for (LitScene &lit : lit_scenes()) {
        Builder builder(lit.scene);
        builder.parallelogram({-3, 0, 3}, {6, 0, 0}, {0, 0, -6},
                              builder.material({.4f, .4f, .3f}, {.3f, .3f, .3f}, 20));
        builder.sphere({.3f, .3f, .3f}, .3f, builder.material({.5f, .3f, .3f}));
        lit.scene.camera.look({0, 1.2f, 4}, {0, .5f, 0}, 40, 1);
        Estimate one = render(lit.scene, 16, 1024, 1);
        lit.scene.layout.bounces = 1;
        Estimate weighted = render(lit.scene, 16, 1024, 2);
        expect_same((std::string(lit.name) + ": direct light, without and with sampled directions").c_str(), one,
                    weighted);
    }
}

// Three lights chosen from are their sum. All at one height: none stands before another.
void choice()
{
    auto build = [](Scene &scene, int which) {
        Builder builder(scene);
        builder.parallelogram({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, builder.material({.5f, .5f, .5f}));
        scene.camera.look({0, 6, .01f}, {0, 0, 0}, 30, 1);
        if (which < 0 || which == 0)
            builder.sphere_light({-2, 2, -1}, .3f, {8, 8, 8});
        if (which < 0 || which == 1)
            builder.triangle_area_light({2, 2, 1}, {2.5f, 2, 1}, {2, 2.3f, 1.5f}, {40, 30, 20});
        if (which < 0 || which == 2)
            builder.area_light({-2, 2, 1.5f}, {.5f, 0, 0}, {0, 0, .5f}, {20, 20, 10});
    };
    double expected = 0, variance = 0;
    for (int which = 0; which < 3; ++which) {
        Scene scene;
        build(scene, which);
        Estimate part = render(scene, 16, 1024, 10 + static_cast<uint64_t>(which));
        expected += part.mean();
        variance += part.error() * part.error();
    }
    for (uint32_t bounces : {0u, 1u}) {
        Scene scene;
        build(scene, -1);
        scene.layout.choice = true;
        scene.layout.bounces = bounces;
        Estimate all = render(scene, 16, 1024, 20 + bounces);
        expect_same(bounces ? "three lights, with sampled directions" : "three lights", all.mean(), all.error(),
                    expected, std::sqrt(variance));
    }
}

void furnaces()
{
    // White, under an even sky: as bright as the sky.
    Scene ball;
    Builder balls(ball);
    balls.sphere({0, 0, 0}, 1, balls.material({1, 1, 1}));
    balls.environment(constant_sky(.7f));
    ball.camera.look({0, 0, 4}, {0, 0, 0}, 30, 1);
    ball.layout.bounces = 2;
    ball.layout.roulette = true;
    expect_mean("furnace: a white ball under an even sky", render(ball, 16, 256, 4), 0.7);

    // Walls that emit a half and reflect a half: one everywhere, the sum of all lengths of paths.
    for (bool roulette : {true, false}) {
        Scene room;
        Builder walls(room);
        cube(walls, {-1, -1, -1}, 2, walls.material({.5f, .5f, .5f}), true);
        walls.shine(0, {.5f, .5f, .5f});
        room.camera.look({0, 0, .9f}, {.1f, .2f, 0}, 50, 1);
        room.layout.bounces = 3;
        room.layout.roulette = roulette;
        if (roulette)
            expect_mean("furnace: walls that emit and reflect a half, roulette", render(room, 8, 4096, 5), 1);
        else
            expect_mean("furnace: the same, three reflections", render(room, 8, 4096, 5), 0.9375);
    }

    // Glass loses nothing: under an even sky it cannot be seen. Nor can what is in it, if that is white.
    Scene glass;
    Builder globe(glass);
    globe.sphere({0, 0, 0}, 1, globe.dielectric(1.5f));
    cube(globe, {-.3f, -.3f, -.3f}, .5f, globe.material({1, 1, 1}));
    globe.environment(constant_sky(.7f));
    glass.camera.look({0, 0, 4}, {0, 0, 0}, 20, 1);
    glass.layout.bounces = 6;
    glass.layout.roulette = true;
    expect_mean("furnace: a white cube in a globe of glass", render(glass, 16, 256, 6), 0.7);
}

// Direct light through a pane, straight on: two boundaries let .96 through each.
void pane()
{
    Scene scene;
    Builder builder(scene);
    cube(builder, {-.5f, -.5f, -.5f}, 1, builder.dielectric(1.5f));
    builder.area_light({-1, -1, -2}, {2, 0, 0}, {0, 2, 0}, {1, 1, 1});
    scene.camera.look({0, 0, 4}, {0, 0, 0}, .01f, 1);
    expect_near(render(scene, 2, 16, 1).mean(), 0.96 * 0.96, 1e-4, "a light behind a pane");
}

// The same vector in other pixels: other further numbers.
void further_numbers()
{
    const float u[2] = {.25f, .5f};
    auto first = [&](uint32_t x, uint32_t y) { return HashedStream(x, y, u, 2).next(); };
    expect(first(3, 5) == first(3, 5), "further numbers are not those of a pixel and a vector");
    expect(first(3, 5) != first(35, 5) && first(3, 5) != first(5, 3) && first(0, 0) != first(0, 32),
           "further numbers are the same in two pixels");
}

} // namespace

int main()
{
    further_numbers();
    direct_light();
    choice();
    furnaces();
    pane();
    return finish();
}
