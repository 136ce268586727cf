// Irradiance at one point, from directions over its hemisphere: an integral over two numbers like a pixel's.
#pragma once

#include "block.hpp"

namespace noisefloor_povray {

// For one number of directions and one depth of recursion.
class Gather {
public:
    Gather(const Settings &settings, uint32_t count)
        : settings_(settings), count_(count), points_(settings, count, most_decisions)
    {
        if (settings.mode == Settings::Mode::estimate)
            estimator_ = make_estimator(settings, 2, 1, count);
    }

    uint32_t count() const { return count_; }

    // Where in space decides where in the tile, so that it depends neither on threads nor on what was gathered before.
    void begin(const double point[3])
    {
        uint64_t key = settings_.seed;
        for (int axis = 0; axis < 3; ++axis) {
            uint64_t bits;
            std::memcpy(&bits, &point[axis], sizeof bits);
            key = demo::mix(key + demo::golden + bits);
        }
        points_.move_to(static_cast<uint32_t>(key), static_cast<uint32_t>(key >> 32));
        tries_ = 0;
        numbers_.clear();
        values_.clear();
    }

    // POV-Ray asks again if the direction lies behind the surface: then the numbers are no longer uniform.
    void direction(double disc[2])
    {
        uint32_t index = tries_ % count_;
        context_.begin(points_, index, {}, nullptr);
        const float *u = context_.draw();
        for (uint32_t turn = tries_ / count_; turn > 0; --turn)
            u = context_.draw();
        ++tries_;
        last_[0] = u[0];
        last_[1] = u[1];
        concentric_disc(last_, disc);
    }

    Context &context() { return context_; }

    void value(const float rgb[3])
    {
        numbers_.insert(numbers_.end(), last_, last_ + 2);
        values_.insert(values_.end(), rgb, rgb + 3);
    }

    bool estimate(float rgb[3])
    {
        bool complete = tries_ == count_ && values_.size() == size_t{3} * count_;
        if (!estimator_ || !complete)
            return false;
        uint32_t surface = 0;
        estimator_->estimate({numbers_.data(), values_.data(), &surface, 1, 1, count_}, rgb);
        for (int c = 0; c < 3; ++c)
            rgb[c] = std::max(rgb[c], 0.0f); // it is kept and looked up again, by code that expects light
        return true;
    }

private:
    const Settings &settings_;
    uint32_t count_, tries_ = 0;
    LazyPoints points_;
    Context context_;
    std::unique_ptr<demo::Estimator> estimator_;
    std::vector<float> numbers_, values_;
    float last_[2] = {0, 0};
};

} // namespace noisefloor_povray
