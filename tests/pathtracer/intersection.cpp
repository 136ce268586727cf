// The path tracer's own tree of boxes: rays that run in the boxes' faces, and normals.
#include "normals.hpp"
#include "scenes.hpp"

using namespace test;

namespace {

// A floor of squares with corners at whole numbers, so that many boxes end there.
Geometry floor_of_squares(int half)
{
    Scene scene;
    Builder builder(scene);
    for (int i = -half; i < half; ++i)
        for (int j = -half; j < half; ++j)
            builder.parallelogram({static_cast<float>(i), 0, static_cast<float>(j + 1)}, {1, 0, 0}, {0, 0, -1}, 0);
    return scene.geometry;
}

// Straight down on the squares' edges and corners: in the face planes of the boxes on both sides, whose entry is 0 *
// infinity.
void face_planes()
{
    constexpr int half = 8;
    const Geometry geometry = floor_of_squares(half);
    const Bvh bvh(geometry);
    Random random(3);
    int missed = 0, lit = 0;
    for (float zero : {0.0f, -0.0f}) {
        for (int i = -half; i <= half; ++i) {
            for (int j = -half; j <= half; ++j) {
                const float x = static_cast<float>(i), z = static_cast<float>(j), between = random(-half, half);
                for (Vector from : {Vector{x, 2, z}, Vector{x, 2, between}, Vector{between, 2, z}}) {
                    const Ray ray{from, {zero, -1, zero}, 0};
                    Hit hit;
                    missed += !bvh.closest(ray, hit) || hit.distance != 2;
                    lit += !bvh.occluded(ray, 3);
                }
            }
        }
    }
    std::printf("   %-72s %d  %d\n", "rays in the faces of boxes: missed, not in shadow", missed, lit);
    expect(missed == 0, "a ray in the face of a box falls through the floor");
    expect(lit == 0, "a shadow ray in the face of a box falls through the floor");
    Hit hit;
    expect(!bvh.closest({{8.5f, 2, 0}, {0, -1, 0}, 0}, hit), "a ray beside the floor meets it");
    expect(!bvh.closest({{0, -1, 0}, {0, -1, 0}, 0}, hit), "a ray below the floor, downwards, meets it");
    expect(!bvh.occluded({{0, 2, 0}, {0, -1, 0}, 0}, 1.5f), "a light before the floor is in its shadow");
}

// Small spheres, far away: the distance is rounded to more than a ten thousandth of the radius.
void normals_of_small_spheres()
{
    Geometry geometry;
    const float radius = 1e-3f;
    const Vector center{3, -5, 8};
    geometry.spheres.push_back({center, radius, {}, 0, -1});
    const Bvh bvh(geometry);
    Random random(4);
    double worst = 0;
    Normals normals;
    for (int i = 0; i < 20000; ++i) {
        const Ray ray{{}, normalize(center + 0.9f * radius * direction(random)), 0};
        Hit hit;
        if (!bvh.closest(ray, hit))
            continue;
        worst =
            std::max({worst, std::abs(double(length(hit.shading)) - 1), std::abs(double(length(hit.geometric)) - 1)});
        normals.add(bvh, geometry, ray);
    }
    expect(normals.spheres > 10000, "normals: too few rays hit anything");
    expect_near(worst, 0, 1e-6, "the length of a small sphere's normal");
    // A unit in the last place of the distance, 1e-6, is a thousandth of the radius; more where the ray is flat.
    expect_near(normals.worst, 0, 1e-2, "the direction of a small sphere's normal");
}

void normals()
{
    const Geometry geometry = jumble_of_normals();
    const Normals normals = normals_of_jumble(geometry, Bvh(geometry));
    std::printf("   %-72s %.1e\n", "normals of triangles and spheres, moving, from both sides: largest error",
                normals.worst);
    expect(normals.behind > 1000 && normals.triangles - normals.behind > 1000, "normals: too few rays meet triangles");
    expect(normals.inside > 1000 && normals.spheres - normals.inside > 1000, "normals: too few rays meet spheres");
    expect_near(normals.worst, 0, 1e-3, "normals of triangles and spheres");
}

} // namespace

int main()
{
    face_planes();
    normals_of_small_spheres();
    normals();
    return finish();
}
