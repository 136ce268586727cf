// The program around the renderer. Another intersector needs only another `main`; see pathtracer.cpp.
#pragma once

#include "render.hpp"
#include <functional>

namespace demo {

using MakeIntersector = std::function<std::unique_ptr<Intersector>(const Geometry &)>;

inline void render(const Options &options, const MakeIntersector &make_intersector)
{
    if (nf_abi_version() != NF_ABI_VERSION)
        throw std::runtime_error("noisefloor.h and the linked library are of different versions");
    Scene scene;
    if (!make_scene(options.scene, static_cast<float>(options.width) / static_cast<float>(options.height), scene))
        throw std::runtime_error("there is no scene `" + options.scene + "`; --help lists them");
    std::unique_ptr<Intersector> intersector = make_intersector(scene.geometry);
    SamplerSetup setup{scene.domains(), scene.dims(), options.spp, options.frame, options.seed};
    std::unique_ptr<Sampler> sampler;
    if (options.reference)
        sampler = std::make_unique<LatticeSampler>(setup);
    else
        sampler = make_sampler(options.sampler, options.tile, setup);
    Renderer renderer(scene, *intersector, *sampler, options);
    renderer.run();

    Outputs outputs;
    for (size_t e = 0; e < renderer.names().size(); ++e)
        outputs.add(options.output + "." + (options.reference ? "reference" : renderer.names()[e]) + ".pfm", renderer.images()[e]);
    outputs.commit();

    const Times &times = renderer.times();
    double samples = static_cast<double>(options.width) * options.height * options.spp;
    double sampling = times.drawing + times.tracing;
    auto each = [&](double seconds) { return seconds / samples * 1e9; };
    for (size_t e = 0; e < renderer.names().size(); ++e)
        std::printf("{\"scene\":\"%s\",\"sampler\":\"%s\",\"estimator\":\"%s\",\"spp\":%u,\"dims\":%u,\"order\":%u,"
                    "\"threads\":%u,\"width\":%u,\"height\":%u,\"total_seconds\":%.6f,\"drawing_ns_per_sample\":%.2f,"
                    "\"tracing_ns_per_sample\":%.2f,\"sampling_ns_per_sample\":%.2f,\"estimating_ns_per_sample\":%.2f}\n",
                    options.scene.c_str(), options.reference ? "lattice" : options.sampler.c_str(),
                    options.reference ? "reference" : renderer.names()[e].c_str(), options.spp, scene.dims(), options.order,
                    options.threads, options.width, options.height, sampling + times.estimating[e], each(times.drawing),
                    each(times.tracing), each(sampling), each(times.estimating[e]));
}

inline int run(int argc, char **argv, const MakeIntersector &make_intersector)
{
    try {
        Options options;
        if (!parse(argc, argv, options)) {
            print_usage(stdout);
            return 0;
        }
        render(options, make_intersector);
        return 0;
    } catch (const std::exception &error) {
        std::fprintf(stderr, "pathtracer: %s\n", error.what());
        return 1;
    }
}

} // namespace demo
