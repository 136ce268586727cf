// Three floats, used for points, directions and linear RGB colours.
#pragma once

#include <algorithm>
#include <cmath>

namespace demo {

constexpr float pi = 3.14159265358979f;

struct Vector {
    float x = 0, y = 0, z = 0;

    float operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
    Vector operator-() const { return {-x, -y, -z}; }
    Vector &operator+=(Vector o) { x += o.x; y += o.y; z += o.z; return *this; }
    Vector &operator*=(Vector o) { x *= o.x; y *= o.y; z *= o.z; return *this; }
};

using Color = Vector;

inline Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vector operator*(Vector a, Vector b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
inline Vector operator*(Vector a, float s) { return {a.x * s, a.y * s, a.z * s}; }
inline Vector operator*(float s, Vector a) { return a * s; }
inline Vector operator/(Vector a, float s) { return a * (1.0f / s); }

inline float dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vector cross(Vector a, Vector b)
{
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline float length(Vector a) { return std::sqrt(dot(a, a)); }
inline Vector normalize(Vector a) { return a / length(a); }
inline Vector minimum(Vector a, Vector b) { return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)}; }
inline Vector maximum(Vector a, Vector b) { return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}; }
inline float largest(Color c) { return std::max(c.x, std::max(c.y, c.z)); }
inline bool black(Color c) { return c.x == 0 && c.y == 0 && c.z == 0; }

// `direction` seen from a surface: mirrored at the normal, both pointing away from it.
inline Vector reflect(Vector direction, Vector normal) { return 2 * dot(direction, normal) * normal - direction; }

// (u, v) in [0, 1)^2 to the unit disc (Shirley and Chiu 1997): without the seam of polar coordinates, which polynomials
// cannot follow.
inline void concentric_disc(float u, float v, float &x, float &y)
{
    float a = 2 * u - 1, b = 2 * v - 1;
    bool wide = std::abs(a) > std::abs(b);
    float radius = wide ? a : b;
    float angle = wide ? pi / 4 * (b / a) : b != 0 ? pi / 2 - pi / 4 * (a / b) : 0.0f;
    x = radius * std::cos(angle);
    y = radius * std::sin(angle);
}

// An orthonormal basis around a unit vector (Duff et al. 2017, "Building an Orthonormal Basis, Revisited").
struct Frame {
    Vector s, t, n;

    explicit Frame(Vector normal) : n(normal)
    {
        float sign = std::copysign(1.0f, n.z), a = -1.0f / (sign + n.z), b = n.x * n.y * a;
        s = {1 + sign * n.x * n.x * a, sign * b, -sign * n.x};
        t = {b, sign + n.y * n.y * a, -n.y};
    }
    Vector world(Vector local) const { return local.x * s + local.y * t + local.z * n; }
};

} // namespace demo
