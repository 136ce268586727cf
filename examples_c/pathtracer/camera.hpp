// A camera with a thin lens, and what of the image plane a pixel sees.
#pragma once

#include "intersector.hpp"

namespace demo {

struct Camera {
    Vector eye, forward, right, up; // right and up span the image plane at distance 1
    float aperture = 0;             // radius of the lens; 0: a pinhole
    float focus = 1;                // distance of the plane that is sharp

    // `field` is the vertical field of view in degrees.
    void look(Vector from, Vector at, float field, float aspect)
    {
        eye = from;
        forward = normalize(at - from);
        float height = std::tan(field * pi / 360);
        right = normalize(cross(forward, {0, 1, 0})) * (height * aspect);
        up = normalize(cross(right, forward)) * height;
    }
    // x and y in [0, 1], from the top left; time in [0, 1].
    Ray ray(float x, float y, float time) const
    {
        return {eye, normalize(forward + (2 * x - 1) * right + (1 - 2 * y) * up), time};
    }
    // The same through a point of the lens, (u, v) in [0, 1)^2.
    Ray ray(float x, float y, float time, float u, float v) const
    {
        float a, b;
        concentric_disc(u, v, a, b);
        Vector offset = aperture * (a * normalize(right) + b * normalize(up));
        Vector at = focus * (forward + (2 * x - 1) * right + (1 - 2 * y) * up);
        return {eye + offset, normalize(at - offset), time};
    }
};

} // namespace demo
