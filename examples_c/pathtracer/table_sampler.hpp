// Points that another program made, so that any sampler can be compared.
#pragma once

#include "samplers.hpp"
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>

namespace demo {

// A file: the line "noisefloor-points WIDTH HEIGHT SAMPLES DIMS", then numbers in [0, 1) as little-endian floats,
// [y][x][sample][dim].
struct PointTable {
    std::string path;
    uint32_t width = 0, height = 0, samples = 0, dims = 0;
    std::vector<float> values;

    // Throws if the file is anything else.
    explicit PointTable(const std::string &file_path) : path(file_path)
    {
        if (path.empty())
            throw std::runtime_error("the sampler `table` needs --table FILE");
        std::unique_ptr<FILE, int (*)(FILE *)> file(std::fopen(path.c_str(), "rb"), std::fclose);
        if (!file)
            throw std::runtime_error("cannot read " + path + ": " + std::strerror(errno));
        char line[128];
        if (!std::fgets(line, sizeof line, file.get()) ||
            std::sscanf(line, "noisefloor-points %u %u %u %u", &width, &height, &samples, &dims) != 4 ||
            !std::strchr(line, '\n'))
            throw std::runtime_error(path + " does not begin with `noisefloor-points WIDTH HEIGHT SAMPLES DIMS`");
        const uint32_t most = 1 << 14;
        if (width - 1 >= most || height - 1 >= most || samples - 1 >= most || dims - 1 >= 64 ||
            uint64_t{width} * height * samples * dims > uint64_t{1} << 28)
            throw std::runtime_error(path + " says that it holds " + std::to_string(width) + " x " +
                                     std::to_string(height) + " pixels of " + std::to_string(samples) + " samples in " +
                                     std::to_string(dims) +
                                     " dimensions: one of these, or their product, is out of range");
        values.resize(size_t{width} * height * samples * dims);
        for (float &value : values) {
            unsigned char bytes[4];
            if (std::fread(bytes, 1, 4, file.get()) != 4)
                throw std::runtime_error(path + " ends early");
            uint32_t bits =
                uint32_t{bytes[0]} | uint32_t{bytes[1]} << 8 | uint32_t{bytes[2]} << 16 | uint32_t{bytes[3]} << 24;
            std::memcpy(&value, &bits, 4);
            if (!(value >= 0 && value < 1))
                throw std::runtime_error(path + " holds " + std::to_string(value) + ", which is not in [0, 1)");
        }
        if (std::fgetc(file.get()) != EOF)
            throw std::runtime_error(path + " holds more than its first line says");
    }
};

// The table, repeated over the image. Other frames than 0 and other seeds than 1 take it at another place, by a hash;
// so do domains that do not fit into its dimensions, which also add a hashed number to all values, modulo 1: two places
// of one table need not be independent.
class TableSampler final : public Sampler {
public:
    TableSampler(std::shared_ptr<const PointTable> table, const SamplerSetup &setup)
        : setup_(setup), table_(std::move(table)), groups_(group(setup.domains, table_->dims))
    {
        if (setup.samples > table_->samples)
            throw std::runtime_error(table_->path + " has " + std::to_string(table_->samples) +
                                     " samples per pixel; --spp asks for " + std::to_string(setup.samples));
        for (const Group &g : groups_)
            if (g.dims > table_->dims)
                throw std::runtime_error(table_->path + " has " + std::to_string(table_->dims) +
                                         " dimensions; a decision of this scene takes " + std::to_string(g.dims));
    }

    void points(uint32_t x, uint32_t y, float *u) const override { range(x, y, 0, setup_.samples, u); }
    void range(uint32_t x, uint32_t y, uint32_t first, uint32_t count, float *u) const override
    {
        for (size_t g = 0; g < groups_.size(); ++g) {
            bool as_it_is = g == 0 && setup_.seed == 1 && setup_.frame == 0;
            uint64_t key = as_it_is ? 0 : mix(mix(setup_.seed * golden + setup_.frame) + g),
                     place = as_it_is ? 0 : mix(key + golden);
            size_t column = (x + (place & 0xffffff)) % table_->width, row = (y + (place >> 40)) % table_->height;
            const float *from =
                &table_->values[((row * table_->width + column) * table_->samples + first) * table_->dims];
            for (uint32_t d = 0; d < groups_[g].dims; ++d, ++u, ++from) {
                float shift = g == 0 ? 0 : unit(static_cast<uint32_t>(mix(key + (d + 2) * golden) >> 32));
                for (uint32_t i = 0; i < count; ++i) {
                    float value = from[size_t{i} * table_->dims] + shift;
                    u[size_t{i} * setup_.dims] = std::min(value < 1 ? value : value - 1, 0x1.fffffep-1f);
                }
            }
        }
    }

private:
    SamplerSetup setup_;
    std::shared_ptr<const PointTable> table_;
    std::vector<Group> groups_;
};

} // namespace demo
