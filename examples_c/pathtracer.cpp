// A small path tracer that hands each pixel's samples to noisefloor.
//
//   c++ -O2 -std=c++17 -Iinclude examples_c/pathtracer.cpp target/noisefloor/libnoisefloor.a -pthread -o pathtracer
//   ./pathtracer --scene direct --spp 64 --estimators mc,robust
//
// To see how the library is used, read pathtracer/estimators.hpp; how samples are made, pathtracer/integrand.hpp.
#include "pathtracer/app.hpp"
#include "pathtracer/bvh.hpp"

int main(int argc, char **argv)
{
    return demo::run(argc, argv, [](const demo::Geometry &geometry) { return std::make_unique<demo::Bvh>(geometry); });
}
