// bridge.h over the library: one block and one stack of gathers for each thread.
#include "bridge.h"
#include "gather.hpp"
#include <cstdio>

using namespace noisefloor_povray;

namespace {

// POV-Ray would take an exception for one of its own and go on to write a picture.
template <class Action> auto or_exit(Action action) -> decltype(action())
{
    try {
        return action();
    } catch (const std::exception &error) {
        std::fprintf(stderr, "noisefloor: %s\n", error.what());
        std::_Exit(2);
    }
}

// Before main(), so that a mistake is seen before anything is parsed.
const Settings settings = or_exit([] {
    Settings read = Settings::read();
    if (read.mode != Settings::Mode::off) { // are there such a sampler and such an estimator?
        make_sampler(read, read.samples, 0, 1);
        make_estimator(read, 2, 8, read.samples);
        if (nf_abi_version() != NF_ABI_VERSION)
            throw std::runtime_error("the library is of another version than its header: build both anew");
    }
    return read;
});

struct Thread {
    Block block{settings};
    bool in_pixel = false, in_sample = false;
    std::vector<std::unique_ptr<Gather>> gathers; // by depth; a few bounces
    size_t depth = 0;

    Context *context()
    {
        if (depth > 0)
            return &gathers[depth - 1]->context();
        return in_sample ? &block.context() : nullptr;
    }
};

Thread &thread()
{
    thread_local Thread state;
    return state;
}

} // namespace

int nfp_enabled(void) { return settings.mode != Settings::Mode::off; }

unsigned nfp_samples(void) { return settings.samples; }

int nfp_in_sample(void) { return nfp_enabled() && thread().in_sample; }

int nfp_moves_lights(void) { return nfp_enabled() && settings.moves_lights && thread().context(); }

void nfp_block_begin(int left, int top, unsigned width, unsigned height, int lens, const void *const *lights,
                     size_t count)
{
    Layout layout;
    layout.box = settings.box;
    layout.lens = lens != 0;
    if (count > 0)
        layout.lights.assign(lights, lights + count);
    or_exit([&] { thread().block.begin(left, top, width, height, layout); });
}

void nfp_block_end(float *means)
{
    or_exit([&] { thread().block.end(means); });
}

void nfp_pixel_begin(size_t pixel)
{
    or_exit([&] { thread().block.pixel(pixel); });
    thread().in_pixel = true;
}

int nfp_wants_surfaces(void) { return thread().block.wants_surfaces(); }

void nfp_pixel_surface(const void *object) { thread().block.surface(object); }

void nfp_pixel_end(void) { thread().in_pixel = false; }

void nfp_sample_begin(unsigned index, double *dx, double *dy)
{
    double offset[2];
    thread().block.sample(index, offset);
    *dx = offset[0];
    *dy = offset[1];
    thread().in_sample = true;
}

void nfp_sample_end(const float rgb[3])
{
    thread().block.value(rgb);
    thread().in_sample = false;
}

int nfp_lens_position(double *x, double *y)
{
    if (!nfp_enabled() || !thread().in_pixel)
        return 0;
    double disc[2] = {0, 0};
    if (thread().in_sample && thread().block.lens())
        concentric_disc(thread().block.lens(), disc);
    *x = disc[0];
    *y = disc[1];
    return 1;
}

int nfp_light_position(const void *light, const double point[3], double *u, double *v)
{
    Context *context = nfp_enabled() ? thread().context() : nullptr;
    if (!context)
        return 0;
    double position[2];
    or_exit([&] { context->light(light, point, position); });
    *u = position[0];
    *v = position[1];
    return 1;
}

void nfp_gather_begin(const double point[3], unsigned count)
{
    if (!nfp_enabled())
        return;
    Thread &t = thread();
    or_exit([&] {
        if (t.gathers.size() == t.depth)
            t.gathers.emplace_back();
        std::unique_ptr<Gather> &gather = t.gathers[t.depth];
        if (!gather || gather->count() != count)
            gather = std::make_unique<Gather>(settings, count);
        gather->begin(point);
    });
    ++t.depth;
}

int nfp_gather_direction(double disc[2])
{
    if (!nfp_enabled())
        return 0;
    or_exit([&] { thread().gathers[thread().depth - 1]->direction(disc); });
    return 1;
}

void nfp_gather_value(const float rgb[3])
{
    if (nfp_enabled())
        or_exit([&] { thread().gathers[thread().depth - 1]->value(rgb); });
}

int nfp_gather_end(float rgb[3])
{
    if (!nfp_enabled())
        return 0;
    Thread &t = thread();
    return or_exit([&] { return t.gathers[--t.depth]->estimate(rgb); });
}
