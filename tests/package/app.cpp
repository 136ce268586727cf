// Uses the installed C++ wrapper and library: they must be of one version, and work.
#include <array>
#include <cstdio>
#include <noisefloor.hpp>

int main()
{
    if (!noisefloor::abi_matches()) {
        std::fprintf(stderr, "header and library have different ABI versions\n");
        return 1;
    }
    const std::array<float, 8> u{.1f, .9f, .4f, .2f, .7f, .6f, .3f, .8f};
    std::array<float, 8> f{};
    for (std::size_t i = 0; i < u.size(); i++)
        f[i] = 1 + 2 * u[i];
    noisefloor::config config(1, 1);
    config.estimator = NF_CV_LEAST_SQUARES;
    std::array<std::uint64_t, 4096> workspace;
    // Least squares of order 1 are exact for a linear integrand.
    const nf_estimate estimate = noisefloor::estimate(config, {u, f}, workspace);
    if (estimate.mean[0] < 1.9999f || estimate.mean[0] > 2.0001f) {
        std::fprintf(stderr, "the mean is %g instead of 2\n", static_cast<double>(estimate.mean[0]));
        return 1;
    }
    std::array<std::uint64_t, 1> small;
    try {
        noisefloor::estimate(config, {u, f}, small);
    } catch (const noisefloor::error &error) {
        return error.code() == noisefloor::status::memory ? 0 : 1;
    }
    std::fprintf(stderr, "8 bytes of workspace were enough\n");
    return 1;
}
