// Lights: flat ones and meshes (sampled by area, shining on one side), spheres (sampled by the solid angle that they
// fill) and environments (importance-sampled). Each takes two numbers.
#pragma once

#include "environment.hpp"
#include <limits>
#include <memory>

namespace demo {

struct LightTriangle {
    Vector origin, edge1, edge2;
    Vector normal; // unit, along cross(edge1, edge2): the side that shines

    LightTriangle(Vector corner, Vector e1, Vector e2)
        : origin(corner), edge1(e1), edge2(e2), normal(normalize(cross(e1, e2)))
    {
    }
};

struct Light {
    enum Kind { parallelogram, triangle, sphere, mesh, environment } kind;
    Color radiance; // not of environments: their map says it
    Vector origin;  // a corner, or the centre
    Vector edge1, edge2;
    Vector normal; // of flat ones, unit: the side that shines
    float radius = 0;
    float area = 0;                        // of all but spheres and environments
    std::vector<LightTriangle> triangles;  // of meshes
    std::vector<float> areas;              // of the triangles, summed up to each
    std::shared_ptr<const Environment> map; // of environments
};

inline Light parallelogram_light(Vector corner, Vector edge1, Vector edge2, Color radiance)
{
    return {Light::parallelogram,        radiance, corner, edge1, edge2, normalize(cross(edge1, edge2)), 0,
            length(cross(edge1, edge2)), {},       {},     {}};
}

inline Light triangle_light(Vector corner, Vector edge1, Vector edge2, Color radiance)
{
    return {Light::triangle,
            radiance,
            corner,
            edge1,
            edge2,
            normalize(cross(edge1, edge2)),
            0,
            length(cross(edge1, edge2)) / 2,
            {},
            {},
            {}};
}

inline Light sphere_light(Vector center, float radius, Color radiance)
{
    return {Light::sphere, radiance, center, {}, {}, {}, radius, 0, {}, {}, {}};
}

inline Light mesh_light(std::vector<LightTriangle> triangles, Color radiance)
{
    Light light{Light::mesh, radiance, {}, {}, {}, {}, 0, 0, std::move(triangles), {}, {}};
    double area = 0;
    for (const LightTriangle &t : light.triangles)
        light.areas.push_back(static_cast<float>(area += length(cross(t.edge1, t.edge2)) / 2));
    light.area = static_cast<float>(area);
    if (!(area > 0))
        throw std::runtime_error("a mesh of " + std::to_string(light.triangles.size()) +
                                 " triangles without area cannot be a light");
    return light;
}

inline Light environment_light(std::shared_ptr<const Environment> map)
{
    return {Light::environment, {}, {}, {}, {}, {}, 0, 0, {}, {}, std::move(map)};
}

struct LightSample {
    Vector direction; // unit, to the light
    float distance = 0;
    float pdf = 0; // per solid angle; 0: the light does not shine here
    Color radiance;
};

inline float cone_cosine(const Light &light, Vector to_center)
{
    float ratio = light.radius * light.radius / dot(to_center, to_center);
    return std::sqrt(std::max(0.0f, 1 - ratio));
}

// 2 pi (1 - cosine), without the cancellation for small lights.
inline float cone_angle(float cosine, const Light &light, Vector to_center)
{
    float ratio = light.radius * light.radius / dot(to_center, to_center);
    return 2 * pi * ratio / (1 + cosine);
}

// The density at which `sample_light` picks the direction to a point of the light, seen from `from`. `normal`: of the
// light at that point, unit; spheres and environments do not need it.
inline float light_pdf(const Light &light, Vector from, Vector direction, float distance, Vector normal)
{
    if (light.kind == Light::environment)
        return light.map->pdf(direction);
    if (light.kind == Light::sphere) {
        Vector to_center = light.origin - from;
        if (dot(to_center, to_center) <= light.radius * light.radius)
            return 0;
        return 1 / cone_angle(cone_cosine(light, to_center), light, to_center);
    }
    float cosine = -dot(normal, direction);
    return cosine > 0 ? distance * distance / (cosine * light.area) : 0.0f;
}

// The point at (u, v) of a surface that `from` may see.
inline LightSample sample_surface(const Light &light, Vector point, Vector normal, Vector from)
{
    Vector to = point - from;
    float distance = length(to);
    Vector direction = to / distance;
    return {direction, distance, light_pdf(light, from, direction, distance, normal), light.radiance};
}

inline Vector triangle_point(Vector corner, Vector edge1, Vector edge2, float u, float v)
{
    float root = std::sqrt(u);
    return corner + (1 - root) * edge1 + v * root * edge2;
}

// One triangle of a mesh is picked by area with u, which is then reused: what (u, v) stands for jumps from triangle to
// triangle.
inline LightSample sample_mesh(const Light &light, Vector from, float u, float v)
{
    float at = u * light.area;
    size_t i = static_cast<size_t>(std::upper_bound(light.areas.begin(), light.areas.end(), at) - light.areas.begin());
    i = std::min(i, light.areas.size() - 1);
    float before = i ? light.areas[i - 1] : 0.0f, area = light.areas[i] - before;
    const LightTriangle &t = light.triangles[i];
    float rest = area > 0 ? std::min((at - before) / area, 1.0f) : 0.5f;
    return sample_surface(light, triangle_point(t.origin, t.edge1, t.edge2, rest, v), t.normal, from);
}

inline LightSample sample_sphere(const Light &light, Vector from, float u, float v)
{
    Vector to_center = light.origin - from;
    float squared = dot(to_center, to_center);
    if (squared <= light.radius * light.radius)
        return {};
    float limit = cone_cosine(light, to_center);
    float angle = cone_angle(limit, light, to_center);
    float x, y;
    concentric_disc(u, v, x, y);
    // A disc and a cap have the same area where squared radii are in proportion to 1 - cosine.
    float part = std::min(1.0f, x * x + y * y), height = part * angle / (2 * pi), cosine = 1 - height;
    float sine = std::sqrt(height * (1 + cosine)), scale = part > 0 ? sine / std::sqrt(part) : 0.0f;
    Vector direction = Frame(normalize(to_center)).world({scale * x, scale * y, cosine});
    float inside = std::max(0.0f, light.radius * light.radius - squared * sine * sine);
    return {direction, std::sqrt(squared) * cosine - std::sqrt(inside), 1 / angle, light.radiance};
}

inline LightSample sample_light(const Light &light, Vector from, float u, float v)
{
    switch (light.kind) {
    case Light::parallelogram:
        return sample_surface(light, light.origin + u * light.edge1 + v * light.edge2, light.normal, from);
    case Light::triangle:
        return sample_surface(light, triangle_point(light.origin, light.edge1, light.edge2, u, v), light.normal, from);
    case Light::sphere: return sample_sphere(light, from, u, v);
    case Light::mesh: return sample_mesh(light, from, u, v);
    case Light::environment: break;
    }
    LightSample sample;
    sample.direction = light.map->sample(u, v, sample.pdf);
    sample.distance = std::numeric_limits<float>::infinity();
    sample.radiance = light.map->radiance(sample.direction);
    return sample;
}

} // namespace demo
