// Materials: densities that integrate to 1, directions drawn by them, energy kept; glass by the laws of Snell and
// Fresnel.
#include "scenes.hpp"

using namespace test;

namespace {

void reflection(const char *name, const Material &m, Vector out)
{
    const Vector normal{0, 0, 1};
    Shading s{m, normal, normal, out, false};
    Random random(3);
    Mean density, uniform, sampled;
    for (int i = 0; i < 1000000; ++i) {
        Vector d = direction(random);
        density.add(direction_pdf(s, d) * 4 * pi);
        uniform.add(luminance(reflectance(s, d)) * 4 * pi);
        float u = random(), v = random();
        Vector in = sample_direction(s, u, v);
        float pdf = direction_pdf(s, in);
        sampled.add(pdf > 0 ? luminance(reflectance(s, in)) / pdf : 0.0f);
        if (i < 1000 && d.z > 0) {
            Shading turned{m, normal, normal, d, false};
            expect_near(reflectance(s, d).x / d.z, reflectance(turned, out).x / out.z, 1e-3, "reciprocity");
        }
    }
    std::string what(name);
    expect_mean((what + ": integral of the density").c_str(), density, 1, 0.04);
    expect_same((what + ": reflected light, drawn and uniform").c_str(), sampled, uniform, 0.04);
    expect(sampled.mean() <= luminance(m.diffuse) + luminance(m.glossy) + 0.01, "more light is reflected than arrives");
}

void glass()
{
    const float index = 1.5f;
    const Vector normal{0, 0, 1};
    expect_near(Boundary(normal, normal, index, false).reflectance, 0.04, 1e-6, "glass seen straight on");
    // Brewster's angle: only one polarisation is mirrored, ((n^2 - 1) / (n^2 + 1))^2 of it.
    float brewster = std::atan(index);
    Boundary polarised(normal, {std::sin(brewster), 0, std::cos(brewster)}, index, false);
    expect_near(polarised.reflectance, 0.5 * std::pow((2.25 - 1) / (2.25 + 1), 2), 1e-5, "glass at Brewster's angle");
    for (float angle = 0.01f; angle < 1.57f; angle += 0.01f) {
        Vector out{std::sin(angle), 0, std::cos(angle)};
        Boundary in(normal, out, index, false);
        expect_near(-in.refracted.x * index, out.x, 1e-5, "Snell's law");
        expect_near(length(in.refracted), 1, 1e-5, "the length of a refracted direction");
        expect(in.refracted.z < 0 && in.reflected.z > 0, "the sides of refraction and reflection");
        // The same way back: from inside, along the refracted ray.
        Boundary back(-normal, in.refracted, index, true);
        expect_near(back.reflectance, in.reflectance, 1e-3, "glass from both sides");
        expect_near(back.refracted.x, out.x, 1e-3, "a path and its reverse");
        // Beyond the critical angle nothing leaves.
        Boundary inside(normal, out, index, true);
        expect((inside.reflectance == 1) == (out.x * index >= 1), "total reflection");
    }
}

} // namespace

int main()
{
    const Vector out = normalize(Vector{.5f, -.2f, .8f}), grazing = normalize(Vector{.9f, .3f, .15f});
    Material matt, shiny, both;
    matt.diffuse = {.8f, .5f, .2f};
    shiny.glossy = {.7f, .6f, .9f};
    shiny.exponent = 40;
    both.diffuse = {.3f, .2f, .1f};
    both.glossy = {.2f, .5f, .6f};
    both.exponent = 12;
    reflection("diffuse", matt, out);
    reflection("glossy", shiny, out);
    reflection("both", both, out);
    reflection("both, grazing", both, grazing);
    glass();
    return finish();
}
