// Each kind of light: what is sampled, the density that is claimed for it, and what a ray finds there are the same
// thing.
#include "scenes.hpp"

using namespace test;

namespace {

// Irradiance at a point by sampling the light, against sampling directions and looking where they end.
void irradiance(const LitScene &lit, const Bvh &bvh, Vector from, Vector normal, uint64_t seed)
{
    const Light &light = lit.scene.lights[0];
    Random random(seed);
    Mean by_light, by_direction, sampled_share, integrated_share;
    for (int i = 0; i < 400000; ++i) {
        float u = random(), v = random();
        LightSample sample = sample_light(light, from, u, v);
        double value = 0;
        if (sample.pdf > 0 && !bvh.occluded({from, sample.direction, 0}, sample.distance - 2e-4f))
            value = std::max(0.0f, dot(normal, sample.direction)) * luminance(sample.radiance) / sample.pdf;
        by_light.add(value);
        sampled_share.add(sample.pdf > 0 && !bvh.occluded({from, sample.direction, 0}, sample.distance - 2e-4f));
    }
    for (int i = 0; i < 2000000; ++i) {
        Vector d = direction(random);
        Hit hit;
        double value = 0, density = 0;
        if (bvh.closest({from, d, 0}, hit)) {
            if (hit.light >= 0 && dot(hit.geometric, d) < 0) {
                value = luminance(light.radiance);
                density = light_pdf(light, from, d, hit.distance, hit.geometric);
            }
        } else if (light.kind == Light::environment) {
            value = luminance(light.map->radiance(d));
            density = light_pdf(light, from, d, 0, {});
        }
        by_direction.add(value * std::max(0.0f, dot(normal, d)) * 4 * pi);
        integrated_share.add(density * 4 * pi);
    }
    bool peaked = light.kind == Light::environment; // its one bright spot is hard to find by chance
    expect_same((std::string(lit.name) + ": irradiance by light and by direction").c_str(), by_light, by_direction,
                peaked ? 0.2 : 0.03);
    expect_same((std::string(lit.name) + ": share of visible samples, integral of the density").c_str(), sampled_share,
                integrated_share, peaked ? 0.2 : 0.03);
}

// The density that comes with a sample is that of its direction.
void densities(const LitScene &lit, const Bvh &bvh, Vector from)
{
    const Light &light = lit.scene.lights[0];
    Random random(5);
    for (int i = 0; i < 10000; ++i) {
        float u = random(), v = random();
        LightSample sample = sample_light(light, from, u, v);
        expect_near(length(sample.direction), 1, 1e-5, "the length of a sampled direction");
        if (!(sample.pdf > 0))
            continue;
        float density = 0;
        Hit hit;
        if (light.kind == Light::environment) {
            density = light_pdf(light, from, sample.direction, 0, {});
        } else {
            if (bvh.occluded({from, sample.direction, 0}, sample.distance - 2e-4f))
                continue;
            // Rays to a rim may miss it by rounding.
            if (!bvh.closest({from, sample.direction, 0}, hit))
                continue;
            density = light_pdf(light, from, sample.direction, hit.distance, hit.geometric);
        }
        // On the border of two pixels of a map rounding decides; grazing angles magnify it.
        bool border = light.kind == Light::environment && std::abs(density / sample.pdf - 1) > 1e-3f;
        static int borders = 0;
        if (border)
            expect(++borders < 20, "environment: the density of a sample is not that of its direction");
        else
            expect_near(density / sample.pdf, 1, 2e-3, lit.name);
    }
}

// The environment's density integrates to 1 over the sphere: midpoints of a fine grid of the map, exactly in
// proportion.
void environment_density()
{
    auto sky = uneven_sky();
    double sum = 0;
    constexpr int rows = 18 * 40, columns = 37 * 40;
    for (int y = 0; y < rows; ++y) {
        constexpr double pi = 3.14159265358979;
        double theta = pi * (y + 0.5) / rows, area = 2 * pi * pi / rows / columns * std::sin(theta);
        for (int x = 0; x < columns; ++x) {
            double phi = 2 * pi * (x + 0.5) / columns;
            Vector d{static_cast<float>(std::sin(theta) * std::sin(phi)), static_cast<float>(std::cos(theta)),
                     static_cast<float>(std::sin(theta) * std::cos(phi))};
            sum += area * sky->pdf(d);
            if (luminance(sky->radiance(d)) > 0)
                expect(sky->pdf(d) > 0, "environment: light where nothing is sampled");
        }
    }
    expect_near(sum, 1, 1e-4, "environment: the density's integral over the sphere");
}

// What is behind a sun, in its row and in rows below, is sampled too.
void sky_with_a_sun()
{
    constexpr uint32_t width = 64, height = 32;
    std::vector<Color> pixels(width * height, Color{1, 1, 1});
    pixels[10 * width + 5] = {1e10f, 1e10f, 1e10f};
    Environment sky(width, height, pixels);
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
            float theta = pi * (static_cast<float>(y) + 0.5f) / height;
            float phi = 2 * pi * (static_cast<float>(x) + 0.5f) / width;
            Vector d{std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi)};
            expect(sky.pdf(d) > 0, "environment: nothing is sampled behind the sun");
        }
}

} // namespace

int main()
{
    const Vector from{.1f, .1f, .2f}, normal = normalize(Vector{.1f, 1, -.2f});
    for (const LitScene &lit : lit_scenes()) {
        Bvh bvh(lit.scene.geometry);
        irradiance(lit, bvh, from, normal, 11);
        densities(lit, bvh, from);
    }
    environment_density();
    sky_with_a_sun();
    return finish();
}
