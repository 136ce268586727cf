// Shapes that scenes are built from.
#pragma once

#include "mesh.hpp"
#include <functional>

namespace harness {

// Radius and height.
struct Profile {
    float radius, height;
};

// A profile turned around the vertical, from the bottom outside to the top (or on, down the inside).
inline Mesh lathe(const std::vector<Profile> &profile, int sides = 48, float crease = 40)
{
    Surface surface;
    for (Profile p : profile)
        for (int i = 0; i < sides; ++i) {
            float angle = 2 * demo::pi * static_cast<float>(i) / static_cast<float>(sides);
            surface.points.push_back({p.radius * std::cos(angle), p.height, -p.radius * std::sin(angle)});
        }
    const size_t n = static_cast<size_t>(sides);
    for (size_t row = 0; row + 1 < profile.size(); ++row)
        for (size_t i = 0; i < n; ++i) {
            size_t j = (i + 1) % n;
            surface.quad(row * n + i, row * n + j, (row + 1) * n + j, (row + 1) * n + i);
        }
    return smooth(surface, crease);
}

// The profile through some points, rounded (Catmull and Rom 1974).
inline std::vector<Profile> rounded(const std::vector<Profile> &points, int steps = 6)
{
    std::vector<Profile> result;
    for (size_t i = 0; i + 1 < points.size(); ++i) {
        Profile a = points[i ? i - 1 : 0], b = points[i], c = points[i + 1],
                d = points[std::min(i + 2, points.size() - 1)];
        for (int k = 0; k < steps; ++k) {
            float t = static_cast<float>(k) / static_cast<float>(steps);
            auto at = [t](float p, float q, float r, float s) {
                return q + 0.5f * t * (r - p + t * (2 * p - 5 * q + 4 * r - s + t * (3 * (q - r) + s - p)));
            };
            result.push_back({std::max(0.0f, at(a.radius, b.radius, c.radius, d.radius)),
                              at(a.height, b.height, c.height, d.height)});
        }
    }
    result.push_back(points.back());
    return result;
}

inline Mesh cylinder(float radius, float height, int sides = 48)
{
    return lathe({{0, 0}, {radius, 0}, {radius, height}, {0, height}}, sides);
}

inline Mesh ball(Vector radii, int sides = 48)
{
    std::vector<Profile> profile;
    for (int i = 0; i <= sides / 2; ++i) {
        float angle = demo::pi * static_cast<float>(i) / static_cast<float>(sides / 2);
        profile.push_back({i == sides / 2 ? 0 : std::sin(angle), -std::cos(angle)});
    }
    return scale(radii) * lathe(profile, sides, 60);
}

// Standing on the origin, with edges rounded to `radius` in `steps`; 0 steps: sharp.
inline Mesh box(Vector size, float radius = 0, int steps = 3)
{
    const Vector half = 0.5f * size, inner = half - Vector{radius, radius, radius};
    auto coordinates = [&](float extent) {
        std::vector<float> list;
        const int arc = radius > 0 ? steps : 0;
        for (int i = 0; i <= arc; ++i)
            list.push_back(arc ? -extent + radius * static_cast<float>(i) / static_cast<float>(arc) : -extent);
        for (size_t i = list.size(); i-- > 0;)
            list.push_back(-list[i]);
        return list;
    };
    auto nearest = [&](float value, float limit) { return std::min(std::max(value, -limit), limit); };
    Mesh mesh;
    for (int axis = 0; axis < 3; ++axis)
        for (float side : {-1.0f, 1.0f}) {
            const int a = (axis + 1) % 3, b = (axis + 2) % 3;
            auto us = coordinates(half[a]), vs = coordinates(half[b]);
            auto corner = [&](size_t i, size_t j, Facet &facet, int k) {
                float q[3];
                q[axis] = side * half[axis];
                q[a] = us[i];
                q[b] = vs[j];
                Vector on{q[0], q[1], q[2]};
                Vector core{nearest(on.x, inner.x), nearest(on.y, inner.y), nearest(on.z, inner.z)};
                Vector flat{axis == 0 ? side : 0, axis == 1 ? side : 0, axis == 2 ? side : 0};
                facet.normal[k] = radius > 0 ? demo::normalize(on - core) : flat;
                facet.corner[k] = (radius > 0 ? core + radius * facet.normal[k] : on) + Vector{0, half.y, 0};
            };
            for (size_t i = 0; i + 1 < us.size(); ++i)
                for (size_t j = 0; j + 1 < vs.size(); ++j) {
                    Facet first, second;
                    corner(i, j, first, 0);
                    corner(i + 1, j, first, side > 0 ? 1 : 2);
                    corner(i + 1, j + 1, first, side > 0 ? 2 : 1);
                    corner(i, j, second, 0);
                    corner(i + 1, j + 1, second, side > 0 ? 1 : 2);
                    corner(i, j + 1, second, side > 0 ? 2 : 1);
                    mesh.facets.push_back(first);
                    mesh.facets.push_back(second);
                }
        }
    return mesh;
}

// Facing cross(edge1, edge2).
inline Mesh rectangle(Vector corner, Vector edge1, Vector edge2)
{
    Vector n = demo::normalize(cross(edge1, edge2)), opposite = corner + edge1 + edge2;
    return {{{{corner, corner + edge1, opposite}, {n, n, n}}, {{corner, opposite, corner + edge2}, {n, n, n}}}};
}

// A round rod along a curve over [0, 1]; its ends are open unless the radius is 0 there.
inline Mesh tube(const std::function<Vector(float)> &curve, const std::function<float(float)> &radius, int rings,
                 int sides = 16)
{
    Surface surface;
    Vector across;
    for (int i = 0; i <= rings; ++i) {
        float t = static_cast<float>(i) / static_cast<float>(rings), step = 0.5f / static_cast<float>(rings);
        Vector tangent = demo::normalize(curve(std::min(1.0f, t + step)) - curve(std::max(0.0f, t - step)));
        // The frame is carried along the curve, so that it does not twist.
        across = i == 0 ? demo::Frame(tangent).s : demo::normalize(across - dot(across, tangent) * tangent);
        Vector up = cross(tangent, across);
        for (int j = 0; j < sides; ++j) {
            float angle = 2 * demo::pi * static_cast<float>(j) / static_cast<float>(sides);
            surface.points.push_back(curve(t) + radius(t) * (std::cos(angle) * across + std::sin(angle) * up));
        }
    }
    const size_t n = static_cast<size_t>(sides);
    for (size_t row = 0; row < static_cast<size_t>(rings); ++row)
        for (size_t i = 0; i < n; ++i) {
            size_t j = (i + 1) % n;
            surface.quad(row * n + i, row * n + j, (row + 1) * n + j, (row + 1) * n + i);
        }
    return smooth(surface, 60);
}

inline Mesh rod(Vector from, Vector to, float radius, int sides = 16)
{
    return tube([=](float t) { return from + t * (to - from); }, [=](float) { return radius; }, 1, sides);
}

// Around the vertical.
inline Mesh torus(float ring, float thickness, int rings = 64, int sides = 20)
{
    std::vector<Profile> profile;
    for (int i = 0; i <= sides; ++i) {
        float angle = 2 * demo::pi * static_cast<float>(i) / static_cast<float>(sides);
        profile.push_back({ring + thickness * std::sin(angle), -thickness * std::cos(angle)});
    }
    profile.back() = profile.front();
    return lathe(profile, rings, 60);
}

} // namespace harness
