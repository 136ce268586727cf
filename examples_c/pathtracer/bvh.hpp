// The demo's own intersector: a bounding volume hierarchy over triangles and spheres; boxes hold all of a motion.
#pragma once

#include "intersector.hpp"
#include <limits>
#include <numeric>

namespace demo {

class Bvh final : public Intersector {
public:
    explicit Bvh(const Geometry &geometry) : geometry_(geometry)
    {
        size_t count = geometry.triangles.size() + geometry.spheres.size();
        order_.resize(count);
        std::iota(order_.begin(), order_.end(), 0u);
        std::vector<Box> boxes(count);
        for (size_t i = 0; i < count; ++i)
            boxes[i] = bounds(static_cast<uint32_t>(i));
        nodes_.reserve(2 * count + 1);
        nodes_.emplace_back();
        split(0, 0, static_cast<uint32_t>(count), 0, boxes);
    }

    bool closest(const Ray &ray, Hit &hit) const override
    {
        Candidate best{std::numeric_limits<float>::infinity(), 0, 0, 0};
        traverse(ray, best, false);
        if (best.distance == std::numeric_limits<float>::infinity())
            return false;
        hit.distance = best.distance;
        if (best.primitive < geometry_.triangles.size())
            describe(geometry_.triangles[best.primitive], best.b1, best.b2, hit);
        else
            describe(geometry_.spheres[best.primitive - geometry_.triangles.size()], ray, hit);
        return true;
    }

    bool occluded(const Ray &ray, float distance) const override
    {
        Candidate best{distance, 0, 0, 0};
        return traverse(ray, best, true);
    }

private:
    struct Box {
        Vector low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};
        static constexpr float infinity = std::numeric_limits<float>::infinity();

        void add(const Box &o) { low = minimum(low, o.low); high = maximum(high, o.high); }
        float half_area() const
        {
            Vector d = high - low;
            return d.x * d.y + d.y * d.z + d.z * d.x;
        }
    };
    struct Node {
        Box box;
        uint32_t first = 0; // the first child (the other follows it) or the first entry in order_
        uint32_t count = 0; // 0 for an inner node
    };
    struct Candidate {
        float distance;
        uint32_t primitive;
        float b1, b2; // barycentric
    };

    Box bounds(uint32_t primitive) const
    {
        Box box;
        if (primitive < geometry_.triangles.size()) {
            const Triangle &triangle = geometry_.triangles[primitive];
            for (Vector corner : triangle.corner) {
                Vector end = corner + triangle.motion;
                box.add({minimum(corner, end), maximum(corner, end)});
            }
        } else {
            const Sphere &sphere = geometry_.spheres[primitive - geometry_.triangles.size()];
            Vector r{sphere.radius, sphere.radius, sphere.radius}, end = sphere.center + sphere.motion;
            box.add({sphere.center - r, sphere.center + r});
            box.add({end - r, end + r});
        }
        return box;
    }

    static Vector center(const Box &box) { return 0.5f * (box.low + box.high); }

    // By the surface area heuristic. It can cut one off at a time: deep down nodes are halved, so that the depth is
    // bounded, and with it the stack of traverse(): 2^32 primitives are leaves after 31 halvings.
    static constexpr uint32_t heuristic_depth = 60, most_depth = heuristic_depth + 31;

    void split(uint32_t index, uint32_t begin, uint32_t end, uint32_t depth, const std::vector<Box> &boxes)
    {
        Box box, centers;
        for (uint32_t i = begin; i < end; ++i) {
            box.add(boxes[order_[i]]);
            centers.add({center(boxes[order_[i]]), center(boxes[order_[i]])});
        }
        nodes_[index].box = box;
        Vector extent = centers.high - centers.low;
        int axis = extent.x > extent.y ? (extent.x > extent.z ? 0 : 2) : (extent.y > extent.z ? 1 : 2);
        uint32_t count = end - begin;
        if (count <= 2 || extent[axis] <= 0) {
            nodes_[index].first = begin;
            nodes_[index].count = count;
            return;
        }
        const uint32_t cut = depth < heuristic_depth
                                 ? cheapest_cut(begin, end, axis, centers.low[axis], extent[axis], boxes)
                                 : begin + count / 2;
        uint32_t child = static_cast<uint32_t>(nodes_.size());
        nodes_.resize(child + 2);
        nodes_[index].first = child;
        split(child, begin, cut, depth + 1, boxes);
        split(child + 1, cut, end, depth + 1, boxes);
    }

    // Over 16 bins along an axis on which the centres lie from `low` to `low + extent`. Parts the entries.
    uint32_t cheapest_cut(uint32_t begin, uint32_t end, int axis, float low, float extent,
                          const std::vector<Box> &boxes)
    {
        constexpr int bins = 16;
        auto bin = [&](uint32_t i) {
            return std::min(bins - 1, static_cast<int>((center(boxes[i])[axis] - low) / extent * bins));
        };
        Box bin_box[bins];
        uint32_t bin_count[bins] = {};
        for (uint32_t i = begin; i < end; ++i) {
            bin_box[bin(order_[i])].add(boxes[order_[i]]);
            ++bin_count[bin(order_[i])];
        }
        int best = 1;
        float best_cost = std::numeric_limits<float>::infinity();
        for (int cut = 1; cut < bins; ++cut) {
            Box side[2];
            float in_side[2] = {0, 0};
            for (int i = 0; i < bins; ++i) {
                side[i >= cut].add(bin_box[i]);
                in_side[i >= cut] += static_cast<float>(bin_count[i]);
            }
            if (in_side[0] == 0 || in_side[1] == 0)
                continue;
            float cost = side[0].half_area() * in_side[0] + side[1].half_area() * in_side[1];
            if (cost < best_cost) {
                best_cost = cost;
                best = cut;
            }
        }
        auto middle =
            std::partition(order_.begin() + begin, order_.begin() + end, [&](uint32_t i) { return bin(i) < best; });
        return static_cast<uint32_t>(middle - order_.begin());
    }

    // With `any`, stops at the first hit nearer than best.distance.
    bool traverse(const Ray &ray, Candidate &best, bool any) const
    {
        Vector inverse{1 / ray.direction.x, 1 / ray.direction.y, 1 / ray.direction.z};
        uint32_t stack[most_depth + 1]; // a sibling of each node on the way, and both children of the last
        int top = 0;
        if (!order_.empty()) // else the root is no leaf, and has no children
            stack[top++] = 0;
        bool found = false;
        while (top > 0) {
            const Node &node = nodes_[stack[--top]];
            if (enter(node.box, ray.origin, inverse) >= best.distance)
                continue;
            if (node.count == 0) {
                // The nearer child is looked at first: it may hide the other.
                float a = enter(nodes_[node.first].box, ray.origin, inverse);
                float b = enter(nodes_[node.first + 1].box, ray.origin, inverse);
                bool swapped = b < a;
                if (std::max(a, b) < best.distance)
                    stack[top++] = node.first + (swapped ? 0 : 1);
                if (std::min(a, b) < best.distance)
                    stack[top++] = node.first + (swapped ? 1 : 0);
                continue;
            }
            for (uint32_t i = node.first; i < node.first + node.count; ++i) {
                uint32_t primitive = order_[i];
                bool hit = primitive < geometry_.triangles.size() ? triangle(primitive, ray, best)
                                                                  : sphere(primitive, ray, best);
                found = found || hit;
                if (hit && any)
                    return true;
            }
        }
        return found;
    }

    // Where the ray enters the box; infinity if it misses it. A ray that runs in a face's plane makes 0 * infinity
    // there, which is not a number: std::max and std::min then keep their first argument, so that such a face decides
    // nothing.
    static float enter(const Box &box, Vector origin, Vector inverse)
    {
        float near = 0, far = Box::infinity;
        for (int axis = 0; axis < 3; ++axis) {
            const bool backwards = std::signbit(inverse[axis]);
            near = std::max(near, ((backwards ? box.high : box.low)[axis] - origin[axis]) * inverse[axis]);
            far = std::min(far, ((backwards ? box.low : box.high)[axis] - origin[axis]) * inverse[axis]);
        }
        return near <= far * 1.00001f ? near : Box::infinity;
    }

    // Möller and Trumbore 1997.
    bool triangle(uint32_t primitive, const Ray &ray, Candidate &best) const
    {
        const Triangle &t = geometry_.triangles[primitive];
        Vector e1 = t.corner[1] - t.corner[0], e2 = t.corner[2] - t.corner[0];
        Vector p = cross(ray.direction, e2);
        float determinant = dot(e1, p);
        if (determinant == 0)
            return false;
        float inverse = 1 / determinant;
        Vector s = ray.origin - (t.corner[0] + ray.time * t.motion);
        float b1 = dot(s, p) * inverse;
        Vector q = cross(s, e1);
        float b2 = dot(ray.direction, q) * inverse;
        float distance = dot(e2, q) * inverse;
        if (!(b1 >= 0 && b2 >= 0 && b1 + b2 <= 1 && distance > 0 && distance < best.distance))
            return false;
        best = {distance, primitive, b1, b2};
        return true;
    }

    bool sphere(uint32_t primitive, const Ray &ray, Candidate &best) const
    {
        const Sphere &s = geometry_.spheres[primitive - geometry_.triangles.size()];
        Vector to_center = s.center + ray.time * s.motion - ray.origin;
        float along = dot(to_center, ray.direction);
        Vector offset = to_center - along * ray.direction; // more exact than the difference of squares
        float discriminant = s.radius * s.radius - dot(offset, offset);
        if (discriminant < 0)
            return false;
        float half = std::sqrt(discriminant);
        float distance = along - half > 0 ? along - half : along + half;
        if (!(distance > 0 && distance < best.distance))
            return false;
        best = {distance, primitive, 0, 0};
        return true;
    }

    const Geometry &geometry_;
    std::vector<uint32_t> order_; // primitives: triangles, then spheres
    std::vector<Node> nodes_;
};

} // namespace demo
