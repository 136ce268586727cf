// Figure 6.13 of the thesis: a network learns the colours of a photograph from the coordinates of its pixels, minibatch
// by minibatch, with batches drawn and weighted in several ways. C++17.
//
//   c++ -std=c++17 -O3 -march=native -Iinclude examples_c/fit_image.cpp target/noisefloor/libnoisefloor.a -o fit_image
//   ./fit_image --output cat > losses.csv   # cat.METHOD.ppm, cat.METHOD.error.ppm; a table on standard error
//   ./fit_image --variance > errors.csv     # of the gradient estimates, over uniform sampling's
//
// To see how the library is used, read fit_image/sampler.hpp.
#include "fit_image/compare.hpp"
#include <exception>

int main(int argc, char **argv)
{
    try {
        const fit::Options options = fit::parse(argc, argv);
        if (options.help) {
            fit::usage();
        } else {
            const fit::Picture picture = fit::read_ppm(options.image);
            if (options.batch > picture.pixels())
                throw std::runtime_error("--batch: " + std::to_string(options.batch) + " is more than the picture's " +
                                         std::to_string(picture.pixels()) + " pixels");
            (options.variance ? fit::compare_errors : fit::compare_training)(picture, options);
        }
        if (std::fflush(stdout) != 0 || std::ferror(stdout))
            throw std::runtime_error("standard output cannot be written");
    } catch (const std::exception &error) {
        std::fprintf(stderr, "fit_image: %s\n", error.what());
        return 1;
    }
    return 0;
}
