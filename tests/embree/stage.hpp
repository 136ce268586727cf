// Puts meshes into a scene.
#pragma once

#include "mesh.hpp"
#include "pathtracer/builder.hpp"

namespace harness {

using demo::Color;
using demo::Scene;

inline void add(demo::Geometry &geometry, const Mesh &mesh, uint32_t material, Vector motion = {})
{
    for (const Facet &f : mesh.facets)
        geometry.triangles.push_back(
            {{f.corner[0], f.corner[1], f.corner[2]}, {f.normal[0], f.normal[1], f.normal[2]}, material, -1, motion});
}

class Stage : public demo::Builder {
public:
    explicit Stage(Scene &scene) : Builder(scene), scene_(scene) {}

    void put(const Mesh &mesh, uint32_t material, const Transform &place = {}, Vector motion = {})
    {
        add(scene_.geometry, place * mesh, material, motion);
    }

    // One light of all the mesh's triangles.
    void lamp(const Mesh &mesh, Color radiance, const Transform &place = {})
    {
        size_t first = triangles();
        put(mesh, material({}), place);
        shine(first, radiance);
    }

private:
    Scene &scene_;
};

} // namespace harness
