// Numbers for what the sample vector has none for.
#pragma once

#include "random.hpp"
#include <cstring>

namespace demo {

// Numbers beyond the sample vector: a hash of it, which is uniform wherever the vector is.
class HashedStream {
public:
    HashedStream(const float *u, uint32_t count) : u_(u), count_(count) {}

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
        uint64_t key = 0;
        for (uint32_t i = 0; i < count_; ++i) {
            uint32_t bits;
            std::memcpy(&bits, u_ + i, sizeof bits);
            key = mix((key + golden) ^ bits);
        }
        stream_ = SplitMix(key);
        count_ = 0;
    }

    const float *u_;
    uint32_t count_; // 0 once the stream is made: most paths end before
    SplitMix stream_{0};
};

} // namespace demo
