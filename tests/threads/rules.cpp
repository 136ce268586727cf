// What the header says of threads: any number may read an object, one at a time may write it. Without arguments the
// rules are kept; `accumulator`, `table`, `generator` and `tile` each break one, which a race detector must find.
#include "noisefloor.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <string>
#include <thread>
#include <vector>

namespace {

constexpr unsigned threads = 3, tiles = 8, rounds = 20;
constexpr std::size_t samples = 64;
constexpr std::uint32_t items = 1000, batch = 32;

void check(nf_status status, const char *what)
{
    if (status != NF_OK) {
        std::fprintf(stderr, "%s: %s\n", what, nf_status_message(status));
        std::abort();
    }
}

// Calls work(0), work(1), ... at the same time.
void run(const std::function<void(unsigned)> &work)
{
    std::vector<std::thread> running;
    for (unsigned i = 0; i < threads; ++i)
        running.emplace_back(work, i);
    for (std::thread &thread : running)
        thread.join();
}

nf_cv_config config()
{
    nf_cv_config result = {};
    result.dims = 2;
    result.channels = 1;
    result.order = 2;
    return result;
}

class Accumulator {
public:
    Accumulator() : memory_(nf_cv_accumulator_size(&config_, &workspace_) / 8 + 1)
    {
        check(nf_cv_accumulator_init(memory_.data(), memory_.size() * 8, &config_, &state), "nf_cv_accumulator_init");
    }

    // Reads the accumulator; the workspace is the thread's own.
    nf_estimate estimate() const
    {
        std::vector<double> work(workspace_ / 8 + 1);
        nf_estimate out;
        check(nf_cv_accumulator_estimate(state, work.data(), work.size() * 8, &out), "nf_cv_accumulator_estimate");
        return out;
    }

private:
    nf_cv_config config_ = config();
    std::size_t workspace_ = 0;
    std::vector<double> memory_;

public:
    nf_cv_accumulator *state = nullptr;
};

// Threads share out the tiles of an image, beforehand: a counter of tiles would put their work in an order, and hide
// races. Each tile has an accumulator; they are merged in the order of the tiles.
bool render(bool shared)
{
    const nf_tile blue = nf_tile_64_4spp_2d;
    std::vector<Accumulator> accumulators(tiles);
    run([&](unsigned thread) {
        for (unsigned tile = thread; tile < tiles; tile += threads) {
            float u[2 * samples], f[samples];
            for (std::uint32_t i = 0; i < samples; ++i) {
                // All threads read the same nf_tile.
                const nf_tile_sampler pixel = nf_tile_sampler_pixel(&blue, tile, 0, 0, i);
                nf_tile_sampler_draw(nf_tile_sampler_domain(pixel, 1), 2, u + 2 * i);
                f[i] = u[2 * i] + u[2 * i + 1];
            }
            nf_cv_samples all{};
            all.u = u, all.f = f, all.n = samples;
            check(nf_cv_accumulator_add(accumulators[shared ? 0 : tile].state, &all), "nf_cv_accumulator_add");
        }
    });
    Accumulator image;
    for (const Accumulator &tile : accumulators)
        check(nf_cv_accumulator_merge(image.state, tile.state), "nf_cv_accumulator_merge");
    // All threads read the same accumulator.
    const nf_estimate out = image.estimate();
    std::vector<nf_estimate> others(threads);
    run([&](unsigned thread) { others[thread] = image.estimate(); });
    bool same = true;
    for (const nf_estimate &other : others)
        same = same && std::memcmp(&other, &out, sizeof out) == 0;
    std::printf("%u samples, %g\n", static_cast<unsigned>(out.samples), static_cast<double>(out.mean[0]));
    return same && out.samples == tiles * samples && out.mean[0] > 0.9f && out.mean[0] < 1.1f;
}

// Loaders draw from one table, each with a generator; then one thread updates it, and they draw again.
bool load(bool updating, bool one_generator)
{
    std::vector<std::uint64_t> memory(nf_table_size(items) / 8 + 1);
    nf_table table;
    check(nf_table_init(&table, memory.data(), memory.size() * 8, items, nullptr), "nf_table_init");
    nf_rng generators[threads];
    for (unsigned i = 0; i < threads; ++i)
        nf_rng_seed(&generators[i], i);
    std::vector<float> sums(threads);
    for (int pass = 0; pass < 2; ++pass) {
        run([&](unsigned thread) {
            std::uint32_t index[batch];
            float weight[batch];
            for (unsigned round = 0; round < rounds; ++round) {
                check(nf_table_draw(&table, &generators[one_generator ? 0 : thread], batch, index, weight),
                      "nf_table_draw");
                for (float one : weight)
                    sums[thread] += one;
                if (updating && thread == 0)
                    check(nf_table_update(&table, index, weight, batch, 0.5f), "nf_table_update");
            }
        });
        const std::uint32_t item = 7;
        const float importance = 30.0f;
        check(nf_table_update(&table, &item, &importance, 1, 0.0f), "nf_table_update");
    }
    // The mean weight is 1, whatever the importances are.
    bool right = true;
    for (float sum : sums)
        right = right && sum > 0.7f * 2 * rounds * batch && sum < 1.3f * 2 * rounds * batch;
    return right;
}

// An nf_tile that is read while another thread makes it anew.
void remake_tile()
{
    nf_tile tile = nf_tile_64_1spp_2d;
    run([&](unsigned thread) {
        float u[2];
        for (std::uint32_t i = 0; i < rounds; ++i)
            if (thread == 0)
                tile = i % 2 == 0 ? nf_tile_64_1spp_2d : nf_tile_64_4spp_2d;
            else
                nf_tile_sampler_draw(nf_tile_sampler_pixel(&tile, i, thread, 0, 0), 2, u);
    });
}

} // namespace

int main(int count, char **arguments)
{
    const std::string broken = count > 1 ? arguments[1] : "";
    if (broken.empty())
        return render(false) && load(false, false) ? 0 : 1;
    if (broken == "accumulator")
        render(true);
    else if (broken == "table")
        load(true, false);
    else if (broken == "generator")
        load(false, true);
    else if (broken == "tile")
        remake_tile();
    else
        return 2;
}
