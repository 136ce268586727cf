// Figure 5.20: a city of more than 100,000 triangles under the sky.
#pragma once

#include "../shapes.hpp"
#include "../sky.hpp"

namespace harness {

class City {
public:
    explicit City(Stage &stage) : stage_(stage)
    {
        const Color paints[7] = {{.68f, .5f, .3f},  {.58f, .24f, .15f}, {.66f, .62f, .55f}, {.25f, .36f, .5f},
                                 {.74f, .56f, .2f}, {.5f, .3f, .2f},    {.35f, .52f, .45f}};
        for (Color paint : paints)
            walls_.push_back(stage.material(paint));
        const Color cars[5] = {
            {.6f, .08f, .06f}, {.1f, .2f, .5f}, {.75f, .75f, .72f}, {.08f, .08f, .09f}, {.75f, .55f, .08f}};
        for (Color car : cars)
            paints_.push_back(stage.material(car, {.25f, .25f, .25f}, 40));
        glass_ = stage.material({.06f, .1f, .13f}, {.5f, .5f, .5f}, 40);
        trim_ = stage.material({.75f, .73f, .7f});
        roof_ = stage.material({.3f, .28f, .27f});
        leaf_ = stage.material({.16f, .34f, .1f});
        bark_ = stage.material({.25f, .17f, .1f});
    }

    float number() { return stream_(); }
    float number(float low, float high) { return stream_(low, high); }
    template <class T> const T &one(const std::vector<T> &of)
    {
        return of[static_cast<size_t>(number() * static_cast<float>(of.size()))];
    }

    // A house on [x, x + width] x [z, z + depth], with panes in frames on every floor.
    void house(float x, float z, float width, float depth, float height)
    {
        const uint32_t wall = one(walls_);
        const Vector base{x + .5f * width, 0, z + .5f * depth};
        const float floors = std::floor(height / .17f), storey = height / floors;
        stage_.put(box({width, height, depth}), wall, move(base));
        stage_.put(box({width + .03f, .03f, depth + .03f}), trim_, move(base + Vector{0, height, 0}));
        stage_.put(box({width - .04f, .02f, depth - .04f}), roof_, move(base + Vector{0, height + .015f, 0}));
        stage_.put(box({width + .02f, .015f, depth + .02f}), trim_, move(base + Vector{0, .17f, 0}));
        facade(base + Vector{0, 0, .5f * depth}, 0, width, floors, storey);
        facade(base + Vector{.5f * width, 0, 0}, 90, depth, floors, storey);
        // Seen from the back or from the left only by the sky.
        for (int i = 0; i < 3; ++i) {
            Vector at = base + Vector{number(-.35f, .35f) * width, height + .03f, number(-.35f, .35f) * depth};
            if (number() < .4f)
                stage_.put(cylinder(number(.03f, .06f), number(.06f, .16f), 16), trim_, move(at));
            else
                stage_.put(box({number(.06f, .16f), number(.04f, .12f), number(.06f, .14f)}),
                           number() < .5f ? roof_ : wall, move(at));
        }
    }

    void tree(Vector at, float size)
    {
        stage_.put(rod(at, at + Vector{0, .5f * size, 0}, .06f * size, 6), bark_);
        for (int i = 0; i < 4; ++i) {
            Vector offset{number(-.2f, .2f), number(.55f, .95f), number(-.2f, .2f)};
            float radius = size * number(.2f, .32f);
            stage_.put(ball({radius, radius * .9f, radius}, 12), leaf_, move(at + size * offset));
        }
    }

    void car(Vector at, float degrees)
    {
        const Transform place = move(at) * turn_up(degrees);
        stage_.put(box({.17f, .04f, .075f}, .012f, 2), one(paints_), place * move({0, .014f, 0}));
        stage_.put(box({.095f, .035f, .066f}, .012f, 2), glass_, place * move({-.01f, .048f, 0}));
        for (float x : {-.05f, .05f})
            stage_.put(turn({1, 0, 0}, 90) * move({0, -.039f, 0}) * cylinder(.017f, .078f, 12), roof_,
                       place * move({x, .017f, 0}));
    }

private:
    void facade(Vector foot, float degrees, float width, float floors, float storey)
    {
        const Transform place = move(foot) * turn_up(degrees);
        const float columns = std::max(1.0f, std::floor(width / .12f)), pitch = width / columns;
        const Mesh frame = box({pitch * .56f, storey * .62f, .012f}), pane = box({pitch * .46f, storey * .52f, .016f});
        const bool balconies = number() < .3f;
        const Mesh balcony = box({pitch * .8f, storey * .22f, .05f});
        for (float row = 0; row < floors; ++row)
            for (float column = 0; column < columns; ++column) {
                Vector at{-.5f * width + (column + .5f) * pitch, (row + .22f) * storey, 0};
                stage_.put(frame, trim_, place * move(at));
                stage_.put(pane, glass_, place * move(at + Vector{0, .07f * storey, 0}));
                if (balconies && row > 0 && static_cast<int>(column) % 2)
                    stage_.put(balcony, trim_, place * move(at + Vector{0, -.1f * storey, .02f}));
            }
    }

    Stage &stage_;
    demo::SplitMix stream_{11};
    std::vector<uint32_t> walls_, paints_;
    uint32_t glass_, trim_, roof_, leaf_, bark_;
};

inline void make_microcity(uint32_t, float aspect, Scene &scene)
{
    Stage stage(scene);
    City city(stage);
    scene.camera.look({6.4f, 5.2f, 8.2f}, {.1f, .1f, .1f}, 30, aspect);
    stage.put(lathe({{0, -.06f}, {60, -.06f}, {60, -.05f}, {0, -.05f}}, 64), stage.material({.3f, .34f, .3f}));
    stage.put(box({9.6f, .05f, 9.6f}), stage.material({.17f, .17f, .18f}), move({0, -.05f, 0}));
    const uint32_t pavement = stage.material({.48f, .47f, .45f}), grass = stage.material({.22f, .38f, .14f}),
                   line = stage.material({.75f, .75f, .7f});
    const float block = 1.55f, street = .36f, pitch = block + street;
    for (int i = -2; i <= 2; ++i)
        for (int j = -2; j <= 2; ++j) {
            const Vector center{static_cast<float>(i) * pitch, 0, static_cast<float>(j) * pitch};
            const bool park = (i == 0 && j == 1) || (i == -2 && j == -1);
            stage.put(box({block, .02f, block}, .006f, 2), park ? grass : pavement, move(center));
            for (float k = -.7f; k < .8f; k += .2f)
                for (int axis = 0; axis < 2; ++axis) {
                    Vector at = axis ? Vector{.5f * pitch, .001f, k} : Vector{k, .001f, .5f * pitch};
                    stage.put(box(axis ? Vector{.012f, .002f, .09f} : Vector{.09f, .002f, .012f}), line,
                              move(center + at));
                }
            for (int k = 0; k < 3; ++k) {
                city.car(center + Vector{city.number(-.7f, .7f), 0, .5f * pitch + (k % 2 ? .09f : -.09f)},
                         k % 2 ? 0.0f : 180.0f);
                city.car(center + Vector{.5f * pitch + (k % 2 ? .09f : -.09f), 0, city.number(-.7f, .7f)},
                         k % 2 ? 90.0f : 270.0f);
            }
            if (park) {
                for (int k = 0; k < 26; ++k)
                    city.tree(center + Vector{city.number(-.68f, .68f), .02f, city.number(-.68f, .68f)},
                              city.number(.16f, .32f));
                stage.put(lathe(rounded({{0, 0},
                                         {.2f, 0},
                                         {.2f, .05f},
                                         {.17f, .05f},
                                         {.16f, .03f},
                                         {.04f, .03f},
                                         {.03f, .14f},
                                         {.09f, .16f},
                                         {0, .17f}}),
                                48, 50),
                          pavement, move(center + Vector{0, .02f, 0}));
                continue;
            }
            for (float k = -.6f; k < .7f; k += .4f)
                city.tree(center + Vector{k, .02f, .5f * block - .04f}, .14f);
            // Taller towards the middle.
            const float tall = std::max(.35f, 1.9f - .42f * length(center + Vector{.8f, 0, .8f}));
            const float width = .5f * block - .1f;
            for (int a = 0; a < 2; ++a)
                for (int b = 0; b < 2; ++b)
                    city.house(center.x - .5f * block + .07f + static_cast<float>(a) * (width + .06f),
                               center.z - .5f * block + .06f + static_cast<float>(b) * (width + .02f),
                               width - city.number(0, .12f), width - city.number(0, .12f),
                               tall * city.number(.55f, 1.35f));
        }
    stage.environment(smooth_sky({-.75f, .55f, .65f}, 60, 2));
}

} // namespace harness
