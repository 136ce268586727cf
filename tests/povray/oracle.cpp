// The path tracer's samplers and estimators on integrands that POV-Ray computed.
//
//   cargo xtask test povray
//   c++ -O2 -std=c++17 -Iinclude tests/povray/oracle.cpp target/noisefloor/libnoisefloor.a -pthread -o oracle
//   ./oracle --scene target/povray/area-32-....stack --width 32 --height 32 --spp 16 --estimators mc,robust
//
// The path tracer's command line, where the scene is the file of a stack, and one option more:
//
//   --model cells|linear  what lies between the centres of the stack's cells: stack_integrand.hpp
//
// --reference writes the exact mean.
#include "stack_integrand.hpp"
#include "../../examples_c/pathtracer/app.hpp"

namespace povray {

// Takes the further option out of the command line.
inline std::vector<char *> take(int argc, char **argv, Model &model)
{
    std::vector<char *> rest;
    for (int i = 0; i < argc; ++i) {
        if (std::string(argv[i]) != "--model") {
            rest.push_back(argv[i]);
            continue;
        }
        const std::string value = ++i < argc ? argv[i] : "";
        if (value != "cells" && value != "linear")
            throw std::runtime_error("--model takes `cells` or `linear`, not `" + value + "`");
        model = value == "cells" ? Model::cells : Model::linear;
    }
    return rest;
}

inline void run(int argc, char **argv)
{
    Model model = Model::cells;
    std::vector<char *> rest = take(argc, argv, model);
    demo::Options options;
    const demo::Program program{"oracle", {}, nullptr};
    if (!demo::parse(static_cast<int>(rest.size()), rest.data(), program, options)) {
        demo::print_usage(stdout, program);
        std::puts("here, --scene FILE.stack; further: [--model cells|linear], see tests/povray/oracle.cpp");
        return;
    }
    if (options.scene.empty())
        throw std::runtime_error(
            "--scene FILE.stack says what is rendered; `cargo xtask test povray` makes stacks in target/povray");
    if (options.filter != demo::Filter::center || options.mis || options.bounces)
        throw std::runtime_error(
            "a stack's pixels are single points, its lights are sampled one way, and its paths are POV-Ray's: no "
            "--filter, no --mis, no --bounces");
    const Stack stack(options.scene);
    if (options.width != stack.width() || options.height != stack.height())
        throw std::runtime_error("the stack " + options.scene + " has other pixels: say --width " +
                                 std::to_string(stack.width()) + " --height " + std::to_string(stack.height()));
    const StackIntegrand integrand(stack, model);
    if (options.reference) {
        demo::Outputs outputs;
        outputs.add(options.output + ".reference.pfm", integrand.reference());
        outputs.commit();
        return;
    }
    demo::render(options, integrand);
}

} // namespace povray

int main(int argc, char **argv)
{
    try {
        povray::run(argc, argv);
        demo::finish_output();
        return 0;
    } catch (const std::exception &error) {
        std::fprintf(stderr, "oracle: %s\n", error.what());
        return 1;
    }
}
