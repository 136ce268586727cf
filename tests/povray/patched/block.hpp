// A block of pixels: their numbers, their values, and what becomes of them.
#pragma once

#include "context.hpp"
#include "estimator.hpp"
#include <utility>

namespace noisefloor_povray {

// The regressed numbers of a sample, two for each decision that every sample takes.
struct Layout {
    bool box = false, lens = false;
    std::vector<const void *> lights;

    uint32_t decisions() const { return (box ? 1u : 0u) + (lens ? 1u : 0u) + static_cast<uint32_t>(lights.size()); }
    uint32_t dims() const { return 2 * decisions(); }
    bool operator==(const Layout &other) const
    {
        return box == other.box && lens == other.lens && lights == other.lights;
    }
};

// Library limit: nf_cv_config.dims.
constexpr uint32_t most_decisions = 8;

// One per thread, used for block after block.
class Block {
public:
    explicit Block(const Settings &settings) : settings_(settings), further_(settings, settings.samples, most_decisions)
    {
    }

    void begin(int left, int top, uint32_t width, uint32_t height, Layout layout)
    {
        while (layout.decisions() > most_decisions)
            layout.lights.pop_back(); // these lights draw from further domains
        if (!sampler_ || !(layout == layout_)) {
            layout_ = std::move(layout);
            sampler_ = make_sampler(settings_, settings_.samples, 0, layout_.decisions());
            estimator_.reset();
        }
        left_ = left;
        top_ = top;
        width_ = width;
        height_ = height;
        size_t pixels = size_t{width} * height;
        bool estimates = settings_.mode == Settings::Mode::estimate && layout_.dims() > 0;
        uint32_t side = std::max(width, height);
        if (estimates && (!estimator_ || side > side_)) {
            side_ = side;
            estimator_ = make_estimator(settings_, layout_.dims(), side, settings_.samples);
        }
        numbers_.resize((estimator_ ? pixels : 1) * settings_.samples * layout_.dims());
        values_.resize(estimator_ ? pixels * settings_.samples * 3 : 0);
        surfaces_.assign(pixels, 0);
        sums_.assign(pixels * 3, 0.0);
    }

    bool wants_surfaces() const { return estimator_ && estimator_->needs_surfaces(); }

    void pixel(size_t pixel)
    {
        pixel_ = pixel;
        uint32_t x = static_cast<uint32_t>(left_) + static_cast<uint32_t>(pixel % width_);
        uint32_t y = static_cast<uint32_t>(top_) + static_cast<uint32_t>(pixel / width_);
        if (layout_.dims() > 0)
            sampler_->points(x, y, row(0));
        further_.move_to(x, y);
    }

    void surface(const void *object)
    {
        uint64_t key = demo::mix(reinterpret_cast<uintptr_t>(object));
        surfaces_[pixel_] = static_cast<uint32_t>(key ^ key >> 32);
    }

    // Where in the pixel, from its centre.
    void sample(uint32_t index, double offset[2])
    {
        index_ = index;
        const float *u = row(index);
        for (int d = 0; d < 2; ++d)
            offset[d] = layout_.box ? static_cast<double>(*u++) - 0.5 : 0.0;
        lens_ = layout_.lens ? u : nullptr;
        context_.begin(further_, index, layout_.lights, layout_.lens ? u + 2 : u);
    }

    Context &context() { return context_; }
    const float *lens() const { return lens_; }

    void value(const float rgb[3])
    {
        for (size_t c = 0; c < 3; ++c)
            sums_[3 * pixel_ + c] += static_cast<double>(rgb[c]);
        if (estimator_)
            std::copy_n(rgb, 3, &values_[3 * (pixel_ * settings_.samples + index_)]);
    }

    void end(float *means)
    {
        if (estimator_)
            estimator_->estimate(
                {numbers_.data(), values_.data(), surfaces_.data(), width_, height_, settings_.samples}, means);
        else
            for (size_t i = 0; i < sums_.size(); ++i)
                means[i] = static_cast<float>(sums_[i] / settings_.samples);
    }

private:
    float *row(uint32_t index)
    {
        size_t pixel = estimator_ ? pixel_ : 0;
        return numbers_.data() + (pixel * settings_.samples + index) * layout_.dims();
    }

    const Settings &settings_;
    Layout layout_;
    std::unique_ptr<demo::Sampler> sampler_;
    std::unique_ptr<demo::Estimator> estimator_; // none: the plain mean
    LazyPoints further_;
    Context context_;
    std::vector<float> numbers_, values_; // of the block if there is an estimator, else of a pixel
    std::vector<uint32_t> surfaces_;
    std::vector<double> sums_;
    const float *lens_ = nullptr;
    int left_ = 0, top_ = 0;
    uint32_t width_ = 0, height_ = 0, side_ = 0, index_ = 0;
    size_t pixel_ = 0;
};

} // namespace noisefloor_povray
