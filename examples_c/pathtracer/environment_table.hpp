// What an environment sends to a surface with nothing between, by the surface's normal. The integral is tabulated for
// some normals, and that of others interpolated. Interpolating the cosine in the same way makes it exact: then both
// speak of the same function, if not of quite the cosine, and the table may be coarse.
#pragma once

#include "environment.hpp"
#include <array>

namespace demo {

class EnvironmentTable {
public:
    explicit EnvironmentTable(const Environment &map)
    {
        for (uint32_t y = 0; y <= cells; ++y)
            for (uint32_t x = 0; x <= cells; ++x)
                normals_[y * (cells + 1) + x] = unfold(place(x), place(y));
        integrate(map);
    }

    // Nearly max(0, dot(normal, direction)). Both unit.
    float cosine(Vector normal, Vector direction) const
    {
        float sum = 0;
        for (const Corner &corner : corners(normal))
            sum += corner.share * std::max(0.0f, dot(normals_[corner.index], direction));
        return sum;
    }

    // The integral of radiance times `cosine` over all directions.
    Color irradiance(Vector normal) const
    {
        Color sum;
        for (const Corner &corner : corners(normal))
            sum += corner.share * irradiances_[corner.index];
        return sum;
    }

private:
    // Normals are the grid points of a square that is folded around an octahedron, whose faces are then blown up.
    static constexpr uint32_t cells = 24, points = (cells + 1) * (cells + 1);
    static constexpr size_t together = 8;
    static constexpr size_t padded = (points + together - 1) / together * together;

    // Of the cell that a normal is in.
    struct Corner {
        size_t index;
        float share;
    };

    static float place(uint32_t i) { return 2 * static_cast<float>(i) / cells - 1; }

    static Vector unfold(float x, float z)
    {
        float y = 1 - std::abs(x) - std::abs(z);
        if (y < 0) {
            float across = x;
            x = std::copysign(1 - std::abs(z), x);
            z = std::copysign(1 - std::abs(across), z);
        }
        return normalize({x, y, z});
    }

    static std::array<Corner, 4> corners(Vector normal)
    {
        float scale = 1 / (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z));
        float x = normal.x * scale, z = normal.z * scale;
        if (normal.y < 0) {
            float across = x;
            x = std::copysign(1 - std::abs(z), x);
            z = std::copysign(1 - std::abs(across), z);
        }
        x = (x + 1) * (cells / 2.0f);
        z = (z + 1) * (cells / 2.0f);
        size_t column = std::min(static_cast<size_t>(std::max(x, 0.0f)), size_t{cells - 1});
        size_t row = std::min(static_cast<size_t>(std::max(z, 0.0f)), size_t{cells - 1});
        float s = x - static_cast<float>(column), t = z - static_cast<float>(row);
        size_t first = row * (cells + 1) + column;
        return {{{first, (1 - s) * (1 - t)},
                 {first + 1, s * (1 - t)},
                 {first + cells + 1, (1 - s) * t},
                 {first + cells + 2, s * t}}};
    }

    // Sums over the map's parts, row by row in float and of the rows in double. Some normals at once, each a lane.
    void integrate(const Environment &map)
    {
        std::array<float, padded> x{}, y{}, z{};
        for (size_t i = 0; i < points; ++i) {
            x[i] = normals_[i].x;
            y[i] = normals_[i].y;
            z[i] = normals_[i].z;
        }
        std::vector<double> sums(3 * padded);
        std::vector<Environment::Part> parts;
        const uint32_t split = map.split();
        for (uint32_t row = 0; row < map.height() * split; ++row) {
            map.parts(row, split, parts);
            for (size_t first = 0; first < padded; first += together) {
                float red[together] = {}, green[together] = {}, blue[together] = {};
                for (const Environment::Part &part : parts) {
                    for (size_t l = 0; l < together; ++l) {
                        float cosine = x[first + l] * part.direction.x + y[first + l] * part.direction.y +
                                       z[first + l] * part.direction.z;
                        cosine = cosine > 0 ? cosine : 0;
                        red[l] += cosine * part.light.x;
                        green[l] += cosine * part.light.y;
                        blue[l] += cosine * part.light.z;
                    }
                }
                for (size_t l = 0; l < together; ++l) {
                    sums[3 * (first + l)] += red[l];
                    sums[3 * (first + l) + 1] += green[l];
                    sums[3 * (first + l) + 2] += blue[l];
                }
            }
        }
        for (size_t i = 0; i < points; ++i)
            irradiances_[i] = {static_cast<float>(sums[3 * i]), static_cast<float>(sums[3 * i + 1]),
                               static_cast<float>(sums[3 * i + 2])};
    }

    std::array<Vector, points> normals_;
    std::array<Color, points> irradiances_;
};

} // namespace demo
