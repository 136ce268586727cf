// Surfaces: smooth glass (dielectric.hpp), or reflection by Lambert's diffuse term plus the normalised Phong lobe
// (Lafortune and Willems 1994). That reflects at most diffuse + glossy of the light that arrives, and scenes keep the
// sum at or below 1.
#pragma once

#include "dielectric.hpp"

namespace demo {

struct Material {
    Color diffuse;
    Color glossy;
    float exponent = 0;
    float index = 0; // of refraction; above 0: smooth glass, and the others say nothing

    bool specular() const { return index > 0; }
    bool dark() const { return black(diffuse) && black(glossy) && !specular(); }
};

// A surface as seen along `out`: unit vectors pointing away from it, normals turned to the side of `out`.
struct Shading {
    const Material &material;
    Vector geometric, normal, out;
    bool inside; // whether `out` is at the back of the surface
};

inline float power(float base, float exponent) { return base > 0 ? std::pow(base, exponent) : 0.0f; }

// Whether light from `in` is reflected to `out` at all: it is on the same side, for both normals.
inline bool reflects(const Shading &s, Vector in) { return dot(s.normal, in) > 0 && dot(s.geometric, in) > 0; }

// The BRDF times the cosine.
inline Color reflectance(const Shading &s, Vector in)
{
    if (!reflects(s, in))
        return {};
    Color value = s.material.diffuse / pi;
    if (!black(s.material.glossy)) {
        float lobe = power(dot(reflect(s.out, s.normal), in), s.material.exponent);
        value += s.material.glossy * ((s.material.exponent + 2) / (2 * pi) * lobe);
    }
    return value * dot(s.normal, in);
}

// How often `sample_direction` picks the glossy lobe.
inline float glossy_probability(const Material &m)
{
    float glossy = largest(m.glossy), sum = glossy + largest(m.diffuse);
    return sum > 0 ? glossy / sum : 0.0f;
}

// The density of `sample_direction`, per solid angle.
inline float direction_pdf(const Shading &s, Vector in)
{
    float glossy = glossy_probability(s.material), cosine = std::max(0.0f, dot(s.normal, in));
    float pdf = (1 - glossy) * cosine / pi;
    if (glossy > 0) {
        float lobe = power(dot(reflect(s.out, s.normal), in), s.material.exponent);
        pdf += glossy * (s.material.exponent + 1) / (2 * pi) * lobe;
    }
    return pdf;
}

// Draws a direction in proportion to one of the two terms; the choice of the term is made with u, which is then reused.
// A glossy direction may lie below the surface: `reflects` is then false, and its light is lost.
inline Vector sample_direction(const Shading &s, float u, float v)
{
    float glossy = glossy_probability(s.material), azimuth = 2 * pi * v;
    bool pick = u < glossy;
    float w = pick ? u / glossy : (u - glossy) / (1 - glossy);
    float cosine = pick ? std::pow(1 - w, 1 / (s.material.exponent + 1)) : std::sqrt(1 - w);
    float sine = std::sqrt(std::max(0.0f, 1 - cosine * cosine));
    Frame frame(pick ? reflect(s.out, s.normal) : s.normal);
    return frame.world({sine * std::cos(azimuth), sine * std::sin(azimuth), cosine});
}

} // namespace demo
