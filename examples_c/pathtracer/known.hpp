// Direct light with nothing in its way: of each sample, and its exact integral over all samples. Reflection is that of
// lobes which light can be integrated over: the diffuse one, and one that stands for the glossy one. Geometric normals
// do not count, and spheres are not seen in glossy lobes.
#pragma once

#include "environment_table.hpp"
#include "material.hpp"
#include "mesh_outline.hpp"

namespace demo {

class KnownLight {
public:
    // `lights` must outlive it.
    KnownLight(const std::vector<Light> &lights, const std::vector<Material> &materials) : lights_(lights)
    {
        for (const Light &light : lights) {
            outlines_.push_back(light.kind == Light::mesh ? std::make_unique<MeshOutline>(light) : nullptr);
            if (light.kind != Light::environment)
                continue;
            for (const Material &material : materials) {
                tabulate(*light.map, 1);
                if (!black(material.glossy))
                    tabulate(*light.map, phong_width(material.exponent));
            }
        }
    }

    // Of u[2] on light number `picked`, which is one of as many as there are.
    Color sample(const Shown &shown, size_t picked, const float *u) const
    {
        const Light &light = lights_[picked];
        LightSample sample = sample_light(light, shown.point, u[0], u[1]);
        if (!(sample.pdf > 0))
            return {};
        Color reflected;
        for (const Lobe &lobe : {shown.diffuse, shown.glossy})
            if (!black(lobe.weight) && has_closed_form(light, lobe))
                reflected += lobe.weight * density(light, lobe, sample.direction);
        return reflected * sample.radiance * (static_cast<float>(lights_.size()) / sample.pdf);
    }

    // The mean of `sample` over all u and lights.
    Color integral(const Shown &shown) const
    {
        Color sum;
        for (const Lobe &lobe : {shown.diffuse, shown.glossy}) {
            if (black(lobe.weight))
                continue;
            for (size_t i = 0; i < lights_.size(); ++i)
                sum += lobe.weight * integral(i, shown.point, lobe);
        }
        return sum;
    }

private:
    Color integral(size_t number, Vector point, const Lobe &lobe) const
    {
        const Light &light = lights_[number];
        if (light.kind == Light::environment)
            return table(lobe).integral(lobe.axis);
        if (!has_closed_form(light, lobe))
            return {};
        double part = outlines_[number] ? outlines_[number]->received(point, lobe) : received(light, point, lobe);
        return light.radiance * static_cast<float>(part);
    }

    float density(const Light &light, const Lobe &lobe, Vector direction) const
    {
        return light.kind == Light::environment ? table(lobe).density(lobe.axis, direction)
                                                : lobe_density(lobe.width, dot(lobe.axis, direction));
    }

    void tabulate(const Environment &map, float width)
    {
        for (const EnvironmentTable &table : tables_)
            if (table.width() == width)
                return;
        tables_.emplace_back(map, width);
    }

    const EnvironmentTable &table(const Lobe &lobe) const
    {
        size_t i = 0;
        while (tables_[i].width() != lobe.width)
            ++i;
        return tables_[i];
    }

    const std::vector<Light> &lights_;
    std::vector<std::unique_ptr<const MeshOutline>> outlines_; // of lights that are meshes
    std::vector<EnvironmentTable> tables_; // of the environment, one for each width
};

} // namespace demo
