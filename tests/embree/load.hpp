// Meshes from files, by assimp: PLY, OBJ and what else it reads.
#pragma once

#include "mesh.hpp"
#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <cstdlib>
#include <stdexcept>
#include <string>

#ifndef MESH_FOLDER // the build gives the absolute path
#define MESH_FOLDER "tests/embree/meshes"
#endif

namespace harness {

// All meshes of the file as one. A file without normals gets smooth ones, which break where faces meet at more than 60
// degrees.
inline Mesh load(const std::string &path)
{
    Assimp::Importer importer;
    importer.SetPropertyFloat(AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, 60);
    importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    const aiScene *file =
        importer.ReadFile(path, aiProcess_Triangulate | aiProcess_JoinIdenticalVertices | aiProcess_GenSmoothNormals |
                                    aiProcess_PreTransformVertices | aiProcess_FindDegenerates | aiProcess_SortByPType);
    if (!file)
        throw std::runtime_error(
            "cannot load the mesh " + path + ": " + importer.GetErrorString() +
            " $NOISEFLOOR_MESHES may name the folder, which is tests/embree/meshes of the sources.");
    Mesh mesh;
    for (unsigned m = 0; m < file->mNumMeshes; ++m) {
        const aiMesh &part = *file->mMeshes[m];
        for (unsigned f = 0; f < part.mNumFaces; ++f) {
            const aiFace &face = part.mFaces[f];
            if (face.mNumIndices != 3)
                continue;
            Facet facet;
            for (int i = 0; i < 3; ++i) {
                const aiVector3D &p = part.mVertices[face.mIndices[i]], &n = part.mNormals[face.mIndices[i]];
                facet.corner[i] = {p.x, p.y, p.z};
                facet.normal[i] = {n.x, n.y, n.z};
            }
            mesh.facets.push_back(facet);
        }
    }
    if (mesh.facets.empty())
        throw std::runtime_error("the mesh " + path + " has no triangles");
    return mesh;
}

// A mesh that comes with the harness, standing, one unit high. $NOISEFLOOR_MESHES names another folder than the
// source's.
inline Mesh shipped(const std::string &name)
{
    const char *folder = std::getenv("NOISEFLOOR_MESHES");
    return standing(load((folder && *folder ? std::string(folder) : std::string(MESH_FOLDER)) + "/" + name));
}

} // namespace harness
