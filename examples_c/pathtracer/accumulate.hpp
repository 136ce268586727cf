// Renders in passes, as a progressive renderer does: no samples are kept, only an accumulator for each pixel. Each row
// is one thread's, and gets its passes in order: what a pixel's fit makes of them does not depend on the threads.
#pragma once

#include "render.hpp"

namespace demo {

// An accumulator for each pixel, side by side. It may be added to by one thread at a time.
class AccumulatorImage {
public:
    AccumulatorImage(const nf_cv_config &config, size_t pixels)
        : words_((nf_cv_accumulator_size(&config, nullptr) + 7) / 8), memory_(words_ * pixels),
          workspace_(memory(accumulator_workspace_size(config)))
    {
        for (size_t p = 0; p < pixels; ++p) {
            nf_cv_accumulator *accumulator = nullptr;
            check(nf_cv_accumulator_init(&memory_[p * words_], 8 * words_, &config, &accumulator),
                  "nf_cv_accumulator_init");
        }
    }

    nf_cv_accumulator *pixel(size_t p) { return reinterpret_cast<nf_cv_accumulator *>(&memory_[p * words_]); }

    void estimate(Image &image)
    {
        for (size_t p = 0; p * words_ < memory_.size(); ++p) {
            nf_estimate result;
            check(nf_cv_accumulator_estimate(pixel(p), workspace_.data(), 8 * workspace_.size(), &result),
                  "nf_cv_accumulator_estimate");
            std::copy_n(result.mean, 3, &image.rgb[3 * p]);
        }
    }

private:
    size_t words_; // of one pixel
    std::vector<uint64_t> memory_, workspace_;
};

class AccumulatingRenderer final : public Rendering {
public:
    // All three must outlive it. options.accumulate samples make a pass. Throws if an estimator cannot do so.
    AccumulatingRenderer(const Integrand &integrand, const Sampler &sampler, const Options &options)
        : Rendering(options.estimators, options), integrand_(integrand), sampler_(sampler),
          dims_(dims(integrand.domains()))
    {
        pass_ = std::min(options.accumulate, options.spp);
        EstimatorSetup setup = estimator_setup(integrand, options, 1);
        for (const std::string &name : names_) {
            if (shares(name))
                throw std::runtime_error(
                    "`" + name + "` needs the samples of neighbouring pixels, which --accumulate does not keep");
            configs_.push_back(configure(find_estimator(name), setup));
            if (nf_cv_accumulator_size(&configs_.back(), nullptr) == 0)
                throw std::runtime_error(refusal(name, configs_.back(), setup) +
                                         ", or it cannot be streamed, as --accumulate does");
            accumulators_.emplace_back(configs_.back(), size_t{options.width} * options.height);
        }
    }

private:
    // Threads take turns at rows.
    void work(uint32_t, Times &times) override
    {
        // Samples of one row of pixels.
        std::vector<float> u(size_t{options_.width} * pass_ * dims_), f(size_t{options_.width} * pass_ * 3);
        const uint32_t passes = (options_.spp + pass_ - 1) / pass_;
        for (uint64_t y; (y = next_++) < options_.height;) {
            for (uint32_t first = 0; first < options_.spp; first += pass_) {
                row(static_cast<uint32_t>(y), first, std::min(pass_, options_.spp - first), u.data(), f.data(), times);
                report(options_.width, size_t{options_.width} * options_.height * passes);
            }
        }
        // Whoever comes last finishes the picture.
        std::lock_guard<std::mutex> lock(mutex_);
        if (++finished_threads_ == options_.threads)
            finish(times);
    }

    void row(uint32_t y, uint32_t first, uint32_t count, float *u, float *f, Times &times)
    {
        auto start = Clock::now();
        for (uint32_t x = 0; x < options_.width; ++x)
            sampler_.range(x, y, first, count, u + size_t{x} * count * dims_);
        auto stop = Clock::now();
        times.drawing += seconds(start, stop);
        start = stop;
        for (uint32_t x = 0; x < options_.width; ++x)
            integrand_.evaluate(x, y, count, u + size_t{x} * count * dims_, f + size_t{x} * count * 3, nullptr,
                                nullptr);
        stop = Clock::now();
        times.tracing += seconds(start, stop);
        for (size_t e = 0; e < accumulators_.size(); ++e) {
            start = stop;
            for (uint32_t x = 0; x < options_.width; ++x) {
                const nf_cv_samples samples =
                    samples_of(u + size_t{x} * count * dims_, f + size_t{x} * count * 3, count);
                check(nf_cv_accumulator_add(accumulators_[e].pixel(size_t{y} * options_.width + x), &samples),
                      "nf_cv_accumulator_add");
            }
            stop = Clock::now();
            times.estimating[e] += seconds(start, stop);
        }
    }

    void finish(Times &times)
    {
        for (size_t e = 0; e < accumulators_.size(); ++e) {
            auto start = Clock::now();
            accumulators_[e].estimate(images_[e]);
            times.estimating[e] += seconds(start, Clock::now());
        }
    }

    const Integrand &integrand_;
    const Sampler &sampler_;
    const uint32_t dims_; // of the sample vector
    uint32_t pass_ = 0;   // samples of one
    std::vector<nf_cv_config> configs_;
    std::vector<AccumulatorImage> accumulators_;
    std::atomic<uint64_t> next_{0}; // row
    uint32_t finished_threads_ = 0; // guarded by mutex_
};

} // namespace demo
