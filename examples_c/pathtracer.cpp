// A small path tracer that draws from noisefloor's tiles and hands each pixel's samples to its estimators.
//
//   c++ -O2 -std=c++17 -Iinclude examples_c/pathtracer.cpp target/noisefloor/libnoisefloor.a -pthread -o pathtracer
//   ./pathtracer --scene direct --spp 64 --estimators mc,robust
//   ./pathtracer --scene direct --spp 4 --sampler tile --estimators mc,shared
//
// To see how the library is used, read pathtracer/estimators.hpp and pathtracer/tile_sampler.hpp; what samples are used
// for, pathtracer/scene_integrand.hpp.
#include "pathtracer/app.hpp"
#include "pathtracer/bvh.hpp"
#include "pathtracer/scenes.hpp"

int main(int argc, char **argv)
{
    auto make_intersector = [](const demo::Geometry &geometry) { return std::make_unique<demo::Bvh>(geometry); };
    return demo::run(argc, argv, {"pathtracer", demo::box_scenes(), make_intersector});
}
