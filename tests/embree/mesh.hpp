// Meshes in the making: triangles with a normal at each corner, and where they are put.
#pragma once

#include "pathtracer/vector.hpp"
#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

namespace harness {

using demo::Vector;

struct Facet {
    Vector corner[3];
    Vector normal[3]; // unit
};

struct Mesh {
    std::vector<Facet> facets;

    void add(const Mesh &other) { facets.insert(facets.end(), other.facets.begin(), other.facets.end()); }
};

// An affine map: the images of the axes, and of the origin.
struct Transform {
    Vector x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, origin;

    Vector direction(Vector v) const { return v.x * x + v.y * y + v.z * z; }
    Vector point(Vector v) const { return direction(v) + origin; }
    // Normals stay perpendicular: the cofactors, not the map itself.
    Vector normal(Vector v) const
    {
        float side = dot(cross(x, y), z) < 0 ? -1.0f : 1.0f;
        return demo::normalize(side * (v.x * cross(y, z) + v.y * cross(z, x) + v.z * cross(x, y)));
    }
};

// First b, then a.
inline Transform operator*(const Transform &a, const Transform &b)
{
    return {a.direction(b.x), a.direction(b.y), a.direction(b.z), a.point(b.origin)};
}

inline Transform move(Vector by) { return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, by}; }
inline Transform scale(Vector by) { return {{by.x, 0, 0}, {0, by.y, 0}, {0, 0, by.z}, {}}; }
inline Transform scale(float by) { return scale({by, by, by}); }

// Around an axis through the origin, in degrees, counter-clockwise seen from the axis' tip (Rodrigues).
inline Transform turn(Vector axis, float degrees)
{
    Vector a = demo::normalize(axis);
    float angle = degrees * demo::pi / 180, c = std::cos(angle), s = std::sin(angle);
    auto image = [&](Vector v) { return c * v + s * cross(a, v) + (1 - c) * dot(a, v) * a; };
    return {image({1, 0, 0}), image({0, 1, 0}), image({0, 0, 1}), {}};
}
inline Transform turn_up(float degrees) { return turn({0, 1, 0}, degrees); }

inline Mesh operator*(const Transform &transform, Mesh mesh)
{
    bool mirrored = dot(cross(transform.x, transform.y), transform.z) < 0;
    for (Facet &facet : mesh.facets) {
        for (int i = 0; i < 3; ++i) {
            facet.corner[i] = transform.point(facet.corner[i]);
            facet.normal[i] = transform.normal(facet.normal[i]);
        }
        if (mirrored) { // the corners' order tells the front
            std::swap(facet.corner[1], facet.corner[2]);
            std::swap(facet.normal[1], facet.normal[2]);
        }
    }
    return mesh;
}

// Moved and scaled to stand on the origin, one unit high.
inline Mesh standing(Mesh mesh)
{
    Vector low = mesh.facets.at(0).corner[0], high = low;
    for (const Facet &facet : mesh.facets)
        for (Vector corner : facet.corner) {
            low = demo::minimum(low, corner);
            high = demo::maximum(high, corner);
        }
    return scale(1 / (high.y - low.y)) * (move({-0.5f * (low.x + high.x), -low.y, -0.5f * (low.z + high.z)}) * mesh);
}

// Triangles that share points, before they get normals.
struct Surface {
    std::vector<Vector> points;
    std::vector<uint32_t> corners; // three of each triangle

    void triangle(size_t a, size_t b, size_t c)
    {
        for (size_t i : {a, b, c})
            corners.push_back(static_cast<uint32_t>(i));
    }
    void quad(size_t a, size_t b, size_t c, size_t d)
    {
        triangle(a, b, c);
        triangle(a, c, d);
    }
};

// A corner's normal is the mean over the triangles around its point, by area, that turn less than `crease` degrees from
// its own. Triangles without area are left out.
inline Mesh smooth(const Surface &surface, float crease = 50)
{
    const size_t count = surface.corners.size() / 3;
    auto corner = [&](size_t triangle, size_t i) { return surface.points[surface.corners[3 * triangle + i]]; };
    // Points in the same place are one.
    std::map<std::tuple<float, float, float>, std::vector<uint32_t>> around;
    std::vector<Vector> area(count);
    auto place = [](Vector p) { return std::make_tuple(p.x + 0.0f, p.y + 0.0f, p.z + 0.0f); };
    for (size_t t = 0; t < count; ++t) {
        area[t] = cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0));
        for (size_t i = 0; i < 3; ++i)
            around[place(corner(t, i))].push_back(static_cast<uint32_t>(t));
    }
    const float limit = std::cos(crease * demo::pi / 180);
    Mesh mesh;
    for (size_t t = 0; t < count; ++t) {
        float size = length(area[t]);
        if (!(size > 1e-12f))
            continue;
        Facet facet;
        for (size_t i = 0; i < 3; ++i) {
            facet.corner[i] = corner(t, i);
            Vector sum;
            for (uint32_t other : around[place(corner(t, i))])
                if (dot(area[t], area[other]) >= limit * size * length(area[other]))
                    sum += area[other];
            facet.normal[i] = demo::normalize(sum);
        }
        mesh.facets.push_back(facet);
    }
    return mesh;
}

} // namespace harness
