// Direct light with nothing in its way, by the diffuse term alone: of each sample, and its exact integral over all
// samples. Shadows, the glossy lobe and the geometric normal are what it leaves out.
#pragma once

#include "environment_table.hpp"
#include "integrand.hpp"
#include "irradiance.hpp"

namespace demo {

class KnownLight {
public:
    // `lights` must outlive it.
    explicit KnownLight(const std::vector<Light> &lights) : lights_(lights)
    {
        for (const Light &light : lights)
            if (light.kind == Light::environment)
                table_ = std::make_unique<EnvironmentTable>(*light.map);
    }

    // Of light number `picked`, which is one of so many, at u[2].
    Color sample(const Shown &shown, size_t picked, const float *u) const
    {
        const Light &light = lights_[picked];
        LightSample sample = sample_light(light, shown.point, u[0], u[1]);
        if (!(sample.pdf > 0))
            return {};
        float cosine = light.kind == Light::environment ? table_->cosine(shown.normal, sample.direction)
                                                        : std::max(0.0f, dot(shown.normal, sample.direction));
        return shown.diffuse * sample.radiance * (cosine * static_cast<float>(lights_.size()) / (pi * sample.pdf));
    }

    // The mean of `sample` over all u, every light as likely.
    Color integral(const Shown &shown) const
    {
        Color sum;
        for (const Light &light : lights_)
            sum += light.kind == Light::environment
                       ? table_->irradiance(shown.normal)
                       : light.radiance * static_cast<float>(irradiance(light, shown.point, shown.normal));
        return shown.diffuse * sum / pi;
    }

private:
    const std::vector<Light> &lights_;
    std::unique_ptr<EnvironmentTable> table_;
};

} // namespace demo
