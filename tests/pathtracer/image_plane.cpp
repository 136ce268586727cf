// The pixel's footprint, the lens, motion, and Sobol points' trees.
#include "../../examples_c/pathtracer/sobol.hpp"
#include "scenes.hpp"

using namespace test;

namespace {

void footprints()
{
    double second = 0;
    constexpr int steps = 100000;
    for (int i = 0; i < steps; ++i) {
        float u = (static_cast<float>(i) + 0.5f) / steps, x = footprint(Filter::gaussian, u);
        expect(std::abs(x) <= 1.501f, "gaussian: beyond 1.5 pixels");
        // The normal distribution, cut and normalised.
        expect_near(std::erf(x / (0.5 * std::sqrt(2.0))) / 0.9973002, 2.0 * u - 1, 2e-5, "gaussian: its distribution");
        second += double(x) * x / steps;
        expect_near(footprint(Filter::box, u), u - 0.5, 1e-6, "box");
    }
    expect_near(second, 0.25 * 0.973337, 1e-3, "gaussian: its variance, cut at three standard deviations");
}

void lens()
{
    // Rays through all of the lens meet in the plane that is sharp, and the lens is covered evenly: its moments up to
    // the second are those of the disc.
    Camera camera;
    camera.look({0, 0, 5}, {0, 0, 0}, 40, 1);
    camera.aperture = 0.3f;
    camera.focus = 4;
    Random random(9);
    Mean x, y, xx, yy, xy;
    Ray center = camera.ray(.3f, .7f, 0);
    Vector sharp = center.origin + (4 / -center.direction.z) * center.direction;
    for (int i = 0; i < 1000000; ++i) {
        float u = random(), v = random();
        Ray ray = camera.ray(.3f, .7f, 0.25f, u, v);
        Vector from = ray.origin - camera.eye, at = ray.origin + (4 / -ray.direction.z) * ray.direction;
        // In units of the aperture, in the plane of the lens.
        const double a = from.x / 0.3, b = from.y / 0.3;
        x.add(a);
        y.add(b);
        xx.add(a * a);
        yy.add(b * b);
        xy.add(a * b);
        expect_near(from.z, 0, 1e-6, "the plane of the lens");
        expect_near(length(at - sharp), 0, 1e-4, "focus");
        expect_near(ray.time, 0.25, 0, "the time of a ray through the lens");
    }
    expect_zero("lens: mean, across", x, 0.005);
    expect_zero("lens: mean, upwards", y, 0.005);
    expect_mean("lens: mean square, across", xx, 0.25, 0.01);
    expect_mean("lens: mean square, upwards", yy, 0.25, 0.01);
    expect_zero("lens: mean product", xy, 0.005);
}

// Moving triangles at a time are still ones that stand where they then are.
void motion()
{
    Scene moving;
    Builder builder(moving);
    uint32_t material = builder.material({.5f, .5f, .5f});
    cube(builder, {-.5f, -.5f, -.5f}, .7f, material);
    const Vector motion{.6f, .3f, -.4f};
    builder.move(0, motion);
    builder.parallelogram({-2, -1, 2}, {4, 0, 0}, {0, 0, -4}, material);
    Bvh all(moving.geometry);
    Random random(21);
    int hits = 0;
    for (float time : {0.0f, 0.35f, 1.0f}) {
        Scene still;
        Builder other(still);
        cube(other, Vector{-.5f, -.5f, -.5f} + time * motion, .7f, other.material({}));
        other.parallelogram({-2, -1, 2}, {4, 0, 0}, {0, 0, -4}, 0);
        Bvh frozen(still.geometry);
        for (int i = 0; i < 20000; ++i) {
            Ray ray{3 * direction(random), direction(random), time};
            Hit a, b;
            bool hit = all.closest(ray, a), expected = frozen.closest(ray, b);
            hits += hit;
            if (hit != expected || (hit && std::abs(a.distance - b.distance) > 1e-3f))
                expect(false, "motion: a ray meets another surface than that which is there");
        }
    }
    expect(hits > 1000, "motion: too few rays hit anything");
}

// A sampler's trees, whose keys are `golden` apart, share no bits.
void trees()
{
    Mean same;
    for (uint64_t k = 0; k < 10000; ++k) {
        const uint64_t key = mix(k);
        const demo::Tree tree(key), next(key + golden);
        for (uint32_t node = 0; node < 64; ++node)
            same.add(tree.flip(64 + node) == next.flip(node));
    }
    expect_near(same.mean(), 0.5, 5 * same.error(), "Sobol points: a bit of one tree and of the next");
}

} // namespace

int main()
{
    footprints();
    trees();
    lens();
    motion();
    return finish();
}
