// Tables of the direct light in a scene's pixels as a function of two numbers, for `fsot measure --scenes`.
//
//     embree_tables FOLDER [SCENE...]
//
// Without names: the scenes that samplers are made by. `duck`, `plane_1`, `plane_16` and `veach` are written if they
// are named: no sampler was made with these in mind.
//
// FOLDER/SCENE.table: a line `noisefloor-scene WIDTH HEIGHT CELLS`, then for each pixel, row by row, the luminance in
// the middle of CELLS x CELLS cells of the unit square, row by row, little-endian f32.
#include "embree.hpp"
#include "scenes.hpp"

#include "pathtracer/scene_integrand.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

namespace {

// Pixels of the picture and of its middle, which is kept; cells along each number.
constexpr uint32_t picture = 128, kept = 96, cells = 64;

// A scene, and the first of the two numbers: a point of the light, or of the sky. All others stay at one half: the
// middle of the exposure and of the lens, one lamp of several.
struct Choice {
    const char *scene;
    uint32_t first;
};
constexpr Choice choices[] = {{"animation", 0}, {"bathroom", 0},  {"chopper", 0}, {"dining", 0},
                              {"dragon", 0},    {"killeroos", 1}, {"lens", 2},    {"microcity", 0},
                              {"duck", 0},      {"plane_1", 0},   {"plane_16", 0}, {"veach", 0}};
// So many of them without names.
constexpr int usual = 8;

void write(const demo::SceneIntegrand &integrand, uint32_t first, const std::string &path)
{
    const uint32_t dims = demo::dims(integrand.domains());
    std::vector<float> numbers(size_t{cells} * cells * dims, .5f), colors(size_t{cells} * cells * 3);
    std::vector<float> values(size_t{cells} * cells);
    for (uint32_t j = 0; j < cells; ++j)
        for (uint32_t i = 0; i < cells; ++i) {
            float *u = &numbers[(size_t{j} * cells + i) * dims + first];
            u[0] = (static_cast<float>(i) + .5f) / cells;
            u[1] = (static_cast<float>(j) + .5f) / cells;
        }
    // Under its name when it is whole, or not at all.
    const std::string partial = path + ".partial";
    std::FILE *file = std::fopen(partial.c_str(), "wb");
    if (!file)
        throw std::runtime_error("cannot create " + partial + ": " + std::strerror(errno));
    bool written = std::fprintf(file, "noisefloor-scene %u %u %u\n", kept, kept, cells) > 0;
    const uint32_t corner = (picture - kept) / 2;
    for (uint32_t y = corner; y < corner + kept; ++y)
        for (uint32_t x = corner; x < corner + kept; ++x) {
            integrand.evaluate(x, y, values.size(), numbers.data(), colors.data(), nullptr, nullptr);
            for (size_t i = 0; i < values.size(); ++i)
                values[i] = .2126f * colors[3 * i] + .7152f * colors[3 * i + 1] + .0722f * colors[3 * i + 2];
            written = written && std::fwrite(values.data(), sizeof(float), values.size(), file) == values.size();
        }
    written = std::fclose(file) == 0 && written;
    if (written && std::rename(partial.c_str(), path.c_str()) == 0)
        return;
    std::remove(partial.c_str());
    throw std::runtime_error("cannot write all of " + path);
}

void table(const Choice &choice, const std::string &folder)
{
    for (const demo::SceneEntry &entry : harness::scenes()) {
        if (entry.name != std::string(choice.scene))
            continue;
        demo::Scene scene;
        entry.build(0, 1.0f, scene);
        const harness::EmbreeIntersector intersector(scene.geometry);
        write(demo::SceneIntegrand(scene, intersector, picture, picture), choice.first,
              folder + "/" + choice.scene + ".table");
    }
}

} // namespace

int main(int argc, char **argv)
{
    if (argc < 2) {
        std::fprintf(stderr, "usage: embree_tables FOLDER [SCENE...]\n");
        return 2;
    }
    try {
        int found = 0;
        for (const Choice &choice : choices) {
            bool wanted = argc == 2 && &choice - choices < usual;
            for (int i = 2; i < argc; ++i)
                wanted = wanted || choice.scene == std::string(argv[i]);
            if (!wanted)
                continue;
            table(choice, argv[1]);
            std::printf("%s\n", choice.scene);
            ++found;
        }
        if (argc > 2 && found != argc - 2)
            throw std::runtime_error("not every name is that of a scene with a table");
    } catch (const std::exception &error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    return 0;
}
