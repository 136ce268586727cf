// The scenes, by name: what figures of the thesis show, rebuilt.
#pragma once

#include "scenes/animation.hpp"
#include "scenes/bathroom.hpp"
#include "scenes/chopper.hpp"
#include "scenes/dining.hpp"
#include "scenes/dragon.hpp"
#include "scenes/duck.hpp"
#include "scenes/glass.hpp"
#include "scenes/killeroos.hpp"
#include "scenes/lens.hpp"
#include "scenes/microcity.hpp"
#include "scenes/plane.hpp"
#include "scenes/veach.hpp"

namespace harness {

inline std::vector<demo::SceneEntry> scenes()
{
    return {
        {"killeroos", "3 dims (figure 4.4): the time, a point on the spherical light", make_killeroos},
        {"bathroom", "3 dims (figure 4.4): a point on one of five mesh lights, which of them", make_bathroom},
        {"dining", "2 dims (figure 4.4): a point on one triangle", make_dining},
        {"duck", "15 dims (figure 4.7): three bounces; upper half lit by two lamps, lower half only indirectly",
         make_duck},
        {"veach", "2 dims (figure 4.9): a point on a mesh light; glossy plates for --mis", make_veach},
        {"dragon", "2 dims (figure 4.10): an environment of high frequency", make_dragon},
        {"chopper", "2 dims (figure 4.10): glossy, an environment of low frequency", make_chopper},
        plane(1),
        plane(2),
        plane(4),
        plane(8),
        {"glass", "12 dims (section 4.3.5): three bounces, then Russian roulette; smooth glass", make_glass},
        {"lens", "4 dims (figure 5.19): points on the lens and of the sky", make_lens},
        {"microcity", "2 dims (figure 5.20): the sky over a city", make_microcity},
        {"animation", "2 dims (figures 5.23, 5.24): a point on the light; 18 frames", make_animation},
    };
}

} // namespace harness
