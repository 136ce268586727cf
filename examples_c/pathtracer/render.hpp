// Renders a scene with several estimators at once, bucket by bucket, and measures where the time goes. Fits that pixels
// share end at a bucket's border: each bucket is an image of its own. A renderer that keeps the samples of the buckets
// around has the windows whole, by nf_cv_image's `given` and `wanted`: see ../strips.cpp.
#pragma once

#include "estimators.hpp"
#include "integrand.hpp"
#include "lobe.hpp"
#include "mis_estimators.hpp"
#include "rendering.hpp"
#include "samplers.hpp"

namespace demo {

// `side`: of the rectangles that pixels come in, at most.
inline EstimatorSetup estimator_setup(const Integrand &integrand, const Options &options, uint32_t side)
{
    const std::vector<Domain> domains = integrand.domains();
    EstimatorSetup setup = {};
    setup.dims = dims(domains);
    setup.regressed = std::min(options.regressed ? options.regressed : 16, setup.dims);
    setup.order = options.order;
    setup.basis = options.basis.id;
    setup.lights = integrand.lights();
    setup.choice = choice(domains);
    setup.point = light_point(domains);
    setup.side = side;
    setup.samples = options.spp;
    setup.stratified = options.sampler != "random" && !options.independent;
    return setup;
}

class Renderer final : public Rendering {
public:
    // All three must outlive it.
    Renderer(const Integrand &integrand, const Sampler &sampler, const Options &options)
        : Rendering(options.reference ? std::vector<std::string>{"mc"} : options.estimators, options),
          integrand_(integrand), sampler_(sampler), dims_(dims(integrand.domains()))
    {
        // As many samples as stay in the cache between sampling and estimating; pixels that share fits need neighbours.
        bool shared = std::any_of(names_.begin(), names_.end(), shares);
        const size_t most = shared ? 1 << 19 : 1 << 12;
        side_ = shared ? 64 : 8;
        while (side_ > (shared ? 8u : 1u) && size_t{side_} * side_ * options.spp > most)
            side_ /= 2;
        // Fails before any work if a name or a configuration is wrong.
        for (const auto &estimator : make_estimators())
            needs_known_ |= estimator->needs_known();
        if (needs_known_ && !integrand_.has_known())
            throw std::runtime_error("`known` and `shared_known` are for direct light alone: of paths, of --mis and of "
                                     "other integrands nothing is known");
    }

private:
    std::vector<std::unique_ptr<Estimator>> make_estimators() const
    {
        EstimatorSetup setup = estimator_setup(integrand_, options_, side_);
        std::vector<std::unique_ptr<Estimator>> estimators;
        for (const std::string &name : names_)
            estimators.push_back(options_.mis ? make_mis_estimator(name, setup) : make_estimator(name, setup));
        return estimators;
    }

    // Square buckets of pixels: reading the clock costs nothing beside them, and every estimator meets the machine in
    // the same mood.
    void work(uint32_t, Times &times) override
    {
        const size_t n = options_.spp, pixels = size_t{side_} * side_;
        Buffers buffers{std::vector<float>(pixels * n * dims_), std::vector<float>(pixels * n * integrand_.values()),
                        std::vector<float>(pixels * 3), std::vector<uint32_t>(pixels), {}, {}, {}};
        if (needs_known_) {
            buffers.shown.resize(pixels * rays());
            buffers.known.resize(pixels * n * 3);
            buffers.integrals.resize(pixels * 3);
        }
        auto estimators = make_estimators();
        const uint64_t columns = (options_.width + side_ - 1) / side_, rows = (options_.height + side_ - 1) / side_;
        for (uint64_t i; (i = next_++) < columns * rows;) {
            uint32_t x = static_cast<uint32_t>(i % columns) * side_, y = static_cast<uint32_t>(i / columns) * side_;
            Rectangle bucket{x, y, std::min(side_, options_.width - x), std::min(side_, options_.height - y)};
            render(bucket, estimators, times, buffers);
            report(size_t{bucket.width} * bucket.height, size_t{options_.width} * options_.height);
        }
    }

    struct Rectangle {
        uint32_t x, y, width, height;
    };
    struct Buffers {
        std::vector<float> u, f, means;
        std::vector<uint32_t> surface;
        std::vector<Shown> shown;
        std::vector<float> known, integrals;
    };

    // From the camera, for the samples of a pixel.
    size_t rays() const { return integrand_.camera_ray_per_sample() ? options_.spp : 1; }

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

        // The number of a pixel's surface comes with its samples, or costs a ray: that is the estimator's who asks for
        // it. So is the time for what is known.
        start = stop;
        const bool free_surface = !integrand_.camera_ray_per_sample();
        for (size_t p = 0; p < pixels; ++p) {
            uint32_t *surface = free_surface ? &buffers.surface[p] : nullptr;
            Shown *shown = needs_known_ ? &buffers.shown[p * rays()] : nullptr;
            integrand_.evaluate(column(p), row(p), n, &u[p * n * dims_], &f[p * n * integrand_.values()], surface,
                                shown);
        }
        stop = Clock::now();
        times.tracing += seconds(start, stop);

        for (size_t e = 0; e < estimators.size(); ++e) {
            start = Clock::now();
            if (estimators[e]->needs_surfaces() && !free_surface)
                for (size_t p = 0; p < pixels; ++p)
                    integrand_.evaluate(column(p), row(p), 0, nullptr, nullptr, &buffers.surface[p], nullptr);
            if (estimators[e]->needs_known())
                for (size_t p = 0; p < pixels; ++p)
                    integrand_.known(n, &u[p * n * dims_], &buffers.shown[p * rays()], &buffers.known[p * n * 3],
                                     &buffers.integrals[p * 3]);
            estimators[e]->estimate({u.data(), f.data(), buffers.surface.data(), b.width, b.height, n,
                                     buffers.known.data(), buffers.integrals.data()},
                                    means.data());
            stop = Clock::now();
            times.estimating[e] += seconds(start, stop);
            for (uint32_t y = 0; y < b.height; ++y)
                std::copy_n(&means[size_t{y} * b.width * 3], size_t{b.width} * 3,
                            &images_[e].rgb[3 * (size_t{b.y + y} * options_.width + b.x)]);
        }
    }

    const Integrand &integrand_;
    const Sampler &sampler_;
    const uint32_t dims_; // of the sample vector
    uint32_t side_ = 1;   // of a bucket, in pixels
    bool needs_known_ = false;
    std::atomic<uint64_t> next_{0}; // bucket
};

} // namespace demo
