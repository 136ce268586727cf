// Animals and beasts, sculpted. Each stands on the origin and looks along x.
#pragma once

#include "sculpt.hpp"
#include "shapes.hpp"

namespace harness {

// A bath duck, one unit high: body and beak are parted, so that they can have different colours.
struct Duck {
    Mesh body, beak, eyes;
};

inline Duck duck()
{
    Body body(.16f);
    body.egg({0, .27f, 0}, {.46f, .27f, .33f})
        .egg({-.36f, .4f, 0}, {.2f, .13f, .17f}, -35)
        .limb({.2f, .42f, 0}, .2f, {.24f, .72f, 0}, .24f);
    body.egg({.24f, .74f, 0}, {.27f, .26f, .26f});
    body.egg({-.08f, .36f, .31f}, {.25f, .15f, .06f}, -12).mirrored(1);
    Body beak(.06f);
    beak.egg({.52f, .7f, 0}, {.16f, .04f, .14f}, 12).egg({.5f, .66f, 0}, {.13f, .035f, .11f}, -8);
    Duck duck;
    // The foot is cut flat: the duck swims, or stands.
    auto afloat = [&](Vector center, float radius) {
        return [near = body.near(center, radius)](Vector p) { return std::max(near(p), .02f - p.y); };
    };
    duck.body = sculpt(afloat, {-.8f, -.1f, -.5f}, {.7f, 1.1f, .5f}, .014f);
    duck.beak = sculpt(beak, {.2f, .5f, -.3f}, {.8f, .9f, .3f}, .012f);
    for (float side : {-1.0f, 1.0f})
        duck.eyes.add(move({.43f, .82f, side * .135f}) * ball({.045f, .045f, .045f}, 20));
    return duck;
}

// A leaping beast with a kangaroo's legs and a killer whale's head, one unit high.
inline Mesh leaper()
{
    Body body(.07f);
    body.limbs({{{-.16f, .42f, 0}, .15f}, {{-.02f, .56f, 0}, .135f}, {{.1f, .68f, 0}, .1f}, {{.17f, .8f, 0}, .065f}});
    body.limbs({{{.17f, .8f, 0}, .065f}, {{.22f, .88f, 0}, .085f}, {{.36f, .85f, 0}, .05f}, {{.42f, .835f, 0}, .032f}});
    body.limbs({{{-.16f, .4f, 0}, .13f},
                {{-.34f, .24f, 0}, .075f},
                {{-.55f, .12f, 0}, .05f},
                {{-.8f, .06f, 0}, .032f},
                {{-1, .09f, 0}, .012f}});
    body.limbs({{{-.14f, .38f, .1f}, .12f},
                {{.04f, .27f, .14f}, .07f},
                {{-.15f, .1f, .15f}, .04f},
                {{.06f, .03f, .16f}, .035f},
                {{.16f, .025f, .17f}, .02f}});
    body.mirrored(4);
    body.limbs({{{.08f, .62f, .09f}, .045f},
                {{.14f, .5f, .15f}, .03f},
                {{.26f, .5f, .13f}, .022f},
                {{.3f, .46f, .12f}, .014f}})
        .mirrored(3);
    body.limbs({{{.17f, .94f, .05f}, .03f}, {{.1f, 1.03f, .1f}, .024f}, {{.06f, 1.1f, .12f}, .006f}}).mirrored(2);
    Body fins(.01f);
    fins.limb({-.06f, .68f, 0}, .035f, {-.17f, .78f, 0}, .005f).limb({-.2f, .55f, 0}, .03f, {-.31f, .63f, 0}, .005f);
    auto field = [&](Vector center, float radius) {
        return [flesh = body.near(center, radius), fin = fins.near(center, radius)](Vector p) {
            return blend(flesh(p), fin(p), .04f);
        };
    };
    return sculpt(field, {-1.1f, -.05f, -.3f}, {.6f, 1.2f, .3f}, .011f);
}

// A serpent of the eastern kind, coiled once, about one unit high: body, mane, horns, legs and scales.
inline Mesh dragon()
{
    constexpr int joints = 40;
    auto spine = [](float t) { // from the tail's tip to the neck
        float angle = 2 * demo::pi * (1.35f * t + .32f), radius = .52f - .2f * t * t;
        float lift =
            .1f + .06f * std::sin(9 * t) * (1 - t) + .72f * std::max(0.0f, t - .55f) * std::max(0.0f, t - .55f) / .2f;
        return Vector{radius * std::cos(angle), lift, radius * std::sin(angle)};
    };
    auto girth = [](float t) { return .012f + .105f * std::sin(demo::pi * std::min(1.0f, .08f + .8f * t)); };
    Body body(.035f);
    std::vector<std::pair<Vector, float>> chain;
    for (int i = 0; i <= joints; ++i) {
        float t = static_cast<float>(i) / joints;
        chain.push_back({spine(t), girth(t)});
    }
    body.limbs(chain);
    const Vector neck = spine(1), along = demo::normalize(spine(1) - spine(.97f));
    const Vector side = demo::normalize(cross(along, {0, 1, 0}));
    const Vector ahead = demo::normalize(cross({0, 1, 0}, side)), up{0, 1, 0};
    auto at = [&](float a, float u, float s) { return neck + a * ahead + u * up + s * side; };
    body.limbs({{neck, .08f}, {at(.08f, .1f, 0), .1f}, {at(.2f, .09f, 0), .075f}, {at(.33f, .06f, 0), .055f}});
    body.limb(at(.1f, .02f, 0), .05f, at(.3f, -.05f, 0), .028f);
    body.limb(at(.35f, .09f, 0), .035f, at(.38f, .12f, 0), .02f);
    for (float s : {-1.0f, 1.0f}) {
        body.limb(at(.13f, .17f, s * .06f), .035f, at(.19f, .17f, s * .065f), .02f);
        body.limbs(
            {{at(.05f, .17f, s * .05f), .026f}, {at(-.08f, .28f, s * .1f), .02f}, {at(-.2f, .31f, s * .09f), .006f}});
        body.limbs({{at(-.06f, .23f, s * .09f), .018f}, {at(-.09f, .34f, s * .13f), .006f}});
        body.limbs(
            {{at(.34f, .05f, s * .04f), .012f}, {at(.42f, .0f, s * .12f), .01f}, {at(.36f, -.1f, s * .18f), .006f}});
        body.limb(at(.02f, .08f, s * .08f), .05f, at(-.13f, .05f, s * .17f), .008f);
        body.limb(at(.02f, .02f, s * .07f), .05f, at(-.1f, -.06f, s * .15f), .008f);
    }
    for (float t : {.42f, .72f}) // two pairs of legs
        for (float s : {-1.0f, 1.0f}) {
            Vector hip = spine(t), forward = demo::normalize(spine(t + .02f) - spine(t - .02f)),
                   out = s * demo::normalize(cross(forward, up));
            Vector knee = hip + .14f * out + .04f * up + .02f * forward,
                   foot{knee.x + .08f * out.x, .03f, knee.z + .08f * out.z};
            body.limbs({{hip, .06f}, {knee, .045f}, {foot, .03f}});
            for (float toe : {-.05f, 0.0f, .05f})
                body.limb(foot, .02f, foot + .07f * out + toe * forward - .015f * up, .006f);
        }
    Body spikes(.012f);
    for (int i = 3; i < 34; ++i) {
        float t = (static_cast<float>(i) + .5f) / 34;
        Vector back = spine(t) + girth(t) * .9f * up, lean = demo::normalize(spine(t) - spine(t + .02f));
        spikes.limb(back, .022f, back + .075f * up + .05f * lean, .003f);
    }
    auto field = [&](Vector center, float radius) {
        return [flesh = body.near(center, radius), spike = spikes.near(center, radius)](Vector p) {
            float d = blend(flesh(p), spike(p), .02f);
            // Scales, near the surface alone.
            return std::abs(d) < .03f ? d + .0025f * std::sin(95 * p.x) * std::sin(95 * p.y) * std::sin(95 * p.z) : d;
        };
    };
    return sculpt(field, {-.85f, -.08f, -.85f}, {.85f, 1.15f, .85f}, .0125f);
}

} // namespace harness
