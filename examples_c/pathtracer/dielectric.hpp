// Smooth glass: light is mirrored, or refracted, and nothing in between.
#pragma once

#include "vector.hpp"

namespace demo {

// What happens to light that leaves a boundary towards `out` (unit). Where it came from, and how much of it: by
// reflection on the side of `out`, by refraction through the other.
//
// Radiance over the squared index of its medium is what refraction keeps, so that value is what paths carry: nothing
// need be scaled, as long as lights and the camera are outside.
struct Boundary {
    Vector reflected, refracted; // unit, away from the boundary
    float reflectance;           // Fresnel's, of unpolarised light; 1: total reflection, and `refracted` says nothing

    // `normal` is on the side of `out`; `index` is that of the glass, `inside` whether `out` is in it.
    Boundary(Vector normal, Vector out, float index, bool inside) : reflected(reflect(out, normal)), reflectance(1)
    {
        float ratio = inside ? index : 1 / index; // sin(refracted) / sin(out)
        float cosine = std::min(dot(normal, out), 1.0f), squared = 1 - ratio * ratio * (1 - cosine * cosine);
        if (squared <= 0 || cosine <= 0)
            return;
        float other = std::sqrt(squared);
        refracted = normalize((ratio * cosine - other) * normal - ratio * out);
        float perpendicular = (ratio * cosine - other) / (ratio * cosine + other);
        float parallel = (cosine - ratio * other) / (cosine + ratio * other);
        reflectance = 0.5f * (perpendicular * perpendicular + parallel * parallel);
    }
};

} // namespace demo
