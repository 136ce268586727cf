// What pbrt_sampler.cpp renders: a ball on a floor, seen from above, under two lamps. No acceleration structure, no
// material.
#pragma once

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "noisefloor.h"

namespace room {

constexpr int lamps = 2;

struct Vector {
    float x, y, z;
};
inline Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline float dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

constexpr Vector centre{0.0f, 0.0f, 0.6f};
constexpr float radius = 0.6f;

struct Hit {
    Vector point, normal;
    uint32_t surface; // 0: the floor, 1: the ball
};

// What is seen at a point of the film, which is the unit square.
inline Hit camera_ray(float x, float y)
{
    const Vector floor{4.0f * x - 2.0f, 4.0f * y - 2.0f, 0.0f};
    const float distance = floor.x * floor.x + floor.y * floor.y;
    if (distance >= radius * radius)
        return {floor, {0.0f, 0.0f, 1.0f}, 0};
    const float height = std::sqrt(radius * radius - distance);
    return {{floor.x, floor.y, centre.z + height}, {floor.x / radius, floor.y / radius, height / radius}, 1};
}

inline bool shadowed(Vector from, Vector to)
{
    const Vector d = to - from, o = from - centre;
    const float a = dot(d, d), b = dot(d, o), c = dot(o, o) - radius * radius;
    const float discriminant = b * b - a * c;
    return c > 1e-3f && discriminant > 0.0f && b < 0.0f && -b - std::sqrt(discriminant) < a;
}

// Light from the point (u, v) of a lamp that was chosen with probability 1 / lamps: integrand over density.
inline float direct_light(const Hit &hit, int lamp, float u, float v)
{
    const Vector at =
        lamp == 0 ? Vector{-1.6f + 0.9f * u, -0.4f + 0.9f * v, 2.2f} : Vector{0.9f + 0.5f * u, 0.5f + 0.5f * v, 1.7f};
    const float power = lamp == 0 ? 4.0f : 2.0f, area = lamp == 0 ? 0.81f : 0.25f;
    const Vector d = at - hit.point;
    const float square = dot(d, d), cosine = dot(d, hit.normal);
    if (cosine <= 0.0f || d.z <= 0.0f || shadowed(hit.point, at))
        return 0.0f;
    return static_cast<float>(lamps) * power * area * cosine * d.z / (square * square);
}

// The pixels' surfaces, for nf_cv_image: by rays through their centres, so that they do not depend on any sample.
inline std::vector<uint32_t> surfaces(int width, int height)
{
    std::vector<uint32_t> ids;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            ids.push_back(camera_ray((static_cast<float>(x) + 0.5f) / static_cast<float>(width),
                                     (static_cast<float>(y) + 0.5f) / static_cast<float>(height))
                              .surface);
    return ids;
}

inline double root_mean_squared_error(const std::vector<float> &image, const std::vector<float> &reference)
{
    double sum = 0.0;
    for (size_t i = 0; i < image.size(); ++i)
        sum += std::pow(image[i] - reference[i], 2.0);
    return std::sqrt(sum / static_cast<double>(image.size()));
}

// The plain means of n samples in each pixel.
inline std::vector<float> means(const std::vector<float> &f, size_t n)
{
    std::vector<float> image(f.size() / n);
    for (size_t i = 0; i < f.size(); ++i)
        image[i / n] += f[i] / static_cast<float>(n);
    return image;
}

inline void check(nf_status status, const char *what)
{
    if (status != NF_OK)
        throw std::runtime_error(std::string(what) + ": " + nf_status_message(status));
}

} // namespace room
