// A stack of pictures as an integrand: what POV-Ray rendered at the centres of a grid's cells becomes a function of the
// whole sample vector. Its exact mean is the mean of the stack, so that no reference needs to be rendered.
#pragma once

#include "../../examples_c/pathtracer/image.hpp"
#include "stack.hpp"
#include <algorithm>

namespace povray {

// How values between the cells' centres are found.
enum class Model {
    cells, // constant in each cell
    // Linear between the centres along every axis but that of the choice, constant beyond the outermost. Along an axis
    // of n cells the values then have the weights 1 / n too: an inner one the area of its hat, 1 / n, an outer one half
    // a hat and half a cell. So the mean stays that of the stack.
    linear,
};

class StackIntegrand final : public demo::Integrand {
public:
    StackIntegrand(const Stack &stack, Model model) : stack_(stack), model_(model) {}

    std::vector<demo::Domain> domains() const override
    {
        std::vector<demo::Domain> all;
        for (const Axis &axis : stack_.axes()) {
            if (!all.empty() && all.back().kind == axis.kind)
                ++all.back().dims;
            else
                all.push_back({axis.kind, 0, 1});
        }
        return all;
    }

    uint32_t lights() const override
    {
        for (const Axis &axis : stack_.axes())
            if (axis.kind == demo::Domain::choice)
                return axis.cells;
        return 1;
    }

    bool camera_ray_per_sample() const override { return false; }

    void evaluate(uint32_t x, uint32_t y, size_t n, const float *u, float *f, uint32_t *surface,
                  demo::Shown *) const override
    {
        if (surface)
            *surface = stack_.surface(x, y);
        const uint16_t *values = stack_.values(x, y);
        for (size_t i = 0; i < n; ++i, u += stack_.axes().size(), f += 3) {
            float sum[3] = {0, 0, 0};
            add(values, 0, 0, 1, u, sum);
            for (int c = 0; c < 3; ++c)
                f[c] = sum[c] / 65535;
        }
    }

    // The exact mean of each pixel.
    demo::Image reference() const
    {
        demo::Image image(stack_.width(), stack_.height());
        const size_t cells = stack_.cells();
        for (uint32_t y = 0; y < image.height; ++y)
            for (uint32_t x = 0; x < image.width; ++x) {
                const uint16_t *values = stack_.values(x, y);
                uint64_t sum[3] = {0, 0, 0};
                for (size_t cell = 0; cell < cells; ++cell)
                    for (size_t c = 0; c < 3; ++c)
                        sum[c] += values[3 * cell + c];
                for (size_t c = 0; c < 3; ++c)
                    image.rgb[3 * (size_t{y} * image.width + x) + c] =
                        static_cast<float>(static_cast<double>(sum[c]) / (65535.0 * static_cast<double>(cells)));
            }
        return image;
    }

private:
    // Adds weight times what the axes from `axis` on make of the cells that begin with `cell`.
    void add(const uint16_t *values, size_t axis, size_t cell, float weight, const float *u, float *sum) const
    {
        if (axis == stack_.axes().size()) {
            for (size_t c = 0; c < 3; ++c)
                sum[c] += weight * values[3 * cell + c];
            return;
        }
        const Axis &a = stack_.axes()[axis];
        const size_t last = a.cells - 1;
        const float place = u[axis] * static_cast<float>(a.cells);
        if (model_ == Model::cells || a.kind == demo::Domain::choice) {
            add(values, axis + 1, cell * a.cells + std::min(static_cast<size_t>(place), last), weight, u, sum);
            return;
        }
        const float centred = std::min(std::max(place - 0.5f, 0.0f), static_cast<float>(last));
        const size_t low = std::min(static_cast<size_t>(centred), last);
        const float part = centred - static_cast<float>(low);
        add(values, axis + 1, cell * a.cells + low, weight * (1 - part), u, sum);
        if (part > 0)
            add(values, axis + 1, cell * a.cells + low + 1, weight * part, u, sum);
    }

    const Stack &stack_;
    Model model_;
};

} // namespace povray
