// Renders a scene with several estimators at once, and measures where the time goes.
#pragma once

#include "estimators.hpp"
#include "image.hpp"
#include "integrand.hpp"
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
    Renderer(const Scene &scene, const Intersector &intersector, const Sampler &sampler, const Options &options)
        : scene_(scene), sampler_(sampler), options_(options), integrand_(scene, intersector), names_(options.estimators)
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

    // Prints "progress X" lines, X in [0, 1]. Throws the first error of any thread.
    void run()
    {
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
        EstimatorSetup setup{scene_.dims(), options_.order, static_cast<uint32_t>(scene_.lights.size()), scene_.choice(), side_,
                             options_.spp, options_.sampler != "random"};
        std::vector<std::unique_ptr<Estimator>> estimators;
        for (const std::string &name : names_) {
            if (name == "slices" && scene_.layout != Layout::lights)
                throw std::runtime_error("`slices` needs the scene `lights`, whose last dimension picks a light");
            estimators.push_back(make_estimator(name, setup));
        }
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
        Buffers buffers{std::vector<float>(pixels * n * scene_.dims()), std::vector<float>(pixels * n * 3), std::vector<float>(pixels * 3),
                        std::vector<Integrand::Pixel>(pixels), std::vector<uint32_t>(pixels)};
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
        std::vector<Integrand::Pixel> pixels;
        std::vector<uint32_t> surface;
    };

    void render(Rectangle b, std::vector<std::unique_ptr<Estimator>> &estimators, Times &times, Buffers &buffers)
    {
        std::vector<float> &u = buffers.u, &f = buffers.f, &means = buffers.means;
        const size_t n = options_.spp, dims = scene_.dims(), pixels = size_t{b.width} * b.height;
        auto start = Clock::now();
        for (size_t p = 0; p < pixels; ++p)
            sampler_.points(b.x + static_cast<uint32_t>(p % b.width), b.y + static_cast<uint32_t>(p / b.width), &u[p * n * dims]);
        auto stop = Clock::now();
        times.drawing += seconds(start, stop);

        start = stop;
        for (size_t p = 0; p < pixels; ++p)
            buffers.pixels[p] = trace(b.x + static_cast<uint32_t>(p % b.width), b.y + static_cast<uint32_t>(p / b.width), &u[p * n * dims],
                                      &f[p * n * 3]);
        stop = Clock::now();
        times.tracing += seconds(start, stop);

        for (size_t e = 0; e < estimators.size(); ++e) {
            start = Clock::now();
            if (estimators[e]->needs_surfaces())
                for (size_t p = 0; p < pixels; ++p)
                    buffers.surface[p] = integrand_.surface(buffers.pixels[p]);
            estimators[e]->estimate({u.data(), f.data(), buffers.surface.data(), b.width, b.height, n}, means.data());
            stop = Clock::now();
            times.estimating[e] += seconds(start, stop);
            for (uint32_t row = 0; row < b.height; ++row)
                std::copy_n(&means[size_t{row} * b.width * 3], size_t{b.width} * 3,
                            &images_[e].rgb[3 * (size_t{b.y + row} * options_.width + b.x)]);
        }
    }

    Integrand::Pixel trace(uint32_t x, uint32_t y, const float *u, float *f) const
    {
        const uint32_t dims = scene_.dims();
        Integrand::Pixel pixel = integrand_.pixel((static_cast<float>(x) + 0.5f) / static_cast<float>(options_.width),
                                                  (static_cast<float>(y) + 0.5f) / static_cast<float>(options_.height));
        for (size_t i = 0; i < options_.spp; ++i) {
            Color value = integrand_(pixel, u + i * dims);
            f[3 * i] = value.x;
            f[3 * i + 1] = value.y;
            f[3 * i + 2] = value.z;
        }
        return pixel;
    }

    // At most a hundred lines.
    void report(size_t pixels)
    {
        std::lock_guard<std::mutex> lock(mutex_);
        const size_t all = size_t{options_.width} * options_.height, before = 100 * finished_ / all;
        finished_ += pixels;
        if (100 * finished_ / all == before)
            return;
        std::printf("progress %.4f\n", static_cast<double>(finished_) / static_cast<double>(all));
        std::fflush(stdout);
    }

    const Scene &scene_;
    const Sampler &sampler_;
    const Options &options_;
    Integrand integrand_;
    std::vector<std::string> names_;
    std::vector<Image> images_;
    Times times_;
    uint32_t side_ = 1; // of a bucket, in pixels
    std::atomic<uint64_t> next_{0}; // bucket
    std::mutex mutex_; // guards what follows, times_ and standard output
    size_t finished_ = 0; // pixels
    std::exception_ptr error_;
};

} // namespace demo
