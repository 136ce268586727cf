// Two techniques for direct light: densities of what each draws, and estimates that agree with next event estimation
// alone.
#include "../../examples_c/pathtracer/mis_integrand.hpp"
#include "scenes.hpp"

using namespace test;

namespace {

// A light's sampling draws some direction: its density integrates to 1, seen or not, from the front or the back.
void densities(const LitScene &lit)
{
    Random random(31);
    Mean integral;
    const Vector from{.1f, .1f, .2f};
    for (int i = 0; i < 1500000; ++i)
        integral.add(4 * pi * drawing_density(lit.scene.lights[0], from, direction(random)));
    const std::string what = std::string(lit.name) + ": integral of the density of what is drawn";
    expect_mean(what.c_str(), integral, 1, lit.scene.environment() ? 0.2 : 0.05);
    const Light &light = lit.scene.lights[0];
    if (light.kind == Light::environment)
        return;
    constexpr int drawn = 100000;
    int outside = 0, seen = 0;
    for (int i = 0; i < drawn; ++i) {
        float u = random(), v = random();
        LightSample sample = sample_light(light, from, u, v);
        float density = drawing_density(light, from, sample.direction);
        if (sample.pdf == 0) // a back of the mesh
            continue;
        ++seen;
        // At a rim rounding decides whether a direction belongs to the light.
        if (density == 0) {
            ++outside;
            continue;
        }
        expect(density > sample.pdf * 0.99f, "a direction is drawn more often than is said");
        // A mesh has a back, which adds to the density of the front.
        expect(light.kind == Light::mesh || density < sample.pdf * 1.01f,
               "a direction is drawn more seldom than is said");
    }
    std::printf("   %-72s %d of %d\n", (std::string(lit.name) + ": drawn, but of density 0").c_str(), outside, seen);
    expect(outside <= seen / 10000, "directions that are drawn have density 0");
    expect(seen > drawn / 5, "too few directions towards the light are drawn");
}

// A floor with gloss, a ball that hides a part of the light.
void furnish(Scene &scene)
{
    Builder builder(scene);
    builder.parallelogram({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, builder.material({.4f, .4f, .3f}, {.4f, .4f, .4f}, 50));
    builder.sphere({.2f, .4f, .3f}, .3f, builder.material({.5f, .3f, .3f}));
    scene.camera.look({0, 1.2f, 4}, {0, .5f, 0}, 40, 1);
}

struct Estimate {
    double mean, error;
};

// The mean over a coarse image of many estimates.
template <typename Render> Estimate render(uint32_t size, int runs, Render pixel)
{
    Estimate all{0, 0};
    for (uint32_t y = 0; y < size; ++y) {
        for (uint32_t x = 0; x < size; ++x) {
            Mean mean;
            for (int i = 0; i < runs; ++i)
                mean.add(pixel(x, y));
            all.mean += mean.mean() / (size * size);
            all.error += mean.error() * mean.error();
        }
    }
    all.error = std::sqrt(all.error) / (size * size);
    return all;
}

// Balance is unbiased at any number of samples. The others use coefficients from the samples that they are applied to:
// what that costs with 16 pairs must stay below `bias` of the mean.
void estimates(const LitScene &lit, bool several)
{
    constexpr uint32_t size = 6;
    constexpr size_t pairs = 16;
    Bvh bvh(lit.scene.geometry);
    SceneIntegrand direct(lit.scene, bvh, size, size);
    MisIntegrand two(lit.scene, bvh, size, size, Filter::center);
    Random random(77);
    std::vector<float> u(4 * pairs), f(two.values() * pairs);
    auto draw = [&] {
        for (float &value : u)
            value = random();
    };
    Estimate expected = render(size, 60000, [&](uint32_t x, uint32_t y) {
        draw();
        direct.evaluate(x, y, 1, u.data(), f.data(), nullptr, nullptr);
        return luminance({f[0], f[1], f[2]});
    });
    for (const MisEstimatorName &kind : mis_estimator_names) {
        EstimatorSetup setup{4, 4, 2, NF_BASIS_LEGENDRE, 1, 0, 0, 1, pairs, false};
        auto estimator = make_mis_estimator(kind.name, setup);
        Estimate actual = render(size, 1500, [&](uint32_t x, uint32_t y) {
            draw();
            two.evaluate(x, y, pairs, u.data(), f.data(), nullptr, nullptr);
            float mean[3];
            estimator->estimate({u.data(), f.data(), nullptr, 1, 1, pairs}, mean);
            return luminance({mean[0], mean[1], mean[2]});
        });
        std::string what = std::string(several ? "several lights" : lit.name) + ": " + kind.name;
        double bias = kind.optimal || kind.regression ? 0.02 * expected.mean : 0;
        std::printf("   %-72s %.5f  %.5f  +- %.5f\n", what.c_str(), actual.mean, expected.mean,
                    std::hypot(actual.error, expected.error));
        expect_near(actual.mean, expected.mean, 5 * std::hypot(actual.error, expected.error) + bias, what.c_str());
        expect(5 * std::hypot(actual.error, expected.error) < 0.05 * expected.mean, "too noisy to tell");
    }
}

} // namespace

int main()
{
    for (LitScene &lit : lit_scenes()) {
        densities(lit);
        furnish(lit.scene);
        estimates(lit, false);
    }
    LitScene lit;
    Builder builder(lit.scene);
    builder.sphere_light({-1, 1.5f, 0}, .1f, {30, 20, 10});
    builder.sphere_light({1, 1.2f, -.5f}, .6f, {1, 1, 1});
    lit.scene.layout.choice = true;
    furnish(lit.scene);
    estimates(lit, true);
    // Its directions differ from the one to its centre less than cosines in float tell.
    LitScene small{"a small sphere", {}};
    Builder(small.scene).sphere_light({-1, 1.5f, 0}, .001f, {3e5f, 2e5f, 1e5f});
    furnish(small.scene);
    estimates(small, false);
    return finish();
}
