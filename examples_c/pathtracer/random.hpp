// Points of the unit cube, a function of (seed, frame, pixel, sample) alone: the image does not depend on the threads.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

namespace demo {

constexpr uint32_t max_dims = 32; // of references

// The finaliser of SplitMix64 (Steele, Lea, Flood 2014): with a counter as its input, a random access generator.
inline uint64_t mix(uint64_t z)
{
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

constexpr uint64_t golden = 0x9e3779b97f4a7c15u;

// 24 bits, so that every value is exact and below 1.
inline float unit(uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; }

// The generator in its usual form: a stream of independent, uniform numbers.
class SplitMix {
public:
    explicit SplitMix(uint64_t seed) : state_(seed) {}

    uint64_t bits() { return mix(state_ += golden); }
    // In [0, 1), or between two numbers.
    float operator()() { return unit(static_cast<uint32_t>(bits())); }
    float operator()(float low, float high) { return low + (high - low) * (*this)(); }

private:
    uint64_t state_;
};

// Of a pixel's key: beyond these numbers, seeds and frames would have the points of others.
constexpr uint64_t key_seeds = uint64_t{1} << 40, key_frames = uint64_t{1} << 24;

inline uint64_t pixel_key(uint64_t seed, uint32_t frame, uint32_t x, uint32_t y)
{
    return mix(mix(seed + golden + (uint64_t{frame} << 40)) ^ (uint64_t{y} << 32 | x));
}

// n independent, uniform points from number `first` on; row after row.
inline void random_points(uint64_t key, size_t first, size_t n, uint32_t dims, float *u)
{
    size_t i = first * dims, end = i + n * dims;
    auto bits = [&] { return mix(key + (i / 2 + 1) * golden); };
    if (i < end && i % 2 == 1) {
        *u++ = unit(static_cast<uint32_t>(bits() >> 32));
        ++i;
    }
    for (; i < end; i += 2) {
        uint64_t pair = bits();
        *u++ = unit(static_cast<uint32_t>(pair));
        if (i + 1 < end)
            *u++ = unit(static_cast<uint32_t>(pair >> 32));
    }
}

// Richtmyer's lattice: multiples of the square roots of primes, modulo 1, after a random shift. Every point is uniform,
// so a mean over them is unbiased, and it converges faster than over random points. For references only.
inline void lattice_points(uint64_t key, size_t first, size_t n, uint32_t dims, float *u)
{
    static const int primes[max_dims] = {2,  3,  5,  7,  11, 13, 17, 19, 23, 29, 31,  37,  41,  43,  47,  53,
                                         59, 61, 67, 71, 73, 79, 83, 89, 97, 101, 103, 107, 109, 113, 127, 131};
    if (dims > max_dims)
        throw std::runtime_error("a reference has at most " + std::to_string(max_dims) + " dimensions, not " +
                                 std::to_string(dims));
    for (uint32_t d = 0; d < dims; ++d) {
        double root = std::sqrt(static_cast<double>(primes[d]));
        uint64_t step = static_cast<uint64_t>((root - std::floor(root)) * 0x1p53) << 11;
        uint64_t value = mix(~key + d) + first * step;
        for (size_t i = 0; i < n; ++i, value += step)
            u[i * dims + d] = unit(static_cast<uint32_t>(value >> 32));
    }
}

} // namespace demo
