// What lights send into a lobe with nothing between, in closed form. In double precision: large terms have small sums.
#pragma once

#include "light.hpp"
#include "lobe.hpp"

namespace demo {

struct Vector64 {
    double x, y, z;

    Vector64(double x, double y, double z) : x(x), y(y), z(z) {}
    Vector64(Vector v) : x(v.x), y(v.y), z(v.z) {}
};

inline Vector64 operator+(Vector64 a, Vector64 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vector64 operator-(Vector64 a, Vector64 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vector64 operator*(double s, Vector64 a) { return {s * a.x, s * a.y, s * a.z}; }
inline double dot(Vector64 a, Vector64 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vector64 cross(Vector64 a, Vector64 b)
{
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// Of an edge from a to b: its angle as seen from the origin, times the cosine between `normal` and that of the plane
// through edge and origin. `edge` is b - a, and not recomputed: of a small polygon far away the difference would be
// inexact, and these terms nearly cancel.
inline double edge_term(Vector64 a, Vector64 b, Vector64 edge, Vector64 normal)
{
    Vector64 across = cross(a, edge);
    double along = dot(a, b), square = dot(across, across), t = square / (along * along);
    if (along > 0 && t < 0.01) // the arc tangent's series, to 1e-14
        return (1 + t * (-1 / 3.0 + t * (1 / 5.0 + t * (-1 / 7.0 + t * (1 / 9.0 + t * (-1 / 11.0 + t / 13)))))) /
               along * dot(across, normal);
    double sine = std::sqrt(square);
    return sine > 0 ? std::atan2(sine, along) / sine * dot(across, normal) : 0.0;
}

// The irradiance of a convex polygon that shines with radiance 1, seen from the origin: half the sum over its edges
// (Lambert 1760). `corner`: the first. What is below the horizon is cut off; the cut's own edge lies in the horizon.
template <size_t count>
double polygon_irradiance(Vector64 corner, const Vector64 (&edges)[count], Vector64 normal)
{
    double sum = 0, height = dot(normal, corner);
    bool cut = false;
    Vector64 sets{0, 0, 0}, rises{0, 0, 0}; // where the border crosses the horizon, down and up
    for (Vector64 edge : edges) {
        Vector64 next = corner + edge;
        double below = height, above = height + dot(normal, edge), at = below / (below - above);
        if (below >= 0 && above >= 0) {
            sum += edge_term(corner, next, edge, normal);
        } else if (below >= 0) {
            sets = corner + at * edge;
            sum += edge_term(corner, sets, at * edge, normal);
            cut = true;
        } else if (above >= 0) {
            rises = corner + at * edge;
            sum += edge_term(rises, next, (1 - at) * edge, normal);
        }
        corner = next;
        height = above;
    }
    if (cut)
        sum += edge_term(sets, rises, rises - sets, normal);
    return std::abs(sum) / 2;
}

// The same into a lobe, from the side that shines; from the other 0. What narrows the lobe to a cosine widens the
// polygon.
template <size_t count>
double polygon_light(Vector first, Vector64 (&edges)[count], Vector shines, Vector from, const Lobe &lobe)
{
    const Vector64 axis = lobe.axis;
    Vector64 corner = Vector64(first) - from;
    if (!(dot(corner, shines) < 0))
        return 0;
    if (lobe.width != 1) {
        auto widen = [&](Vector64 &v) { v = v + (lobe.width - 1) * dot(axis, v) * axis; };
        widen(corner);
        for (Vector64 &edge : edges)
            widen(edge);
    }
    return polygon_irradiance(corner, edges, axis);
}

inline double triangle_light(Vector corner, Vector64 edge1, Vector64 edge2, Vector shines, Vector from,
                             const Lobe &lobe)
{
    Vector64 edges[3] = {edge1, edge2 - edge1, -1 * edge2};
    return polygon_light(corner, edges, shines, from, lobe);
}

// The irradiance of a sphere that shines with radiance 1, around `center` as seen from the origin. Where the horizon
// cuts it, the integral along the border of what is seen: an arc of the sphere's outline, then one of the horizon.
inline double sphere_irradiance(Vector64 center, double radius, Vector64 normal)
{
    double squared = dot(center, center), sine2 = radius * radius / squared; // of half the angle that the sphere fills
    if (!(sine2 < 1))
        return 0;
    double up = dot(center, normal) / std::sqrt(squared), sine = std::sqrt(sine2);
    if (up >= sine)
        return static_cast<double>(pi) * sine2 * up;
    if (up <= -sine)
        return 0;
    double cosine = std::sqrt(1 - sine2), along = std::sqrt(1 - up * up);
    double turn = -cosine * up / (sine * along); // the cosine of half the arc above the horizon
    double half = std::acos(std::min(std::max(turn, -1.0), 1.0)), width = along * std::sin(half);
    return sine2 * up * half - sine * cosine * width + std::atan2(sine * width, cosine);
}

// Whether a light's part of a lobe is known: there is no closed form for spheres but in the cosine.
inline bool has_closed_form(const Light &light, const Lobe &lobe)
{
    return light.kind != Light::sphere || lobe.width == 1;
}

// The integral of a lobe over the directions to a light, which shines with radiance 1. Not of environments.
inline double received(const Light &light, Vector from, const Lobe &lobe)
{
    double sum = 0;
    switch (light.kind) {
    case Light::parallelogram: {
        Vector64 edge1 = light.edge1, edge2 = light.edge2, edges[4] = {edge1, edge2, -1 * edge1, -1 * edge2};
        sum = polygon_light(light.origin, edges, light.normal, from, lobe);
        break;
    }
    case Light::triangle:
        sum = triangle_light(light.origin, light.edge1, light.edge2, light.normal, from, lobe);
        break;
    case Light::sphere: sum = sphere_irradiance(Vector64(light.origin) - from, light.radius, lobe.axis); break;
    case Light::mesh:
        for (const LightTriangle &t : light.triangles)
            sum += triangle_light(t.origin, t.edge1, t.edge2, t.normal, from, lobe);
        break;
    case Light::environment: break;
    }
    return sum / static_cast<double>(pi);
}

} // namespace demo
