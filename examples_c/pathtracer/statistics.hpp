// What many images of the same pixels say about an estimator: where it is on the mean, and how far from the truth.
#pragma once

#include "image.hpp"

namespace demo {

// Two independent renderings of what is to be estimated. Not one: its own error would be added to every estimator's.
struct Halves {
    Image a, b;

    // Throws unless both can be read and have that size.
    Halves(const std::string &path_a, const std::string &path_b, uint32_t width, uint32_t height)
        : a(read_pfm(path_a)), b(read_pfm(path_b))
    {
        check(a, path_a, width, height);
        check(b, path_b, width, height);
    }

private:
    static void check(const Image &image, const std::string &path, uint32_t width, uint32_t height)
    {
        if (image.width != width || image.height != height)
            throw std::runtime_error(path + " has " + std::to_string(image.width) + " x " +
                                     std::to_string(image.height) + " pixels, the image " + std::to_string(width) +
                                     " x " + std::to_string(height));
    }
};

// Of each pixel and channel.
class Statistics {
public:
    Statistics(uint32_t width, uint32_t height)
        : width_(width), height_(height), sum_(size_t{3} * width * height), error_(sum_.size())
    {
    }

    void add(const Image &image, const Halves &halves)
    {
        ++count_;
        for (size_t i = 0; i < sum_.size(); ++i) {
            double value = image.rgb[i];
            sum_[i] += value;
            error_[i] += (value - halves.a.rgb[i]) * (value - halves.b.rgb[i]);
        }
    }

    Image mean() const { return average(sum_); }
    // The mean of (I - A)(I - B), whose expectation is the mean squared error.
    Image squared_error() const { return average(error_); }

private:
    Image average(const std::vector<double> &sums) const
    {
        Image image(width_, height_);
        for (size_t i = 0; i < sums.size(); ++i)
            image.rgb[i] = static_cast<float>(sums[i] / count_);
        return image;
    }

    uint32_t width_, height_;
    double count_ = 0;
    std::vector<double> sum_, error_;
};

} // namespace demo
