// The path tracer's samplers and estimators on integrands that POV-Ray computed.
//
//   cargo xtask test povray
//   c++ -O2 -std=c++17 -Iinclude tests/povray/oracle.cpp target/noisefloor/libnoisefloor.a -pthread -o oracle
//   ./oracle --scene target/povray/area-32-....stack --width 32 --height 32 --spp 16 --estimators mc,robust
//
// The path tracer's command line, where the scene is the file of a stack, and two options more:
//
//   --model cells|linear  what lies between the centres of the stack's cells: stack_integrand.hpp
//   --seeds N             N renderings in one process, from --seed on; each has its seed's number as its frame too, because tiles know
//                         frames, not seeds. Files are then PREFIX.ESTIMATOR.SEED.pfm
//
// --reference writes the exact mean.
#include "stack_integrand.hpp"
#include "../../examples_c/pathtracer/app.hpp"

namespace povray {

struct Extra {
    Model model = Model::cells;
    uint32_t seeds = 1;
};

// Takes the two further options out of the command line.
inline std::vector<char *> take(int argc, char **argv, Extra &extra)
{
    std::vector<char *> rest;
    for (int i = 0; i < argc; ++i) {
        const std::string name = argv[i];
        if (name != "--model" && name != "--seeds") {
            rest.push_back(argv[i]);
            continue;
        }
        if (++i == argc)
            throw std::runtime_error("`" + name + "` lacks its value");
        const std::string value = argv[i];
        if (name == "--seeds")
            extra.seeds = static_cast<uint32_t>(demo::parse_number(name, value, 1, 1 << 20));
        else if (value == "cells" || value == "linear")
            extra.model = value == "cells" ? Model::cells : Model::linear;
        else
            throw std::runtime_error("--model takes `cells` or `linear`, not `" + value + "`");
    }
    return rest;
}

inline void save(const std::string &path, const demo::Image &image)
{
    demo::Outputs outputs;
    outputs.add(path, image);
    outputs.commit();
}

inline void render_seed(demo::Options options, const demo::Integrand &integrand, bool many)
{
    options.frame = static_cast<uint32_t>(options.seed);
    demo::SamplerSetup setup{integrand.domains(), dims(integrand.domains()), options.spp, options.frame, options.seed};
    auto sampler = demo::make_sampler(options.sampler, options.tile, setup);
    demo::Renderer renderer(integrand, *sampler, options);
    renderer.run();
    const double samples = static_cast<double>(options.width) * options.height * options.spp;
    const demo::Times &times = renderer.times();
    for (size_t e = 0; e < renderer.names().size(); ++e) {
        const std::string &name = renderer.names()[e];
        save(options.output + "." + name + (many ? "." + std::to_string(options.seed) : "") + ".pfm", renderer.images()[e]);
        std::printf("{\"scene\":\"%s\",\"sampler\":\"%s\",\"estimator\":\"%s\",\"spp\":%u,\"dims\":%u,\"order\":%u,\"seed\":%llu,"
                    "\"total_seconds\":%.6f,\"drawing_ns_per_sample\":%.2f,\"sampling_ns_per_sample\":%.2f,\"estimating_ns_per_sample\":%.2f}\n",
                    options.scene.c_str(), options.sampler.c_str(), name.c_str(), options.spp, setup.dims, options.order,
                    static_cast<unsigned long long>(options.seed), times.drawing + times.tracing + times.estimating[e],
                    1e9 * times.drawing / samples, 1e9 * (times.drawing + times.tracing) / samples, 1e9 * times.estimating[e] / samples);
    }
}

inline void run(int argc, char **argv)
{
    Extra extra;
    std::vector<char *> rest = take(argc, argv, extra);
    demo::Options options;
    const demo::Program program{"oracle", {}, nullptr};
    if (!demo::parse(static_cast<int>(rest.size()), rest.data(), program, options)) {
        demo::print_usage(stdout, program);
        std::puts("here, --scene FILE.stack; further: [--model cells|linear] [--seeds N], see tests/povray/oracle.cpp");
        return;
    }
    if (nf_abi_version() != NF_ABI_VERSION)
        throw std::runtime_error("noisefloor.h and the linked library are of different versions");
    if (options.scene.empty())
        throw std::runtime_error("--scene FILE.stack says what is rendered; `cargo xtask test povray` makes stacks in target/povray");
    if (options.filter != demo::Filter::center)
        throw std::runtime_error("a stack's pixels are single points: --filter takes `center` only");
    const Stack stack(options.scene);
    if (options.width != stack.width() || options.height != stack.height())
        throw std::runtime_error("the stack " + options.scene + " has other pixels: say --width " + std::to_string(stack.width()) +
                                 " --height " + std::to_string(stack.height()));
    const StackIntegrand integrand(stack, extra.model);
    if (options.reference) {
        save(options.output + ".reference.pfm", integrand.reference());
        return;
    }
    // Frames are numbered by seeds.
    if (options.seed + extra.seeds > 1 << 20)
        throw std::runtime_error("seeds must stay below " + std::to_string(1 << 20));
    for (const uint64_t end = options.seed + extra.seeds; options.seed < end; ++options.seed)
        render_seed(options, integrand, extra.seeds > 1);
}

} // namespace povray

int main(int argc, char **argv)
{
    try {
        povray::run(argc, argv);
        return 0;
    } catch (const std::exception &error) {
        std::fprintf(stderr, "oracle: %s\n", error.what());
        return 1;
    }
}
