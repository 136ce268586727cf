// Puts a scene together: materials, shapes and lights.
#pragma once

#include "scene.hpp"

namespace demo {

class Builder {
public:
    explicit Builder(Scene &scene) : scene_(scene) {}

    uint32_t material(Color diffuse, Color glossy = {}, float exponent = 0)
    {
        scene_.materials.push_back({diffuse, glossy, exponent});
        return static_cast<uint32_t>(scene_.materials.size() - 1);
    }

    // Faces cross(edge1, edge2).
    void parallelogram(Vector corner, Vector edge1, Vector edge2, uint32_t material, int32_t light = -1)
    {
        Vector n = normalize(cross(edge1, edge2)), opposite = corner + edge1 + edge2;
        scene_.geometry.triangles.push_back({{corner, corner + edge1, opposite}, {n, n, n}, material, light});
        scene_.geometry.triangles.push_back({{corner, opposite, corner + edge2}, {n, n, n}, material, light});
    }

    void sphere(Vector center, float radius, uint32_t material, Vector motion = {})
    {
        scene_.geometry.spheres.push_back({center, radius, motion, material, -1});
    }

    // A block standing at `base`, turned by `angle` around the vertical.
    void block(Vector base, Vector size, float angle, uint32_t material)
    {
        Vector x = Vector{std::cos(angle), 0, -std::sin(angle)} * size.x, y{0, size.y, 0};
        Vector z = Vector{std::sin(angle), 0, std::cos(angle)} * size.z, corner = base - 0.5f * (x + z);
        parallelogram(corner + z, x, y, material);
        parallelogram(corner + x, -x, y, material);
        parallelogram(corner + x + z, -z, y, material);
        parallelogram(corner, z, y, material);
        parallelogram(corner + y, z, x, material);
    }

    // A tube along a (2, 3) torus knot: 12,288 triangles with smooth normals.
    void knot(Vector center, float scale, uint32_t material)
    {
        constexpr int rings = 256, sides = 24;
        auto curve = [&](float t) {
            float r = 2 + std::cos(3 * t);
            return center + scale * Vector{r * std::cos(2 * t), r * std::sin(2 * t), -std::sin(3 * t)};
        };
        std::vector<Vector> points, normals;
        for (int i = 0; i < rings; ++i) {
            float t = 2 * pi * static_cast<float>(i) / rings;
            Vector spine = curve(t), tangent = normalize(curve(t + 1e-2f) - curve(t - 1e-2f));
            Vector across = normalize(cross(tangent, spine - center)), up = cross(across, tangent);
            for (int j = 0; j < sides; ++j) {
                float a = 2 * pi * static_cast<float>(j) / sides;
                Vector normal = std::cos(a) * across + std::sin(a) * up;
                points.push_back(spine + 0.62f * scale * normal);
                normals.push_back(normal);
            }
        }
        for (int i = 0; i < rings; ++i) {
            for (int j = 0; j < sides; ++j) {
                int a = i * sides + j, b = i * sides + (j + 1) % sides;
                int c = (i + 1) % rings * sides + (j + 1) % sides, d = (i + 1) % rings * sides + j;
                face(points, normals, a, b, c, material);
                face(points, normals, a, c, d, material);
            }
        }
    }

    // Smooth glass. Objects of it must be closed, their triangles facing outwards.
    uint32_t dielectric(float index)
    {
        scene_.materials.push_back({{}, {}, 0, index});
        return static_cast<uint32_t>(scene_.materials.size() - 1);
    }

    void triangle(Vector a, Vector b, Vector c, uint32_t material, int32_t light = -1)
    {
        Vector n = normalize(cross(b - a, c - a));
        scene_.geometry.triangles.push_back({{a, b, c}, {n, n, n}, material, light});
    }

    // All that was added since `first`, an earlier triangles(), moves.
    size_t triangles() const { return scene_.geometry.triangles.size(); }
    void move(size_t first, Vector motion)
    {
        for (size_t i = first; i < triangles(); ++i)
            scene_.geometry.triangles[i].motion = motion;
    }

    void area_light(Vector corner, Vector edge1, Vector edge2, Color radiance)
    {
        parallelogram(corner, edge1, edge2, material({}), next_light());
        scene_.lights.push_back(parallelogram_light(corner, edge1, edge2, radiance));
    }

    void triangle_area_light(Vector a, Vector b, Vector c, Color radiance)
    {
        triangle(a, b, c, material({}), next_light());
        scene_.lights.push_back(triangle_light(a, b - a, c - a, radiance));
    }

    void sphere_light(Vector center, float radius, Color radiance)
    {
        scene_.geometry.spheres.push_back({center, radius, {}, material({}), next_light()});
        scene_.lights.push_back(demo::sphere_light(center, radius, radiance));
    }

    // Makes one light of all triangles that were added since `first`. They shine beside what their material reflects.
    void shine(size_t first, Color radiance)
    {
        std::vector<LightTriangle> shining;
        for (size_t i = first; i < triangles(); ++i) {
            Triangle &t = scene_.geometry.triangles[i];
            shining.emplace_back(t.corner[0], t.corner[1] - t.corner[0], t.corner[2] - t.corner[0]);
            t.light = next_light();
        }
        scene_.lights.push_back(mesh_light(std::move(shining), radiance));
    }

    void environment(std::shared_ptr<const Environment> map)
    {
        scene_.lights.push_back(environment_light(std::move(map)));
    }

private:
    int32_t next_light() const { return static_cast<int32_t>(scene_.lights.size()); }

    void face(const std::vector<Vector> &p, const std::vector<Vector> &n, int a, int b, int c, uint32_t material)
    {
        scene_.geometry.triangles.push_back({{p[a], p[b], p[c]}, {n[a], n[b], n[c]}, material, -1});
    }

    Scene &scene_;
};

} // namespace demo
