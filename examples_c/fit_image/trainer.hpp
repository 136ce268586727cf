// One network on its way to a picture.
#pragma once
#include "network.hpp"
#include "options.hpp"
#include "picture.hpp"
#include "sampler.hpp"
#include <cmath>
#include <cstdint>
#include <vector>

namespace fit {

class Trainer {
public:
    Trainer(const Picture &picture, const Options &options, std::uint64_t seed)
        : picture_(picture), batch_(options.batch), rate_(options.rate), rng_(seeded(seed)),
          network_(options.width, options.batch, rng_), points_(Network::INPUTS * batch_),
          target_(Network::OUTPUTS * batch_), derivative_(Network::OUTPUTS * batch_)
    {
    }

    const Network &network() const { return network_; }
    const std::vector<float> &gradient() const { return gradient_; }

    // gradient() becomes the estimate from a batch, and `sampler` learns its importances.
    void estimate(Sampler &sampler, bool learn)
    {
        sampler.draw();
        load(sampler.index().data());
        const std::vector<float> &output = network_.forward(points_.data());
        backward(output, sampler.weight().data());
        if (learn)
            sampler.update(output.data(), target_.data());
    }

    // A batch that only the sampler learns from.
    void visit(Sampler &sampler)
    {
        sampler.draw();
        load(sampler.index().data());
        sampler.update(network_.forward(points_.data()).data(), target_.data());
    }

    // `rest`: the part of the steps yet to come. The learning rate falls with it to nought, or else the last few
    // batches' noise decides what the network is like at the end.
    void step(float rest) { optimiser_.step(rate_ * rest, gradient_, network_.parameters()); }

    // output[3][pixels], of the whole picture.
    void evaluate(std::vector<float> &output)
    {
        each_block([&](std::size_t first, std::size_t count) {
            const std::vector<float> &block = network_.forward(points_.data());
            for (std::size_t c = 0; c < 3; ++c)
                for (std::size_t k = 0; k < count; ++k)
                    output[c * picture_.pixels() + first + k] = block[c * batch_ + k];
        });
    }

    // The mean over the picture of a pixel's gradient.
    std::vector<double> exact_gradient()
    {
        std::vector<double> sum(network_.parameters().size());
        each_block([&](std::size_t, std::size_t count) {
            const std::vector<float> &output = network_.forward(points_.data());
            std::vector<float> weight(batch_); // those that stand for no pixel: 0
            std::fill_n(weight.begin(), count, float(batch_) / float(picture_.pixels()));
            backward(output, weight.data());
            for (std::size_t i = 0; i < sum.size(); ++i)
                sum[i] += double(gradient_[i]);
        });
        return sum;
    }

private:
    static nf_rng seeded(std::uint64_t seed)
    {
        nf_rng rng;
        nf_rng_seed(&rng, seed);
        return rng;
    }

    void load(const std::uint32_t *index)
    {
        for (std::size_t k = 0; k < batch_; ++k) {
            points_[k] = picture_.x(index[k]);
            points_[batch_ + k] = picture_.y(index[k]);
            for (std::size_t c = 0; c < 3; ++c)
                target_[c * batch_ + k] = picture_.value(index[k], c);
        }
    }

    // One backward pass, whatever the weights: the loss of a pixel is the sum of its channels' squared errors.
    void backward(const std::vector<float> &output, const float *weight)
    {
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t k = 0; k < batch_; ++k) {
                const std::size_t i = c * batch_ + k;
                derivative_[i] = 2.0f * (output[i] - target_[i]) * weight[k] / float(batch_);
            }
        network_.backward(derivative_.data(), gradient_);
    }

    template <typename Action> void each_block(Action action)
    {
        std::vector<std::uint32_t> index(batch_);
        for (std::size_t first = 0; first < picture_.pixels(); first += batch_) {
            const std::size_t count = std::min(batch_, picture_.pixels() - first);
            for (std::size_t k = 0; k < batch_; ++k)
                index[k] = std::uint32_t(first + std::min(k, count - 1));
            load(index.data());
            action(first, count);
        }
    }

    const Picture &picture_;
    std::size_t batch_;
    float rate_;
    nf_rng rng_;
    Network network_;
    Adam optimiser_;
    std::vector<float> points_, target_, derivative_, gradient_;
};

// The targets of a whole picture, [3][pixels].
inline std::vector<float> targets(const Picture &picture)
{
    std::vector<float> values(3 * picture.pixels());
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < picture.pixels(); ++i)
            values[c * picture.pixels() + i] = picture.value(i, c);
    return values;
}

// The mean squared error of a channel, white being 1 and black 0.
inline double mean_squared_error(const std::vector<float> &output, const std::vector<float> &target)
{
    double sum = 0.0;
    for (std::size_t i = 0; i < output.size(); ++i)
        sum += std::pow(0.5 * (double(output[i]) - double(target[i])), 2.0);
    return sum / double(output.size());
}

} // namespace fit
