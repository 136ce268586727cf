// A SIREN (Sitzmann et al. 2020): from a point of [-1, 1]^2 to three colours, fully connected layers with sines
// between.
#pragma once
#include "matrix.hpp"
#include "noisefloor.h"
#include "sine.hpp"
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace fit {

class Network {
public:
    static constexpr std::size_t LAYERS = 5, INPUTS = 2, OUTPUTS = 3;
    // What the first layer's sums are multiplied by: how fine the details are that it can see.
    static constexpr float OMEGA = 30.0f;

    // `batch`: how many points are evaluated at a time.
    Network(std::size_t width, std::size_t batch, nf_rng &rng) : batch_(batch)
    {
        std::size_t offset = 0;
        for (std::size_t i = 0; i < LAYERS; ++i) {
            Layer &layer = layers_[i];
            layer.inputs = i == 0 ? INPUTS : width;
            layer.outputs = i + 1 == LAYERS ? OUTPUTS : width;
            layer.weights = offset;
            layer.biases = offset + layer.inputs * layer.outputs;
            offset = layer.biases + layer.outputs;
            layer.in.resize(layer.inputs * batch);
            layer.slope.resize(layer.outputs * batch);
        }
        parameters_.resize(offset);
        // Uniform, so that sums have a standard deviation of about 1 in every layer.
        for (const Layer &layer : layers_) {
            const float inputs = float(layer.inputs);
            const float bound = &layer == &layers_[0] ? 1.0f / inputs : std::sqrt(6.0f / inputs);
            for (std::size_t k = 0; k < layer.inputs * layer.outputs; ++k)
                parameters_[layer.weights + k] = bound * (2.0f * nf_rng_uniform(&rng) - 1.0f);
            const float bias = 1.0f / std::sqrt(inputs);
            for (std::size_t k = 0; k < layer.outputs; ++k)
                parameters_[layer.biases + k] = bias * (2.0f * nf_rng_uniform(&rng) - 1.0f);
        }
        const std::size_t largest = std::max({width, OUTPUTS, INPUTS});
        sums_.resize(largest * batch);
        other_.resize(largest * batch);
        turned_.resize(largest * std::max(batch, largest));
        outputs_.resize(OUTPUTS * batch);
    }

    std::vector<float> &parameters() { return parameters_; }
    const std::vector<float> &parameters() const { return parameters_; }

    // points[INPUTS][batch] -> [OUTPUTS][batch], valid until the next call.
    const std::vector<float> &forward(const float *points)
    {
        std::copy(points, points + INPUTS * batch_, layers_[0].in.begin());
        for (std::size_t i = 0; i < LAYERS; ++i) {
            Layer &layer = layers_[i];
            const bool last = i + 1 == LAYERS;
            float *sums = last ? outputs_.data() : sums_.data();
            multiply(layer.outputs, layer.inputs, batch_, &parameters_[layer.weights], layer.in.data(), sums);
            const float scale = i == 0 ? OMEGA : 1.0f;
            for (std::size_t row = 0; row < layer.outputs; ++row) {
                const float bias = parameters_[layer.biases + row];
                for (std::size_t k = 0; k < batch_; ++k)
                    sums[row * batch_ + k] = scale * (sums[row * batch_ + k] + bias);
            }
            if (!last)
                sine_and_cosine(layer.outputs * batch_, sums, layers_[i + 1].in.data(), layer.slope.data());
        }
        return outputs_;
    }

    // After forward(): derivative[OUTPUTS][batch], of a sum over the batch by each output -> by each parameter.
    void backward(const float *derivative, std::vector<float> &gradient)
    {
        gradient.resize(parameters_.size());
        std::copy(derivative, derivative + OUTPUTS * batch_, sums_.begin());
        for (std::size_t i = LAYERS; i-- > 0;) {
            Layer &layer = layers_[i];
            // sums_ holds the derivatives by this layer's sums.
            transpose(layer.inputs, batch_, layer.in.data(), turned_.data());
            multiply(layer.outputs, batch_, layer.inputs, sums_.data(), turned_.data(), &gradient[layer.weights]);
            for (std::size_t row = 0; row < layer.outputs; ++row) {
                float sum = 0.0f;
                for (std::size_t k = 0; k < batch_; ++k)
                    sum += sums_[row * batch_ + k];
                gradient[layer.biases + row] = sum;
            }
            if (i == 0)
                break;
            transpose(layer.outputs, layer.inputs, &parameters_[layer.weights], turned_.data());
            multiply(layer.inputs, layer.outputs, batch_, turned_.data(), sums_.data(), other_.data());
            const std::vector<float> &slope = layers_[i - 1].slope;
            const float scale = i == 1 ? OMEGA : 1.0f;
            for (std::size_t k = 0; k < layer.inputs * batch_; ++k)
                sums_[k] = scale * slope[k] * other_[k];
        }
    }

private:
    struct Layer {
        std::size_t inputs, outputs, weights, biases; // the latter two: where they start among the parameters
        std::vector<float> in;                        // [inputs][batch]
        std::vector<float> slope;                     // [outputs][batch], the sine's derivative at the sums
    };

    std::size_t batch_;
    std::array<Layer, LAYERS> layers_;
    std::vector<float> parameters_, sums_, other_, turned_, outputs_;
};

// Kingma and Ba 2014.
class Adam {
public:
    void step(float learning_rate, const std::vector<float> &gradient, std::vector<float> &parameters)
    {
        mean_.resize(parameters.size());
        square_.resize(parameters.size());
        ++steps_;
        const float rate = learning_rate / float(1.0 - std::pow(0.9, steps_));
        const float scale = float(1.0 / (1.0 - std::pow(0.999, steps_)));
        for (std::size_t i = 0; i < parameters.size(); ++i) {
            mean_[i] = 0.9f * mean_[i] + 0.1f * gradient[i];
            square_[i] = 0.999f * square_[i] + 0.001f * gradient[i] * gradient[i];
            parameters[i] -= rate * mean_[i] / (std::sqrt(scale * square_[i]) + 1e-8f);
        }
    }

private:
    int steps_ = 0;
    std::vector<float> mean_, square_;
};

} // namespace fit
