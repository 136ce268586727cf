// The integrand in primary sample space: one pixel's radiance as a function of the sample vector u in [0, 1)^dims,
// divided by the density of what u stands for. Its mean over u is the pixel's value.
//
// The footprint is one ray through the pixel's centre: no dimension is spent on antialiasing, so that `direct` integrates
// over the light's surface alone.
#pragma once

#include "scene.hpp"

namespace demo {

class Integrand {
public:
    Integrand(const Scene &scene, const Intersector &intersector) : scene_(scene), intersector_(intersector) {}

    // Where the ray through the lens' centre, amid the exposure, ends. In most scenes that does not depend on u: it is traced once
    // per pixel.
    struct Pixel {
        float x = 0, y = 0; // in [0, 1] over the image
        bool traced = false, hit = false;
        Ray ray;
        Hit surface;
    };

    Pixel pixel(float x, float y) const
    {
        Pixel pixel;
        pixel.x = x;
        pixel.y = y;
        if (scene_.layout != Layout::motion && scene_.layout != Layout::lens)
            trace(pixel);
        return pixel;
    }

    // A number for what the pixel shows: its material and the axis, of six, that its surface faces.
    uint32_t surface(Pixel &pixel) const
    {
        if (!pixel.traced)
            trace(pixel);
        if (!pixel.hit)
            return 0;
        Vector n = pixel.surface.shading;
        float x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
        int axis = x > y ? (x > z ? 0 : 2) : (y > z ? 1 : 2);
        return 1 + 6 * pixel.surface.material + 2 * static_cast<uint32_t>(axis) + (n[axis] > 0);
    }

    Color operator()(const Pixel &pixel, const float *u) const
    {
        switch (scene_.layout) {
        case Layout::direct: return pixel.hit ? direct(pixel.ray, pixel.surface, u[0], u[1], 0, 1) : Color{};
        case Layout::lights: return pixel.hit ? direct(pixel.ray, pixel.surface, u[0], u[1], choose(u[2]), count()) : Color{};
        case Layout::global: return pixel.hit ? path(pixel.ray, pixel.surface, u) : Color{};
        case Layout::motion: return first(scene_.camera.ray(pixel.x, pixel.y, u[0]), u + 1);
        case Layout::lens: return first(scene_.camera.ray(pixel.x, pixel.y, u[0], u[1]), u + 2);
        }
        return {};
    }

private:
    // Rays start and end this far from surfaces, in units of the scene: more than rounding, less than a visible gap.
    static constexpr float epsilon = 1e-4f;

    void trace(Pixel &pixel) const
    {
        pixel.ray = scene_.camera.ray(pixel.x, pixel.y, 0.5f);
        pixel.hit = intersector_.closest(pixel.ray, pixel.surface);
        pixel.traced = true;
    }

    float count() const { return static_cast<float>(scene_.lights.size()); }

    size_t choose(float u) const
    {
        size_t lights = scene_.lights.size();
        return std::min(static_cast<size_t>(u * static_cast<float>(lights)), lights - 1);
    }

    Shading shading(const Ray &ray, const Hit &hit) const
    {
        Vector out = -ray.direction;
        Vector geometric = dot(hit.geometric, out) < 0 ? -hit.geometric : hit.geometric;
        Vector normal = dot(hit.shading, geometric) < 0 ? -hit.shading : hit.shading;
        return {scene_.materials[hit.material], geometric, normal, out};
    }

    static Vector leave(const Ray &ray, const Hit &hit, const Shading &s)
    {
        return ray.origin + hit.distance * ray.direction + epsilon * s.geometric;
    }

    Color emitted(const Ray &ray, const Hit &hit) const
    {
        if (hit.light < 0)
            return {};
        const Light &light = scene_.lights[static_cast<size_t>(hit.light)];
        bool shines = light.kind == Light::sphere || dot(light.normal, ray.direction) < 0;
        return shines ? light.radiance : Color{};
    }

    Color first(const Ray &ray, const float *u) const
    {
        Hit hit;
        return intersector_.closest(ray, hit) ? direct(ray, hit, u[0], u[1], 0, 1) : Color{};
    }

    // Emitted light plus next event estimation with one light, which was chosen with probability 1 / choices.
    Color direct(const Ray &ray, const Hit &hit, float u, float v, size_t choice, float choices) const
    {
        Shading s = shading(ray, hit);
        Vector from = leave(ray, hit, s);
        LightSample sample = sample_light(scene_.lights[choice], from, u, v);
        return emitted(ray, hit) + choices * connect(s, from, sample, choice, ray.time);
    }

    // The light that reaches s.out from a point of a light, divided by the point's density.
    Color connect(const Shading &s, Vector from, const LightSample &sample, size_t choice, float time) const
    {
        if (!(sample.pdf > 0))
            return {};
        Color value = reflectance(s, sample.direction);
        if (black(value) || intersector_.occluded({from, sample.direction, time}, sample.distance - 2 * epsilon))
            return {};
        return value * scene_.lights[choice].radiance / sample.pdf;
    }

    // Light over paths of up to `bounces` reflections. Each reflection is lit by next event estimation and by its sampled
    // direction, if that meets a light; the balance heuristic weights the two (Veach and Guibas 1995).
    Color path(Ray ray, Hit hit, const float *u) const
    {
        Color sum = emitted(ray, hit), throughput{1, 1, 1};
        for (uint32_t bounce = 0; bounce < bounces && hit.light < 0; ++bounce, u += dims_per_bounce) {
            Shading s = shading(ray, hit);
            Vector from = leave(ray, hit, s);
            size_t choice = choose(u[2]);
            LightSample sample = sample_light(scene_.lights[choice], from, u[0], u[1]);
            float weight = sample.pdf / (sample.pdf + count() * direction_pdf(s, sample.direction));
            if (sample.pdf > 0)
                sum += throughput * connect(s, from, sample, choice, ray.time) * (count() * weight);

            Vector direction = sample_direction(s, u[3], u[4]);
            float pdf = direction_pdf(s, direction);
            Color value = reflectance(s, direction);
            if (!(pdf > 0) || black(value))
                break;
            throughput *= value / pdf;
            ray = {from, direction, ray.time};
            if (!intersector_.closest(ray, hit))
                break;
            Color light = emitted(ray, hit);
            if (!black(light)) {
                const Light &met = scene_.lights[static_cast<size_t>(hit.light)];
                float other = light_pdf(met, ray.origin, direction, hit.distance);
                sum += throughput * light * (pdf * count() / (pdf * count() + other));
            }
        }
        return sum;
    }

    const Scene &scene_;
    const Intersector &intersector_;
};

} // namespace demo
