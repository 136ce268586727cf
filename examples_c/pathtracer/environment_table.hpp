// What an environment sends into a lobe with nothing between, by the lobe's axis. Its integral is tabulated for some
// axes, and that of others interpolated. The lobe itself is interpolated likewise: then the two speak of the same
// function exactly, if not of quite that lobe, and the table may be coarse.
#pragma once

#include "environment.hpp"
#include "lobe.hpp"
#include <array>

namespace demo {

class EnvironmentTable {
public:
    // For lobes of that width.
    EnvironmentTable(const Environment &map, float width)
        : width_(width), cells_(static_cast<uint32_t>(8 + std::min(5 / width, 56.0f)))
    {
        for (uint32_t y = 0; y <= cells_; ++y)
            for (uint32_t x = 0; x <= cells_; ++x)
                axes_.push_back(unfold(place(x), place(y)));
        integrate(map);
    }

    float width() const { return width_; }

    // Nearly the lobe around an axis in a direction, both unit.
    float density(Vector axis, Vector direction) const
    {
        float sum = 0;
        for (const Corner &corner : corners(axis))
            sum += corner.share * lobe_density(width_, dot(axes_[corner.index], direction));
        return sum;
    }

    // The integral of radiance times `density` over all directions.
    Color integral(Vector axis) const
    {
        Color sum;
        for (const Corner &corner : corners(axis))
            sum += corner.share * integrals_[corner.index];
        return sum;
    }

private:
    // Axes go through the grid points of a square that is folded around an octahedron.
    struct Corner {
        size_t index;
        float share;
    };

    float place(uint32_t i) const { return 2 * static_cast<float>(i) / static_cast<float>(cells_) - 1; }

    // Folds the square's corners down, or back up.
    static void fold(float &x, float &z)
    {
        float across = x;
        x = std::copysign(1 - std::abs(z), x);
        z = std::copysign(1 - std::abs(across), z);
    }

    static Vector unfold(float x, float z)
    {
        float y = 1 - std::abs(x) - std::abs(z);
        if (y < 0)
            fold(x, z);
        return normalize({x, y, z});
    }

    // Of the cell that an axis goes through.
    std::array<Corner, 4> corners(Vector axis) const
    {
        float scale = 1 / (std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z));
        float x = axis.x * scale, z = axis.z * scale;
        if (axis.y < 0)
            fold(x, z);
        x = std::max(0.0f, (x + 1) / 2 * static_cast<float>(cells_));
        z = std::max(0.0f, (z + 1) / 2 * static_cast<float>(cells_));
        uint32_t column = std::min(static_cast<uint32_t>(x), cells_ - 1);
        uint32_t row = std::min(static_cast<uint32_t>(z), cells_ - 1);
        float s = x - static_cast<float>(column), t = z - static_cast<float>(row);
        size_t first = size_t{row} * (cells_ + 1) + column, below = first + cells_ + 1;
        return {{{first, (1 - s) * (1 - t)}, {first + 1, s * (1 - t)}, {below, (1 - s) * t}, {below + 1, s * t}}};
    }

    // Some axes at once, a lane each. Sums over the map's parts row by row in float, of the rows in double.
    void integrate(const Environment &map)
    {
        constexpr size_t lanes = 8;
        struct Group {
            float x[lanes] = {}, y[lanes] = {}, z[lanes] = {};
            double sums[3][lanes] = {};
        };
        std::vector<Group> groups((axes_.size() + lanes - 1) / lanes);
        for (size_t i = 0; i < axes_.size(); ++i) {
            groups[i / lanes].x[i % lanes] = axes_[i].x;
            groups[i / lanes].y[i % lanes] = axes_[i].y;
            groups[i / lanes].z[i % lanes] = axes_[i].z;
        }
        const float square = width_ * width_;
        std::vector<Environment::Part> parts;
        for (uint32_t row = 0; row < map.rows(); ++row) {
            map.parts(row, parts);
            for (Group &group : groups) {
                float sums[3][lanes] = {};
                for (const Environment::Part &part : parts) {
                    for (size_t l = 0; l < lanes; ++l) {
                        float cosine = group.x[l] * part.direction.x + group.y[l] * part.direction.y +
                                       group.z[l] * part.direction.z;
                        float spread = 1 - (1 - square) * cosine * cosine;
                        float density = (cosine > 0 ? cosine : 0.0f) / (spread * spread);
                        sums[0][l] += density * part.light.x;
                        sums[1][l] += density * part.light.y;
                        sums[2][l] += density * part.light.z;
                    }
                }
                for (size_t c = 0; c < 3; ++c)
                    for (size_t l = 0; l < lanes; ++l)
                        group.sums[c][l] += sums[c][l];
            }
        }
        for (size_t i = 0; i < axes_.size(); ++i) {
            auto sum = [&](size_t c) {
                return static_cast<float>(groups[i / lanes].sums[c][i % lanes]) * (square / pi);
            };
            integrals_.push_back({sum(0), sum(1), sum(2)});
        }
    }

    float width_;
    uint32_t cells_;
    std::vector<Vector> axes_;
    std::vector<Color> integrals_;
};

} // namespace demo
