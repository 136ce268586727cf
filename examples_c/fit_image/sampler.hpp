// Minibatches of pixels: what noisefloor does.
#pragma once
#include "noisefloor.h"
#include <algorithm>
#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace fit {

// How minibatches are drawn.
struct Method {
    const char *name;
    std::uint32_t tables;
    std::uint32_t split;  // of the three channels' derivatives among the tables: NF_NODES_*
    std::uint32_t solver; // NF_OMIS_*
    const char *what;
};

inline const std::array<Method, 6> &methods()
{
    static const std::array<Method, 6> all = {{
        {"uniform", 0, NF_NODES_NORM, NF_OMIS_RIDGE, "every pixel once per epoch"},
        {"is", 1, NF_NODES_NORM, NF_OMIS_RIDGE, "one table: the norm of the loss's derivatives by the channels"},
        {"balance3", 3, NF_NODES_NORM, NF_OMIS_BALANCE, "the tables of omis3, balance heuristic"},
        {"omis3", 3, NF_NODES_NORM, NF_OMIS_RIDGE, "a table for each channel, optimal MIS"},
        {"balance6", 6, NF_NODES_SIGN, NF_OMIS_BALANCE, "the tables of omis6, balance heuristic"},
        {"omis6", 6, NF_NODES_SIGN, NF_OMIS_RIDGE, "a table for each channel and sign, optimal MIS"},
    }};
    return all;
}

inline void check(nf_status status, const char *what)
{
    if (status != NF_OK)
        throw std::runtime_error(std::string(what) + ": " + nf_status_message(status));
}

class Sampler {
public:
    static constexpr std::uint32_t MAX_TABLES = 6;

    // uniform_fraction: part of every distribution that is uniform; momentum: how much of an importance is kept when
    // its pixel is visited. stratified: see nf_table_draw_stratified.
    Sampler(const Method &method, std::uint32_t items, std::uint32_t batch, float uniform_fraction, float momentum,
            bool stratified, std::uint64_t seed)
        : method_(method), items_(items), batch_(batch), uniform_fraction_(uniform_fraction), momentum_(momentum),
          draw_(stratified ? nf_table_draw_stratified : nf_table_draw), shuffle_(seed << 32), index_(batch),
          technique_(batch), weight_(batch),
          pdf_(std::size_t(batch) * MAX_TABLES)
    {
        nf_rng_seed(&rng_, seed);
        for (std::uint32_t j = 0; j < method.tables; ++j) {
            memory_[j].resize((nf_table_size(items) + 7) / 8);
            initial_[j].resize(items);
        }
    }

    Sampler(const Sampler &) = delete; // A table points into memory_.
    Sampler &operator=(const Sampler &) = delete;

    const Method &method() const { return method_; }
    bool started() const { return started_; }
    const std::vector<std::uint32_t> &index() const { return index_; }
    // The gradient of the mean loss is about the mean over the batch of weight * gradient.
    const std::vector<float> &weight() const { return weight_; }

    void draw()
    {
        if (!started_) { // The initial epoch, and uniform sampling: without replacement, all weights 1.
            for (std::uint32_t k = 0; k < batch_; ++k, ++position_) {
                check(nf_shuffle(shuffle_ + position_ / items_, items_, position_, 1, &index_[k]), "nf_shuffle");
                weight_[k] = 1.0f;
            }
            return;
        }
        if (method_.tables == 1) {
            check(draw_(&tables_[0], &rng_, batch_, index_.data(), weight_.data()), "nf_table_draw");
            return;
        }
        // As nearly as possible the same number from each table.
        std::uint32_t at = 0;
        for (std::uint32_t j = 0; j < method_.tables; ++j) {
            const std::uint32_t count = batch_ / method_.tables + (j < batch_ % method_.tables);
            check(draw_(&tables_[j], &rng_, count, &index_[at], nullptr), "nf_table_draw");
            std::fill_n(&technique_[at], count, j);
            at += count;
        }
        for (std::uint32_t j = 0; j < method_.tables; ++j)
            check(nf_table_probabilities(&tables_[j], index_.data(), batch_, method_.tables, &pdf_[j]),
                  "nf_table_probabilities");
        check(nf_omis_weights(method_.solver, 0.0f, method_.tables, items_, pdf_.data(), technique_.data(), batch_,
                              weight_.data()),
              "nf_omis_weights");
    }

    // output[3][batch], target[3][batch] of the batch that was drawn: their importances are known now, at no cost.
    void update(const float *output, const float *target)
    {
        for (std::uint32_t k = 0; k < batch_; ++k) {
            std::array<float, MAX_TABLES> q{};
            importance(output + k, target + k, batch_, q.data());
            for (std::uint32_t j = 0; j < method_.tables; ++j) {
                pdf_[std::size_t(j) * batch_ + k] = q[j];
                if (!started_)
                    initial_[j][index_[k]] = q[j];
            }
        }
        if (started_)
            for (std::uint32_t j = 0; j < method_.tables; ++j)
                check(nf_table_update(&tables_[j], index_.data(), &pdf_[std::size_t(j) * batch_], batch_, momentum_),
                      "nf_table_update");
        else if (method_.tables > 0 && position_ >= items_) // All pixels have been seen.
            start();
    }

    // Replaces the importance of every pixel. output[3][items], target[3][items].
    void refresh(const float *output, const float *target)
    {
        for (std::uint32_t i = 0; i < items_; ++i) {
            std::array<float, MAX_TABLES> q{};
            importance(output + i, target + i, items_, q.data());
            for (std::uint32_t j = 0; j < method_.tables; ++j)
                initial_[j][i] = q[j];
        }
        if (method_.tables > 0)
            start();
    }

private:
    // Channels lie `stride` numbers apart.
    void importance(const float *output, const float *target, std::size_t stride, float *q) const
    {
        const float outputs[3] = {output[0], output[stride], output[2 * stride]};
        const float targets[3] = {target[0], target[stride], target[2 * stride]};
        if (method_.tables == 1) {
            check(nf_importance_squared_error(outputs, targets, 1, 3, q), "nf_importance_squared_error");
        } else if (method_.tables > 1) {
            float derivatives[3];
            for (int c = 0; c < 3; ++c)
                derivatives[c] = 2.0f * (outputs[c] - targets[c]);
            check(nf_importance_gradient(derivatives, 1, 3, method_.split, method_.tables, q),
                  "nf_importance_gradient");
        }
    }

    void start()
    {
        for (std::uint32_t j = 0; j < method_.tables; ++j) {
            // Where no derivative has the table's sign, it has nothing to draw by: it is uniform until a visit finds
            // one.
            if (*std::max_element(initial_[j].begin(), initial_[j].end()) == 0.0f)
                std::fill(initial_[j].begin(), initial_[j].end(), 1e-20f);
            const std::size_t bytes = memory_[j].size() * sizeof(std::uint64_t);
            check(nf_table_init(&tables_[j], memory_[j].data(), bytes, items_, initial_[j].data()), "nf_table_init");
            tables_[j].uniform_fraction = uniform_fraction_;
        }
        started_ = true;
    }

    const Method &method_;
    std::uint32_t items_, batch_;
    float uniform_fraction_, momentum_;
    decltype(&nf_table_draw) draw_;
    nf_rng rng_;
    std::uint64_t shuffle_, position_ = 0; // seed of the permutations, and where in them
    bool started_ = false;
    std::array<nf_table, MAX_TABLES> tables_{};
    std::array<std::vector<std::uint64_t>, MAX_TABLES> memory_;
    std::array<std::vector<float>, MAX_TABLES> initial_; // importances seen while the tables do not exist yet
    std::vector<std::uint32_t> index_, technique_;
    std::vector<float> weight_, pdf_;
};

} // namespace fit
