// Embree's intersector against the path tracer's own, hit by hit: on random rays through triangles and spheres that
// stand still and that move, then in every scene. Prints a line of JSON for each scene: its size, and how many million
// rays either traces in a second of one core's time.
#include "compare.hpp"
#include "embree.hpp"
#include "load.hpp"
#include "scenes.hpp"
#include "shapes.hpp"
#include "../pathtracer/normals.hpp"

#include "pathtracer/bvh.hpp"
#include <cstdio>

namespace {

using namespace harness;

demo::Geometry jumble(Numbers &numbers)
{
    demo::Geometry geometry;
    add(geometry, shipped("bunny.ply"), 0);
    add(geometry, move({1.2f, 0, 0}) * shipped("teapot.ply"), 1, {.3f, .1f, -.2f});
    add(geometry, move({0, -1.5f, 0}) * box({3, 1, 3}, .2f), 2);
    for (uint32_t i = 0; i < 2000; ++i) {
        demo::Triangle t{{}, {}, 3 + i, static_cast<int32_t>(i % 5) - 1, i % 2 ? numbers.vector(-.2f, .2f) : Vector{}};
        Vector center = numbers.vector(-2, 2);
        for (Vector &corner : t.corner)
            corner = center + numbers.vector(-.15f, .15f);
        for (Vector &normal : t.normal)
            normal = demo::normalize(cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0]) +
                                     numbers.vector(-1e-3f, 1e-3f));
        geometry.triangles.push_back(t);
    }
    for (uint32_t i = 0; i < 200; ++i) {
        Vector center = numbers.vector(-2, 2);
        geometry.spheres.push_back(
            {center, numbers(.02f, .3f), i % 2 ? numbers.vector(-.3f, .3f) : Vector{}, 5000 + i, -1});
    }
    return geometry;
}

void compare_jumble()
{
    Numbers numbers{7};
    const demo::Geometry geometry = jumble(numbers);
    const demo::Bvh own(geometry);
    const EmbreeIntersector embree(geometry);
    Comparison comparison;
    for (int i = 0; i < 400000; ++i) {
        demo::Ray ray{numbers.vector(-3, 3), demo::normalize(numbers.vector(-1, 1) + Vector{1e-6f, 0, 0}),
                      numbers(0, 1)};
        comparison.add(own, embree, ray, numbers(0, 3));
    }
    comparison.check("random rays");
    if (comparison.hits < comparison.rays / 4 || comparison.shadows < comparison.rays / 10)
        throw std::runtime_error("random rays: too few of them hit anything");
}

// Agreement alone would not see an error that both share.
void compare_normals()
{
    const demo::Geometry geometry = test::jumble_of_normals();
    const test::Normals normals = test::normals_of_jumble(geometry, EmbreeIntersector(geometry));
    if (normals.triangles < 2000 || normals.spheres < 2000)
        throw std::runtime_error("normals: too few rays hit anything");
    if (!(normals.worst <= 1e-3))
        throw std::runtime_error("Embree's normals differ from the surfaces' by " + std::to_string(normals.worst));
}

void compare_scene(const demo::SceneEntry &entry)
{
    demo::Scene scene;
    entry.build(0, 1, scene);
    const demo::Bvh own(scene.geometry);
    const EmbreeIntersector embree(scene.geometry);
    Comparison comparison;
    Numbers numbers{11};
    // What the camera sees, and where light goes from there.
    std::vector<demo::Ray> rays;
    while (rays.size() < 40000) {
        demo::Ray ray = scene.camera.ray(numbers(0, 1), numbers(0, 1), numbers(0, 1));
        demo::Hit hit;
        rays.push_back(ray);
        if (!own.closest(ray, hit))
            continue;
        Vector normal = dot(hit.geometric, ray.direction) < 0 ? hit.geometric : -hit.geometric;
        Vector direction = demo::normalize(demo::normalize(numbers.vector(-1, 1)) + 1.01f * normal);
        rays.push_back({ray.origin + hit.distance * ray.direction + 1e-4f * normal, direction, ray.time});
    }
    for (const demo::Ray &ray : rays)
        comparison.add(own, embree, ray, numbers(0, 2));
    comparison.check(entry.name);
    std::printf(
        "{\"scene\":\"%s\",\"dims\":%u,\"triangles\":%zu,\"spheres\":%zu,\"lights\":%zu,\"embree_mrays\":%.2f,\"own_"
        "mrays\":%.2f}\n",
        entry.name.c_str(), demo::dims(scene.layout.domains()), scene.geometry.triangles.size(),
        scene.geometry.spheres.size(), scene.lights.size(), speed(embree, rays), speed(own, rays));
    if (entry.name == "microcity" && scene.geometry.triangles.size() < 100000)
        throw std::runtime_error("microcity has fewer than 100,000 triangles");
}

} // namespace

int main()
{
    try {
        compare_jumble();
        compare_normals();
        for (const demo::SceneEntry &entry : scenes())
            compare_scene(entry);
        return 0;
    } catch (const std::exception &error) {
        std::fprintf(stderr, "agreement: %s\n", error.what());
        return 1;
    }
}
