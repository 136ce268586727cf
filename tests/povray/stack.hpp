// A stack of pictures: one of a scene for every cell of a grid over the unit cube of samples. Files, which
// tests/programs/povray_stack.py has POV-Ray render and writes, are lines of text, then numbers, little-endian.
//
//   noisefloor-stack 1
//   size 128 128                       width and height
//   axis lens 8                        once for each coordinate of the sample vector: what it decides, and its cells
//   axis lens 8
//   checksum 0123456789abcdef          FNV-1a, 64 bits, of all that follows `data`
//   data
//
// then for each pixel, rows from the top down, a 16-bit number of the surface that it shows; then for each pixel and
// each cell, the last axis fastest, three 16-bit values, of which 65535 is 1.
#pragma once

#include "../../examples_c/pathtracer/integrand.hpp"
#include <cstdio>
#include <stdexcept>
#include <string>

namespace povray {

struct Axis {
    demo::Domain::Kind kind;
    uint32_t cells;
};

class Stack {
public:
    // Throws if the file cannot be read, is no stack, or is damaged.
    explicit Stack(const std::string &path) : path_(path)
    {
        File file(path);
        header(file);
        const size_t numbers = pixels() * (1 + 3 * cells());
        numbers_.resize(numbers);
        if (std::fread(numbers_.data(), 2, numbers, file.get()) != numbers)
            fail("it ends early; its header promises " + std::to_string(2 * numbers) + " bytes of data");
        if (std::fgetc(file.get()) != EOF)
            fail("there is more after its " + std::to_string(2 * numbers) + " bytes of data");
        const auto *bytes = reinterpret_cast<const unsigned char *>(numbers_.data());
        uint64_t hash = 0xcbf29ce484222325u;
        for (size_t i = 0; i < 2 * numbers; ++i)
            hash = (hash ^ bytes[i]) * 0x100000001b3u;
        if (hash != checksum_)
            fail("its data does not have the checksum that its header states");
        for (size_t i = 0; i < numbers; ++i) // from the file's byte order to the machine's
            numbers_[i] = static_cast<uint16_t>(bytes[2 * i] | bytes[2 * i + 1] << 8);
    }

    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    const std::vector<Axis> &axes() const { return axes_; }
    // Of the whole grid.
    size_t cells() const
    {
        size_t product = 1;
        for (const Axis &axis : axes_)
            product *= axis.cells;
        return product;
    }
    uint32_t surface(uint32_t x, uint32_t y) const { return numbers_[index(x, y)]; }
    // values[cells() * 3]
    const uint16_t *values(uint32_t x, uint32_t y) const { return &numbers_[pixels() + index(x, y) * cells() * 3]; }

private:
    class File {
    public:
        explicit File(const std::string &path) : file_(std::fopen(path.c_str(), "rb"))
        {
            if (!file_)
                throw std::runtime_error("cannot read the stack " + path +
                                         "; `cargo xtask test povray` renders small ones into target/povray");
        }
        File(const File &) = delete;
        File &operator=(const File &) = delete;
        ~File() { std::fclose(file_); }
        FILE *get() const { return file_; }

    private:
        FILE *file_;
    };

    [[noreturn]] void fail(const std::string &what) const
    {
        throw std::runtime_error("the stack " + path_ + " is damaged: " + what +
                                 ". Delete it: it is rendered again when it is needed");
    }

    std::string line(FILE *file) const
    {
        std::string text;
        for (int c; (c = std::fgetc(file)) != '\n';) {
            if (c == EOF || text.size() > 100)
                fail("its header ends early");
            text += static_cast<char>(c);
        }
        return text;
    }

    void header(const File &file)
    {
        if (line(file.get()) != "noisefloor-stack 1")
            throw std::runtime_error(path_ +
                                     " is no stack of this version: it does not begin with `noisefloor-stack 1`");
        bool checked = false;
        for (std::string text; (text = line(file.get())) != "data";) {
            char kind[16];
            unsigned a = 0, b = 0;
            unsigned long long sum = 0;
            if (std::sscanf(text.c_str(), "size %5u %5u", &a, &b) == 2) {
                width_ = a;
                height_ = b;
            } else if (std::sscanf(text.c_str(), "axis %15s %5u", kind, &a) == 2) {
                axes_.push_back({domain(kind), a});
            } else if (std::sscanf(text.c_str(), "checksum %16llx", &sum) == 1) {
                checksum_ = sum;
                checked = true;
            } else {
                fail("its header says `" + text + "`");
            }
        }
        if (!checked || axes_.empty() || axes_.size() > 8 || width_ == 0 || height_ == 0 || cells() == 0 ||
            pixels() > (size_t{1} << 31) / cells())
            fail("its header lacks a line, or states an impossible size");
    }

    demo::Domain::Kind domain(const std::string &kind) const
    {
        if (kind == "light")
            return demo::Domain::light;
        if (kind == "choice")
            return demo::Domain::choice;
        if (kind == "lens")
            return demo::Domain::lens;
        if (kind == "time")
            return demo::Domain::time;
        fail("its header names an axis `" + kind + "`");
    }

    size_t pixels() const { return size_t{width_} * height_; }
    size_t index(uint32_t x, uint32_t y) const { return size_t{y} * width_ + x; }

    std::string path_;
    uint32_t width_ = 0, height_ = 0;
    std::vector<Axis> axes_;
    uint64_t checksum_ = 0;
    std::vector<uint16_t> numbers_; // the surfaces, then the values
};

} // namespace povray
