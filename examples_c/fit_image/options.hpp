// The command line.
#pragma once
#include "sampler.hpp"
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

namespace fit {

struct Options {
    std::string image = "examples_c/data/house_cat.ppm";
    std::string output; // what the pictures' names start with; empty: none
    std::vector<const Method *> chosen;
    std::uint32_t steps = 4000, seeds = 3, batch = 256, width = 64, records = 40, batches = 100;
    float rate = 2e-2f, uniform_fraction = 0.2f, momentum = 0.5f;
    bool stratified = false, variance = false, help = false;
};

inline void usage()
{
    std::fputs("usage: fit_image [options]\n"
               "  --image FILE          binary PPM [examples_c/data/house_cat.ppm]\n"
               "  --methods A,B,...     [uniform,is,omis3,omis6]\n"
               "  --output PREFIX       write PREFIX.METHOD.ppm and PREFIX.METHOD.error.ppm, of the first seed\n"
               "  --steps N             steps of Adam [4000]\n"
               "  --seeds N             networks and runs [3]\n"
               "  --batch N             pixels of a minibatch, a multiple of 16 [256]\n"
               "  --width N             nodes of a hidden layer, a multiple of 4 [64]\n"
               "  --rate R              Adam's learning rate at the start; it falls to 0 [.02]\n"
               "  --records N           how often the whole picture is evaluated [40]\n"
               "  --uniform-fraction D  part of every distribution that is uniform [.2]\n"
               "  --momentum M          how much of an importance is kept when its pixel is visited [.5]\n"
               "  --stratified          draw from strata of the tables: of neighbouring pixels\n"
               "  --variance            errors of the gradient estimates at the same states, instead of training\n"
               "  --batches N           minibatches per state of --variance [100]\n"
               "methods:\n",
               stdout);
    for (const Method &method : methods())
        std::printf("  %-9s %s\n", method.name, method.what);
}

inline std::vector<const Method *> parse_methods(const std::string &names)
{
    std::vector<const Method *> chosen;
    for (std::size_t start = 0; start <= names.size();) {
        const std::size_t end = std::min(names.find(',', start), names.size());
        const std::string name = names.substr(start, end - start);
        const std::size_t before = chosen.size();
        for (const Method *other : chosen)
            if (name == other->name)
                throw std::runtime_error("--methods: `" + name + "` is named twice");
        for (const Method &method : methods())
            if (name == method.name)
                chosen.push_back(&method);
        if (chosen.size() == before)
            throw std::runtime_error("--methods: there is no `" + name + "`");
        start = end + 1;
    }
    return chosen;
}

inline Options parse(int argc, char **argv)
{
    Options options;
    std::string chosen = "uniform,is,omis3,omis6";
    for (int i = 1; i < argc; ++i) {
        const std::string name = argv[i];
        bool *flag = name == "--help"         ? &options.help
                     : name == "--variance"   ? &options.variance
                     : name == "--stratified" ? &options.stratified
                                              : nullptr;
        if (flag) {
            *flag = true;
            continue;
        }
        if (++i == argc)
            throw std::runtime_error(name + ": unknown option, or its value is missing");
        const std::string text = argv[i];
        const auto number = [&](double low, double high) {
            char *end = nullptr, range[64];
            const double value = std::strtod(text.c_str(), &end);
            std::snprintf(range, sizeof range, "%g to %g", low, high);
            if (text.empty() || *end || !(value >= low && value <= high))
                throw std::runtime_error(name + ": `" + text + "` is not a number from " + range);
            return value;
        };
        const auto whole = [&](double low, double high, std::uint32_t unit = 1) {
            const double value = number(low, high);
            if (std::fmod(value, unit) != 0.0)
                throw std::runtime_error(name + ": `" + text + "` is not a multiple of " + std::to_string(unit));
            return std::uint32_t(value);
        };
        if (name == "--image")
            options.image = text;
        else if (name == "--methods")
            chosen = text;
        else if (name == "--output")
            options.output = text;
        else if (name == "--steps")
            options.steps = whole(1, 1e7);
        else if (name == "--seeds")
            options.seeds = whole(1, 1000);
        else if (name == "--batch")
            options.batch = whole(16, 4096, 16);
        else if (name == "--width")
            options.width = whole(4, 1024, 4);
        else if (name == "--rate")
            options.rate = float(number(1e-9, 1));
        else if (name == "--records")
            options.records = whole(1, 10000);
        else if (name == "--uniform-fraction")
            options.uniform_fraction = float(number(1e-3, 1));
        else if (name == "--momentum")
            options.momentum = float(number(0, 0.99));
        else if (name == "--batches")
            options.batches = whole(2, 1e5);
        else
            throw std::runtime_error(name + ": unknown option");
    }
    options.chosen = parse_methods(chosen);
    return options;
}

} // namespace fit
