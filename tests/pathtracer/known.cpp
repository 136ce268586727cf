// What is known of direct light: closed forms against sums over many directions; the mean of samples against their
// integral; and the estimator that uses nothing else against the plain mean.
#include "../../examples_c/pathtracer/estimators.hpp"
#include "scenes.hpp"

using namespace test;

namespace {

Vector point(Random &random, float size)
{
    float x = random(-size, size), y = random(-size, size);
    return {x, y, random(-size, size)};
}

// As lobe_density, in double.
double density(const Lobe &lobe, Vector64 direction)
{
    double cosine = dot(direction, Vector64(lobe.axis)), square = double(lobe.width) * lobe.width;
    double spread = 1 - (1 - square) * cosine * cosine;
    return cosine > 0 ? square * cosine / (static_cast<double>(pi) * spread * spread) : 0.0;
}

// Midpoints of side * side parts of a triangle or parallelogram, one after the other.
double sum_over_area(const Light &light, Vector from, const Lobe &lobe, int side)
{
    Vector64 normal = light.normal, edge1 = light.edge1, edge2 = light.edge2, sum_at = Vector64(light.origin) - from;
    double sum = 0, area = std::sqrt(dot(cross(edge1, edge2), cross(edge1, edge2))) / side / side;
    auto add = [&](double a, double b, double share) {
        Vector64 to = sum_at + (a / side) * edge1 + (b / side) * edge2;
        double squared = dot(to, to), distance = std::sqrt(squared);
        double cosine = -dot(to, normal) / distance;
        sum += cosine > 0 ? share * area * cosine / squared * density(lobe, (1 / distance) * to) : 0.0;
    };
    for (int i = 0; i < side; ++i) {
        for (int j = 0; j < side; ++j) {
            if (light.kind == Light::parallelogram) {
                add(i + 0.5, j + 0.5, 1);
            } else if (i + j < side) {
                // The square's lower triangle, and its upper one where that is still inside.
                add(i + 1 / 3.0, j + 1 / 3.0, 0.5);
                if (i + j < side - 1)
                    add(i + 2 / 3.0, j + 2 / 3.0, 0.5);
            }
        }
    }
    return sum;
}

// Above the horizon, cut by it and below; at both sides of the light, some near its plane.
void polygons()
{
    Random random(1);
    int cut = 0, behind = 0, flat = 0;
    for (int i = 0; i < 400; ++i) {
        Vector edge1 = point(random, 1), edge2 = point(random, 1), from = point(random, 2);
        Light light = i % 2 ? triangle_light({0, 0, 0}, edge1, edge2, {1, 1, 1})
                            : parallelogram_light({0, 0, 0}, edge1, edge2, {1, 1, 1});
        if (i % 4 == 2)
            from = from - (0.98f * dot(from, light.normal)) * light.normal;
        Vector center = (i % 2 ? 1 / 3.0f : 0.5f) * (edge1 + edge2);
        // Parts must be small beside their distance.
        if (length(from - center) < length(edge1) + length(edge2))
            from = from + (length(edge1) + length(edge2)) * normalize(from - center);
        Lobe lobe;
        lobe.axis = i % 3 ? direction(random) : normalize(cross(point(random, 1), from - center)); // in the horizon
        lobe.width = i % 5 < 3 ? 1.0f : random(0.2f, 1.4f);
        double expected = sum_over_area(light, from, lobe, 200), value = received(light, from, lobe);
        expect_near(value, expected, 1e-4 * expected + 2e-7, "a polygon's light in closed form");
        double low = 1, high = -1;
        for (Vector corner : {Vector{}, edge1, edge2, i % 2 ? edge1 : edge1 + edge2}) {
            low = std::min(low, dot(Vector64(corner) - from, lobe.axis));
            high = std::max(high, dot(Vector64(corner) - from, lobe.axis));
        }
        cut += low < 0 && high > 0 && expected > 0;
        behind += dot(from, light.normal) <= 0;
        flat += i % 4 == 2;
        if (dot(from, light.normal) <= 0 || high <= 0)
            expect(value == 0, "a polygon's light from behind, or below the horizon");
    }
    expect(cut > 50 && behind > 50 && flat > 50, "too few special cases");
}

// As seen from a surface right before it, whose normal is the light's or opposite: half of all directions, or nothing.
void close_polygons()
{
    Light light = parallelogram_light({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, {1, 1, 1});
    Lobe lobe;
    for (float height : {1e-2f, 1e-4f, 1e-6f}) {
        lobe.axis = {0, -1, 0};
        expect_near(received(light, {0.1f, height, 0.2f}, lobe), 1, 2.0 * height * height + 1e-7, "a light close by");
        lobe.axis = {0, 1, 0};
        expect(received(light, {0.1f, height, 0.2f}, lobe) == 0, "a light close by, below the horizon");
        // Its border is the horizon's half: half of the directions shine.
        lobe.axis = {1, 0, 0};
        expect_near(received(light, {0.1f, height, 0.2f}, lobe), 0.5, height + 1e-7, "a light close by, cut in halves");
    }
}

// Small and far away a triangle is a point. The formula's sums must not cancel.
void tiny_triangles()
{
    Random random(2);
    double worst = 0;
    for (int i = 0; i < 3000; ++i) {
        const float size = i % 3 == 0 ? 1e-3f : i % 3 == 1 ? 1e-4f : 1e-5f;
        Light light = triangle_light(direction(random), size * direction(random), size * direction(random), {1, 1, 1});
        Vector64 middle = Vector64(light.origin) + 1 / 3.0 * (Vector64(light.edge1) + Vector64(light.edge2));
        Vector64 across = cross(light.edge1, light.edge2);
        double squared = dot(middle, middle), facing = -dot(across, middle) / 2 / squared / std::sqrt(squared);
        Lobe lobe;
        lobe.axis = direction(random);
        if (std::abs(dot(Vector64(lobe.axis), middle)) < 0.1 || facing * squared < 0.05 * size * size)
            continue;
        double expected = facing * density(lobe, 1 / std::sqrt(squared) * middle);
        if (expected == 0)
            expect(received(light, {}, lobe) == 0, "a tiny triangle below the horizon");
        else
            worst = std::max(worst, std::abs(received(light, {}, lobe) / expected - 1));
    }
    std::printf("   tiny triangles: worst relative error %.2g\n", worst);
    expect(worst < 2e-5, "a tiny triangle far away"); // of the point, for the largest
}

// A mesh by its outlines, and triangle by triangle: above the horizon, cut by it, right above, within.
void meshes()
{
    Scene scene;
    Builder builder(scene);
    uint32_t material = builder.material({});
    cube(builder, {-.2f, 1, -.3f}, .6f, material);
    builder.parallelogram({-1.3f, 1.4f, -.2f}, {.5f, 0, 0}, {0, .1f, .5f}, material);
    builder.shine(0, {1, 1, 1});
    size_t first = builder.triangles();
    builder.knot({0, 0, 0}, .138f, material);
    builder.shine(first, {1, 1, 1});
    Random random(6);
    for (const Light &light : scene.lights) {
        const MeshOutline outline(light);
        int cut = 0;
        double worst = 0;
        for (int i = 0; i < 300; ++i) {
            Vector from = point(random, 2);
            Lobe lobe;
            lobe.axis = direction(random);
            lobe.width = i % 2 ? 1.0f : random(0.2f, 1);
            double low = 1, high = -1;
            for (const LightTriangle &t : light.triangles) {
                low = std::min(low, dot(Vector64(t.origin) - from, lobe.axis));
                high = std::max(high, dot(Vector64(t.origin) - from, lobe.axis));
            }
            cut += low < 0 && high > 0;
            double expected = received(light, from, lobe), value = outline.received(from, lobe);
            worst = std::max(worst, std::abs(value - expected) / (expected + 1e-3));
        }
        std::printf("   a mesh of %zu triangles: worst relative error %.2g\n", light.triangles.size(), worst);
        expect(cut > 50, "too few meshes are cut by the horizon");
        expect(worst < 1e-5, "a mesh by its outlines");
    }
}

void spheres()
{
    Random random(3);
    int cut = 0;
    for (int i = 0; i < 200; ++i) {
        Lobe lobe;
        lobe.axis = direction(random);
        Vector center = random(1.05f, 3) * direction(random);
        if (i % 2) // near the horizon
            center = normalize(center - (0.9f * dot(center, lobe.axis)) * lobe.axis) * length(center);
        Light light = sphere_light(center, i % 4 ? 1.0f : 0.1f, {1, 1, 1});
        const Vector64 to = center;
        const double squared = dot(to, to), sine2 = double(light.radius) * light.radius / squared;
        const Vector64 axis = 1 / std::sqrt(squared) * to;
        Frame frame(normalize(center));
        double sum = 0;
        constexpr int side = 500;
        for (int a = 0; a < side; ++a) {
            // Rings of equal solid angle.
            double cosine = 1 - (a + 0.5) / side * (1 - std::sqrt(1 - sine2)), sine = std::sqrt(1 - cosine * cosine);
            for (int b = 0; b < side; ++b) {
                double angle = 2 * static_cast<double>(pi) * (b + 0.5) / side;
                sum += density(lobe, cosine * axis + sine * std::cos(angle) * Vector64(frame.s) +
                                         sine * std::sin(angle) * Vector64(frame.t));
            }
        }
        double expected = sum / side / side * 2 * static_cast<double>(pi) * (1 - std::sqrt(1 - sine2));
        double value = received(light, {}, lobe);
        expect_near(value, expected, 1e-5 * expected + 1e-6 * sine2, "a sphere's light in closed form");
        double up = dot(axis, Vector64(lobe.axis));
        cut += up * up < sine2;
        if (up < -std::sqrt(sine2))
            expect(value == 0, "a sphere below the horizon");
    }
    expect(cut > 50, "too few spheres are cut by the horizon");
    Lobe lobe;
    lobe.axis = {0, 1, 0};
    expect(received(sphere_light({.1f, .2f, .3f}, 1, {1, 1, 1}), {}, lobe) == 0, "within a sphere that shines");
}

// Against midpoints of a grid that is finer than the table's own, and not a multiple of it.
void environments()
{
    auto sky = uneven_sky();
    constexpr int rows = 18 * 47, columns = 37 * 47;
    for (float width : {1.0f, phong_width(20)}) {
        const EnvironmentTable table(*sky, width);
        const Vector axes[4] = {{0, 1, 0}, normalize({.3f, -.2f, .9f}), normalize({-.8f, .1f, -.3f}), {0, 0, -1}};
        double sums[4] = {};
        for (int y = 0; y < rows; ++y) {
            constexpr double pi = 3.14159265358979;
            double theta = pi * (y + 0.5) / rows, area = 4 * pi / columns * std::sin(theta) * std::sin(pi / 2 / rows);
            for (int x = 0; x < columns; ++x) {
                double phi = 2 * pi * (x + 0.5) / columns;
                Vector d{static_cast<float>(std::sin(theta) * std::sin(phi)), static_cast<float>(std::cos(theta)),
                         static_cast<float>(std::sin(theta) * std::cos(phi))};
                float radiance = sky->radiance(d).x;
                for (int i = 0; i < 4; ++i)
                    sums[i] += area * table.density(axes[i], d) * radiance;
            }
        }
        for (int i = 0; i < 4; ++i)
            expect_near(table.integral(axes[i]).x / sums[i], 1, 1e-4, "an environment's light from the table");
    }
}

// Lights of each kind; several; rays of each sample's own. The floor is glossy, a ball moves above it.
std::vector<LitScene> known_scenes()
{
    std::vector<LitScene> all = lit_scenes();
    all.push_back({"several lights", {}});
    Scene &several = all.back().scene;
    several.layout.choice = true;
    Builder lights(several);
    lights.sphere_light({-1, 1.2f, -.4f}, .3f, {4, 3, 2});
    lights.area_light({.4f, 1.5f, -.3f}, {.8f, .2f, 0}, {.1f, -.1f, .6f}, {3, 4, 5});
    lights.environment(constant_sky(.7f));
    all.push_back({"lens and motion", {}});
    Scene &moving = all.back().scene;
    moving.layout.lens = moving.layout.time = true;
    moving.camera.aperture = 0.1f;
    moving.camera.focus = 4;
    Builder(moving).area_light({-.7f, 3, -.3f}, {1.1f, .2f, 0}, {.2f, -.1f, .9f}, {20, 30, 10});
    // The sky is seen beside the floor: light that is not known, as much or as little as a lens lets through.
    all.push_back({"lens and motion under the sky", {}});
    Scene &outside = all.back().scene;
    outside.layout.lens = outside.layout.time = outside.layout.choice = true;
    outside.camera.aperture = 0.1f;
    outside.camera.focus = 4;
    Builder sky(outside);
    sky.sphere_light({-1, 1.2f, -.4f}, .3f, {4, 3, 2});
    sky.environment(constant_sky(.7f));
    for (LitScene &lit : all) {
        Builder builder(lit.scene);
        builder.parallelogram({-3, 0, 3}, {6, 0, 0}, {0, 0, -6},
                              builder.material({.4f, .4f, .3f}, {.3f, .3f, .3f}, 20));
        builder.sphere({.3f, .3f, .3f}, .3f, builder.material({.5f, .3f, .3f}), {.1f, .2f, 0});
        lit.scene.camera.look({0, 1.2f, 4}, {0, .5f, 0}, 40, 1);
    }
    return all;
}

constexpr uint32_t size = 16;

float brightness(const float *rgb) { return luminance({rgb[0], rgb[1], rgb[2]}); }

// What is known of samples has the mean that is said. Of all pixels, and relative to their integrals.
void means(const LitScene &lit)
{
    Bvh bvh(lit.scene.geometry);
    SceneIntegrand integrand(lit.scene, bvh, size, size);
    constexpr size_t n = 64;
    const uint32_t count = dims(integrand.domains());
    expect(integrand.has_known(), "direct light is not known");
    Random random(4);
    std::vector<float> u(n * count), f(3 * n), values(3 * n);
    std::vector<Shown> shown(n);
    Mean difference;
    for (uint32_t pass = 0; pass < 64; ++pass) {
        for (uint32_t p = 0; p < size * size; ++p) {
            for (float &value : u)
                value = random();
            float integral[3];
            integrand.evaluate(p % size, p / size, n, u.data(), f.data(), nullptr, shown.data());
            integrand.known(n, u.data(), shown.data(), values.data(), integral);
            double sum = 0;
            for (size_t i = 0; i < n; ++i)
                sum += brightness(&values[3 * i]) / n;
            if (brightness(integral) > 0)
                difference.add(sum / brightness(integral) - 1);
            else
                expect(sum == 0, "known samples without an integral");
        }
    }
    expect_zero((std::string(lit.name) + ": known samples, less their integral").c_str(), difference, 0.02);
}

// The estimator that corrects by what is known alone.
void estimates(const LitScene &lit)
{
    Bvh bvh(lit.scene.geometry);
    SceneIntegrand integrand(lit.scene, bvh, size, size);
    const std::vector<Domain> domains = integrand.domains();
    const uint32_t count = dims(domains), pixels = size * size;
    integrand.has_known();
    Random random(5);
    Mean plain, known;
    double plain_square = 0, known_square = 0; // of differences from the other passes' mean, summed over pixels
    constexpr size_t n = 2, passes = 4000;
    EstimatorSetup setup{count, count, 1, NF_BASIS_LEGENDRE, integrand.lights(), choice(domains), 0, size, n, false};
    auto estimator = make_estimator("known", setup);
    std::vector<float> u(pixels * n * count), f(3 * pixels * n), values(f.size()), integrals(3 * pixels);
    std::vector<float> images(3 * pixels), sums(2 * pixels), squares(2 * pixels);
    std::vector<Shown> shown(n);
    std::vector<uint32_t> surface(pixels);
    for (uint32_t pass = 0; pass < passes; ++pass) {
        for (float &value : u)
            value = random();
        double mean = 0, corrected = 0;
        for (uint32_t p = 0; p < pixels; ++p) {
            const float *at = &u[p * n * count];
            integrand.evaluate(p % size, p / size, n, at, &f[3 * p * n], &surface[p], shown.data());
            integrand.known(n, at, shown.data(), &values[3 * p * n], &integrals[3 * p]);
        }
        estimator->estimate({u.data(), f.data(), surface.data(), size, size, n, values.data(), integrals.data()},
                            images.data());
        for (uint32_t p = 0; p < pixels; ++p) {
            float value[2] = {0, brightness(&images[3 * p])};
            for (size_t i = 0; i < n; ++i)
                value[0] += brightness(&f[3 * (p * n + i)]) / n;
            mean += value[0] / pixels;
            corrected += value[1] / pixels;
            for (size_t e = 0; e < 2; ++e) {
                sums[2 * p + e] += value[e];
                squares[2 * p + e] += value[e] * value[e];
            }
        }
        plain.add(mean);
        known.add(corrected);
    }
    for (uint32_t p = 0; p < pixels; ++p) {
        plain_square += squares[2 * p] - sums[2 * p] * sums[2 * p] / passes;
        known_square += squares[2 * p + 1] - sums[2 * p + 1] * sums[2 * p + 1] / passes;
    }
    expect_same((std::string(lit.name) + ": the plain mean, `known`").c_str(), plain, known, 0.01);
    std::printf("   %-72s %.3f\n", "its variance, of the plain mean's", known_square / plain_square);
    expect(known_square < 0.9 * plain_square, "`known` gains nothing");
}

} // namespace

int main()
{
    polygons();
    close_polygons();
    tiny_triangles();
    meshes();
    spheres();
    environments();
    for (const LitScene &lit : known_scenes()) {
        means(lit);
        estimates(lit);
    }
    return finish();
}
