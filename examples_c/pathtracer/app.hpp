// The program around the renderer. Other scenes, or another intersector, need only another `main`; see pathtracer.cpp.
#pragma once

#include "program.hpp"
#include "render.hpp"
#include "scene_integrand.hpp"

namespace demo {

// Renders any integrand: the command line with its own `main`. `options.scene` only names it.
inline void render(const Options &options, const Integrand &integrand)
{
    if (nf_abi_version() != NF_ABI_VERSION)
        throw std::runtime_error("noisefloor.h and the linked library are of different versions");
    const uint32_t dimensions = dims(integrand.domains());
    SamplerSetup setup{integrand.domains(), dimensions, options.spp, options.frame, options.seed};
    std::unique_ptr<Sampler> sampler;
    if (options.reference)
        sampler = std::make_unique<LatticeSampler>(setup);
    else
        sampler = make_sampler(options.sampler, options.tile, setup);
    Renderer renderer(integrand, *sampler, options);
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
                    "\"threads\":%u,\"width\":%u,\"height\":%u,\"seed\":%llu,\"frame\":%u,\"camera_rays\":\"%s\",\"total_seconds\":%.6f,\"drawing_ns_per_sample\":%.2f,"
                    "\"tracing_ns_per_sample\":%.2f,\"sampling_ns_per_sample\":%.2f,\"estimating_ns_per_sample\":%.2f}\n",
                    options.scene.c_str(), options.reference ? "lattice" : options.sampler.c_str(),
                    options.reference ? "reference" : renderer.names()[e].c_str(), options.spp, dimensions, options.order,
                    options.threads, options.width, options.height, static_cast<unsigned long long>(options.seed), options.frame,
                    integrand.camera_ray_per_sample() ? "sample" : "pixel", sampling + times.estimating[e], each(times.drawing),
                    each(times.tracing), each(sampling), each(times.estimating[e]));
}

inline void render(const Options &options, const Program &program)
{
    auto entry = std::find_if(program.scenes.begin(), program.scenes.end(), [&](const SceneEntry &e) { return e.name == options.scene; });
    if (entry == program.scenes.end())
        throw std::runtime_error("there is no scene `" + options.scene + "`; --help lists them");
    Scene scene;
    entry->build(options.frame, static_cast<float>(options.width) / static_cast<float>(options.height), scene);
    std::unique_ptr<Intersector> intersector = program.make_intersector(scene.geometry);
    SceneIntegrand integrand(scene, *intersector, options.width, options.height, options.filter);
    render(options, integrand);
}

inline int run(int argc, char **argv, const Program &program)
{
    try {
        Options options;
        if (!parse(argc, argv, program, options)) {
            print_usage(stdout, program);
            return 0;
        }
        render(options, program);
        return 0;
    } catch (const std::exception &error) {
        std::fprintf(stderr, "%s: %s\n", program.name.c_str(), error.what());
        return 1;
    }
}

} // namespace demo
