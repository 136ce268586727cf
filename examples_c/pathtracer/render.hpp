// Renders a scene with several estimators at once, and measures where the time goes.
#pragma once

#include "estimators.hpp"
#include "image.hpp"
#include "options.hpp"
#include "samplers.hpp"
#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>

namespace demo {

// Seconds, summed over the threads.
struct Times {
    double drawing = 0; // of sample points
    double tracing = 0;
    std::vector<double> estimating;
};

class Renderer {
public:
    // All three must outlive it.
    Renderer(const Integrand &integrand, const Sampler &sampler, const Options &options)
        : integrand_(integrand), sampler_(sampler), options_(options), dims_(dims(integrand.domains())), names_(options.estimators)
    {
        if (options.reference)
            names_ = {"mc"};
        // As many samples as stay in the cache between sampling and estimating; pixels that share fits need neighbours.
        bool shared = std::find(names_.begin(), names_.end(), "shared") != names_.end();
        const size_t most = shared ? 1 << 19 : 1 << 12;
        side_ = shared ? 64 : 8;
        while (side_ > (shared ? 8u : 1u) && size_t{side_} * side_ * options.spp > most)
            side_ /= 2;
        // Fails before any work if a name or a configuration is wrong.
        make_estimators();
        images_.assign(names_.size(), Image(options.width, options.height));
        times_.estimating.resize(names_.size());
    }

    // Prints "progress X" lines, X from `from` to `to`. Throws the first error of any thread.
    void run(double from = 0, double to = 1)
    {
        from_ = from;
        to_ = to;
        percent_ = static_cast<int>(100 * from);
        std::vector<std::thread> threads;
        for (uint32_t i = 0; i < options_.threads; ++i)
            threads.emplace_back([this] { work(); });
        for (std::thread &thread : threads)
            thread.join();
        if (error_)
            std::rethrow_exception(error_);
    }

    const std::vector<std::string> &names() const { return names_; }
    const std::vector<Image> &images() const { return images_; }
    const Times &times() const { return times_; }

private:
    using Clock = std::chrono::steady_clock;
    static double seconds(Clock::time_point from, Clock::time_point to) { return std::chrono::duration<double>(to - from).count(); }

    std::vector<std::unique_ptr<Estimator>> make_estimators() const
    {
        EstimatorSetup setup{dims_, options_.regressed ? std::min(options_.regressed, dims_) : std::min(dims_, 16u), options_.order,
                             options_.basis.id, integrand_.lights(), choice(integrand_.domains()), side_,
                             options_.spp, options_.sampler != "random"};
        std::vector<std::unique_ptr<Estimator>> estimators;
        for (const std::string &name : names_)
            estimators.push_back(make_estimator(name, setup));
        return estimators;
    }

    void work()
    {
        try {
            buckets();
        } catch (...) {
            std::lock_guard<std::mutex> lock(mutex_);
            if (!error_)
                error_ = std::current_exception();
            next_ = ~uint64_t{0} >> 1; // the others stop
        }
    }

    // Square buckets of pixels: reading the clock costs nothing beside them, and every estimator meets the machine in the same
    // mood.
    void buckets()
    {
        const size_t n = options_.spp, pixels = size_t{side_} * side_;
        Buffers buffers{std::vector<float>(pixels * n * dims_), std::vector<float>(pixels * n * 3), std::vector<float>(pixels * 3),
                        std::vector<uint32_t>(pixels)};
        auto estimators = make_estimators();
        Times times;
        times.estimating.resize(estimators.size());
        const uint64_t columns = (options_.width + side_ - 1) / side_, rows = (options_.height + side_ - 1) / side_;
        for (uint64_t i; (i = next_++) < columns * rows;) {
            uint32_t x = static_cast<uint32_t>(i % columns) * side_, y = static_cast<uint32_t>(i / columns) * side_;
            Rectangle bucket{x, y, std::min(side_, options_.width - x), std::min(side_, options_.height - y)};
            render(bucket, estimators, times, buffers);
            report(size_t{bucket.width} * bucket.height);
        }
        std::lock_guard<std::mutex> lock(mutex_);
        times_.drawing += times.drawing;
        times_.tracing += times.tracing;
        for (size_t e = 0; e < estimators.size(); ++e)
            times_.estimating[e] += times.estimating[e];
    }

    struct Rectangle {
        uint32_t x, y, width, height;
    };
    struct Buffers {
        std::vector<float> u, f, means;
        std::vector<uint32_t> surface;
    };

    void render(Rectangle b, std::vector<std::unique_ptr<Estimator>> &estimators, Times &times, Buffers &buffers)
    {
        std::vector<float> &u = buffers.u, &f = buffers.f, &means = buffers.means;
        const size_t n = options_.spp, pixels = size_t{b.width} * b.height;
        auto column = [&](size_t p) { return b.x + static_cast<uint32_t>(p % b.width); };
        auto row = [&](size_t p) { return b.y + static_cast<uint32_t>(p / b.width); };
        auto start = Clock::now();
        for (size_t p = 0; p < pixels; ++p)
            sampler_.points(column(p), row(p), &u[p * n * dims_]);
        auto stop = Clock::now();
        times.drawing += seconds(start, stop);

        // The number of a pixel's surface comes with its samples, or costs a ray: that is the estimator's who asks for it.
        start = stop;
        bool free_surface = !integrand_.camera_ray_per_sample();
        for (size_t p = 0; p < pixels; ++p)
            integrand_.evaluate(column(p), row(p), n, &u[p * n * dims_], &f[p * n * 3], free_surface ? &buffers.surface[p] : nullptr);
        stop = Clock::now();
        times.tracing += seconds(start, stop);

        for (size_t e = 0; e < estimators.size(); ++e) {
            start = Clock::now();
            if (estimators[e]->needs_surfaces() && !free_surface)
                for (size_t p = 0; p < pixels; ++p)
                    integrand_.evaluate(column(p), row(p), 0, nullptr, nullptr, &buffers.surface[p]);
            estimators[e]->estimate({u.data(), f.data(), buffers.surface.data(), b.width, b.height, n}, means.data());
            stop = Clock::now();
            times.estimating[e] += seconds(start, stop);
            for (uint32_t y = 0; y < b.height; ++y)
                std::copy_n(&means[size_t{y} * b.width * 3], size_t{b.width} * 3,
                            &images_[e].rgb[3 * (size_t{b.y + y} * options_.width + b.x)]);
        }
    }

    // At most a hundred lines.
    void report(size_t pixels)
    {
        std::lock_guard<std::mutex> lock(mutex_);
        finished_ += pixels;
        const double all = static_cast<double>(options_.width) * options_.height;
        const double progress = from_ + (to_ - from_) * static_cast<double>(finished_) / all;
        const int percent = static_cast<int>(100 * progress);
        if (percent == percent_)
            return;
        percent_ = percent;
        std::printf("progress %.4f\n", progress);
        std::fflush(stdout);
    }

    const Integrand &integrand_;
    const Sampler &sampler_;
    const Options &options_;
    const uint32_t dims_; // of the sample vector
    std::vector<std::string> names_;
    std::vector<Image> images_;
    Times times_;
    double from_ = 0, to_ = 1; // of the progress
    int percent_ = 0;          // of it, printed last
    uint32_t side_ = 1; // of a bucket, in pixels
    std::atomic<uint64_t> next_{0}; // bucket
    std::mutex mutex_; // guards what follows, times_ and standard output
    size_t finished_ = 0; // pixels
    std::exception_ptr error_;
};

} // namespace demo
