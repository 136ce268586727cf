// Area lights: parallelograms (sampled by area, shining on one side) and spheres (sampled by the solid angle that they fill).
#pragma once

#include "vector.hpp"

namespace demo {

struct Light {
    enum Kind { parallelogram, sphere } kind;
    Vector origin;     // a corner, or the centre
    Vector edge1, edge2;
    Vector normal;     // the side that shines: cross(edge1, edge2), unit
    float radius;
    Color radiance;
};

struct LightSample {
    Vector direction; // unit, to the light
    float distance;
    float pdf; // per solid angle; 0: the light does not shine here
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

// The density at which `sample_light` picks the direction to a point of the light, seen from `from`.
inline float light_pdf(const Light &light, Vector from, Vector direction, float distance)
{
    if (light.kind == Light::sphere) {
        Vector to_center = light.origin - from;
        return 1 / cone_angle(cone_cosine(light, to_center), light, to_center);
    }
    float cosine = -dot(light.normal, direction), area = length(cross(light.edge1, light.edge2));
    return cosine > 0 ? distance * distance / (cosine * area) : 0.0f;
}

inline LightSample sample_light(const Light &light, Vector from, float u, float v)
{
    if (light.kind == Light::parallelogram) {
        Vector to = light.origin + u * light.edge1 + v * light.edge2 - from;
        float distance = length(to);
        Vector direction = to / distance;
        return {direction, distance, light_pdf(light, from, direction, distance)};
    }
    Vector to_center = light.origin - from;
    float squared = dot(to_center, to_center);
    if (squared <= light.radius * light.radius)
        return {};
    float limit = cone_cosine(light, to_center);
    float angle = cone_angle(limit, light, to_center);
    float cosine = 1 - u * angle / (2 * pi);
    float sine = std::sqrt(std::max(0.0f, 1 - cosine * cosine)), azimuth = 2 * pi * v;
    Vector direction = Frame(normalize(to_center)).world({sine * std::cos(azimuth), sine * std::sin(azimuth), cosine});
    float inside = std::max(0.0f, light.radius * light.radius - squared * sine * sine);
    return {direction, std::sqrt(squared) * cosine - std::sqrt(inside), 1 / angle};
}

} // namespace demo
