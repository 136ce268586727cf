/* The command line. */
#ifndef FIT_POLYNOMIAL_OPTIONS_H
#define FIT_POLYNOMIAL_OPTIONS_H

#include "common.h"
#include <math.h>
#include <string.h>

#define MAX_TABLES 4
#define MAX_BATCH 1024

typedef struct options {
    uint32_t items, batch, steps, seeds, batches;
    double rate, noise, uniform_fraction, momentum, beta;
    int variance;
} options;

static void usage(FILE *to)
{
    fputs("usage: fit_polynomial [options]\n"
          "  --variance            errors of the gradient estimates at the same states, instead of training\n"
          "  --items N             data points [1000]\n"
          "  --batch N             items of a minibatch, a multiple of 4 [32]\n"
          "  --steps N             steps of Adam [3000]\n"
          "  --seeds N             problems and runs to average [10]\n"
          "  --batches N           minibatches per state of --variance [2000]\n"
          "  --rate R              Adam's learning rate [.003]\n"
          "  --noise S             standard deviation of noise added to the points [0]\n"
          "  --uniform-fraction D  part of every distribution that is uniform [.2]\n"
          "  --momentum M          how much of an importance is kept when its item is visited [0]\n"
          "  --beta B              add omis4-beta: optimal MIS with momentum B over the steps [0: leave it out]\n",
          to);
}

static double number(const char *name, const char *text, double low, double high)
{
    char *end = NULL;
    double value = text ? strtod(text, &end) : 0.0;
    if (!text)
        fail("%s: its value is missing: a number from %g to %g", name, low, high);
    if (end == text || *end || !(value >= low && value <= high))
        fail("%s: `%s` is not a number from %g to %g", name, text, low, high);
    return value;
}

static uint32_t whole(const char *name, const char *text, double low, double high)
{
    double value = number(name, text, low, high);
    if (value != floor(value))
        fail("%s: `%s` is not a whole number", name, text);
    return (uint32_t)value;
}

static options parse(int argc, char **argv)
{
    options o = {1000, 32, 3000, 10, 2000, 0.003, 0.0, 0.2, 0.0, 0.0, 0};
    for (int i = 1; i < argc; ++i) {
        const char *name = argv[i], *text = i + 1 < argc ? argv[i + 1] : NULL;
        if (strcmp(name, "--help") == 0) {
            usage(stdout);
            if (fflush(stdout) != 0)
                fail("standard output cannot be written");
            exit(0);
        }
        if (strcmp(name, "--variance") == 0) {
            o.variance = 1;
            continue;
        }
        ++i;
        if (strcmp(name, "--items") == 0)
            o.items = whole(name, text, 32, 1e7);
        else if (strcmp(name, "--batch") == 0)
            o.batch = whole(name, text, MAX_TABLES, MAX_BATCH);
        else if (strcmp(name, "--steps") == 0)
            o.steps = whole(name, text, 1, 1e7);
        else if (strcmp(name, "--seeds") == 0)
            o.seeds = whole(name, text, 1, 1e4);
        else if (strcmp(name, "--batches") == 0)
            o.batches = whole(name, text, 2, 1e6);
        else if (strcmp(name, "--rate") == 0)
            o.rate = number(name, text, 1e-9, 10.0);
        else if (strcmp(name, "--noise") == 0)
            o.noise = number(name, text, 0.0, 1e3);
        else if (strcmp(name, "--uniform-fraction") == 0)
            o.uniform_fraction = number(name, text, 1e-3, 1.0);
        else if (strcmp(name, "--momentum") == 0)
            o.momentum = number(name, text, 0.0, 0.99);
        else if (strcmp(name, "--beta") == 0)
            o.beta = number(name, text, 0.0, 0.99);
        else {
            usage(stderr);
            fail("there is no option `%s`", name);
        }
    }
    if (o.batch % MAX_TABLES != 0)
        fail("--batch: %u is not a multiple of %d", (unsigned)o.batch, MAX_TABLES);
    if (o.batch > o.items)
        fail("--batch: %u is more than --items, %u", (unsigned)o.batch, (unsigned)o.items);
    return o;
}

#endif
