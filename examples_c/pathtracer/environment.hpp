// Light from all around: an image of the sphere of directions, latitude by longitude, sampled in proportion to its
// luminance times the sine that the map spends too many pixels on at the poles.
#pragma once

#include "vector.hpp"
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace demo {

inline float luminance(Color c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

class Environment {
public:
    // pixels[height][width], linear; the first row is around +y (up). Columns start at +z and go on over +x.
    Environment(uint32_t width, uint32_t height, std::vector<Color> pixels)
        : width_(width), height_(height), pixels_(std::move(pixels)), columns_(size_t{width} * height), rows_(height)
    {
        if (width == 0 || height == 0 || pixels_.size() != size_t{width} * height)
            throw std::runtime_error("an environment map of " + std::to_string(width) + " x " + std::to_string(height) +
                                     " pixels cannot have " + std::to_string(pixels_.size()));
        double total = 0;
        for (uint32_t y = 0; y < height; ++y) {
            double row = 0;
            for (uint32_t x = 0; x < width; ++x) {
                const Color &color = pixels_[size_t{y} * width + x];
                for (int c = 0; c < 3; ++c)
                    if (!(color[c] >= 0 && std::isfinite(color[c])))
                        throw std::runtime_error("an environment map must be finite and not negative: pixel (" +
                                                 std::to_string(x) + ", " + std::to_string(y) + ") has " +
                                                 std::to_string(color[c]));
                columns_[size_t{y} * width + x] = row += weight(x, y);
            }
            rows_[y] = total += row;
        }
        if (!(total > 0) || !std::isfinite(total))
            throw std::runtime_error("an environment map must shine, with a finite sum");
    }

    // Interpolated between the centres of the map's pixels.
    Color radiance(Vector direction) const
    {
        float u, v;
        coordinates(direction, u, v);
        return interpolate(u, v);
    }

    // A small part of the sphere, and the light from it: radiance times solid angle.
    struct Part {
        Vector direction;
        Color light;
    };

    // The whole sphere in rows of parts: each pixel is split as often as makes sums over parts nearly integrals.
    uint32_t rows() const { return height_ * split(); }
    void parts(uint32_t row, std::vector<Part> &parts) const
    {
        // At the poles half a cell may be left.
        const bool half = split() / 2 % 2 == 1 && (row == 0 || row + 1 == rows());
        const double v = (half ? row + 0.5 : place(row)) / rows();
        const double pi64 = 3.14159265358979323846, sine = std::sin(pi64 * v);
        parts.resize(size_t{width_} * split());
        const double columns = static_cast<double>(parts.size()), area = 2 * pi64 * pi64 / columns / rows() * sine;
        for (size_t i = 0; i < parts.size(); ++i) {
            double u = place(i) / columns;
            parts[i].direction = {static_cast<float>(sine * std::sin(2 * pi64 * u)),
                                  static_cast<float>(std::cos(pi64 * v)),
                                  static_cast<float>(sine * std::cos(2 * pi64 * u))};
            parts[i].light = static_cast<float>(area) * interpolate(static_cast<float>(u), static_cast<float>(v));
        }
    }

    // The density of `sample`, per solid angle.
    float pdf(Vector direction) const
    {
        float u, v;
        coordinates(direction, u, v);
        uint32_t x = std::min(static_cast<uint32_t>(u * static_cast<float>(width_)), width_ - 1);
        uint32_t y = std::min(static_cast<uint32_t>(v * static_cast<float>(height_)), height_ - 1);
        return density(x, y, v);
    }

    // A direction and its density.
    Vector sample(float u, float v, float &pdf) const
    {
        uint32_t y = pick(rows_.data(), height_, v), x = pick(&columns_[size_t{y} * width_], width_, u);
        float longitude = (static_cast<float>(x) + u) / static_cast<float>(width_);
        float latitude = (static_cast<float>(y) + v) / static_cast<float>(height_);
        pdf = density(x, y, latitude);
        float sine = std::sin(pi * latitude), azimuth = 2 * pi * longitude;
        return {sine * std::sin(azimuth), std::cos(pi * latitude), sine * std::cos(azimuth)};
    }

private:
    // 1, or even.
    uint32_t split() const
    {
        double times = std::sqrt(65536.0 / (static_cast<double>(width_) * height_));
        return std::max(1u, 2 * static_cast<uint32_t>(std::lround(times / 2)));
    }

    // Where of the i-th part light is looked up. Two parts together are a cell with its Gauss points; the kinks of the
    // interpolation, in the middle of pixels, are between cells.
    double place(size_t i) const
    {
        const bool first = i % 2 == split() / 2 % 2;
        return static_cast<double>(i) + (split() == 1 ? 0.5 : first ? 0.5 - 0.0773503 : 0.5 + 0.0773503);
    }

    // At u of the map's width and v of its height.
    Color interpolate(float u, float v) const
    {
        float x = u * static_cast<float>(width_) - 0.5f, y = v * static_cast<float>(height_) - 0.5f;
        float left = std::floor(x), top = std::floor(y), s = x - left, t = y - top;
        int32_t i = static_cast<int32_t>(left), j = static_cast<int32_t>(top);
        return (1 - t) * ((1 - s) * pixel(i, j) + s * pixel(i + 1, j)) +
               t * ((1 - s) * pixel(i, j + 1) + s * pixel(i + 1, j + 1));
    }

    Color pixel(int32_t x, int32_t y) const
    {
        int32_t width = static_cast<int32_t>(width_), row = std::min(std::max(y, 0), static_cast<int32_t>(height_) - 1);
        return pixels_[static_cast<size_t>(row) * width_ + static_cast<size_t>((x + width) % width)];
    }

    // The mean of what `radiance` interpolates over a pixel: never 0 where that shines.
    double weight(uint32_t column, uint32_t row) const
    {
        int32_t x = static_cast<int32_t>(column), y = static_cast<int32_t>(row);
        double sum = 0;
        for (int32_t j = -1; j <= 1; ++j)
            for (int32_t i = -1; i <= 1; ++i)
                sum += luminance(pixel(x + i, y + j)) * (i == 0 ? 6 : 1) * (j == 0 ? 6 : 1) / 64.0;
        return sum * std::sin(static_cast<double>(pi) * (row + 0.5) / height_);
    }

    static void coordinates(Vector direction, float &u, float &v)
    {
        u = std::atan2(direction.x, direction.z) / (2 * pi);
        u = std::min(u < 0 ? u + 1 : u, 0x1.fffffep-1f);
        v = std::min(std::atan2(std::hypot(direction.x, direction.z), direction.y) / pi, 1.0f);
    }

    // Of the pixel, divided by what the map does to areas at that latitude.
    float density(uint32_t x, uint32_t y, float latitude) const
    {
        const double *row = &columns_[size_t{y} * width_];
        double sum = row[width_ - 1], share = sum > 0 ? (row[x] - (x ? row[x - 1] : 0)) / sum : 0;
        share *= (rows_[y] - (y ? rows_[y - 1] : 0)) / rows_[height_ - 1];
        float pixels = static_cast<float>(width_) * static_cast<float>(height_), sine = std::sin(pi * latitude);
        return sine > 0 ? static_cast<float>(share) * pixels / (2 * pi * pi * sine) : 0;
    }

    // Which entry of a running sum u in [0, 1) falls into; u becomes its place within that, in [0, 1).
    static uint32_t pick(const double *sums, uint32_t count, float &u)
    {
        double at = u * sums[count - 1];
        uint32_t i = std::min(static_cast<uint32_t>(std::upper_bound(sums, sums + count, at) - sums), count - 1);
        double before = i ? sums[i - 1] : 0, width = sums[i] - before;
        u = width > 0 ? std::min(static_cast<float>((at - before) / width), 0x1.fffffep-1f) : 0.5f;
        return i;
    }

    uint32_t width_, height_;
    std::vector<Color> pixels_;
    // Running sums of weights, of each row and of the rows: in float, pixels behind a bright one would add nothing.
    std::vector<double> columns_, rows_;
};

} // namespace demo
