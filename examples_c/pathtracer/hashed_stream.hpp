// Numbers for what the sample vector has none for.
#pragma once

#include "random.hpp"
#include <cstring>

namespace demo {

// Numbers beyond the sample vector: a hash of it, which is uniform wherever the vector is, and of the pixel. Of the
// vector alone it would repeat: in noisefloor's first two samples pixels 32 apart have the same.
class HashedStream {
public:
    HashedStream(uint32_t x, uint32_t y, const float *u, uint32_t count)
        : pixel_(uint64_t{y} << 32 | x), u_(u), count_(count)
    {
    }

    float next()
    {
        if (count_ > 0)
            start();
        return unit(static_cast<uint32_t>(stream_.bits() >> 32));
    }
    const float *draw(float *to, uint32_t count)
    {
        for (uint32_t i = 0; i < count; ++i)
            to[i] = next();
        return to;
    }

private:
    void start()
    {
        uint64_t key = mix(pixel_);
        for (uint32_t i = 0; i < count_; ++i) {
            uint32_t bits;
            std::memcpy(&bits, u_ + i, sizeof bits);
            key = mix((key + golden) ^ bits);
        }
        stream_ = SplitMix(key);
        count_ = 0;
    }

    uint64_t pixel_;
    const float *u_;
    uint32_t count_; // 0 once the stream is made: most paths end before
    SplitMix stream_{0};
};

} // namespace demo
