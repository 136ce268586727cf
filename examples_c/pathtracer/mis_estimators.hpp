// Direct light by two techniques, combined by multiple importance sampling, without and with regression (section
// 4.3.3).
#pragma once

#include "estimators.hpp"
#include <cstring>

namespace demo {

// What of one sample the estimators need, beside its numbers: a direction's value and both densities, per solid angle.
// Not divided by any density. `pdf` of the technique that drew it is 0 where it failed: from within a light, say.
struct Drawn {
    float value[3];
    float pdf[2]; // by light sampling, by direction sampling
};

// The values of an integrand for these estimators: a direction from each technique, and the light that needs none.
struct TwoTechniques {
    Drawn drawn[2];
    float emitted[3];
};
static_assert(sizeof(TwoTechniques) == 13 * sizeof(float), "a row of floats");

struct MisEstimatorName {
    const char *name;
    bool optimal, regression;
    const char *description;
};

inline const MisEstimatorName mis_estimator_names[] = {
    {"balance", false, false, "the balance heuristic"},
    {"balance_regression", false, true, "each technique's weighted samples regressed"},
    {"optimal", true, false, "optimal weights (Kondapaneni et al. 2019), with a ridge"},
    {"optimal_regression", true, true, "each technique's optimally weighted samples regressed"},
};

// Of pairs of samples, u[4]: the light's two numbers, the direction's two.
class MisEstimator final : public Estimator {
public:
    MisEstimator(const MisEstimatorName &kind, const nf_cv_config &config, size_t pairs)
        : kind_(kind), config_(config), pairs_(pairs), weighted_(3 * pairs),
          workspace_(memory(nf_cv_workspace_size(&config, pairs))), omis_(memory(nf_omis_size(2, 3)))
    {
    }

    void estimate(const Samples &s, float *means) override
    {
        for (size_t p = 0; p < s.pixels(); ++p) {
            std::memcpy(pairs_.data(), s.f + p * s.n * 13, s.n * sizeof(TwoTechniques));
            pixel(s.u + p * s.n * 4, pairs_.data(), s.n, means + 3 * p);
        }
    }

private:
    void pixel(const float *u, const TwoTechniques *pairs, size_t n, float *mean)
    {
        const uint32_t counts[2] = {static_cast<uint32_t>(n), static_cast<uint32_t>(n)};
        float alpha[6] = {0, 0, 0, 0, 0, 0}; // [channel][technique]; all 0 is the balance heuristic
        if (kind_.optimal) {
            nf_omis *omis = nullptr;
            check(nf_omis_init(omis_.data(), 8 * omis_.size(), 2, 3, counts, &omis), "nf_omis_init");
            for (size_t i = 0; i < n; ++i)
                for (uint32_t t = 0; t < 2; ++t) {
                    // What failed counts, too: as worth nothing, where no other technique draws.
                    Drawn failed = {};
                    failed.pdf[t] = 1;
                    const Drawn &sample = pairs[i].drawn[t].pdf[t] > 0 ? pairs[i].drawn[t] : failed;
                    check(nf_omis_add(omis, sample.pdf, &t, sample.value, 1), "nf_omis_add");
                }
            check(nf_omis_solve(omis, NF_OMIS_RIDGE, 0, nullptr, alpha), "nf_omis_solve");
        }
        std::copy_n(pairs[0].emitted, 3, mean);
        for (uint32_t t = 0; t < 2; ++t) {
            for (size_t i = 0; i < n; ++i)
                for (size_t c = 0; c < 3; ++c)
                    weighted_[3 * i + c] =
                        static_cast<float>(n) * contribution(pairs[i].drawn[t], t, n, alpha + 2 * c, c);
            add_mean(u + 2 * t, n, mean);
        }
    }

    // What a sample adds to the estimate: w f / (n p). nf_mis_optimal_contribution() says the same for any number of
    // techniques and checks its arguments, which takes some 70 ns: more than all else here for the balance heuristic.
    static float contribution(const Drawn &drawn, uint32_t technique, size_t n, const float *alpha, size_t channel)
    {
        if (!(drawn.pdf[technique] > 0))
            return 0;
        float sum = static_cast<float>(n) * (drawn.pdf[0] + drawn.pdf[1]);
        float rest = drawn.value[channel] - alpha[0] * drawn.pdf[0] - alpha[1] * drawn.pdf[1];
        return alpha[technique] / static_cast<float>(n) + rest / sum;
    }

    // Adds the mean of weighted_, or its regression over one technique's numbers.
    void add_mean(const float *u, size_t n, float *mean)
    {
        if (kind_.regression) {
            nf_estimate result;
            const nf_cv_samples samples = samples_of(u, weighted_.data(), n);
            check(nf_cv_estimate(&config_, &samples, 1, workspace_.data(), 8 * workspace_.size(), &result),
                  "nf_cv_estimate");
            for (size_t c = 0; c < 3; ++c)
                mean[c] += result.mean[c];
            return;
        }
        for (size_t c = 0; c < 3; ++c) {
            float sum = 0;
            for (size_t i = 0; i < n; ++i)
                sum += weighted_[3 * i + c];
            mean[c] += sum / static_cast<float>(n);
        }
    }

    MisEstimatorName kind_;
    nf_cv_config config_; // of one technique's samples
    std::vector<TwoTechniques> pairs_;
    std::vector<float> weighted_;
    std::vector<uint64_t> workspace_, omis_;
};

// Throws if the name is unknown or the configuration is refused.
inline std::unique_ptr<Estimator> make_mis_estimator(const std::string &name, const EstimatorSetup &setup)
{
    for (const MisEstimatorName &known : mis_estimator_names) {
        if (name != known.name)
            continue;
        nf_cv_config config = {};
        config.dims = 2;
        config.stride = setup.dims;
        config.order = setup.order;
        config.basis = setup.basis;
        config.channels = 3;
        config.stratified = setup.stratified;
        if (nf_cv_workspace_size(&config, setup.samples) == 0)
            throw std::runtime_error(refusal(name, config, setup));
        return std::make_unique<MisEstimator>(known, config, setup.samples);
    }
    throw std::runtime_error("there is no estimator `" + name + "` for --mis; --help lists them");
}

} // namespace demo
