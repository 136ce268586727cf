// Figure 5.19, middle: a wide lens before a chess board under the sky.
#pragma once

#include "../shapes.hpp"
#include "../sky.hpp"

namespace harness {

// A turned foot and stem up to `neck`, which most pieces share; squares are one unit wide.
inline std::vector<Profile> stem(float neck)
{
    return rounded({{0, 0},
                    {.36f, 0},
                    {.37f, .08f},
                    {.3f, .13f},
                    {.31f, .19f},
                    {.2f, .28f},
                    {.13f, .5f * neck},
                    {.11f, .85f * neck},
                    {.21f, .92f * neck},
                    {.21f, .96f * neck},
                    {.1f, neck}});
}

inline Mesh turned(float neck, const std::vector<Profile> &head)
{
    std::vector<Profile> all = stem(neck), top = rounded(head);
    all.insert(all.end(), top.begin(), top.end());
    return lathe(all, 56, 45);
}

inline Mesh pawn() { return turned(.72f, {{.1f, .72f}, {.2f, .82f}, {.22f, .92f}, {.17f, 1.04f}, {0, 1.1f}}); }
inline Mesh bishop()
{
    Mesh mesh = turned(1, {{.1f, 1}, {.2f, 1.12f}, {.19f, 1.26f}, {.08f, 1.44f}, {.05f, 1.47f}, {0, 1.5f}});
    mesh.add(move({0, 1.53f, 0}) * ball({.06f, .06f, .06f}, 24));
    return mesh;
}
inline Mesh rook()
{
    std::vector<Profile> profile = stem(.8f);
    for (Profile p : std::vector<Profile>{
             {.19f, .84f}, {.19f, 1}, {.27f, 1.04f}, {.27f, 1.12f}, {.18f, 1.12f}, {.18f, 1.05f}, {0, 1.05f}})
        profile.push_back(p);
    Mesh mesh = lathe(profile, 56, 40);
    for (int i = 0; i < 6; ++i)
        mesh.add(turn_up(60 * static_cast<float>(i)) * move({.222f, 1.11f, 0}) * box({.09f, .11f, .14f}, .01f));
    return mesh;
}
inline Mesh queen()
{
    Mesh mesh = turned(1.25f, {{.1f, 1.25f}, {.17f, 1.4f}, {.27f, 1.6f}, {.22f, 1.58f}, {.1f, 1.62f}, {0, 1.64f}});
    mesh.add(move({0, 1.69f, 0}) * ball({.07f, .07f, .07f}, 24));
    for (int i = 0; i < 10; ++i)
        mesh.add(turn_up(36 * static_cast<float>(i)) * move({.255f, 1.62f, 0}) * ball({.035f, .035f, .035f}, 16));
    return mesh;
}
inline Mesh king()
{
    Mesh mesh = turned(1.3f, {{.1f, 1.3f}, {.18f, 1.45f}, {.25f, 1.65f}, {.2f, 1.72f}, {.06f, 1.76f}, {0, 1.77f}});
    mesh.add(move({0, 1.75f, 0}) * box({.07f, .26f, .06f}, .015f));
    mesh.add(move({0, 1.84f, 0}) * box({.2f, .07f, .06f}, .015f));
    return mesh;
}

inline void make_lens(uint32_t, float aspect, Scene &scene)
{
    Stage stage(scene);
    scene.layout.lens = true;
    const Vector eye{-2.6f, 2.5f, 5.4f}, sharp{.5f, .9f, .5f};
    scene.camera.look(eye, {.3f, .45f, 0}, 36, aspect);
    scene.camera.aperture = .17f;
    scene.camera.focus = demo::dot(sharp - eye, scene.camera.forward);
    const uint32_t light = stage.material({.72f, .62f, .46f}, {.08f, .08f, .08f}, 16),
                   dark = stage.material({.22f, .12f, .075f}, {.08f, .08f, .08f}, 16);
    const uint32_t ivory = stage.material({.74f, .68f, .55f}, {.1f, .1f, .1f}, 16),
                   ebony = stage.material({.09f, .06f, .055f}, {.16f, .15f, .14f}, 12);
    stage.put(lathe({{0, -.5f}, {40, -.5f}, {40, -.49f}, {0, -.49f}}, 64), stage.material({.3f, .36f, .3f}));
    stage.put(box({8.8f, .3f, 8.8f}, .08f), stage.material({.3f, .16f, .08f}, {.1f, .1f, .1f}, 16),
              move({0, -.32f, 0}));
    const Mesh square = box({.985f, .1f, .985f}, .012f, 2);
    for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j)
            stage.put(square, (i + j) % 2 ? dark : light,
                      move({static_cast<float>(i) - 3.5f, -.1f, static_cast<float>(j) - 3.5f}));
    // The position after a few moves; files along x, ranks along -z.
    const Mesh small = pawn(), runner = bishop(), tower = rook(), lady = queen(), ruler = king();
    const struct {
        const Mesh &mesh;
        int file, rank;
        uint32_t material;
    } men[] = {{small, 0, 1, ivory}, {small, 1, 1, ivory}, {small, 5, 1, ivory},  {small, 6, 1, ivory},
               {small, 7, 1, ivory}, {small, 0, 6, ebony}, {small, 2, 6, ebony},  {small, 5, 6, ebony},
               {small, 6, 6, ebony}, {small, 7, 6, ebony}, {small, 4, 3, ivory},  {small, 3, 2, ivory},
               {small, 4, 4, ebony}, {small, 1, 5, ebony}, {runner, 2, 3, ivory}, {runner, 5, 4, ebony},
               {lady, 3, 5, ebony},  {ruler, 4, 7, ebony}, {tower, 0, 7, ebony},  {tower, 7, 7, ebony},
               {ruler, 5, 2, ivory}, {tower, 7, 0, ivory}, {tower, 2, 5, ivory}};
    for (const auto &man : men) // each turned a little differently
        stage.put(man.mesh, man.material,
                  move({static_cast<float>(man.file) - 3.5f, 0, 3.5f - static_cast<float>(man.rank)}) *
                      turn_up(static_cast<float>(17 * man.file + 31 * man.rank)));
    stage.environment(smooth_sky({.75f, .6f, .15f}));
}

} // namespace harness
