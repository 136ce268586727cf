// Sample points from noisefloor's samplers: how a renderer draws, and where tiles come from.
#pragma once

#include "noisefloor.h"
#include "samplers.hpp"
#include "table_sampler.hpp"
#include <algorithm>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>

namespace demo {

struct TileName {
    const char *name;
    const nf_tile *tile;
};

inline const TileName tile_names[] = {
    {"128_1SPP_2D", &nf_tile_128_1spp_2d},
    {"128_4SPP_2D", &nf_tile_128_4spp_2d},
    {"128_16SPP_2D", &nf_tile_128_16spp_2d},
    {"128_16SPP_2D_PROGRESSIVE", &nf_tile_128_16spp_2d_progressive},
    {"128_1SPP_4D", &nf_tile_128_1spp_4d},
    {"128_4SPP_4D", &nf_tile_128_4spp_4d},
    {"128_1SPP_2D_GAUSSIAN", &nf_tile_128_1spp_2d_gaussian},
    {"128_4SPP_2D_GAUSSIAN", &nf_tile_128_4spp_2d_gaussian},
    {"128_1SPP_2D_TEMPORAL", &nf_tile_128_1spp_2d_temporal},
    {"64_1SPP_2D", &nf_tile_64_1spp_2d},
    {"64_4SPP_2D", &nf_tile_64_4spp_2d},
    {"64_4SPP_2D_TEMPORAL", &nf_tile_64_4spp_2d_temporal},
};

// Those that come with the library.
inline std::string tile_list()
{
    std::string list;
    for (const TileName &tile : tile_names)
        list += (list.empty() ? "" : ", ") + std::string(tile.name);
    return list;
}

// A tile of the library, or one from a file, whose bytes must then outlive the view.
class LoadedTile {
public:
    // `name`: a name from tile_names, or a file. Throws if there is no such tile.
    explicit LoadedTile(const std::string &name)
    {
        for (const TileName &known : tile_names) {
            if (name != known.name)
                continue;
            view_ = *known.tile;
            return;
        }
        read(name);
        check(nf_tile_from_bytes(bytes_.data(), bytes_.size(), &view_), name);
    }
    LoadedTile(const LoadedTile &) = delete;
    LoadedTile &operator=(const LoadedTile &) = delete;

    const nf_tile &view() const { return view_; }

private:
    void read(const std::string &path)
    {
        FILE *file = std::fopen(path.c_str(), "rb");
        if (!file)
            throw std::runtime_error("there is no tile `" + path + "`, and no such file that can be read; tiles are " +
                                     tile_list());
        char buffer[4096];
        for (size_t n; (n = std::fread(buffer, 1, sizeof buffer, file)) > 0;)
            bytes_.insert(bytes_.end(), buffer, buffer + n);
        bool good = !std::ferror(file) && !bytes_.empty();
        std::fclose(file);
        if (!good)
            throw std::runtime_error(path + " cannot be read, or is empty");
    }

    static void check(nf_status status, const std::string &name)
    {
        if (status != NF_OK)
            throw std::runtime_error("tile " + name + ": " + nf_status_message(status));
    }

    nf_tile view_;
    std::vector<char> bytes_;
};

// If no tile is asked for: the library's tile of two dimensions with as many samples as are drawn, or the next fewer.
inline std::string default_tile(uint32_t samples)
{
    const TileName *best = nullptr;
    uint32_t best_size = 0, best_spp = 0;
    for (const TileName &tile : tile_names) {
        const nf_tile &view = *tile.tile;
        if (view.dims != 2 || view.spp > samples)
            continue;
        // Of equals the first: those that follow are for special purposes.
        if (!best || view.spp > best_spp || (view.spp == best_spp && view.size > best_size)) {
            best = &tile;
            best_size = view.size;
            best_spp = view.spp;
        }
    }
    return best->name;
}

inline nf_sampler child(nf_sampler s, uint32_t key) { return nf_sampler_domain(s, key); }
inline nf_tile_sampler child(nf_tile_sampler s, uint32_t key) { return nf_tile_sampler_domain(s, key); }
inline void draw(nf_sampler s, uint32_t dims, float *u) { nf_sampler_draw(s, dims, u); }
inline void draw(nf_tile_sampler s, uint32_t dims, float *u) { nf_tile_sampler_draw(s, dims, u); }

// The numbers of one sample: a tree of domains, the bounce, and in it the decision. Keys are all that tells them apart:
// nothing is counted, and a path that takes another turn does not disturb what the others draw.
template <class S> void draw_groups(const S &sampler, const std::vector<Group> &groups, float *u)
{
    for (const Group &g : groups) {
        draw(child(child(sampler, g.first.bounce), g.first.kind), g.dims, u);
        // The two numbers that belong together are drawn first, wherever they go.
        if (g.dims == 3 && g.first.dims == 1)
            std::rotate(u, u + 2, u + 3);
        u += g.dims;
    }
}

// noisefloor's samplers know frames alone. A seed is a block of them, so many for each frame of a tile; frames are
// numbers of 32 bits, and have room for so many seeds. Seed 1 begins at frame 0.
constexpr uint32_t frames_of_seed = 4096;

// Throws where a frame would be that of another seed.
inline uint32_t frame_of(const SamplerSetup &setup, uint32_t tile_frames)
{
    const uint64_t block = uint64_t{frames_of_seed} * tile_frames, seeds = (uint64_t{1} << 32) / block;
    auto refuse = [](const char *what, uint64_t number, uint64_t most) {
        throw std::runtime_error(std::string(what) + " " + std::to_string(number) + " is beyond " +
                                 std::to_string(most) + ", the last with points of its own from this sampler");
    };
    if (setup.seed >= seeds)
        refuse("seed", setup.seed, seeds - 1);
    if (setup.frame >= block)
        refuse("frame", setup.frame, block - 1);
    return setup.frame + static_cast<uint32_t>((setup.seed - 1) * block);
}

// The library's own: nothing to choose. Frames of few samples are shown averaged with those before: as many of them as
// make 16 samples count their samples on.
class DefaultSampler final : public Sampler {
public:
    explicit DefaultSampler(const SamplerSetup &setup)
        : setup_(setup), frame_(frame_of(setup, 1)),
          scramble_(setup.scramble ? static_cast<uint32_t>(mix(setup.seed)) | 1 : 0), groups_(group(setup.domains, 4))
    {
        const uint32_t together = 16 % setup.samples == 0 ? 16 / setup.samples : 1;
        first_ = setup.frame % together * setup.samples;
        frame_ -= setup.frame - setup.frame / together;
    }

    void points(uint32_t x, uint32_t y, float *u) const override { range(x, y, 0, setup_.samples, u); }
    void range(uint32_t x, uint32_t y, uint32_t first, uint32_t count, float *u) const override
    {
        for (uint32_t i = first; i < first + count; ++i, u += setup_.dims)
            draw_groups(nf_sampler_scramble(nf_sampler_pixel(x, y, frame_, first_ + i), scramble_), groups_, u);
    }

private:
    SamplerSetup setup_;
    uint32_t frame_, first_, scramble_;
    std::vector<Group> groups_;
};

class TileSampler final : public Sampler {
public:
    TileSampler(std::shared_ptr<const LoadedTile> tile, const SamplerSetup &setup)
        : setup_(setup), frame_(setup.frame), tile_(std::move(tile)),
          // A tile of two dimensions has a third that is stratified with them, which suits a choice or a time.
          groups_(group(setup.domains, std::min(std::max(tile_->view().dims, 3u), 4u)))
    {
        // Another seed is the tile at another place: as good as the first, which a scrambled tile is not. Frames stay
        // in their order.
        if (setup.scramble)
            scramble_ = static_cast<uint32_t>(mix(setup.seed)) | 1;
        else
            frame_ = frame_of(setup, tile_->view().frames);
    }

    void points(uint32_t x, uint32_t y, float *u) const override { range(x, y, 0, setup_.samples, u); }
    void range(uint32_t x, uint32_t y, uint32_t first, uint32_t count, float *u) const override
    {
        for (uint32_t i = first; i < first + count; ++i, u += setup_.dims) {
            const nf_tile_sampler sampler = nf_tile_sampler_pixel(&tile_->view(), x, y, frame_, i);
            draw_groups(nf_tile_sampler_scramble(sampler, scramble_), groups_, u);
        }
    }

private:
    SamplerSetup setup_;
    uint32_t frame_, scramble_ = 0;
    std::shared_ptr<const LoadedTile> tile_;
    std::vector<Group>
        groups_; // what one draw makes: domains that fit into the tile's dimensions are optimised together
};

inline const char *const sampler_names[] = {"default", "random", "sobol", "tile", "table"};

// Makes samplers of one kind: for each seed, for each domain. A file is read once, however many there are.
class SamplerFactory {
public:
    // `tile`: empty for one by the samples. Throws if there is no such sampler, or no such tile or table for it.
    SamplerFactory(const std::string &name, const std::string &tile, const std::string &table) : name_(name)
    {
        if (std::find(std::begin(sampler_names), std::end(sampler_names), name) == std::end(sampler_names))
            throw std::runtime_error("there is no sampler `" + name + "`; --help lists them");
        if (name == "tile" && !tile.empty())
            tile_ = std::make_shared<const LoadedTile>(tile);
        if (name == "table")
            table_ = std::make_shared<const PointTable>(table);
    }

    // Throws if the points that there are do not suffice.
    std::unique_ptr<Sampler> make(const SamplerSetup &setup) const
    {
        if (name_ == "default")
            return std::make_unique<DefaultSampler>(setup);
        if (name_ == "random")
            return std::make_unique<RandomSampler>(setup);
        if (name_ == "sobol")
            return std::make_unique<SobolSampler>(setup);
        if (table_)
            return std::make_unique<TableSampler>(table_, setup);
        return std::make_unique<TileSampler>(
            tile_ ? tile_ : std::make_shared<const LoadedTile>(default_tile(setup.samples)), setup);
    }

private:
    std::string name_;
    std::shared_ptr<const LoadedTile> tile_;
    std::shared_ptr<const PointTable> table_;
};

} // namespace demo
