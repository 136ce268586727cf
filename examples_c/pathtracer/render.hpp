// Renders a scene with several estimators at once, and measures where the time goes.
#pragma once

#include "estimators.hpp"
#include "image.hpp"
#include "integrand.hpp"
#include "options.hpp"
#include "random.hpp"
#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>

namespace demo {

// Seconds, summed over the threads.
struct Times {
    double sampling = 0;
    std::vector<double> estimating;
};

class Renderer {
public:
    Renderer(const Scene &scene, const Intersector &intersector, const Options &options)
        : scene_(scene), options_(options), integrand_(scene, intersector), names_(options.estimators)
    {
        if (options.reference)
            names_ = {"mc"};
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
        EstimatorSetup setup{scene_.dims(), options_.order, static_cast<uint32_t>(scene_.lights.size()), options_.spp};
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
            rows();
        } catch (...) {
            std::lock_guard<std::mutex> lock(mutex_);
            if (!error_)
                error_ = std::current_exception();
            next_row_ = options_.height; // the others stop
        }
    }

    // Batches of about a thousand samples: reading the clock costs nothing beside them, they stay in the cache between
    // sampling and estimating, and every estimator meets the machine in the same mood.
    void rows()
    {
        const size_t n = options_.spp, dims = scene_.dims();
        const uint32_t batch = static_cast<uint32_t>(std::max<size_t>(1, 1024 / n));
        std::vector<float> u(batch * n * dims), f(batch * n * 3);
        auto estimators = make_estimators();
        Times times;
        times.estimating.resize(estimators.size());
        for (uint32_t y; (y = next_row_++) < options_.height;) {
            for (uint32_t begin = 0; begin < options_.width; begin += batch) {
                uint32_t end = std::min(options_.width, begin + batch);
                auto start = Clock::now();
                for (uint32_t x = begin; x < end; ++x)
                    sample(x, y, &u[(x - begin) * n * dims], &f[(x - begin) * n * 3]);
                auto stop = Clock::now();
                times.sampling += seconds(start, stop);
                for (size_t e = 0; e < estimators.size(); ++e) {
                    start = stop;
                    for (uint32_t x = begin; x < end; ++x)
                        estimators[e]->estimate(&u[(x - begin) * n * dims], &f[(x - begin) * n * 3], n,
                                                &images_[e].rgb[3 * (size_t{y} * options_.width + x)]);
                    stop = Clock::now();
                    times.estimating[e] += seconds(start, stop);
                }
            }
            report();
        }
        std::lock_guard<std::mutex> lock(mutex_);
        times_.sampling += times.sampling;
        for (size_t e = 0; e < estimators.size(); ++e)
            times_.estimating[e] += times.estimating[e];
    }

    void sample(uint32_t x, uint32_t y, float *u, float *f) const
    {
        const size_t n = options_.spp;
        const uint32_t dims = scene_.dims();
        uint64_t key = pixel_key(options_.seed, x, y);
        if (options_.reference)
            lattice_points(key, n, dims, u);
        else
            random_points(key, n, dims, u);
        Integrand::Pixel pixel = integrand_.pixel((static_cast<float>(x) + 0.5f) / static_cast<float>(options_.width),
                                                  (static_cast<float>(y) + 0.5f) / static_cast<float>(options_.height));
        for (size_t i = 0; i < n; ++i) {
            Color value = integrand_(pixel, u + i * dims);
            f[3 * i] = value.x;
            f[3 * i + 1] = value.y;
            f[3 * i + 2] = value.z;
        }
    }

    void report()
    {
        std::lock_guard<std::mutex> lock(mutex_);
        std::printf("progress %.4f\n", static_cast<double>(++finished_rows_) / options_.height);
        std::fflush(stdout);
    }

    const Scene &scene_;
    const Options &options_;
    Integrand integrand_;
    std::vector<std::string> names_;
    std::vector<Image> images_;
    Times times_;
    std::atomic<uint32_t> next_row_{0};
    std::mutex mutex_; // guards what follows, times_ and standard output
    uint32_t finished_rows_ = 0;
    std::exception_ptr error_;
};

} // namespace demo
