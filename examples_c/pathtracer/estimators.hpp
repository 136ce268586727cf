// The estimators that the demo compares: the plain mean, and noisefloor's. All see the same samples.
#pragma once

#include "noisefloor.h"
#include <algorithm>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

namespace demo {

inline void check(nf_status status, const std::string &what)
{
    if (status != NF_OK)
        throw std::runtime_error(what + ": " + nf_status_message(status));
}

// A block of neighbouring pixels and their samples.
struct Samples {
    const float *u, *f;      // u[pixels * n * dims], f[pixels * n * 3]
    const uint32_t *surface; // [pixels], the same for pixels that show the same surface; for those who ask
    size_t pixels, n;
};

// One per thread: it owns the memory that an estimate needs, so that estimating allocates nothing.
struct Estimator {
    virtual ~Estimator() = default;
    // means[pixels * 3]
    virtual void estimate(const Samples &samples, float *means) = 0;
    virtual bool needs_surfaces() const { return false; }
};

// What looks at one pixel at a time.
class PixelEstimator : public Estimator {
public:
    explicit PixelEstimator(size_t dims) : dims_(dims) {}

    void estimate(const Samples &s, float *means) final
    {
        for (size_t p = 0; p < s.pixels; ++p)
            pixel(s.u + p * s.n * dims_, s.f + p * s.n * 3, s.n, means + p * 3);
    }

protected:
    // u[n * dims], f[n * 3] -> mean[3]
    virtual void pixel(const float *u, const float *f, size_t n, float *mean) = 0;

private:
    size_t dims_;
};

class PlainMean final : public PixelEstimator {
public:
    using PixelEstimator::PixelEstimator;

protected:
    void pixel(const float *, const float *f, size_t n, float *mean) override
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

class Regression final : public PixelEstimator {
public:
    Regression(const nf_cv_config &config, size_t n)
        : PixelEstimator(config.dims), config_(config), workspace_(memory(nf_cv_workspace_size(&config, n)))
    {
    }

protected:
    void pixel(const float *u, const float *f, size_t n, float *mean) override
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
class Streaming final : public PixelEstimator {
public:
    explicit Streaming(const nf_cv_config &config)
        : PixelEstimator(config.dims), config_(config), state_(memory(nf_cv_accumulator_size(&config))),
          workspace_(memory(nf_cv_accumulator_workspace_size(&config)))
    {
    }

protected:
    void pixel(const float *u, const float *f, size_t n, float *mean) override
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

// Each pixel is corrected by a fit to the others' samples: even one sample a pixel is enough, and whatever stratification the
// samples have within the pixel, or over the image, stays. The fit helps as far as the pixels' integrands are alike, so only
// pixels that show the same surface share one.
constexpr uint32_t block_side = 8; // pixels

class Block final : public Estimator {
public:
    Block(const nf_cv_config &config, size_t pixels, size_t n)
        : config_(config), workspace_(memory(nf_cv_block_workspace_size(&config, pixels, n))), u_(pixels * n * config.dims),
          f_(pixels * n * 3), results_(pixels)
    {
        left_.reserve(pixels);
    }

    void estimate(const Samples &s, float *means) override
    {
        const size_t u_size = s.n * config_.dims, f_size = s.n * 3;
        left_.resize(s.pixels);
        std::iota(left_.begin(), left_.end(), size_t{0});
        while (!left_.empty()) {
            // The pixels that show what the first one does.
            uint32_t surface = s.surface[left_.front()];
            auto others = std::stable_partition(left_.begin(), left_.end(), [&](size_t p) { return s.surface[p] == surface; });
            size_t pixels = static_cast<size_t>(others - left_.begin());
            for (size_t i = 0; i < pixels; ++i) {
                std::copy_n(s.u + left_[i] * u_size, u_size, &u_[i * u_size]);
                std::copy_n(s.f + left_[i] * f_size, f_size, &f_[i * f_size]);
            }
            check(nf_cv_block_estimate(&config_, u_.data(), f_.data(), pixels, s.n, workspace_.data(), 8 * workspace_.size(), results_.data()),
                  "nf_cv_block_estimate");
            for (size_t i = 0; i < pixels; ++i)
                std::copy_n(results_[i].mean, 3, means + 3 * left_[i]);
            left_.erase(left_.begin(), others);
        }
    }

    bool needs_surfaces() const override { return true; }

private:
    nf_cv_config config_;
    std::vector<uint64_t> workspace_;
    std::vector<float> u_, f_;
    std::vector<nf_estimate> results_;
    std::vector<size_t> left_; // pixels that have no estimate yet
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
    {"block", NF_CV_ROBUST, "blocks of 8 x 8 pixels, each pixel against a fit to the others; suits every sampler"},
    {"slices", NF_CV_ROBUST, "robust, told that the last dimension picks a light; `lights` only"},
};

struct EstimatorSetup {
    uint32_t dims, order, lights;
    size_t pixels;  // of a block, at most
    size_t samples; // of a pixel
    bool stratified;
};

// Throws if the name is unknown or the configuration is refused.
inline std::unique_ptr<Estimator> make_estimator(const std::string &name, const EstimatorSetup &setup)
{
    for (const EstimatorName &known : estimator_names) {
        if (name != known.name)
            continue;
        if (name == "mc")
            return std::make_unique<PlainMean>(setup.dims);
        nf_cv_config config;
        nf_cv_config_default(&config);
        config.dims = setup.dims;
        config.order = setup.order;
        config.channels = 3;
        config.estimator = known.id;
        config.slices = name == "slices" ? setup.lights : 0;
        // The robust estimator is then the plain mean: a pixel's few samples do not tell what their stratification gains.
        config.stratified = setup.stratified;
        bool block = name == "block";
        if ((block ? nf_cv_block_workspace_size(&config, setup.pixels, setup.samples) : nf_cv_workspace_size(&config, setup.samples)) == 0)
            throw std::runtime_error("noisefloor refuses estimator " + name + " with dims " + std::to_string(setup.dims) + ", order " + std::to_string(setup.order));
        if (block)
            return std::make_unique<Block>(config, setup.pixels, setup.samples);
        if (name == "incremental")
            return std::make_unique<Streaming>(config);
        return std::make_unique<Regression>(config, setup.samples);
    }
    throw std::runtime_error("there is no estimator `" + name + "`");
}

} // namespace demo
