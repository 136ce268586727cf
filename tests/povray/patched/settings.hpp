// What the environment asks for. POV-Ray's options and scene files stay POV-Ray's own.
#pragma once

#include "tile_sampler.hpp"
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>

extern char **environ;

namespace noisefloor_povray {

struct Settings {
    enum class Mode { off, samples, estimate };

    Mode mode = Mode::off;
    uint32_t samples = 16;
    std::string sampler = "tile", tile, estimator = "recommended";
    uint32_t order = 0; // 0: the recommended one
    uint32_t seed = 0;
    std::shared_ptr<const demo::SamplerFactory> samplers; // none if off, and for `grid`
    bool box = true;         // samples anywhere in the pixel; else at its centre
    bool moves_lights = true; // see nfp_moves_lights

    // Throws if a value is not understood, or a name is not one of these.
    static Settings read()
    {
        Settings s;
        s.mode = static_cast<Mode>(choose("NOISEFLOOR", {"off", "samples", "estimate"}));
        s.samples = number("NOISEFLOOR_SPP", s.samples, 1, 65536);
        s.sampler = sampler_names[choose("NOISEFLOOR_SAMPLER", sampler_names)];
        s.tile = text("NOISEFLOOR_TILE", s.tile);
        s.estimator = text("NOISEFLOOR_ESTIMATOR", s.estimator);
        s.order = number("NOISEFLOOR_ORDER", s.order, 0, 7);
        // Frames of a sampler: no more than every tile has.
        s.seed = number("NOISEFLOOR_SEED", s.seed, 0, demo::frames_of_seed - 1);
        s.box = choose("NOISEFLOOR_PIXEL", {"box", "center"}) == 0;
        s.moves_lights = choose("NOISEFLOOR_LIGHT", {"whole", "shadow"}) == 0;
        refuse_others();
        if (s.mode != Mode::off && s.sampler != "grid")
            s.samplers = std::make_shared<const demo::SamplerFactory>(s.sampler, s.tile, "");
        return s;
    }

private:
    static constexpr const char *sampler_names[] = {"tile", "sobol", "random", "grid"};
    static constexpr const char *names[] = {"NOISEFLOOR",      "NOISEFLOOR_SPP",       "NOISEFLOOR_SAMPLER",
                                            "NOISEFLOOR_TILE", "NOISEFLOOR_ESTIMATOR", "NOISEFLOOR_ORDER",
                                            "NOISEFLOOR_SEED", "NOISEFLOOR_PIXEL",     "NOISEFLOOR_LIGHT"};

    static std::string text(const char *name, const std::string &otherwise)
    {
        const char *value = std::getenv(name);
        return value && *value ? value : otherwise;
    }

    template <size_t n> static size_t choose(const char *name, const char *const (&values)[n])
    {
        std::string value = text(name, values[0]), all;
        for (size_t i = 0; i < n; ++i) {
            if (value == values[i])
                return i;
            all += (i ? ", " : "") + std::string(values[i]);
        }
        throw std::runtime_error(std::string(name) + "=" + value + " is not one of " + all);
    }

    static uint32_t number(const char *name, uint32_t otherwise, uint64_t least, uint64_t most)
    {
        std::string value = text(name, std::to_string(otherwise));
        char *end = nullptr;
        uint64_t result = std::strtoull(value.c_str(), &end, 10);
        if (value[0] < '0' || value[0] > '9' || *end || result < least || result > most)
            throw std::runtime_error(std::string(name) + "=" + value + " is not a whole number from " +
                                     std::to_string(least) + " to " + std::to_string(most));
        return static_cast<uint32_t>(result);
    }

    // A misspelt name would otherwise be a setting silently left alone.
    static void refuse_others()
    {
        for (char **entry = environ; *entry; ++entry) {
            std::string name(*entry, std::strcspn(*entry, "="));
            bool known = false;
            for (const char *other : names)
                known = known || name == other;
            if (name.rfind("NOISEFLOOR_", 0) == 0 && !known)
                throw std::runtime_error("there is no setting " + name + "; tests/povray/patched/README.md lists them");
        }
    }
};

} // namespace noisefloor_povray
