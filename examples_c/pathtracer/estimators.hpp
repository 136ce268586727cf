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

// A rectangle of pixels, row after row, and their samples.
struct Samples {
    const float *u, *f;      // u[pixels * n * dims], f[pixels * n * 3]
    const uint32_t *surface; // [pixels], the same for pixels that show the same surface; for those who ask
    uint32_t width, height;
    size_t n; // of each pixel
    // For those who ask: what is known of each sample, as f, and integrals[pixels * 3] of that.
    const float *known = nullptr, *integrals = nullptr;

    size_t pixels() const { return size_t{width} * height; }
};

// One per thread: it owns the memory that an estimate needs, so that estimating allocates nothing.
struct Estimator {
    virtual ~Estimator() = default;
    // means[pixels * 3]
    virtual void estimate(const Samples &samples, float *means) = 0;
    virtual bool needs_surfaces() const { return false; }
    virtual bool needs_known() const { return false; }
};

// What looks at one pixel at a time.
class PixelEstimator : public Estimator {
public:
    // `stride`: numbers of the sample vector.
    explicit PixelEstimator(size_t stride) : stride_(stride) {}

    void estimate(const Samples &s, float *means) final
    {
        for (size_t p = 0; p < s.pixels(); ++p)
            pixel(s.u + p * s.n * stride_, s.f + p * s.n * 3, s.n, means + p * 3);
    }

protected:
    // u[n * stride], f[n * 3] -> mean[3]
    virtual void pixel(const float *u, const float *f, size_t n, float *mean) = 0;

private:
    size_t stride_;
};

class PlainMean final : public PixelEstimator {
public:
    using PixelEstimator::PixelEstimator;

protected:
    void pixel(const float *, const float *f, size_t n, float *mean) override
    {
        double sum[3] = {0, 0, 0}; // references have millions of samples
        for (size_t i = 0; i < n; ++i)
            for (int c = 0; c < 3; ++c)
                sum[c] += f[3 * i + static_cast<size_t>(c)];
        for (int c = 0; c < 3; ++c)
            mean[c] = static_cast<float>(sum[c] / static_cast<double>(n));
    }
};

// noisefloor's memory must be 8-byte aligned, which an array of uint64_t is.
inline std::vector<uint64_t> memory(size_t bytes) { return std::vector<uint64_t>((bytes + 7) / 8); }

inline nf_cv_samples samples_of(const float *u, const float *f, size_t n)
{
    nf_cv_samples samples = {};
    samples.u = u, samples.f = f, samples.n = n;
    return samples;
}

inline size_t accumulator_workspace_size(const nf_cv_config &config)
{
    size_t bytes = 0;
    nf_cv_accumulator_size(&config, &bytes);
    return bytes;
}

class Regression final : public PixelEstimator {
public:
    Regression(const nf_cv_config &config, size_t n)
        : PixelEstimator(config.stride), config_(config), workspace_(memory(nf_cv_workspace_size(&config, n)))
    {
    }

protected:
    void pixel(const float *u, const float *f, size_t n, float *mean) override
    {
        nf_estimate result;
        const nf_cv_samples samples = samples_of(u, f, n);
        check(nf_cv_estimate(&config_, &samples, 1, workspace_.data(), 8 * workspace_.size(), &result),
              "nf_cv_estimate");
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
        : PixelEstimator(config.stride), config_(config), state_(memory(nf_cv_accumulator_size(&config, nullptr))),
          workspace_(memory(accumulator_workspace_size(config)))
    {
    }

protected:
    void pixel(const float *u, const float *f, size_t n, float *mean) override
    {
        constexpr size_t pass = 8;
        nf_cv_accumulator *accumulator = nullptr;
        check(nf_cv_accumulator_init(state_.data(), 8 * state_.size(), &config_, &accumulator),
              "nf_cv_accumulator_init");
        for (size_t i = 0; i < n; i += pass) {
            const nf_cv_samples samples = samples_of(u + i * config_.stride, f + i * 3, std::min(pass, n - i));
            check(nf_cv_accumulator_add(accumulator, &samples), "nf_cv_accumulator_add");
        }
        nf_estimate result;
        check(nf_cv_accumulator_estimate(accumulator, workspace_.data(), 8 * workspace_.size(), &result),
              "nf_cv_accumulator_estimate");
        std::copy(result.mean, result.mean + 3, mean);
    }

private:
    nf_cv_config config_;
    std::vector<uint64_t> state_, workspace_;
};

// Each pixel is corrected by fits to the samples of its neighbours: even one sample a pixel is enough, and whatever
// stratification the samples have within the pixel, or over the image, stays. The fits help as far as the pixels'
// integrands are alike, so only pixels that show the same surface share them.
class Shared final : public Estimator {
public:
    enum Kind {
        told, // which pixels show the same surface
        blocks, // told that, in windows side by side, in a fourth of the time
        blind, // not told, in windows side by side, to show what that does
        known, // told that, and what is known of the samples
    };

    // For rectangles of at most `side` x `side` pixels. Windows do not reach beyond a rectangle, which should be large
    // beside them: theirs are 8 x 8 pixels.
    Shared(const nf_cv_config &config, uint32_t side, size_t n, Kind kind)
        : config_(config), kind_(kind), results_(size_t{side} * side)
    {
        nf_cv_image image = {};
        image.width = image.height = side;
        image.stride = stride();
        nf_cv_samples samples = samples_of(nullptr, nullptr, n);
        const float any = 0; // it is not read: that there is something known takes memory
        if (kind == known)
            samples.known = &any;
        workspace_ = memory(nf_cv_image_workspace_size(&config, &image, &samples));
    }

    void estimate(const Samples &s, float *means) override
    {
        nf_cv_image image = {};
        image.width = s.width;
        image.height = s.height;
        image.surfaces = kind_ == blind ? nullptr : s.surface;
        image.stride = stride();
        nf_cv_samples samples = samples_of(s.u, s.f, s.n);
        if (kind_ == known) {
            samples.known = s.known;
            samples.known_integrals = s.integrals;
        }
        check(nf_cv_image_estimate(&config_, &image, &samples, workspace_.data(), 8 * workspace_.size(),
                                   results_.data()),
              "nf_cv_image_estimate");
        for (size_t p = 0; p < s.pixels(); ++p)
            std::copy_n(results_[p].mean, 3, means + 3 * p);
    }

    bool needs_surfaces() const override { return kind_ != blind; }
    bool needs_known() const override { return kind_ == known; }

private:
    uint32_t stride() const { return kind_ == blind || kind_ == blocks ? 8 : 0; }

    nf_cv_config config_;
    Kind kind_;
    std::vector<uint64_t> workspace_;
    std::vector<nf_estimate> results_;
};

struct EstimatorName {
    const char *name;
    uint32_t id;
    const char *description;
    uint32_t color = NF_COLOR_PER_CHANNEL;
};

struct Basis {
    const char *name;
    uint32_t id;
};

inline const Basis basis_names[] = {
    {"legendre", NF_BASIS_LEGENDRE}, {"step", NF_BASIS_STEP}, {"sine", NF_BASIS_SINE}, {"gaussian", NF_BASIS_GAUSSIAN}};

inline const EstimatorName estimator_names[] = {
    {"mc", 0, "the plain mean"},
    {"robust", NF_CV_ROBUST, "noisefloor's default"},
    {"least_squares", NF_CV_LEAST_SQUARES, "a fit to all samples"},
    {"leave_one_out", NF_CV_LEAVE_ONE_OUT, "each sample against a fit to the others"},
    {"k_fold", NF_CV_K_FOLD, "each fold against a fit to the others; unbiased"},
    {"gradient_descent", NF_CV_GRADIENT_DESCENT, "least squares by gradient descent"},
    {"incremental", NF_CV_INCREMENTAL, "each sample against a fit to those before it; streamed, 8 samples at a time"},
    {"shared", NF_CV_ROBUST, "each pixel against fits to its neighbours; suits every sampler"},
    {"shared_blocks", NF_CV_ROBUST, "the same in windows side by side, not half over each other: a fourth of the time"},
    {"shared_k_fold", NF_CV_K_FOLD, "shared, unbiased: halves of the neighbours choose fits for each other"},
    {"shared_blind", NF_CV_ROBUST, "shared, but not told which pixels show the same surface, in windows side by side"},
    {"shared_edges", NF_CV_ROBUST, "shared, told which numbers pick a point of a light: follows the edges of shadows"},
    {"shared_known", NF_CV_ROBUST, "shared, told what direct light would be with nothing in its way"},
    {"known", NF_CV_LEAVE_ONE_OUT, "each pixel against that alone, as far as its neighbours follow it; unbiased"},
    {"luminance", NF_CV_LEAST_SQUARES, "a fit to the luminance of all samples, which scales the plain mean",
     NF_COLOR_LUMINANCE_RATIO},
    {"robust_luminance", NF_CV_ROBUST, "the same with the default estimator", NF_COLOR_LUMINANCE_RATIO},
    {"slices", NF_CV_ROBUST, "robust, told which light was picked; for scenes that pick one"},
};

struct EstimatorSetup {
    uint32_t dims;      // of the sample vector
    uint32_t regressed; // of them, from the first; at most 16
    uint32_t order, basis, lights;
    uint32_t choice; // numbers of u up to the first that picks a light; 0 if none does
    uint32_t point;  // the first number, counted from 1, that picks a point of a light; 0 if none does
    uint32_t side;   // of the rectangles that pixels come in, at most
    size_t samples;  // of a pixel
    bool stratified;
    const char *settings = "--regressed and --order set them"; // what a refusal says of dims and order
};

// Whether it needs what is known of the samples.
inline bool needs_known(const std::string &name) { return name == "shared_known" || name == "known"; }

// Whether it needs the samples of neighbouring pixels.
inline bool shares(const std::string &name)
{
    return name == "shared" || name == "shared_blocks" || name == "shared_k_fold" || name == "shared_blind" ||
           name == "shared_edges" || needs_known(name);
}

// Throws if the name is unknown.
inline const EstimatorName &find_estimator(const std::string &name)
{
    for (const EstimatorName &known : estimator_names)
        if (name == known.name)
            return known;
    throw std::runtime_error("there is no estimator `" + name + "`; --help lists them");
}

inline nf_cv_config configure(const EstimatorName &known, const EstimatorSetup &setup)
{
    const std::string name = known.name;
    nf_cv_config config = {};
    config.dims = setup.regressed;
    config.stride = setup.dims;
    config.basis = setup.basis;
    config.color = known.color;
    config.order = name == "mc" ? 0 : setup.order;
    config.channels = 3;
    config.estimator = known.id;
    // The robust estimator is then the plain mean: a pixel's few samples do not tell what their stratification gains.
    config.stratified = setup.stratified;
    if (name == "slices" && setup.choice == 0)
        throw std::runtime_error("`slices` needs a scene that picks one of several lights");
    if ((shares(name) || name == "slices") && setup.choice > 0) {
        // Which light was picked is known, and explains most. Of long paths only what comes before is regressed.
        config.dims = setup.choice;
        config.slices = setup.lights;
    }
    if (name == "shared_edges" && setup.point < config.dims)
        config.edges = setup.point;
    return config;
}

// What went wrong with a configuration that noisefloor refuses.
inline std::string refusal(const std::string &name, const nf_cv_config &config, const EstimatorSetup &setup)
{
    return "noisefloor refuses estimator " + name + " with dims " + std::to_string(config.dims) + ", order " +
           std::to_string(config.order) + " (terms are limited to 136, dims to 16; " + setup.settings + ")";
}

// Throws if the name is unknown or the configuration is refused.
inline std::unique_ptr<Estimator> make_estimator(const std::string &name, const EstimatorSetup &setup)
{
    const nf_cv_config config = configure(find_estimator(name), setup);
    if (name == "mc")
        return std::make_unique<PlainMean>(setup.dims);
    if (nf_cv_workspace_size(&config, setup.samples) == 0)
        throw std::runtime_error(refusal(name, config, setup));
    if (shares(name)) {
        const Shared::Kind kind = needs_known(name)         ? Shared::known
                                  : name == "shared_blocks" ? Shared::blocks
                                  : name == "shared_blind"  ? Shared::blind
                                                            : Shared::told;
        return std::make_unique<Shared>(config, setup.side, setup.samples, kind);
    }
    if (name == "incremental")
        return std::make_unique<Streaming>(config);
    return std::make_unique<Regression>(config, setup.samples);
}

} // namespace demo
