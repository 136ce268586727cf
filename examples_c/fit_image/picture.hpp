// Pictures: binary PPM files of 8 bits.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

namespace fit {

struct Picture {
    std::size_t width = 0, height = 0;
    std::vector<std::uint8_t> bytes; // red, green, blue of each pixel, in the order of Morton's curve: see read_ppm
    std::vector<std::uint32_t> places; // row * width + column of each pixel

    std::size_t pixels() const { return places.size(); }

    // The point of [-1, 1]^2 at a pixel's centre.
    float x(std::size_t pixel) const { return (2.0f * float(places[pixel] % width) + 1.0f) / float(width) - 1.0f; }
    float y(std::size_t pixel) const { return (2.0f * float(places[pixel] / width) + 1.0f) / float(height) - 1.0f; }

    // A channel, 0..=255 being -1..=1.
    float value(std::size_t pixel, std::size_t channel) const
    {
        return float(bytes[3 * pixel + channel]) / 127.5f - 1.0f;
    }
};

inline std::uint8_t to_byte(float value)
{
    return std::uint8_t(std::clamp((value + 1.0f) * 127.5f + 0.5f, 0.0f, 255.0f));
}

// The column's and the row's bits in turn: pixels whose numbers are close are close in the picture.
inline std::uint64_t morton(std::uint64_t x, std::uint64_t y)
{
    std::uint64_t code = 0;
    for (int bit = 0; bit < 12; ++bit)
        code |= (x >> bit & 1) << (2 * bit) | (y >> bit & 1) << (2 * bit + 1);
    return code;
}

// In Morton's order a stratum of a table is a patch of the picture; in that of rows it would be a part of a row.
inline Picture read_ppm(const std::string &path)
{
    std::ifstream file(path, std::ios::binary);
    if (!file)
        throw std::runtime_error(path + ": cannot be opened");
    const auto bad = [&path](const std::string &why) { return std::runtime_error(path + ": " + why); };
    std::string kind;
    file >> kind;
    if (kind != "P6")
        throw bad("not a binary PPM picture (P6)");
    std::size_t numbers[3];
    for (std::size_t &number : numbers) {
        while ((file >> std::ws) && file.peek() == '#')
            file.ignore(1 << 20, '\n');
        if (!(file >> number))
            throw bad("no header of a PPM picture");
    }
    const auto [width, height, largest] = numbers;
    if (largest != 255 || width < 16 || height < 16 || width > 4096 || height > 4096)
        throw bad(std::to_string(width) + " x " + std::to_string(height) + " pixels of 0 to " +
                  std::to_string(largest) + ": not 16 x 16 to 4096 x 4096 of 8 bits, 0 to 255");
    file.get(); // one white space
    std::vector<std::uint8_t> rows(3 * width * height);
    if (!file.read(reinterpret_cast<char *>(rows.data()), std::streamsize(rows.size())))
        throw bad("ends early");
    Picture picture{width, height, {}, std::vector<std::uint32_t>(width * height)};
    std::iota(picture.places.begin(), picture.places.end(), 0u);
    std::sort(picture.places.begin(), picture.places.end(), [w = width](std::uint32_t a, std::uint32_t b) {
        return morton(a % w, a / w) < morton(b % w, b / w);
    });
    for (const std::uint32_t place : picture.places)
        picture.bytes.insert(picture.bytes.end(), &rows[3 * place], &rows[3 * place] + 3);
    return picture;
}

inline void write_ppm(const std::string &path, const Picture &picture)
{
    std::vector<std::uint8_t> rows(picture.bytes.size());
    for (std::size_t i = 0; i < picture.pixels(); ++i)
        std::copy_n(&picture.bytes[3 * i], 3, &rows[3 * picture.places[i]]);
    std::ofstream file(path, std::ios::binary);
    file << "P6\n" << picture.width << ' ' << picture.height << "\n255\n";
    file.write(reinterpret_cast<const char *>(rows.data()), std::streamsize(rows.size()));
    file.close();
    if (!file)
        throw std::runtime_error(path + ": cannot be written");
}

} // namespace fit
