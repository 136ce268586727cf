// What a program around the renderer consists of: its scenes, and the ray tracer that it renders them with.
#pragma once

#include "scene.hpp"

namespace demo {

// A function that makes an intersector for a geometry, which will outlive it.
using MakeIntersector = std::function<std::unique_ptr<Intersector>(const Geometry &)>;

struct Program {
    std::string name; // as its messages say it
    std::vector<SceneEntry> scenes; // at least one
    MakeIntersector make_intersector;
};

} // namespace demo
