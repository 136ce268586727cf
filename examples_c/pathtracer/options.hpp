// The command line.
#pragma once

#include "estimators.hpp"
#include "mis_estimators.hpp"
#include "filter.hpp"
#include "scene.hpp"
#include "tile_sampler.hpp"
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <thread>

namespace demo {

struct Options {
    std::string scene; // empty: the first
    uint32_t width = 128, height = 128, spp = 64, order = 2, threads = 1;
    uint64_t seed = 1;
    uint32_t seeds = 1; // consecutive ones, from `seed`
    std::vector<std::string> estimators{"mc", "robust"};
    std::string sampler = "random", tile, table; // tile: a name or a file; empty: by the samples
    uint32_t frame = 0;
    Filter filter = Filter::center;
    std::string output = "pathtracer";
    bool reference = false, scramble = false;
    bool independent = false; // the table's points are, and estimators are told so
    uint32_t bounces = 0; // of the paths; 0: as the scene has them
    bool mis = false; // the estimators are those of mis_estimators.hpp
    uint32_t accumulate = 0; // samples of a pass over the image; 0: pixel by pixel
    std::vector<std::string> statistics; // two halves of a reference; empty: images are written
    Basis basis = basis_names[0];
    uint32_t regressed = 0; // numbers of the sample vector, from its start; 0: all, or as many as noisefloor regresses
};

// The words between commas.
inline std::vector<std::string> split(const std::string &text)
{
    std::vector<std::string> words;
    for (size_t begin = 0; begin <= text.size();) {
        size_t comma = std::min(text.find(',', begin), text.size());
        words.push_back(text.substr(begin, comma - begin));
        begin = comma + 1;
    }
    return words;
}

inline void print_usage(FILE *to, const Program &program)
{
    std::fprintf(
        to,
        "usage: %s [--scene NAME] [--width N] [--height N] [--spp N] [--estimators A,B,...] [--order N]\n"
        "                  [--basis NAME] [--regressed N] [--sampler NAME] [--tile NAME|FILE.nft]\n"
        "                  [--table FILE [--independent]] [--filter NAME]\n"
        "                  [--frame N] [--seed N] [--seeds N] [--statistics A.pfm,B.pfm] [--threads N] [--output "
        "PREFIX]\n"
        "                  [--accumulate N] [--bounces N] [--mis] [--reference]\n"
        "                  [--scramble]\n\n"
        "Renders PREFIX.ESTIMATOR.pfm with each estimator from the same samples and prints one line of JSON for each.\n"
        "--reference renders PREFIX.reference.pfm instead: the plain mean over a shifted lattice.\n"
        "--seeds renders PREFIX.ESTIMATOR.SEED.pfm with each of so many seeds.\n"
        "--statistics writes PREFIX.ESTIMATOR.mean.pfm and PREFIX.ESTIMATOR.mse.pfm over all seeds instead: the mean "
        "image, and\n"
        "the mean squared error of each pixel and channel, (I - A)(I - B) for two independent halves of a reference.\n"
        "--accumulate: rows get passes of N samples, one after the other, into accumulators.\n"
        "--bounces: how many reflections paths have, instead of as many as the scene says.\n"
        "--mis: direct light by two techniques, a half of the samples each: light sampling and direction sampling.\n"
        "--scramble: seeds scramble the values of tile and default: exactly unbiased, and not as good.\n"
        "--table: points for the sampler of that name, made elsewhere; their format is in "
        "pathtracer/table_sampler.hpp.\n"
        "--independent: they are independent, where estimators take them for stratified otherwise.\n"
        "--regressed: how many of the sample vector's numbers the estimators regress, from its start; those told\n"
        "which light was picked regress the numbers up to that instead.\n\nsamplers:",
        program.name.c_str());
    for (const char *name : sampler_names)
        std::fprintf(to, " %s", name);
    std::fputs("\ntiles:", to);
    for (const TileName &tile : tile_names)
        std::fprintf(to, " %s", tile.name);
    std::fputs("\nfilters:", to);
    for (const FilterName &filter : filter_names)
        std::fprintf(to, " %s", filter.name);
    std::fputs("\nbases:", to);
    for (const Basis &basis : basis_names)
        std::fprintf(to, " %s", basis.name);
    std::fputs("\nscenes:\n", to);
    for (const SceneEntry &scene : program.scenes)
        std::fprintf(to, "  %-17s %s\n", scene.name.c_str(), scene.description.c_str());
    std::fputs("estimators:\n", to);
    for (const EstimatorName &estimator : estimator_names)
        std::fprintf(to, "  %-17s %s\n", estimator.name, estimator.description);
    std::fputs("estimators with --mis:\n", to);
    for (const MisEstimatorName &estimator : mis_estimator_names)
        std::fprintf(to, "  %-22s %s\n", estimator.name, estimator.description);
}

inline uint64_t parse_number(const std::string &option, const std::string &text, uint64_t low, uint64_t high)
{
    bool digits = !text.empty() && text.size() < 20 && text.find_first_not_of("0123456789") == std::string::npos;
    uint64_t value = digits ? std::strtoull(text.c_str(), nullptr, 10) : 0;
    if (!digits || value < low || value > high)
        throw std::runtime_error(option + " takes a number from " + std::to_string(low) + " to " +
                                 std::to_string(high) + ", not `" + text + "`");
    return value;
}

inline Filter parse_filter(const std::string &text)
{
    for (const FilterName &known : filter_names)
        if (text == known.name)
            return known.filter;
    throw std::runtime_error("there is no filter `" + text + "`; --help lists them");
}

inline Basis parse_basis(const std::string &text)
{
    for (const Basis &known : basis_names)
        if (text == known.name)
            return known;
    throw std::runtime_error("there is no basis `" + text + "`; --help lists them");
}

inline std::vector<std::string> distinct(const std::vector<std::string> &names)
{
    for (size_t i = 0; i < names.size(); ++i)
        if (std::count(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(i), names[i]) > 0)
            throw std::runtime_error("--estimators names `" + names[i] + "` twice");
    return names;
}

// Throws on a wrong command line; returns false if only help was asked for.
inline bool parse(int argc, char **argv, const Program &program, Options &options)
{
    options.threads = std::max(1u, std::thread::hardware_concurrency());
    if (!program.scenes.empty())
        options.scene = program.scenes[0].name;
    bool named = false;
    for (int i = 1; i < argc; ++i) {
        std::string name = argv[i];
        if (name == "--help" || name == "-h")
            return false;
        bool *flag = name == "--scramble"      ? &options.scramble
                     : name == "--reference"   ? &options.reference
                     : name == "--mis"         ? &options.mis
                     : name == "--independent" ? &options.independent
                                               : nullptr;
        if (flag) {
            *flag = true;
            continue;
        }
        if (i + 1 == argc)
            throw std::runtime_error("`" + name + "` is unknown or lacks its value; --help lists the options");
        std::string value = argv[++i];
        auto number = [&](uint64_t low, uint64_t high) {
            return static_cast<uint32_t>(parse_number(name, value, low, high));
        };
        if (name == "--scene")
            options.scene = value;
        else if (name == "--width")
            options.width = number(1, 8192);
        else if (name == "--height")
            options.height = number(1, 8192);
        else if (name == "--spp")
            options.spp = number(1, 1 << 20);
        else if (name == "--order")
            options.order = number(0, 7);
        else if (name == "--threads")
            options.threads = number(1, 256);
        else if (name == "--seed")
            options.seed = parse_number(name, value, 0, key_seeds - 1);
        else if (name == "--sampler")
            options.sampler = value;
        else if (name == "--tile")
            options.tile = value;
        else if (name == "--table")
            options.table = value;
        else if (name == "--frame")
            options.frame = number(0, 1 << 20); // below key_frames
        else if (name == "--filter")
            options.filter = parse_filter(value);
        else if (name == "--output")
            options.output = value;
        else if (name == "--estimators") {
            options.estimators = distinct(split(value));
            named = true;
        } else if (name == "--statistics") {
            options.statistics = split(value);
            if (options.statistics.size() != 2)
                throw std::runtime_error("--statistics takes the two halves of a reference, A.pfm,B.pfm, not `" +
                                         value + "`");
        } else if (name == "--seeds")
            options.seeds = number(1, 1 << 20);
        else if (name == "--accumulate")
            options.accumulate = number(1, 1 << 20);
        else if (name == "--basis")
            options.basis = parse_basis(value);
        else if (name == "--bounces")
            options.bounces = number(1, 16);
        else if (name == "--regressed")
            options.regressed = number(1, 16);
        else
            throw std::runtime_error("unknown option `" + name + "`; --help lists them");
    }
    if (options.seed + options.seeds > key_seeds)
        throw std::runtime_error("--seeds " + std::to_string(options.seeds) + " from --seed " +
                                 std::to_string(options.seed) + " on go beyond the last, " +
                                 std::to_string(key_seeds - 1));
    const std::filesystem::path folder = std::filesystem::path(options.output).parent_path();
    if (!folder.empty() && !std::filesystem::is_directory(folder))
        throw std::runtime_error("--output " + options.output + ": there is no folder " + folder.string() +
                                 "; create it first");
    if (options.mis && !named) {
        options.estimators.clear();
        for (const MisEstimatorName &estimator : mis_estimator_names)
            options.estimators.push_back(estimator.name);
    }
    if (options.mis && (options.accumulate || options.reference || options.spp % 2))
        throw std::runtime_error("--mis takes an even --spp, and neither --accumulate nor --reference");
    if (options.mis && (options.bounces || options.regressed))
        throw std::runtime_error(
            std::string(options.bounces ? "--bounces" : "--regressed") +
            " is not for --mis: that is direct light, and regresses the two numbers of each technique");
    if (options.independent && options.sampler != "table")
        throw std::runtime_error("--independent is for --sampler table: of the others it is known");
    if (options.accumulate && options.reference)
        throw std::runtime_error("--reference does without --accumulate");
    return true;
}

} // namespace demo
