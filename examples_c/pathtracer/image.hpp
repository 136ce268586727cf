// Linear RGB images as PFM files: a text header, then rows of floats from the bottom up.
#pragma once

#include "vector.hpp"
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace demo {

struct Image {
    uint32_t width, height;
    std::vector<float> rgb; // rows from the top down

    Image(uint32_t w, uint32_t h) : width(w), height(h), rgb(size_t{3} * w * h) {}
};

inline bool little_endian()
{
    const uint16_t one = 1;
    return *reinterpret_cast<const unsigned char *>(&one) == 1;
}

// Throws unless the file is a PFM of three channels in this machine's byte order.
inline Image read_pfm(const std::string &path)
{
    std::unique_ptr<FILE, int (*)(FILE *)> file(std::fopen(path.c_str(), "rb"), std::fclose);
    if (!file)
        throw std::runtime_error("cannot read " + path + ": " + std::strerror(errno));
    uint32_t width = 0, height = 0;
    float scale = 0;
    if (std::fscanf(file.get(), "PF %u %u %f", &width, &height, &scale) != 3 || std::fgetc(file.get()) == EOF)
        throw std::runtime_error(path + " is no PFM image of three channels");
    if ((scale < 0) != little_endian())
        throw std::runtime_error(path + " was written on a machine of the other byte order");
    if (width == 0 || height == 0 || width > 1 << 16 || height > 1 << 16)
        throw std::runtime_error(path + " has " + std::to_string(width) + " x " + std::to_string(height) +
                                 " pixels: not 1 to 65536 each way");
    Image image(width, height);
    size_t row = size_t{3} * width;
    for (uint32_t y = height; y-- > 0;)
        if (std::fread(image.rgb.data() + y * row, sizeof(float), row, file.get()) != row)
            throw std::runtime_error(path + " ends early");
    return image;
}

// Files appear under their names when all of them are complete.
class Outputs {
public:
    Outputs() = default;
    Outputs(const Outputs &) = delete;
    Outputs &operator=(const Outputs &) = delete;
    ~Outputs()
    {
        for (const auto &file : files_)
            std::remove(file.first.c_str());
    }

    void add(const std::string &path, const Image &image)
    {
        std::string temporary = path + ".partial";
        FILE *file = std::fopen(temporary.c_str(), "wb");
        if (!file)
            throw std::runtime_error("cannot create " + temporary + ": " + std::strerror(errno));
        files_.emplace_back(temporary, path);
        // The sign of the scale tells the byte order.
        bool good =
            std::fprintf(file, "PF\n%u %u\n%s\n", image.width, image.height, little_endian() ? "-1.0" : "1.0") > 0;
        size_t row = size_t{3} * image.width;
        for (uint32_t y = image.height; y-- > 0;)
            good = std::fwrite(image.rgb.data() + y * row, sizeof(float), row, file) == row && good;
        if (std::fclose(file) != 0 || !good)
            throw std::runtime_error("cannot write " + temporary);
    }

    // Where a name cannot be had, those before it stay: what they may have replaced is gone.
    void commit()
    {
        std::string done;
        for (const auto &file : files_) {
            if (std::rename(file.first.c_str(), file.second.c_str()) != 0)
                throw std::runtime_error("cannot create " + file.second + ": " + std::strerror(errno) +
                                         (done.empty() ? "" : "; written:" + done));
            done += " " + file.second;
        }
        files_.clear();
    }

private:
    std::vector<std::pair<std::string, std::string>> files_; // temporary, final
};

} // namespace demo
