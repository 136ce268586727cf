// An image by threads, each a strip of it: the same bits as from one call. It prints the errors of the mean and of
// noisefloor, and how many pixels differ.
#include "noisefloor.hpp"
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <future>
#include <stdexcept>
#include <vector>

namespace nf = noisefloor;

const uint32_t width = 128, height = 128, strip = 16;

// A light of size 1 over a floor, an edge between them: what reaches a pixel from point u of the light.
static float radiance(uint32_t x, uint32_t y, const float *u)
{
    const float edge = 2.0f * static_cast<float>(x) / width - 0.5f, near = 0.5f + static_cast<float>(y) / height;
    return u[0] + 0.3f * u[1] < edge ? near * (1.0f + 0.5f * u[1]) : 0.0f;
}

static double exact(uint32_t x, uint32_t y)
{
    const uint32_t n = 64;
    double sum = 0;
    for (uint32_t i = 0; i < n * n; ++i) {
        const float u[2] = {(static_cast<float>(i % n) + 0.5f) / n, (static_cast<float>(i / n) + 0.5f) / n};
        sum += radiance(x, y, u);
    }
    return sum / (n * n);
}

// Throws if noisefloor refuses something. Returns whether the strips are the image, and better than the mean.
static bool run()
{
    std::vector<float> u(2 * width * height), f(width * height);
    const nf_sampler first[] = {nf_sampler_pixel(0, 0, 0, 0)};
    const uint32_t dims[] = {2};
    nf::fill(first, dims, width, height, 1, u);

    const nf::config config = nf::config(2, 3).with_stratified_samples();
    const nf::image image(width, height);
    std::vector<nf_estimate> out(width * height), whole(width * height);

    // Samples of a strip, and its pixels once those of all windows on it are there: a renderer waits for the strips
    // beside, here for all.
    const auto render = [&](uint32_t y) {
        for (uint32_t i = y * width; i < (y + strip) * width; ++i)
            f[i] = radiance(i % width, i / width, &u[2 * i]);
    };
    const auto estimate = [&](uint32_t y) {
        const nf_cv_rectangle wanted = {0, y, width, strip}, given = image.with_parts(wanted, {}).needed();
        const nf::image part = image.with_parts(wanted, given);
        const size_t start = given.y * width, pixels = given.height * width; // given: whole rows, as wanted
        std::vector<uint64_t> memory(config.image_workspace_size(part, 1) / 8 + 1);
        nf::estimate_image(config, part, {{&u[2 * start], 2 * pixels}, {&f[start], pixels}}, memory,
                           {&out[y * width], width * strip});
    };
    for (int step = 0; step < 2; ++step) {
        // An exception that leaves a std::thread ends the program without a word; get() throws it here.
        std::vector<std::future<void>> threads;
        for (uint32_t y = 0; y < height; y += strip)
            threads.push_back(std::async(std::launch::async, [&, y] { step == 0 ? render(y) : estimate(y); }));
        for (std::future<void> &thread : threads)
            thread.get();
    }

    std::vector<uint64_t> memory(config.image_workspace_size(image, 1) / 8 + 1);
    nf::estimate_image(config, image, {u, f}, memory, whole);
    double mean = 0, ours = 0;
    uint32_t different = 0;
    for (uint32_t i = 0; i < width * height; ++i) {
        const double truth = exact(i % width, i / width);
        mean += std::pow(f[i] - truth, 2);
        ours += std::pow(out[i].mean[0] - truth, 2);
        different += std::memcmp(&out[i], &whole[i], sizeof out[i]) != 0;
    }
    std::printf("mean       %.5f\n", std::sqrt(mean / (width * height)));
    std::printf("noisefloor %.5f\n", std::sqrt(ours / (width * height)));
    std::printf("%u pixels differ from those of one call\n", different);
    return different == 0 && ours < mean;
}

int main()
{
    try {
        const bool good = run();
        if (std::fflush(stdout) != 0 || std::ferror(stdout))
            throw std::runtime_error("standard output cannot be written");
        return good ? 0 : 1;
    } catch (const std::exception &error) {
        std::fprintf(stderr, "strips: %s\n", error.what());
        return 1;
    }
}
