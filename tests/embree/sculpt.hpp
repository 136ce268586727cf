// Rounded bodies: solids blended smoothly into each other, given by signed distances, and turned into meshes.
#pragma once

#include "mesh.hpp"
#include <functional>
#include <limits>

namespace harness {

using Field = std::function<float(Vector)>; // negative inside
// The field within a ball: parts that do not matter there are left out.
using LocalField = std::function<Field(Vector center, float radius)>;

// Blends two distances over the width k (Quilez's polynomial smooth minimum).
inline float blend(float a, float b, float k)
{
    float h = std::max(k - std::abs(a - b), 0.0f) / k;
    return std::min(a, b) - 0.25f * h * h * k;
}

// Limbs: balls of two radii and all between them; and egg shapes.
class Body {
public:
    explicit Body(float width) : width_(width) {}

    Body &limb(Vector from, float radius1, Vector to, float radius2)
    {
        const Vector axis = to - from;
        const float squared = dot(axis, axis), grow = radius2 - radius1;
        add(0.5f * (from + to), 0.5f * std::sqrt(squared) + std::max(radius1, radius2), [=](Vector p) {
            float t = std::min(1.0f, std::max(0.0f, dot(p - from, axis) / squared));
            return length(p - (from + t * axis)) - (radius1 + t * grow);
        });
        return *this;
    }
    // A chain of limbs.
    Body &limbs(const std::vector<std::pair<Vector, float>> &joints)
    {
        for (size_t i = 0; i + 1 < joints.size(); ++i)
            limb(joints[i].first, joints[i].second, joints[i + 1].first, joints[i + 1].second);
        return *this;
    }
    Body &egg(Vector center, Vector radii, float degrees = 0, Vector axis = {0, 0, 1})
    {
        Transform back = turn(axis, -degrees);
        add(center, std::max(radii.x, std::max(radii.y, radii.z)), [=](Vector p) {
            Vector q = back.direction(p - center), r = q * Vector{1 / radii.x, 1 / radii.y, 1 / radii.z};
            Vector s = r * Vector{1 / radii.x, 1 / radii.y, 1 / radii.z};
            float k = length(r), slope = length(s);
            return slope > 0 ? k * (k - 1) / slope : -std::min(radii.x, std::min(radii.y, radii.z));
        });
        return *this;
    }
    // The same again, mirrored at z = 0.
    Body &mirrored(size_t last)
    {
        for (size_t i = parts_.size() - last, end = parts_.size(); i < end; ++i) {
            Field part = parts_[i];
            Vector center = bounds_[i].center;
            add({center.x, center.y, -center.z}, bounds_[i].radius, [=](Vector p) { return part({p.x, p.y, -p.z}); });
        }
        return *this;
    }

    float operator()(Vector p) const
    {
        float sum = std::numeric_limits<float>::max();
        for (const Field &part : parts_)
            sum = blend(sum, part(p), width_);
        return sum;
    }

    // What matters within a ball. A distance changes no faster than its point, and beyond the blend's width it changes
    // nothing.
    Body near(Vector center, float radius) const
    {
        float least = std::numeric_limits<float>::max();
        std::vector<float> bounds;
        for (const Bound &bound : bounds_) {
            float distance = length(center - bound.center);
            bounds.push_back(distance - bound.radius);
            if (bounds.back() < least)
                least = std::min(least, parts_[bounds.size() - 1](center));
        }
        Body body(width_);
        for (size_t i = 0; i < parts_.size(); ++i)
            if (bounds[i] < least + 2 * (radius + width_))
                body.add(bounds_[i].center, bounds_[i].radius, parts_[i]);
        return body;
    }

private:
    struct Bound {
        Vector center;
        float radius;
    };

    void add(Vector center, float radius, Field part)
    {
        bounds_.push_back({center, radius});
        parts_.push_back(std::move(part));
    }

    float width_;
    std::vector<Bound> bounds_; // balls around the parts
    std::vector<Field> parts_;
};

// Naive surface nets (Gibson 1998): a point in every cell that the surface crosses, moved onto it. `cell` is the cells'
// size.
inline Mesh sculpt(const LocalField &local, Vector low, Vector high, float cell)
{
    constexpr size_t block = 8;
    size_t blocks[3], size[3];
    for (int axis = 0; axis < 3; ++axis) {
        blocks[axis] = static_cast<size_t>((high[axis] - low[axis]) / cell) / block + 1;
        size[axis] = blocks[axis] * block + 1;
    }
    auto at = [&](size_t i, size_t j, size_t k) { return (k * size[1] + j) * size[0] + i; };
    auto point = [&](size_t i, size_t j, size_t k) {
        return low + cell * Vector{static_cast<float>(i), static_cast<float>(j), static_cast<float>(k)};
    };
    // Blocks far from the surface get their centre's value, and no field.
    std::vector<float> value(size[0] * size[1] * size[2], std::numeric_limits<float>::max());
    std::vector<Field> fields(blocks[0] * blocks[1] * blocks[2]);
    auto field_of = [&](size_t i, size_t j, size_t k) -> Field & {
        return fields[(k / block * blocks[1] + j / block) * blocks[0] + i / block];
    };
    const float radius = 0.9f * static_cast<float>(block) * cell; // half the diagonal, and a little
    for (size_t z = 0; z + 1 < size[2]; z += block)
        for (size_t y = 0; y + 1 < size[1]; y += block)
            for (size_t x = 0; x + 1 < size[0]; x += block) {
                const Vector middle = point(x + block / 2, y + block / 2, z + block / 2);
                Field field = local(middle, radius);
                const float center = field(middle);
                const bool far = std::abs(center) > 1.4f * radius; // distances of eggs are inexact
                for (size_t k = z; k <= z + block; ++k)
                    for (size_t j = y; j <= y + block; ++j)
                        for (size_t i = x; i <= x + block; ++i)
                            if (!far)
                                value[at(i, j, k)] = field(point(i, j, k));
                            else if (value[at(i, j, k)] == std::numeric_limits<float>::max())
                                value[at(i, j, k)] = center;
                if (!far)
                    field_of(x, y, z) = std::move(field);
            }
    auto gradient = [&](const Field &field, Vector p) {
        const float h = 0.5f * cell;
        return Vector{field(p + Vector{h, 0, 0}) - field(p - Vector{h, 0, 0}),
                      field(p + Vector{0, h, 0}) - field(p - Vector{0, h, 0}),
                      field(p + Vector{0, 0, h}) - field(p - Vector{0, 0, h})} /
               (2 * h);
    };
    std::vector<uint32_t> index(value.size(), ~0u);
    std::vector<Vector> points, normals;
    for (size_t k = 0; k + 1 < size[2]; ++k)
        for (size_t j = 0; j + 1 < size[1]; ++j)
            for (size_t i = 0; i + 1 < size[0]; ++i) {
                const Field &field = field_of(i, j, k);
                if (!field)
                    continue;
                // Most cells are on one side.
                const bool inside = value[at(i, j, k)] < 0;
                bool crossed = false;
                for (size_t corner = 1; corner < 8 && !crossed; ++corner)
                    crossed = (value[at(i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2))] < 0) != inside;
                if (!crossed)
                    continue;
                Vector sum;
                int crossings = 0;
                for (size_t edge = 0; edge < 12; ++edge) {
                    size_t a[3] = {i, j, k};
                    const size_t axis = edge / 4;
                    a[(axis + 1) % 3] += edge & 1;
                    a[(axis + 2) % 3] += edge >> 1 & 1;
                    size_t b[3] = {a[0], a[1], a[2]};
                    ++b[axis];
                    float u = value[at(a[0], a[1], a[2])], v = value[at(b[0], b[1], b[2])];
                    if ((u < 0) == (v < 0))
                        continue;
                    Vector p = point(a[0], a[1], a[2]), q = point(b[0], b[1], b[2]);
                    sum += p + u / (u - v) * (q - p);
                    ++crossings;
                }
                if (!crossings)
                    continue;
                Vector p = sum / static_cast<float>(crossings), g = gradient(field, p);
                float slope = std::max(0.25f, dot(g, g)), step = field(p) / slope;
                p = p - std::min(0.5f * cell, std::max(-0.5f * cell, step)) * g;
                index[at(i, j, k)] = static_cast<uint32_t>(points.size());
                points.push_back(p);
                normals.push_back(demo::normalize(gradient(field, p) + Vector{0, 1e-12f, 0}));
            }
    Mesh mesh;
    auto facet = [&](uint32_t a, uint32_t b, uint32_t c) {
        mesh.facets.push_back({{points[a], points[b], points[c]}, {normals[a], normals[b], normals[c]}});
    };
    // A quadrilateral around every edge of the grid that the surface crosses.
    for (size_t k = 1; k + 1 < size[2]; ++k)
        for (size_t j = 1; j + 1 < size[1]; ++j)
            for (size_t i = 1; i + 1 < size[0]; ++i)
                for (size_t axis = 0; axis < 3; ++axis) {
                    // Cells without a point have no surface around them.
                    if (index[at(i, j, k)] == ~0u)
                        break;
                    size_t next[3] = {i, j, k};
                    ++next[axis];
                    bool inside = value[at(i, j, k)] < 0;
                    if (inside == (value[at(next[0], next[1], next[2])] < 0))
                        continue;
                    auto beside = [&](size_t da, size_t db) {
                        size_t c[3] = {i, j, k};
                        c[(axis + 1) % 3] -= da;
                        c[(axis + 2) % 3] -= db;
                        return index[at(c[0], c[1], c[2])];
                    };
                    uint32_t a = beside(1, 1), b = beside(0, 1), c = beside(0, 0), d = beside(1, 0);
                    if (std::max(std::max(a, b), std::max(c, d)) == ~0u)
                        continue; // cut by the grid's end
                    if (!inside)
                        std::swap(b, d);
                    facet(a, b, c);
                    facet(a, c, d);
                }
    return mesh;
}

inline Mesh sculpt(const Body &body, Vector low, Vector high, float cell)
{
    return sculpt([&](Vector center, float radius) { return Field(body.near(center, radius)); }, low, high, cell);
}

} // namespace harness
