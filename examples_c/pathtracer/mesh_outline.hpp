// What a mesh sends into a lobe with nothing between: the sum of its triangles' light, by fewer edges. Where two
// triangles meet that both face a point, or neither does, their terms cancel: outlines are left.
#pragma once

#include "irradiance.hpp"
#include <array>
#include <map>
#include <vector>

namespace demo {

class MeshOutline {
public:
    // The light, a mesh, must outlive it.
    explicit MeshOutline(const Light &light) : light_(light)
    {
        Vector low = light.triangles[0].origin, high = low;
        for (const LightTriangle &t : light.triangles) {
            for (Vector corner : {t.origin, t.origin + t.edge1, t.origin + t.edge2}) {
                low = minimum(low, corner);
                high = maximum(high, corner);
            }
        }
        center_ = 0.5f * (low + high);
        radius_ = length(high - low) / 2;
        for (const LightTriangle &t : light.triangles) {
            const Vector64 corner = t.origin, edge1 = t.edge1, edge2 = t.edge2;
            add(corner, edge1);
            add(corner + edge1, edge2 - edge1);
            add(corner + edge2, -1 * edge2);
            planes_.push_back({t.normal, dot(t.normal, corner)});
        }
        open_.clear();
    }

    // As demo::received.
    double received(Vector from, const Lobe &lobe) const
    {
        const Vector64 axis = lobe.axis, origin = from, to = Vector64(center_) - from;
        const double height = dot(axis, to);
        if (height < -radius_)
            return 0;
        // Where the horizon cuts, angles along it are counted from the middle: that must not be right above.
        const Vector64 ahead = to - height * axis, aside = cross(axis, ahead);
        if (height < radius_ && dot(ahead, ahead) <= radius_ * radius_)
            return demo::received(light_, from, lobe);
        std::vector<char> faces;
        for (const Plane &plane : planes_)
            faces.push_back(dot(plane.normal, origin) > plane.offset);
        double sum = 0;
        for (const Edge &edge : edges_) {
            const int sign = faces[edge.left] - (edge.right < faces.size() ? faces[edge.right] : 0);
            if (sign == 0)
                continue;
            Vector64 corner = edge.corner - origin, along = edge.along;
            double below = dot(axis, corner), rise = dot(axis, along), above = below + rise;
            if (below < 0 && above < 0)
                continue;
            corner = corner + (lobe.width - 1) * below * axis;
            along = along + (lobe.width - 1) * rise * axis;
            if (below < 0 || above < 0) {
                const double at = below / (below - above);
                const Vector64 crossing = corner + at * along;
                const double angle = std::atan2(dot(crossing, aside), dot(crossing, ahead));
                sum += sign * (below < 0 ? angle : -angle);
                corner = below < 0 ? crossing : corner;
                along = (below < 0 ? 1 - at : at) * along;
            }
            sum += sign * edge_term(corner, corner + along, along, axis);
        }
        return std::abs(sum) / 2 / static_cast<double>(pi);
    }

private:
    struct Plane {
        Vector64 normal;
        double offset;
    };
    // Of the triangle at its left, and of that at its right; none: a border.
    struct Edge {
        Vector64 corner, along;
        size_t left, right;
    };
    using Key = std::array<long, 6>;

    // Of the next triangle, in its order. Corners are the same where they agree to a millionth. Where rounding says
    // otherwise, two borders are kept, whose terms cancel.
    void add(Vector64 corner, Vector64 along)
    {
        const Vector64 next = corner + along;
        Key there = key(corner, next), back = key(next, corner);
        auto found = open_.find(back);
        if (found != open_.end()) {
            edges_[found->second].right = planes_.size();
            open_.erase(found);
            return;
        }
        open_.emplace(there, edges_.size());
        edges_.push_back({corner, along, planes_.size(), ~size_t{0}});
    }

    Key key(Vector64 a, Vector64 b) const
    {
        const double scale = 1e6 / radius_;
        auto round = [&](double x, float middle) { return std::lround((x - static_cast<double>(middle)) * scale); };
        return {round(a.x, center_.x), round(a.y, center_.y), round(a.z, center_.z),
                round(b.x, center_.x), round(b.y, center_.y), round(b.z, center_.z)};
    }

    const Light &light_;
    Vector center_;
    double radius_;
    std::vector<Plane> planes_; // of the triangles
    std::vector<Edge> edges_;
    std::multimap<Key, size_t> open_; // edges whose right is not known yet
};

} // namespace demo
