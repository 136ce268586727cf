// One ray and all that follows from it: which numbers its decisions get.
#pragma once

#include "points.hpp"
#include <algorithm>
#include <vector>

namespace noisefloor_povray {

// The first point at which a light of the scene is asked for gets numbers of its own, which are the same decision in
// all of a pixel's samples; further points (behind a mirror, in a medium) get whatever domain is next.
class Context {
public:
    // numbers: two for each of `lights`, or NULL. They and the points must outlive the ray.
    void begin(LazyPoints &points, uint32_t index, const std::vector<const void *> &lights, const float *numbers)
    {
        points_ = &points;
        index_ = index;
        numbers_ = numbers;
        next_ = 0;
        uses_.clear();
        if (numbers)
            for (const void *light : lights)
                uses_.push_back({light, false, {}, {}});
    }

    void light(const void *light, const double point[3], double u[2])
    {
        auto use = std::find_if(uses_.begin(), uses_.end(), [&](const Use &other) { return other.light == light; });
        // The layers of one surface, and shading and shadow, ask again.
        if (use == uses_.end() || !use->used || !std::equal(point, point + 3, use->point)) {
            const float *numbers = nullptr;
            if (use == uses_.end())
                use = uses_.insert(use, {light, true, {}, {}});
            else if (!use->used)
                numbers = numbers_ + 2 * (use - uses_.begin());
            if (!numbers)
                numbers = points_->at(next_++, index_);
            use->used = true;
            std::copy_n(point, 3, use->point);
            std::copy_n(numbers, 2, use->u);
        }
        std::copy_n(use->u, 2, u);
    }

    // A further domain's numbers.
    const float *draw() { return points_->at(next_++, index_); }

private:
    struct Use {
        const void *light;
        bool used;
        double point[3], u[2];
    };

    LazyPoints *points_ = nullptr;
    const float *numbers_ = nullptr;
    uint32_t index_ = 0, next_ = 0;
    std::vector<Use> uses_;
};

} // namespace noisefloor_povray
