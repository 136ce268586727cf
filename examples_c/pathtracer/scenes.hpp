// The demo's scenes, all in one box: x in [-1, 1], y (up) in [0, 2], z in [-1, 1], open towards the camera.
#pragma once

#include "scene.hpp"
#include <string>

namespace demo {

inline const char *const scene_names[5] = {"direct", "motion", "lens", "lights", "global"};

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

    void area_light(Vector corner, Vector edge1, Vector edge2, Color radiance)
    {
        Light light{Light::parallelogram, corner, edge1, edge2, normalize(cross(edge1, edge2)), 0, radiance};
        parallelogram(corner, edge1, edge2, material({}), static_cast<int32_t>(scene_.lights.size()));
        scene_.lights.push_back(light);
    }

    void sphere_light(Vector center, float radius, Color radiance)
    {
        int32_t index = static_cast<int32_t>(scene_.lights.size());
        scene_.geometry.spheres.push_back({center, radius, {}, material({}), index});
        scene_.lights.push_back({Light::sphere, center, {}, {}, {}, radius, radiance});
    }

    void walls()
    {
        uint32_t white = material({.73f, .71f, .68f}), red = material({.63f, .09f, .07f}), green = material({.14f, .45f, .11f});
        uint32_t floor = material({.6f, .58f, .55f}, {.15f, .15f, .15f}, 30);
        parallelogram({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, floor);
        parallelogram({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}, white);
        parallelogram({-1, 0, -1}, {2, 0, 0}, {0, 2, 0}, white);
        parallelogram({-1, 0, 1}, {0, 0, -2}, {0, 2, 0}, red);
        parallelogram({1, 0, -1}, {0, 0, 2}, {0, 2, 0}, green);
    }

private:
    void face(const std::vector<Vector> &p, const std::vector<Vector> &n, int a, int b, int c, uint32_t material)
    {
        scene_.geometry.triangles.push_back({{p[a], p[b], p[c]}, {n[a], n[b], n[c]}, material, -1});
    }

    Scene &scene_;
};

inline void furnish(Builder &builder)
{
    builder.walls();
    builder.block({-.42f, 0, -.42f}, {.52f, 1.1f, .52f}, .32f, builder.material({.7f, .68f, .64f}));
    builder.knot({.38f, .44f, .08f}, .138f, builder.material({.5f, .33f, .1f}, {.35f, .3f, .2f}, 40));
    builder.sphere({-.48f, .24f, .48f}, .24f, builder.material({.12f, .2f, .42f}, {.4f, .4f, .4f}, 60));
}

// False if there is no scene of that name.
inline bool make_scene(const std::string &name, float aspect, Scene &scene)
{
    Builder builder(scene);
    scene.camera.look({0, 1, 4.2f}, {0, .95f, 0}, 36, aspect);
    if (name == "direct") {
        scene.layout = Layout::direct;
        furnish(builder);
        builder.area_light({-.35f, 1.98f, -.35f}, {.7f, 0, 0}, {0, 0, .7f}, {16, 14.5f, 12});
    } else if (name == "motion") {
        scene.layout = Layout::motion;
        builder.walls();
        builder.knot({.42f, .44f, -.3f}, .138f, builder.material({.5f, .33f, .1f}, {.35f, .3f, .2f}, 40));
        builder.sphere({-.62f, .3f, .2f}, .3f, builder.material({.12f, .2f, .42f}, {.4f, .4f, .4f}, 60), {.5f, .12f, .1f});
        builder.sphere_light({-.1f, 1.6f, .3f}, .2f, {26, 24, 21});
    } else if (name == "lens") {
        scene.layout = Layout::lens;
        scene.camera.look({.1f, .75f, 2.9f}, {-.05f, .5f, 0}, 34, aspect);
        scene.camera.aperture = .12f;
        scene.camera.focus = 2.4f; // the blue sphere's distance
        furnish(builder);
        builder.area_light({-.35f, 1.98f, -.35f}, {.7f, 0, 0}, {0, 0, .7f}, {16, 14.5f, 12});
    } else if (name == "lights") {
        scene.layout = Layout::lights;
        furnish(builder);
        // Four panels at the ceiling, one lamp at the back, one near the floor.
        const Color colors[4] = {{18, 13, 9}, {9, 14, 19}, {13, 13, 13}, {17, 9, 13}};
        for (int i = 0; i < 4; ++i) {
            Vector corner{i % 2 ? .35f : -.75f, 1.98f, i / 2 ? .2f : -.7f};
            builder.area_light(corner, {.4f, 0, 0}, {0, 0, .4f}, colors[i]);
        }
        builder.area_light({.3f, 1.25f, -.98f}, {.45f, 0, 0}, {0, .25f, 0}, {10, 8, 5});
        builder.sphere_light({.05f, .16f, .62f}, .1f, {12, 10, 7});
    } else if (name == "global") {
        scene.layout = Layout::global;
        furnish(builder);
        builder.area_light({-.3f, 1.98f, -.3f}, {.6f, 0, 0}, {0, 0, .6f}, {12, 11, 9.5f});
        builder.area_light({-.98f, 1.1f, .75f}, {0, 0, -.35f}, {0, .35f, 0}, {5, 6.5f, 9});
    } else {
        return false;
    }
    return true;
}

} // namespace demo
