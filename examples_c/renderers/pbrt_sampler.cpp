// noisefloor in a renderer like pbrt-v4: its sampler, and fits shared by pixels after rendering.
// docs/renderer.md.
#include "pbrt_noisefloor_sampler.hpp"
#include <cstdio>
#include <exception>

namespace {

using namespace pbrt;

// At which count of dimensions Li asks for the light and for the point on it: behind wavelengths 0, time 1, lens 2
// and 3.
constexpr uint32_t choice_dimension = 4, light_dimension = 5;

// The estimates of all pixels. The integrator did not keep its numbers: the sampler gives them again.
std::vector<Float> shared_fits(const Film &film, const NoisefloorSampler &sampler)
{
    const auto width = static_cast<uint32_t>(film.FullResolution().x),
               height = static_cast<uint32_t>(film.FullResolution().y);
    const auto n = static_cast<uint32_t>(sampler.SamplesPerPixel());

    // For each sample the point on the light, then the choice: a number that picks one of several is the last.
    const Point2i first{0, 0}; // In pbrt film.PixelBounds().pMin, which a crop window moves.
    const nf_sampler domains[] = {sampler.Request(first, light_dimension), sampler.Request(first, choice_dimension)};
    const uint32_t dims[] = {2, 1};
    std::vector<Float> u(std::size_t{3} * width * height * n);
    room::check(nf_sampler_fill(domains, dims, 2, width, height, n, u.data(), u.size()), "nf_sampler_fill");

    nf_cv_config config = {};
    config.dims = 3;
    config.order = 2;
    config.channels = 1;
    config.slices = room::lamps;
    config.stratified = 1;

    const std::vector<uint32_t> surfaces = room::surfaces(film.FullResolution().x, film.FullResolution().y);
    nf_cv_image image{};
    image.width = width;
    image.height = height;
    image.surfaces = surfaces.data();

    nf_cv_samples samples = {};
    samples.u = u.data(), samples.f = film.Values().data(), samples.n = n;
    std::vector<uint64_t> workspace(nf_cv_image_workspace_size(&config, &image, &samples) / 8 + 1);
    std::vector<nf_estimate> estimates(surfaces.size());
    room::check(nf_cv_image_estimate(&config, &image, &samples, workspace.data(), 8 * workspace.size(),
                                     estimates.data()),
                "nf_cv_image_estimate");
    std::vector<Float> pixels;
    for (const nf_estimate &estimate : estimates)
        pixels.push_back(estimate.mean[0]);
    return pixels;
}

void run()
{
    const Point2i resolution{64, 64};
    const int spp = 4;

    // Of another frame: samples of the pictures that it judges are none of its own.
    const std::vector<Float> reference = room::means(Render(resolution, NoisefloorSampler(256, 1)).Values(), 256);
    const auto report = [&](const char *name, const std::vector<Float> &image) {
        std::printf("%-12s %.5f\n", name, room::root_mean_squared_error(image, reference));
    };
    std::printf("root mean squared errors, %d samples per pixel\n", spp);
    report("independent", room::means(Render(resolution, IndependentSampler(spp)).Values(), spp));

    const NoisefloorSampler sampler(spp);
    const Film film = Render(resolution, sampler.Clone(1).front());
    report("sampler", room::means(film.Values(), spp));
    report("noisefloor", shared_fits(film, sampler));
}

} // namespace

int main()
{
    try {
        run();
        if (std::fflush(stdout) != 0 || std::ferror(stdout))
            throw std::runtime_error("standard output cannot be written");
    } catch (const std::exception &error) {
        std::fprintf(stderr, "pbrt_sampler: %s\n", error.what());
        return 1;
    }
}
