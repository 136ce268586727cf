// Sobol's sequence in up to four dimensions, scrambled as Owen (1995) proposed: the best known points that need no
// tables.
#pragma once

#include "random.hpp"

namespace demo {

constexpr uint32_t sobol_dims = 4;

// The generator matrices' columns, from the direction numbers of Joe and Kuo (2008).
class Sobol {
public:
    Sobol()
    {
        struct Polynomial {
            uint32_t degree, coefficients, first[3];
        };
        const Polynomial polynomials[sobol_dims] = {{0, 0, {}}, {1, 0, {1}}, {2, 1, {1, 3}}, {3, 1, {1, 3, 1}}};
        for (uint32_t d = 0; d < sobol_dims; ++d) {
            const Polynomial &p = polynomials[d];
            for (uint32_t k = 0; k < 32; ++k) {
                if (p.degree == 0) {
                    columns_[d][k] = 0x80000000u >> k; // van der Corput's sequence
                } else if (k < p.degree) {
                    columns_[d][k] = p.first[k] << (31 - k);
                } else {
                    uint32_t value = columns_[d][k - p.degree] ^ columns_[d][k - p.degree] >> p.degree;
                    for (uint32_t j = 1; j < p.degree; ++j)
                        if (p.coefficients >> (p.degree - 1 - j) & 1)
                            value ^= columns_[d][k - j];
                    columns_[d][k] = value;
                }
            }
        }
    }

    // The binary digits of coordinate d of a point; the first is the highest bit.
    uint32_t digits(uint32_t index, uint32_t d) const
    {
        uint32_t value = 0;
        for (uint32_t k = 0; index != 0; index >>= 1, ++k)
            value ^= columns_[d][k] & (0u - (index & 1)); // without a branch that no one can predict
        return value;
    }

private:
    uint32_t columns_[sobol_dims][32];
};

// One random bit for each node of a binary tree; the root is node 1, the children of node i are 2 i and 2 i + 1.
class Tree {
public:
    // Any keys, even such as differ by `golden`, which trees' words are apart.
    explicit Tree(uint64_t key = 0) : key_(mix(key)), top_(mix(key_)), leaves_(mix(~key_)) {}

    uint32_t flip(uint32_t node) const
    {
        uint64_t word = node < 64 ? top_ : mix(key_ + (node >> 6) * golden);
        return static_cast<uint32_t>(word >> (node & 63)) & 1;
    }
    // 32 random bits.
    uint32_t leaf(uint32_t node) const { return static_cast<uint32_t>(mix(leaves_ + node * golden)); }

private:
    uint64_t key_;
    uint64_t top_;    // the bits of nodes 1 to 63
    uint64_t leaves_; // the leaves' key
};

// Owen's nested scrambling for the first 2^levels points of a sequence: each digit is flipped or not depending on all
// digits before it. No two of these points share their first `levels` digits, so that their further digits are
// independent.
inline uint32_t scramble(uint32_t digits, uint32_t levels, const Tree &tree)
{
    uint32_t node = 1, flips = 0;
    for (uint32_t level = 0; level < levels; ++level) {
        flips = flips << 1 | tree.flip(node);
        node = node << 1 | (digits >> (31 - level) & 1);
    }
    if (levels == 0)
        return tree.leaf(node);
    uint32_t high = (digits >> (32 - levels) ^ flips) << (32 - levels);
    return high | tree.leaf(node) >> levels;
}

// The same for the digits of an index from the lowest up: an order of the sequence in which every aligned block of 2^k
// points remains one. Different keys give orders that have nothing to do with each other.
inline uint32_t shuffle(uint32_t index, uint32_t levels, const Tree &tree)
{
    uint32_t flips = 0;
    for (uint32_t level = 0; level < levels; ++level)
        flips |= tree.flip(1u << level | (index & ((1u << level) - 1))) << level;
    return index ^ flips;
}

} // namespace demo
