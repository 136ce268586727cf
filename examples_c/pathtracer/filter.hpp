// A pixel's footprint: the filter that the image is reconstructed with, sampled in proportion to it (Ernst et al.
// 2006), so that every sample has the same weight and each pixel remains an integral of its own.
#pragma once

#include <cmath>

namespace demo {

enum class Filter {
    center,  // a point: no antialiasing, and no numbers spent on it
    box,     // the pixel's square
    gaussian // standard deviation .5 pixels, cut at 1.5
};

struct FilterName {
    const char *name;
    Filter filter;
};

inline const FilterName filter_names[] = {
    {"center", Filter::center}, {"box", Filter::box}, {"gaussian", Filter::gaussian}};

// The inverse of std::erf (M. Giles, "Approximating the erfinv function", 2010), for |x| < .9975: to about 1e-5 in erf.
inline float inverse_erf(float x)
{
    float w = -std::log((1 - x) * (1 + x)) - 2.5f, p = 2.81022636e-08f;
    for (float c : {3.43273939e-07f, -3.5233877e-06f, -4.39150654e-06f, 2.1858087e-04f, -1.25372503e-03f,
                    -4.17768164e-03f, 2.46640727e-01f, 1.50140941f})
        p = c + p * w;
    return p * x;
}

// u in [0, 1) -> pixels from the pixel's centre, along one axis.
inline float footprint(Filter filter, float u)
{
    switch (filter) {
    case Filter::center: return 0;
    case Filter::box: return u - 0.5f;
    case Filter::gaussian: break;
    }
    const float inside = 0.9973002f; // erf(3 / sqrt(2)): three standard deviations on either side
    return 0.5f * 1.41421356f * inverse_erf((2 * u - 1) * inside);
}

} // namespace demo
