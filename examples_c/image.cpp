// An image of soft direct light, one sample in each pixel: by that sample alone, and by fits that pixels
// share. It prints the error of both. "Tracing" is a formula: a square light above a plane, a wall beside it.
#include "noisefloor.h"
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

const uint32_t width = 128, height = 128, samples = 1;

static void check(nf_status status)
{
    if (status != NF_OK) {
        std::fprintf(stderr, "noisefloor: %s\n", nf_status_message(status));
        std::exit(1);
    }
}

// What a pixel shows: the floor (0), or the wall (1) in the picture's upper half.
static uint32_t surface_at(uint32_t pixel)
{
    return pixel / width < height / 2 ? 1 : 0;
}

// The light that reaches the pixel's point from point (u[0], u[1]) of the light, divided by its density: unshadowed.
static float radiance(uint32_t pixel, const float *u)
{
    float x = (static_cast<float>(pixel % width) + 0.5f) / width * 4.0f - 2.0f;
    float y = (static_cast<float>(pixel / width) + 0.5f) / height * 4.0f - 2.0f;
    bool wall = surface_at(pixel) == 1;
    float point[3] = {x, wall ? 2.0f : -y, wall ? -y : 0.0f}; // on the wall y = 2, or on the floor z = 0
    float light[3] = {u[0] * 2.0f - 1.0f, u[1] * 2.0f - 1.0f, 2.5f};
    float d[3] = {light[0] - point[0], light[1] - point[1], light[2] - point[2]};
    float square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    float cosines = (wall ? -d[1] : d[2]) * d[2]; // at the surface and at the light, times the distance each
    return 4.0f * std::max(cosines, 0.0f) / (square * square);
}

// The pixel's true value, by a fine midpoint rule.
static float reference(uint32_t pixel)
{
    const int n = 32;
    double sum = 0.0;
    for (int i = 0; i < n * n; ++i) {
        float u[2] = {(static_cast<float>(i % n) + 0.5f) / n, (static_cast<float>(i / n) + 0.5f) / n};
        sum += radiance(pixel, u);
    }
    return static_cast<float>(sum / (n * n));
}

static std::vector<nf_estimate> estimate(std::vector<float> &f)
{
    const uint32_t pixels = width * height, dims = 2;
    std::vector<uint32_t> surfaces(pixels);
    std::vector<nf_estimate> out(pixels);
    // README begin
    std::vector<float> u(pixels * dims);                // u[pixel][dim]: samples is 1
    nf_sampler first = nf_sampler_pixel(0, 0, 0, 0);    // column, row, frame, sample
    check(nf_sampler_fill(&first, &dims, 1, width, height, samples, u.data(), u.size()));
    for (uint32_t i = 0; i < pixels; ++i) {
        f[i] = radiance(i, &u[dims * i]);               // yours: the sample's value / pdf
        surfaces[i] = surface_at(i);                    // yours: pixels with the same number share fits
    }
    nf_cv_config config = {};
    config.dims = dims, config.order = 3, config.channels = 1;
    config.stratified = 1;                              // nf_sampler spreads samples evenly
    nf_cv_samples traced = {};
    traced.u = u.data(), traced.f = f.data(), traced.n = samples;
    nf_cv_image image = {};
    image.width = width, image.height = height, image.surfaces = surfaces.data();
    std::vector<uint64_t> memory(nf_cv_image_workspace_size(&config, &image, &traced) / 8 + 1);
    check(nf_cv_image_estimate(&config, &image, &traced, memory.data(), 8 * memory.size(),
                               out.data()));            // out[pixel].mean[0] is the picture
    // README end
    return out;
}

int main()
{
    std::vector<float> f(width * height * samples); // one value for each pixel
    std::vector<nf_estimate> out = estimate(f);
    double mean = 0.0, shared = 0.0;
    for (uint32_t i = 0; i < width * height; ++i) {
        double exact = reference(i);
        mean += std::pow(f[i] - exact, 2.0);
        shared += std::pow(out[i].mean[0] - exact, 2.0);
    }
    std::printf("root mean squared errors of one sample in each pixel\n");
    std::printf("mean       %.5f\n", std::sqrt(mean / (width * height)));
    std::printf("noisefloor %.5f\n", std::sqrt(shared / (width * height)));
    if (std::fflush(stdout) != 0 || std::ferror(stdout)) {
        std::fprintf(stderr, "image: standard output cannot be written\n");
        return 1;
    }
    return shared < mean ? 0 : 1;
}
