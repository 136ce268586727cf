// Direct light by two techniques apart: each sample vector draws one direction towards a light and one by the material.
#pragma once

#include "mis_estimators.hpp"
#include "scene_integrand.hpp"

namespace demo {

// How often a light's sampling draws a direction, whatever stands before the light and whichever side of it shines: per
// solid angle, and 1 integrated over all directions, which optimal weights rely on.
inline float drawing_density(Vector origin, Vector edge1, Vector edge2, Vector normal, bool triangle, float area,
                             Vector from, Vector direction)
{
    float cosine = dot(normal, direction), distance = dot(origin - from, normal) / cosine;
    if (!(distance > 0))
        return 0;
    Vector at = from + distance * direction - origin, across = cross(edge1, edge2);
    float scale = 1 / dot(across, normal), a = dot(cross(at, edge2), normal) * scale,
          b = dot(cross(edge1, at), normal) * scale;
    bool inside = a >= 0 && b >= 0 && (triangle ? a + b <= 1 : a <= 1 && b <= 1);
    return inside ? distance * distance / (std::abs(cosine) * area) : 0.0f;
}

// `is_own`: whether the direction is one that this light's sampling drew: rounding does not put it beside a sphere.
inline float drawing_density(const Light &light, Vector from, Vector direction, bool is_own = false)
{
    switch (light.kind) {
    case Light::parallelogram:
    case Light::triangle:
        return drawing_density(light.origin, light.edge1, light.edge2, light.normal, light.kind == Light::triangle,
                               light.area, from, direction);
    case Light::mesh: {
        float sum = 0;
        for (const LightTriangle &t : light.triangles)
            sum += drawing_density(t.origin, t.edge1, t.edge2, t.normal, true, light.area, from, direction);
        return sum;
    }
    case Light::sphere: {
        // By the sine: the cosines of a small sphere's directions are all alike in float.
        Vector to_center = light.origin - from, aside = cross(to_center, direction);
        bool meets = dot(to_center, direction) > 0 && dot(aside, aside) <= light.radius * light.radius;
        return is_own || meets ? light_pdf(light, from, direction, 0, {}) : 0.0f;
    }
    case Light::environment: break;
    }
    return light.map->pdf(direction);
}

class MisIntegrand final : public SceneIntegrand {
public:
    // As for SceneIntegrand. Throws if a sample would need a camera ray of its own: there are numbers for light and
    // direction only.
    MisIntegrand(const Scene &scene, const Intersector &intersector, uint32_t width, uint32_t height, Filter filter)
        : SceneIntegrand(scene, intersector, width, height, filter, direct_light(scene.layout))
    {
        if (SceneIntegrand::camera_ray_per_sample())
            throw std::runtime_error("--mis takes scenes without lens and motion, and the filter `center`");
    }

    std::vector<Domain> domains() const override { return {{Domain::light, 0, 2}, {Domain::direction, 0, 2}}; }
    uint32_t lights() const override { return 1; }
    uint32_t values() const override { return sizeof(TwoTechniques) / sizeof(float); }

    bool has_known() const override { return false; } // of samples of two techniques

    void evaluate(uint32_t x, uint32_t y, size_t n, const float *u, float *f, uint32_t *surface, Shown *) const override
    {
        const View view = center(x, y, surface);
        const Color emitted_light =
            view.throughput * (view.found ? emitted(view.ray, view.hit) : background(view.ray.direction));
        const bool lit = view.found && !material(view.hit).dark() && !material(view.hit).specular();
        for (size_t i = 0; i < n; ++i, u += 4, f += values()) {
            TwoTechniques pair = {};
            if (lit) {
                Shading s = shading(view.ray, view.hit);
                Vector from = leave(view.ray, view.hit, s, s.geometric);
                const Light *light = nullptr;
                Vector direction = to_light(from, u[0], u[1], light);
                pair.drawn[0] = drawn(view, s, from, direction, light);
                pair.drawn[1] = drawn(view, s, from, sample_direction(s, u[2], u[3]), nullptr);
            }
            store(emitted_light, pair.emitted);
            std::memcpy(f, &pair, sizeof pair);
        }
    }

private:
    static Layout direct_light(Layout layout)
    {
        layout.bounces = 0;
        return layout;
    }

    static void store(Color c, float *to)
    {
        to[0] = c.x;
        to[1] = c.y;
        to[2] = c.z;
    }

    // The first number picks one of several lights, and is then reused.
    Vector to_light(Vector from, float u, float v, const Light *&light) const
    {
        size_t count = scene().lights.size(),
               i = std::min(static_cast<size_t>(u * static_cast<float>(count)), count - 1);
        light = &scene().lights[i];
        return sample_light(*light, from, u * static_cast<float>(count) - static_cast<float>(i), v).direction;
    }

    // `own`: the light that drew the direction, or none.
    Drawn drawn(const View &view, const Shading &s, Vector from, Vector direction, const Light *own) const
    {
        Drawn result = {};
        if (black(direction)) // the point is inside the light
            return result;
        for (const Light &light : scene().lights)
            result.pdf[0] +=
                drawing_density(light, from, direction, &light == own) / static_cast<float>(scene().lights.size());
        result.pdf[1] = direction_pdf(s, direction);
        Color value = reflectance(s, direction);
        if (black(value))
            return result;
        Hit hit;
        Ray ray{from, direction, view.ray.time};
        value *= intersector().closest(ray, hit) ? emitted(ray, hit) : background(direction);
        store(view.throughput * value, result.value);
        return result;
    }
};

} // namespace demo
