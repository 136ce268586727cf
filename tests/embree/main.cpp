// The path tracer with Embree's rays and with the thesis's scenes; `cargo xtask embree` builds it. --help says what it
// takes.
#include "embree.hpp"
#include "scenes.hpp"

#include "pathtracer/app.hpp"

int main(int argc, char **argv)
{
    auto make_intersector = [](const demo::Geometry &geometry) {
        return std::make_unique<harness::EmbreeIntersector>(geometry);
    };
    return demo::run(argc, argv, {"embree_harness", harness::scenes(), make_intersector});
}
