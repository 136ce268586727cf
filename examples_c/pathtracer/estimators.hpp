// The estimators that the demo compares: the plain mean, and noisefloor's. All see the same samples.
#pragma once

#include "noisefloor.h"
#include <algorithm>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace demo {

inline void check(nf_status status, const std::string &what)
{
    if (status != NF_OK)
        throw std::runtime_error(what + ": " + nf_status_message(status));
}

// One per thread: it owns the memory that an estimate needs, so that estimating allocates nothing.
struct Estimator {
    virtual ~Estimator() = default;
    // u[n * dims], f[n * 3] -> mean[3]
    virtual void estimate(const float *u, const float *f, size_t n, float *mean) = 0;
};

class PlainMean final : public Estimator {
public:
    void estimate(const float *, const float *f, size_t n, float *mean) override
    {
        float sum[3] = {0, 0, 0};
        for (size_t i = 0; i < n; ++i)
            for (int c = 0; c < 3; ++c)
                sum[c] += f[3 * i + static_cast<size_t>(c)];
        for (int c = 0; c < 3; ++c)
            mean[c] = sum[c] / static_cast<float>(n);
    }
};

// noisefloor's memory must be 8-byte aligned, which an array of uint64_t is.
inline std::vector<uint64_t> memory(size_t bytes) { return std::vector<uint64_t>((bytes + 7) / 8); }

class Regression final : public Estimator {
public:
    Regression(const nf_cv_config &config, size_t n) : config_(config), workspace_(memory(nf_cv_workspace_size(&config, n))) {}

    void estimate(const float *u, const float *f, size_t n, float *mean) override
    {
        nf_estimate result;
        check(nf_cv_estimate(&config_, u, f, n, workspace_.data(), 8 * workspace_.size(), &result), "nf_cv_estimate");
        std::copy(result.mean, result.mean + 3, mean);
    }

private:
    nf_cv_config config_;
    std::vector<uint64_t> workspace_;
};

// What a progressive renderer does: samples arrive a few at a time, and only an accumulator per pixel is kept.
class Streaming final : public Estimator {
public:
    explicit Streaming(const nf_cv_config &config)
        : config_(config), state_(memory(nf_cv_accumulator_size(&config))),
          workspace_(memory(nf_cv_accumulator_workspace_size(&config)))
    {
    }

    void estimate(const float *u, const float *f, size_t n, float *mean) override
    {
        constexpr size_t pass = 8;
        nf_cv_accumulator *accumulator = nullptr;
        check(nf_cv_accumulator_init(state_.data(), 8 * state_.size(), &config_, &accumulator), "nf_cv_accumulator_init");
        for (size_t i = 0; i < n; i += pass)
            check(nf_cv_accumulator_add(accumulator, u + i * config_.dims, f + i * 3, std::min(pass, n - i)), "nf_cv_accumulator_add");
        nf_estimate result;
        check(nf_cv_accumulator_estimate(accumulator, workspace_.data(), 8 * workspace_.size(), &result), "nf_cv_accumulator_estimate");
        std::copy(result.mean, result.mean + 3, mean);
    }

private:
    nf_cv_config config_;
    std::vector<uint64_t> state_, workspace_;
};

struct EstimatorName {
    const char *name;
    uint32_t id;
    const char *description;
};

inline const EstimatorName estimator_names[] = {
    {"mc", 0, "the plain mean"},
    {"robust", NF_CV_ROBUST, "noisefloor's default"},
    {"least_squares", NF_CV_LEAST_SQUARES, "a fit to all samples"},
    {"leave_one_out", NF_CV_LEAVE_ONE_OUT, "each sample against a fit to the others"},
    {"k_fold", NF_CV_K_FOLD, "each fold against a fit to the others; unbiased"},
    {"gradient_descent", NF_CV_GRADIENT_DESCENT, "least squares by gradient descent"},
    {"incremental", NF_CV_INCREMENTAL, "each sample against a fit to those before it; streamed, 8 samples at a time"},
    {"slices", NF_CV_ROBUST, "robust, told that the last dimension picks a light; `lights` only"},
};

struct EstimatorSetup {
    uint32_t dims, order, lights;
    size_t samples;
};

// Throws if the name is unknown or the configuration is refused.
inline std::unique_ptr<Estimator> make_estimator(const std::string &name, const EstimatorSetup &setup)
{
    for (const EstimatorName &known : estimator_names) {
        if (name != known.name)
            continue;
        if (name == "mc")
            return std::make_unique<PlainMean>();
        nf_cv_config config;
        nf_cv_config_default(&config);
        config.dims = setup.dims;
        config.order = setup.order;
        config.channels = 3;
        config.estimator = known.id;
        config.slices = name == "slices" ? setup.lights : 0;
        if (nf_cv_workspace_size(&config, setup.samples) == 0)
            throw std::runtime_error("noisefloor refuses estimator " + name + " with dims " + std::to_string(setup.dims) + ", order " + std::to_string(setup.order));
        if (name == "incremental")
            return std::make_unique<Streaming>(config);
        return std::make_unique<Regression>(config, setup.samples);
    }
    throw std::runtime_error("there is no estimator `" + name + "`");
}

} // namespace demo
