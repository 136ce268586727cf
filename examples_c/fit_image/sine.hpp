// Sines and cosines of many numbers at once: std::sin is one call each, and half of such a network's time.
#pragma once
#include <cstddef>

namespace fit {

// The nearest whole number, for |x| < 2^22: what the sum cannot hold is rounded away.
inline float nearest(float x)
{
    constexpr float SHIFT = 12582912.0f; // 1.5 * 2^23
    return (x + SHIFT) - SHIFT;
}

// Errors below 1e-6 for |x| < 1000.
inline void sine_and_cosine(std::size_t count, const float *x, float *sine, float *cosine)
{
    for (std::size_t i = 0; i < count; ++i) {
        const float half_turns = nearest(x[i] * 0.318309886f);
        // pi in three parts, the first two short: their products with a whole number are exact.
        const float r = ((x[i] - half_turns * 3.140625f) - half_turns * 9.67502594e-4f) - half_turns * 1.50995799e-7f;
        const float odd = half_turns - 2.0f * nearest(0.5f * half_turns); // -1, 0 or 1
        const float sign = 1.0f - 2.0f * odd * odd;
        const float s = r * r; // Taylor's series: |r| is at most pi / 2.
        const float high_sine = 1.0f / 362880 - s / 39916800;
        const float high_cosine = 1.0f / 40320 + s * (-1.0f / 3628800 + s / 479001600);
        sine[i] = sign * r * (1.0f + s * (-1.0f / 6 + s * (1.0f / 120 + s * (-1.0f / 5040 + s * high_sine))));
        cosine[i] = sign * (1.0f + s * (-0.5f + s * (1.0f / 24 + s * (-1.0f / 720 + s * high_cosine))));
    }
}

} // namespace fit
