// What every way to render an image has in common: threads, images, times, progress.
#pragma once

#include "image.hpp"
#include "options.hpp"
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

class Rendering {
public:
    virtual ~Rendering() = default;

    // Prints "progress X" lines, X from `from` to `to`. Throws the first error of any thread.
    void run(double from = 0, double to = 1)
    {
        from_ = from;
        to_ = to;
        percent_ = static_cast<int>(100 * from);
        std::vector<std::thread> threads;
        try {
            for (uint32_t i = 0; i < options_.threads; ++i)
                threads.emplace_back([this, i] { guard(i); });
        } catch (...) {
            fail();
        }
        for (std::thread &thread : threads)
            thread.join();
        if (error_)
            std::rethrow_exception(error_);
    }

    const std::vector<Image> &images() const { return images_; }
    const Times &times() const { return times_; }

protected:
    using Clock = std::chrono::steady_clock;
    static double seconds(Clock::time_point from, Clock::time_point to)
    {
        return std::chrono::duration<double>(to - from).count();
    }

    // One image for each name. `options` must outlive it.
    Rendering(const std::vector<std::string> &names, const Options &options)
        : names_(names), options_(options), images_(names.size(), Image(options.width, options.height))
    {
        times_.estimating.resize(names.size());
    }

    // What one thread does.
    virtual void work(uint32_t thread, Times &times) = 0;

    // Some more of all that is to do is done. At most a hundred lines.
    void report(size_t done, size_t all)
    {
        std::lock_guard<std::mutex> lock(mutex_);
        if (error_)
            throw Stopped();
        done_ += done;
        const double progress = from_ + (to_ - from_) * static_cast<double>(done_) / static_cast<double>(all);
        const int percent = static_cast<int>(100 * progress);
        if (percent == percent_)
            return;
        percent_ = percent;
        std::printf("progress %.4f\n", progress);
        std::fflush(stdout);
    }

    const std::vector<std::string> names_; // of the estimators
    const Options &options_;
    std::vector<Image> images_;
    std::mutex mutex_; // guards what follows, and standard output

private:
    struct Stopped {}; // by another thread's error

    void guard(uint32_t thread)
    {
        try {
            Times times;
            times.estimating.resize(names_.size());
            work(thread, times);
            std::lock_guard<std::mutex> lock(mutex_);
            times_.drawing += times.drawing;
            times_.tracing += times.tracing;
            for (size_t e = 0; e < names_.size(); ++e)
                times_.estimating[e] += times.estimating[e];
        } catch (const Stopped &) {
        } catch (...) {
            fail();
        }
    }

    // Keeps the exception that is being handled, if it is the first.
    void fail()
    {
        std::lock_guard<std::mutex> lock(mutex_);
        if (!error_)
            error_ = std::current_exception();
    }

    Times times_;
    double from_ = 0, to_ = 1; // of the progress
    int percent_ = 0;          // of it, printed last
    size_t done_ = 0;
    std::exception_ptr error_;
};

} // namespace demo
