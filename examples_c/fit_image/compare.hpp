// What the program prints: losses of networks trained by each method, or errors of the methods' gradients.
#pragma once
#include "trainer.hpp"
#include <memory>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

namespace fit {

inline void write_pictures(const std::string &prefix, const Picture &picture, const std::vector<float> &output)
{
    Picture result = picture, error = picture;
    for (std::size_t i = 0; i < picture.pixels(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const float value = output[c * picture.pixels() + i];
            result.bytes[3 * i + c] = to_byte(value);
            error.bytes[3 * i + c] =
                to_byte(4.0f * std::abs(value - picture.value(i, c)) - 1.0f); // eight times too bright
        }
    write_ppm(prefix + ".ppm", result);
    write_ppm(prefix + ".error.ppm", error);
}

inline double decibels(double squared_error) { return -10.0 * std::log10(squared_error); }

// method,seed,step,seconds,loss,psnr: processor seconds of the steps, without evaluating the whole picture.
inline void compare_training(const Picture &picture, const Options &options)
{
    const std::vector<float> target = targets(picture);
    std::vector<float> output(target.size());
    struct Sums {
        double loss = 0.0, square = 0.0, seconds = 0.0;
    };
    std::vector<Sums> sums(options.chosen.size());
    std::printf("method,seed,step,seconds,loss,psnr\n");
    // Seed by seed, so that what else the machine does befalls all methods alike.
    for (std::uint32_t seed = 1; seed <= options.seeds; ++seed)
        for (std::size_t m = 0; m < options.chosen.size(); ++m) {
            const Method &method = *options.chosen[m];
            Trainer trainer(picture, options, seed);
            // Not the numbers that the network begins with.
            Sampler sampler(method, std::uint32_t(picture.pixels()), options.batch, options.uniform_fraction,
                            options.momentum, options.stratified, seed + 1000);
            double seconds = 0.0, loss = 0.0;
            std::uint32_t step = 0;
            for (std::uint32_t record = 1; record <= options.records; ++record) {
                const std::clock_t start = std::clock();
                for (; step < std::uint64_t(options.steps) * record / options.records; ++step) {
                    trainer.estimate(sampler, true);
                    trainer.step(1.0f - float(step) / float(options.steps));
                }
                seconds += double(std::clock() - start) / CLOCKS_PER_SEC;
                trainer.evaluate(output);
                loss = mean_squared_error(output, target);
                if (!std::isfinite(loss))
                    throw std::runtime_error(std::string(method.name) + ": the loss is not finite any more");
                std::printf("%s,%u,%u,%.3f,%.6e,%.3f\n", method.name, unsigned(seed), unsigned(step), seconds, loss,
                            decibels(loss));
            }
            std::fflush(stdout);
            if (seed == 1 && !options.output.empty())
                write_pictures(options.output + "." + method.name, picture, output);
            sums[m].loss += loss / options.seeds;
            sums[m].square += loss * loss / options.seeds;
            sums[m].seconds += seconds / options.seeds;
        }
    std::fputs("| method   | mean squared error | standard error |  PSNR | us per step |\n"
               "| -------- | -----------------: | -------------: | ----: | ----------: |\n",
               stderr);
    for (std::size_t m = 0; m < sums.size(); ++m) {
        const double spread = std::max(0.0, sums[m].square - sums[m].loss * sums[m].loss);
        std::fprintf(stderr, "| %-8s | %18.4e | ", options.chosen[m]->name, sums[m].loss);
        if (options.seeds > 1)
            std::fprintf(stderr, "%14.1e", std::sqrt(spread / (options.seeds - 1)));
        else
            std::fprintf(stderr, "%14s", "-");
        std::fprintf(stderr, " | %5.2f | %11.0f |\n", decibels(sums[m].loss), 1e6 * sums[m].seconds / options.steps);
    }
}

// Squared errors of gradient estimates, for each parameter.
inline std::vector<double> errors(Trainer &trainer, Sampler &sampler, const std::vector<double> &exact,
                                  std::uint32_t batches)
{
    std::vector<double> sum(exact.size());
    for (std::uint32_t b = 0; b < batches; ++b) {
        trainer.estimate(sampler, false);
        for (std::size_t i = 0; i < exact.size(); ++i)
            sum[i] += std::pow(double(trainer.gradient()[i]) - exact[i], 2.0) / batches;
    }
    return sum;
}

// step,method,tables,distance,parameter: mean squared errors of the estimates over those of uniform sampling: summed
// over the parameters, and as the mean over the parameters of their own ratios. Tables as they are after visiting a
// batch per step ("kept"), and fresh. All on the way of one network trained with uniform batches.
inline void compare_errors(const Picture &picture, const Options &options)
{
    const std::uint32_t pixels = std::uint32_t(picture.pixels());
    const std::uint32_t epoch = (pixels + options.batch - 1) / options.batch;
    if (options.steps <= epoch)
        throw std::runtime_error("--variance: the tables start after an epoch, so --steps must be above " +
                                 std::to_string(epoch) + ", not " + std::to_string(options.steps));
    std::vector<std::uint32_t> states = {epoch};
    for (std::uint32_t step = options.steps / 4; step <= options.steps; step += std::max(1u, options.steps / 4))
        if (step > epoch)
            states.push_back(step);
    const std::vector<float> target = targets(picture);
    std::vector<float> output(target.size());
    const auto sampler = [&](const Method &method, std::uint64_t seed) {
        return std::make_unique<Sampler>(method, pixels, options.batch, options.uniform_fraction, options.momentum,
                                         options.stratified, seed);
    };
    struct Ratio {
        double distance = 0.0, parameter = 0.0;
    };
    const std::size_t count = options.chosen.size();
    std::vector<Ratio> ratios(states.size() * count * 2);
    for (std::uint32_t seed = 1; seed <= options.seeds; ++seed) {
        Trainer trainer(picture, options, seed);
        const std::unique_ptr<Sampler> way = sampler(methods()[0], seed);
        std::vector<std::unique_ptr<Sampler>> kept;
        for (const Method *method : options.chosen)
            kept.push_back(sampler(*method, seed + 1000));
        std::size_t state = 0;
        for (std::uint32_t step = 1; state < states.size(); ++step) {
            trainer.estimate(*way, true);
            trainer.step(1.0f - float(step - 1) / float(options.steps));
            for (const std::unique_ptr<Sampler> &each : kept)
                trainer.visit(*each);
            if (step != states[state])
                continue;
            const std::vector<double> exact = trainer.exact_gradient();
            trainer.evaluate(output);
            const std::unique_ptr<Sampler> uniform = sampler(methods()[0], seed + 2000);
            const std::vector<double> reference = errors(trainer, *uniform, exact, 4 * options.batches);
            for (std::size_t m = 0; m < count; ++m)
                for (int fresh = 0; fresh < 2; ++fresh) {
                    const std::unique_ptr<Sampler> other = sampler(*options.chosen[m], seed + 3000);
                    if (fresh)
                        other->refresh(output.data(), target.data());
                    const std::vector<double> error =
                        errors(trainer, fresh ? *other : *kept[m], exact, options.batches);
                    double ours = 0.0, theirs = 0.0, mean = 0.0;
                    for (std::size_t i = 0; i < error.size(); ++i) {
                        ours += error[i];
                        theirs += reference[i];
                        mean += error[i] / reference[i] / double(error.size());
                    }
                    Ratio &ratio = ratios[(state * count + m) * 2 + std::size_t(fresh)];
                    ratio.distance += ours / theirs / options.seeds;
                    ratio.parameter += mean / options.seeds;
                }
            ++state;
        }
    }
    std::printf("step,method,tables,distance,parameter\n");
    std::fputs("| step | method   | kept tables: distance | parameter | fresh tables: distance | parameter |\n"
               "| ---: | -------- | --------------------: | --------: | ---------------------: | --------: |\n",
               stderr);
    for (std::size_t state = 0; state < states.size(); ++state)
        for (std::size_t m = 0; m < count; ++m) {
            const Ratio *ratio = &ratios[(state * count + m) * 2];
            for (int fresh = 0; fresh < 2; ++fresh)
                std::printf("%u,%s,%s,%.6e,%.6e\n", unsigned(states[state]), options.chosen[m]->name,
                            fresh ? "fresh" : "kept", ratio[fresh].distance, ratio[fresh].parameter);
            std::fprintf(stderr, "| %4u | %-8s | %21.3f | %9.3f | %22.3f | %9.3f |\n", unsigned(states[state]),
                         options.chosen[m]->name, ratio[0].distance, ratio[0].parameter, ratio[1].distance,
                         ratio[1].parameter);
        }
}

} // namespace fit
