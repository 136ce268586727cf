// Reflection whose light can be integrated in closed form: a linearly transformed cosine (Heitz et al. 2016, "Real-Time
// Polygonal-Light Shading with Linearly Transformed Cosines"), narrowed around its axis alone.
#pragma once

#include "vector.hpp"

namespace demo {

struct Lobe {
    Vector axis;     // unit
    float width = 1; // 1: the cosine; less: narrower; more: wider
    Color weight;    // how much of the light is reflected to the camera
};

// The lobe at a cosine to its axis, per solid angle; 1 integrated over all directions.
inline float lobe_density(float width, float cosine)
{
    float square = width * width, spread = 1 - (1 - square) * cosine * cosine;
    return cosine > 0 ? square * cosine / (pi * spread * spread) : 0.0f;
}

// As high as a Phong lobe, and nearly of its shape.
inline float phong_width(float exponent) { return std::sqrt(2 / (exponent + 1)); }

// What a camera ray ended at, as far as light in closed form depends on it. Weights of 0: nothing is known here.
struct Shown {
    Vector point;
    Lobe diffuse, glossy;
};

} // namespace demo
