// What the header says of threads: each has an accumulator of its own, and one merges them when all are done. The first
// argument `race` lets all threads add to one accumulator instead, which a race detector must find.
#include "noisefloor.h"

#include <cstdio>
#include <cstring>
#include <thread>
#include <vector>

namespace {

constexpr std::size_t samples = 64;
constexpr unsigned threads = 3;

struct Accumulator {
    std::vector<double> memory;
    nf_cv_accumulator *state = nullptr;

    explicit Accumulator(const nf_cv_config &config)
        : memory(nf_cv_accumulator_size(&config, nullptr) / sizeof(double) + 1)
    {
        if (nf_cv_accumulator_init(memory.data(), memory.size() * sizeof(double), &config, &state) != NF_OK)
            std::fprintf(stderr, "the accumulator was refused\n");
    }
};

// Samples of x + y, which differ between threads.
void add(nf_cv_accumulator *accumulator, std::uint32_t thread)
{
    float u[2 * samples], f[samples];
    nf_rng rng;
    nf_rng_seed(&rng, thread);
    for (std::size_t i = 0; i < samples; ++i) {
        u[2 * i] = nf_rng_uniform(&rng);
        u[2 * i + 1] = nf_rng_uniform(&rng);
        f[i] = u[2 * i] + u[2 * i + 1];
    }
    nf_cv_samples all{};
    all.u = u, all.f = f, all.n = samples;
    nf_cv_accumulator_add(accumulator, &all);
}

} // namespace

int main(int count, char **arguments)
{
    const bool race = count > 1 && std::strcmp(arguments[1], "race") == 0;
    nf_cv_config config = {};
    config.dims = 2;
    config.channels = 1;
    config.order = 2;
    config.estimator = NF_CV_ROBUST;
    std::vector<Accumulator> accumulators;
    for (unsigned i = 0; i < threads; ++i)
        accumulators.emplace_back(config);
    std::vector<std::thread> running;
    for (unsigned i = 0; i < threads; ++i)
        running.emplace_back(add, accumulators[race ? 0 : i].state, i);
    for (std::thread &thread : running)
        thread.join();
    for (unsigned i = 1; i < threads && !race; ++i)
        if (nf_cv_accumulator_merge(accumulators[0].state, accumulators[i].state) != NF_OK)
            return 1;
    std::size_t bytes = 0;
    nf_cv_accumulator_size(&config, &bytes);
    std::vector<double> work(bytes / sizeof(double) + 1);
    nf_estimate out;
    if (nf_cv_accumulator_estimate(accumulators[0].state, work.data(), work.size() * sizeof(double), &out) != NF_OK)
        return 1;
    std::printf("%u samples, %g\n", static_cast<unsigned>(out.samples), static_cast<double>(out.mean[0]));
    return race || (out.samples == threads * samples && out.mean[0] > 0.9f && out.mean[0] < 1.1f) ? 0 : 1;
}
