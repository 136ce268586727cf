// The program around the renderer. Other scenes, or another intersector, need only another `main`; see pathtracer.cpp.
#pragma once

#include "accumulate.hpp"
#include "mis_integrand.hpp"
#include "render.hpp"
#include "scene_integrand.hpp"
#include "statistics.hpp"

namespace demo {

// As a string of JSON, with its quotes.
inline std::string json(const std::string &text)
{
    const char *const digits = "0123456789abcdef";
    std::string quoted = "\"";
    for (char c : text) {
        if (c >= 0 && c < 0x20) {
            quoted += {'\\', 'u', '0', '0', digits[c / 16], digits[c % 16]};
            continue;
        }
        if (c == '"' || c == '\\')
            quoted += '\\';
        quoted += c;
    }
    return quoted + '"';
}

// One line of JSON for each estimator.
inline void print(const Options &options, const Integrand &integrand, uint32_t samples_per_vector,
                  const Rendering &renderer, const std::vector<std::string> &names, uint64_t seed)
{
    const Times &times = renderer.times();
    const uint32_t spp = options.spp * samples_per_vector;
    double samples = static_cast<double>(options.width) * options.height * spp;
    double sampling = times.drawing + times.tracing;
    auto each = [&](double seconds) { return seconds / samples * 1e9; };
    for (size_t e = 0; e < names.size(); ++e)
        std::printf(
            "{\"scene\":%s,\"sampler\":\"%s\",\"estimator\":\"%s\",\"spp\":%u,\"dims\":%u,\"order\":%u,"
            "\"threads\":%u,\"width\":%u,\"height\":%u,\"seed\":%llu,\"frame\":%u,\"camera_rays_per\":\"%s\","
            "\"total_seconds\":%.6f,\"drawing_ns_per_sample\":%.2f,"
            "\"tracing_ns_per_sample\":%.2f,\"sampling_ns_per_sample\":%.2f,\"estimating_ns_per_sample\":%.2f}\n",
            json(options.scene).c_str(), options.reference ? "lattice" : options.sampler.c_str(), names[e].c_str(), spp,
            dims(integrand.domains()), options.order, options.threads, options.width, options.height,
            static_cast<unsigned long long>(seed), options.frame,
            integrand.camera_ray_per_sample() ? "sample" : "pixel", sampling + times.estimating[e], each(times.drawing),
            each(times.tracing), each(sampling), each(times.estimating[e]));
    std::fflush(stdout);
}

// Renders any integrand with every seed: what is left of a program with an integrand of its own. `options.scene` only
// names it.
inline void render(const Options &options, const Integrand &integrand, uint32_t samples_per_vector = 1)
{
    if (nf_abi_version() != NF_ABI_VERSION)
        throw std::runtime_error("noisefloor.h and the linked library are of different versions");
    const std::vector<std::string> names =
        options.reference ? std::vector<std::string>{"reference"} : options.estimators;
    std::unique_ptr<Halves> halves;
    if (!options.statistics.empty())
        halves = std::make_unique<Halves>(options.statistics[0], options.statistics[1], options.width, options.height);
    std::vector<Statistics> statistics(halves ? names.size() : 0, Statistics(options.width, options.height));
    const auto setup_of = [&](uint64_t seed) {
        return SamplerSetup{integrand.domains(), dims(integrand.domains()), options.spp, options.frame, seed,
                            options.scramble};
    };
    std::unique_ptr<SamplerFactory> samplers;
    if (!options.reference) {
        samplers = std::make_unique<SamplerFactory>(options.sampler, options.tile, options.table);
        samplers->make(setup_of(options.seed + options.seeds - 1)); // Fails before any work if it has not so many.
    }
    Outputs outputs;
    for (uint32_t i = 0; i < options.seeds; ++i) {
        const uint64_t seed = options.seed + i;
        std::unique_ptr<Sampler> sampler;
        if (samplers)
            sampler = samplers->make(setup_of(seed));
        else
            sampler = std::make_unique<LatticeSampler>(setup_of(seed));
        std::unique_ptr<Rendering> renderer;
        if (options.accumulate)
            renderer = std::make_unique<AccumulatingRenderer>(integrand, *sampler, options);
        else
            renderer = std::make_unique<Renderer>(integrand, *sampler, options);
        renderer->run(double(i) / options.seeds, double(i + 1) / options.seeds);
        for (size_t e = 0; e < names.size(); ++e) {
            const std::string number = options.seeds > 1 ? "." + std::to_string(seed) : "";
            if (halves)
                statistics[e].add(renderer->images()[e], *halves);
            else
                outputs.add(options.output + "." + names[e] + number + ".pfm", renderer->images()[e]);
        }
        print(options, integrand, samples_per_vector, *renderer, names, seed);
    }
    for (size_t e = 0; e < statistics.size(); ++e) {
        outputs.add(options.output + "." + names[e] + ".mean.pfm", statistics[e].mean());
        outputs.add(options.output + "." + names[e] + ".mse.pfm", statistics[e].squared_error());
    }
    outputs.commit();
}

inline void render(const Options &options, const Program &program)
{
    auto entry = std::find_if(program.scenes.begin(), program.scenes.end(),
                              [&](const SceneEntry &e) { return e.name == options.scene; });
    if (entry == program.scenes.end())
        throw std::runtime_error("there is no scene `" + options.scene + "`; --help lists them");
    Scene scene;
    entry->build(options.frame, static_cast<float>(options.width) / static_cast<float>(options.height), scene);
    if (options.bounces > 0)
        scene.layout.bounces = options.bounces;
    std::unique_ptr<Intersector> intersector = program.make_intersector(scene.geometry);
    if (options.mis) {
        // A sample vector is two samples.
        Options pairs = options;
        pairs.spp /= 2;
        render(pairs, MisIntegrand(scene, *intersector, options.width, options.height, options.filter), 2);
        return;
    }
    render(options, SceneIntegrand(scene, *intersector, options.width, options.height, options.filter));
}

// Throws unless all that was printed has arrived: what is still in a buffer may find no room.
inline void finish_output()
{
    if (std::fflush(stdout) != 0 || std::ferror(stdout))
        throw std::runtime_error("standard output cannot be written");
}

inline int run(int argc, char **argv, const Program &program)
{
    try {
        Options options;
        if (parse(argc, argv, program, options))
            render(options, program);
        else
            print_usage(stdout, program);
        finish_output();
        return 0;
    } catch (const std::exception &error) {
        std::fprintf(stderr, "%s: %s\n", program.name.c_str(), error.what());
        return 1;
    }
}

} // namespace demo
