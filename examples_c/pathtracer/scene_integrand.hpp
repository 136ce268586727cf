// The path tracer: a scene's radiance as a function of the sample vector.
#pragma once

#include "filter.hpp"
#include "hashed_stream.hpp"
#include "known.hpp"
#include "scene.hpp"
#include <algorithm>
#include <mutex>

namespace demo {

class SceneIntegrand : public Integrand {
public:
    // Scene and intersector must outlive it. Throws if the scene's layout does not suit its lights.
    SceneIntegrand(const Scene &scene, const Intersector &intersector, uint32_t width, uint32_t height,
                   Filter filter = Filter::center)
        : SceneIntegrand(scene, intersector, width, height, filter, scene.layout)
    {
    }

protected:
    SceneIntegrand(const Scene &scene, const Intersector &intersector, uint32_t width, uint32_t height, Filter filter,
                   const Layout &layout)
        : scene_(scene), layout_(layout), intersector_(intersector), environment_(scene.environment()),
          width_(static_cast<float>(width)),
          height_(static_cast<float>(height)), filter_(filter)
    {
        layout_.footprint = filter != Filter::center;
        head_ = layout_.head();
        dims_ = dims(domains());
        if (scene.lights.empty() || (scene.lights.size() > 1 && !layout_.choice))
            throw std::runtime_error("the scene has " + std::to_string(scene.lights.size()) +
                                     " lights: it needs one, or a layout with a choice among several");
        auto surrounds = [](const Light &light) { return light.kind == Light::environment; };
        if (std::count_if(scene.lights.begin(), scene.lights.end(), surrounds) > 1)
            throw std::runtime_error(
                "the scene has several environments: rays that leave it would see the first alone");
        choices_ = static_cast<float>(scene.lights.size());
    }

public:

    std::vector<Domain> domains() const override { return layout_.domains(); }
    uint32_t lights() const override { return layout_.choice ? static_cast<uint32_t>(scene_.lights.size()) : 1; }
    bool camera_ray_per_sample() const override { return head_ > 0; }

    void evaluate(uint32_t x, uint32_t y, size_t n, const float *u, float *f, uint32_t *surface,
                  Shown *shown) const override
    {
        float column = static_cast<float>(x) + 0.5f, row = static_cast<float>(y) + 0.5f;
        View view;
        if (surface || (n > 0 && head_ == 0))
            view = center(x, y, surface);
        if (shown && head_ == 0)
            *shown = show(view);
        for (size_t i = 0; i < n; ++i, u += dims_, f += 3) {
            if (head_ > 0)
                view = look(camera_ray(column, row, u));
            if (shown && head_ > 0)
                shown[i] = show(view);
            Color value = view.throughput * radiance(x, y, view, u);
            f[0] = value.x;
            f[1] = value.y;
            f[2] = value.z;
        }
    }

    // Of direct light, where next event estimation is all there is.
    bool has_known() const override
    {
        if (layout_.bounces > 0)
            return false;
        std::call_once(known_once_, [this] { known_ = std::make_unique<KnownLight>(scene_.lights, scene_.materials); });
        return true;
    }

    void known(size_t n, const float *u, const Shown *shown, float *values, float *integral) const override
    {
        Color sum;
        for (size_t i = 0; i < n; ++i, u += dims_, values += 3) {
            const Shown &at = shown[head_ > 0 ? i : 0];
            if (i == 0 || head_ > 0)
                sum += known_->integral(at);
            Color value = known_->sample(at, choose(u + head_), u + head_);
            values[0] = value.x;
            values[1] = value.y;
            values[2] = value.z;
        }
        sum = sum / (head_ > 0 ? static_cast<float>(n) : 1.0f);
        integral[0] = sum.x;
        integral[1] = sum.y;
        integral[2] = sum.z;
    }

protected:
    // Rays start and end this far from surfaces, in units of the scene: more than rounding, less than a visible gap.
    static constexpr float epsilon = 1e-4f;
    // Boundaries of glass that direct light is followed through.
    static constexpr int most_boundaries = 12;

    // Where a ray from the camera ends.
    struct View {
        Ray ray;
        Hit hit;
        bool found = false;
        Color throughput{1, 1, 1}; // of the glass before it
    };

    // What the ray through the pixel's centre and the lens' sees, amid the exposure.
    View center(uint32_t x, uint32_t y, uint32_t *surface) const
    {
        View view = look(
            scene_.camera.ray((static_cast<float>(x) + 0.5f) / width_, (static_cast<float>(y) + 0.5f) / height_, 0.5f));
        if (surface)
            *surface = number(view);
        return view;
    }

    const Scene &scene() const { return scene_; }
    const Intersector &intersector() const { return intersector_; }

    // The ray of a sample, from the numbers before the first vertex's.
    Ray camera_ray(float column, float row, const float *u) const
    {
        if (layout_.footprint) {
            column += footprint(filter_, u[0]);
            row += footprint(filter_, u[1]);
            u += 2;
        }
        float x = column / width_, y = row / height_, time = layout_.time ? *u++ : 0.5f;
        return layout_.lens ? scene_.camera.ray(x, y, time, u[0], u[1]) : scene_.camera.ray(x, y, time);
    }

    // Direct light is seen through glass along one way, that of the larger part at each boundary; the rest is lost.
    View look(const Ray &ray) const
    {
        View view;
        view.ray = ray;
        view.found = intersector_.closest(view.ray, view.hit);
        for (int i = 0; i < most_boundaries && layout_.bounces == 0 && view.found && material(view.hit).specular();
             ++i) {
            Shading s = shading(view.ray, view.hit);
            Boundary boundary(s.normal, s.out, s.material.index, s.inside);
            bool mirrored = boundary.reflectance > 0.5f;
            Vector direction = mirrored ? boundary.reflected : boundary.refracted;
            view.throughput *= white(mirrored ? boundary.reflectance : 1 - boundary.reflectance);
            view.ray = {leave(view.ray, view.hit, s, direction), direction, view.ray.time};
            view.found = intersector_.closest(view.ray, view.hit);
        }
        return view;
    }

    // A number for what the pixel shows: its material and the axis, of six, that its surface faces.
    static uint32_t number(const View &view)
    {
        if (!view.found)
            return 0;
        Vector n = view.hit.shading;
        float x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
        int axis = x > y ? (x > z ? 0 : 2) : (y > z ? 1 : 2);
        return 1 + 6 * view.hit.material + 2 * static_cast<uint32_t>(axis) + (n[axis] > 0);
    }

    Color radiance(uint32_t x, uint32_t y, const View &view, const float *u) const
    {
        if (!view.found)
            return background(view.ray.direction);
        return layout_.bounces == 0 ? direct(view, u + head_) : path(view, u, HashedStream(x, y, u, dims_));
    }

    static Color white(float value) { return {value, value, value}; }
    const Material &material(const Hit &hit) const { return scene_.materials[hit.material]; }
    Color background(Vector direction) const { return environment_ ? environment_->map->radiance(direction) : Color{}; }

    size_t choose(const float *u) const
    {
        return layout_.choice ? std::min(static_cast<size_t>(u[2] * choices_), scene_.lights.size() - 1) : 0;
    }

    Shading shading(const Ray &ray, const Hit &hit) const
    {
        Vector out = -ray.direction;
        bool inside = dot(hit.geometric, out) < 0;
        Vector geometric = inside ? -hit.geometric : hit.geometric;
        Vector normal = dot(hit.shading, geometric) < 0 ? -hit.shading : hit.shading;
        return {material(hit), geometric, normal, out, inside};
    }

    // Where a ray in a direction starts: on that side of the surface.
    static Vector leave(const Ray &ray, const Hit &hit, const Shading &s, Vector direction)
    {
        float side = dot(direction, s.geometric) < 0 ? -epsilon : epsilon;
        return ray.origin + hit.distance * ray.direction + side * s.geometric;
    }

    Color emitted(const Ray &ray, const Hit &hit) const
    {
        return hit.light >= 0 && dot(hit.geometric, ray.direction) < 0
                   ? scene_.lights[static_cast<size_t>(hit.light)].radiance
                   : Color{};
    }

    // Emitted light plus next event estimation with one light.
    Color direct(const View &view, const float *u) const
    {
        Shading s = shading(view.ray, view.hit);
        Color sum = emitted(view.ray, view.hit);
        if (s.material.specular() || s.material.dark())
            return sum;
        Vector from = leave(view.ray, view.hit, s, s.geometric);
        LightSample sample = sample_light(scene_.lights[choose(u)], from, u[0], u[1]);
        return sum + choices_ * connect(s, from, sample, view.ray.time);
    }

    // As `direct` sees it: light is drawn from the same point.
    Shown show(const View &view) const
    {
        if (!view.found || material(view.hit).specular())
            return {};
        Shading s = shading(view.ray, view.hit);
        Shown shown;
        shown.point = leave(view.ray, view.hit, s, s.geometric);
        shown.diffuse = {s.normal, 1, view.throughput * s.material.diffuse};
        // A Phong lobe's integral, and the cosine in its middle for that of every direction.
        float exponent = s.material.exponent, lobe = (exponent + 2) / (exponent + 1) * dot(s.normal, s.out);
        shown.glossy = {reflect(s.out, s.normal), phong_width(exponent),
                        view.throughput * s.material.glossy * std::max(0.0f, lobe)};
        return shown;
    }

    // The light that reaches s.out from a point of a light, divided by the point's density.
    Color connect(const Shading &s, Vector from, const LightSample &sample, float time) const
    {
        if (!(sample.pdf > 0))
            return {};
        Color value = reflectance(s, sample.direction);
        if (black(value) || intersector_.occluded({from, sample.direction, time}, sample.distance - 2 * epsilon))
            return {};
        return value * sample.radiance / sample.pdf;
    }

    // Light over paths of up to layout.bounces reflections. Each reflection is lit by next event estimation and by its
    // sampled direction, if that meets a light; the balance heuristic weights the two (Veach and Guibas 1995).
    Color path(const View &view, const float *u, HashedStream further) const
    {
        Ray ray = view.ray;
        Hit hit = view.hit;
        float drawn[5];
        Color sum = emitted(ray, hit), throughput{1, 1, 1};
        const uint32_t step = layout_.dims_per_bounce();
        const float *numbers = u + head_;
        for (uint32_t bounce = 0; !material(hit).dark(); ++bounce, numbers += step) {
            if (bounce >= layout_.bounces) {
                if (!layout_.roulette || !survives(further, throughput))
                    break;
                numbers = further.draw(drawn, step);
            }
            Shading s = shading(ray, hit);
            Vector direction;
            float pdf = 0; // of the direction times the number of lights; 0 stands for a mirror or glass, which nothing
                           // else finds
            if (s.material.specular()) {
                Boundary boundary(s.normal, s.out, s.material.index, s.inside);
                direction = numbers[step - 2] < boundary.reflectance ? boundary.reflected : boundary.refracted;
            } else {
                sum += throughput * next_event(s, leave(ray, hit, s, s.geometric), numbers, ray.time);
                direction = sample_direction(s, numbers[step - 2], numbers[step - 1]);
                pdf = direction_pdf(s, direction);
                Color value = reflectance(s, direction);
                if (!(pdf > 0) || black(value))
                    break;
                throughput *= value / pdf;
                pdf *= choices_;
            }
            ray = {leave(ray, hit, s, direction), direction, ray.time};
            if (!intersector_.closest(ray, hit)) {
                if (environment_)
                    sum += throughput * background(direction) * met(*environment_, ray, 0, {}, pdf);
                break;
            }
            Color light = emitted(ray, hit);
            if (!black(light))
                sum += throughput * light *
                       met(scene_.lights[static_cast<size_t>(hit.light)], ray, hit.distance, hit.geometric, pdf);
        }
        return sum;
    }

    // Next event estimation with the weight that it has beside sampled directions.
    Color next_event(const Shading &s, Vector from, const float *u, float time) const
    {
        LightSample sample = sample_light(scene_.lights[choose(u)], from, u[0], u[1]);
        if (!(sample.pdf > 0))
            return {};
        float weight = sample.pdf / (sample.pdf + choices_ * direction_pdf(s, sample.direction));
        return connect(s, from, sample, time) * (choices_ * weight);
    }

    // The weight of a light that a sampled direction met.
    static float met(const Light &light, const Ray &ray, float distance, Vector normal, float pdf)
    {
        return pdf > 0 ? pdf / (pdf + light_pdf(light, ray.origin, ray.direction, distance, normal)) : 1.0f;
    }

    // Russian roulette (Arvo and Kirk 1990).
    static bool survives(HashedStream &numbers, Color &throughput)
    {
        float probability = std::min(largest(throughput), 0.95f);
        if (!(numbers.next() < probability))
            return false;
        throughput = throughput / probability;
        return true;
    }

private:
    const Scene &scene_;
    Layout layout_;
    const Intersector &intersector_;
    const Light *environment_;
    float width_, height_, choices_ = 1;
    Filter filter_;
    uint32_t head_ = 0, dims_ = 0; // of the numbers before the first vertex's; of all
    mutable std::once_flag known_once_; // only who asks for what is known waits for its tables
    mutable std::unique_ptr<const KnownLight> known_;
};

} // namespace demo
