// noisefloor in a renderer like Mitsuba 3: its sampler, and an accumulator for each pixel. docs/renderer.md.
#include "mitsuba_noisefloor_sampler.hpp"
#include <cstdio>
#include <exception>

namespace {

using namespace mitsuba;

// At which count of dimensions the emitter's two numbers come: behind the film's, 0 and 1.
constexpr uint32_t emitter_dimension = 2;
constexpr Point2u film_size{64, 64};
constexpr uint32_t pixels = film_size.x * film_size.y;

std::vector<Float> plain_means(Sampler &sampler)
{
    std::vector<Float> image(pixels);
    render(sampler, film_size, 0, [&](uint32_t pixel, uint32_t, Float value) {
        image[pixel] += value / static_cast<Float>(sampler.sample_count());
    });
    return image;
}

// An accumulator for each pixel, filled in passes: after each of them there is a picture.
class Accumulators {
public:
    Accumulators()
    {
        config_.dims = 3;
        config_.order = 2;
        config_.channels = 1;
        config_.slices = room::lamps;
        stride_ = nf_cv_accumulator_size(&config_, &workspace_) / 8 + 1;
        memory_.resize(pixels * stride_);
        accumulators_.resize(pixels);
        for (uint32_t pixel = 0; pixel < pixels; ++pixel)
            room::check(nf_cv_accumulator_init(&memory_[pixel * stride_], 8 * stride_, &config_, &accumulators_[pixel]),
                        "nf_cv_accumulator_init");
    }

    // Which numbers to keep: the place on the emitter, and last the number that chose it. Mitsuba makes both of one.
    void add(uint32_t pixel, RecordingSampler &sampler, Float value)
    {
        const Float x = sampler.number(emitter_dimension), scaled = x * static_cast<Float>(room::lamps);
        const Float u[] = {scaled - static_cast<Float>(static_cast<int>(scaled)), sampler.number(emitter_dimension + 1),
                           x};
        nf_cv_samples sample = {};
        sample.u = u, sample.f = &value, sample.n = 1;
        room::check(nf_cv_accumulator_add(accumulators_[pixel], &sample), "nf_cv_accumulator_add");
    }

    std::vector<Float> picture() const
    {
        std::vector<uint64_t> workspace(workspace_ / 8 + 1);
        std::vector<Float> image;
        for (const nf_cv_accumulator *accumulator : accumulators_) {
            nf_estimate estimate;
            room::check(nf_cv_accumulator_estimate(accumulator, workspace.data(), 8 * workspace.size(), &estimate),
                        "nf_cv_accumulator_estimate");
            image.push_back(estimate.mean[0]);
        }
        return image;
    }

private:
    nf_cv_config config_{};
    size_t stride_ = 0, workspace_ = 0;
    std::vector<uint64_t> memory_;
    std::vector<nf_cv_accumulator *> accumulators_;
};

// What estimators are told after rendering must be what was drawn.
void check_numbers(NoisefloorSampler &sampler)
{
    const std::vector<Float> all = sampler.numbers(0, emitter_dimension, 2, sampler.sample_count());
    for (uint32_t pixel = 0; pixel < pixels; ++pixel) {
        sampler.seed(pixel, 1);
        for (uint32_t j = 0; j < sampler.sample_count(); ++j, sampler.advance()) {
            sampler.next_2d(true);
            const Point2f u = sampler.next_2d(true);
            const size_t at = 2 * (size_t{pixel} * sampler.sample_count() + j);
            if (u.x != all[at] || u.y != all[at + 1])
                throw std::runtime_error("all numbers together differ from single draws");
        }
    }
}

void run()
{
    const uint32_t spp = 16, passes = 4;
    NoisefloorSampler many(256, film_size);
    const std::vector<Float> reference = plain_means(many);
    const auto report = [&](const char *name, const std::vector<Float> &image) {
        std::printf("%-16s %.5f\n", name, room::root_mean_squared_error(image, reference));
    };

    std::printf("root mean squared errors\n%u samples per pixel\n", spp);
    IndependentSampler independent(spp);
    report("independent", plain_means(independent));
    NoisefloorSampler sampler(spp, film_size);
    check_numbers(sampler);
    report("sampler", plain_means(sampler));

    std::printf("%u samples per pixel, in %u passes\n", spp * passes, passes);
    RecordingSampler recorder(independent.fork());
    Accumulators accumulators;
    std::vector<Float> mean(pixels);
    for (uint32_t pass = 0; pass < passes; ++pass)
        render(recorder, film_size, pass, [&](uint32_t pixel, uint32_t, Float value) {
            mean[pixel] += value / static_cast<Float>(spp * passes);
            accumulators.add(pixel, recorder, value);
        });
    report("mean", mean);
    report("noisefloor", accumulators.picture());
}

} // namespace

int main()
{
    try {
        run();
    } catch (const std::exception &error) {
        std::fprintf(stderr, "mitsuba_sampler: %s\n", error.what());
        return 1;
    }
}
