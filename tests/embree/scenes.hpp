// The scenes, by name: what figures of the thesis show, rebuilt.
#pragma once

#include "scenes/bathroom.hpp"
#include "scenes/dining.hpp"
#include "scenes/dragon.hpp"
#include "scenes/duck.hpp"
#include "scenes/killeroos.hpp"

namespace harness {

inline std::vector<demo::SceneEntry> scenes()
{
    return {
        {"killeroos", "3 dims (figure 4.4): the time, a point on the spherical light", make_killeroos},
        {"bathroom", "3 dims (figure 4.4): a point on one of five mesh lights, which of them", make_bathroom},
        {"dining", "2 dims (figure 4.4): a point on one triangle", make_dining},
        {"duck", "15 dims (figure 4.7): three bounces; upper half lit by two lamps, lower half only indirectly", make_duck},
        {"dragon", "2 dims (figure 4.10): an environment of high frequency", make_dragon},
    };
}

} // namespace harness
