// What lights send to a point with nothing between, in closed form or from a table: the integral over directions of
// radiance times the cosine to a normal, above its horizon. In double precision: sums of large terms are small here.
#pragma once

#include "light.hpp"

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
// through edge and origin. `edge` is b - a, and not recomputed: for a far and small polygon the difference would be
// inexact, and these terms nearly cancel.
inline double edge_term(Vector64 a, Vector64 b, Vector64 edge, Vector64 normal)
{
    Vector64 across = cross(a, edge);
    double sine = std::sqrt(dot(across, across));
    return sine > 0 ? std::atan2(sine, dot(a, b)) / sine * dot(across, normal) : 0.0;
}

// Of a convex polygon that shines with radiance 1, seen from the origin: half the sum over its edges (Lambert 1760).
// `corner`: the first. What is below the horizon is cut off; the cut's own edge lies in the horizon.
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

// From its side that shines, else 0.
template <size_t count>
double one_sided_irradiance(Vector corner, const Vector64 (&edges)[count], Vector shines, Vector from, Vector normal)
{
    Vector64 to = Vector64(corner) - from;
    return dot(to, shines) < 0 ? polygon_irradiance(to, edges, normal) : 0.0;
}

inline double triangle_irradiance(Vector corner, Vector64 edge1, Vector64 edge2, Vector shines, Vector from,
                                  Vector normal)
{
    const Vector64 edges[3] = {edge1, edge2 - edge1, -1 * edge2};
    return one_sided_irradiance(corner, edges, shines, from, normal);
}

inline double parallelogram_irradiance(Vector corner, Vector64 edge1, Vector64 edge2, Vector shines, Vector from,
                                       Vector normal)
{
    const Vector64 edges[4] = {edge1, edge2, -1 * edge1, -1 * edge2};
    return one_sided_irradiance(corner, edges, shines, from, normal);
}

// Of a sphere that shines with radiance 1, around `center` as seen from the origin. Where the horizon cuts it, the
// integral along the border of what is seen: an arc of the sphere's outline, then one of the horizon.
inline double sphere_irradiance(Vector64 center, double radius, Vector64 normal)
{
    const double pi64 = 3.14159265358979323846;
    double squared = dot(center, center), sine2 = radius * radius / squared; // of half the angle that the sphere fills
    if (!(sine2 < 1))
        return 0;
    double up = dot(center, normal) / std::sqrt(squared), sine = std::sqrt(sine2);
    if (up >= sine)
        return pi64 * sine2 * up;
    if (up <= -sine)
        return 0;
    double cosine = std::sqrt(1 - sine2), along = std::sqrt(1 - up * up);
    double turn = -cosine * up / (sine * along); // the cosine of half the arc above the horizon
    double half = std::acos(std::min(std::max(turn, -1.0), 1.0)), width = along * std::sin(half);
    return sine2 * up * half - sine * cosine * width + std::atan2(sine * width, cosine);
}

// Of any light but an environment, with radiance 1.
inline double irradiance(const Light &light, Vector from, Vector normal)
{
    switch (light.kind) {
    case Light::parallelogram:
        return parallelogram_irradiance(light.origin, light.edge1, light.edge2, light.normal, from, normal);
    case Light::triangle:
        return triangle_irradiance(light.origin, light.edge1, light.edge2, light.normal, from, normal);
    case Light::sphere: return sphere_irradiance(Vector64(light.origin) - from, light.radius, normal);
    case Light::mesh: {
        double sum = 0;
        for (const LightTriangle &t : light.triangles)
            sum += triangle_irradiance(t.origin, t.edge1, t.edge2, t.normal, from, normal);
        return sum;
    }
    case Light::environment: break;
    }
    return 0;
}

} // namespace demo
