// Tests of the path tracer's parts, by statistics: two ways to the same integral must agree.
//
// A test compares means at 5 standard errors: with fixed seeds it always says the same, and a correct program would
// fail one in 1.7 million of them by another choice of seeds. Each also demands standard errors small enough that an
// error of `resolution` would show: a test that is too noisy to fail is no test.
#pragma once

#include "../../examples_c/pathtracer/random.hpp"
#include <cmath>
#include <cstdio>

namespace test {

inline int failures = 0;

class Mean {
public:
    void add(double value)
    {
        ++n_;
        double difference = value - mean_;
        mean_ += difference / n_;
        squares_ += difference * (value - mean_);
    }
    double mean() const { return mean_; }
    double error() const { return std::sqrt(squares_ / (n_ - 1) / n_); }

private:
    double n_ = 0, mean_ = 0, squares_ = 0;
};

inline void expect(bool good, const char *what)
{
    if (good)
        return;
    ++failures;
    std::printf("FAILED: %s\n", what);
}

inline void expect_near(double value, double expected, double tolerance, const char *what)
{
    if (std::abs(value - expected) <= tolerance)
        return;
    ++failures;
    std::printf("FAILED: %s: %.8g, not %.8g +- %.2g\n", what, value, expected, tolerance);
}

// `resolution`: the relative error that must be detectable.
inline void expect_same(const char *what, double a, double error_a, double b, double error_b, double resolution = 0.02)
{
    double error = std::sqrt(error_a * error_a + error_b * error_b);
    std::printf("   %-72s %.5f  %.5f  +- %.5f\n", what, a, b, error);
    if (!(std::abs(a - b) <= 5 * error + 1e-6 * std::abs(b))) {
        ++failures;
        std::printf("FAILED: %s: they differ by %.1f standard errors\n", what, (a - b) / error);
    }
    if (!(5 * error <= resolution * std::abs(b))) {
        ++failures;
        std::printf("FAILED: %s: an error of %g would go unseen\n", what, resolution);
    }
}

// Of anything with mean() and error().
template <typename Mean> void expect_same(const char *what, const Mean &a, const Mean &b, double resolution = 0.02)
{
    expect_same(what, a.mean(), a.error(), b.mean(), b.error(), resolution);
}
template <typename Mean> void expect_mean(const char *what, const Mean &a, double expected, double resolution = 0.02)
{
    expect_same(what, a.mean(), a.error(), expected, 0, resolution);
}

// `resolution`: here absolute.
inline void expect_zero(const char *what, const Mean &mean, double resolution)
{
    std::printf("   %-72s %.5f  0  +- %.5f\n", what, mean.mean(), mean.error());
    expect(std::abs(mean.mean()) <= 5 * mean.error(), what);
    expect(5 * mean.error() <= resolution, "too noisy to tell");
}

// Independent uniform numbers.
struct Random : demo::SplitMix {
    // Seeds that follow each other are streams far apart.
    explicit Random(uint64_t seed) : SplitMix(demo::mix(seed)) {}
};

inline int finish()
{
    if (failures > 0)
        std::printf("%d checks failed\n", failures);
    return failures > 0;
}

} // namespace test
