// Renders in passes over the whole image, as a progressive renderer does: no samples are kept, only an accumulator for each pixel. Every
// thread has accumulators of its own, so that none waits for another; they are merged at the end.
#pragma once

#include "render.hpp"
#include <map>

namespace demo {

// An accumulator for each pixel, side by side. It may be added to by one thread at a time.
class AccumulatorImage {
public:
    AccumulatorImage(const nf_cv_config &config, size_t pixels)
        : words_((nf_cv_accumulator_size(&config) + 7) / 8), memory_(words_ * pixels),
          workspace_(memory(nf_cv_accumulator_workspace_size(&config)))
    {
        for (size_t p = 0; p < pixels; ++p) {
            nf_cv_accumulator *accumulator = nullptr;
            check(nf_cv_accumulator_init(&memory_[p * words_], 8 * words_, &config, &accumulator), "nf_cv_accumulator_init");
        }
    }

    nf_cv_accumulator *pixel(size_t p) { return reinterpret_cast<nf_cv_accumulator *>(&memory_[p * words_]); }

    // Adds what another holds of all pixels.
    void merge(AccumulatorImage &other)
    {
        for (size_t p = 0; p * words_ < memory_.size(); ++p)
            check(nf_cv_accumulator_merge(pixel(p), other.pixel(p)), "nf_cv_accumulator_merge");
    }

    void estimate(Image &image)
    {
        for (size_t p = 0; p * words_ < memory_.size(); ++p) {
            nf_estimate result;
            check(nf_cv_accumulator_estimate(pixel(p), workspace_.data(), 8 * workspace_.size(), &result), "nf_cv_accumulator_estimate");
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
        : Rendering(options.estimators, options), integrand_(integrand), sampler_(sampler), dims_(dims(integrand.domains()))
    {
        pass_ = std::min(options.accumulate, (options.spp + 3) / 4 * 4);
        EstimatorSetup setup = estimator_setup(integrand, options, 1);
        for (const std::string &name : names_) {
            if (shares(name))
                throw std::runtime_error("`" + name + "` needs the samples of neighbouring pixels, which --accumulate does not keep");
            configs_.push_back(configure(find_estimator(name), setup));
            if (nf_cv_accumulator_size(&configs_.back()) == 0)
                throw std::runtime_error(refusal(name, configs_.back(), setup) + ", or it cannot be streamed, as --accumulate does");
        }
    }

private:
    // Threads take turns at passes; what each did is merged in the order of the threads.
    void work(uint32_t thread, Times &times) override
    {
        const size_t pixels = size_t{options_.width} * options_.height;
        std::vector<AccumulatorImage> images;
        for (size_t e = 0; e < names_.size(); ++e)
            images.emplace_back(configs_[e], pixels);
        // Samples of one row of pixels.
        std::vector<float> u(size_t{options_.width} * pass_ * dims_), f(size_t{options_.width} * pass_ * 3);
        const uint32_t passes = (options_.spp + pass_ - 1) / pass_;
        bool any = false;
        for (uint64_t pass; (pass = next_++) < passes; any = true) {
            uint32_t first = static_cast<uint32_t>(pass) * pass_, count = std::min(pass_, options_.spp - first);
            for (uint32_t y = 0; y < options_.height; ++y) {
                row(y, first, count, u.data(), f.data(), images, times);
                report(options_.width, pixels * passes);
            }
        }
        // Whoever comes last finishes the picture.
        std::lock_guard<std::mutex> lock(mutex_);
        if (any)
            parts_[thread] = std::move(images);
        if (++finished_threads_ == options_.threads)
            finish(times);
    }

    void row(uint32_t y, uint32_t first, uint32_t count, float *u, float *f, std::vector<AccumulatorImage> &images, Times &times)
    {
        auto start = Clock::now();
        for (uint32_t x = 0; x < options_.width; ++x)
            sampler_.range(x, y, first, count, u + size_t{x} * count * dims_);
        auto stop = Clock::now();
        times.drawing += seconds(start, stop);
        start = stop;
        for (uint32_t x = 0; x < options_.width; ++x)
            integrand_.evaluate(x, y, count, u + size_t{x} * count * dims_, f + size_t{x} * count * 3, nullptr);
        stop = Clock::now();
        times.tracing += seconds(start, stop);
        for (size_t e = 0; e < images.size(); ++e) {
            start = stop;
            for (uint32_t x = 0; x < options_.width; ++x)
                check(nf_cv_accumulator_add(images[e].pixel(size_t{y} * options_.width + x), u + size_t{x} * count * dims_,
                                            f + size_t{x} * count * 3, count),
                      "nf_cv_accumulator_add");
            stop = Clock::now();
            times.estimating[e] += seconds(start, stop);
        }
    }

    void finish(Times &times)
    {
        std::vector<AccumulatorImage> *sum = nullptr;
        for (auto &part : parts_) {
            for (size_t e = 0; sum && e < names_.size(); ++e) {
                auto start = Clock::now();
                (*sum)[e].merge(part.second[e]);
                times.estimating[e] += seconds(start, Clock::now());
            }
            if (!sum)
                sum = &part.second;
        }
        for (size_t e = 0; sum && e < names_.size(); ++e) {
            auto start = Clock::now();
            (*sum)[e].estimate(images_[e]);
            times.estimating[e] += seconds(start, Clock::now());
        }
    }

    const Integrand &integrand_;
    const Sampler &sampler_;
    const uint32_t dims_; // of the sample vector
    uint32_t pass_ = 0;   // samples of one
    std::vector<nf_cv_config> configs_;
    std::atomic<uint64_t> next_{0}; // pass
    // Guarded by mutex_:
    std::map<uint32_t, std::vector<AccumulatorImage>> parts_; // by thread
    uint32_t finished_threads_ = 0;
};

} // namespace demo
