/* The summary: test error at equal epochs and at equal time, over the seeds, with 95 % confidence intervals. */
#ifndef TRAIN_MLP_SUMMARY_H
#define TRAIN_MLP_SUMMARY_H

#include "options.h"
#include <math.h>

/* Test error against training time of one run: points + 1 of each. */
typedef struct curve {
    double *seconds, *error;
} curve;

/* Student's t, 97.5 %, for 1.. degrees of freedom. */
static double student(uint32_t freedom)
{
    static const double t[] = {12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228,
                               2.201,  2.179, 2.160, 2.145, 2.131, 2.120, 2.110, 2.101, 2.093, 2.086,
                               2.080,  2.074, 2.069, 2.064, 2.060, 2.056, 2.052, 2.048, 2.045, 2.042};
    return freedom > sizeof t / sizeof *t ? 1.96 + 2.5 / freedom : t[freedom - 1];
}

/* "mean +- half the confidence interval's width" of 100 * value. */
static void print_interval(const double *value, uint32_t count, const char *format)
{
    double mean = 0.0, square = 0.0;
    for (uint32_t i = 0; i < count; ++i)
        mean += 100.0 * value[i] / count;
    for (uint32_t i = 0; i < count; ++i)
        square += (100.0 * value[i] - mean) * (100.0 * value[i] - mean);
    fprintf(stderr, format, mean);
    if (count > 1)
        fprintf(stderr, " +- %.3f", student(count - 1) * sqrt(square / (count - 1) / count));
}

/* A run's error at a time, between its points linearly; after its last point, the last. */
static double error_at(const curve *run, uint32_t points, double seconds)
{
    for (uint32_t i = 1; i <= points; ++i)
        if (run->seconds[i] >= seconds) {
            double part = (seconds - run->seconds[i - 1]) / (run->seconds[i] - run->seconds[i - 1]);
            return run->error[i - 1] + (run->error[i] - run->error[i - 1]) * (part > 0.0 ? part : 0.0);
        }
    return run->error[points];
}

static void print_cell(const double *value, uint32_t count, int empty, const char *format)
{
    fprintf(stderr, " | ");
    if (empty)
        fprintf(stderr, "-");
    else
        print_interval(value, count, format);
}

/* curves[mode of o->modes][seed], half-way and at the end. Equal time is that which uniform (or the first mode) takes
   for these epochs; differences are to it too, seed by seed: the modes begin with the same network and see the same
   first epoch. */
static void print_summary(const options *o, curve (*curves)[MAX_SEEDS])
{
    uint32_t base = 0;
    for (uint32_t m = 0; m < o->mode_count; ++m)
        if (o->modes[m] == UNIFORM)
            base = m;
    const char *name = mode_name[o->modes[base]];
    fprintf(stderr, "| epochs | mode | seeds | test error %%, equal epochs | minus %s's | test error %%, equal time | "
                    "minus %s's | time / %s's |\n| ---: | --- | ---: | ---: | ---: | ---: | ---: | ---: |\n",
            name, name, name);
    for (uint32_t half = o->epochs < 4; half < 2; ++half) {
        uint32_t epochs = half == 0 ? o->epochs / 2 : o->epochs, point = epochs * o->rows;
        for (uint32_t m = 0; m < o->mode_count; ++m) {
            double equal[MAX_SEEDS], less[MAX_SEEDS], timed[MAX_SEEDS], timed_less[MAX_SEEDS], time = 0.0;
            for (uint32_t s = 0; s < o->seeds; ++s) {
                const curve *own = &curves[m][s], *other = &curves[base][s];
                equal[s] = own->error[point];
                less[s] = equal[s] - other->error[point];
                timed[s] = error_at(own, o->epochs * o->rows, other->seconds[point]);
                timed_less[s] = timed[s] - other->error[point];
                time += own->seconds[point] / other->seconds[point] / o->seeds;
            }
            fprintf(stderr, "| %u | %s | %u", epochs, mode_name[o->modes[m]], o->seeds);
            print_cell(equal, o->seeds, 0, "%.3f");
            print_cell(less, o->seeds, m == base, "%+.3f");
            print_cell(timed, o->seeds, 0, "%.3f");
            print_cell(timed_less, o->seeds, m == base, "%+.3f");
            fprintf(stderr, " | %.3f |\n", time);
        }
    }
}

#endif
