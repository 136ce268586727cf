// noisefloor.hpp: the same results as the C functions, lengths checked, errors thrown or returned. Compiled with and
// without exceptions; nothing in the wrapper may allocate, which the replaced operator new checks.
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <new>
#include <random>
#include <vector>
// Windows' headers have such.
#define min(a, b) ((a) < (b) ? (a) : (b))
#define max(a, b) ((a) > (b) ? (a) : (b))
#include "check.h"
#undef min
#undef max

namespace nf = noisefloor;

static std::size_t allocations;
// Not inlined: gcc 12 would take free() for a mismatch with a `new` that it no longer recognises.
[[gnu::noinline]] void *operator new(std::size_t bytes)
{
    ++allocations;
    if (void *block = std::malloc(bytes ? bytes : 1))
        return block;
    std::abort();
}
[[gnu::noinline]] void operator delete(void *block) noexcept { std::free(block); }
[[gnu::noinline]] void operator delete(void *block, std::size_t) noexcept { std::free(block); }

#ifdef NOISEFLOOR_NO_EXCEPTIONS
template <class Call> static nf::status code_of(Call call) { return call().code; }
template <class T> static T value_of(const nf::result<T> &result)
{
    CHECK(result.ok());
    return *result;
}
static void succeed(const nf::result<void> &result) { CHECK(result.ok()); }
#define SUCCEED(call) succeed(call)
#else
template <class Call> static nf::status code_of(Call call)
{
    try {
        static_cast<void>(call());
        return nf::status::ok;
    } catch (const nf::error &error) {
        CHECK(error.what() != nullptr);
        return error.code();
    }
}
template <class Call> static const char *words_of(Call call)
{
    static const char *words;
    try {
        static_cast<void>(call());
        words = "";
    } catch (const nf::error &error) {
        words = error.what();
    }
    return words;
}
#define WORDS(call) words_of([&] { return call; })
template <class T> static T value_of(const T &value) { return value; }
#define SUCCEED(call) (call)
#endif
#define CODE(call) code_of([&] { return call; })

constexpr std::size_t n = 64;
static float u[n * 2], f[n];

static void views()
{
    std::vector<float> vector(5, 1.0f);
    const std::vector<float> constant(4, 2.0f);
    std::array<double, 3> array{};
    float plain[7] = {};
    CHECK(nf::span<const float>(vector).size() == 5 && nf::span<const float>(vector).data() == vector.data());
    CHECK(nf::span<float>(vector).size() == 5);
    CHECK(nf::span<const float>(constant)[3] == 2.0f);
    CHECK(nf::span<const float>(plain).size() == 7 && nf::span<const float>(plain, 2).size() == 2);
    CHECK(nf::span<const float>().empty());
    CHECK(nf::memory(array).bytes() == 24 && nf::memory(vector).bytes() == 20 && nf::memory(plain).bytes() == 28);
    static_assert(!std::is_constructible_v<nf::span<float>, const std::vector<float> &>, "const is kept");
    static_assert(!std::is_constructible_v<nf::span<float>, std::vector<double> &>, "types are kept");
    static_assert(!std::is_constructible_v<nf::memory, const std::vector<float> &>, "memory is written");
    std::size_t count = 0;
    for (float value : nf::span<const float>(constant))
        count += value == 2.0f;
    CHECK(count == 4);
}

// What keeps a pointer to an array takes no array that ends with the expression.
template <class Taker> static void takes_what_stays(Taker)
{
    using room = std::vector<std::uint64_t>;
    static_assert(std::is_invocable_v<Taker, room &> && std::is_invocable_v<Taker, nf::memory>, "it stays");
    static_assert(!std::is_invocable_v<Taker, room>, "it ends first");
}
#define IT std::forward<decltype(it)>(it)
#define TAKES_WHAT_STAYS(call) takes_what_stays([](auto &&it) -> decltype(call) { return {}; })

static void lifetimes()
{
    TAKES_WHAT_STAYS(nf::accumulator::create(nf::config(), IT));
    TAKES_WHAT_STAYS((nf::optimal_mis::create({}, 1, IT)));
    TAKES_WHAT_STAYS(nf::optimal_gradient::create(2, 1, IT));
    TAKES_WHAT_STAYS(std::declval<nf::table &>().init(IT, 5));
    TAKES_WHAT_STAYS(std::declval<nf::table &>().init(IT, std::array<float, 2>{}));
    TAKES_WHAT_STAYS(std::declval<nf::table &>().load(IT, std::array<unsigned char, 2>{}));
    using values = std::vector<float>;
    using kept = decltype(nf::samples::u);
    static_assert(std::is_same_v<kept, decltype(nf::samples::known_integrals)> &&
                      std::is_same_v<kept, decltype(nf::mis::point::pdf)>,
                  "of one kind");
    static_assert(std::is_convertible_v<values &, kept> && std::is_convertible_v<const values &, kept> &&
                      std::is_convertible_v<nf::span<float>, kept> && std::is_convertible_v<float (&)[2], kept> &&
                      std::is_constructible_v<kept, float *, std::size_t>,
                  "they stay");
    static_assert(!std::is_convertible_v<values, kept> && !std::is_convertible_v<const values, kept> &&
                      !std::is_convertible_v<std::array<float, 2>, kept> && !std::is_assignable_v<kept &, values>,
                  "they end first");
    // What changes the sums is not for constants.
    using nf::samples;
    static_assert(std::is_invocable_v<decltype(&nf::accumulator::add), nf::accumulator &, samples> &&
                      !std::is_invocable_v<decltype(&nf::accumulator::add), const nf::accumulator &, samples> &&
                      !std::is_invocable_v<decltype(&nf::optimal_mis::merge), const nf::optimal_mis &, nf::optimal_mis>,
                  "constants stay as they are");
}

static void configurations()
{
    const nf_cv_config expected = make_config(2, 2, 1, NF_CV_ROBUST);
    const nf::config defaults;
    CHECK(std::memcmp(&defaults, &expected, sizeof expected) == 0);
    const nf::config config = nf::config(3, 1, 2)
                                  .with(nf::estimator::k_fold)
                                  .with(nf::basis::sine)
                                  .with(nf::solver::normal_equations)
                                  .with_stratified_samples()
                                  .with_slices(4)
                                  .with_edges(1)
                                  .with_controls(1)
                                  .with_stride(7)
                                  .with_single_precision()
                                  .with_non_finite_skipped()
                                  .with_folds(5)
                                  .with_ridge(0.5f);
    CHECK(config.dims == 3 && config.order == 1 && config.channels == 2 && config.estimator == NF_CV_K_FOLD);
    CHECK(config.basis == NF_BASIS_SINE && config.solver == NF_SOLVER_NORMAL_EQUATIONS);
    CHECK(config.stratified == 1 && config.slices == 4 && config.edges == 1 && config.controls == 1);
    CHECK(config.stride == 7 && config.precision == NF_PRECISION_F32);
    CHECK(config.nonfinite == NF_NONFINITE_SKIP && config.folds == 5 && config.ridge == 0.5f);
    CHECK(config.with_automatic_ridge().ridge == NF_RIDGE_AUTO);
    CHECK(config.with_luminance_ratio().color == NF_COLOR_LUMINANCE_RATIO);
    CHECK(config.terms() == nf_cv_terms(&config) && config.valid());
    CHECK(nf::check(config) == nullptr && std::strstr(nf::check(nf::config(0, 1)), "dims must be 1 to 16") != nullptr);
    CHECK(nf::check(nf::image(64, 64)) == nullptr && std::strstr(nf::check(nf::image(0, 64)), "width") != nullptr);
    CHECK(std::strstr(nf::check(nf_cv_descent{3, 0, 0.0f, 0.0f}), "optimizer") != nullptr);
    CHECK(std::strstr(nf::check(nf_omis_arguments{}), "techniques") != nullptr);
    CHECK(std::strstr(nf::check(nf_importance_arguments{1, 0, 2}), "outputs") != nullptr);
    CHECK(std::strstr(nf::check(nf_table{}), "nf_table_init") != nullptr);
    CHECK(nf::check(nf_tile{}) == nullptr && nf::check(nf_tile_sampler{}) == nullptr);
    CHECK(!nf::config(0, 1).valid() && nf::config(17, 1).workspace_size(4) == 0);
    CHECK(config.workspace_size(64) == nf_cv_workspace_size(&config, 64) &&
          config.accumulator_size() == nf_cv_accumulator_size(&config, nullptr));
}

static void estimates()
{
    const nf::config config(2, 2);
    std::array<std::uint64_t, 4096> workspace{};
    nf_estimate expected;
    CHECK(config.workspace_size(n) <= sizeof workspace);
    CHECK(estimate_one(&config, u, f, n, workspace.data(), sizeof workspace, &expected) == NF_OK);
    const std::size_t before = allocations;
    const nf_estimate estimate = value_of(nf::estimate(config, {u, f}, workspace));
    CHECK(std::memcmp(&estimate, &expected, sizeof estimate) == 0);

    using nf::span;
    using nf::status;
    CHECK(CODE(nf::estimate(config, {span<const float>(u, 2 * n - 1), f}, workspace)) == status::length);
    CHECK(CODE(nf::estimate(config, {u, span<const float>(f, 0)}, workspace)) == status::no_samples);
    // Rows of four numbers: without the stride they would pair each second value with the wrong numbers.
    const span<const float> half_of_f(f, n / 2);
    CHECK(CODE(nf::estimate(config, {u, half_of_f}, workspace)) == status::length);
    CHECK(CODE(nf::estimate(config.with_stride(4), {u, half_of_f}, workspace)) == status::ok);
    CHECK(CODE(nf::estimate(config.with_stride(4), {span<const float>(u, 2 * n - 2), half_of_f}, workspace)) ==
          status::ok);
    CHECK(CODE(nf::estimate(config.with_stride(UINT32_MAX), {u, span<const float>(f, 1)}, workspace)) == status::ok);
    CHECK(CODE(nf::estimate(config, {}, workspace)) == status::no_samples);
    CHECK(CODE(nf::estimate(config.with_controls(1), {u, f}, workspace)) == status::length);
    CHECK(CODE(nf::estimate(config, {u, f, f, {}}, workspace)) == status::length);
    CHECK(CODE(nf::estimate(nf::config(2, 2, 3), {u, f}, workspace)) == status::length); // 64 is no multiple of 3
    CHECK(CODE(nf::estimate(nf::config(2, 2, 0), {u, f}, workspace)) == status::range);
    CHECK(CODE(nf::estimate(config.with_stride(1u << 31), {u, f}, workspace)) == status::length);
    CHECK(CODE(nf::estimate(config, {u, f}, {})) == status::null);
    CHECK(CODE(nf::estimate(config, {u, f}, {workspace.data(), 8})) == status::memory);
    CHECK(CODE(nf::estimate(config.with(nf::solver::square_root), {u, f}, workspace)) == status::unsupported);

    // A control function, u0, whose integral is 1/2.
    std::array<float, n> h{};
    for (std::size_t i = 0; i < n; ++i)
        h[i] = u[2 * i];
    const float half[1] = {0.5f};
    CHECK(CODE(nf::estimate(config.with_controls(1), {u, f, h, half}, workspace)) == status::ok);

    std::array<nf_estimate, 4> each{};
    SUCCEED(nf::estimate_each(config, {u, f}, workspace, each));
    CHECK(estimate_one(&config, u, f, n / 4, workspace.data(), sizeof workspace, &expected) == NF_OK);
    CHECK(std::memcmp(&each[0], &expected, sizeof expected) == 0 && each[3].samples == n / 4);
    CHECK(CODE(nf::estimate_each(config, {u, f}, workspace, {each.data(), 3})) == status::length);
    CHECK(CODE(nf::estimate_each(config, {u, f}, workspace, {})) == status::length);

    std::array<float, 5> coefficients{};
    const nf::config descent = config.with(nf::estimator::gradient_descent);
    CHECK(std::fabs(value_of(nf::gradient_descent(descent, {u, f}, coefficients, workspace)).mean[0] - 2.0f) < 0.2f);
    CHECK(coefficients[0] != 0.0f);
    nf_cv_descent steps{};
    steps.momentum = 2.0f;
    CHECK(CODE(nf::gradient_descent(descent, {u, f}, coefficients, workspace, steps)) == status::range);
    const span<float> four(coefficients.data(), 4);
    CHECK(CODE(nf::gradient_descent(descent, {u, f}, four, workspace)) == status::length);
#ifdef NOISEFLOOR_NO_EXCEPTIONS
    CHECK(allocations == before);
#else
    static_cast<void>(before); // a thrown exception allocates, in the language's runtime
#endif
}

static void images()
{
    [[maybe_unused]] const auto surfaces_of =
        [](auto &&ids) -> decltype(nf::image(2, 2).with_surfaces(std::forward<decltype(ids)>(ids))) { return {2, 2}; };
    [[maybe_unused]] const auto factors_of =
        [](auto &&all) -> decltype(nf::image(2, 2).with_factors(std::forward<decltype(all)>(all))) { return {2, 2}; };
    using ids = std::vector<std::uint32_t>;
    using values = std::array<float, 4>;
    static_assert(std::is_invocable_v<decltype(surfaces_of), ids &> &&
                      std::is_invocable_v<decltype(surfaces_of), nf::span<std::uint32_t>> &&
                      std::is_invocable_v<decltype(factors_of), const values &> &&
                      std::is_invocable_v<decltype(factors_of), nf::span<const float>>,
                  "views and what stays are taken");
    static_assert(!std::is_invocable_v<decltype(surfaces_of), ids> &&
                      !std::is_invocable_v<decltype(surfaces_of), const ids> &&
                      !std::is_invocable_v<decltype(factors_of), values>,
                  "a temporary array ends first");
    using nf::span;
    using nf::status;
    const nf::config config(2, 2);
    std::array<std::uint64_t, 16384> workspace{};
    std::array<nf_estimate, 16> pixels{}, expected{};
    const nf::image image = nf::image(4, 4).with_window(4, 2);
    CHECK(image.width == 4 && image.height == 4 && image.frames == 1 && image.window == 4 && image.stride == 2);
    CHECK(image.surfaces == nullptr && image.factors == nullptr && image.pixels() == 16 &&
          nf::image(2, 4, 2).pixels() == 16);
    CHECK(nf::image(UINT32_MAX, UINT32_MAX, UINT32_MAX).pixels() == 0 && nf::image(0, 4).pixels() == 0);
    CHECK(image.with_window(6).window == 6 && image.with_window(6).stride == 0);
    nf_cv_image plain{};
    plain.width = plain.height = plain.window = 4;
    plain.frames = 1;
    plain.stride = 2;
    CHECK(image.samples == 0 && image.with_samples(3).samples == 3);
    CHECK(image.unordered == 0 && image.without_places().unordered == 1 && !image.with_surfaces({}).fits(config));
    CHECK(config.image_workspace_size(image, 4) == image_workspace_size(&config, &plain, 4));
    CHECK(config.image_workspace_size(image, 4) > 0 && config.image_workspace_size(image, 4) <= sizeof workspace);
    CHECK(config.image_workspace_size(nf::image(4, 4, 200), 4) == 0);
    CHECK(estimate_image(&config, &plain, u, f, 4, workspace.data(), sizeof workspace, expected.data()) == NF_OK);
    const std::size_t before = allocations;
    SUCCEED(nf::estimate_image(config, image, {u, f}, workspace, pixels));
    CHECK(std::memcmp(pixels.data(), expected.data(), sizeof expected) == 0 && pixels[15].samples == 4);

    std::array<std::uint32_t, 16> surfaces{};
    std::array<float, 16> factors{};
    surfaces.fill(3);
    factors.fill(2.0f);
    SUCCEED(nf::estimate_image(config, image.with_surfaces(surfaces).with_factors(factors), {u, f}, workspace, pixels));
    for (std::size_t pixel = 0; pixel < 16; ++pixel)
        CHECK(std::fabs(pixels[pixel].mean[0] - expected[pixel].mean[0]) < 1e-5f);

    const nf_cv_rectangle row{0, 3, 4, 1}, all{0, 0, 4, 4};
    SUCCEED(nf::estimate_image(config, image.with_parts(row, all), {u, f}, workspace, {pixels.data(), 4}));
    CHECK(std::memcmp(pixels.data(), &expected[12], 4 * sizeof expected[0]) == 0);
    CHECK(image.with_parts(row, all).estimates() == 4 && image.with_parts(row, row).pixels() == 4);
    CHECK(CODE(nf::estimate_image(config, image.with_parts(row, all), {u, f}, workspace, pixels)) == status::length);
    CHECK(value_of(image.with_parts(row, all).needed()).height == 4);

    // All of the light arrives: what is known is exact.
    const span<const float> exact(factors.data(), 16), known(f);
    const nf::config alone = config.with(nf::estimator::leave_one_out);
    CHECK(config.image_workspace_size(image, 4, true) > config.image_workspace_size(image, 4));
    SUCCEED(nf::estimate_image(alone, image, {u, f, {}, {}, known, exact}, workspace, pixels));
    for (std::size_t pixel = 0; pixel < 16; ++pixel)
        CHECK(std::fabs(pixels[pixel].mean[0] - 2.0f) < 1e-4f);
    const span<const float> nothing, short_known(f, n - 1), short_exact(factors.data(), 15);
    for (const auto &wrong : {nf::samples{u, f, {}, {}, nothing, exact}, nf::samples{u, f, {}, {}, known, nothing},
                              nf::samples{u, f, {}, {}, short_known, exact},
                              nf::samples{u, f, {}, {}, known, short_exact}})
        CHECK(CODE(nf::estimate_image(config, image, wrong, workspace, pixels)) == status::length);
    CHECK(nf::check(image) == nullptr && nf::check(image.with_window(4, 5)) != nullptr);

    const span<const std::uint32_t> few(surfaces.data(), 15);
    CHECK(CODE(nf::estimate_image(config, image.with_surfaces(few), {u, f}, workspace, pixels)) == status::length);
    CHECK(CODE(nf::estimate_image(config, image.with_factors({factors.data(), 15}), {u, f}, workspace, pixels)) ==
          status::length);
    CHECK(CODE(nf::estimate_image(config, image, {u, f}, workspace, {pixels.data(), 8})) == status::length);
    CHECK(CODE(nf::estimate_image(config, image, {u, f}, workspace, {})) == status::length);
    CHECK(CODE(nf::estimate_image(config, nf::image(4, 3), {u, f}, workspace, {pixels.data(), 12})) == status::length);
    CHECK(CODE(nf::estimate_image(config, image, {span<const float>(u, 2 * n - 1), f}, workspace, pixels)) ==
          status::length);
    CHECK(CODE(nf::estimate_image(config, image, {}, workspace, pixels)) == status::no_samples);
    CHECK(CODE(nf::estimate_image(config, image, {u, f}, {}, pixels)) == status::null);
    CHECK(CODE(nf::estimate_image(config, image, {u, f}, {workspace.data(), 8}, pixels)) == status::memory);
    CHECK(CODE(nf::estimate_image(config, image.with_window(4, 5), {u, f}, workspace, pixels)) == status::range);
    factors[3] = -1.0f;
    CHECK(CODE(nf::estimate_image(config, image.with_factors(factors), {u, f}, workspace, pixels)) == status::range);
#ifdef NOISEFLOOR_NO_EXCEPTIONS
    CHECK(allocations == before);
#else
    static_cast<void>(before); // as above
#endif
}

static void accumulators()
{
    const nf::config config = nf::config(2, 2).with(nf::estimator::least_squares);
    std::array<std::uint64_t, 512> first{}, second{}, workspace{};
    CHECK(config.accumulator_size() <= sizeof first && config.accumulator_workspace_size() <= sizeof workspace);
    const std::size_t before = allocations;
    nf::accumulator a = value_of(nf::accumulator::create(config, first)),
                    b = value_of(nf::accumulator::create(config, second));
    SUCCEED(a.add({nf::span<const float>(u, n), nf::span<const float>(f, n / 2)}));
    SUCCEED(b.add({nf::span<const float>(u + n, n), nf::span<const float>(f + n / 2, n / 2)}));
    SUCCEED(a.merge(b));
    const nf_estimate estimate = value_of(a.estimate(workspace));
    CHECK(estimate.samples == n && std::fabs(estimate.mean[0] - 2.0f) < 1e-4f);
    a = value_of(nf::accumulator::create(config, first));
    CHECK(allocations == before);
    CHECK(CODE(a.estimate(workspace)) == nf::status::no_samples);
    CHECK(CODE(a.merge(a)) == nf::status::range);
    CHECK(CODE(a.add({nf::span<const float>(u, 3), f})) == nf::status::length);
    CHECK(CODE(nf::accumulator::create(config, {first.data(), 8})) == nf::status::memory);
    CHECK(CODE(nf::accumulator::create(config.with(nf::estimator::leave_one_out), first)) == nf::status::unsupported);
}

// A view of an accumulator whose bytes lie in memory. Arrays end where they say, for what looks for reads beyond them.
static void resumed_accumulators()
{
    const nf::config config = nf::config(2, 2, 3).with(nf::estimator::least_squares);
    std::array<std::uint64_t, 512> first{}, second{}, scratch{}, workspace{};
    std::vector<float> points(u, u + 2 * 8), values(3 * 8, 1.0f), few(8, 1.0f);
    CHECK(config.accumulator_size() <= sizeof first && config.accumulator_workspace_size() <= sizeof workspace);
    nf::accumulator made = value_of(nf::accumulator::create(config, first));
    SUCCEED(made.add({points, values}));
    second = first;
    nf::accumulator moved = value_of(nf::accumulator::resume(config, second, scratch));
    CHECK(moved.handle() == static_cast<void *>(second.data()) && value_of(moved.estimate(workspace)).samples == 8);
    SUCCEED(moved.add({points, values}));
    CHECK(value_of(moved.estimate(workspace)).samples == 16 && value_of(made.estimate(workspace)).samples == 8);
    CHECK(CODE(moved.add({points, few})) == nf::status::length);

    // Of any other configuration its lengths would be others.
    using nf::status;
    for (const nf::config &other : {nf::config(2, 2, 1), nf::config(2, 2, 3), config.with_stride(3),
                                    config.with_controls(1), config.with_single_precision(), nf::config(3, 2, 3)}) {
        CHECK(other.accumulator_size() <= sizeof scratch);
        CHECK(CODE(nf::accumulator::resume(other, second, scratch)) == status::mismatch);
    }
    const std::size_t size = config.accumulator_size();
    CHECK(CODE(nf::accumulator::resume(config, {second.data(), size - 1}, scratch)) == status::memory);
    CHECK(CODE(nf::accumulator::resume(config, second, {scratch.data(), size - 1})) == status::memory);
    CHECK(CODE(nf::accumulator::resume(config, workspace, scratch)) == status::state);
    CHECK(CODE(nf::accumulator::resume(config, second, second)) == status::range);
    CHECK(CODE(nf::accumulator::resume(config, {nullptr, size}, scratch)) == status::null);
    CHECK(CODE(nf::accumulator::resume(nf::config(0, 2), second, scratch)) == status::range);
    CHECK(value_of(moved.estimate(workspace)).samples == 16);
}

// Every call with an object that was not made yet says so, whatever else is wrong.
static void not_made()
{
    const auto state = nf::status::state;
    std::array<std::uint64_t, 512> room{};
    std::array<float, 2> out{};
    std::array<std::uint32_t, 2> index{};
    nf::accumulator sums;
    CHECK(CODE(sums.add({u, f})) == state && CODE(sums.add({})) == state && CODE(sums.merge(sums)) == state);
    CHECK(CODE(sums.estimate(room)) == state && CODE(sums.estimate({})) == state);
    nf::accumulator made = value_of(nf::accumulator::create(nf::config(2, 2).with(nf::estimator::least_squares), room));
    CHECK(CODE(made.merge(sums)) == state && CODE(sums.merge(made)) == state);
    nf::optimal_mis omis;
    CHECK(CODE(omis.add(out, 0, out)) == state && CODE(omis.add({}, 0, {})) == state);
    CHECK(CODE(omis.solve(out)) == state && CODE(omis.solve({})) == state && CODE(omis.alpha(out)) == state);
    CHECK(CODE(omis.next_batch()) == state && CODE(omis.merge(omis)) == state);
    const std::uint32_t counts[2] = {1, 1};
    std::array<std::uint64_t, 64> other{};
    CHECK(CODE(value_of(nf::optimal_mis::create(counts, 1, other)).merge(omis)) == state);
    nf::optimal_gradient gradient;
    CHECK(CODE(gradient.estimate(1, {}, {}, {}, {})) == state);
    CHECK(CODE(gradient.estimate(1, out, index, {}, {})) == state);
    nf::table table;
    nf::rng rng(1);
    std::array<unsigned char, 64> saved{};
    const nf_shard all[1] = {};
    CHECK(CODE(table.draw(rng, index)) == state && CODE(table.draw(rng, index, {out.data(), 1})) == state);
    CHECK(CODE(table.draw_stratified(rng, {})) == state && CODE(table.draw_distinct(rng, index)) == state);
    CHECK(CODE(table.draw_shard(all, rng, index)) == state && CODE(table.update(index, {}, 0.5f)) == state);
    CHECK(CODE(table.set_uniform_fraction(0.5f)) == state && CODE(table.set_uniform_fraction(1.5f)) == state);
    CHECK(CODE(table.add_epsilon(-1.0f)) == state && CODE(table.append({})) == state && CODE(table.shard()) == state);
    CHECK(CODE(table.probabilities(index, {})) == state && CODE(table.save({})) == state);
    CHECK(CODE(table.save(saved)) == state && table.items() == 0);
}

#ifndef NOISEFLOOR_NO_EXCEPTIONS
// What is wrong, in words: the field, lengths, or else what the code says.
static void words()
{
    const nf::config config(2, 2);
    std::array<std::uint64_t, 4096> workspace{};
    std::array<nf_estimate, 16> pixels{};
    const nf::span<const float> half(u, n);
    const auto is = [](const char *words, const char *expected) { return std::strcmp(words, expected) == 0; };
    const char *const lengths = nf::message(nf::status::length);
    CHECK(is(WORDS(nf::estimate(config, {half, f}, workspace)), lengths));
    const auto dims = nf::config(20, 1);
    CHECK(is(WORDS(nf::estimate(dims, {u, f}, workspace)), nf::check(dims)));
    CHECK(CODE(nf::estimate(dims, {u, f}, workspace)) == nf::status::range);
    const auto solver = config.with(nf::solver::square_root);
    CHECK(is(WORDS(nf::estimate(solver, {u, f}, workspace)), nf::check(solver)));
    CHECK(is(WORDS(nf::estimate_each(dims, {u, f}, workspace, pixels)), nf::check(dims)));
    CHECK(is(WORDS(nf::accumulator::create(dims, workspace)), nf::check(dims)));
    const nf::image image(4, 4), wide = image.with_window(4, 5);
    CHECK(is(WORDS(nf::estimate_image(config, wide, {u, f}, workspace, pixels)), nf::check(wide)));
    CHECK(is(WORDS(nf::estimate_image(config, nf::image(0, 4), {u, f}, workspace, pixels)),
             nf::check(nf::image(0, 4))));
    CHECK(is(WORDS(nf::estimate_image(config, image, {u, f}, workspace, {pixels.data(), 8})), lengths));
    const nf_cv_descent steps{3, 0, 0.0f, 0.0f};
    std::array<float, 5> start{};
    CHECK(is(WORDS(nf::gradient_descent(config.with(nf::estimator::gradient_descent), {u, f}, start, workspace, steps)),
             nf::check(steps)));
    const std::uint32_t counts[2] = {0, 1};
    CHECK(std::strstr(WORDS(nf::optimal_mis::create(counts, 1, workspace)), "counts") != nullptr);
    const std::uint32_t once[2] = {1, 1};
    CHECK(std::strstr(WORDS(nf::optimal_mis::create(once, 0, workspace)), "integrals") != nullptr);
    std::array<std::uint64_t, 64> sums{};
    nf::optimal_mis omis = nf::optimal_mis::create(once, 1, sums);
    CHECK(std::strstr(WORDS(omis.next_batch(nf::optimal_mis::solver::plain, 0.0f, 2.0f)), "beta") != nullptr);
    std::array<float, 1> one{};
    CHECK(std::strstr(WORDS(omis.solve(one, nf::optimal_mis::solver::ridge, -1.0f)), "ridge") != nullptr);
    // A coordinate is no field.
    std::array<float, 4> outside{0.5f, 1.0001f, 0.5f, 0.5f};
    CHECK(is(WORDS(nf::estimate(config, {outside, {f, 2}}, workspace)), nf::message(nf::status::range)));
    CHECK(std::strstr(nf::message(nf::status::range), "function's description") != nullptr);
}
#endif

static void mis()
{
    const float pdf[2] = {1.0f, 3.0f}, alpha[2] = {0.5f, 0.25f}, value[1] = {2.0f};
    const std::uint32_t counts[2] = {1, 1};
    const nf::mis::point at{pdf, counts};
    CHECK(value_of(nf::mis::balance(at, 0)) == 0.25f);
    CHECK(value_of(nf::mis::power(at, 0)) == 0.1f);
    CHECK(value_of(nf::mis::cutoff(at, 1, 0.5f)) == 1.0f);
    CHECK(value_of(nf::mis::maximum(at, 1)) == 1.0f);
    // alpha_j / n_j + (f - sum of alpha_k p_k) / sum of n_k p_k
    CHECK(std::fabs(value_of(nf::mis::optimal_contribution(at, 1, alpha, 2.0f)) - (0.25f + 0.75f / 4.0f)) < 1e-6f);
    CHECK(CODE(nf::mis::balance(at, 2)) == nf::status::range);
    CHECK(CODE(nf::mis::balance({pdf, {counts, 1}}, 0)) == nf::status::length);
    CHECK(CODE(nf::mis::optimal_contribution(at, 0, {alpha, 1}, 2.0f)) == nf::status::length);

    std::array<std::uint64_t, 64> sums{};
    CHECK(nf::optimal_mis::size(2, 1) <= sizeof sums);
    nf::optimal_mis omis = value_of(nf::optimal_mis::create(counts, 1, sums));
    std::array<float, 1> estimate{};
    std::array<float, 2> found{};
    CHECK(CODE(omis.solve(estimate)) == nf::status::no_samples);
    SUCCEED(omis.add(pdf, 0, value));
    SUCCEED(omis.add(pdf, 1, value));
    SUCCEED(omis.next_batch());
    SUCCEED(omis.solve(estimate, nf::optimal_mis::solver::balance));
    CHECK(estimate[0] == 1.0f);
    SUCCEED(omis.alpha(found));
    SUCCEED(omis.next_batch(nf::optimal_mis::solver::balance, 0.0f, 0.5f));
    CHECK(CODE(omis.add({pdf, 1}, 0, value)) == nf::status::length);
    {
        // Many at once have the bits of one after the other.
        const float densities[6] = {1.0f, 0.5f, 1.0f, 1.5f, 1.0f, 0.0f}, values[3] = {3.0f, 4.0f, 5.0f};
        const std::uint32_t drawn[3] = {0, 1, 0};
        std::array<std::uint64_t, 64> apart{}, together{};
        nf::optimal_mis one = value_of(nf::optimal_mis::create(counts, 1, apart));
        nf::optimal_mis all = value_of(nf::optimal_mis::create(counts, 1, together));
        for (std::size_t i = 0; i < 3; ++i)
            SUCCEED(one.add({densities + 2 * i, 2}, drawn[i], {values + i, 1}));
        SUCCEED(all.add(densities, drawn, values));
        CHECK(apart == together);
        SUCCEED(all.add({densities, 0}, {drawn, 0}, {values, 0}));
        CHECK(CODE(all.add({densities, 4}, drawn, values)) == nf::status::length);
        CHECK(CODE(all.add(densities, drawn, {values, 2})) == nf::status::length);
        // The last has none of the second technique: nothing is added.
        const std::uint32_t wrong[3] = {0, 1, 1};
        CHECK(CODE(all.add(densities, wrong, values)) == nf::status::range);
        CHECK(apart == together);
    }
    CHECK(CODE(omis.solve({})) == nf::status::length);
    CHECK(CODE(omis.alpha({found.data(), 1})) == nf::status::length);
    CHECK(CODE(omis.merge(omis)) == nf::status::range);
    CHECK(CODE(omis.next_batch(nf::optimal_mis::solver::progressive)) == nf::status::unsupported);
    CHECK(CODE(nf::optimal_mis::create({counts, 0}, 1, sums)) == nf::status::range);
    CHECK(CODE(nf::optimal_mis::create(counts, 1, {sums.data(), 8})) == nf::status::memory);
}

// As many numbers as there is room for; a length that is no domain's is refused, and nothing written.
template <class Sampler> static void draws_into(const Sampler &pixel, const std::array<float, 4> &expected)
{
    std::array<float, 3> array{};
    float plain[4] = {}, room[6] = {};
    static_assert(noexcept(pixel.draw(array)) && noexcept(pixel.draw(plain)), "what is static cannot fail");
    pixel.draw(array);
    pixel.draw(plain);
    CHECK(std::memcmp(array.data(), expected.data(), sizeof array) == 0);
    CHECK(std::memcmp(plain, expected.data(), sizeof plain) == 0);
    CHECK(CODE(pixel.draw({room, 5})) == nf::status::range && CODE(pixel.draw({room, 0})) == nf::status::range);
    CHECK(CODE(pixel.draw(nf::span<float>())) == nf::status::range && room[0] == 0.0f);
    SUCCEED(pixel.draw({room, 2}));
    CHECK(room[1] == expected[1] && room[2] == 0.0f);
}

static void samplers()
{
    const nf::sampler pixel(3, 70, 0, 5), child = pixel.domain(7).scramble(9);
    float expected[4];
    nf_sampler_draw(nf_sampler_pixel(3, 70, 0, 5), 4, expected);
    const std::array<float, 4> four = pixel.draw<4>();
    CHECK(std::memcmp(four.data(), expected, sizeof expected) == 0);
    CHECK(pixel.draw<2>()[1] == expected[1] && pixel.draw() == expected[0]);
    draws_into(pixel, four);
    nf_sampler_draw(nf_sampler_scramble(nf_sampler_domain(pixel.state(), 7), 9), 3, expected);
    CHECK(child.draw<3>()[2] == expected[2]);
    nf_sampler_draw(nf_sampler_white(3, 70, 1, 5), 1, expected);
    CHECK(nf::sampler::white(3, 70, 1, 5).draw() == expected[0]);

    const nf_sampler both[2] = {pixel.state(), child.state()};
    const std::uint32_t dims[2] = {2, 3};
    std::array<float, 2 * 2 * 3 * 5> block{};
    SUCCEED(nf::fill(both, dims, 2, 2, 3, block));
    CHECK(block[0] == four[0] && block[2] == child.draw());
    CHECK(CODE(nf::fill(both, nf::span<const std::uint32_t>(dims, 1), 2, 2, 3, block)) == nf::status::length);
    CHECK(CODE(nf::fill(both, dims, 2, 2, 4, block)) == nf::status::memory);
}

static void tiles()
{
    const std::size_t before = allocations;
    const nf::tile tile(nf_tile_64_1spp_2d);
    CHECK(tile.size == 64 && tile.spp == 1 && tile.dims == 2);
    const nf::tile_sampler pixel(tile, 3, 70, 0, 0), child = pixel.domain(7).scramble(9);
    float expected[4];
    nf_tile_sampler_draw(nf_tile_sampler_pixel(&tile, 3, 70, 0, 0), 4, expected);
    const std::array<float, 4> four = pixel.draw<4>();
    CHECK(std::memcmp(four.data(), expected, sizeof expected) == 0);
    CHECK(pixel.draw<2>()[1] == expected[1] && pixel.draw() == expected[0]);
    draws_into(pixel, four);
    nf_tile_sampler_draw(nf_tile_sampler_scramble(nf_tile_sampler_domain(pixel.state(), 7), 9), 3, expected);
    CHECK(child.draw<3>()[2] == expected[2]);
    using u32 = std::uint32_t;
    static_assert(!std::is_constructible_v<nf::tile_sampler, nf::tile, u32, u32, u32, u32> &&
                      !std::is_constructible_v<nf::tile_sampler, const nf::tile, u32, u32, u32, u32>,
                  "a temporary tile ends first");
    [[maybe_unused]] const auto tile_of =
        [](auto &&bytes) -> decltype(nf::tile::from_bytes(std::forward<decltype(bytes)>(bytes))) { return {}; };
    static_assert(std::is_invocable_v<decltype(tile_of), const std::vector<unsigned char> &> &&
                      !std::is_invocable_v<decltype(tile_of), std::vector<unsigned char>>,
                  "a temporary file ends first");
#ifdef NOISEFLOOR_NO_EXCEPTIONS
    static_assert(std::is_same_v<decltype(*nf::tile::from_bytes(nullptr, 0)), nf::tile>, "no reference to a temporary");
#endif

    const nf_tile_sampler both[2] = {pixel.state(), child.state()};
    const std::uint32_t dims[2] = {2, 3};
    std::array<float, 2 * 2 * 3 * 5> block{};
    SUCCEED(nf::fill(both, dims, 2, 2, 3, block));
    CHECK(block[0] == four[0] && block[4] == expected[2]);
    CHECK(allocations == before);
    CHECK(CODE(nf::fill(both, {dims, 1}, 2, 2, 3, block)) == nf::status::length);
    CHECK(CODE(nf::fill(both, dims, 2, 2, 4, block)) == nf::status::memory);
    const unsigned char text[] = "P6 1 1 255";
    CHECK(CODE(nf::tile::from_bytes(text)) == nf::status::foreign);
    CHECK(CODE(nf::tile::from_bytes("\x8eNFT\r\n\x1a\n", 8)) == nf::status::length);
    CHECK(CODE(nf::tile::from_bytes(nullptr, 8)) == nf::status::null);
    CHECK(nf::tile_sampler(nf_tile_sampler{}).draw() == 0.0f);
}

static void random_numbers()
{
    nf_rng expected;
    nf_rng_seed(&expected, 5);
    nf::rng rng(5), copy(rng.state());
    CHECK(rng() == nf_rng_next(&expected));
    CHECK(rng.uniform() == nf_rng_uniform(&expected));
    std::array<float, 4> filled{};
    rng.fill(filled);
    CHECK(filled[0] == nf_rng_uniform(&expected));
    CHECK(copy() != 0u && nf::rng::max() == UINT32_MAX);
    const int die = std::uniform_int_distribution<int>(1, 6)(rng);
    CHECK(die >= 1 && die <= 6);
}

static void minibatches()
{
    const std::array<float, 5> importance{0.0f, 1.0f, 2.0f, 3.0f, 4.0f};
    std::vector<std::uint64_t> room(nf::table::size(6) / 8 + 1), other(room.size());
    nf::table table;
    nf::rng rng(1);
    std::array<std::uint32_t, 8> index{};
    std::array<float, 8> weight{};
    CHECK(CODE(table.draw(rng, index)) == nf::status::state);
    CHECK(CODE(table.set_uniform_fraction(0.5f)) == nf::status::state);
    SUCCEED(table.init(room, importance));
    CHECK(table.items() == 5 && table.total() == 10.0 && table.importance(3) == 3.0f);
    SUCCEED(table.set_uniform_fraction(0.0f));
    CHECK(CODE(table.set_uniform_fraction(1.5f)) == nf::status::range);
    CHECK(table.probability(4) == 0.4f && table.probability(0) == 0.0f);

    nf_rng expected_rng;
    nf_rng_seed(&expected_rng, 1);
    std::array<std::uint32_t, 8> expected{};
    CHECK_STATUS(nf_table_draw(&table.state(), &expected_rng, 8, expected.data(), nullptr), NF_OK);
    SUCCEED(table.draw(rng, index, weight));
    CHECK(index == expected);
    for (std::size_t i = 0; i < index.size(); ++i)
        CHECK(index[i] > 0 && std::fabs(weight[i] * 5.0f * table.probability(index[i]) - 1.0f) < 1e-6f);
    // No elements at an address, as of a vector that was cleared: no weights, all the same.
    std::array<float, 8> unused{};
    nf::rng other_rng(7);
    SUCCEED(table.draw(other_rng, expected, {unused.data(), 0}));
    CHECK(unused == (std::array<float, 8>{}));
    SUCCEED(table.draw_stratified(rng, index));
    SUCCEED(table.draw_distinct(rng, {index.data(), 4}, {weight.data(), 4}));
    CHECK(CODE(table.draw(rng, index, {weight.data(), 7})) == nf::status::length);
    CHECK(CODE(table.draw_distinct(rng, {index.data(), 5})) == nf::status::no_samples);

    const std::uint32_t first[] = {0};
    const float ten[] = {10.0f};
    SUCCEED(table.update(first, ten, 0.5f));
    CHECK(table.importance(0) == 5.0f);
    CHECK(CODE(table.update(index, ten, 0.5f)) == nf::status::length);
    SUCCEED(table.append(ten));
    SUCCEED(table.add_epsilon(1.0f));
    CHECK(table.items() == 6 && table.importance(5) == 11.0f);
    std::array<float, 3> p{};
    SUCCEED(table.probabilities({index.data(), 2}, p, 2));
    CHECK(p[2] == table.probability(index[1]) && p[1] == 0.0f);
    CHECK(CODE(table.probabilities({index.data(), 3}, p, 2)) == nf::status::length);

    std::vector<unsigned char> saved(table.saved_size());
    SUCCEED(table.save(saved));
    nf::table loaded;
    SUCCEED(loaded.load(other, saved));
    CHECK(loaded.total() == table.total());
    saved.back() ^= 1u;
    CHECK(CODE(loaded.load(other, saved)) == nf::status::corrupt);
    nf::table moved(std::move(loaded));
    CHECK(moved.items() == 6 && loaded.items() == 0);

    const nf_shard all[] = {value_of(table.shard()), value_of(moved.shard())};
    std::array<std::uint32_t, 2> counts{};
    SUCCEED(nf::allocate(all, 0.0f, rng, 8, counts));
    CHECK(counts[0] + counts[1] == 8);
    CHECK(CODE(nf::allocate(all, 0.0f, rng, 8, {counts.data(), 1})) == nf::status::length);
    SUCCEED(moved.draw_shard(all, rng, index, weight));
    SUCCEED(moved.init(other, 3));
    CHECK(moved.total() == 3.0);
    static_assert(!std::is_copy_constructible_v<nf::table>, "a copy would share the memory");

    const float pdf[] = {0.1f, 0.2f, 0.3f, 0.1f};
    const std::uint32_t technique[] = {0, 1};
    float direct[2], wrapped[2];
    CHECK_STATUS(nf_omis_weights(NF_OMIS_RIDGE, 0.0f, 2, 10, pdf, technique, 2, direct), NF_OK);
    SUCCEED(nf::omis_weights(2, 10, pdf, technique, wrapped));
    CHECK(direct[0] == wrapped[0] && direct[1] == wrapped[1]);
    CHECK(CODE(nf::omis_weights(3, 10, pdf, technique, wrapped)) == nf::status::length);
}

static void importances()
{
    const float logits[] = {0.0f, 0.0f, 9.0f, 0.0f}, target[] = {0.0f, 3.0f, 9.0f, 0.0f};
    const std::uint32_t label[] = {0, 0};
    std::array<float, 2> norm{}, loss{};
    std::array<float, 4> gradient{}, parts{};
    SUCCEED(nf::importance::cross_entropy(logits, label, norm, loss, gradient));
    CHECK(norm[0] == std::sqrt(0.5f) && norm[1] < 0.001f && loss[1] < loss[0] && gradient[0] == -0.5f);
    SUCCEED(nf::importance::cross_entropy(logits, label, norm));
    CHECK(CODE(nf::importance::cross_entropy(logits, label, norm, {loss.data(), 1})) == nf::status::length);
    SUCCEED(nf::importance::squared_error(logits, target, norm));
    CHECK(norm[0] == 6.0f && norm[1] == 0.0f);
    CHECK(CODE(nf::importance::squared_error(logits, {target, 2}, norm)) == nf::status::length);
    SUCCEED(nf::importance::gradient(gradient, 1, norm));
    CHECK(std::fabs(norm[0] - std::sqrt(0.5f)) < 1e-6f);
    SUCCEED(nf::importance::gradient(gradient, 2, parts, nf::importance::split::sign));
    CHECK(parts[0] == 0.5f && parts[1] == 0.5f);
    CHECK(CODE(nf::importance::gradient(gradient, 0, parts)) == nf::status::range);
    CHECK(CODE(nf::importance::gradient({}, 1, norm)) == nf::status::length);
    // No rows, as a process has to which nf_shards_allocate() gave none.
    SUCCEED(nf::importance::cross_entropy({}, {}, {}));
    SUCCEED(nf::importance::squared_error({}, {}, {}));
    SUCCEED(nf::importance::gradient({}, 1, {}));
    SUCCEED(nf::importance::gradient({}, 4, {}));
    SUCCEED(nf::importance::gradient({}, 4, {}, nf::importance::split::sign));
    CHECK(CODE(nf::importance::gradient({}, 3, {}, nf::importance::split::sign)) == nf::status::range);
    CHECK(CODE(nf::importance::squared_error(logits, target, {})) == nf::status::length);
    std::uint32_t order[5], rest[3];
    SUCCEED(nf::shuffle(1, 5, 0, order));
    SUCCEED(nf::shuffle(1, 5, 2, rest));
    CHECK(std::memcmp(rest, order + 2, sizeof rest) == 0 && CODE(nf::shuffle(1, 0, 0, rest)) == nf::status::range);
}

static void gradients()
{
    const float pdf[] = {0.1f, 0.2f, 0.3f, 0.1f}, each[] = {1.0f, 2.0f};
    const std::uint32_t technique[] = {0, 1};
    std::vector<std::uint64_t> room(nf::optimal_gradient::size(2, 1) / 8 + 1);
    nf::optimal_gradient state = value_of(nf::optimal_gradient::create(2, 1, room));
    std::array<float, 1> out{};
    float weight[2];
    SUCCEED(state.estimate(10, pdf, technique, each, out));
    SUCCEED(nf::omis_weights(2, 10, pdf, technique, weight));
    CHECK(std::fabs(out[0] - (weight[0] + 2.0f * weight[1]) / 2.0f) < 1e-5f);
    CHECK(state.handle() == static_cast<void *>(room.data()));
    CHECK(CODE(state.estimate(10, pdf, technique, {each, 1}, out)) == nf::status::length);
    CHECK(CODE(state.estimate(10, {}, {}, {}, out)) == nf::status::no_samples);
    CHECK(CODE(state.estimate(10, {}, {}, each, out)) == nf::status::length);
    CHECK(CODE(nf::optimal_gradient::create(2, 1, {room.data(), 8})) == nf::status::memory);
    CHECK(CODE(nf::optimal_gradient::create(17, 1, room)) == nf::status::range);
}

static void recommendations()
{
    nf_recommendation expected;
    CHECK_STATUS(nf_recommend(2, 4, NF_SAMPLING_STRATIFIED, 1, INFINITY, &expected), NF_OK);
    const nf_recommendation actual = value_of(nf::recommend(2, 4, nf::sampling::stratified, true));
    CHECK(actual.method == expected.method && actual.config.order == expected.config.order);
    CHECK_STATUS(nf_recommend(2, 4, NF_SAMPLING_INDEPENDENT, 0, INFINITY, &expected), NF_OK);
    CHECK(value_of(nf::recommend(2, 4, nf::sampling::independent, false)).method == expected.method);
    CHECK(CODE(nf::recommend(0, 4, nf::sampling::independent, false)) == nf::status::range);
}

int main()
{
    CHECK(nf::abi_matches());
    fill_uniform(u, n * 2, 3);
    fill_linear(f, u, n, 2, 1);
    views();
    lifetimes();
    configurations();
    estimates();
    images();
    accumulators();
    resumed_accumulators();
    not_made();
#ifndef NOISEFLOOR_NO_EXCEPTIONS
    words();
#endif
    mis();
    samplers();
    tiles();
    random_numbers();
    minibatches();
    importances();
    gradients();
    recommendations();
    return report("wrapper");
}
